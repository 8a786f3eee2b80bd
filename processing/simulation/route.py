"""A polyline with corners rounded so smoothly that its curvature is continuous, by arc length.

Within a bend of turning angle θ and length ``L = 2θR`` the tangent turns by ``φ(u) = θ(u − sin 2πu/2π)``, ``u = s/L``:
the curvature ``(θ/L)(1 − cos 2πu)`` starts and ends at zero and peaks at ``1/R``. A jump in curvature would be a jump
in acceleration, which no sampled sensor records faithfully.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from processing.simulation.scenario import PipeRoute
from processing.survey import FloatArray

_TABLE = 1025  # points of the position table of a bend: cubic Hermite between them is exact to 1e-12 of its length


@dataclass(frozen=True)
class RoutePoints:
    """Where on the line: ``position_w_m``, unit ``tangent_w``, ``curvature_w_pm`` (d tangent/ds), each (n, 3)."""

    position_w_m: FloatArray
    tangent_w: FloatArray
    curvature_w_pm: FloatArray


@dataclass(frozen=True)
class _Line:
    start_w_m: FloatArray
    along_w: FloatArray
    length_m: float

    def points(self, s: FloatArray) -> RoutePoints:
        position = self.start_w_m + s[:, None] * self.along_w
        return RoutePoints(position, np.broadcast_to(self.along_w, position.shape), np.zeros_like(position))


@dataclass(frozen=True)
class _Bend:
    start_w_m: FloatArray
    along_w: FloatArray
    aside_w: FloatArray
    angle_rad: float
    length_m: float

    @cached_property
    def _table(self) -> FloatArray:
        return self.length_m * _unit_bend(self.angle_rad)

    @property
    def end_w_m(self) -> FloatArray:
        x, y = self._table[-1]
        return np.asarray(self.start_w_m + x * self.along_w + y * self.aside_w)

    def points(self, s: FloatArray) -> RoutePoints:
        u = np.clip(s / self.length_m, 0.0, 1.0)
        phi = _turned(u, self.angle_rad)
        kappa = self.angle_rad / self.length_m * (1 - np.cos(2 * np.pi * u))
        cos, sin = np.cos(phi)[:, None], np.sin(phi)[:, None]
        xy = self._hermite(u)
        return RoutePoints(
            self.start_w_m + xy[:, :1] * self.along_w + xy[:, 1:] * self.aside_w,
            cos * self.along_w + sin * self.aside_w,
            kappa[:, None] * (cos * self.aside_w - sin * self.along_w),
        )

    def _hermite(self, u: FloatArray) -> FloatArray:
        step = 1.0 / (_TABLE - 1)
        i = np.minimum((u / step).astype(np.int64), _TABLE - 2)
        f = (u / step - i)[:, None]
        p0, p1 = self._table[i], self._table[i + 1]
        m0, m1 = (self._slope((i + k) * step) * step for k in (0, 1))
        return np.asarray(
            (1 + 2 * f) * (1 - f) ** 2 * p0 + f * (1 - f) ** 2 * m0 + f**2 * (3 - 2 * f) * p1 - f**2 * (1 - f) * m1
        )

    def _slope(self, u: FloatArray) -> FloatArray:
        phi = _turned(u, self.angle_rad)
        return self.length_m * np.stack([np.cos(phi), np.sin(phi)], axis=1)


def _turned(u: FloatArray, angle_rad: float) -> FloatArray:
    return np.asarray(angle_rad * (u - np.sin(2 * np.pi * u) / (2 * np.pi)))


def _unit_bend(angle_rad: float) -> FloatArray:
    """Return (n, 2): where a bend of length 1 that starts along x has come to; each step by Gauss' 3-point rule."""
    step = 1.0 / (_TABLE - 1)
    left = np.arange(_TABLE - 1) * step
    steps = np.zeros((_TABLE - 1, 2))
    for node, weight in ((0.5 - np.sqrt(0.15), 5 / 18), (0.5, 8 / 18), (0.5 + np.sqrt(0.15), 5 / 18)):
        phi = _turned(left + node * step, angle_rad)
        steps += weight * step * np.stack([np.cos(phi), np.sin(phi)], axis=1)
    return np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


class SmoothRoute:
    """The rounded line; ``points(s)`` evaluates it at arc lengths, held at its ends beyond them."""

    def __init__(self, points_m: FloatArray, bend_radius_m: float) -> None:
        """Round the corners of ``points_m`` (n, 3); raises ValueError for coincident points or a hairpin > 170°."""
        corners = _without_straight_corners(np.asarray(points_m, dtype=np.float64))
        self._pieces = _pieces(corners, bend_radius_m)
        self._starts = np.concatenate([[0.0], np.cumsum([p.length_m for p in self._pieces])])

    @property
    def length_m(self) -> float:
        """Arc length from end to end."""
        return float(self._starts[-1])

    @property
    def bends_m(self) -> tuple[tuple[float, float], ...]:
        """Chainage of the middle and turning angle (rad) of each bend."""
        return tuple(
            (float(start + piece.length_m / 2), piece.angle_rad)
            for start, piece in zip(self._starts, self._pieces)
            if isinstance(piece, _Bend)
        )

    def points(self, s_m: FloatArray) -> RoutePoints:
        """Return position, tangent and curvature at arc lengths ``s_m`` (n,)."""
        s = np.clip(np.asarray(s_m, dtype=np.float64), 0.0, self.length_m)
        which = np.clip(np.searchsorted(self._starts, s, side="right") - 1, 0, len(self._pieces) - 1)
        out = RoutePoints(*(np.empty((len(s), 3)) for _ in range(3)))
        for index in np.flatnonzero(np.bincount(which)):
            here = which == index
            part = self._pieces[index].points(s[here] - self._starts[index])
            out.position_w_m[here] = part.position_w_m
            out.tangent_w[here] = part.tangent_w
            out.curvature_w_pm[here] = part.curvature_w_pm
        return out


def _without_straight_corners(points_m: FloatArray) -> FloatArray:
    if len(points_m) < 2:
        raise ValueError("a route needs at least two points")
    legs = np.diff(points_m, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    if np.any(lengths < 1e-6):
        raise ValueError("a route may not have two neighbouring points at the same place")
    ways = legs / lengths[:, None]
    bent = np.linalg.norm(np.cross(ways[:-1], ways[1:]), axis=1) > 1e-7
    bent |= np.sum(ways[:-1] * ways[1:], axis=1) < 0
    return np.asarray(points_m[np.concatenate([[True], bent, [True]])])


def _pieces(corners: FloatArray, bend_radius_m: float) -> list[_Line | _Bend]:
    legs = np.diff(corners, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    ways = legs / lengths[:, None]
    pieces: list[_Line | _Bend] = []
    at = corners[0]
    for i in range(1, len(corners) - 1):
        aside = ways[i] - ways[i] @ ways[i - 1] * ways[i - 1]
        angle = float(np.arctan2(np.linalg.norm(aside), ways[i] @ ways[i - 1]))
        if angle > np.radians(170.0):
            raise ValueError(f"the route turns back on itself at point {i + 1}")
        x, y = _unit_bend(angle)[-1]
        setback = float(x - y / np.tan(angle))  # of a bend of length 1
        # neighbours share a side: each bend may use a little less than half of it, even where that tightens it
        length = min(2 * angle * bend_radius_m, 0.48 * float(min(lengths[i - 1], lengths[i])) / setback)
        start = corners[i] - setback * length * ways[i - 1]
        pieces.append(_Line(at, ways[i - 1], float(np.linalg.norm(start - at))))
        bend = _Bend(start, ways[i - 1], aside / np.linalg.norm(aside), angle, length)
        pieces.append(bend)
        at = bend.end_w_m
    pieces.append(_Line(at, ways[-1], float(np.linalg.norm(corners[-1] - at))))
    return pieces


def centre_line(pipe: PipeRoute) -> SmoothRoute:
    """Return the pipe's centre line; raises ValueError for a route that cannot be."""
    points = np.asarray(pipe.points_m, dtype=np.float64)
    if pipe.closed:
        points = np.vstack([points, points[:1]])
    return route_of_length(points, pipe.bend_radius_m, pipe.length_m)


def route_of_length(points_m: FloatArray, bend_radius_m: float, length_m: float | None) -> SmoothRoute:
    """Return the rounded line, scaled about its first point until it is ``length_m`` long (None: as it is)."""
    points = np.asarray(points_m, dtype=np.float64)
    if length_m is None:
        return SmoothRoute(points, bend_radius_m)
    return SmoothRoute(scaled_to_length(points, bend_radius_m, length_m), bend_radius_m)


def scaled_to_length(points_m: FloatArray, bend_radius_m: float, length_m: float) -> FloatArray:
    """Return the points, scaled about the first, whose rounded line is ``length_m`` long."""
    points = np.asarray(points_m, dtype=np.float64)
    route, scale = SmoothRoute(points, bend_radius_m), 1.0
    for _ in range(60):  # what rounding cuts off does not grow with the scale: a contraction, far below 1e-10 in 60
        scale *= length_m / route.length_m
        route = SmoothRoute(points[0] + scale * (points - points[0]), bend_radius_m)
        if abs(route.length_m - length_m) < 1e-10 * length_m:
            break
    return np.asarray(points[0] + scale * (points - points[0]))
