"""Learns how the noise of rolling follows the turning of the ball, so that the quiet half of each turn counts most.

Step 2 of the detector measured in acoustics §5.1: order tracking by synchronous averaging. The scale of the gyro's
angle is tracked from the sound itself, because an error of 2 % in it loses all of the gain.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from processing.sound.background import robust_sigma
from processing.survey import BoolArray, FloatArray, ImuSamples

_WINDOW_S = 30.0
_CONTEXT = 0.5  # of a window, added on either side while its scale is searched
_SCALES = 1.0 + 0.002 * np.arange(-30.0, 31.0)
_NARROW = 0.002 * np.arange(-6.0, 7.0)
_PHASES = 12
_MIN_FRAMES = 6  # in a phase of a window
_TREND_S = 5.0
_LISTEN_HZ = (500.0, 3000.0)
_MIN_POWER = 12.0  # summed over two harmonics, in units of what noise gives on average: chance reaches it hardly ever
_MODULATION_RANGE = (0.1, 10.0)
_CHUNK = 1 << 20


@dataclass(frozen=True)
class RollingNoise:
    """Where in its turn the ball was in each level frame; ``cell`` is −1 where the rolling is not heard."""

    cell: npt.NDArray[np.int64]  # (t,) window · phases + phase
    cells: int
    frame_s: float

    @property
    def heard_share(self) -> float:
        """Share of the frames in which the rolling is heard."""
        return float(np.mean(self.cell >= 0))

    def modulation(self, log_power: npt.NDArray[np.float32], counts: BoolArray) -> npt.NDArray[np.float32]:
        """Return m (t,) by which the turning lifts this band's power; 1 on average over a turn, 1 where unknown."""
        usable = counts & (self.cell >= 0)
        steady = np.exp(log_power[usable] - _trend(log_power, self.frame_s)[usable])
        medians = _grouped_median(steady, self.cell[usable], self.cells).reshape(-1, _PHASES)
        whole = np.isfinite(medians).all(axis=1, keepdims=True)
        filled = np.where(whole, medians, 1.0)
        table = np.clip(filled / filled.mean(axis=1, keepdims=True), *_MODULATION_RANGE).ravel().astype(np.float32)
        out = np.ones(len(log_power), np.float32)
        out[usable] = table[self.cell[usable]]
        return out


def listened_bands(bands_hz: FloatArray) -> npt.NDArray[np.int64]:
    """Return which of the bands (b, 2) rolling is loud in."""
    hz = np.sqrt(bands_hz[:, 0] * bands_hz[:, 1])
    return np.flatnonzero((hz >= _LISTEN_HZ[0]) & (hz <= _LISTEN_HZ[1]))


def turned_angle(imu: ImuSamples, time_s: FloatArray) -> FloatArray:
    """Return the angle (t,) that the device had turned through by ``time_s``, radians, about whatever axis."""
    angle = np.empty(len(imu.time_s))
    total = 0.0
    for start in range(0, len(angle), _CHUNK):
        end = min(start + _CHUNK, len(angle))
        rate = np.linalg.norm(imu.gyr_s_radps[start:end], axis=1)
        rate[~np.asarray(imu.valid[start:end])] = 0.0
        steps = np.diff(imu.time_s[start:end], prepend=imu.time_s[max(start - 1, 0)])
        angle[start:end] = total + np.cumsum(rate * steps)
        total = float(angle[end - 1])
    return np.asarray(np.interp(time_s, imu.time_s, angle), np.float64)


def rolling_noise(
    level: npt.NDArray[np.float32], angle_rad: FloatArray, counts: BoolArray, frame_s: float
) -> RollingNoise | None:
    """Return the phase of each frame, its scale tracked from the sound; None where no turning is heard.

    Args:
        level: (t,) mean natural logarithm of power over the bands that :func:`listened_bands` names.
        angle_rad: (t,) angle turned, right to a few per cent.
        counts: (t,) frames that are heard and moving.
        frame_s: seconds a frame.
    """
    signal = np.where(counts, level - _trend(level, frame_s), 0.0)
    limit = 3 * robust_sigma(signal[counts].astype(np.float64))
    signal = np.clip(signal, -limit, limit)
    windows = list(_windows(len(signal), frame_s))
    powers = np.array([_harmonic_power(signal[wide], angle_rad[wide], _SCALES) for _, wide in windows])
    overall = powers.mean(axis=0)
    common = float(_SCALES[int(np.argmax(overall))])
    cell = np.full(len(signal), -1, np.int64)
    for number, (own, wide) in enumerate(windows):
        scales = common + _NARROW
        power = _harmonic_power(signal[wide], angle_rad[wide], scales)
        if power.max() < _MIN_POWER:
            continue
        turn = angle_rad[own] * float(scales[int(np.argmax(power))]) / (2 * np.pi)
        cell[own] = number * _PHASES + np.floor((turn - np.floor(turn)) * _PHASES).astype(np.int64) % _PHASES
    return RollingNoise(cell, len(windows) * _PHASES, frame_s) if (cell >= 0).any() else None


def _windows(count: int, frame_s: float) -> Iterator[tuple[slice, slice]]:
    """Yield the windows and the windows with context."""
    size = max(1, round(_WINDOW_S / frame_s))
    context = round(_CONTEXT * size)
    for start in range(0, count, size):
        yield slice(start, min(start + size, count)), slice(max(0, start - context), min(start + size + context, count))


def _harmonic_power(signal: npt.NDArray[np.floating], angle_rad: FloatArray, scales: FloatArray) -> FloatArray:
    """Return (scales,) the power of the first two harmonics of the turning, 2 on average for noise alone."""
    energy = float(np.sum(np.square(signal)))
    if energy <= 0:
        return np.zeros(len(scales))
    turned = np.exp(-1j * np.outer(scales, angle_rad - angle_rad[0]))
    first, second = turned @ signal, np.square(turned) @ signal
    return np.asarray((np.abs(first) ** 2 + np.abs(second) ** 2) / energy, np.float64)


def _trend(log_power: npt.NDArray[np.float32], frame_s: float) -> npt.NDArray[np.float32]:
    trend: npt.NDArray[np.float32] = ndimage.median_filter(
        log_power, 2 * round(_TREND_S / frame_s / 2) + 1, mode="nearest"
    )
    return trend


def _grouped_median(values: npt.NDArray[np.floating], group: npt.NDArray[np.int64], groups: int) -> FloatArray:
    """Return the lower median (groups,) of each group's values; NaN where there are too few."""
    order = np.lexsort((values, group))
    number = np.bincount(group, minlength=groups)
    first = np.cumsum(number) - number
    out = np.full(groups, np.nan)
    enough = number >= _MIN_FRAMES
    out[enough] = values[order][first[enough] + (number[enough] - 1) // 2]
    return out
