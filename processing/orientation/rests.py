"""Finds the moments at which the device lay still, anywhere in a run of any length.

Sums over quarter-second bins are all that is kept of the samples; four neighbouring bins are the one-second window
whose standard deviations are compared with the thresholds (navigation §6.2).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from processing.orientation.binning import BinSums, IndexArray
from processing.settings import OrientationSettings
from processing.survey import BoolArray, FloatArray, ImuSamples

_BIN_S = 0.25
_BINS_A_WINDOW = 4
_BLOCK_ROWS = 1 << 18
_AS_QUIET = 3.0
_RESOLUTION = np.array([0.005, np.radians(0.02)])  # m/s², rad/s: finer differences of quiet are no matter


@dataclass(frozen=True)
class Rest:
    """One standstill: means and standard deviations (3,) of ``count`` valid samples in ``start_s``..``end_s``."""

    start_s: float
    end_s: float
    count: int
    gyr_mean_radps: FloatArray
    gyr_std_radps: FloatArray
    acc_mean_mps2: FloatArray
    acc_std_mps2: FloatArray

    @property
    def middle_s(self) -> float:
        """The moment that the means stand for."""
        return 0.5 * (self.start_s + self.end_s)

    @property
    def duration_s(self) -> float:
        """How long it lay still."""
        return self.end_s - self.start_s


@dataclass(frozen=True)
class _Sums:
    """Per bin: where it starts, number of valid samples, sums and sums of squares of acc and gyr (m, 6)."""

    start_s: FloatArray
    count: FloatArray
    first: FloatArray
    second: FloatArray


def find_rests(imu: ImuSamples, settings: OrientationSettings) -> tuple[Rest, ...]:
    """Return the standstills of at least ``rest_min_s``, in order.

    A one-second window is at rest when the standard deviations (root of the summed variances of the axes) of specific
    force and angular rate, and the mean rate itself, lie under their settings. Bins whose mean rate differs from the
    median of all by more than ``rest_agree_dps`` were a slow steady turn and are left out.
    """
    sums = _bin_sums(imu)
    least = int(np.ceil(settings.rest_min_s / _BIN_S))
    found = [(a, b) for a, b in _runs(_quiet_bins(sums, imu.sample_rate_hz, settings)) if b - a >= least]
    if not found:
        return ()
    rests = []
    for bins in _trustworthy(sums, found, np.radians(settings.rest_agree_dps)):
        rests += [
            _rest(sums, part)
            for part in np.split(bins, np.flatnonzero(np.diff(bins) > _BINS_A_WINDOW) + 1)
            if len(part) >= least // 2
        ]
    return tuple(rests)


def _trustworthy(sums: _Sums, runs: list[tuple[int, int]], agree_radps: float) -> Iterator[IndexArray]:
    """Yield each run's bins that are as quiet as the quietest rest, and whose mean rate is that of all bins at rest.

    A window may pass that already holds the onset of motion; a hand that holds the device is no rest where the ground
    is known; a slow steady turn shakes nothing: each would spoil the offset.
    """
    deviation = _deviations(sums)
    floor = np.min([np.percentile(deviation[a:b], 25.0, axis=0) for a, b in runs], axis=0)
    quiet = np.all(deviation <= _AS_QUIET * floor + _RESOLUTION, axis=1)
    rate = sums.first[:, 3:] / np.maximum(sums.count, 1.0)[:, None]
    usual = np.median(np.concatenate([rate[a:b] for a, b in runs]), axis=0)
    quiet &= np.linalg.norm(rate - usual, axis=1) <= agree_radps
    for a, b in runs:
        yield a + np.flatnonzero(quiet[a:b])


def _deviations(sums: _Sums) -> FloatArray:
    """Return each bin's own standard deviations (m, 2) of specific force and angular rate, over the axes."""
    count = np.maximum(sums.count, 1.0)[:, None]
    mean = sums.first / count
    variance = np.maximum(sums.second / count - mean * mean, 0.0)
    both = np.column_stack([variance[:, :3].sum(axis=1), variance[:, 3:].sum(axis=1)])
    return np.asarray(np.sqrt(both), dtype=np.float64)


def _bin_sums(imu: ImuSamples) -> _Sums:
    collected = BinSums(float(imu.time_s[0]), _BIN_S, 13, most_empty=_BINS_A_WINDOW)
    for a in range(0, len(imu.time_s), _BLOCK_ROWS):
        rows = slice(a, a + _BLOCK_ROWS)
        valid = imu.valid[rows]
        values = np.hstack([imu.acc_s_mps2[rows][valid], imu.gyr_s_radps[rows][valid]])
        collected.add(imu.time_s[rows][valid], np.hstack([np.ones((len(values), 1)), values, values * values]))
    bins = collected.result()
    return _Sums(bins.start_of, bins.sums[:, 0], bins.sums[:, 1:7], bins.sums[:, 7:])


def _quiet_bins(sums: _Sums, rate_hz: float, settings: OrientationSettings) -> BoolArray:
    """Return which bins lie in a window at rest; a window that lacks half its samples is none."""
    n = len(sums.count) - _BINS_A_WINDOW + 1
    quiet = np.zeros(len(sums.count), dtype=np.bool_)
    if n <= 0:
        return quiet
    windows = [slice(k, k + n) for k in range(_BINS_A_WINDOW)]
    count = sum(sums.count[w] for w in windows)
    known = count >= max(0.5 * rate_hz * _BIN_S * _BINS_A_WINDOW, 4)
    whole = np.where(known, count, 1.0)[:, None]
    mean = sum(sums.first[w] for w in windows) / whole
    variance = np.maximum(sum(sums.second[w] for w in windows) / whole - mean * mean, 0.0)
    still = (
        known
        & (np.sqrt(variance[:, :3].sum(axis=1)) < settings.rest_acc_std_mps2)
        & (np.sqrt(variance[:, 3:].sum(axis=1)) < np.radians(settings.rest_gyr_std_dps))
        & (np.linalg.norm(mean[:, 3:], axis=1) < np.radians(settings.rest_gyr_mean_dps))
    )
    for w in windows:
        quiet[w] |= still
    return quiet


def _runs(flags: BoolArray) -> Iterator[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist())


def _rest(sums: _Sums, bins: IndexArray) -> Rest:
    count = float(sums.count[bins].sum())
    mean = sums.first[bins].sum(axis=0) / count
    std = np.sqrt(np.maximum(sums.second[bins].sum(axis=0) / count - mean * mean, 0.0))
    start, end = sums.start_s[bins[0]], sums.start_s[bins[-1]] + _BIN_S
    return Rest(float(start), float(end), int(count), mean[3:], std[3:], mean[:3], std[:3])
