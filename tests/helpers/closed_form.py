"""The peer of the smoother, for tests: every tie at once, in closed form, for errors that are random walks.

How the errors of a free path hang together: one Gaussian process with all its covariances in closed form.

The errors are a scale κ (radius, slip), a heading offset and drift rate, a heading walk, a slip walk along and a
smaller one across the way, a slope and a height walk. Chainage and place depend linearly on them, through integrals
along the path that are cumulated once. So the covariance between any two moments costs nothing, and the posterior
given n ties is exact (the same as that of a Kalman smoother over all rows) at a cost linear in rows and in n².

With p the path, J = ẑ × p its derivative by the heading, G = ∫ t dJ that by the drift rate, Q the cumulated variance of
the heading walk, A = ∫ J dQ and B = ∫ J Jᵀ dQ, the walk gives for moments i, j and m the earlier of them
``Cov(e_i, e_j) = Q_m J_i J_jᵀ − J_i A_mᵀ − A_m J_jᵀ + B_m``.
"""

from dataclasses import dataclass

import numpy as np

from processing.position.odometry import Odometry, Rows, cumulated, directions
from processing.position.ties import Observation
from processing.position.whole_track import outer
from processing.survey import FloatArray


@dataclass(frozen=True)
class Sigmas:
    """1-sigma of the constant errors: scale, heading offset (rad), drift rate (rad/s), slope, start (m)."""

    scale: float
    heading_rad: float
    drift_radps: float
    slope: float
    start_m: float


@dataclass(frozen=True)
class Walks:
    """Cumulated variances (m,) of the walks along, across, up (m²) and of the heading (rad²)."""

    along_m2: FloatArray
    cross_m2: FloatArray
    up_m2: FloatArray
    heading_rad2: FloatArray


class ErrorModel:
    """Covariances of the errors of one nominal path: times (m,), level path (m, 2), chainage (m,)."""

    def __init__(
        self,
        time_s: FloatArray,
        level_m: FloatArray,
        scaled_m: FloatArray,
        chainage_m: FloatArray,
        sigmas: Sigmas,
        walks: Walks,
    ) -> None:
        self.sigmas, self.walks = sigmas, walks
        self.since_s = time_s - time_s[0]
        self.chainage_m = chainage_m
        self.scaled_m = scaled_m  # derivative of the path by the scale (m, 2)
        self.turn_m = np.column_stack([-level_m[:, 1], level_m[:, 0]])  # J (m, 2)
        step_j = np.diff(self.turn_m, axis=0)
        middle_s = 0.5 * (self.since_s[1:] + self.since_s[:-1])
        self.drift_ms = cumulated(step_j * middle_s[:, None])  # G (m, 2)
        step_q = np.diff(walks.heading_rad2)
        middle_j = 0.5 * (self.turn_m[1:] + self.turn_m[:-1])
        self.walk_a = cumulated(middle_j * step_q[:, None])  # A (m, 2)
        self.walk_b = cumulated(outer(middle_j) * step_q[:, None])  # B (m, 3): xx, xy, yy
        self.direction = directions(level_m)  # (m − 1, 2) of each step
        across = np.column_stack([-self.direction[:, 1], self.direction[:, 0]])
        step_a, step_c = np.diff(walks.along_m2)[:, None], np.diff(walks.cross_m2)[:, None]
        self.slip_e = cumulated(self.direction * step_a)  # E = ∫ u dW (m, 2)
        self.side_f = cumulated(across * step_c)  # F = ∫ n dW' (m, 2)
        self.place_d = cumulated(outer(self.direction) * step_a + outer(across) * step_c)  # D (m, 3)

    def chainage_chainage(self, i: Rows, j: int) -> FloatArray:
        """Cov(c_i, c_j) (k,)."""
        m = np.minimum(i, j)
        s = self.sigmas
        return np.asarray(s.scale**2 * self.chainage_m[i] * self.chainage_m[j] + self.walks.along_m2[m] + s.start_m**2)

    def chainage_place(self, i: Rows, j: int, swap: bool = False) -> FloatArray:
        """Cov(c_i, e_j) (k, 2); with ``swap`` Cov(e_i, c_j)."""
        m = np.minimum(i, j)
        scale2 = self.sigmas.scale**2
        if swap:
            return np.asarray(scale2 * self.scaled_m[i] * self.chainage_m[j] + self.slip_e[m])
        return np.asarray(scale2 * self.chainage_m[i][:, None] * self.scaled_m[j] + self.slip_e[m])

    def place_place(self, i: Rows, j: "int | Rows") -> FloatArray:
        """Cov(e_i, e_j) (k, 2, 2); ``j`` may be one row or as many as ``i``."""
        m = np.minimum(i, j)
        s = self.sigmas
        ji, jj, q = self.turn_m[i], self.turn_m[j], self.walks.heading_rad2[m]
        a = self.walk_a[m]
        out = s.scale**2 * _product(self.scaled_m[i], self.scaled_m[j])
        out = out + s.drift_radps**2 * _product(self.drift_ms[i], self.drift_ms[j])
        out += (s.heading_rad**2 + q)[:, None, None] * _product(ji, jj)
        out -= _product(ji, a) + _product(a, jj)
        out += _square(self.walk_b[m] + self.place_d[m]) + s.start_m**2 * np.eye(2)
        return np.asarray(out)

    def up_up(self, i: Rows, j: "int | Rows") -> FloatArray:
        """Cov(z_i, z_j) (k,)."""
        m = np.minimum(i, j)
        s = self.sigmas
        slope = s.slope**2 * self.chainage_m[i] * self.chainage_m[j]
        return np.asarray(slope + self.walks.up_m2[m] + s.start_m**2)

    def heading_place(self, i: Rows, j: int) -> FloatArray:
        """Cov(ψ_i, e_j) (k, 2)."""
        m = np.minimum(i, j)
        s = self.sigmas
        out = s.heading_rad**2 * self.turn_m[j] + s.drift_radps**2 * self.since_s[i][:, None] * self.drift_ms[j]
        return np.asarray(out + self.walks.heading_rad2[m][:, None] * self.turn_m[j] - self.walk_a[m])

    def heading_variance(self) -> FloatArray:
        """Var(ψ) (m,)."""
        s = self.sigmas
        return np.asarray(s.heading_rad**2 + (s.drift_radps * self.since_s) ** 2 + self.walks.heading_rad2)


def _square(packed: FloatArray) -> FloatArray:
    return np.asarray(packed[:, [0, 1, 1, 2]].reshape(-1, 2, 2))


def _product(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., :, None] * b[..., None, :])


TURNS = 20
_STILL_M = 1e-3
_BLOCK_ROWS = 20_000


@dataclass(frozen=True)
class Deviation:
    """Mean of the errors given the ties, at all rows: what is added to the free path."""

    scale: float
    heading_rad: FloatArray
    along_m: FloatArray
    cross_m: FloatArray
    up_m: FloatArray


@dataclass(frozen=True)
class Path:
    """A nominal path: ``level_m`` (m, 2) and its derivative by the scale, ``up_m`` (m,)."""

    level_m: FloatArray
    scaled_m: FloatArray
    up_m: FloatArray


@dataclass(frozen=True)
class Solution:
    """The last linear problem: model, ties, their weights ``alpha`` and the inverse of their covariance."""

    model: ErrorModel
    ties: tuple[Observation, ...]
    deviation: Deviation
    path: Path
    inverse: FloatArray
    alpha: FloatArray
    turns: int


def solve(odometry: Odometry, ties: tuple[Observation, ...], sigmas: Sigmas) -> Solution:
    """Solve for the errors, again around each new path until the path stands still."""
    walks = Walks(odometry.along_var_m2, odometry.cross_var_m2, odometry.up_var_m2, odometry.heading_var_rad2)
    zero = np.zeros(len(odometry.time_s))
    deviation = Deviation(0.0, zero, zero, zero, zero)
    path = _integrated(odometry, deviation)
    turns = 0
    while True:
        turns += 1
        model = ErrorModel(odometry.time_s, path.level_m, path.scaled_m, odometry.chainage_m, sigmas, walks)
        residual = _residual(odometry, ties, path, deviation, model)
        inverse = _inverse(model, ties)
        alpha = inverse @ residual
        deviation = _mean(model, ties, alpha, zero)
        new = _integrated(odometry, deviation)
        moved = float(np.max(np.hypot(*(new.level_m - path.level_m).T)))
        path = new
        if not any(t.is_place for t in ties) or moved < _STILL_M or turns == TURNS:
            return Solution(model, ties, deviation, path, inverse, alpha, turns)


def _integrated(odometry: Odometry, deviation: Deviation) -> Path:
    """The nominal path of a deviation: the free steps turned, scaled, and moved by the slip."""
    free = np.diff(odometry.position_w_m[:, :2], axis=0)
    turn = 0.5 * (deviation.heading_rad[1:] + deviation.heading_rad[:-1])
    cos, sin = np.cos(turn), np.sin(turn)
    up = odometry.position_w_m[:, 2] + deviation.up_m
    if not odometry.follows_slope:  # the way goes up and down: seen from above it is shorter
        rolled = np.diff(odometry.chainage_m) * (1.0 + deviation.scale)
        slope = np.where(rolled > 1e-6, np.diff(up) / np.maximum(rolled, 1e-6), 0.0)
        free = free * np.sqrt(1.0 - np.clip(slope, -0.9, 0.9) ** 2)[:, None]
    step = np.column_stack([cos * free[:, 0] - sin * free[:, 1], sin * free[:, 0] + cos * free[:, 1]])
    ahead = directions(cumulated(step))
    side = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    slip = ahead * np.diff(deviation.along_m)[:, None] + side * np.diff(deviation.cross_m)[:, None]
    return Path(cumulated((1.0 + deviation.scale) * step + slip), cumulated(step), up)


def _residual(
    odometry: Odometry, ties: tuple[Observation, ...], path: Path, deviation: Deviation, model: ErrorModel
) -> FloatArray:
    """Observed minus nominal, plus the linear effect of the deviation already taken: the residual from the prior."""
    turn = 0.5 * (deviation.heading_rad[1:] + deviation.heading_rad[:-1])[:, None]
    side = np.column_stack([-model.direction[:, 1], model.direction[:, 0]])
    effect = deviation.scale * path.scaled_m + cumulated(
        turn * np.diff(model.turn_m, axis=0)
        + model.direction * np.diff(deviation.along_m)[:, None]
        + side * np.diff(deviation.cross_m)[:, None]
    )
    out = []
    for tie in ties:
        if not tie.is_place:
            out.append(tie.value - odometry.chainage_m[tie.row])
            continue
        out.append(tie.value[:2] - path.level_m[tie.row] + effect[tie.row])
        out.append(tie.value[2:] - odometry.position_w_m[tie.row, 2])
    return np.concatenate([*out, np.empty(0)])


def _inverse(model: ErrorModel, ties: tuple[Observation, ...]) -> FloatArray:
    """Inverse of the covariance of all observed values."""
    size = sum(len(t.value) for t in ties)
    covariance = np.zeros((size, size))
    at = 0
    for tie in ties:
        rows = np.array([t.row for t in ties])
        cross = _cross(model, rows, tie)
        to = 0
        for k, other in enumerate(ties):
            n = len(other.value)
            columns = slice(at, at + len(tie.value))
            if not other.is_place:
                covariance[to, columns] = cross.chainage[k]
            else:
                covariance[to : to + 2, columns] = cross.place[k]
                covariance[to + 2 : to + n, columns] = cross.up[k] if n == 3 else 0.0
            to += n
        covariance[at : at + len(tie.value), at : at + len(tie.value)] += tie.covariance_m2
        at += len(tie.value)
    if size == 0:
        return covariance
    scale = 1.0 / np.sqrt(np.diag(covariance))  # unit diagonal: metres of a long run and centimetres meet here
    balanced = 0.5 * (covariance + covariance.T) * np.outer(scale, scale)
    return np.asarray(np.linalg.inv(balanced) * np.outer(scale, scale))


@dataclass(frozen=True)
class _Cross:
    """Covariances of the errors at k rows with the n values of one tie: (k, n), place (k, 2, n)."""

    chainage: FloatArray
    place: FloatArray
    up: FloatArray


def _cross(model: ErrorModel, rows: Rows, tie: Observation) -> _Cross:
    count, size = len(rows), len(tie.value)
    up = np.zeros((count, size))
    if not tie.is_place:
        return _Cross(
            model.chainage_chainage(rows, tie.row)[:, None],
            model.chainage_place(rows, tie.row, swap=True)[:, :, None],
            up,
        )
    chainage, place = np.zeros((count, size)), np.zeros((count, 2, size))
    chainage[:, :2] = model.chainage_place(rows, tie.row)
    place[:, :, :2] = model.place_place(rows, tie.row)
    if size == 3:
        up[:, 2] = model.up_up(rows, tie.row)
    return _Cross(chainage, place, up)


def _mean(model: ErrorModel, ties: tuple[Observation, ...], alpha: FloatArray, zero: FloatArray) -> Deviation:
    """Mean of each error at all rows given the ties: its covariances with them, times their weights."""
    rows = np.arange(len(zero))
    scale, heading, along, cross, up = 0.0, zero.copy(), zero.copy(), zero.copy(), zero.copy()
    at = 0
    for tie in ties:
        weight = alpha[at : at + len(tie.value)]
        at += len(tie.value)
        first = np.minimum(rows, tie.row)
        if not tie.is_place:
            scale += model.sigmas.scale**2 * float(model.chainage_m[tie.row] * weight[0])
            along += model.walks.along_m2[first] * weight[0]
            continue
        scale += model.sigmas.scale**2 * float(model.scaled_m[tie.row] @ weight[:2])
        heading += model.heading_place(rows, tie.row) @ weight[:2]
        along += model.slip_e[first] @ weight[:2]
        cross += model.side_f[first] @ weight[:2]
        if len(weight) == 3:
            up += model.up_up(rows, tie.row) * weight[2]
    return Deviation(scale, heading, along, cross, up)


@dataclass(frozen=True)
class Spread:
    """Posterior variances (m,) along (of the chainage), across the way and up, and of the place: EE, EN, NN (m, 3)."""

    along_m2: FloatArray
    cross_m2: FloatArray
    up_m2: FloatArray
    level_m2: FloatArray


def variances(solution: Solution) -> Spread:
    """Return what the errors may still be, given the ties, at all rows."""
    model = solution.model
    count = len(model.chainage_m)
    along, up, level = np.empty(count), np.empty(count), np.empty((count, 2, 2))
    ahead = np.vstack([model.direction, model.direction[-1:]])
    side = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    # S⁻¹ = L Lᵀ, so what the ties take off is the squared size of K L
    root = np.linalg.cholesky(solution.inverse) if len(solution.alpha) else np.zeros((0, 0))
    for start in range(0, count, _BLOCK_ROWS):
        rows = np.arange(start, min(start + _BLOCK_ROWS, count))
        level[rows] = model.place_place(rows, rows)
        along[rows] = (
            (model.sigmas.scale * model.chainage_m[rows]) ** 2 + model.walks.along_m2[rows] + model.sigmas.start_m**2
        )
        up[rows] = model.up_up(rows, rows)
        if not solution.ties:
            continue
        parts = [_cross(model, rows, tie) for tie in solution.ties]
        along[rows] -= np.sum((np.hstack([p.chainage for p in parts]) @ root) ** 2, axis=1)
        known = np.concatenate([p.place for p in parts], axis=2) @ root
        level[rows] -= known @ known.transpose(0, 2, 1)
        up[rows] -= np.sum((np.hstack([p.up for p in parts]) @ root) ** 2, axis=1)
    cross = np.einsum("ki,kij,kj->k", side, level, side)
    packed = level.reshape(-1, 4)[:, [0, 1, 3]] + 1e-6 * np.array([1.0, 0.0, 1.0])
    return Spread(np.maximum(along, 1e-6), np.maximum(cross, 1e-6), np.maximum(up, 1e-6), packed)
