"""Sound from real devices behind PortAudio: a virtual sound server stands for the microphone."""

import time

import numpy as np
import pytest
import soundfile

from app.devices.audio_input import AudioInput
from app.devices.audio_spec import AudioChoice
from processing.live.stream import LinkState

DEADLINE_S = 15.0


class Heard:
    """Collects the blocks of an input."""

    def __init__(self):
        self.blocks = []

    def __call__(self, block):
        self.blocks.append(block)

    @property
    def sound(self):
        return np.concatenate([b.frames for b in self.blocks]) if self.blocks else np.zeros((0, 1), np.int32)


def wait_for(condition, what):
    until = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < until, f"waited in vain: {what}"
        time.sleep(0.02)


@pytest.mark.parametrize(("rate_hz", "channels", "subtype"), [(48_000, 1, "PCM_24"), (96_000, 2, "PCM_16")])
def test_what_is_played_arrives_bit_by_bit(sound_server, tmp_path, rate_hz, channels, subtype):
    sound_server.reform(rate_hz, channels)
    bits = 24 if subtype == "PCM_24" else 16
    rng = np.random.default_rng(5)
    known = rng.integers(-(2 ** (bits - 1)), 2 ** (bits - 1), (rate_hz, channels), dtype=np.int32) << (32 - bits)
    known[0] = 1 << (32 - bits)  # the beginning must be found after silence
    soundfile.write(tmp_path / "known.wav", known, rate_hz, subtype)
    heard = Heard()
    sound = AudioInput(AudioChoice("default", rate_hz, channels), heard)
    sound.start()
    try:
        wait_for(lambda: sound.status().state is LinkState.LIVE, "the input to open")
        player = sound_server.play(tmp_path / "known.wav")
        player.wait(timeout=DEADLINE_S)
        wait_for(lambda: sound.status().frames > 2.5 * rate_hz, "all of the sound")
    finally:
        assert sound.stop()
    got = heard.sound
    first = int(np.flatnonzero(got.any(axis=1))[0])
    np.testing.assert_array_equal(got[first : first + len(known)], known)
