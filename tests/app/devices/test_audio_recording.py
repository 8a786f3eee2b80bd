"""Recording through the real PortAudio: a virtual sound server, and ALSA's own files, stand for the microphone."""

import time

import numpy as np
import pytest
import soundfile
from sound_server import why_missing

from app.devices import audio_input
from app.devices.audio_input import AudioInput
from app.devices.audio_spec import AudioChoice
from processing.errors import ErrorCode
from processing.live.stream import LinkState

DEADLINE_S = 20.0


def wait_for(condition, what):
    until = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < until, f"waited in vain: {what}"
        time.sleep(0.01)


@pytest.fixture
def record(sound_server):
    """Begins inputs, which are stopped at the end, whatever happens."""
    running = []

    def begin(on_block, choice, **more):
        sound = AudioInput(choice, on_block, **more)
        running.append(sound)
        sound.start()
        return sound

    yield begin
    for sound in running:
        assert sound.stop()


@pytest.mark.parametrize(("rate_hz", "channels", "bits"), [(48_000, 1, 16), (96_000, 2, 24)])
def test_what_is_played_arrives_bit_by_bit(sound_server, record, tmp_path, rate_hz, channels, bits):
    sound_server.reform(rate_hz, channels)
    low = 2 ** (bits - 1)
    known = np.random.default_rng(5).integers(-low, low, (rate_hz, channels), dtype=np.int32) << (32 - bits)
    known[0] = 1 << 30  # the beginning must be found after silence
    soundfile.write(tmp_path / "known.wav", known, rate_hz, f"PCM_{bits}")
    blocks = []
    sound = record(blocks.append, AudioChoice("default", rate_hz, channels))
    wait_for(lambda: sound.status().state is LinkState.LIVE, "sound")
    player = sound_server.play(tmp_path / "known.wav")
    assert player.wait(timeout=DEADLINE_S) == 0
    ended = sound.status().frames
    wait_for(lambda: sound.status().frames > ended + 0.3 * rate_hz, "the last of the sound")
    got = np.concatenate([b.frames for b in blocks])
    first = int(np.flatnonzero(got.any(axis=1))[0])
    np.testing.assert_array_equal(got[first : first + len(known)], known)
    assert not any(b.lost_before for b in blocks)
    assert sound.status().sample_rate_hz == rate_hz


@pytest.mark.parametrize("what", ["server", "sink"])
def test_a_lost_device_is_found_again_and_the_gap_is_as_long_as_it_was_gone(sound_server, record, monkeypatch, what):
    monkeypatch.setattr(audio_input, "RETRY_S", 0.3)
    blocks = []
    sound = record(blocks.append, AudioChoice("default", 48_000, 1))
    wait_for(lambda: sound.status().frames > 48_000, "a second of sound")
    sound_server.kill() if what == "server" else sound_server.unload_sink()
    wait_for(lambda: sound.status().state is LinkState.LOST, "the loss to be told")
    before = sound.status().frames
    assert sound.fault is not None
    time.sleep(0.7)
    sound_server.start() if what == "server" else sound_server.load_sink()
    wait_for(lambda: sound.status().frames > before + 36_000, "sound again")
    assert sound.status().state is LinkState.LIVE
    assert sound.fault is None
    (gap,) = [n for n, b in enumerate(blocks) if b.lost_before]
    host_s = np.array([b.adc_host_s for b in blocks])
    axis_s = np.array([b.first_frame for b in blocks]) / 48_000
    late_s = host_s - axis_s
    assert blocks[gap].lost_before > 0.7 * 48_000
    assert abs(np.median(late_s[gap:]) - np.median(late_s[:gap])) < 0.05


def test_resampling_by_the_server_is_told(sound_server, record):
    sound = record(lambda block: None, AudioChoice("default", 96_000, 1))
    wait_for(lambda: sound.status().source, "the source to be known")
    status = sound.status()
    assert (status.source, status.sample_rate_hz, status.source_rate_hz) == ("vsink.monitor", 96_000, 48_000)


def test_another_microphone_that_the_server_puts_in_place_of_ours_is_not_recorded(sound_server, record, monkeypatch):
    monkeypatch.setattr(audio_input, "SOURCE_S", 0.1)
    monkeypatch.setattr(audio_input, "RETRY_S", 0.1)
    for module in ("module-rescue-streams", "module-null-sink sink_name=other rate=48000 channels=1"):
        sound_server.control("load-module", *module.split())
    sound_server.control("set-default-source", "vsink.monitor")
    try:
        sound = record(lambda block: None, AudioChoice("default", 48_000, 1))
        wait_for(lambda: sound.status().source == "vsink.monitor", "the source to be known")
        sound_server.unload_sink()
        wait_for(lambda: sound.status().state is LinkState.LOST, "the loss to be told")
        wait_for(lambda: sound.fault and sound.fault.code is ErrorCode.SOUND_DEVICE_SWAPPED, "the reason")
        assert sound.fault.params["other"] == "other.monitor"
        sound_server.load_sink()
        sound_server.control("set-default-source", "vsink.monitor")
        wait_for(lambda: sound.status().state is LinkState.LIVE, "the right one again")
    finally:
        sound.stop()
        sound_server.kill()  # the next test gets a new one, without these modules


def test_stop_returns_in_time_when_the_sound_server_hangs(sound_server, record):
    sound = record(lambda block: None, AudioChoice("default", 48_000, 1))
    wait_for(lambda: sound.status().state is LinkState.LIVE, "sound")
    sound_server.hang()
    try:
        begun_s = time.monotonic()
        assert not sound.stop(timeout_s=0.5)
        assert time.monotonic() - begun_s < 5.0
    finally:
        sound_server.wake()
    wait_for(sound.stop, "the end")


def test_a_file_as_device_arrives_in_order_and_what_found_no_room_is_counted(sound_server, record, tmp_path):
    ramp = np.arange(1, 2_000_001, dtype=np.int32)
    ramp.tofile(tmp_path / "ramp.raw")
    sound_server.write_asound(
        "pcm.nothing { type null }\n"
        'pcm.ramp { type file slave.pcm { type null } file "/dev/null" infile "%s" format "raw" }\n'
        % (tmp_path / "ramp.raw")
    )
    blocks = []

    def slowly(block):
        if len(blocks) == 5:
            # this device waits for nobody: it brings a minute of sound in a tenth of a second
            wait_for(lambda: sound._handover.refused_frames > 0, "the queue to be full")
        blocks.append(block)

    sound = record(slowly, AudioChoice("ramp", 48_000, 1), queue_s=2.0)
    wait_for(lambda: blocks and blocks[-1].first_frame > len(ramp), "the whole file")
    assert sound.stop()
    within = [b for b in blocks if b.first_frame + len(b.frames) <= len(ramp)]
    for block in within:
        np.testing.assert_array_equal(block.frames[:, 0], ramp[block.first_frame :][: len(block.frames)])
    assert len(within) > 5
    lost = [b for b in blocks if b.lost_before]
    assert lost
    assert {b.reason for b in lost} == {"sound_behind"}


def test_where_the_programs_are_missing_the_reason_names_their_packages(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    reason = why_missing()
    assert "pulseaudio, pulseaudio-utils not installed" in reason
