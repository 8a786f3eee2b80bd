"""The attitude at which an estimator begins: tilt from the specific force, yaw from the launch, the field, or before.

Nobody knows how the sensor lies in a rolling ball, so its yaw says nothing of the direction of travel. The yaw is
therefore arbitrary unless ``Attitude.heading_from`` is ``magnetometer`` or ``device``: it is laid so that the sensor's
x axis points along the launch heading (east without one), and the path is turned to the heading in ``position``.
"""

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.orientation.samples import Block
from processing.survey import FloatArray

_UP = np.array([0.0, 0.0, 1.0])


def first_attitude(block: Block, duration_s: float, yaw_rad: float, previous_ws: FloatArray | None) -> FloatArray:
    """Return the attitude (4,) at the first row of a segment's first block.

    The tilt fits the specific force of the first ``duration_s``: the gyro carries every reading back to the first row
    before they are averaged, so that a ball may already be rolling: what turns with it averages out, gravity stays.
    The yaw comes from the field where there is one, else it continues ``previous_ws`` (4,), else it is ``yaw_rad``.
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
    if previous_ws is not None:
        return qt.multiply(qt.turn_about_up(float(yaw_towards(q, previous_ws))), q)
    return with_yaw(q, yaw_rad)


def with_yaw(q_ws: FloatArray, yaw_rad: float) -> FloatArray:
    """Return ``q_ws`` (4,) turned about up until its yaw is ``yaw_rad``."""
    return qt.multiply(qt.turn_about_up(yaw_rad - float(qt.to_roll_pitch_yaw(q_ws)[2])), q_ws)


def yaw_towards(q_ws: FloatArray, target_ws: FloatArray) -> FloatArray:
    """Return the angles about up (...,) by which ``q_ws`` must be turned to come closest to ``target_ws`` (..., 4)."""
    r = qt.multiply(target_ws, qt.conjugate(q_ws))
    return np.asarray(2.0 * np.arctan2(r[..., 3], r[..., 0]), dtype=np.float64)
