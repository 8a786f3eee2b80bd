"""From a line of the map to the mapped route of a survey: in metres, from the launch on, and measured."""

from dataclasses import dataclass, replace

import numpy as np

from processing.coordinates import LOCAL, LocalFrame, is_local, local_frame, route_local
from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files.crs import area_of, crs_label, in_route_grid, is_degrees, metres_scale, to_degrees
from processing.importing.route_files.joining import Section
from processing.position.route import RouteLine
from processing.survey import Finding, FloatArray, Route, Severity, Survey

FROM_LAUNCH = "drawing"  # a drawing's own metres: the line begins at the launch, wherever the drawing's zero is
NEAR_LAUNCH_M = 50.0
AT_END_M = 2.0
FIRST_M = 10.0
LENGTH_PART, LENGTH_M = 0.02, 5.0  # a pipe's length and its map differ by less, or one of them is wrong


@dataclass(frozen=True)
class RouteChoice:
    """What the operator says of a line: ``crs`` is ``EPSG:n``, a WKT, ``local`` or :data:`FROM_LAUNCH`.

    ``unit_m`` is what the numbers are in, where that is not the unit of ``crs`` (a drawing); degrees are degrees.
    ``swap`` takes the second column for east.
    ``reverse`` None: as it best fits launch and length. ``clip`` cuts off what lies before the launch.
    """

    crs: str
    unit_m: float | None = None
    swap: bool = False
    reverse: bool | None = None
    clip: bool = True
    sigma_m: float = 0.5


@dataclass(frozen=True)
class BuiltRoute:
    """The route with what it is like: its points as local places for a map, its length, how far off the launch."""

    route: Route
    reversed: bool
    local_w_m: FloatArray  # (n, 3)
    length_m: float
    launch_off_m: float | None
    findings: tuple[Finding, ...]


@dataclass(frozen=True)
class _Way:
    """One of the two directions: the whole line, where on it the launch is, and how much lies after that."""

    built: BuiltRoute
    line_w_m: FloatArray
    along_m: float
    after_m: float


def route_from(line: Section, choice: RouteChoice, survey: Survey) -> BuiltRoute:
    """Return the route that a line of the map gives.

    Without heights the route lies level at the launch's elevation. Length is the true one on the ground, in three
    dimensions where there are heights, not the one in the map's projection.

    Raises:
        LeaklineError: CRS_UNKNOWN, ROUTE_OUTSIDE_CRS, ROUTE_EMPTY for a line that is one point; LAUNCH_INCOMPLETE,
            LAUNCH_INVALID for a launch that contradicts itself.
    """
    points, code = _in_grid(line, choice, survey)
    route = _as_route(points, code, choice)
    candidates = [_measured(route, survey, choice, back=False), _measured(route, survey, choice, back=True)]
    if choice.reverse is not None:
        built = candidates[choice.reverse].built
    elif candidates[0].built.launch_off_m is None:
        built = candidates[0].built  # nothing to fit to: as it was drawn
    else:
        built = min(candidates, key=lambda way: _misfit(way, survey)).built
    extra = () if is_local(route.crs) else _outside(points, code)
    return replace(built, findings=built.findings + extra)


def map_scale(crs: str | None, unit_m: float | None, points: FloatArray) -> tuple[float, float]:
    """Return about how many metres one unit of x and of y is; ``crs`` None: nobody has told yet."""
    if crs is None or crs == FROM_LAUNCH or is_local(crs) or (unit_m is not None and not is_degrees(crs)):
        return unit_m or 1.0, unit_m or 1.0
    return metres_scale(crs, points)


def _in_grid(line: Section, choice: RouteChoice, survey: Survey) -> tuple[FloatArray, str]:
    points = line.points.copy()
    if choice.swap:
        points[:, :2] = points[:, 1::-1]
    if choice.crs == FROM_LAUNCH or is_local(choice.crs):
        points, code = points * (choice.unit_m or 1.0), LOCAL
        if choice.crs == FROM_LAUNCH:
            points -= points[0]
    else:
        if choice.unit_m is not None and not is_degrees(choice.crs):
            points *= choice.unit_m / metres_scale(choice.crs, points)[0]
        points, code = in_route_grid(points, choice.crs)
    if not line.has_z:
        points[:, 2] = 0.0 if is_local(code) else survey.launch.elevation_m or 0.0
    step = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1) + np.abs(np.diff(points[:, 2]))
    points = points[np.concatenate([[True], step > 1e-4])]
    if len(points) < 2:
        raise LeaklineError(ErrorCode.ROUTE_EMPTY)
    return points, code


def _as_route(points: FloatArray, code: str, choice: RouteChoice) -> Route:
    rows = np.round(points, 4)  # a tenth of a millimetre
    return Route(tuple((float(x), float(y), float(z)) for x, y, z in rows), code, choice.sigma_m)


def _measured(route: Route, survey: Survey, choice: RouteChoice, *, back: bool) -> _Way:
    """The route drawn one way."""
    if back:
        points = route.points[::-1]
        if choice.crs == FROM_LAUNCH:  # it begins at the launch from this end too
            x, y, z = points[0]
            points = tuple((p[0] - x, p[1] - y, p[2] - z) for p in points)
        route = replace(route, points=points)
    frame = local_frame(survey.launch, route)
    local = route_local(frame, route)
    findings: list[Finding] = []
    line_w_m, along_m = local, 0.0
    off_m: float | None = None
    after_m = _length(local)
    if _knows_launch(survey, route):
        along_m, off_m = _drawn_line(local).chainage_of((0.0, 0.0), 0.0, route.sigma_m)
        if off_m > 5.0 + 3.0 * route.sigma_m:
            findings.append(Finding("route_far_from_launch", Severity.WARNING, {"metres": off_m}))
        after_m -= along_m
        if choice.clip and min(along_m, after_m) > AT_END_M and off_m <= NEAR_LAUNCH_M:
            route, local = _clipped(route, frame, local, along_m)
            findings.append(Finding("route_clipped", Severity.INFO, {"metres": along_m}))
    length_m = _length(local)
    findings += _length_finding(length_m, survey.pipe.length_m)
    return _Way(BuiltRoute(route, back, local, length_m, off_m, tuple(findings)), line_w_m, along_m, after_m)


def _length(local: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(local, axis=0), axis=1).sum())


def _knows_launch(survey: Survey, route: Route) -> bool:
    """Whether launch and route can be compared: a launch without coordinates borrows the route's first point."""
    return is_local(route.crs) or local_frame(survey.launch).is_geographic


def _drawn_line(local: FloatArray) -> RouteLine:
    length = np.linalg.norm(np.diff(local, axis=0), axis=1)
    keep = np.concatenate([[True], length > 1e-6])
    points = local[keep]
    return RouteLine(points, np.concatenate([[0.0], np.cumsum(length[length > 1e-6])]), 0.0)


def _clipped(route: Route, frame: LocalFrame, local: FloatArray, along_m: float) -> tuple[Route, FloatArray]:
    line = _drawn_line(local)
    first = line.at(np.array([along_m]))
    rest = line.points_w_m[line.chainage_m > along_m + 1e-3]
    local = np.concatenate([first, rest])
    lift = frame.height_m or route.points[0][2]
    if is_local(route.crs):
        start = (float(first[0, 0]), float(first[0, 1]), float(first[0, 2]))
    else:
        on_grid = frame.to_grid(first, route.crs)[0]
        start = (round(float(on_grid[0]), 4), round(float(on_grid[1]), 4), round(float(first[0, 2] + lift), 4))
    return replace(route, points=(start, *route.points[-len(rest) :])), local


def _misfit(way: _Way, survey: Survey) -> tuple[bool, float, float]:
    """How badly a direction fits: against the stated heading, too short for the run, and then by the length.

    A map may well go on after the retrieval; a run cannot. Without a length the longer way is the run's.
    """
    pipe_m = survey.pipe.length_m
    against = survey.launch.heading_deg is not None and _along_heading(way, survey.launch.heading_deg) < 0.0
    if pipe_m is None:
        return against, 0.0, -way.after_m
    short_m = max(pipe_m - _allowed(pipe_m) - way.after_m, 0.0)
    return against, short_m, abs(way.after_m - pipe_m)


def _along_heading(way: _Way, heading_deg: float) -> float:
    """Cosine between a stated heading and the first metres of the way; 0 where too little of it lies ahead."""
    if way.after_m < AT_END_M:
        return -1.0
    line = _drawn_line(way.line_w_m)
    ahead = np.array([way.along_m, way.along_m + min(FIRST_M, way.after_m)])
    east, north, _ = np.diff(line.at(ahead), axis=0)[0]
    length = float(np.hypot(east, north))
    heading = np.radians(heading_deg)
    return float((east * np.sin(heading) + north * np.cos(heading)) / length) if length > 0.0 else 0.0


def _allowed(pipe_m: float) -> float:
    return max(LENGTH_M, LENGTH_PART * pipe_m)


def _length_finding(length_m: float, pipe_m: float | None) -> list[Finding]:
    if pipe_m is None or abs(length_m - pipe_m) <= _allowed(pipe_m):
        return []
    return [Finding("route_length_differs", Severity.WARNING, {"route_m": length_m, "pipe_m": pipe_m})]


def _outside(points: FloatArray, code: str) -> tuple[Finding, ...]:
    """A route far outside of where its system is used was read in the wrong system, or with its axes swapped."""
    area = area_of(code)
    if area is None:
        return ()
    longitude, latitude = np.median(to_degrees(points, code)[:, :2], axis=0)
    west, south, east, north = area
    width = east - west if east >= west else east - west + 360.0
    if (longitude - west + 2.0) % 360.0 <= width + 4.0 and south - 2.0 <= latitude <= north + 2.0:
        return ()
    return (Finding("route_outside_area", Severity.WARNING, {"crs": crs_label(code)}),)
