"""Finds the moments at which the device lay still, anywhere in a run of any length.

Sums over quarter-second bins are all that is kept of the samples; four neighbouring bins are the one-second window
whose standard deviations are compared with the thresholds (navigation §6.2).

A device that lies still may be *shaken*, by a pump or an engine: then the samples scatter, but the means of successive
seconds are the same. On real wheels of a car with its engine running (the public Wheel Inertial Dataset) all rests are
of this kind, and their offsets agree with one another to 0.02 °/s.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from processing.orientation import kernels_calibration
from processing.orientation.binning import BinSums, IndexArray
from processing.settings import OrientationSettings
from processing.survey import BoolArray, FloatArray, ImuSamples

_BIN_S = 0.25
_BINS_A_WINDOW = 4
_BLOCK_ROWS = 1 << 18
_AS_QUIET = 3.0
_SHAKEN_S = 3.0  # seconds must repeat themselves so long
_SHAKEN_RADPS, _SHAKEN_MPS2 = np.radians(0.15), 0.15  # as the mean of each second does that of the next
_SHAKEN_STD_RADPS, _SHAKEN_STD_MPS2 = np.radians(6.0), 6.0
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
    shaken: bool = False  # it lay still, but trembled: its scatter is not the sensors' noise

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
    quiet = _quiet_bins(sums, imu.sample_rate_hz, settings)
    rests = _rests_in(sums, quiet, least, settings, shaken=False)
    usual = np.median([r.gyr_mean_radps for r in rests], axis=0) if rests else None
    least = max(least, int(np.ceil(_SHAKEN_S / _BIN_S)))
    shaken = _shaken_bins(sums, imu.sample_rate_hz, settings) & ~quiet
    rests += _rests_in(sums, shaken, least, settings, shaken=True, usual=usual)
    return tuple(sorted(rests, key=lambda r: r.start_s))


def _rests_in(
    sums: _Sums,
    still: BoolArray,
    least: int,
    settings: OrientationSettings,
    *,
    shaken: bool,
    usual: FloatArray | None = None,
) -> list[Rest]:
    """Return the rests among bins (m,); at least ``least`` of them make one."""
    found = [(a, b) for a, b in _runs(still) if b - a >= least]
    if not found:
        return []
    rests = []
    for bins in _trustworthy(sums, found, np.radians(settings.rest_agree_dps), usual):
        rests += [
            _rest(sums, part, shaken=shaken)
            for part in np.split(bins, np.flatnonzero(np.diff(bins) > _BINS_A_WINDOW) + 1)
            if len(part) >= least // 2
        ]
    return rests


def _trustworthy(
    sums: _Sums, runs: list[tuple[int, int]], agree_radps: float, usual: FloatArray | None
) -> Iterator[IndexArray]:
    """Yield each run's bins that are as quiet as the quietest rest, and whose mean rate is the ``usual`` one (3,).

    Without one it is that of all bins at rest.

    A window may pass that already holds the onset of motion; a hand that holds the device is no rest where the ground
    is known; a slow steady turn shakes nothing: each would spoil the offset.
    """
    deviation = _deviations(sums)
    floor = np.min([np.percentile(deviation[a:b], 25.0, axis=0) for a, b in runs], axis=0)
    quiet = np.all(deviation <= _AS_QUIET * floor + _RESOLUTION, axis=1)
    rate = sums.first[:, 3:] / np.maximum(sums.count, 1.0)[:, None]
    if usual is None:
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
        picked = slice(None) if np.all(valid) else valid
        acc, gyr = (np.ascontiguousarray(v[rows][picked], np.float64) for v in (imu.acc_s_mps2, imu.gyr_s_radps))
        kernels_calibration.add_moments(acc, gyr, *collected.places(imu.time_s[rows][picked]))
    bins = collected.result()
    return _Sums(bins.start_of, bins.sums[:, 0], bins.sums[:, 1:7], bins.sums[:, 7:])


def _quiet_bins(sums: _Sums, rate_hz: float, settings: OrientationSettings) -> BoolArray:
    """Return which bins lie in a window at rest; a window that lacks half its samples is none."""
    quiet = np.zeros(len(sums.count), dtype=np.bool_)
    known, mean, deviation = _windows(sums, rate_hz)
    still = (
        known
        & (deviation[:, 0] < settings.rest_acc_std_mps2)
        & (deviation[:, 1] < np.radians(settings.rest_gyr_std_dps))
        & (np.linalg.norm(mean[:, 3:], axis=1) < np.radians(settings.rest_gyr_mean_dps))
    )
    for k in range(_BINS_A_WINDOW):
        quiet[k : k + len(still)] |= still
    return quiet


def _shaken_bins(sums: _Sums, rate_hz: float, settings: OrientationSettings) -> BoolArray:
    """Return which bins lie in two successive seconds of the same means, however they tremble."""
    still = np.zeros(len(sums.count), dtype=np.bool_)
    known, mean, deviation = _windows(sums, rate_hz)
    slow = known & (deviation[:, 0] < _SHAKEN_STD_MPS2) & (deviation[:, 1] < _SHAKEN_STD_RADPS)
    slow &= np.linalg.norm(mean[:, 3:], axis=1) < np.radians(settings.rest_gyr_mean_dps)
    change = mean[_BINS_A_WINDOW:] - mean[:-_BINS_A_WINDOW]
    same = slow[_BINS_A_WINDOW:] & slow[:-_BINS_A_WINDOW]
    same &= np.linalg.norm(change[:, :3], axis=1) < _SHAKEN_MPS2
    same &= np.linalg.norm(change[:, 3:], axis=1) < _SHAKEN_RADPS
    for k in range(2 * _BINS_A_WINDOW):
        still[k : k + len(same)] |= same
    return still


def _windows(sums: _Sums, rate_hz: float) -> tuple[BoolArray, FloatArray, FloatArray]:
    """Return per window of a second (k,) whether it has its samples, its means (k, 6) and deviations (k, 2)."""
    n = max(len(sums.count) - _BINS_A_WINDOW + 1, 0)
    windows = [slice(k, k + n) for k in range(_BINS_A_WINDOW)]
    count = np.sum([sums.count[w] for w in windows], axis=0)
    known = count >= max(0.5 * rate_hz * _BIN_S * _BINS_A_WINDOW, 4)
    whole = np.where(known, count, 1.0)[:, None]
    mean = np.sum([sums.first[w] for w in windows], axis=0) / whole
    variance = np.maximum(np.sum([sums.second[w] for w in windows], axis=0) / whole - mean * mean, 0.0)
    deviation = np.sqrt(np.column_stack([variance[:, :3].sum(axis=1), variance[:, 3:].sum(axis=1)]))
    return known, mean, np.asarray(deviation, dtype=np.float64)


def _runs(flags: BoolArray) -> Iterator[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist())


def _rest(sums: _Sums, bins: IndexArray, *, shaken: bool) -> Rest:
    count = float(sums.count[bins].sum())
    mean = sums.first[bins].sum(axis=0) / count
    std = np.sqrt(np.maximum(sums.second[bins].sum(axis=0) / count - mean * mean, 0.0))
    start, end = sums.start_s[bins[0]], sums.start_s[bins[-1]] + _BIN_S
    return Rest(float(start), float(end), int(count), mean[3:], std[3:], mean[:3], std[:3], shaken)
