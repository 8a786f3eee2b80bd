"""The attitude at which an estimator begins: tilt from the specific force, yaw from the launch, the field, or before.

Nobody knows how the sensor lies in a rolling ball, so its yaw says nothing of the direction of travel. The yaw is
therefore arbitrary unless ``Attitude.heading_from`` is ``magnetometer`` or ``device``: it is laid so that the sensor's
x axis points along the launch heading (east without one), and the path is turned to the heading in ``position``.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.orientation.samples import Block
from processing.survey import FloatArray

_UP = np.array([0.0, 0.0, 1.0])
TAIL_S = 1.0  # so much of a segment tells its mean rate
_ROLLING_RADPS = np.radians(60.0)


@dataclass(frozen=True)
class Before:
    """How the segment before ended: attitude (4,) and mean angular rate of the last second in the world (3,)."""

    quat_ws: FloatArray
    rate_w_radps: FloatArray


def end_of(block: Block, quat_ws: FloatArray) -> Before:
    """Return how a block with attitudes (m, 4) ends."""
    last = slice(int(np.searchsorted(block.time_s, block.time_s[-1] - TAIL_S)), None)
    return Before(quat_ws[-1], _mean_rate(block, last, quat_ws[last]))


def first_attitude(block: Block, duration_s: float, yaw_rad: float, before: Before | None) -> FloatArray:
    """Return the attitude (4,) at the first row of a segment's first block.

    The tilt fits the specific force of the first ``duration_s``: the gyro carries every reading back to the first row
    before they are averaged, so that a ball may already be rolling: what turns with it averages out, gravity stays.
    The yaw comes from the field where there is one, else it continues the segment before, else it is ``yaw_rad``.
    """
    stop = max(int(np.searchsorted(block.time_s, block.time_s[0] + duration_s)), 1)
    relative = np.empty((stop, 4))
    kernels.integrate(block.turn[:stop], np.array(qt.IDENTITY), relative)
    up = qt.rotate(relative, block.acc_g[:stop]).mean(axis=0)
    # free fall or a dead channel: any tilt is as good
    q = qt.from_two_vectors(up, _UP) if np.linalg.norm(up) > 0.1 else np.array(qt.IDENTITY)
    if len(block.mag):
        clean = np.flatnonzero(block.mag_weight[:stop] > 0.0)
        if not len(clean):
            clean = np.arange(stop)  # a disturbed field is a better heading than none
        east, north, _ = qt.rotate(qt.multiply(q, relative[clean]), block.mag[clean]).mean(axis=0)
        return qt.multiply(qt.turn_about_up(float(np.arctan2(east, north))), q)
    if before is not None:
        return qt.multiply(qt.turn_about_up(continuing_turn(block, qt.multiply(q, relative), before)), q)
    return with_yaw(q, yaw_rad)


def continuing_turn(block: Block, quat_ws: FloatArray, before: Before) -> float:
    """Return the angle about up by which a segment's first attitudes (m, 4) must be turned to continue the one before.

    A rolling ball has turned on during the hole by nobody knows how much, but about the same axis: its horizontal
    direction is what continues. A device that hardly turned continues its attitude.
    """
    first = slice(0, max(int(np.searchsorted(block.time_s[: len(quat_ws)], block.time_s[0] + TAIL_S)), 1))
    rate = _mean_rate(block, first, quat_ws[first])
    if min(np.hypot(*rate[:2]), np.hypot(*before.rate_w_radps[:2])) > _ROLLING_RADPS:
        return float(np.arctan2(before.rate_w_radps[1], before.rate_w_radps[0]) - np.arctan2(rate[1], rate[0]))
    return float(yaw_towards(quat_ws[0], before.quat_ws))


def _mean_rate(block: Block, rows: slice, quat_ws: FloatArray) -> FloatArray:
    duration_s = float(block.dt_s[rows].sum())
    turn = qt.rotate(quat_ws, block.turn[rows]).sum(axis=0)
    return np.asarray(turn / duration_s if duration_s > 0.0 else 0.0 * turn, dtype=np.float64)


def with_yaw(q_ws: FloatArray, yaw_rad: float) -> FloatArray:
    """Return ``q_ws`` (4,) turned about up until its yaw is ``yaw_rad``."""
    return qt.multiply(qt.turn_about_up(yaw_rad - float(qt.to_roll_pitch_yaw(q_ws)[2])), q_ws)


def yaw_towards(q_ws: FloatArray, target_ws: FloatArray) -> FloatArray:
    """Return the angles about up (...,) by which ``q_ws`` must be turned to come closest to ``target_ws`` (..., 4)."""
    r = qt.multiply(target_ws, qt.conjugate(q_ws))
    return np.asarray(2.0 * np.arctan2(r[..., 3], r[..., 0]), dtype=np.float64)
