"""The true motion of the device, sampled at the IMU's instants, and what every kind of motion has in common."""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.survey import BoolArray, FloatArray

GRAVITY_MPS2 = 9.81


@dataclass(frozen=True)
class TrueMotion:
    """Truth at ``time_s`` (n,), the instants of the IMU samples.

    ``force_s_mps2`` (n, 3) is the specific force at the IMU at that instant, ``gyr_s_radps`` (n, 3) the rate as the
    scenario's ``gyro_sampling`` defines it; ``rotation_rad`` (n,) is how far a ball has rolled (0 for carried ones).
    On foot ``velocity_w_mps`` (n, 3) is the sensor's own, and ``flat`` (n,) says where the sole stands on the ground.
    """

    time_s: FloatArray
    chainage_m: FloatArray
    speed_mps: FloatArray
    position_w_m: FloatArray
    quat_ws: FloatArray
    force_s_mps2: FloatArray
    gyr_s_radps: FloatArray
    rotation_rad: FloatArray
    velocity_w_mps: FloatArray | None = None
    flat: BoolArray | None = None


def rates_from_turns(quat_ws: FloatArray, step_s: float) -> FloatArray:
    """Return (n, 3) sensor-frame rates: the rotation from the sample before, over ``step_s``; the first is its own."""
    turns = qt.log_map(qt.multiply(qt.conjugate(quat_ws[:-1]), quat_ws[1:])) / step_s
    return np.vstack([np.zeros((1, 3)), turns])


def chained(turns: FloatArray, start: FloatArray) -> FloatArray:
    """Return (n, 4) running products ``turns[k] ⊗ … ⊗ turns[0] ⊗ start`` of unit quaternions ``turns`` (n, 4).

    Products are taken within √n blocks side by side, then over the blocks: no loop over samples.
    """
    count = len(turns)
    width = max(int(np.sqrt(count)), 1)
    rows = -(-count // width)
    padded = np.tile(np.asarray(qt.IDENTITY), (rows * width, 1))
    padded[:count] = turns
    blocks = padded.reshape(rows, width, 4)
    for column in range(1, width):
        blocks[:, column] = qt.multiply(blocks[:, column], blocks[:, column - 1])
    heads = np.empty((rows, 4))
    heads[0] = start
    for row in range(1, rows):
        heads[row] = qt.multiply(blocks[row - 1, -1], heads[row - 1])
    out = qt.multiply(blocks, heads[:, None, :]).reshape(-1, 4)[:count]
    return qt.normalise(out)
