"""What dead reckoning hands to the fit: a free path at track rate, and how fast its error grows.

Rolling and inertial reckoning both end here, so the fit knows no physics. Rates are integrated at the IMU's rate, in
blocks, and kept at the track's rate.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError
from processing.position.evidence import SlipSpan
from processing.survey import BoolArray, Channel, Finding, FloatArray, ImuSamples, Params, Stretch

Rows: TypeAlias = npt.NDArray[np.intp]

BLOCK_ROWS = 200_000  # 5 MB a vector column: large enough to be quick, small enough for hours at 1 kHz
_CARRY_ON_S = 60.0  # so long a device is taken to have gone on as before; what it did later, nobody knows
GAP_S = 0.25  # a longer silence of good samples is reported as not assessed; shorter ones are bridged


@dataclass(frozen=True)
class Odometry:
    """The free path: m rows, time strictly increasing; each ``*_var_*`` never decreases.

    ``position_w_m`` begins at the origin in the attitude's own heading; ``chainage_m`` begins at 0 and never decreases.
    The variances are cumulated: the error made between rows i and j has variance ``var[j] − var[i]``, a random walk.
    ``scale_sigma`` is the 1-sigma of one factor on all lengths, ``slope_sigma`` of one unknown slope (m/m).
    """

    time_s: FloatArray  # (m,)
    position_w_m: FloatArray  # (m, 3)
    chainage_m: FloatArray  # (m,)
    speed_mps: FloatArray  # (m,)
    quat_ws: FloatArray  # (m, 4)
    along_var_m2: FloatArray  # (m,)
    cross_var_m2: FloatArray  # (m,)
    up_var_m2: FloatArray  # (m,)
    heading_var_rad2: FloatArray  # (m,)
    scale_sigma: float
    slope_sigma: float
    start_sigma_m: float = 0.02
    follows_slope: bool = False  # whether the third coordinate was measured
    heading_from: str = "launch"  # as in Attitude
    method: str = ""
    reason: str = ""
    findings: tuple[Finding, ...] = ()
    not_assessed: tuple[Stretch, ...] = ()
    quality: Params = field(default_factory=dict)
    slip_sigma: float = 0.0  # 1-sigma of slip as a share of the way that wanders over slip_tau_s, beside the walks
    slip_tau_s: float = 15.0
    lost_var_m2: FloatArray | None = None  # (m,) cumulated, of the way in gaps: no level of noise scales it
    lost_heading_rad2: FloatArray | None = None  # (m,)


def usable_rows(imu: ImuSamples) -> Rows | slice:
    """Return the valid rows, as a slice where all are.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES where fewer than two are left.
    """
    count = int(np.count_nonzero(imu.valid))
    if count < 2:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=float(count), needed=2.0)
    return slice(0, len(imu.time_s)) if count == len(imu.valid) else np.flatnonzero(imu.valid)


def track_grid(start_s: float, end_s: float, rate_hz: float) -> FloatArray:
    """Return times from ``start_s`` to ``end_s`` (both included) at ``rate_hz``; the last step may be half longer."""
    count = max(int(np.floor((end_s - start_s) * rate_hz + 0.5)), 1)
    grid = start_s + np.arange(count + 1) / rate_hz
    grid[-1] = end_s
    return grid


def integrate(
    time_s: FloatArray, rates: Callable[[slice], FloatArray], at_s: FloatArray, tick: Callable[[float], None]
) -> FloatArray:
    """Return the integrals (m, k) at times ``at_s`` (m,) of what ``rates(rows)`` gives: (rows, k) at ``time_s`` (n,).

    Trapezoidal, block by block; ``at_s`` increases and lies within ``time_s``. ``tick`` is told the fraction done.
    """
    total: FloatArray | None = None
    out: FloatArray | None = None
    for start in range(0, len(time_s) - 1, BLOCK_ROWS):
        rows = slice(start, min(start + BLOCK_ROWS + 1, len(time_s)))  # one row shared with the next block
        values = rates(rows)
        times = time_s[rows]
        if total is None or out is None:
            total = np.zeros(values.shape[1])
            out = np.zeros((len(at_s), values.shape[1]))
        steps = 0.5 * np.diff(times)[:, None] * (values[1:] + values[:-1])
        cumulated = np.vstack([total, total + np.cumsum(steps, axis=0)])
        wanted = slice(*np.searchsorted(at_s, [times[0], times[-1]], side="left"))
        wanted = slice(wanted.start, len(at_s) if rows.stop == len(time_s) else wanted.stop)
        for column in range(values.shape[1]):
            out[wanted, column] = np.interp(at_s[wanted], times, cumulated[:, column])
        total = cumulated[-1]
        tick(rows.stop / len(time_s))
    assert out is not None
    return out


def gaps(time_s: FloatArray, imu: ImuSamples) -> tuple[FloatArray, tuple[Stretch, ...]]:
    """Return the spans (g, 2) without good samples that are longer than GAP_S, and their stretches."""
    step = np.diff(time_s)
    places = np.flatnonzero(step > max(GAP_S, 3.0 * float(np.median(step))))
    spans = np.column_stack([time_s[places], time_s[places + 1]])
    stretches = []
    for start, end in spans:
        inside = slice(*np.searchsorted(imu.time_s, [start, end], side="right"))
        masked = bool(np.any(~imu.valid[inside.start : max(inside.stop - 1, inside.start)]))
        stretches.append(Stretch(float(start), float(end), Channel.PATH, "imu_masked" if masked else "imu_gap"))
    return spans, tuple(stretches)


def in_spans(time_s: FloatArray, spans: FloatArray) -> BoolArray:
    """Return for each step between rows of ``time_s`` (m − 1,) whether it touches one of ``spans`` (g, 2)."""
    touched = np.zeros(len(time_s) - 1, dtype=np.bool_)
    for start, end in spans:
        first = int(np.searchsorted(time_s, start, side="right")) - 1
        last = int(np.searchsorted(time_s, end, side="left"))
        touched[max(first, 0) : max(last, first + 1, 1)] = True  # a moment that falls on a row lies in the step after
    return touched


def cumulated(steps: FloatArray) -> FloatArray:
    """Return 0 and the running sums of ``steps`` (m − 1, …): shape (m, …)."""
    return np.concatenate([np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)])


def directions(level_m: FloatArray) -> FloatArray:
    """Return unit directions (m − 1, 2) of a path's steps; where it rests, the last one before."""
    step = np.diff(level_m, axis=0)
    size = np.hypot(step[:, 0], step[:, 1])
    moving = size > 1e-9
    if not np.any(moving):
        return np.tile([1.0, 0.0], (len(step), 1))
    last = np.maximum.accumulate(np.where(moving, np.arange(len(step)), -1))
    last[last < 0] = int(np.argmax(moving))
    return np.asarray(step[last] / size[last, None])


def rescaled(odometry: Odometry, factor: float) -> Odometry:
    """Return the odometry with all lengths times ``factor`` (another radius)."""
    return replace(
        odometry,
        position_w_m=odometry.position_w_m * factor,
        chainage_m=odometry.chainage_m * factor,
        speed_mps=odometry.speed_mps * factor,
        along_var_m2=odometry.along_var_m2 * factor,
        cross_var_m2=odometry.cross_var_m2 * factor,
        up_var_m2=odometry.up_var_m2 * factor,
        lost_var_m2=None if odometry.lost_var_m2 is None else odometry.lost_var_m2 * factor**2,
    )


def thinned(odometry: Odometry, rows: Rows) -> Odometry:
    """Return the odometry at some of its rows: the walks are cumulated, so nothing but detail is lost."""
    return replace(
        odometry,
        time_s=odometry.time_s[rows],
        position_w_m=odometry.position_w_m[rows],
        chainage_m=odometry.chainage_m[rows],
        speed_mps=odometry.speed_mps[rows],
        quat_ws=odometry.quat_ws[rows],
        along_var_m2=odometry.along_var_m2[rows],
        cross_var_m2=odometry.cross_var_m2[rows],
        up_var_m2=odometry.up_var_m2[rows],
        heading_var_rad2=odometry.heading_var_rad2[rows],
        lost_var_m2=None if odometry.lost_var_m2 is None else odometry.lost_var_m2[rows],
        lost_heading_rad2=None if odometry.lost_heading_rad2 is None else odometry.lost_heading_rad2[rows],
    )


def held_back(odometry: Odometry) -> Odometry:
    """Return the odometry that goes on in a long gap for ``_CARRY_ON_S`` only: hours of it would lead anywhere.

    What the whole gap may have taken stands in the variances that no level of noise scales: the way that was bridged,
    and any turn.
    """
    count = len(odometry.time_s)
    share, left = np.ones(count - 1), np.ones(count - 1)
    way, turn = np.zeros(count - 1), np.zeros(count - 1)
    for stretch in odometry.not_assessed:
        duration = stretch.end_s - stretch.start_s
        if stretch.channel is not Channel.PATH or duration <= _CARRY_ON_S:
            continue
        inside = in_spans(odometry.time_s, np.array([[stretch.start_s, stretch.end_s]]))
        bridged = float(np.sum(np.diff(odometry.chainage_m)[inside]))
        share[inside] = np.minimum(share[inside], _CARRY_ON_S / duration)
        left[inside] = 0.0
        way[inside] = bridged**2 / np.count_nonzero(inside)
        turn[inside] = np.pi**2 / 3.0 / np.count_nonzero(inside) if bridged > 0.0 else 0.0
    if np.all(share == 1.0):
        return odometry

    def summed(values: FloatArray, factor: FloatArray) -> FloatArray:
        step = np.diff(values, axis=0)
        return np.asarray(values[:1] + cumulated(step * (factor[:, None] if values.ndim == 2 else factor)))

    def lost(values: FloatArray | None, steps: FloatArray) -> FloatArray:
        own = np.diff(values) if values is not None else np.zeros(count - 1)
        return cumulated(np.maximum(own, steps) if values is not None else steps)

    return replace(
        odometry,
        position_w_m=summed(odometry.position_w_m, share),
        chainage_m=summed(odometry.chainage_m, share),
        speed_mps=odometry.speed_mps * np.append(share, share[-1]),
        along_var_m2=summed(odometry.along_var_m2, left),
        cross_var_m2=summed(odometry.cross_var_m2, left),
        up_var_m2=summed(odometry.up_var_m2, np.where(left == 0.0, share, 1.0)),
        heading_var_rad2=summed(odometry.heading_var_rad2, left),
        # a method that knows better what a gap costs has said so already: the capped way, say
        lost_var_m2=odometry.lost_var_m2 if odometry.lost_var_m2 is not None else cumulated(way),
        lost_heading_rad2=lost(odometry.lost_heading_rad2, turn),
    )


def with_slips(odometry: Odometry, slips: Sequence[SlipSpan]) -> Odometry:
    """Return the odometry with the variance of its untrustworthy spans, which become stretches that are not assessed.

    The error of a span grows in equal shares over its rows.
    """
    if not slips:
        return odometry
    count = len(odometry.time_s)
    way, turn = np.zeros(count - 1), np.zeros(count - 1)
    stretches = []
    for slip in slips:
        if slip.end_s <= odometry.time_s[0] or slip.start_s >= odometry.time_s[-1]:
            continue
        inside = in_spans(odometry.time_s, np.array([[slip.start_s, slip.end_s]]))
        told = float(np.diff(np.interp([slip.start_s, slip.end_s], odometry.time_s, odometry.chainage_m))[0])
        shares = np.count_nonzero(inside)
        way[inside] += ((slip.sigma_share * told) ** 2 + slip.sigma_m**2) / shares
        turn[inside] += slip.heading_sigma_rad**2 / shares
        if slip.reason:
            stretches.append(Stretch(slip.start_s, slip.end_s, Channel.PATH, slip.reason))
    zero = np.zeros(count)
    return replace(
        odometry,
        lost_var_m2=(zero if odometry.lost_var_m2 is None else odometry.lost_var_m2) + cumulated(way),
        lost_heading_rad2=(zero if odometry.lost_heading_rad2 is None else odometry.lost_heading_rad2)
        + cumulated(turn),
        not_assessed=(*odometry.not_assessed, *stretches),
    )


def started_at(odometry: Odometry, time_s: float, sigma_m: float) -> Odometry:
    """Return the odometry with the launch at ``time_s``: what moved before it was the handling, and does not count."""

    def since(values: FloatArray) -> FloatArray:
        if values.ndim == 1:
            return np.maximum(values - np.interp(time_s, odometry.time_s, values), 0.0)
        at = np.array([np.interp(time_s, odometry.time_s, column) for column in values.T])
        return np.where(odometry.time_s[:, None] < time_s, 0.0, values - at)

    return replace(
        odometry,
        position_w_m=since(odometry.position_w_m),
        chainage_m=since(odometry.chainage_m),
        speed_mps=np.where(odometry.time_s < time_s, 0.0, odometry.speed_mps),
        along_var_m2=since(odometry.along_var_m2),
        cross_var_m2=since(odometry.cross_var_m2),
        up_var_m2=since(odometry.up_var_m2),
        heading_var_rad2=since(odometry.heading_var_rad2),
        lost_var_m2=None if odometry.lost_var_m2 is None else since(odometry.lost_var_m2),
        lost_heading_rad2=None if odometry.lost_heading_rad2 is None else since(odometry.lost_heading_rad2),
        start_sigma_m=sigma_m,
    )
