"""The ball as its own odometer: from angular rate to a free path, P1's ``v = r (ω_w × n)``.

With the contact normal ``n`` across the pipe's axis the ball turns by the true length of its way, whatever the slope:
``r |ω|`` across ``n`` is the speed along the pipe, and the spin about ``n`` moves nothing. The slope itself leaves no
trace in the rotation, so the path is level here; route, tie points or a growing ``sigma_up`` speak for the height.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from processing.orientation.quaternions import rotate, slerp_at
from processing.position.odometry import (
    GAP_S,
    Odometry,
    cumulated,
    gaps,
    in_spans,
    integrate,
    track_grid,
    usable_rows,
)
from processing.progress import Progress
from processing.settings import PositionSettings
from processing.survey import Attitude, BoolArray, Finding, FloatArray, ImuSamples, Params, Severity, Survey

UNKNOWN_RADIUS_M = 0.05  # a ball for 6-inch pipes; only the beginning of a fit
UNKNOWN_RADIUS_SIGMA = 0.5
_REVERSAL_COS = -0.7  # a pipe turns by less than 135° within a moment; a ball that comes back by 180°
_CREEP_MPS = 0.01  # slower, the direction of travel is noise
_LOST_HEADING_RAD = 0.5  # a gap in which the ball turned on loses the heading by about this much
_HEIGHT_WALK = 0.1  # m/√m: slopes of 2 % that change every 20 m

Rows: TypeAlias = slice | npt.NDArray[np.intp]


def reckon(
    imu: ImuSamples, attitude: Attitude, survey: Survey, settings: PositionSettings, progress: Progress
) -> Odometry:
    """Return the free path of a rolling ball (P1, eq. for v; shapes as :class:`Odometry`).

    Rests turn nothing; the chainage holds while the ball rolls back, until it passes the place again.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES.
    """
    radius, findings = _radius(survey)
    rows = usable_rows(imu)
    time_s = imu.time_s[rows]
    grid = track_grid(float(time_s[0]), float(time_s[-1]), settings.track_rate_hz)
    still = _still(imu, attitude, rows, time_s, settings)

    def rates(part: slice) -> FloatArray:
        index = part if isinstance(rows, slice) else rows[part]
        omega_w = _turning(imu, attitude, index)
        omega_w[still[part]] = 0.0
        # r (ω × ẑ), and its size: the path length has no chords in it
        return radius * np.column_stack([omega_w[:, 1], -omega_w[:, 0], np.hypot(omega_w[:, 0], omega_w[:, 1])])

    sums = integrate(time_s, rates, grid, lambda done: progress.update(done, "position_reckon"))
    spans, stretches = gaps(time_s, imu)
    forward = travel(np.diff(sums[:, :2], axis=0), np.diff(sums[:, 2]), np.diff(grid), settings.reverse_max_m)
    chainage = forward.chainage_m
    steps = np.diff(chainage)
    if forward.back_m > 0.5:
        findings = (*findings, Finding("rolled_back", Severity.INFO, {"metres": forward.back_m}))
    lost = in_spans(grid, spans)
    along = settings.slip_walk**2 * steps
    lost_way = np.where(lost, _span_variance(grid, spans, sums[:, 2], survey.pipe.length_m), 0.0)
    moved = np.hypot(*np.diff(sums[:, :2], axis=0).T)
    heading = np.radians(settings.heading_walk) ** 2 * np.diff(grid)
    lost_turn = np.where(lost & (moved > 0.0), _lost_heading(grid, spans), 0.0)
    return Odometry(
        time_s=grid,
        position_w_m=np.column_stack([sums[:, 0], sums[:, 1], np.zeros(len(grid))]),
        chainage_m=chainage,
        speed_mps=_per_row(np.diff(sums[:, 2]) / np.diff(grid)),
        quat_ws=slerp_at(imu.time_s, attitude.quat_ws, grid),
        along_var_m2=cumulated(along),
        cross_var_m2=cumulated(0.25 * along),
        up_var_m2=cumulated(_HEIGHT_WALK**2 * steps),
        heading_var_rad2=cumulated(heading),
        scale_sigma=UNKNOWN_RADIUS_SIGMA if survey.device.radius_m is None else settings.scale_sigma_pct / 100.0,
        slope_sigma=settings.slope_sigma_pct / 100.0,
        findings=findings,
        not_assessed=stretches,
        slip_sigma=settings.slip_sigma_pct / 100.0,
        slip_tau_s=settings.slip_tau_s,
        lost_var_m2=cumulated(lost_way),
        lost_heading_rad2=cumulated(lost_turn),
        quality={"radius_m": radius, "rolled_back_m": forward.back_m},
    )


@dataclass(frozen=True)
class Travel:
    """Distance along the pipe: ``chainage_m`` (m,), never decreasing, and how far the ball rolled back in all."""

    chainage_m: FloatArray
    back_m: float


def travel(step_m: FloatArray, length_m: FloatArray, duration_s: FloatArray, reverse_max_m: float) -> Travel:
    """Return the distance along the pipe of steps (k, 2) with path lengths (k,) and durations (k,): k + 1 rows.

    A ball that comes back through zero speed rolls backwards: that does not add, and the chainage waits until the ball
    passes the place again. A way back of more than ``reverse_max_m`` is taken for a turn of the pipe.
    """
    size = np.hypot(step_m[:, 0], step_m[:, 1])
    rolling = np.flatnonzero(size > _CREEP_MPS * duration_s)
    sign = np.ones(len(size))
    if len(rolling) > 1:
        direction = step_m[rolling] / size[rolling, None]
        flips = np.flatnonzero(np.sum(direction[1:] * direction[:-1], axis=1) < _REVERSAL_COS) + 1
        bounds = np.concatenate([[0], rolling[flips], [len(size)]])
        run_m = np.add.reduceat(length_m, bounds[:-1])
        forward = True
        for piece, run in enumerate(run_m):
            forward = forward if piece == 0 else not forward
            if not forward and run > reverse_max_m:
                forward = True
            sign[bounds[piece] : bounds[piece + 1]] = 1.0 if forward else -1.0
    signed = cumulated(sign * length_m)
    back = float(np.sum(length_m[sign < 0.0]))
    return Travel(np.maximum.accumulate(signed), back)


def _radius(survey: Survey) -> tuple[float, tuple[Finding, ...]]:
    if survey.device.radius_m is not None and survey.device.radius_m > 0.0:
        return survey.device.radius_m, ()
    known = survey.pipe.length_m is not None or any(t.enabled and t.chainage_m for t in survey.tie_points)
    if known:
        return UNKNOWN_RADIUS_M, (Finding("radius_fitted", Severity.INFO),)
    return UNKNOWN_RADIUS_M, (Finding("radius_unknown", Severity.WARNING, {"radius_m": UNKNOWN_RADIUS_M}),)


def _turning(imu: ImuSamples, attitude: Attitude, index: Rows) -> FloatArray:
    """World-frame angular rate (k, 3) of some rows."""
    bias = attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[index]
    return rotate(attitude.quat_ws[index], imu.gyr_s_radps[index] - bias)


def _still(
    imu: ImuSamples,
    attitude: Attitude,
    rows: Rows,
    time_s: FloatArray,
    settings: PositionSettings,
) -> BoolArray:
    """Where the ball turns by less than the threshold over half a second (n,)."""
    from scipy.ndimage import uniform_filter1d

    window = max(round(0.5 / float(np.median(np.diff(time_s), overwrite_input=True))), 1)
    energy = np.empty(len(time_s))
    for start in range(0, len(time_s), 1_000_000):
        part = slice(start, min(start + 1_000_000, len(time_s)))
        index = part if isinstance(rows, slice) else rows[part]
        bias = attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[index]
        gyr = imu.gyr_s_radps[index] - bias
        energy[part] = np.einsum("ij,ij->i", gyr, gyr)
    uniform_filter1d(energy, window, output=energy, mode="nearest")  # in place: one number a row is enough
    return np.asarray(energy < np.radians(settings.rolling_still_dps) ** 2)


def _lost_heading(grid: FloatArray, spans: FloatArray) -> FloatArray:
    """Variance of the heading in each step (m − 1,) within a gap: after a few seconds it may be anything."""
    out = np.zeros(len(grid) - 1)
    for span in spans:
        inside = in_spans(grid, span[None, :])
        whole = min(_LOST_HEADING_RAD**2 * (span[1] - span[0]) / GAP_S, np.pi**2 / 3.0)
        out[inside] += whole / np.count_nonzero(inside)
    return out


def _span_variance(grid: FloatArray, spans: FloatArray, path_m: FloatArray, most_m: float | None) -> FloatArray:
    """Variance of each step (m − 1,) within a gap: the whole bridged way may be missing, or be twice as long.

    No more than the whole pipe, ``most_m``, can be missing.
    """
    out = np.zeros(len(grid) - 1)
    for span in spans:
        inside = in_spans(grid, span[None, :])
        bridged = float(np.interp(span[1], grid, path_m) - np.interp(span[0], grid, path_m))
        bridged = min(bridged, most_m) if most_m else bridged
        # the error grows in equal shares; the ball may also have been moved although it rested on both sides
        out[inside] += (bridged**2 + 0.05**2) / np.count_nonzero(inside)
    return out


def _per_row(rates: FloatArray) -> FloatArray:
    """Rates of steps (m − 1,) as rates of rows (m,)."""
    return np.concatenate([rates[:1], 0.5 * (rates[1:] + rates[:-1]), rates[-1:]])


def quality_of(chainage_m: FloatArray, speed_mps: FloatArray) -> Params:
    """Return the figures of a path that every method gives."""
    moving = speed_mps > _CREEP_MPS
    mean = float(np.mean(speed_mps[moving])) if np.any(moving) else 0.0
    return {"path_length_m": float(chainage_m[-1]), "moving_share": float(np.mean(moving)), "mean_speed_mps": mean}
