"""The mapped route as a line with chainage: place on it by metres, and metres of a place.

The chainage of the route begins at the launch, wherever the map's line begins, and runs the way the device went.
"""

from dataclasses import dataclass

import numpy as np

from processing.coordinates import LocalFrame, route_local
from processing.survey import Finding, FloatArray, Route, Severity


@dataclass(frozen=True)
class RouteLine:
    """``points_w_m`` (k, 3), k ≥ 2, at ``chainage_m`` (k,), strictly increasing; negative before the launch."""

    points_w_m: FloatArray
    chainage_m: FloatArray
    sigma_m: float

    def at(self, chainage_m: FloatArray) -> FloatArray:
        """Return the places (m, 3) at ``chainage_m`` (m,); beyond its ends the route goes straight on."""
        segment = np.clip(np.searchsorted(self.chainage_m, chainage_m, side="right") - 1, 0, len(self.points_w_m) - 2)
        beyond = (chainage_m - self.chainage_m[segment])[:, None]
        return np.asarray(self.points_w_m[segment] + beyond * self._directions()[segment])

    def directions(self, chainage_m: FloatArray) -> FloatArray:
        """Return the unit directions (m, 3) of the route at ``chainage_m`` (m,)."""
        segment = np.clip(np.searchsorted(self.chainage_m, chainage_m, side="right") - 1, 0, len(self.points_w_m) - 2)
        return np.asarray(self._directions()[segment])

    def chainage_of(self, place: tuple[float, float], near_m: float, sigma_m: float) -> tuple[float, float]:
        """Return chainage and distance off the route of a place (east, north).

        Where the route passes it more than once (a loop), the passage nearest to ``near_m`` counts.
        """
        start = self.points_w_m[:-1, :2]
        along = np.diff(self.points_w_m[:, :2], axis=0)
        length2 = np.maximum(np.sum(along**2, axis=1), 1e-12)
        part = np.clip(np.sum((np.asarray(place) - start) * along, axis=1) / length2, 0.0, 1.0)
        off = np.hypot(*(start + part[:, None] * along - np.asarray(place)).T)
        chainage = self.chainage_m[:-1] + part * np.diff(self.chainage_m)
        passages = np.flatnonzero(off <= off.min() + 3.0 * (sigma_m + self.sigma_m))
        # the best place of each passage: of neighbouring segments only the nearest
        passages = passages[[bool(off[p] <= _around(off, chainage, int(p))) for p in passages]]
        best = passages[np.argmin(np.abs(chainage[passages] - near_m))]
        return float(chainage[best]), float(off[best])

    def _directions(self) -> FloatArray:
        step = np.diff(self.points_w_m, axis=0)
        return np.asarray(step / np.linalg.norm(step, axis=1, keepdims=True))


def _around(off: FloatArray, chainage: FloatArray, place: int) -> float:
    near = np.abs(chainage - chainage[place]) < 10.0
    return float(off[near].min())


def route_line(frame: LocalFrame, route: Route | None) -> tuple[RouteLine | None, tuple[Finding, ...]]:
    """Return the route as a line from the launch on, None for a route of fewer than two different points.

    Raises:
        LeaklineError: CRS_UNKNOWN, LAUNCH_INCOMPLETE.
    """
    if route is None:
        return None, ()
    points = route_local(frame, route)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], length > 1e-6])] if len(points) else points
    if len(points) < 2 or not np.all(np.isfinite(points)):
        return None, (Finding("route_too_short", Severity.WARNING),)
    findings: list[Finding] = []
    line = _from_first(points, route.sigma_m)
    launch_m, off_m = line.chainage_of((0.0, 0.0), 0.0, route.sigma_m)
    if launch_m > 0.9 * line.chainage_m[-1]:  # drawn from the retrieval to the launch
        line = _from_first(points[::-1], route.sigma_m)
        launch_m, off_m = line.chainage_of((0.0, 0.0), 0.0, route.sigma_m)
        findings.append(Finding("route_reversed", Severity.INFO))
    if off_m > 5.0 + 3.0 * route.sigma_m:
        findings.append(Finding("route_far_from_launch", Severity.WARNING, {"metres": off_m}))
    return RouteLine(line.points_w_m, line.chainage_m - launch_m, route.sigma_m), tuple(findings)


def _from_first(points: FloatArray, sigma_m: float) -> RouteLine:
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return RouteLine(points, np.concatenate([[0.0], np.cumsum(length)]), sigma_m)
