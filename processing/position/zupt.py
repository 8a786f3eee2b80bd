"""A device on a foot: the zero-velocity aided inertial filter with a chosen standstill detector, and its smoother.

The stances are found by one of :data:`processing.position.detectors.DETECTORS`; at each of them velocity is zero, the
less surely the nearer the detector's statistic is to its threshold. Long rests also show the gyro's offset. The
filter is :mod:`processing.position.zupt_filter`.

How fast the error grows is told by the run itself: what the velocity missed zero by at the stances, against the time
it was on its own. The factors on top are those that made 95 % intervals true on the VICON trials (navigation §4.7:
the filter's own covariance is four times too small).
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.orientation import quaternions as qt
from processing.position.detectors import DETECTORS, Standing, find_standing
from processing.position.inertial import arc_length
from processing.position.levelling import GyroOffset, rates_are_means
from processing.position.odometry import BLOCK_ROWS, Odometry, cumulated, gaps, in_spans, track_grid, usable_rows
from processing.position.stillness import resting_level, spans_of
from processing.position.zupt_filter import IndexArray, Inertial, Noise, Smoothed, Start, Updates, run_filter
from processing.progress import Progress
from processing.settings import PositionSettings
from processing.survey import Attitude, BoolArray, Finding, FloatArray, ImuSamples, Motion, Severity, Survey

_NODE_S = 0.02  # a zero velocity more often than this tells nothing new
_REST_S = 1.0
_REST_RADPS = np.radians(3.0)
_REST_RATE_SIGMA = 0.02
_GAP_S = 0.1
_LONG_GAP_S = 10.0
_IN_GAP = 30.0  # a second without samples: 1 m/s and 1°
_UNHELD = 0.5  # m/s/√s of a foot that never stands
_SURE_NIS = 16.27  # 99.9 % of chi squared with three degrees of freedom
_USUAL_NIS = 2.37  # its median


def choose_detector(survey: Survey, settings: PositionSettings) -> str:
    """Return the detector's name: the operator's, or what did best for the motion (``tests/benchmarks/foot.py``)."""
    if settings.zero_velocity_detector != "auto":
        return settings.zero_velocity_detector
    return "tcn" if survey.device.motion is Motion.FOOT else "butterworth"


def reckon(
    imu: ImuSamples, attitude: Attitude, survey: Survey, settings: PositionSettings, progress: Progress
) -> Odometry:
    """Return the free path of a foot-mounted (or carried) device (P4 section 2.1; shapes as :class:`Odometry`).

    Raises:
        LeaklineError: TOO_FEW_SAMPLES.
    """
    usable = usable_rows(imu)
    index = np.arange(len(imu.time_s)) if isinstance(usable, slice) else usable
    time_s = imu.time_s[usable]
    detector = choose_detector(survey, settings)
    gravity = _gravity(imu, index)

    def blocks(rows: slice) -> tuple[FloatArray, FloatArray]:
        return imu.acc_s_mps2[index[rows]], imu.gyr_s_radps[index[rows]]

    standing = find_standing(detector, time_s, blocks, gravity, settings, progress.part(0.0, 0.4))
    still = _cleaned(time_s, standing.still, DETECTORS[detector].least_s)
    grid = track_grid(float(time_s[0]), float(time_s[-1]), settings.track_rate_hz)
    updates = _updates(imu, attitude, index, still, standing, grid, settings)
    means = rates_are_means(imu, attitude, index, GyroOffset(np.empty(0), np.empty((0, 3))))
    offset = attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[index[0]]

    def read(rows: slice) -> Inertial:
        return _inertial(imu, attitude, index, rows, gravity, means=means)

    start = _start(imu, attitude, index, still, offset, settings)
    noise = Noise(
        settings.foot_acc_noise,
        np.radians(settings.foot_gyr_noise_dps),
        settings.foot_acc_offset_walk,
        np.radians(settings.foot_gyr_offset_walk_dps),
    )
    smoothed = run_filter(read, updates, start, noise, np.inf, progress.part(0.4, 0.7))
    gate = _gate(smoothed.nis)
    if np.any(smoothed.nis > gate):  # stances that the rest of the run finds implausible
        smoothed = run_filter(read, updates, start, noise, gate, progress.part(0.7, 1.0))
    odometry = _odometry(imu, time_s, still, grid, updates, smoothed, settings, detector, gravity)
    if survey.device.motion is Motion.FOOT:
        return odometry
    # travel at constant speed feels like a standstill; only a foot cannot help standing
    return replace(odometry, findings=(*odometry.findings, Finding("zupt_not_on_foot", Severity.WARNING)))


def _gravity(imu: ImuSamples, index: IndexArray) -> float:
    acc, gyr = np.empty(len(index)), np.empty(len(index))
    for start in range(0, len(index), BLOCK_ROWS):
        rows = index[start : start + BLOCK_ROWS]
        acc[start : start + BLOCK_ROWS] = np.linalg.norm(imu.acc_s_mps2[rows], axis=1)
        gyr[start : start + BLOCK_ROWS] = np.linalg.norm(imu.gyr_s_radps[rows], axis=1)
    return resting_level(acc, gyr, 1.0 / float(np.median(np.diff(imu.time_s[index]))))


def _cleaned(time_s: FloatArray, still: BoolArray, least_s: float) -> BoolArray:
    """Without moments too short for a stance; a gap in the samples says nothing about rest."""
    out = still.copy()
    gap = np.flatnonzero(np.diff(time_s) > _GAP_S)
    out[gap], out[gap + 1] = False, False
    spans = spans_of(out)
    if len(spans):
        short = time_s[spans[:, 1]] - time_s[spans[:, 0]] < least_s
        for first, last in spans[short]:
            out[first : last + 1] = False
    return out


def _inertial(
    imu: ImuSamples, attitude: Attitude, index: IndexArray, rows: slice, gravity: float, *, means: bool
) -> Inertial:
    """The strapdown's inputs for ``rows`` of the usable ones. Over a gap the attitude's own turn holds, and no longer
    than ``_GAP_S`` pass: one jolt held for seconds had thrown the foot out of the filter's reach for good.
    """
    here = index[rows]
    gyr = np.ascontiguousarray(imu.gyr_s_radps[here], dtype=np.float64)
    step = np.diff(imu.time_s[here], prepend=imu.time_s[here[0]])
    turn = step[:, None] * gyr
    if not means:  # rates of the moment: linear in between, coning to second order
        turn[1:] = 0.5 * step[1:, None] * (gyr[1:] + gyr[:-1])
        turn[1:] += np.cross(gyr[:-1], gyr[1:]) * (step[1:, None] ** 2 / 12.0)
    over = np.flatnonzero(step > _GAP_S)
    before, after = attitude.quat_ws[here[over - 1]], attitude.quat_ws[here[over]]
    turn[over] = qt.log_map(qt.multiply(qt.conjugate(before), after))
    step = np.minimum(step, _GAP_S)
    return Inertial(np.ascontiguousarray(imu.acc_s_mps2[here], dtype=np.float64), gyr, turn, step, gravity)


def _updates(
    imu: ImuSamples,
    attitude: Attitude,
    index: IndexArray,
    still: BoolArray,
    standing: Standing,
    grid: FloatArray,
    settings: PositionSettings,
) -> Updates:
    """Nodes at the track's rows and every 20 ms of a standstill, where the statistic is least; and what is known."""
    time_s = imu.time_s[index]
    chosen = np.zeros(len(time_s), dtype=np.bool_)
    chosen[_nearest(time_s, grid)] = True
    moments = np.flatnonzero(still)
    if len(moments):
        part = ((time_s[moments] - time_s[0]) / _NODE_S).astype(np.int64)
        order = np.lexsort((standing.statistic[moments], part))
        chosen[moments[order[np.unique(part[order], return_index=True)[1]]]] = True
    rows = np.flatnonzero(chosen).astype(np.int64)
    share = standing.statistic[rows] / standing.threshold[rows]
    sigma = settings.foot_still_mps * np.sqrt(1.0 + share.astype(np.float64) ** 2)
    rest = _resting(imu, index, still)
    yaw, yaw_sigma = np.zeros(len(rows)), np.zeros(len(rows))
    if attitude.heading_from != "launch":  # an absolute heading, whose error lasts: once a second, and weakly
        w, x, y, z = attitude.quat_ws[index[rows]].T
        yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        second = np.unique((time_s[rows] - time_s[0]).astype(np.int64), return_index=True)[1]
        yaw_sigma[second] = np.radians(settings.magnetic_sigma_deg) * np.sqrt(30.0)
    gap = np.diff(time_s, prepend=time_s[0])
    gone = np.diff(np.cumsum(np.where(gap > _GAP_S, gap, 0.0))[rows], prepend=0.0)
    # the filter sees no more than _GAP_S of a gap; what a minute does not leave of tilt and speed, an hour does not
    looser = np.where(gone > 0.0, _IN_GAP * np.sqrt(np.clip(gone, _GAP_S, _LONG_GAP_S) / _GAP_S), 1.0)
    return Updates(
        rows,
        np.where(still[rows], sigma, 0.0),
        np.where(rest[rows], _REST_RATE_SIGMA, 0.0),
        yaw,
        yaw_sigma,
        looser[:, None] * _jolted(imu, index, rows, settings),
    )


def _jolted(imu: ImuSamples, index: IndexArray, rows: IndexArray, settings: PositionSettings) -> FloatArray:
    """How much noisier than smooth motion acceleration and rate are before each node (m, 2): what changes between two
    samples is not seen, so a share of it is an error that lasts for that long. Impacts then take the blame that is
    theirs: on the VICON trials this took the position error from 0.21 m to 0.10 m.
    """
    time_s = imu.time_s
    sums, total = np.empty((len(rows), 2)), np.zeros(2)
    for start in range(0, len(index), BLOCK_ROWS):
        here = index[max(start - 1, 0) : start + BLOCK_ROWS]
        change = (np.diff(values[here], axis=0) for values in (imu.acc_s_mps2, imu.gyr_s_radps))
        power = np.column_stack([np.einsum("ij,ij->i", c, c) for c in change]) * np.diff(time_s[here])[:, None]
        gone = total + np.cumsum(np.vstack([np.zeros(2), power]) if start == 0 else power, axis=0)
        inside = slice(*np.searchsorted(rows, [start, start + BLOCK_ROWS]))
        sums[inside] = gone[rows[inside] - start]
        total = gone[-1] if len(gone) else total
    node_s = time_s[index[rows]]
    lasted = np.maximum(np.diff(node_s, prepend=node_s[0] - 1.0), 1e-6)[:, None]
    density = np.diff(sums, axis=0, prepend=0.0) / lasted * float(np.median(np.diff(time_s[index])))
    usual = np.array([settings.foot_acc_noise, np.radians(settings.foot_gyr_noise_dps)])
    return np.asarray(np.sqrt(1.0 + (settings.foot_jolt_share / usual) ** 2 * density))


def _nearest(time_s: FloatArray, at_s: FloatArray) -> IndexArray:
    right = np.clip(np.searchsorted(time_s, at_s), 1, len(time_s) - 1)
    return (right - (at_s - time_s[right - 1] < time_s[right] - at_s)).astype(np.int64)


def _resting(imu: ImuSamples, index: IndexArray, still: BoolArray) -> BoolArray:
    """Standstills of a second and more that do not turn: there the gyro reads its offset."""
    out = np.zeros(len(still), dtype=np.bool_)
    time_s = imu.time_s
    for first, last in spans_of(still):
        if time_s[index[last]] - time_s[index[first]] < _REST_S:
            continue
        gyr = imu.gyr_s_radps[index[first : last + 1]]
        if float(np.max(np.std(gyr, axis=0))) < _REST_RADPS and float(np.linalg.norm(gyr.mean(axis=0))) < 0.1:
            out[first : last + 1] = True
    return out


def _start(
    imu: ImuSamples,
    attitude: Attitude,
    index: IndexArray,
    still: BoolArray,
    offset_radps: FloatArray,
    settings: PositionSettings,
) -> Start:
    """Heading as the estimator has it, tilt as the first standstill shows it; without one the estimator's too."""
    first = attitude.quat_ws[index[0]]
    tilt_deg, speed = 3.0, 1.0
    if still[0]:
        time_s = imu.time_s[index]
        end = int(np.argmin(still)) if not np.all(still) else len(still)
        end = min(end, int(np.searchsorted(time_s, time_s[0] + 1.0)))
        force = np.mean(imu.acc_s_mps2[index[: max(end, 1)]], axis=0)
        first = qt.multiply(qt.from_two_vectors(qt.rotate(first, force), np.array([0.0, 0.0, 1.0])), first)
        tilt_deg, speed = 0.5, 0.01
    state = np.concatenate([np.zeros(6), first, np.zeros(3), offset_radps])
    tilt, turn = np.radians(tilt_deg), np.radians(settings.foot_gyr_offset_sigma_dps)
    sigma = np.array([1e-5] * 3 + [speed] * 3 + [tilt, tilt, 1e-3] + [settings.foot_acc_offset_sigma] * 3 + [turn] * 3)
    return Start(state, sigma)


def _gate(nis: FloatArray) -> float:
    """Where a stance becomes implausible, on the scale of this run's own innovations: gaits differ a thousandfold."""
    seen = nis[nis >= 0.0]
    return _SURE_NIS * max(float(np.quantile(seen, 0.9)) / 6.25, 1.0) if len(seen) else np.inf


@dataclass(frozen=True)
class _Strides:
    """Moving stretches between standstills: ``spans_s`` (k, 2), and the velocity (k, 3) missed at their ends.

    ``held_s`` are the first and the last moment of any standstill.
    """

    spans_s: FloatArray
    missed_mps: FloatArray
    held_s: tuple[float, float]


def _strides(node_s: FloatArray, smoothed: Smoothed) -> _Strides:
    held = np.flatnonzero(smoothed.nis >= 0.0)
    if len(held) == 0:  # nothing holds it: an unknown speed all the way
        return _Strides(np.empty((0, 2)), np.empty((0, 3)), (float(node_s[0]), float(node_s[0])))
    gap = np.flatnonzero(np.diff(held) > 1)
    moving = node_s[held[gap + 1]] - node_s[held[gap]] > 2.0 * _NODE_S
    before, after = held[gap][moving], held[gap + 1][moving]
    edges = (float(node_s[held[0]]), float(node_s[held[-1]]))
    return _Strides(np.column_stack([node_s[before], node_s[after]]), smoothed.missed_mps[after], edges)


def _odometry(
    imu: ImuSamples,
    time_s: FloatArray,
    still: BoolArray,
    grid: FloatArray,
    updates: Updates,
    smoothed: Smoothed,
    settings: PositionSettings,
    detector: str,
    gravity: float,
) -> Odometry:
    node_s = time_s[updates.rows]
    at = np.searchsorted(updates.rows, _nearest(time_s, grid))
    unseen = np.abs(grid - node_s[at]) > _GAP_S  # in a gap; how far it went there is in the interval
    velocity = np.where(unseen[:, None], 0.0, smoothed.state[at, 3:6])
    position = smoothed.state[at, :3] + velocity * (grid - node_s[at])[:, None]
    strides = _strides(node_s, smoothed)
    long = [(time_s[a], time_s[b]) for a, b in spans_of(still) if time_s[b] - time_s[a] > _REST_S]
    moving = np.ones(len(grid), dtype=np.bool_)
    for first, last in long:
        moving[(grid >= first) & (grid <= last)] = False
    chainage = arc_length(grid, velocity, moving)
    spans, stretches = gaps(time_s, imu)
    lost = _lost(grid, spans, chainage)
    level, up = _density(strides, settings)
    walk = _walked(grid, strides)

    def variance(density: float, factor: float) -> FloatArray:
        return cumulated(np.diff(walk) * (density * factor) ** 2)

    return Odometry(
        time_s=grid,
        position_w_m=position - position[0],
        chainage_m=chainage,
        speed_mps=np.gradient(chainage, grid),
        quat_ws=qt.normalise(smoothed.state[at, 6:10]),
        along_var_m2=variance(level, settings.foot_error_factor),
        lost_var_m2=cumulated(lost) if np.any(lost) else None,
        cross_var_m2=variance(level, settings.foot_error_factor),
        up_var_m2=variance(up, settings.foot_up_error_factor),
        heading_var_rad2=np.radians(settings.heading_walk) ** 2 * (grid - grid[0]),
        scale_sigma=settings.foot_scale_sigma_pct / 100.0,
        slope_sigma=settings.foot_slope_sigma_pct / 100.0,
        follows_slope=True,
        findings=_findings(strides, still, grid),
        not_assessed=stretches,
        quality={
            "stances": float(len(strides.spans_s)),
            "gravity_mps2": gravity,
            "velocity_walk": level,
            "zero_velocity_detector": detector,
            "zero_velocity_doubted": float(np.count_nonzero(smoothed.nis > _gate(smoothed.nis))),
        },
    )


def _density(strides: _Strides, settings: PositionSettings) -> tuple[float, float]:
    """Density (m/s/√s) of the velocity error, level and upward, from what the strides' velocities missed zero by."""
    if len(strides.spans_s) == 0:
        unheld = strides.held_s[0] == strides.held_s[1]
        return (_UNHELD, _UNHELD) if unheld else (settings.velocity_walk, settings.velocity_walk)
    duration = np.diff(strides.spans_s, axis=1)[:, 0]
    each = strides.missed_mps**2 / duration[:, None]
    # the mean of squares, the largest hundredth cut: one knock must not speak for a thousand strides
    each = np.minimum(each, np.quantile(each, 0.99, axis=0))
    level, up = np.sqrt(np.mean(each[:, :2])), np.sqrt(np.mean(each[:, 2]))
    return max(float(level), settings.velocity_walk), max(float(up), settings.velocity_walk)


def _walked(grid: FloatArray, strides: _Strides) -> FloatArray:
    """Cumulated variance (m,) of a coordinate for a velocity error of 1 m/s/√s: T³/12 a stride of length T whose
    velocity is zero at both ends, spread evenly over it; T³/3 before the first and beyond the last standstill.
    """
    held = strides.held_s
    head, tail = max(held[0] - grid[0], 0.0), max(grid[-1] - held[1], 0.0)
    begins = np.concatenate([[grid[0]], strides.spans_s[:, 0], [held[1]]])
    ends = np.concatenate([[held[0]], strides.spans_s[:, 1], [grid[-1]]])
    duration = np.diff(strides.spans_s, axis=1)[:, 0]
    sums = cumulated(np.concatenate([[head**3 / 3.0], duration**3 / 12.0, [tail**3 / 3.0]]))
    knots = np.column_stack([begins, ends]).ravel()
    return np.asarray(np.interp(grid, np.maximum.accumulate(knots), np.column_stack([sums[:-1], sums[1:]]).ravel()))


def _lost(grid: FloatArray, spans: FloatArray, chainage: FloatArray) -> FloatArray:
    """Variance of each step (m − 1,) from gaps: all of the way there, and a metre a second, are in doubt."""
    out = np.zeros(len(grid) - 1)
    for start, end in spans:
        inside = in_spans(grid, np.array([[start, end]]))
        way = float(np.diff(np.interp([start, end], grid, chainage))[0]) + end - start
        out[inside] += way**2 / max(int(np.count_nonzero(inside)), 1)
    return out


def _findings(strides: _Strides, still: BoolArray, grid: FloatArray) -> tuple[Finding, ...]:
    if not np.any(still):
        return (Finding("no_stops", Severity.WARNING, {"seconds": float(grid[-1] - grid[0])}),)
    if np.all(still):
        return (Finding("never_moved", Severity.WARNING),)
    found = []
    if not still[0]:
        found.append(Finding("moving_at_start", Severity.WARNING))
    if not still[-1]:
        found.append(Finding("moving_at_end", Severity.WARNING))
    longest = float(np.max(np.diff(strides.spans_s, axis=1))) if len(strides.spans_s) else 0.0
    if longest > 60.0:
        found.append(Finding("long_without_stop", Severity.WARNING, {"seconds": longest}))
    return tuple(found)
