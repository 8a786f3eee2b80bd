"""The pressure as second witness: does it dip or step where the sound proposes a leak, more than it does elsewhere?

The pressure along the pipe, its height taken off by the track and its slow course by a running median, is compared at
a place with what the same figure does along the rest of the pipe: ``p`` is the share of places that show as much.

What can be expected: water that leaves a pipe of section A with flow q slows what goes on by q/A and lifts the pressure
by ``ρ v q/A``, less than 10 Pa for 10 L/min out of a 100 mm main at 0.5 m/s; near the hole the pull falls off with the
square of the distance. A sensor's noise and the surges of a main are 50 to 500 Pa: only a burst can be seen. And a
track that took its heights from the pressure has already explained a part of whatever there was. A change that comes at
once may be of the place or of the moment: it counts as a transient, and the seconds around it bear no witness.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from processing.conditioning.transients import KPA_PER_M, PressureRows, Transient, find_transients, pressure_rows
from processing.sound.background import robust_sigma, running_median
from processing.survey import BoolArray, Candidate, Finding, FloatArray, ImuSamples, Severity, Track

_CELL_M = 0.5
_HALF_BACKGROUND_M = 24.0
_LEAST_WIDTH_M, _MOST_WIDTH_M = 1.0, 6.0
_REACH_WIDTHS = 4.0
_STEP_SIDE_M = 6.0
_FEWEST = 40  # places apart from the candidates
_APART_M = 10.0  # from a candidate: what is compared with is no leak
_MOVING_MPS = 0.05
_AROUND_TRANSIENT_S = 6.0


@dataclass(frozen=True)
class PressureAlong:
    """Cells of half a metre (n,), NaN where unknown: ``level_kpa`` without height, ``rest_kpa`` without its course."""

    chainage_m: FloatArray
    level_kpa: FloatArray
    rest_kpa: FloatArray

    @property
    def known(self) -> BoolArray:
        """Which cells were measured."""
        return np.isfinite(self.rest_kpa)


@dataclass(frozen=True)
class Witness:
    """What the pressure says of one place: kPa, negative for a fall; ``p`` is 1 where it says nothing at all."""

    dip_kpa: float
    dip_p: float
    step_kpa: float
    step_p: float


def pressure_along(rows: PressureRows, track: Track, transients: Sequence[Transient] = ()) -> PressureAlong | None:
    """Return the pressure along the pipe, without the seconds around ``transients``; None where there is none."""
    time_s = rows.time_s
    speed = np.interp(time_s, track.time_s, np.abs(track.speed_mps))
    use = rows.known & (time_s >= track.time_s[0]) & (time_s <= track.time_s[-1]) & (speed > _MOVING_MPS)
    for event in transients:
        use &= np.abs(time_s - event.time_s) > _AROUND_TRANSIENT_S
    if np.count_nonzero(use) < 2:
        return None
    way = np.interp(time_s[use], track.time_s, track.chainage_m)
    up = np.interp(time_s[use], track.time_s, track.position_w_m[:, 2])
    value = rows.values_kpa[use] + KPA_PER_M * up
    first = np.floor(way.min() / _CELL_M)
    cell = (np.floor(way / _CELL_M) - first).astype(np.int64)
    count = int(cell.max()) + 1
    number = np.bincount(cell, minlength=count)
    mean = np.where(number > 0, np.bincount(cell, value, count) / np.maximum(number, 1), np.nan)
    rest = mean - running_median(mean, max(1, round(_HALF_BACKGROUND_M / _CELL_M)))
    return PressureAlong((first + np.arange(count) + 0.5) * _CELL_M, mean, rest)


class PressureJudge:
    """Holds the pressure along one run; :meth:`at` compares a place with the rest of the pipe."""

    def __init__(self, along: PressureAlong, leaks_m: Iterable[float] = ()) -> None:
        self._along = along
        known = along.known
        self._rest = np.where(known, along.rest_kpa, 0.0)
        self._known = known
        self._elsewhere = known.copy()
        for place in leaks_m:
            self._elsewhere &= np.abs(along.chainage_m - place) > _APART_M
        self._dips: dict[float, FloatArray] = {}
        self._steps = self._step_figures()

    def at(self, chainage_m: float, width_m: float) -> Witness | None:
        """Return what the pressure does at a place; None where it was not measured there, or hardly anywhere."""
        cell = round((chainage_m - float(self._along.chainage_m[0])) / _CELL_M)
        if not 0 <= cell < len(self._rest) or not self._known[cell]:
            return None
        width = _rounded(width_m)
        if width not in self._dips:
            self._dips[width] = self._dip_figures(width)
        dips, steps = self._dips[width], self._steps
        every = max(1, round(width / _CELL_M))  # neighbours tell the same once more
        others_dip = dips[::every][self._elsewhere[::every] & np.isfinite(dips[::every])]
        far = max(1, round(_STEP_SIDE_M / _CELL_M))
        others_step = steps[::far][self._elsewhere[::far] & np.isfinite(steps[::far])]
        if len(others_dip) < _FEWEST or not np.isfinite(dips[cell]):
            return None
        dip, step = float(dips[cell]), float(steps[cell])
        dip_p = (1.0 + np.count_nonzero(others_dip <= dip)) / (1.0 + len(others_dip))
        step_p = 1.0
        if np.isfinite(step) and len(others_step) >= _FEWEST // 2:
            step_p = (1.0 + np.count_nonzero(np.abs(others_step) >= abs(step))) / (1.0 + len(others_step))
        return Witness(dip, float(dip_p), step if np.isfinite(step) else 0.0, float(step_p))

    def _dip_figures(self, width_m: float) -> FloatArray:
        """Return the height (n,) of the shape 1/(1+(d/w)²) in the pressure around each cell, least squares."""
        half = round(_REACH_WIDTHS * width_m / _CELL_M)
        shape: FloatArray = 1.0 / (1.0 + (np.arange(-half, half + 1, dtype=np.float64) * _CELL_M / width_m) ** 2)
        known = self._known.astype(np.float64)
        # the height and a level are fitted to what is known within the shape's reach
        n = _correlated(known, np.ones(len(shape)))
        s1, s2 = _correlated(known, shape), _correlated(known, np.square(shape))
        y1, ys = _correlated(self._rest, np.ones(len(shape))), _correlated(self._rest, shape)
        spread = s2 - s1 * s1 / np.maximum(n, 1.0)
        enough = (n >= 0.7 * len(shape)) & (spread > 1e-6)
        return np.where(enough, (ys - s1 * y1 / np.maximum(n, 1.0)) / np.where(enough, spread, 1.0), np.nan)

    def _step_figures(self) -> FloatArray:
        """Return the mean of the metres behind each cell less that of the metres before it (n,)."""
        side = round(_STEP_SIDE_M / _CELL_M)
        # a running median follows a step: steps are looked for in what it has not touched
        level = np.where(self._known, self._along.level_kpa - np.nanmedian(self._along.level_kpa), 0.0)
        total = np.concatenate([[0.0], np.cumsum(level)])
        count = np.concatenate([[0.0], np.cumsum(self._known)])
        cells = np.arange(len(self._rest))
        low, high = np.maximum(cells - side, 0), np.minimum(cells + side + 1, len(cells))
        before, behind = count[cells] - count[low], count[high] - count[cells + 1]
        enough = (before >= 0.7 * side) & (behind >= 0.7 * side)
        mean_behind = (total[high] - total[cells + 1]) / np.maximum(behind, 1.0)
        mean_before = (total[cells] - total[low]) / np.maximum(before, 1.0)
        return np.where(enough, mean_behind - mean_before, np.nan)


def with_pressure(
    candidates: Sequence[Candidate], imu: ImuSamples | None, track: Track | None
) -> tuple[tuple[Candidate, ...], tuple[Finding, ...]]:
    """Return the candidates with what the pressure says of each, and what is to be told of the pressure's transients.

    Evidence: ``pressure_dip_kpa``, ``pressure_dip_p``, ``pressure_step_kpa``, ``pressure_step_p`` where there is a path
    and enough of it; ``pressure_transient_s``, seconds from the nearest transient, where one is within six seconds.
    """
    rows = pressure_rows(imu) if imu is not None else None
    if imu is None or rows is None or robust_sigma(np.diff(rows.values_kpa)) == 0.0:
        return tuple(candidates), ()
    transients = find_transients(rows, track)
    along = pressure_along(rows, track, transients) if track is not None else None
    judge = PressureJudge(along, [c.chainage_m for c in candidates]) if along is not None else None
    out = []
    for candidate in candidates:
        evidence = dict(candidate.evidence)
        witness = judge.at(candidate.chainage_m, candidate.width_m) if judge is not None else None
        if witness is not None:
            evidence |= {
                "pressure_dip_kpa": witness.dip_kpa,
                "pressure_dip_p": witness.dip_p,
                "pressure_step_kpa": witness.step_kpa,
                "pressure_step_p": witness.step_p,
            }
        off = min((abs(event.time_s - candidate.time_s) for event in transients), default=np.inf)
        if off <= _AROUND_TRANSIENT_S:
            evidence["pressure_transient_s"] = float(off)
        out.append(replace(candidate, evidence=evidence))
    return tuple(out), _told(transients)


def _told(transients: Sequence[Transient]) -> tuple[Finding, ...]:
    if not transients:
        return ()
    largest = max(transients, key=lambda event: abs(event.size_kpa))
    params = {
        "count": float(len(transients)),
        "ringing": float(sum(event.kind == "hammer" for event in transients)),
        "largest_kpa": largest.size_kpa,
        "largest_s": largest.time_s,
    }
    return (Finding("pressure_transients", Severity.INFO, params),)


def _rounded(width_m: float) -> float:
    """Return a width on a coarse scale: candidates of like width share one pass over the pipe."""
    width = float(np.clip(width_m if np.isfinite(width_m) else _LEAST_WIDTH_M, _LEAST_WIDTH_M, _MOST_WIDTH_M))
    return float(2.0 ** (round(2.0 * np.log2(width)) / 2.0))


def _correlated(values: FloatArray, shape: FloatArray) -> FloatArray:
    half = len(shape) // 2
    return np.asarray(np.convolve(np.pad(values, half), shape[::-1], mode="valid"), np.float64)
