"""What a route file would give under the operator's answers so far: sections for a map, the chosen line, its route."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from processing.coordinates import is_local, local_frame
from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files.building import FROM_LAUNCH, BuiltRoute, RouteChoice, map_scale, route_from
from processing.importing.route_files.crs import CrsEntry, from_degrees, metres_scale, projected_roughly, search
from processing.importing.route_files.joining import (
    TOLERANCE_M,
    Section,
    one_line,
    sections_of,
    with_connections,
)
from processing.importing.route_files.lines import CrsSource, RouteFile
from processing.progress import Progress
from processing.survey import FloatArray, Survey

MAP_POINTS = 60_000  # what a screen can show of all sections together
ROUGH = {"KML": 3.0, "GPX": 3.0}  # drawn on pictures or walked with a handheld: 1 sigma in metres
SIGMA_M = 0.5
TRIED_SYSTEMS = 25
FITS_M = 1000.0


@dataclass(frozen=True)
class RouteAnswer:
    """What the operator has said: ``pieces`` are lines of the file, None: choose; ``crs`` None: not told yet."""

    pieces: frozenset[int] | None = None
    crs: str | None = None
    unit_m: float | None = None
    swap: bool = False
    reverse: bool | None = None
    clip: bool = True
    sigma_m: float = SIGMA_M
    tolerance_m: float = TOLERANCE_M
    connect: bool = False  # choose also what lies between the chosen


@dataclass(frozen=True)
class RouteProposal:
    """The map is in metres from its middle, x to the east: ``planes`` one (n, 2) a section, ``way`` the route (m, 2).

    ``error`` says why there is no ``built`` yet.
    """

    answer: RouteAnswer
    sections: tuple[Section, ...]
    lengths_m: tuple[float, ...]
    planes: tuple[FloatArray, ...]
    chosen: frozenset[int]
    launch: tuple[float, float] | None = None
    way: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    built: BuiltRoute | None = None
    error: LeaklineError | None = None


def first_answer(file: RouteFile, survey: Survey) -> RouteAnswer:
    """Return what can be answered without asking: the file's own system and unit, and the usual trust in its kind."""
    crs = file.crs
    if crs is None and file.crs_source is CrsSource.ASK and survey.launch.crs and not is_local(survey.launch.crs):
        crs = survey.launch.crs.strip()  # the utility's own grid, most likely
    return RouteAnswer(crs=crs, unit_m=file.unit_m, sigma_m=ROUGH.get(file.format, SIGMA_M))


def fitting_systems(
    file: RouteFile, entries: Iterable[CrsEntry], near: tuple[float, float] | None
) -> tuple[tuple[str, float], ...]:
    """Return the systems in which the lines of a file without one would pass ``near`` (longitude, latitude).

    Each with how many metres the nearest point of the lines is away; the nearest first. The operator decides: systems
    of two datums lie some hundred metres apart, and the launch may be that wrong.
    """
    if near is None or file.crs is not None:
        return ()
    points = np.concatenate([line.points[:, :2] for line in file.lines])
    found = []
    for entry in search(entries, "", near, TRIED_SYSTEMS):
        rough = projected_roughly(near, entry.code)
        if rough is None or _away_m(points, rough, entry.code, file.unit_m) > 2.0 * FITS_M:
            continue
        try:
            away_m = _away_m(points, from_degrees(np.array([near]), entry.code)[0], entry.code, file.unit_m)
        except LeaklineError:
            continue  # no way is known into it: it is of no use for a route either
        if away_m < FITS_M:
            found.append((entry.code, away_m))
    return tuple(sorted(found, key=lambda pair: pair[1]))


def _away_m(points: FloatArray, place: FloatArray, crs: str, unit_m: float | None) -> float:
    """How many metres the nearest of the points, in ``unit_m``, is from a place in the units of a system."""
    if not np.isfinite(place).all():
        return float("inf")
    own, given = metres_scale(crs, place[None, :])[0], unit_m or metres_scale(crs, place[None, :])[0]
    return float(np.hypot(*(points * given - place * own).T).min())


def propose(file: RouteFile, answer: RouteAnswer, survey: Survey, progress: Progress) -> RouteProposal:
    """Return what ``answer`` gives; faults of the answer are told in the proposal, not raised."""
    progress.update(0.0, "route_joining")
    try:
        scale = map_scale(answer.crs, answer.unit_m, file.lines[0].points)
    except LeaklineError:
        scale = (1.0, 1.0)
    sections = sections_of(file.lines, scale, answer.tolerance_m)
    lengths = tuple(section.length_m(scale) for section in sections)
    progress.update(0.5)
    origin, planes = _planes(sections, scale, swap=answer.swap)
    launch = _launch_on_map(answer, survey, origin, scale)
    chosen = _chosen(sections, planes, launch, answer)
    if answer.connect:
        chosen = with_connections(sections, chosen, scale, answer.tolerance_m)
    progress.update(0.7)
    try:
        line = one_line([sections[k] for k in sorted(chosen)], scale, answer.tolerance_m)
        built = route_from(line, _choice(answer), survey)
    except LeaklineError as error:
        return RouteProposal(answer, sections, lengths, planes, chosen, launch, error=error)
    way = _on_map(line.points, origin, scale, swap=answer.swap)
    way = _after(way[::-1] if built.reversed else way, built)
    return RouteProposal(answer, sections, lengths, planes, chosen, launch, way, built)


def pieces_of(proposal: RouteProposal, chosen: frozenset[int]) -> frozenset[int]:
    """Return which lines of the file some sections are made of: these stay, when sections are joined otherwise."""
    return frozenset(piece for k in chosen for piece in proposal.sections[k].pieces)


def _choice(answer: RouteAnswer) -> RouteChoice:
    if answer.crs is None:
        raise LeaklineError(ErrorCode.ROUTE_NEEDS_CRS)
    return RouteChoice(answer.crs, answer.unit_m, answer.swap, answer.reverse, answer.clip, answer.sigma_m)


def _chosen(
    sections: Sequence[Section], planes: Sequence[FloatArray], launch: tuple[float, float] | None, answer: RouteAnswer
) -> frozenset[int]:
    if answer.pieces is not None:
        return frozenset(k for k, section in enumerate(sections) if answer.pieces.intersection(section.pieces))
    if launch is None:
        return frozenset([0])  # the longest
    away = [float(np.hypot(*(plane - launch).T).min()) for plane in planes]
    near = min(away)
    # of those that meet at the launch the longest: a house's service may begin there too
    return frozenset([next(k for k, metres in enumerate(away) if metres <= near + 5.0)])


def _planes(
    sections: Sequence[Section], scale: tuple[float, float], *, swap: bool
) -> tuple[FloatArray, tuple[FloatArray, ...]]:
    low = np.min([section.points[:, :2].min(axis=0) for section in sections], axis=0)
    high = np.max([section.points[:, :2].max(axis=0) for section in sections], axis=0)
    origin = 0.5 * (low + high)
    every = max(1, sum(len(section.points) for section in sections) // MAP_POINTS)
    shown = []
    for section in sections:
        rows = np.unique(np.append(np.arange(0, len(section.points), every), len(section.points) - 1))
        shown.append(_on_map(section.points[rows], origin, scale, swap=swap))
    return origin, tuple(shown)


def _on_map(points: FloatArray, origin: FloatArray, scale: tuple[float, float], *, swap: bool) -> FloatArray:
    plane = (points[:, :2] - origin) * scale
    return np.asarray(plane[:, ::-1] if swap else plane)


def _launch_on_map(
    answer: RouteAnswer, survey: Survey, origin: FloatArray, scale: tuple[float, float]
) -> tuple[float, float] | None:
    """Where the launch lies on the map; None where one of the two has no place in the world."""
    if answer.crs is None or answer.crs == FROM_LAUNCH:
        return None
    try:
        frame = local_frame(survey.launch)
        if is_local(answer.crs):
            place = np.zeros((1, 2))
        elif frame.is_geographic:
            place = from_degrees(frame.to_geographic(np.zeros((1, 3)))[:, 1::-1], answer.crs)
        else:
            return None
    except LeaklineError:
        return None  # told when the route is built
    if answer.swap:
        place = place[:, ::-1]
    x, y = _on_map(place, origin, scale, swap=answer.swap)[0]
    return (float(x), float(y)) if np.isfinite([x, y]).all() else None


def _after(way: FloatArray, built: BuiltRoute) -> FloatArray:
    """The part of the line that was kept, by its share of the length: exact to less than a pixel."""
    cut_m = sum(float(f.params["metres"]) for f in built.findings if f.code == "route_clipped")
    if cut_m <= 0.0:
        return way
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    start = along[-1] * cut_m / (cut_m + built.length_m)
    first = [np.interp(start, along, way[:, k]) for k in (0, 1)]
    return np.vstack([first, way[along > start]])
