"""From the fitted keyframes back to a track at the odometry's own rate, and to a preview of it."""

from dataclasses import dataclass

import numpy as np

from processing.orientation.quaternions import multiply, turn_about_up
from processing.position.fit_results import FitPreview, FitSeries, Innovation
from processing.position.heading import route_turn
from processing.position.height import Heights
from processing.position.keyframes import Keyframes
from processing.position.motion_model import DRIFT, EAST, NORTH, SCALE, SLIP, TURN, WAY
from processing.position.odometry import Odometry, Rows, cumulated
from processing.position.route import RouteLine
from processing.position.smoothing import Settled
from processing.position.tie_checks import TieCheck
from processing.survey import FloatArray, Track

_TIME_PART = 1e-6  # m/s: what shares out a step in which the device did not move


def track_of(
    odometry: Odometry, frames: Keyframes, settled: Settled, heights: Heights, route: RouteLine | None
) -> Track:
    """Return the track at all rows of ``odometry``, of which ``frames`` are some."""
    between = _between(odometry, frames.rows)
    chainage = np.maximum.accumulate(np.maximum(between.of(settled.mean[:, WAY]), 0.0))
    turn = np.interp(odometry.time_s, frames.odometry.time_s, settled.nominal.turn_rad)
    level = _level(odometry, frames, settled, heights, between, turn)
    up = odometry.position_w_m[:, 2] + between.of(heights.up_m - frames.odometry.position_w_m[:, 2])
    place = np.column_stack([level, up])
    along = np.sqrt(between.variance(settled.along_sigma_m**2, settled.wandered_m2))
    cross = np.sqrt(between.variance(settled.cross_sigma_m**2, np.diff(frames.odometry.cross_var_m2)))
    sigma_up = np.sqrt(between.variance(heights.variance_m2, np.diff(frames.odometry.up_var_m2)))
    cov = np.column_stack([between.of(column) for column in _level_cov(settled, route).T])
    if route is not None:
        turn = route_turn(route, chainage, place)
        place = route.at(chainage)
        cross = np.full_like(cross, route.sigma_m)
        if np.ptp(route.points_w_m[:, 2]) > 0.0:
            sigma_up = np.full_like(sigma_up, route.sigma_m)
        cov = _on_route(route, chainage, along, cross)
    return Track(
        time_s=odometry.time_s,
        chainage_m=chainage,
        position_w_m=place,
        sigma_along_m=along,
        sigma_cross_m=cross,
        sigma_up_m=sigma_up,
        quat_ws=multiply(turn_about_up(turn), odometry.quat_ws),
        speed_mps=odometry.speed_mps * between.gain(settled.mean[:, WAY], frames.way_m),
        method=odometry.method,
        reason=odometry.reason,
        not_assessed=odometry.not_assessed,
        cov_level_m2=cov,
    )


def preview_of(
    odometry: Odometry,
    frames: Keyframes,
    settled: Settled,
    heights: Heights,
    route: RouteLine | None,
    checks: tuple[TieCheck, ...],
) -> FitPreview:
    """Return the same as far as it is drawn."""
    track = track_of(odometry, frames, settled, heights, route)
    assert track.cov_level_m2 is not None
    return FitPreview(
        track.time_s,
        track.chainage_m,
        track.position_w_m,
        track.sigma_along_m,
        track.sigma_cross_m,
        track.cov_level_m2,
        checks,
    )


def series_of(frames: Keyframes, settled: Settled, factor: float) -> FitSeries:
    """Return the course of the unknowns; ``factor`` is what the odometry's lengths were taken times beforehand."""

    def sigma(unknown: int) -> FloatArray:
        return np.sqrt(np.maximum(settled.cov[:, unknown, unknown], 0.0))

    return FitSeries(
        time_s=frames.odometry.time_s,
        chainage_m=settled.mean[:, WAY],
        slip_share=settled.mean[:, SLIP],
        slip_sigma=sigma(SLIP),
        heading_correction_rad=settled.mean[:, TURN],
        heading_sigma_rad=sigma(TURN),
        heading_drift_radps=settled.mean[:, DRIFT],
        heading_drift_sigma_radps=sigma(DRIFT),
        scale=factor * (1.0 + float(settled.mean[0, SCALE])),
        scale_sigma=factor * float(sigma(SCALE)[0]),
        slip_level=float(np.sqrt(settled.levels.slip)),
        heading_level=float(np.sqrt(settled.levels.heading)),
        innovations=_innovations(settled),
    )


def _innovations(settled: Settled) -> tuple[Innovation, ...]:
    normal = settled.amid.innovation / np.sqrt(settled.amid.spread)
    out = []
    for item, kept, (start, stop) in zip(settled.items, settled.held, settled.read.parts):
        size = float(normal[start]) if stop - start == 1 else float(np.linalg.norm(normal[start:stop]))
        out.append(Innovation(item.time_s, item.kind, item.name, size, kept is not item))
    return tuple(out)


@dataclass(frozen=True)
class _Between:
    """Where each row lies between its two keyframes: ``step`` (m,), ``part`` (m,) from 0 to 1."""

    step: Rows
    part: FloatArray

    def of(self, at_frames: FloatArray) -> FloatArray:
        """Return what is told at the keyframes (k,) at all rows (m,)."""
        first = at_frames[self.step]
        return np.asarray(first + self.part * (at_frames[self.step + 1] - first))

    def variance(self, at_frames: FloatArray, wandered: FloatArray) -> FloatArray:
        """Return variances at all rows: bridges between the keyframes over which ``wandered`` (k − 1,) builds up."""
        first, last, f = at_frames[self.step], at_frames[self.step + 1], self.part
        mixed = 2.0 * f * (1.0 - f) * np.minimum(first, last)
        bridge = f * (1.0 - f) * wandered[self.step]
        return np.asarray((1.0 - f) ** 2 * first + f**2 * last + mixed + bridge)

    def gain(self, fitted_m: FloatArray, way_m: FloatArray) -> FloatArray:
        """Return by what each row's speed is to be taken times, for it to fit the chainage."""
        moving = way_m > 1e-3
        gain = np.where(moving, np.diff(fitted_m) / np.where(moving, way_m, 1.0), 1.0)
        return np.asarray(np.clip(gain, 0.0, None)[self.step])


def _between(odometry: Odometry, rows: Rows) -> _Between:
    measure = odometry.chainage_m + _TIME_PART * (odometry.time_s - odometry.time_s[0])
    step = np.repeat(np.arange(len(rows) - 1), np.diff(rows))
    step = np.append(step, len(rows) - 2)
    first, last = measure[rows[step]], measure[rows[step + 1]]
    return _Between(step, np.clip((measure - first) / (last - first), 0.0, 1.0))


def _level(
    odometry: Odometry,
    frames: Keyframes,
    settled: Settled,
    heights: Heights,
    between: _Between,
    turn: FloatArray,
) -> FloatArray:
    """Turn and scale the free steps row by row, and share out what is then left to the keyframes."""
    nominal = settled.nominal
    free = np.diff(odometry.position_w_m[:, :2], axis=0)
    middle = 0.5 * (turn[1:] + turn[:-1])
    gain = ((1.0 + nominal.scale + nominal.slip[:-1]) * heights.shorter)[between.step[:-1]]
    cos, sin = gain * np.cos(middle), gain * np.sin(middle)
    own = cumulated(np.column_stack([cos * free[:, 0] - sin * free[:, 1], sin * free[:, 0] + cos * free[:, 1]]))
    left = nominal.place_m - own[frames.rows]
    return own + np.column_stack([between.of(column) for column in left.T])


def _level_cov(settled: Settled, route: RouteLine | None) -> FloatArray:
    """Variances east-east, east-north, north-north (k, 3)."""
    if route is not None:
        return np.zeros((len(settled.mean), 3))
    cov = settled.cov[:, EAST : NORTH + 1, EAST : NORTH + 1].reshape(-1, 4)[:, [0, 1, 3]]
    return np.asarray(cov + 1e-6 * np.array([1.0, 0.0, 1.0]))


def _on_route(route: RouteLine, chainage: FloatArray, along: FloatArray, cross: FloatArray) -> FloatArray:
    ahead = route.directions(chainage)[:, :2]
    round_part = (cross**2)[:, None] * np.array([1.0, 0.0, 1.0])
    return np.asarray((along**2 - cross**2)[:, None] * outer(ahead) + round_part)


def outer(v: FloatArray) -> FloatArray:
    """Return xx, xy, yy (k, 3) of the products of vectors (k, 2) with themselves."""
    return np.column_stack([v[:, 0] ** 2, v[:, 0] * v[:, 1], v[:, 1] ** 2])
