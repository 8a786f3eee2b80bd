"""Devices that give what a test tells them to give, for the recorder: everything behind them is real."""

import time
from dataclasses import replace

import numpy as np

from processing.importing.frames import Frames, encode
from processing.live.stream import LinkState, SoundBlock, SoundStatus

RATE_HZ = 8000


class FakeInput:
    """A sound input; :meth:`give` hands over frames as its worker would."""

    def __init__(self, choice, on_block, rate_hz=RATE_HZ):
        self.choice, self._on_block = choice, on_block
        self.now = SoundStatus(LinkState.LIVE, "mic", rate_hz, choice.channels, clipped=(False,) * choice.channels)
        self.fault = None
        self.next = 0
        self.is_running = False

    def start(self):
        self.is_running = True

    def stop(self, timeout_s=3.0):
        self.is_running = False
        return True

    def status(self):
        return self.now

    def clear_clip(self):
        self.now = replace(self.now, clipped=(False,) * self.choice.channels)

    def give(self, frames, lost=0, reason="sound_overflow", host_s=None):
        """Hand over frames (n, channels), their last one digitised now."""
        self.next += lost
        at = (time.monotonic() if host_s is None else host_s) - len(frames) / (self.now.sample_rate_hz or RATE_HZ)
        self._on_block(SoundBlock(frames, self.next, at, lost, reason if lost else ""))
        self.next += len(frames)


class FakeLink:
    """An IMU's link; :meth:`give` hands over bytes as its thread would."""

    def __init__(self, choice, on_bytes, on_state):
        self.choice, self._on_bytes, self._on_state = choice, on_bytes, on_state
        self.device, self.detail = "ball", ""
        self.is_running = False

    def start(self):
        self.is_running = True
        self._on_state(LinkState.WAITING, "")

    def stop(self, timeout=2.0):
        self.is_running = False
        self._on_state(LinkState.ENDED, "")

    def go(self, state, reason=""):
        self._on_state(state, reason)

    def give(self, data, host_s=None):
        self._on_state(LinkState.LIVE, "")
        self._on_bytes(data, time.monotonic() if host_s is None else host_s)


def noise(count, channels=1, seed=0):
    """Return frames (count, channels) of white noise with 24 bits."""
    return np.random.default_rng(seed).integers(-(2**23), 2**23, (count, channels)).astype(np.int32) << 8


def motion(count, first=0, rate_hz=400.0, start_us=5_000_000, seed=0):
    """Return samples number ``first`` to ``first + count`` of a device that sends ``rate_hz``."""
    rng = np.random.default_rng([seed, first])
    number = first + np.arange(count)
    missing = np.full(count, np.nan, np.float32)
    return Frames(
        counter=number.astype(np.uint32),
        time_us=(start_us + np.round(number * 1e6 / rate_hz)).astype(np.uint64),
        acc_s_mps2=rng.normal(0.0, 9.8, (count, 3)).astype(np.float32),
        gyr_s_radps=rng.normal(0.0, 5.0, (count, 3)).astype(np.float32),
        mag_s_ut=np.full((count, 3), np.nan, np.float32),
        pressure_kpa=missing,
        temperature_c=missing,
        quat_ws=np.full((count, 4), np.nan, np.float32),
        host_s=np.full(count, np.nan),
    )


def sent(frames):
    """Return the bytes of samples."""
    return encode(frames)
