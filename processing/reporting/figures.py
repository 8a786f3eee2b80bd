"""The report's figures as SVG: maps, elevation profile, level along the pipe; pure functions of the content."""

from dataclasses import dataclass

import numpy as np

from processing.coordinates import route_local
from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.svg import INK, SOFT, Drawing, Frame, round_up
from processing.survey import FloatArray, Track, Verdict

PATH_COLOUR, INTERVAL, NOT_ASSESSED, TIE = "#1f5fa8", "#f2a900", "#9aa4ad", "#0b3d2e"
VERDICT_COLOURS = {
    Verdict.CONFIRMED: "#b3001b",
    Verdict.REJECTED: "#6b7680",
    Verdict.UNSURE: "#8a5a00",
    Verdict.NONE: "#7a1fa2",
}
LINE_STEP_M = 0.25
SCALE_STRIP = 24.0  # points under a map for its scale, so that it hides nothing


@dataclass(frozen=True)
class MapLabels:
    """Words that stand on a map, in the report's language."""

    launch: str
    north: str


def path_between(track: Track, start_m: float, end_m: float) -> FloatArray:
    """Return positions (n, 3) along the path between two chainages."""
    count = int(np.clip((end_m - start_m) / LINE_STEP_M, 2, 4000))
    return distance.places_at(track, distance.times_at(track, np.linspace(start_m, end_m, count))[0]).position_w_m


def plan_map(
    content: ReportContent, labels: MapLabels, size: tuple[float, float], around: LeakRow | None = None
) -> str | None:
    """Return the plan: the whole run, or 40 m around one leak; None without a path."""
    track = content.results.track
    if track is None or (around is not None and not np.all(np.isfinite(around.candidate.position_w_m))):
        return None
    whole = path_between(track, float(track.chainage_m[0]), float(track.chainage_m[-1]))
    frame = _map_frame(size, whole if around is None else np.array([around.candidate.position_w_m]), around)
    drawing = Drawing(*size)
    drawing.rectangle(0, 0, *size, fill="#f7f8f9")

    def draw() -> None:
        _draw_route(drawing, frame, content)
        _draw_path(drawing, frame, content, whole, track, around)
        _draw_known_places(drawing, frame, content, track, labels)
        for row in content.rows:
            if around is None or row is around or _inside(frame, row):
                _draw_leak(drawing, frame, row, emphasised=row is around)

    drawing.clipped(frame, draw)
    _draw_scale_and_north(drawing, frame, labels)
    return drawing.svg()


def _map_frame(size: tuple[float, float], points: FloatArray, around: LeakRow | None) -> Frame:
    """Return a frame of equal scales around the points, with a margin; 9 m or the interval around one leak."""
    width, height = size[0], size[1] - SCALE_STRIP
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    reach = 0.0 if around is None else max(9.0, 1.3 * around.interval_m)
    middle = (low + high) / 2
    metres = max((high[0] - low[0] + 2 * reach) * 1.18, (high[1] - low[1] + 2 * reach) * 1.18 * width / height, 4.0)
    half_x, half_y = metres / 2, metres / 2 * height / width
    return Frame(0, 0, width, height, middle[0] - half_x, middle[0] + half_x, middle[1] - half_y, middle[1] + half_y)


def _inside(frame: Frame, row: LeakRow) -> bool:
    east, north, _ = row.candidate.position_w_m
    return frame.x_low <= east <= frame.x_high and frame.y_low <= north <= frame.y_high


def _places(frame: Frame, positions: FloatArray) -> list[tuple[float, float]]:
    return [(frame.x(east), frame.y(north)) for east, north in positions[:, :2]]


def _draw_route(drawing: Drawing, frame: Frame, content: ReportContent) -> None:
    route = content.results.survey.route
    if route is None or len(route.points) < 2:
        return
    drawing.path(_places(frame, route_local(content.frame, route)), SOFT, 3.2, opacity=0.25)


def _draw_path(
    drawing: Drawing, frame: Frame, content: ReportContent, whole: FloatArray, track: Track, around: LeakRow | None
) -> None:
    for row in content.rows:
        c = row.candidate
        if (
            row.decision.verdict is not Verdict.REJECTED
            and np.isfinite([c.chainage_low95_m, c.chainage_high95_m]).all()
            and (around is None or row is around or _inside(frame, row))
        ):
            span = path_between(track, c.chainage_low95_m, c.chainage_high95_m)
            drawing.path(_places(frame, span), INTERVAL, 12.0, opacity=0.7, cap="butt")
    drawing.path(_places(frame, whole), PATH_COLOUR, 1.4)
    for part in content.unassessed:
        if part.start_m is not None and part.end_m is not None:
            span = path_between(track, part.start_m, part.end_m)
            drawing.path(_places(frame, span), "#ffffff", 1.8, cap="butt")
            drawing.path(_places(frame, span), NOT_ASSESSED, 1.4, dash="2 2", cap="butt")


def _draw_known_places(drawing: Drawing, frame: Frame, content: ReportContent, track: Track, labels: MapLabels) -> None:
    for place in content.known_places:
        at = path_between(track, place.chainage_m, place.chainage_m)[0]
        x, y = frame.x(at[0]), frame.y(at[1])
        drawing.rectangle(x - 2.6, y - 2.6, 5.2, 5.2, TIE)
        name = labels.launch if place.name == "launch" else place.name
        drawing.text(x + 5, y + 8, name, colour=TIE, size=6.8, backed=1)


def _draw_leak(drawing: Drawing, frame: Frame, row: LeakRow, emphasised: bool) -> None:
    """Draw shape, colour and number: a filled circle for confirmed, a cross for rejected, a diamond for the rest."""
    east, north, _ = row.candidate.position_w_m
    x, y, colour = frame.x(east), frame.y(north), VERDICT_COLOURS[row.decision.verdict]
    reach = 3.4 if emphasised else 4.2  # small enough there for the interval to be seen around it
    if row.decision.verdict is Verdict.REJECTED:
        drawing.line(x - 3, y - 3, x + 3, y + 3, colour, 1.4)
        drawing.line(x - 3, y + 3, x + 3, y - 3, colour, 1.4)
    elif row.decision.verdict is Verdict.CONFIRMED:
        drawing.add(
            f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{reach}" fill="{colour}" stroke="#ffffff" stroke-width="0.8"/>'
        )
    else:
        corners = [(x, y - reach), (x + reach, y), (x, y + reach), (x - reach, y), (x, y - reach)]
        drawing.path(corners, "#ffffff", 0.8, fill=colour)
    drawing.text(x + reach + 2, y - 3, str(row.candidate.label), weight=600, size=8.5, colour=colour, backed=1)


def _draw_scale_and_north(drawing: Drawing, frame: Frame, labels: MapLabels) -> None:
    metres = round_up((frame.x_high - frame.x_low) / 8)
    length = frame.x(frame.x_low + metres) - frame.left
    bottom = frame.top + frame.height + SCALE_STRIP - 6
    drawing.line(12, bottom, 12 + length, bottom, INK, 1.6)
    for x in (12.0, 12 + length):
        drawing.line(x, bottom - 3, x, bottom + 3, INK, 1.0)
    drawing.text(12 + length / 2, bottom - 6, f"{metres:g} m", anchor="middle", size=7.5)
    x = frame.left + frame.width - 16
    drawing.path([(x, 10), (x + 5, 26), (x, 22), (x - 5, 26), (x, 10)], INK, 0.6, fill=INK)
    drawing.text(x, 36, labels.north, anchor="middle", weight=600, size=8)


def profile(content: ReportContent, x_label: str, y_label: str, size: tuple[float, float]) -> str | None:
    """Return the elevation along the pipe with its 95 % band; None without a path."""
    track = content.results.track
    if track is None or not track.chainage_m[-1] > track.chainage_m[0]:
        return None
    keep = np.unique(np.linspace(0, track.time_s.size - 1, 1500).astype(int))
    chainage, up = track.chainage_m[keep], track.position_w_m[keep, 2]
    band = 1.96 * track.sigma_up_m[keep]
    low, high = float((up - band).min()), float((up + band).max())
    pad = max(0.5, 0.08 * (high - low))
    frame = Frame(46, 8, size[0] - 54, size[1] - 38, float(chainage[0]), float(chainage[-1]), low - pad, high + pad)
    drawing = Drawing(*size)
    drawing.axes(frame, x_label, y_label)

    def draw() -> None:
        outline = [(frame.x(s), frame.y(u)) for s, u in zip(chainage, up + band)]
        outline += [(frame.x(s), frame.y(u)) for s, u in zip(chainage[::-1], (up - band)[::-1])]
        drawing.path(outline, "none", 0, fill=PATH_COLOUR, opacity=0.15)
        drawing.path([(frame.x(s), frame.y(u)) for s, u in zip(chainage, up)], PATH_COLOUR, 1.3)
        for row in content.rows:
            if row.decision.verdict is not Verdict.REJECTED and np.isfinite(row.candidate.chainage_m):
                x = frame.x(row.candidate.chainage_m)
                drawing.line(x, frame.top, x, frame.top + frame.height, VERDICT_COLOURS[row.decision.verdict], 0.9)
                drawing.text(x + 2, frame.top + 8, str(row.candidate.label), weight=600, size=7.5, backed=1)

    drawing.clipped(frame, draw)
    return drawing.svg()


def level_excerpt(
    content: ReportContent, row: LeakRow, x_label: str, y_label: str, size: tuple[float, float]
) -> str | None:
    """Return level, background and threshold 20 m either side of a leak; None where there is no level in metres."""
    along, at = content.results.level_along, row.candidate.chainage_m
    if along is None or not np.isfinite(at):
        return None
    near = np.abs(along.chainage_m - at) <= max(20.0, 1.3 * row.interval_m)
    levels = along.level_db[near]
    if np.isfinite(levels).sum() < 3:
        return None
    chainage = along.chainage_m[near]
    values = np.concatenate([levels, along.background_db[near], along.threshold_db[near]])
    low, high = float(np.nanmin(values)) - 2, float(np.nanmax(values)) + 2
    frame = Frame(46, 8, size[0] - 54, size[1] - 38, float(chainage[0]), float(chainage[-1]), low, high)
    drawing = Drawing(*size)
    drawing.axes(frame, x_label, y_label)

    def draw() -> None:
        left, right = frame.x(row.candidate.chainage_low95_m), frame.x(row.candidate.chainage_high95_m)
        drawing.rectangle(left, frame.top, right - left, frame.height, INTERVAL, 0.3)
        _curve(drawing, frame, chainage, along.background_db[near], SOFT, 0.9, "3 2")
        _curve(drawing, frame, chainage, along.threshold_db[near], VERDICT_COLOURS[Verdict.CONFIRMED], 0.8, "1 2")
        _curve(drawing, frame, chainage, levels, PATH_COLOUR, 1.3, None)
        drawing.line(frame.x(at), frame.top, frame.x(at), frame.top + frame.height, INK, 0.9)

    drawing.clipped(frame, draw)
    return drawing.svg()


def _curve(
    drawing: Drawing, frame: Frame, x: FloatArray, y: FloatArray, colour: str, width: float, dash: str | None
) -> None:
    """Draw a curve, broken where it is unknown."""
    known = np.isfinite(y)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(np.int8), [0]])))
    for start, end in zip(edges[::2], edges[1::2]):
        points = [(frame.x(a), frame.y(b)) for a, b in zip(x[start:end], y[start:end])]
        if dash:
            drawing.path(points, colour, width, dash=dash)
        else:
            drawing.path(points, colour, width)
