"""Finds the knocks and bumps that the microphone and the accelerometer both feel, for the common clock."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from processing.sound.scan import SoundScan
from processing.sound.tile_values import TILE_STEP_DB
from processing.survey import FloatArray, ImuSamples

_BLOCK_S = 10.0
_EVENTS_PER_BLOCK = 12  # joints come every ten seconds, knocks one a second: more is only noise
_BLOCKS_PER_CHUNK = 60
_RISE_S = 0.008
_APART_S = 0.06
_MIN_RISE_DB = 5.0
_ATTACK_S = 0.02
_QUARTER_DB = 6.0  # 25 % of the peak's energy
_MIN_JERK = 6.0  # in medians of the block


@dataclass(frozen=True)
class Events:
    """Moments (n,) in ascending order on the clock of their sensor, with strengths (n,) that rank them."""

    time_s: FloatArray
    strength: FloatArray

    def between(self, start_s: float, end_s: float) -> "Events":
        """Return the events in a span."""
        first, end = np.searchsorted(self.time_s, [start_s, end_s])
        return Events(self.time_s[first:end], self.strength[first:end])

    def only(self, which: npt.NDArray[np.bool_]) -> "Events":
        """Return those that are marked (n,)."""
        return Events(self.time_s[which], self.strength[which])

    def strongest(self, count: int) -> "Events":
        """Return the ``count`` strongest, in order of time."""
        if len(self.time_s) <= count:
            return self
        keep = np.sort(np.argsort(self.strength, kind="stable")[-count:])
        return Events(self.time_s[keep], self.strength[keep])


def audio_events(scan: SoundScan) -> Events:
    """Return sudden rises of the high-passed energy, in audio seconds, strength in dB.

    The moment is where the energy first reaches a quarter of its peak (acoustics §6).
    """
    step_s = scan.onset_step_s
    found: list[tuple[FloatArray, FloatArray]] = []
    block = max(1, round(_BLOCK_S / step_s))
    margin = round(0.1 / step_s)
    for start in range(0, len(scan.onset), block * _BLOCKS_PER_CHUNK):
        end = min(start + block * _BLOCKS_PER_CHUNK, len(scan.onset))
        first = max(0, start - margin)
        level = np.asarray(scan.onset[first : min(end + margin, len(scan.onset))], np.float32) * TILE_STEP_DB
        peaks, strength = rises(level, step_s)
        own = (peaks + first >= start) & (peaks + first < end)
        peaks, strength = _strongest_per_block(peaks[own], strength[own], block)
        times = np.array([first_quarter(level, int(p), step_s) for p in peaks]) + first
        found.append((times * step_s, strength))
    return _joined(found)


def rises(level: npt.NDArray[np.float32], step_s: float) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Return the steps and sizes (dB) of the sudden rises of a level (n,) in dB, one value each ``step_s``."""
    lag = max(1, round(_RISE_S / step_s))
    smooth = ndimage.uniform_filter1d(level, 3)
    rise = np.zeros(len(level), np.float32)
    rise[lag:] = smooth[lag:] - smooth[:-lag]
    return _separate_peaks(rise, _MIN_RISE_DB, max(1, round(_APART_S / step_s)))


def first_quarter(level: npt.NDArray[np.float32], peak: int, step_s: float) -> float:
    """Return the fractional step at which the level first comes within 6 dB of the attack's peak."""
    first = max(0, peak - 2 * round(_RISE_S / step_s))
    attack = level[first : peak + round(_ATTACK_S / step_s)]
    threshold = float(attack.max()) - _QUARTER_DB
    at = int(np.argmax(attack >= threshold))
    if at == 0:
        return float(first)
    before, after = float(attack[at - 1]), float(attack[at])
    return first + at - 1 + (threshold - before) / (after - before) + 0.5


def imu_events(imu: ImuSamples) -> Events:
    """Return jerks of |acceleration|, in survey seconds, strength in medians of the ten seconds around.

    The moment is the centroid of the blow's energy over three samples (acoustics §6). Rows that are not valid are
    passed over.
    """
    found: list[tuple[FloatArray, FloatArray]] = []
    rate = imu.sample_rate_hz
    block = max(8, round(_BLOCK_S * rate))
    apart = max(1, round(_APART_S * rate))
    for start in range(0, len(imu.time_s), block * _BLOCKS_PER_CHUNK):
        end = min(start + block * _BLOCKS_PER_CHUNK + 1, len(imu.time_s))
        times = np.asarray(imu.time_s[start:end])
        size = np.linalg.norm(imu.acc_s_mps2[start:end], axis=1)
        jerk = np.abs(np.diff(size))
        is_good = np.asarray(imu.valid[start:end])
        jerk[~(is_good[1:] & is_good[:-1]) | (np.diff(times) > 3 / rate)] = 0.0
        relative = jerk / _block_medians(jerk, block)
        peaks, strength = _separate_peaks(relative.astype(np.float32), _MIN_JERK, apart)
        peaks, strength = _strongest_per_block(peaks, strength, block)
        found.append((_centroids(_from_usual(size, block), times, peaks), strength))
    return _joined(found)


def _block_medians(values: FloatArray, block: int) -> FloatArray:
    """Return for each value the median of its block, never 0."""
    medians = np.empty(len(values))
    for start in range(0, len(values), block):
        part = values[start : start + block]
        above = part[part > 0]
        medians[start : start + block] = np.median(above) if len(above) else np.inf
    return medians


def _from_usual(size: FloatArray, block: int) -> FloatArray:
    """Return how far each value is from the median of its block."""
    away = np.empty(len(size))
    for start in range(0, len(size), block):
        part = size[start : start + block]
        away[start : start + block] = np.abs(part - np.median(part))
    return away


def _centroids(away: FloatArray, times: FloatArray, peaks: npt.NDArray[np.int64]) -> FloatArray:
    """Return the centroids around the larger of the two samples between which each peak of the jerk lies."""
    middle = np.where(away[peaks + 1] > away[peaks], peaks + 1, peaks)
    around = np.clip(middle[:, None] + np.array([-1, 0, 1]), 0, max(len(away) - 1, 0))
    weight = away[around] ** 2 + 1e-12
    moments: FloatArray = (weight * times[around]).sum(axis=1) / weight.sum(axis=1)
    return moments


def _separate_peaks(
    values: npt.NDArray[np.float32], threshold: float, apart: int
) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Return indices and values of maxima above ``threshold`` that are the highest within ±``apart``."""
    if not len(values):
        return np.zeros(0, np.int64), np.zeros(0)
    highest = ndimage.maximum_filter1d(values, 2 * apart + 1)
    peaks = np.flatnonzero((values == highest) & (values >= threshold))
    # a plateau is one event
    peaks = peaks[np.diff(peaks, prepend=-(apart + 2)) > apart] if len(peaks) else peaks
    return peaks, values[peaks].astype(np.float64)


def _strongest_per_block(
    peaks: npt.NDArray[np.int64], strength: FloatArray, block: int
) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Keep the few strongest events of every ten seconds."""
    order = np.lexsort((-strength, peaks // block))
    blocks = (peaks // block)[order]
    rank = np.arange(len(order)) - np.searchsorted(blocks, blocks)
    keep = np.sort(order[rank < _EVENTS_PER_BLOCK])
    return peaks[keep], strength[keep]


def _joined(found: list[tuple[FloatArray, FloatArray]]) -> Events:
    times = np.concatenate([np.zeros(0), *(t for t, _ in found)])
    strength = np.concatenate([np.zeros(0), *(s for _, s in found)])
    order = np.argsort(times, kind="stable")
    return Events(times[order], strength[order])
