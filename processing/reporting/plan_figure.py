"""The report's maps as SVG: the whole run, and the surroundings of one leak with its 95 % ellipse."""

import math
from dataclasses import dataclass

import numpy as np

from processing.coordinates import frame_of, route_local
from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.labels import Labels
from processing.reporting.marks import VERDICT_COLOURS, draw_mark
from processing.reporting.references import LAUNCH, Reference, Tape, covariance, ellipse, is_heading_known
from processing.reporting.svg import INK, SOFT, Drawing, Frame, round_up
from processing.reporting.words import Words
from processing.survey import FloatArray, Track, Verdict

PATH_COLOUR, INTERVAL, NOT_ASSESSED, TIE = "#1f5fa8", "#f2a900", "#7d8790", "#0b3d2e"
ELLIPSE = "#c25e00"
SCALE_STRIP = 38.0  # points under a map for its scale and its legend, so that they hide nothing
LEGEND = 7.5  # points
_LINE_STEP_M = 0.25
_LINE_AT_MOST = 3000  # points of a line: a page is 500 points wide
_LEAST_REACH_M = 9.0
_REFERENCE_REACH = 1.5  # so many times further the map of a leak reaches to have a reference on it
_NAME_CHARACTERS = 28


@dataclass(frozen=True)
class Surroundings:
    """One leak's map: the leak, and the tapes to its references with their places."""

    row: LeakRow
    tapes: tuple[Tape, ...]
    known: tuple[Reference, ...]


def path_between(track: Track, start_m: float, end_m: float) -> FloatArray:
    """Return positions (n, 3) along the path between two chainages."""
    count = int(np.clip((end_m - start_m) / _LINE_STEP_M, 2, _LINE_AT_MOST))
    return distance.places_at(track, distance.times_at(track, np.linspace(start_m, end_m, count))[0]).position_w_m


def overview(
    content: ReportContent, known: tuple[Reference, ...], words: Words, size: tuple[float, float]
) -> str | None:
    """Return the plan of the whole run; None without a path."""
    track = content.results.track
    if track is None:
        return None
    whole = path_between(track, float(track.chainage_m[0]), float(track.chainage_m[-1]))
    spans = [whole[:, :2], *(np.array([reference.place_m]) for reference in known if reference.place_m is not None)]
    frame = _frame(size, np.concatenate(spans), 0.0)
    return _map(content, known, words, size, frame, None)


def leak_map(content: ReportContent, around: Surroundings, words: Words, size: tuple[float, float]) -> str | None:
    """Return the surroundings of one leak: 9 m at least, its interval, its ellipse, a reference that is near."""
    row = around.row
    if content.results.track is None or not np.all(np.isfinite(row.candidate.position_w_m)):
        return None
    reach = max(_LEAST_REACH_M, 1.3 * row.interval_m)
    cov = covariance(row.candidate, content.results)
    if cov is not None and is_heading_known(content.results):
        reach = max(reach, 1.15 * ellipse(cov).major_m)
    at = np.array(row.candidate.position_w_m[:2])
    points = [at]
    points += [
        np.array(tape.place_m)
        for tape in around.tapes
        if tape.place_m is not None and tape.surface_m is not None and tape.surface_m <= _REFERENCE_REACH * reach
    ]
    return _map(content, around.known, words, size, _frame(size, np.array(points), reach), around)


def _frame(size: tuple[float, float], points: FloatArray, reach: float) -> Frame:
    """Return a frame of equal scales around the points, ``reach`` metres and a margin beyond them."""
    width, height = size[0], size[1] - SCALE_STRIP
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    middle = (low + high) / 2
    margin = 1.16 if reach == 0.0 else 1.04
    metres = max((high[0] - low[0]) * margin, (high[1] - low[1]) * margin * width / height, 4.0)
    half_x, half_y = metres / 2, metres / 2 * height / width
    return Frame(0, 0, width, height, middle[0] - half_x, middle[0] + half_x, middle[1] - half_y, middle[1] + half_y)


def _map(
    content: ReportContent,
    known: tuple[Reference, ...],
    words: Words,
    size: tuple[float, float],
    frame: Frame,
    around: Surroundings | None,
) -> str:
    track = content.results.track
    assert track is not None  # both callers have seen to it
    drawing = Drawing(*size)
    drawing.rectangle(frame.left, frame.top, frame.width, frame.height, fill="#f7f8f9")
    labels = Labels(drawing, frame)
    rows = [row for row in content.rows if _is_shown(frame, row)]

    def draw() -> None:
        _draw_route(drawing, frame, content)
        _draw_path(drawing, frame, content, track, rows, around)
        if around is not None:
            _draw_ellipse(drawing, frame, content, around.row)
        for row in rows:
            east, north, _ = row.candidate.position_w_m
            labels.keep_clear(frame.x(east), frame.y(north), 4.5)
        _draw_references(drawing, frame, known, words, labels)
        if around is not None:
            _draw_tapes(drawing, frame, around, words, labels)
        _draw_leaks(drawing, frame, rows, around, labels)

    drawing.clipped(frame, draw)
    _draw_scale(drawing, frame, words)
    _draw_legend(drawing, frame, content, words, around)
    if is_heading_known(content.results):
        _draw_north(drawing, frame, words)
    return drawing.svg()


def _is_shown(frame: Frame, row: LeakRow) -> bool:
    east, north, _ = row.candidate.position_w_m
    return frame.x_low <= east <= frame.x_high and frame.y_low <= north <= frame.y_high


def _places(frame: Frame, positions: FloatArray) -> list[tuple[float, float]]:
    return [(frame.x(east), frame.y(north)) for east, north in positions[:, :2]]


def _draw_route(drawing: Drawing, frame: Frame, content: ReportContent) -> None:
    route = content.results.survey.route
    if route is not None and len(route.points) >= 2:
        drawing.path(_places(frame, route_local(frame_of(content.results.survey), route)), SOFT, 3.4, opacity=0.35)


def _draw_path(
    drawing: Drawing,
    frame: Frame,
    content: ReportContent,
    track: Track,
    rows: list[LeakRow],
    around: Surroundings | None,
) -> None:
    """Draw intervals, the path, and over it what was not assessed: all of the run, or what the map of a leak shows."""
    for row in rows:
        c = row.candidate
        spans = np.isfinite([c.chainage_low95_m, c.chainage_high95_m]).all()
        if row.decision.verdict is not Verdict.REJECTED and spans:
            span = path_between(track, c.chainage_low95_m, c.chainage_high95_m)
            own = around is not None and row is around.row
            drawing.path(_places(frame, span), INTERVAL, 11.0 if own else 7.0, opacity=0.75, cap="butt")
    start, end = float(track.chainage_m[0]), float(track.chainage_m[-1])
    if around is not None:
        # a map can show no more of the pipe than its own diagonal, unless the pipe winds; thrice that is plenty
        reach = 3.0 * math.hypot(frame.x_high - frame.x_low, frame.y_high - frame.y_low)
        start = max(start, around.row.candidate.chainage_m - reach)
        end = min(end, around.row.candidate.chainage_m + reach)
    drawing.path(_places(frame, path_between(track, start, end)), PATH_COLOUR, 1.5)
    for part in content.unassessed:
        if part.start_m is not None and part.end_m is not None and part.end_m >= start and part.start_m <= end:
            places = _places(frame, path_between(track, max(part.start_m, start), min(part.end_m, end)))
            drawing.path(places, "#ffffff", 2.2, cap="butt")
            drawing.path(places, NOT_ASSESSED, 1.8, dash="3 2", cap="butt")


def _draw_ellipse(drawing: Drawing, frame: Frame, content: ReportContent, row: LeakRow) -> None:
    """Draw the 95 % ellipse of a leak's place on the map; none where the map's direction is arbitrary."""
    cov = covariance(row.candidate, content.results)
    if cov is None or not is_heading_known(content.results):
        return
    found = ellipse(cov)
    turn = np.linspace(0.0, 2.0 * np.pi, 73)
    bearing = math.radians(found.bearing_deg)
    along, aside = found.major_m * np.cos(turn), found.minor_m * np.sin(turn)
    east = row.candidate.position_w_m[0] + along * math.sin(bearing) + aside * math.cos(bearing)
    north = row.candidate.position_w_m[1] + along * math.cos(bearing) - aside * math.sin(bearing)
    outline = _places(frame, np.column_stack([east, north]))
    drawing.path(outline, "none", 0.0, fill=ELLIPSE, opacity=0.16)
    drawing.path(outline, ELLIPSE, 1.1)


def _draw_references(
    drawing: Drawing, frame: Frame, known: tuple[Reference, ...], words: Words, labels: Labels
) -> None:
    for reference in known:
        if reference.place_m is None:
            continue
        x, y = frame.x(reference.place_m[0]), frame.y(reference.place_m[1])
        if 0.0 <= x <= frame.width and 0.0 <= y <= frame.height:
            drawing.rectangle(x - 3.6, y - 3.6, 7.2, 7.2, "#ffffff")
            drawing.rectangle(x - 2.8, y - 2.8, 5.6, 5.6, TIE)
            labels.keep_clear(x, y, 3.6)
            labels.place(x, y, reference_name(reference.name, words), away=5.5, size=8.0, colour=TIE)


def reference_name(name: str, words: Words) -> str:
    """Return what a map calls a reference."""
    return words("launch") if name == LAUNCH else words.name(name, _NAME_CHARACTERS)


def _draw_tapes(drawing: Drawing, frame: Frame, around: Surroundings, words: Words, labels: Labels) -> None:
    """Draw the way to each reference: a line to one on the map, an arrow at the edge towards one beyond it."""
    east, north, _ = around.row.candidate.position_w_m
    x, y = frame.x(east), frame.y(north)
    for tape in around.tapes:
        if tape.place_m is None or tape.surface_m is None:
            continue
        to_x, to_y = frame.x(tape.place_m[0]), frame.y(tape.place_m[1])
        text = words.length(tape.surface_m)
        if 0.0 <= to_x <= frame.width and 0.0 <= to_y <= frame.height:
            drawing.path([(x, y), (to_x, to_y)], TIE, 0.8, dash="1 2")
            labels.place((x + to_x) / 2, (y + to_y) / 2, text, away=4.0, size=8.0, colour=TIE)
            continue
        length = math.hypot(to_x - x, to_y - y)
        way_x, way_y = (to_x - x) / length, (to_y - y) / length
        tip_x, tip_y = _edge(frame, x, y, way_x, way_y)
        drawing.line(tip_x - 16 * way_x, tip_y - 16 * way_y, tip_x, tip_y, TIE, 1.2)
        wings = [(tip_x - 6 * way_x + s * 3 * way_y, tip_y - 6 * way_y - s * 3 * way_x) for s in (1.0, -1.0)]
        drawing.path([wings[0], (tip_x, tip_y), wings[1], wings[0]], TIE, 0.5, fill=TIE)
        name = f"{reference_name(tape.name, words)} {text}"
        labels.place(tip_x - 18 * way_x, tip_y - 18 * way_y, name, away=4.0, size=8.0, colour=TIE, must=True)


def _edge(frame: Frame, x: float, y: float, way_x: float, way_y: float) -> tuple[float, float]:
    """Return where a ray from (x, y) meets the frame, two points inside of it."""
    steps = []
    if abs(way_x) > 1e-9:
        steps.append(((frame.width - 2 if way_x > 0 else 2) - x) / way_x)
    if abs(way_y) > 1e-9:
        steps.append(((frame.height - 2 if way_y > 0 else 2) - y) / way_y)
    step = max(0.0, min(steps))
    return x + step * way_x, y + step * way_y


def _draw_leaks(
    drawing: Drawing, frame: Frame, rows: list[LeakRow], around: Surroundings | None, labels: Labels
) -> None:
    """Draw each leak's mark and number; rejected ones first, so that they lie under the others."""
    order = (Verdict.REJECTED, Verdict.NONE, Verdict.UNSURE, Verdict.CONFIRMED)
    for row in sorted(rows, key=lambda r: (around is not None and r is around.row, order.index(r.decision.verdict))):
        east, north, _ = row.candidate.position_w_m
        own = around is not None and row is around.row
        draw_mark(drawing, frame.x(east), frame.y(north), row.decision.verdict, 2.4 if own else 4.2)
    for row in sorted(rows, key=lambda r: -order.index(r.decision.verdict)):
        east, north, _ = row.candidate.position_w_m
        own = around is not None and row is around.row
        labels.place(
            frame.x(east), frame.y(north), str(row.candidate.label), away=5.5, size=10.0 if own else 8.0, weight=600,
            colour=VERDICT_COLOURS[row.decision.verdict], must=own,
        )  # fmt: skip


def _draw_scale(drawing: Drawing, frame: Frame, words: Words) -> None:
    factor = words.quantities.length_factor
    shown = round_up((frame.x_high - frame.x_low) * factor / 14)
    length = frame.x(frame.x_low + shown / factor) - frame.left
    y = frame.top + frame.height + 17
    drawing.line(4, y, 4 + length, y, INK, 1.6)
    for x in (4.0, 4 + length):
        drawing.line(x, y - 3, x, y + 3, INK, 1.0)
    digits = max(0, -math.floor(math.log10(shown) + 1e-9))
    text = f"{words.number(shown, digits)} {words.quantities.length_unit}"
    drawing.text(4 + length / 2, y - 5, text, anchor="middle", size=8)


def _draw_legend(
    drawing: Drawing, frame: Frame, content: ReportContent, words: Words, around: Surroundings | None
) -> None:
    """Draw what the lines mean, below the scale."""
    entries = [("legend_path", PATH_COLOUR, 1.5, ""), ("legend_interval", INTERVAL, 6.0, "")]
    if around is not None and is_heading_known(content.results):
        entries.append(("legend_ellipse", ELLIPSE, 1.2, ""))
    if content.unassessed:
        entries.append(("legend_not_assessed", NOT_ASSESSED, 1.8, "3 2"))
    route = content.results.survey.route
    if route is not None and len(route.points) >= 2:
        entries.append(("legend_route", "#bfc5ca", 3.4, ""))
    y = frame.top + frame.height + SCALE_STRIP - 7
    x = frame.left + 4
    for key, colour, width, dash in entries:
        text = words(key)
        style: dict[str, str | float] = {"cap": "butt"}
        if dash:
            style["dash"] = dash
        drawing.path([(x, y), (x + 12, y)], colour, width, **style)
        drawing.text(x + 15, y + 2.5, text, size=LEGEND, colour=SOFT)
        x += 15 + 0.54 * LEGEND * len(text) + 7


def _draw_north(drawing: Drawing, frame: Frame, words: Words) -> None:
    x = frame.left + frame.width - 14
    drawing.rectangle(x - 9, 4, 18, 36, "#ffffff", 0.8)
    drawing.path([(x, 7), (x + 5, 23), (x, 19), (x - 5, 23), (x, 7)], INK, 0.6, fill=INK)
    drawing.text(x, 34, words("north"), anchor="middle", weight=600, size=8)
