"""A carried, pulled or foot-mounted device: double integration between standstills (P0, P3).

``a_w = q ⊗ a ⊗ q* − g ẑ``, with the attitude of :mod:`processing.position.levelling`; velocity is integrated over each
moving stretch, its linear drift taken off so that it is zero at the standstills on both sides, and the position is its
integral. The integrals are taken once over the whole run at the IMU's rate and kept at the track's rate: the drift of
a stretch is linear in them.

Chainage is the length of the way without sway and vibration: the speed along the smoothed direction of travel, or the
plain horizontal speed within a turn, whose corner a smoothed direction would cut; height enters smoothed.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation.quaternions import rotate
from processing.position.odometry import (
    BLOCK_ROWS,
    Odometry,
    Rows,
    cumulated,
    gaps,
    in_spans,
    track_grid,
    usable_rows,
)
from processing.position.stillness import Felt, find_stillness, really_resting, resting_level, spans_of
from processing.position.strapdown import levelled
from processing.progress import Progress
from processing.settings import PositionSettings
from processing.survey import Attitude, BoolArray, Finding, FloatArray, ImuSamples, Motion, Severity, Survey

_SWAY_S = 0.35  # Gaussian sigma: takes 91 % off a sway of 1 Hz, all of steps at 2 Hz
_TURN_RADPS = np.radians(30.0)  # sway leaves 5 °/s in the smoothed heading, a person's corner 60 °/s and more
_CREEP_MPS = 0.02
_KNOCK_S = 12.0  # a row of knocks
_FOOT_LEVEL_S = 1.0
_MOMENT_S = 0.6
_BLOW_MPS2 = 0.5


def reckon(
    imu: ImuSamples, attitude: Attitude, survey: Survey, settings: PositionSettings, progress: Progress
) -> Odometry:
    """Return the free path of a carried or foot-mounted device (P3 section 5.3; shapes as :class:`Odometry`).

    Raises:
        LeaklineError: TOO_FEW_SAMPLES.
    """
    rows = usable_rows(imu)
    time_s = imu.time_s[rows]
    index = np.arange(len(imu.time_s)) if isinstance(rows, slice) else rows
    acc, gyr = _sizes(imu.acc_s_mps2, index), _sizes(imu.gyr_s_radps, index)
    on_foot = survey.device.motion is Motion.FOOT
    if on_foot:  # a stance is short, hard, and leaves no doubt
        stillness = find_stillness(time_s, acc, gyr, settings)
    else:
        gravity = resting_level(acc, gyr, 1.0 / float(np.median(np.diff(time_s))))
        stillness = find_stillness(time_s, acc, gyr, settings, _felt(imu, attitude, index, gravity))
    progress.update(0.2, "position_reckon")
    rests = spans_of(stillness.still)
    grid = track_grid(float(time_s[0]), float(time_s[-1]), settings.track_rate_hz)
    at_s = np.unique(np.concatenate([grid, time_s[rests.ravel()]]))
    # a stance is too short and too hard to level by
    long_enough = time_s[rests[:, 1]] - time_s[rests[:, 0]] > (_FOOT_LEVEL_S if on_foot else 0.0)
    gravity = stillness.gravity_mps2
    sums = levelled(imu, attitude, index, rests[long_enough], gravity, at_s, progress)
    if not on_foot:
        first, last = (sums.velocity_w_mps[np.searchsorted(at_s, time_s[rests[:, edge]])] for edge in (0, 1))
        resting = really_resting(time_s[rests[1:, 0]] - time_s[rests[:-1, 1]], first, last)
        if not np.all(resting):  # a long bend is quiet, but its specific force is not upright
            rests = rests[resting]
            sums = levelled(imu, attitude, index, rests, gravity, at_s, progress)
    velocity, position = sums.velocity_w_mps, sums.position_w_m
    moves = _moving_stretches(time_s, rests)
    if not on_foot:
        moves = _without_knocks(moves, at_s, velocity, position)
    path = _without_drift(at_s, velocity, position, moves)
    on_grid = np.searchsorted(at_s, grid)
    density = _velocity_walk(moves, at_s, velocity, settings)
    variance = _walk_variance(at_s, moves, density)[on_grid]
    free, speed_w = path.position_w_m[on_grid], path.velocity_w_mps[on_grid]
    moving = _moving_rows(grid, moves)
    chainage = arc_length(grid, speed_w, moving)
    spans, stretches = gaps(time_s, imu)
    lost = in_spans(grid, spans) & moving[1:]
    step_var = np.diff(variance) + np.where(lost, (np.abs(np.diff(chainage)) + np.diff(grid)) ** 2, 0.0)
    walked = cumulated(step_var)
    return Odometry(
        time_s=grid,
        position_w_m=free,
        chainage_m=chainage,
        speed_mps=np.gradient(chainage, grid),
        quat_ws=sums.quat_ws[on_grid],
        along_var_m2=walked,
        cross_var_m2=walked,
        up_var_m2=walked,
        heading_var_rad2=np.radians(settings.heading_walk) ** 2 * (grid - grid[0]),
        scale_sigma=settings.inertial_scale_sigma_pct / 100.0,
        slope_sigma=0.0,
        follows_slope=True,
        findings=_findings(time_s, moves),
        not_assessed=stretches,
        quality={"stops": float(len(rests)), "gravity_mps2": stillness.gravity_mps2, "velocity_walk": density},
    )


@dataclass(frozen=True)
class Moves:
    """Moving stretches: ``spans_s`` (k, 2), and whether each begins and ends at a standstill (k,)."""

    spans_s: FloatArray
    rest_before: BoolArray
    rest_after: BoolArray


@dataclass(frozen=True)
class FreePath:
    """Velocity and position (m, 3) after the drift was taken off."""

    velocity_w_mps: FloatArray
    position_w_m: FloatArray


def _sizes(vectors: FloatArray, index: Rows) -> FloatArray:
    """Euclidean norms (k,) of the indexed rows, block by block."""
    out = np.empty(len(index))
    for start in range(0, len(index), BLOCK_ROWS):
        part = vectors[index[start : start + BLOCK_ROWS]]
        out[start : start + BLOCK_ROWS] = np.sqrt(np.einsum("ij,ij->i", part, part))
    return out


def _felt(imu: ImuSamples, attitude: Attitude, index: Rows, gravity_mps2: float) -> Felt:
    from scipy.ndimage import uniform_filter1d

    push, change = np.empty(len(index)), np.empty(len(index))
    width = max(round(_MOMENT_S / float(np.median(np.diff(imu.time_s[index])))), 1)
    for start in range(0, len(index), BLOCK_ROWS):
        rows = index[start : start + BLOCK_ROWS]
        acc_w = rotate(attitude.quat_ws[rows], imu.acc_s_mps2[rows])
        acc_w[:, 2] -= gravity_mps2
        push[start : start + BLOCK_ROWS] = np.sqrt(np.einsum("ij,ij->i", acc_w, acc_w))
        # clipped, so that a blow does not shift the mean of its moment; a difference, since a gentle start is linear
        mean = uniform_filter1d(np.clip(acc_w, -_BLOW_MPS2, _BLOW_MPS2), max(width // 4, 1), axis=0, mode="nearest")
        ahead = np.minimum(np.arange(len(rows)) + width // 2, len(rows) - 1)
        behind = np.maximum(np.arange(len(rows)) - width // 2, 0)
        step, blow = mean[ahead] - mean[behind], acc_w - mean
        size = np.maximum(np.einsum("ij,ij->i", step, step), np.einsum("ij,ij->i", blow, blow))
        change[start : start + BLOCK_ROWS] = np.sqrt(size)
    return Felt(push, change)


def _moving_stretches(time_s: FloatArray, rests: Rows) -> Moves:
    starts = np.concatenate([[time_s[0]], time_s[rests[:, 1]]])
    ends = np.concatenate([time_s[rests[:, 0]], [time_s[-1]]])
    before, after = np.ones(len(starts), dtype=np.bool_), np.ones(len(starts), dtype=np.bool_)
    before[0], after[-1] = False, False
    real = ends > starts
    return Moves(np.column_stack([starts, ends])[real], before[real], after[real])


def _without_knocks(moves: Moves, at_s: FloatArray, velocity: FloatArray, position: FloatArray) -> Moves:
    """Drop what came nowhere, the more so when its velocity never came back either: knocks on the shell."""
    start, end = (np.searchsorted(at_s, moves.spans_s[:, edge]) for edge in (0, 1))
    duration = moves.spans_s[:, 1] - moves.spans_s[:, 0]
    gained = velocity[end] - velocity[start]
    way = position[end] - position[start] - velocity[start] * duration[:, None] - 0.5 * gained * duration[:, None]
    nowhere = np.linalg.norm(way, axis=1) < np.where(np.linalg.norm(gained, axis=1) > 0.1, 0.2, 0.03)
    knock = moves.rest_before & moves.rest_after & (duration < _KNOCK_S) & nowhere
    return Moves(moves.spans_s[~knock], moves.rest_before[~knock], moves.rest_after[~knock])


def _without_drift(at_s: FloatArray, velocity: FloatArray, position: FloatArray, moves: Moves) -> FreePath:
    """Take the linear velocity drift off each moving stretch, and all velocity off the standstills."""
    clean_v, step = np.zeros_like(velocity), np.zeros((len(at_s) - 1, 3))
    for (start, end), after in zip(moves.spans_s, moves.rest_after):
        rows = slice(int(np.searchsorted(at_s, start)), int(np.searchsorted(at_s, end)) + 1)
        since = (at_s[rows] - start)[:, None]
        v0, p0 = velocity[rows.start], position[rows.start]
        # a stretch that runs into the end of the recording has no second standstill to measure its drift
        drift = (velocity[rows.stop - 1] - v0) / (end - start) if after else np.zeros(3)
        clean_v[rows] = velocity[rows] - v0 - drift * since
        step[rows.start : rows.stop - 1] = np.diff(position[rows] - p0 - v0 * since - 0.5 * drift * since**2, axis=0)
    return FreePath(clean_v, cumulated(step))


def _velocity_walk(moves: Moves, at_s: FloatArray, velocity: FloatArray, settings: PositionSettings) -> float:
    """Density (m/s/√s) of the velocity error, from what each stretch's velocity failed to come back to zero."""
    closed = moves.spans_s[moves.rest_before & moves.rest_after]
    if len(closed) == 0:
        return 10.0 * settings.velocity_walk
    missed = velocity[np.searchsorted(at_s, closed[:, 1])] - velocity[np.searchsorted(at_s, closed[:, 0])]
    # pooled over axes; a constant error is in it too although the drift removal takes it off: on the safe side
    seen = float(np.sqrt(np.sum(missed**2) / 3.0 / np.sum(closed[:, 1] - closed[:, 0])))
    return max(seen, settings.velocity_walk)


def _walk_variance(at_s: FloatArray, moves: Moves, density: float) -> FloatArray:
    """Cumulated variance (m,) of one coordinate: within a stretch of length T, τ after its start, a white acceleration
    error leaves n² (τ³/3 − τ⁴/4T) once the velocity is tied at both ends, n² τ³/3 where it is not.
    """
    step = np.zeros(len(at_s) - 1)
    for (start, end), before, after in zip(moves.spans_s, moves.rest_before, moves.rest_after):
        rows = slice(int(np.searchsorted(at_s, start)), int(np.searchsorted(at_s, end)) + 1)
        since = at_s[rows] - start
        tied = since**4 / (4.0 * (end - start)) if before and after else 0.0
        step[rows.start : rows.stop - 1] = np.diff(density**2 * (since**3 / 3.0 - tied))
    return cumulated(step)


def _moving_rows(grid: FloatArray, moves: Moves) -> BoolArray:
    place = np.searchsorted(moves.spans_s[:, 0], grid, side="left") - 1
    inside = place >= 0
    return np.asarray(inside & (grid <= moves.spans_s[np.maximum(place, 0), 1])) if len(moves.spans_s) else inside


def arc_length(time_s: FloatArray, velocity_w_mps: FloatArray, moving: BoolArray) -> FloatArray:
    """Return the length of the way (m,) without sway, of velocities (m, 3) at uniform times (the last may differ).

    Rows that do not move add nothing; the result never decreases.
    """
    from scipy.ndimage import gaussian_filter1d, maximum_filter1d

    step_s = float(np.median(np.diff(time_s)))
    width = _SWAY_S / step_s
    level = velocity_w_mps[:, :2]
    smooth = gaussian_filter1d(level, width, axis=0, mode="nearest")
    speed = np.hypot(smooth[:, 0], smooth[:, 1])
    direction = smooth / np.maximum(speed, 1e-12)[:, None]
    heading = np.unwrap(np.arctan2(smooth[:, 1], smooth[:, 0]))
    turning = (np.abs(np.gradient(heading, time_s)) > _TURN_RADPS) & (speed > 0.1)
    turning = maximum_filter1d(turning.astype(np.uint8), 2 * int(np.ceil(2.0 * width)) + 1).astype(np.bool_)
    along = np.where(turning, np.hypot(level[:, 0], level[:, 1]), np.sum(level * direction, axis=1))
    rising, onward = gaussian_filter1d(
        np.column_stack([velocity_w_mps[:, 2], speed]), 1.0 / step_s, axis=0, mode="nearest"
    ).T
    along = np.maximum(along, 0.0)
    climbing = np.abs(rising) / np.maximum(onward, 0.1)
    pace = np.where(onward > 0.1, along * np.hypot(1.0, climbing), np.hypot(along, rising))
    pace[~moving | (pace < _CREEP_MPS)] = 0.0
    return cumulated(0.5 * np.diff(time_s) * (pace[1:] + pace[:-1]))


def _findings(time_s: FloatArray, moves: Moves) -> tuple[Finding, ...]:
    if len(moves.spans_s) == 0:
        return (Finding("never_moved", Severity.WARNING),)
    found = []
    longest = int(np.argmax(moves.spans_s[:, 1] - moves.spans_s[:, 0]))
    seconds = float(np.diff(moves.spans_s[longest])[0])
    if not np.any(moves.rest_before | moves.rest_after):
        return (Finding("no_stops", Severity.WARNING, {"seconds": float(time_s[-1] - time_s[0])}),)
    if not moves.rest_before[0]:
        found.append(Finding("moving_at_start", Severity.WARNING))
    if not moves.rest_after[-1]:
        found.append(Finding("moving_at_end", Severity.WARNING))
    if seconds > 60.0:
        found.append(Finding("long_without_stop", Severity.WARNING, {"seconds": seconds}))
    return tuple(found)
