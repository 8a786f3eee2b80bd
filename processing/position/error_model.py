"""How the errors of a free path hang together: one Gaussian process with all its covariances in closed form.

The errors are a scale κ (radius, slip), a heading offset and drift rate, a heading walk, a slip walk along and a
smaller one across the way, a slope and a height walk. Chainage and place depend linearly on them, through integrals
along the path that are cumulated once. So the covariance between any two moments costs nothing, and the posterior
given n ties is exact (the same as that of a Kalman smoother over all rows) at a cost linear in rows and in n².

With p the path, J = ẑ × p its derivative by the heading, G = ∫ t dJ that by the drift rate, Q the cumulated variance of
the heading walk, A = ∫ J dQ and B = ∫ J Jᵀ dQ, the walk gives for moments i, j and m the earlier of them
``Cov(e_i, e_j) = Q_m J_i J_jᵀ − J_i A_mᵀ − A_m J_jᵀ + B_m``.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from processing.position.odometry import cumulated
from processing.survey import FloatArray

Rows: TypeAlias = npt.NDArray[np.intp]


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


def outer(v: FloatArray) -> FloatArray:
    """Return xx, xy, yy (k, 3) of the products of vectors (k, 2) with themselves."""
    return np.column_stack([v[:, 0] ** 2, v[:, 0] * v[:, 1], v[:, 1] ** 2])


def _square(packed: FloatArray) -> FloatArray:
    return np.asarray(packed[:, [0, 1, 1, 2]].reshape(-1, 2, 2))


def _product(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., :, None] * b[..., None, :])
