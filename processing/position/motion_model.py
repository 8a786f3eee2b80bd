"""How a rolling or carried device's errors go on from keyframe to keyframe, as a chain of unknowns.

The unknowns of the level chain at each keyframe are: scale κ (radius, one for the run), slip s (a share of the way,
first-order Gauss–Markov), chainage c, the clock of the tie points τ, place east and north, heading ψ and its drift b
(first-order Gauss–Markov about zero: gyro bias and scale as they drift). Between two keyframes, with the way ΔC, the
free step D and its late part M (:mod:`processing.position.keyframes`)::

    c += (1 + κ) ΔC + ∫ s dC + w_c              w_c: slip that is not s, a random walk in the way
    p += (1 + κ + s̄) (R(ψ) (D − M) + R(ψ') M) + w_c t + w_n n      t, n: unit vectors along and across
    ψ' = ψ + ∫ b dt + w_ψ

with ψ' the heading at the later one: exact in c, linearised in p about a nominal path. The height has a chain of its
own: it does not act on the level one but by shortening the way seen from above.
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.position.chain import Chain
from processing.position.keyframes import Keyframes
from processing.survey import FloatArray

SCALE, SLIP, WAY, CLOCK, EAST, NORTH, TURN, DRIFT = range(8)
LEVEL_SIZE = 8


@dataclass(frozen=True)
class Prior:
    """1-sigmas of what is not known beforehand: constants of the run and the stationary wanderings."""

    scale: float
    heading_rad: float
    drift_radps: float
    slope: float
    start_m: float
    clock_s: float
    drift_tau_s: float


@dataclass(frozen=True)
class Levels:
    """Factors on the variances of slip (with all that wanders along and across) and of the heading's noise."""

    slip: float = 1.0
    heading: float = 1.0


@dataclass(frozen=True)
class Nominal:
    """The path about which the level chain is linearised: heading, slip (k,), scale, and what else moved (k − 1, 2)."""

    turn_rad: FloatArray
    slip: FloatArray
    scale: float
    extra_m: FloatArray
    place_m: FloatArray  # (k, 2)


@dataclass(frozen=True)
class LevelModel:
    """A level chain taken apart: what the levels of noise do not change, and the noises that they scale."""

    chain: Chain  # without noise
    slip_noise: FloatArray  # (k − 1, d, d)
    heading_noise: FloatArray
    lost_noise: FloatArray | None
    slip_prior: FloatArray  # (d, d)
    heading_prior: FloatArray

    def at(self, levels: Levels) -> Chain:
        """Return the chain with the noise of ``levels``."""
        noise = levels.slip * self.slip_noise
        noise += levels.heading * self.heading_noise
        if self.lost_noise is not None:
            noise += self.lost_noise
        return replace(
            self.chain,
            noise=noise,
            prior_cov=self.chain.prior_cov + levels.slip * self.slip_prior + levels.heading * self.heading_prior,
        )


def start_nominal(frames: Keyframes, shorter: FloatArray) -> Nominal:
    """Return the free path itself as nominal; ``shorter`` (k − 1,) is the cosine of its slope."""
    count = len(frames.rows)
    zero = np.zeros(count)
    path = np.concatenate([np.zeros((1, 2)), np.cumsum(frames.free_m * shorter[:, None], axis=0)])
    return Nominal(zero, zero, 0.0, np.zeros((count - 1, 2)), path + frames.odometry.position_w_m[0, :2])


@dataclass(frozen=True)
class _Steps:
    """The linearised steps about a nominal path."""

    base_m: FloatArray  # (k − 1, 2) the turned free step: derivative by the scale
    gain: FloatArray  # (k − 1,) 1 + scale + slip
    by_first: FloatArray  # (k − 1, 2) derivative by the heading at the step's beginning
    by_last: FloatArray  # (k − 1, 2) and by that at its end
    slip_share: FloatArray  # (k − 1,) mean over the step of a slip of 1 at its beginning


def _steps(frames: Keyframes, nominal: Nominal, shorter: FloatArray) -> _Steps:
    first = _turned((frames.free_m - frames.late_m) * shorter[:, None], nominal.turn_rad[:-1])
    last = _turned(frames.late_m * shorter[:, None], nominal.turn_rad[1:])
    a = frames.step_s / frames.odometry.slip_tau_s
    share = -np.expm1(-a) / a
    gain = 1.0 + nominal.scale + share * nominal.slip[:-1]
    return _Steps(
        first + last,
        gain,
        _quarter(gain[:, None] * first + 0.5 * nominal.extra_m),
        _quarter(gain[:, None] * last + 0.5 * nominal.extra_m),
        share,
    )


def level_model(frames: Keyframes, nominal: Nominal, shorter: FloatArray, prior: Prior, size: int) -> LevelModel:
    """Return the level chain about ``nominal`` with room for ``size`` unknowns; those beyond the eight stay put."""
    steps = _steps(frames, nominal, shorter)
    count = len(frames.rows) - 1
    odometry, dt, way = frames.odometry, frames.step_s, frames.way_m
    keep, mean_share = _decay(dt, prior.drift_tau_s)
    f = np.tile(np.eye(size), (count, 1, 1))
    f[:, SLIP, SLIP] = np.exp(-dt / odometry.slip_tau_s)
    f[:, WAY, SCALE], f[:, WAY, SLIP] = way, way * steps.slip_share
    f[:, EAST : NORTH + 1, SCALE] = steps.base_m
    f[:, EAST : NORTH + 1, SLIP] = steps.base_m * steps.slip_share[:, None]
    f[:, EAST : NORTH + 1, TURN] = steps.by_first + steps.by_last
    f[:, EAST : NORTH + 1, DRIFT] = steps.by_last * (dt * mean_share)[:, None]
    f[:, TURN, DRIFT], f[:, DRIFT, DRIFT] = dt * mean_share, keep
    u = np.zeros((count, size))
    u[:, WAY] = way
    u[:, EAST : NORTH + 1] = (
        steps.base_m - steps.by_first * nominal.turn_rad[:-1, None] - steps.by_last * nominal.turn_rad[1:, None]
    )
    mean, cov = np.zeros(size), np.zeros((size, size))
    mean[EAST : NORTH + 1] = nominal.place_m[0]
    for at, sigma in ((SCALE, prior.scale), (WAY, prior.start_m), (CLOCK, prior.clock_s), (TURN, prior.heading_rad)):
        cov[at, at] = sigma**2
    cov[EAST, EAST] = cov[NORTH, NORTH] = prior.start_m**2
    slip_prior, heading_prior = np.zeros((size, size)), np.zeros((size, size))
    slip_prior[SLIP, SLIP] = odometry.slip_sigma**2
    heading_prior[DRIFT, DRIFT] = prior.drift_radps**2
    return LevelModel(
        Chain(f, u, np.zeros((0, size, size)), mean, cov),
        _slip_noise(frames, steps, size),
        _heading_noise(frames, steps, prior, size),
        _lost_noise(frames, steps, size),
        slip_prior,
        heading_prior,
    )


def next_nominal(
    frames: Keyframes, nominal: Nominal, shorter: FloatArray, model: LevelModel, mean: FloatArray
) -> Nominal:
    """Return the path of the smoothed unknowns ``mean`` (k, d) as the next nominal one."""
    old = _steps(frames, nominal, shorter)
    chain = model.chain
    expected = np.einsum("kij,kj->ki", chain.step, mean[:-1]) + chain.shift
    left = mean[1:] - expected
    # what the noise of the heading moved is in the turned steps; the rest is slip that is not in the slip unknown
    extra = left[:, EAST : NORTH + 1] - old.by_last * left[:, TURN, None]
    found = Nominal(mean[:, TURN], mean[:, SLIP], float(mean[0, SCALE]), extra, nominal.place_m)
    steps = _steps(frames, found, shorter)
    moved = np.cumsum(steps.gain[:, None] * steps.base_m + extra, axis=0)
    start = mean[0, EAST : NORTH + 1]
    return replace(found, place_m=np.concatenate([start[None], start + moved]))


def _slip_noise(frames: Keyframes, steps: _Steps, size: int) -> FloatArray:
    """Noise of slip s and of its integral, which moves chainage and place; and of the walks along and across."""
    odometry, way = frames.odometry, frames.way_m
    a = frames.step_s / odometry.slip_tau_s
    keep = np.exp(-a)
    lost = -np.expm1(-a)
    variance = odometry.slip_sigma**2
    # of the integral of a Gauss–Markov process over a step; a short step's digits are lost in the closed form
    square = np.where(a < 1e-2, a * (2.0 / 3.0) - 0.5 * a**2, (2.0 * a - 3.0 + 4.0 * keep - keep**2) / a**2)
    along, across = _unit_steps(frames, steps)
    out = np.zeros((len(way), size, size))
    out[:, SLIP, SLIP] = variance * -np.expm1(-2.0 * a)
    ways = np.zeros((len(way), size))
    ways[:, WAY] = 1.0
    ways[:, EAST : NORTH + 1] = along
    mixed = (variance * way * lost**2 / a)[:, None] * ways
    out[:, SLIP, :] += mixed
    out[:, :, SLIP] += mixed
    _add(out, WAY, variance * way**2 * square + np.diff(odometry.along_var_m2), ways[:, WAY : NORTH + 1])
    _add(out, EAST, np.diff(odometry.cross_var_m2), across)
    return out


def _heading_noise(frames: Keyframes, steps: _Steps, prior: Prior, size: int) -> FloatArray:
    out = np.zeros((len(frames.way_m), size, size))
    _add(out, EAST, np.diff(frames.odometry.heading_var_rad2), _heading_way(steps))
    out[:, DRIFT, DRIFT] += prior.drift_radps**2 * -np.expm1(-2.0 * frames.step_s / prior.drift_tau_s)
    return np.asarray(out)


def _lost_noise(frames: Keyframes, steps: _Steps, size: int) -> FloatArray | None:
    """What gaps and slips may have taken, way and heading; None without any."""
    way, turn = frames.odometry.lost_var_m2, frames.odometry.lost_heading_rad2
    if (way is None or way[-1] <= way[0]) and (turn is None or turn[-1] <= turn[0]):
        return None
    out = np.zeros((len(frames.way_m), size, size))
    if way is not None:
        along, _ = _unit_steps(frames, steps)
        ways = np.zeros((len(along), NORTH + 1 - WAY))
        ways[:, 0] = 1.0
        ways[:, EAST - WAY :] = along
        _add(out, WAY, np.diff(way), ways)
    if turn is not None:
        _add(out, EAST, np.diff(turn), _heading_way(steps))
    return out


def _heading_way(steps: _Steps) -> FloatArray:
    """What a turn at a step's end moves: east, north and the heading itself (k − 1, 3)."""
    return np.column_stack([steps.by_last, np.ones(len(steps.by_last))])


def _add(noise: FloatArray, first: int, variance: FloatArray, way: FloatArray) -> None:
    """Add the noise of one quantity that moves unknowns ``first`` … by ``way`` (k − 1, j)."""
    last = first + way.shape[1]
    noise[:, first:last, first:last] += (variance[:, None] * way)[:, :, None] * way[:, None, :]


def _unit_steps(frames: Keyframes, steps: _Steps) -> tuple[FloatArray, FloatArray]:
    """Directions along (k − 1, 2), as long as the step is straight, and across."""
    way = frames.way_m
    size = np.hypot(*steps.base_m.T)
    rolled = (way > 1e-6) & (size > 1e-9)
    last = np.maximum.accumulate(np.where(size > 1e-9, np.arange(len(way)), -1))
    last[last < 0] = int(np.argmax(size > 1e-9))
    unit = steps.base_m[last] / np.maximum(size[last], 1e-12)[:, None]
    share = np.where(rolled, np.minimum(size / np.where(rolled, way, 1.0), 1.0), 1.0)
    return unit * share[:, None], _quarter(unit)


def _decay(dt: FloatArray, tau_s: float) -> tuple[FloatArray, FloatArray]:
    a = dt / tau_s
    return np.exp(-a), -np.expm1(-a) / a


def _turned(v: FloatArray, angle: FloatArray) -> FloatArray:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.column_stack([cos * v[:, 0] - sin * v[:, 1], sin * v[:, 0] + cos * v[:, 1]])


def _quarter(v: FloatArray) -> FloatArray:
    """Turn vectors (k, 2) by a quarter to the left."""
    return np.column_stack([-v[:, 1], v[:, 0]])
