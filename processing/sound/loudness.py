"""How loud a recording usually is at each frequency, from short looks spread over it, weighed as the ear does."""

from typing import Protocol

import numpy as np

from processing.sound.pcm import Samples
from processing.survey import FloatArray

LOOK_FRAMES = 8192
_LOOKS = 16


class Reads(Protocol):
    """Reads samples from anywhere, as AudioReader does."""

    def read(self, start: int, count: int) -> Samples:
        """Return up to ``count`` samples from frame ``start`` on."""


def usual_power(reader: Reads, frames: int) -> FloatArray:
    """Return the median power (LOOK_FRAMES // 2 + 1,) of the looks: a knock at the launch is not what one hears.

    Raises:
        LeaklineError: AUDIO_UNREADABLE.
    """
    window = np.hanning(LOOK_FRAMES)
    powers = []
    for start in np.unique(np.linspace(0, max(0, frames - LOOK_FRAMES), _LOOKS).astype(int)):
        block = reader.read(int(start), LOOK_FRAMES)
        if block.size == LOOK_FRAMES:
            powers.append(np.square(np.abs(np.fft.rfft(block * window))))
    return np.asarray(np.median(powers, axis=0) if powers else np.zeros(LOOK_FRAMES // 2 + 1), np.float64)


def a_weight(hz: FloatArray) -> FloatArray:
    """Return the A-weighting as a factor of power, 1 at 1 kHz (IEC 61672-1, annex E)."""
    square = np.square(np.asarray(hz, np.float64))
    low, high = 20.598997**2, 12194.217**2
    amplitude = high * square**2
    amplitude = amplitude / (
        (square + low) * np.sqrt((square + 107.65265**2) * (square + 737.86223**2)) * (square + high)
    )
    return np.asarray(np.square(amplitude * 10.0 ** (2.0 / 20.0)), np.float64)
