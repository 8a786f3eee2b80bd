"""A ball rolling along the pipe: angular velocity from the contact, attitude by the exponential map, force at the IMU.

``ω_w = (1 − slip)(n × v)/r + spin·n`` with contact normal ``n``; the world-frame equation ``q̇ = ½ ω_w ⊗ q`` is
integrated by the fourth-order Magnus expansion with two Gauss nodes, ``θ = h(ω₁+ω₂)/2 − (√3/12)h²(ω₁×ω₂)``, each step
an exponential map. The force at the lever arm ``l`` is ``Rᵀ(a + g ẑ + ω̇ × l + ω × (ω × l))``.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.progress import Progress, silent
from processing.simulation.drive import DrivePlan
from processing.simulation.motion import GRAVITY_MPS2, TrueMotion, chained, rates_from_turns
from processing.simulation.route import RoutePoints, SmoothRoute
from processing.simulation.scenario import Ball
from processing.simulation.smooth import step
from processing.simulation.wander import Wander, gauss_markov
from processing.survey import FloatArray

_UP = np.array([0.0, 0.0, 1.0])
INNER_RATE_HZ = 400.0  # Magnus steps: the error of fourth order is below 1e-9 rad a second at 20 rad/s
_BLOCK = 40_000  # IMU samples at a time: bounds the memory
_SLIDE_RAMP_M = 0.3  # over which rolling goes over into sliding
_H = 5e-4  # half the span of the central difference for ω̇; ω is smooth over tens of milliseconds


@dataclass(frozen=True)
class Rolling:
    """How a ball rolls: everything that its angular velocity depends on."""

    ball: Ball
    route: SmoothRoute
    plan: DrivePlan
    slip: Wander
    spin: Wander

    def _slid(self, t: FloatArray, chainage_m: FloatArray) -> FloatArray:
        """Return the share (n,) of the way that is slid: the usual slip, and within a slide more."""
        slip = self.slip(t)
        for slide in self.ball.slides:
            ramp = min(_SLIDE_RAMP_M, 0.5 * (slide.to_m - slide.from_m))
            within = np.minimum(chainage_m - slide.from_m, slide.to_m - chainage_m) / ramp
            slip = slip + (1.0 - slip) * slide.share * step(np.clip(within, 0.0, 1.0))
        return slip

    def rates_w(self, t: FloatArray) -> FloatArray:
        """Return (n, 3) the angular velocity in the world at times ``t`` (n,)."""
        return self.turning(t)[0]

    def turning(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return (n, 3) the angular velocity in the world, and (n,) the speed at which the surface rolls."""
        going = self.plan.at(t)
        where = self.route.points(going.chainage_m)
        normal = self._normal(where, going.speed_mps)
        rolled_mps = going.speed_mps * (1 - self._slid(t, going.chainage_m))
        stuck = self.plan.turning_on_the_spot(t)
        if stuck is not None:
            rolled_mps = rolled_mps + stuck * self.ball.radius_m
        rolled = rolled_mps / self.ball.radius_m
        spin = self.spin(t) * going.speed_mps / self.plan.nominal_mps
        return np.asarray(rolled[:, None] * np.cross(normal, where.tangent_w) + spin[:, None] * normal), rolled_mps

    def _normal(self, where: RoutePoints, speed_mps: FloatArray) -> FloatArray:
        """Contact normal: against gravity (and, banked, against the centrifugal force), square to the way."""
        up = np.broadcast_to(GRAVITY_MPS2 * _UP, where.tangent_w.shape)
        if self.ball.bank:
            up = up + (speed_mps**2)[:, None] * where.curvature_w_pm
        along = np.sum(up * where.tangent_w, axis=1, keepdims=True)
        square = up - along * where.tangent_w
        return np.asarray(square / np.linalg.norm(square, axis=1, keepdims=True))


def rolling_of(ball: Ball, route: SmoothRoute, plan: DrivePlan, rng: np.random.Generator) -> Rolling:
    """Draw slip and spin for a run."""
    span = (0.0, plan.duration_s)
    wander = gauss_markov(span, ball.slip_sigma, ball.slip_tau_s, rng)
    spin = gauss_markov(span, ball.spin_sigma_radps, ball.spin_tau_s, rng)
    return Rolling(ball, route, plan, lambda t: ball.slip + wander(t), spin)


def roll(
    rolling: Rolling,
    rate_hz: float,
    gyro_sampling: str,
    start_quat_ws: FloatArray,
    progress: Progress | None = None,
    inner_rate_hz: float = INNER_RATE_HZ,
) -> TrueMotion:
    """Return the true motion at ``rate_hz`` from time 0 to the end of the plan, integrated at ``inner_rate_hz``."""
    progress = progress or silent()
    count = int(np.floor(rolling.plan.duration_s * rate_hz)) + 1
    time_s = np.arange(count) / rate_hz
    quats, turned = np.empty((count, 4)), np.zeros(count)
    quats[0] = start_quat_ws
    for first in range(0, count - 1, _BLOCK):
        last = min(first + _BLOCK, count - 1)
        q, phi = _attitudes(rolling, time_s[first : last + 1], quats[first], inner_rate_hz)
        quats[first + 1 : last + 1] = q
        turned[first + 1 : last + 1] = turned[first] + phi
        progress.update(0.5 * last / count)
    motion = _at_instants(rolling, time_s, quats, turned, progress.part(0.5, 1.0))
    if gyro_sampling == "increment":
        gyr = rates_from_turns(quats, 1.0 / rate_hz)
        return TrueMotion(**{**vars(motion), "gyr_s_radps": gyr})
    return motion


def _attitudes(
    rolling: Rolling, time_s: FloatArray, start: FloatArray, inner_rate_hz: float
) -> tuple[FloatArray, FloatArray]:
    """Return attitudes (n, 4) and rolled angle (n,) at ``time_s[1:]``, from attitude ``start`` at ``time_s[0]``."""
    period = float(time_s[1] - time_s[0])
    inner = max(int(np.ceil(inner_rate_hz * period)), 1)
    h = period / inner
    lefts = (time_s[:-1, None] + h * np.arange(inner)).ravel()
    nodes = [lefts + (0.5 + sign * np.sqrt(3) / 6) * h for sign in (-1, 1)]
    (first, rolled0), (second, rolled1) = (rolling.turning(t) for t in nodes)
    theta = 0.5 * h * (first + second) - np.sqrt(3) / 12 * h**2 * np.cross(first, second)
    quats = chained(qt.exp_map(theta), start)[inner - 1 :: inner]
    rolled = 0.5 * h * (rolled0 + rolled1) / rolling.ball.radius_m
    return quats, np.cumsum(rolled)[inner - 1 :: inner]


def _at_instants(
    rolling: Rolling, time_s: FloatArray, quats: FloatArray, turned: FloatArray, progress: Progress
) -> TrueMotion:
    count = len(time_s)
    chainage, speed = np.empty(count), np.empty(count)
    position, force, gyr = (np.empty((count, 3)) for _ in range(3))
    arm_s = np.asarray(rolling.ball.lever_arm_s_m, dtype=np.float64)
    for first in range(0, count, _BLOCK):
        rows = slice(first, min(first + _BLOCK, count))
        t = time_s[rows]
        going = rolling.plan.at(t)
        where = rolling.route.points(going.chainage_m)
        omega = rolling.rates_w(t)
        omega_dot = (rolling.rates_w(t + _H) - rolling.rates_w(t - _H)) / (2 * _H)
        arm = qt.rotate(quats[rows], arm_s)
        acc = going.acc_mps2[:, None] * where.tangent_w + (going.speed_mps**2)[:, None] * where.curvature_w_pm
        felt = acc + GRAVITY_MPS2 * _UP + np.cross(omega_dot, arm) + np.cross(omega, np.cross(omega, arm))
        chainage[rows], speed[rows], position[rows] = going.chainage_m, going.speed_mps, where.position_w_m
        force[rows] = qt.rotate_inverse(quats[rows], felt)
        gyr[rows] = qt.rotate_inverse(quats[rows], omega)
        progress.update(rows.stop / count)
    return TrueMotion(time_s, chainage, speed, position, quats, force, gyr, turned)
