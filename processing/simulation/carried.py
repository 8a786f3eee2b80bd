"""A probe carried or pulled along the line: x forward, swaying and wobbling with the steps, still at stops.

Attitude and position are closed forms of time, so accelerations are exact derivatives.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.simulation.drive import DrivePlan, Going
from processing.simulation.motion import GRAVITY_MPS2, TrueMotion, rates_from_turns
from processing.simulation.route import SmoothRoute
from processing.simulation.scenario import Carried
from processing.survey import FloatArray

_H = 1e-4  # half the span of the central difference of the attitude for instant rates


@dataclass(frozen=True)
class Carrying:
    """How a probe is carried; ``phases_rad`` (6,) make each run's sway its own."""

    carried: Carried
    route: SmoothRoute
    plan: DrivePlan
    phases_rad: FloatArray

    def sway(self, t: FloatArray, going: Going) -> tuple[FloatArray, FloatArray]:
        """Return offset (n, 3) from the line and its second derivative, in the world: bob at each step, sway at two."""
        offset, acc = np.empty((len(t), 3)), np.empty((len(t), 3))
        half, full = np.pi * self.carried.step_hz, 2 * np.pi * self.carried.step_hz
        for axis, (size, w) in enumerate([(self.carried.sway_m, half)] * 2 + [(self.carried.bob_m, full)]):
            angle = w * t + self.phases_rad[axis]
            wave, wave_d1 = size * np.sin(angle), size * w * np.cos(angle)
            offset[:, axis] = going.going * wave
            acc[:, axis] = going.going_d2 * wave + 2 * going.going_d1 * wave_d1 - going.going * w**2 * wave
        return offset, acc

    def attitude(self, t: FloatArray) -> FloatArray:
        """Return ``q_ws`` (n, 4): along the tangent, wobbling while under way."""
        going = self.plan.at(t)
        tangent = self.route.points(going.chainage_m).tangent_w
        size = np.radians(self.carried.wobble_deg) * going.going
        w = np.pi * self.carried.step_hz
        roll, pitch, yaw = (
            size * np.sin(rate * w * t + phase) for rate, phase in zip((1.0, 2.0, 0.5), self.phases_rad[3:])
        )
        heading = np.arctan2(tangent[:, 1], tangent[:, 0]) + yaw
        nose_down = -np.arcsin(np.clip(tangent[:, 2], -1, 1)) + pitch
        return qt.from_euler_zyx(roll, nose_down, heading)


def carry(carrying: Carrying, rate_hz: float, gyro_sampling: str) -> TrueMotion:
    """Return the true motion at ``rate_hz`` from time 0 to the end of the plan; chainage is that of the line."""
    count = int(np.floor(carrying.plan.duration_s * rate_hz)) + 1
    t = np.arange(count) / rate_hz
    going = carrying.plan.at(t)
    where = carrying.route.points(going.chainage_m)
    offset, sway_acc = carrying.sway(t, going)
    acc = going.acc_mps2[:, None] * where.tangent_w + (going.speed_mps**2)[:, None] * where.curvature_w_pm + sway_acc
    quats = carrying.attitude(t)
    if gyro_sampling == "increment":
        gyr = rates_from_turns(quats, 1.0 / rate_hz)
    else:
        before, after = carrying.attitude(t - _H), carrying.attitude(t + _H)
        gyr = qt.log_map(qt.multiply(qt.conjugate(before), after)) / (2 * _H)
    return TrueMotion(
        time_s=t,
        chainage_m=going.chainage_m,
        speed_mps=going.speed_mps,
        position_w_m=where.position_w_m + offset,
        quat_ws=quats,
        force_s_mps2=qt.rotate_inverse(quats, acc + np.array([0.0, 0.0, GRAVITY_MPS2])),
        gyr_s_radps=gyr,
        rotation_rad=np.zeros(count),
    )
