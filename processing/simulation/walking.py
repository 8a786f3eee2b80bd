"""A sensor on a walking foot: strike on the heel, flat, roll over the toes, swing; still only while the sole stands.

With the toe's contact ``S(t)`` moving along the route in the swings alone, the pitch ``α`` about the toes, ``β`` about
the heel and the tilt ``ρ``, sensor and attitude are closed forms of time,

    p = S + Rz(ψ) [Ry(α) Rx(ρ) T + (Ry(β) − I) Rx(ρ) H],   R = Rz(ψ) Ry(α + β) Rx(ρ),

``T`` and ``H`` from the contacts to the sensor: on the ground one of them is at rest and the sensor turns about it.
Every part has three continuous derivatives; velocity and acceleration are taken by differences of fourth order.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.simulation.events import Blow
from processing.simulation.motion import GRAVITY_MPS2, TrueMotion, rates_from_turns
from processing.simulation.route import SmoothRoute
from processing.simulation.scenario import Drive, Foot
from processing.simulation.smooth import ramped, step
from processing.survey import FloatArray

_H = 5e-4  # step of the differences: their error is below 1e-5 m/s²
_RAMP = 0.42  # share of the swing in which the foot is sped up, and slowed down
_CREEP_S = 0.35
_LONG_S = 1.2  # a foot that stands longer stands still
_SETTLE_S = 0.3
_SWAY_HZ = (0.7, 4.0)
_TONES = 5
_RING = ((0.0, 1.0), (0.014, -0.55), (0.03, 0.3))  # after the strike: time, share of its size
_LEAST_WIDTH_S = 0.005


@dataclass(frozen=True)
class _Strides:
    """Rows of one stride each, n of them: it begins flat on the ground at ``start_s`` and ends at the next strike."""

    start_s: FloatArray
    flat_s: FloatArray
    toe_s: FloatArray
    swing_s: FloatArray
    heel_s: FloatArray
    from_m: FloatArray
    to_m: FloatArray
    lift_m: FloatArray
    toe_rad: FloatArray
    heel_rad: FloatArray
    base_rad: FloatArray
    next_base_rad: FloatArray
    creep_rad: FloatArray
    shock_mps2: FloatArray
    drag_mps2: FloatArray

    def of(self, index: np.ndarray) -> "_Strides":
        """Return the rows of some strides."""
        return _Strides(*(values[index] for values in vars(self).values()))


class Walking:
    """A walk over ``length_m`` of the route, laid out stride by stride; the last row is the rest at the end."""

    def __init__(self, foot: Foot, drive: Drive, route: SmoothRoute, rng: np.random.Generator) -> None:
        """Draw the strides and the sway; ``drive`` gives the rests and the stops."""
        self.foot, self.route = foot, route
        self._strides, self.duration_s = _laid_out(foot, drive, route.length_m, rng)
        self._tones = [
            (rng.uniform(*_SWAY_HZ, _TONES), rng.uniform(0, 2 * np.pi, _TONES), rng.normal(size=_TONES))
            for _ in range(2)
        ]

    def chainage(self, t: FloatArray) -> FloatArray:
        """Return the chainage (n,) of the toe's contact."""
        at = self._at(t)
        moved = ramped(np.clip((t - at.start_s - at.flat_s - at.toe_s) / at.swing_s, 0.0, 1.0), _RAMP)
        return np.asarray(at.from_m + (at.to_m - at.from_m) * moved)

    def flat(self, t: FloatArray) -> np.ndarray:
        """Return where (n,) the sole stands on the ground."""
        at = self._at(t)
        return np.asarray(t - at.start_s < at.flat_s)

    def pose(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return position (n, 3) and attitude (n, 4) of a sensor that points along the foot."""
        at, chainage = self._at(t), self.chainage(t)
        where = self.route.points(chainage)
        alpha, beta, tilt = self._angles(t, at)
        swing = np.clip((t - at.start_s - at.flat_s - at.toe_s) / at.swing_s, 0.0, 1.0)
        level = np.arctan2(where.tangent_w[:, 1], where.tangent_w[:, 0])
        turn = qt.turn_about_up(level - np.radians(self.foot.toe_out_deg))
        aside = np.column_stack([-np.sin(level), np.cos(level), np.zeros(len(t))]) * self.foot.aside_m
        lift = at.lift_m * (4 * swing * (1 - swing)) ** 4
        rolled = _about(0, tilt)
        toe = qt.rotate(qt.multiply(_about(1, alpha), rolled), np.asarray(self.foot.from_toe_m))
        heel = qt.rotate(rolled, np.asarray(self.foot.from_heel_m))
        arm = toe + qt.rotate(_about(1, beta), heel) - heel
        position = where.position_w_m + aside + qt.rotate(turn, arm)
        position[:, 2] += lift
        return position, qt.multiply(turn, qt.multiply(_about(1, alpha + beta), rolled))

    def shocks(self) -> tuple[Blow, ...]:
        """Return the blows of all strikes, which ring."""
        rows = self._strides
        out = []
        for k in range(len(rows.start_s) - 1):
            strike = float(rows.start_s[k] + rows.flat_s[k] + rows.toe_s[k] + rows.swing_s[k])
            for after, share in _RING:
                size = float(rows.shock_mps2[k]) * share
                level = -40.0 + 20 * np.log10(max(abs(size), 1e-3) / 40.0)
                out.append(Blow("step", strike + after, float(rows.to_m[k]), size, float(level), _LEAST_WIDTH_S))
        return tuple(out)

    def scraping(self, t: FloatArray) -> FloatArray:
        """Return the rms (n,) of what the foot feels while it is dragged, m/s²."""
        at = self._at(t)
        u = np.clip((t - at.start_s - at.flat_s - at.toe_s) / at.swing_s, 0.0, 1.0)
        return np.asarray(at.drag_mps2 * np.sqrt(4 * u * (1 - u)))

    def _at(self, t: FloatArray) -> _Strides:
        index = np.searchsorted(self._strides.start_s, t, side="right") - 1
        return self._strides.of(np.clip(index, 0, len(self._strides.start_s) - 1))

    def _angles(self, t: FloatArray, at: _Strides) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Pitch about the toes, pitch about the heel, tilt: each (n,)."""
        since = t - at.start_s
        creep = np.minimum(_CREEP_S, at.flat_s)
        up = at.creep_rad * _risen(since - at.flat_s + creep, creep)
        up += (at.toe_rad - at.creep_rad) * _risen(since - at.flat_s, at.toe_s)
        aloft = since - at.flat_s - at.toe_s
        alpha = up - at.toe_rad * _risen(aloft, 0.6 * at.swing_s)
        alpha += at.base_rad + (at.next_base_rad - at.base_rad) * _risen(aloft, at.swing_s)
        beta = -at.heel_rad * _risen(aloft - 0.5 * at.swing_s, 0.5 * at.swing_s)
        beta += at.heel_rad * _risen(aloft - at.swing_s, at.heel_s)
        # who stands for long stands still
        still = _risen(since, _SETTLE_S) * _risen(at.flat_s - since, _SETTLE_S) * (at.flat_s > _LONG_S)
        size = np.radians(self.foot.sway_deg) * (1.0 - still)
        return alpha + 0.5 * size * _wave(t, self._tones[0]), beta, size * _wave(t, self._tones[1])


def walk(walking: Walking, rate_hz: float, gyro_sampling: str, mounting: FloatArray) -> TrueMotion:
    """Return the true motion at ``rate_hz``; ``mounting`` (4,) turns sensor vectors into the foot's."""
    count = int(np.floor(walking.duration_s * rate_hz)) + 1
    t = np.arange(count) / rate_hz
    poses = [walking.pose(t + k * _H) for k in (-2, -1, 0, 1, 2)]
    (far0, _), (near0, before), (here, foot), (near1, after), (far1, _) = poses
    velocity = (far0 - 8 * near0 + 8 * near1 - far1) / (12 * _H)
    acc = (-far0 + 16 * near0 - 30 * here + 16 * near1 - far1) / (12 * _H**2)
    quats = qt.multiply(foot, mounting)
    chainage = walking.chainage(t)
    if gyro_sampling == "increment":
        gyr = rates_from_turns(quats, 1.0 / rate_hz)
    else:
        turned = qt.multiply(qt.conjugate(qt.multiply(before, mounting)), qt.multiply(after, mounting))
        gyr = qt.log_map(turned) / (2 * _H)
    return TrueMotion(
        time_s=t,
        chainage_m=chainage,
        speed_mps=(walking.chainage(t + _H) - walking.chainage(t - _H)) / (2 * _H),
        position_w_m=here,
        quat_ws=quats,
        force_s_mps2=qt.rotate_inverse(quats, acc + np.array([0.0, 0.0, GRAVITY_MPS2])),
        gyr_s_radps=gyr,
        rotation_rad=np.zeros(count),
        velocity_w_mps=velocity,
        flat=walking.flat(t),
    )


def dragged_w_mps2(walking: Walking, time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return (n, 3) what a scraping foot feels: it comes and goes without leaving a velocity behind."""
    size = walking.scraping(time_s)
    if not np.any(size > 0):
        return np.zeros((len(time_s), 3))
    noise = rng.normal(size=(len(time_s) + 2, 3))
    return np.asarray(size[:, None] * np.diff(noise, 2, axis=0) / np.sqrt(6.0))


def _about(axis: int, angle_rad: FloatArray) -> FloatArray:
    out = np.zeros((len(angle_rad), 4))
    out[:, 0], out[:, 1 + axis] = np.cos(0.5 * angle_rad), np.sin(0.5 * angle_rad)
    return out


def _risen(since_s: FloatArray, span_s: FloatArray | float) -> FloatArray:
    return step(np.clip(since_s / span_s, 0.0, 1.0))


def _wave(t: FloatArray, tones: tuple[FloatArray, FloatArray, FloatArray]) -> FloatArray:
    """A sway (n,) of rms 1."""
    hz, phases, sizes = tones
    out = np.zeros(len(t))
    for f, phase, size in zip(hz, phases, sizes):
        out += size * np.sin(2 * np.pi * f * t + phase)
    return np.asarray(out / np.sqrt(0.5 * np.sum(sizes**2)))


def _laid_out(foot: Foot, drive: Drive, length_m: float, rng: np.random.Generator) -> tuple[_Strides, float]:
    stops = sorted((s for s in drive.stops if 0.0 < s.chainage_m < length_m), key=lambda s: s.chainage_m)
    gaits = sorted(foot.gaits, key=lambda g: g.from_m)
    rows: list[list[float]] = []
    clock, at, rest = 0.0, 0.0, drive.rest_start_s
    while length_m - at > 1e-6:
        gait = [g for g in gaits if g.from_m <= at + 1e-6 or g is gaits[0]][-1]
        want = gait.stride_m * float(np.exp(foot.variation * rng.normal()))
        seconds = gait.stride_s * float(np.exp(foot.variation * rng.normal()))
        want = want if length_m - at > 1.3 * want else length_m - at  # no tiny stride at the end
        shares = (gait.flat_share, gait.toe_share, gait.heel_share)
        flat, toe, heel = (share * seconds for share in shares)
        swing = seconds - flat - toe - heel
        pitch = np.radians([gait.toe_pitch_deg, gait.heel_pitch_deg]) * np.exp(3 * foot.variation * rng.normal(size=2))
        shock = gait.shock_mps2 * float(np.exp(0.3 * rng.normal()))
        rows.append(
            [clock, flat + rest, toe, swing, heel, at, at + want, gait.clearance_m, *pitch,
             np.radians(gait.base_pitch_deg), 0.0, np.radians(gait.creep_deg), shock, gait.drag_mps2]
        )  # fmt: skip
        clock += flat + rest + toe + swing + heel
        at += want
        rest = sum(s.duration_s for s in stops if s.chainage_m <= at)
        stops = [s for s in stops if s.chainage_m > at]
    end = rest + drive.rest_end_s + _CREEP_S
    last_base = rows[-1][10]
    rows.append([clock, end + 1.0, 1.0, 1.0, 1.0, at, at, 0.0, 0.0, 0.0, last_base, last_base, 0.0, 0.0, 0.0])
    table = np.array(rows)
    table[:-1, 11] = table[1:, 10]
    table[0, :2] += [-_SETTLE_S, _SETTLE_S]  # at time 0 the foot stands still already
    return _Strides(*table.T), clock + end
