"""Playing: exactly the asked samples, in bounded blocks, in a loop, and silence when the card goes."""

import sys
import threading

import numpy as np
import pytest

from app.devices.audio_output import BLOCK_S, Playback, SoundUnavailableError, Stretch, open_sink, why_silent

RATE_HZ = 8000.0
SOUND = np.linspace(-1.0, 1.0, 20_000, dtype=np.float32)


class CountingSink:
    """Takes everything at once, up to ``limit`` blocks."""

    latency_s = 0.0

    def __init__(self, limit=10_000):
        self.blocks, self.closed, self._limit = [], threading.Event(), limit

    def write(self, block):
        if len(self.blocks) >= self._limit:
            raise OSError("the card is gone")
        self.blocks.append(block.copy())

    def drain(self):
        self.drained = not self.closed.is_set()

    def close(self):
        self.closed.set()


def read(start, count):
    return SOUND[start : start + count]


def played(sink, stretch, gain=1.0):
    playback = Playback(sink, read, RATE_HZ, stretch, lambda: gain)
    playback.start()
    assert sink.closed.wait(10)
    playback.stop()
    return playback


def test_exactly_the_asked_samples_are_played_in_bounded_blocks():
    sink = CountingSink()
    playback = played(sink, Stretch(1000, 9000))
    np.testing.assert_array_equal(np.concatenate(sink.blocks), SOUND[1000:9000])
    assert max(map(len, sink.blocks)) <= BLOCK_S * RATE_HZ
    assert playback.position == 9000
    assert sink.drained  # the last moment is heard too
    assert playback.error is None


def test_the_sound_ends_with_the_recording():
    sink = CountingSink()
    played(sink, Stretch(19_000, 30_000))
    np.testing.assert_array_equal(np.concatenate(sink.blocks), SOUND[19_000:])


def test_a_loop_begins_again_where_it_shall():
    sink = CountingSink(limit=9)
    playback = played(sink, Stretch(2000, 2600, loop=True, loop_start=2000))
    heard = np.concatenate(sink.blocks)
    np.testing.assert_array_equal(heard[:1800], np.tile(SOUND[2000:2600], 3))
    assert isinstance(playback.error, OSError)  # the sink refused at last: told, not raised in the thread


def test_loud_sound_is_clipped_and_gain_is_applied():
    sink = CountingSink()
    played(sink, Stretch(0, 20_000), gain=4.0)
    heard = np.concatenate(sink.blocks)
    np.testing.assert_allclose(heard, np.clip(4.0 * SOUND, -1.0, 1.0), rtol=0, atol=1e-6)


def test_stopping_ends_the_thread_and_closes_the_card():
    gate = threading.Event()

    class SlowSink(CountingSink):
        def write(self, block):
            gate.wait(0.01)
            super().write(block)

    sink = SlowSink()
    playback = Playback(sink, read, RATE_HZ, Stretch(0, 20_000, loop=True))
    playback.start()
    playback.stop()
    assert not playback.active
    assert sink.closed.is_set()


def test_a_missing_sound_library_is_a_reason_not_a_crash(monkeypatch):
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    assert why_silent()
    with pytest.raises(SoundUnavailableError):
        open_sink(RATE_HZ)


def test_a_library_without_its_portaudio_is_a_reason_not_a_crash(monkeypatch):
    class Broken:
        def __getattr__(self, _name):
            raise OSError("PortAudio library not found")

    monkeypatch.setitem(sys.modules, "sounddevice", Broken())
    assert "PortAudio" in why_silent()
