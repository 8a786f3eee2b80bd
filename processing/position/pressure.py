"""Height from the pressure in the pipe: ``p = p0 − ρ g h − friction·s + surges``, with what cannot be told apart said.

Ten-second means leave the sensor's noise behind; what remains are surges that last for tens of seconds. Their size is
read from the series itself: second differences cancel slopes, and only few of them meet a change of slope. A pump that
switches moves the pressure at once by more than any pipe can climb meanwhile: there the series is cut, the step is
taken off and the offset is open again. The friction slope stays an unknown of the fit (``gradient_sigma``).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from processing.orientation.binning import BinSums
from processing.position.evidence import HeightSeries
from processing.position.odometry import Odometry
from processing.progress import Progress
from processing.survey import Finding, FloatArray, ImuSamples, Severity

KPA_PER_M = 9.81  # of water: 1000 kg/m³ · 9.81 m/s²
_FINE_S = 1.0
_ROW_S = 10.0
_SURGE_TAU_S = 20.0
_SURGE_FLOOR_M = 0.02
_SURGE_CEILING_M = 3.0  # beyond, the pressure speaks of pumps and not of height
_FRICTION = 0.02  # Darcy's factor of water mains, 0.015 to 0.03
_USUAL_DIAMETER_M = 0.3
_LEAST_GRADIENT, _MOST_GRADIENT = 0.0003, 0.01
_START_SIGMA_M = 0.1  # the stagnation pressure of a metre a second is 5 cm
_STEEPEST = 0.5  # m/m: nothing rolls through a steeper pipe
_STEP_SIDE_S = 3.0
_DOUBTED_M = 0.3
_STEP_SIGMAS = 6.0
_LEAST_ROWS = 6


@dataclass(frozen=True)
class PressureHeight:
    """The series, one for each span between pump steps, and what to say of them."""

    heights: tuple[HeightSeries, ...]
    findings: tuple[Finding, ...]


def find_heights(
    imu: ImuSamples, odometry: Odometry, progress: Progress, diameter_m: float | None = None
) -> PressureHeight:
    """Return heights above the launch where the log has a pressure that lives; none otherwise.

    The pipe's ``diameter_m`` tells, with the speed, how much friction can take.
    """
    if imu.pressure_kpa is None:
        return PressureHeight((), ())
    time_s, head_m = _fine(imu, progress)
    if len(time_s) < _LEAST_ROWS * _ROW_S / _FINE_S or float(np.ptp(head_m)) == 0.0 or _is_air(head_m):
        return PressureHeight((), (Finding("pressure_unusable", Severity.INFO),))
    way = np.interp(time_s, odometry.time_s, odometry.chainage_m)
    first = max(int(np.searchsorted(way, 0.05)) - 1, 1)  # the last second before it set out
    steps = _steps(head_m, way)
    parts: list[tuple[FloatArray, FloatArray, float]] = []
    start_m = float(np.median(head_m[max(first - 10, 0) : first + 1]))
    doubt = _START_SIGMA_M**2
    bounds = [0, *(s.row for s in steps), len(time_s)]
    jump = 0.0
    for k, (low, high) in enumerate(pairwise(bounds)):
        if k > 0:
            jump += steps[k - 1].size_m
            doubt += steps[k - 1].sigma_m ** 2
        rows = _rows(time_s[low:high], head_m[low:high] - jump - start_m)
        if len(rows[0]) >= 2:
            parts.append((rows[0], rows[1], float(np.sqrt(doubt))))
    surge = _surge_sigma([-up for _, up, _ in parts])
    if not parts or surge > _SURGE_CEILING_M:
        return PressureHeight((), (Finding("pressure_unusable", Severity.INFO),))
    gradient = _gradient_sigma(odometry, diameter_m or _USUAL_DIAMETER_M)
    # surges outlast a row: as if independent, rows would claim too much, so each takes its share of the others' doubt
    keep = np.exp(-_ROW_S / _SURGE_TAU_S)
    noise = surge * float(np.sqrt((1.0 + keep) / (1.0 - keep)))
    heights = tuple(
        HeightSeries(at, -up, noise, 600.0, 0.0, offset, gradient_sigma=gradient) for at, up, offset in parts
    )
    findings = [Finding("pressure_used", Severity.INFO, {"sigma_m": surge})]
    if steps:
        findings.append(Finding("pressure_steps", Severity.INFO, {"count": float(len(steps))}))
    return PressureHeight(heights, tuple(findings))


def _gradient_sigma(odometry: Odometry, diameter_m: float) -> float:
    """The head that friction takes a metre at the device's usual speed: ``f v²/(2 g D)`` (Darcy–Weisbach).

    The water may be quicker than the device and the pipe smoother than most, so it is taken for the sigma of a slope
    that is not known, not for its value.
    """
    moving = odometry.speed_mps > 0.05
    speed = float(np.median(odometry.speed_mps[moving])) if np.any(moving) else 0.0
    return float(np.clip(_FRICTION * speed**2 / (2.0 * 9.81 * diameter_m), _LEAST_GRADIENT, _MOST_GRADIENT))


def _is_air(head_m: FloatArray) -> bool:
    """A barometer in air stands near ten metres of water and hardly moves."""
    return 8.5 < float(np.median(head_m)) < 11.3 and float(np.ptp(head_m)) < 0.15


def _fine(imu: ImuSamples, progress: Progress) -> tuple[FloatArray, FloatArray]:
    """Means over each second of the valid rows, as metres of head (k,); blockwise."""
    assert imu.pressure_kpa is not None
    sums = BinSums(float(imu.time_s[0]), _FINE_S, 2, most_empty=3600)
    for start in range(0, len(imu.time_s), 500_000):
        rows = slice(start, start + 500_000)
        pressure = imu.pressure_kpa[rows]
        good = imu.valid[rows] & np.isfinite(pressure)
        sums.add(imu.time_s[rows][good], np.column_stack([np.ones(np.count_nonzero(good)), pressure[good]]))
        progress.update(min(start + 500_000, len(imu.time_s)) / len(imu.time_s), "position_pressure")
    found = sums.result()
    some = found.sums[:, 0] > 0
    return found.start_of[some] + 0.5 * _FINE_S, found.sums[some, 1] / found.sums[some, 0] / KPA_PER_M


@dataclass(frozen=True)
class _Step:
    """At second ``row`` the head jumped: by ``size_m`` that is taken off, with ``sigma_m`` for what stays unknown."""

    row: int
    size_m: float
    sigma_m: float


def _steps(head_m: FloatArray, way_m: FloatArray) -> tuple[_Step, ...]:
    """Where the level moves at once by more than the device can have climbed meanwhile.

    A smaller jump that stands alone may be a pump or a hump of the pipe: it stays, and is doubted.
    """
    side = round(_STEP_SIDE_S / _FINE_S)
    if len(head_m) < 6 * side:
        return ()
    rows = np.arange(side, len(head_m) - side)
    total = np.concatenate([[0.0], np.cumsum(head_m)])
    # a second on either side of the edge may lie within the jump
    before = (total[rows - 1] - total[rows - side]) / (side - 1)
    after = (total[rows + side] - total[rows + 1]) / (side - 1)
    change = after - before
    usual = float(np.median(np.abs(change))) / 0.6745 + 1e-6
    reach = (side + 1) // 2  # the two means are side + 1 seconds apart
    gone = way_m[rows + reach] - way_m[rows - reach]
    size = np.abs(change)
    neighbours = np.maximum(_shifted(size, -2 * side), _shifted(size, 2 * side))
    alone = (size > max(_STEP_SIGMAS * usual, _DOUBTED_M)) & (size > 3.0 * neighbours)
    sure = size > np.maximum(_STEEPEST * gone, max(_STEP_SIGMAS * usual, _DOUBTED_M))
    out: list[_Step] = []
    for row in np.flatnonzero(alone | sure):
        first_near = max(int(row) - 2 * side, 0)
        if row == first_near + int(np.argmax(size[first_near : row + 2 * side + 1])):
            climbed = float(np.hypot(2.0 * usual, 0.05 * gone[row]))
            at = int(rows[row])
            out.append(_Step(at, float(change[row]), climbed) if sure[row] else _Step(at, 0.0, float(size[row])))
    return tuple(out)


def _shifted(values: FloatArray, by: int) -> FloatArray:
    return np.asarray(values[np.clip(np.arange(len(values)) + by, 0, len(values) - 1)])


def _rows(time_s: FloatArray, up_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Means over ten seconds (j,), in order; a piece that is too short gives none."""
    if len(time_s) < 2:
        return np.zeros(0), np.zeros(0)
    at = ((time_s - time_s[0]) / _ROW_S).astype(np.int64)
    count = np.bincount(at)
    full = count >= 0.5 * _ROW_S / _FINE_S
    with np.errstate(invalid="ignore", divide="ignore"):
        return (np.bincount(at, time_s) / count)[full], (np.bincount(at, up_m) / count)[full]


def _surge_sigma(parts: list[FloatArray]) -> float:
    """Standard deviation of the surges, from the second differences of the rows: a Gauss–Markov process's, inverted."""
    second = np.concatenate([np.zeros(0), *(np.diff(up, 2) for up in parts if len(up) > 2)])
    if len(second) < _LEAST_ROWS:
        return _SURGE_FLOOR_M
    keep = np.exp(-_ROW_S / _SURGE_TAU_S)
    usual = float(np.median(np.abs(second - np.median(second)))) / 0.6745
    return max(usual / float(np.sqrt(6.0 - 8.0 * keep + 2.0 * keep**2)), _SURGE_FLOOR_M)
