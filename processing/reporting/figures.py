"""The report's curves as SVG: elevation and level along the pipe; pure functions of the content."""

import numpy as np

from processing.position.distance import NORMAL_95
from processing.quantities import Places
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.labels import Labels
from processing.reporting.marks import VERDICT_COLOURS, draw_mark
from processing.reporting.plan_figure import INTERVAL, NOT_ASSESSED, PATH_COLOUR, TIE
from processing.reporting.references import Reference
from processing.reporting.svg import INK, SOFT, Drawing, Frame, Scale, number
from processing.reporting.words import Words
from processing.survey import FloatArray, Verdict

THRESHOLD = "#b3001b"
_MARKS = 18.0  # points above a profile for the marks of the leaks
_PROFILE_AT_MOST = 1500  # points of a curve


def chainage_scale(words: Words) -> Scale:
    """Return how an axis along the pipe is told: metres, feet, or stations."""
    q = words.quantities
    if q.places is Places.STATIONING:
        return Scale(q.length_factor, lambda shown: q.place(q.to_metres(shown), 0))
    return Scale(q.length_factor, lambda shown: tick(shown, words))


def length_scale(words: Words) -> Scale:
    """Return how an axis of lengths is told."""
    return Scale(words.quantities.length_factor, lambda shown: tick(shown, words))


def plain_scale(words: Words) -> Scale:
    """Return how an axis of any other figures is told."""
    return Scale(1.0, lambda shown: tick(shown, words))


def tick(shown: float, words: Words) -> str:
    """Return a tick's label by the language."""
    text = number(shown)
    return text.replace(".", ",") if words.language == "tr" else text


def chainage_label(words: Words) -> str:
    """Return the words below an axis along the pipe."""
    if words.quantities.places is Places.STATIONING:
        return words("axis_station")
    return words("axis_chainage", unit=words.quantities.length_unit)


def profile(
    content: ReportContent, known: tuple[Reference, ...], words: Words, size: tuple[float, float]
) -> str | None:
    """Return the elevation along the pipe with its 95 % band, what was not assessed, references and leaks."""
    track = content.results.track
    if track is None or not track.chainage_m[-1] > track.chainage_m[0]:
        return None
    keep = np.unique(np.linspace(0, track.time_s.size - 1, _PROFILE_AT_MOST).astype(int))
    chainage, up = track.chainage_m[keep], track.position_w_m[keep, 2]
    band = NORMAL_95 * track.sigma_up_m[keep]
    low, high = float((up - band).min()), float((up + band).max())
    pad = max(0.5, 0.08 * (high - low))
    ends = float(chainage[0]), float(chainage[-1])
    frame = Frame(50, _MARKS, size[0] - 58, size[1] - _MARKS - 30, *ends, low - pad, high + pad)
    drawing = Drawing(*size)
    for part in content.unassessed:
        if part.start_m is not None and part.end_m is not None:
            left, right = frame.x(part.start_m), frame.x(part.end_m)
            drawing.rectangle(left, frame.top, max(right - left, 0.6), frame.height, NOT_ASSESSED, 0.3)
    label = words("axis_up", unit=words.quantities.length_unit)
    drawing.axes(frame, chainage_label(words), label, scales=(chainage_scale(words), length_scale(words)))

    def draw() -> None:
        outline = [(frame.x(s), frame.y(u)) for s, u in zip(chainage, up + band)]
        outline += [(frame.x(s), frame.y(u)) for s, u in zip(chainage[::-1], (up - band)[::-1])]
        drawing.path(outline, "none", 0, fill=PATH_COLOUR, opacity=0.15)
        drawing.path([(frame.x(s), frame.y(u)) for s, u in zip(chainage, up)], PATH_COLOUR, 1.3)
        for reference in known:
            x = frame.x(reference.chainage_m)
            y = frame.y(float(np.interp(reference.chainage_m, track.chainage_m, track.position_w_m[:, 2])))
            drawing.rectangle(x - 2.4, y - 2.4, 4.8, 4.8, TIE)

    drawing.clipped(frame, draw)
    _draw_leaks_above(drawing, frame, content)
    return drawing.svg()


def _draw_leaks_above(drawing: Drawing, frame: Frame, content: ReportContent) -> None:
    """Draw each leak's mark above the frame, with a thin line down to the pipe, and its number where there is room."""
    labels = Labels(drawing, Frame(0, 0, drawing.width, _MARKS, 0, 1, 0, 1))
    rows = [r for r in content.rows if r.decision.verdict is not Verdict.REJECTED]
    rows = [r for r in rows if frame.x_low <= r.candidate.chainage_m <= frame.x_high]
    y = _MARKS - 5.0
    for row in rows:
        x, colour = frame.x(row.candidate.chainage_m), VERDICT_COLOURS[row.decision.verdict]
        drawing.line(x, y, x, frame.top + frame.height, colour, 0.7)
        draw_mark(drawing, x, y, row.decision.verdict, 3.6)
        labels.keep_clear(x, y, 4.0)
    for row in rows:
        x, colour = frame.x(row.candidate.chainage_m), VERDICT_COLOURS[row.decision.verdict]
        labels.place(x, y, str(row.candidate.label), away=5.0, size=7.5, weight=600, colour=colour)


def level_excerpt(content: ReportContent, row: LeakRow, words: Words, size: tuple[float, float]) -> str | None:
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
    frame = Frame(42, 6, size[0] - 50, size[1] - 34, float(chainage[0]), float(chainage[-1]), low, high)
    drawing = Drawing(*size)
    scales = (chainage_scale(words), plain_scale(words))
    drawing.axes(frame, chainage_label(words), words("axis_level"), scales=scales)

    def draw() -> None:
        if np.isfinite(row.interval_m):
            left, right = frame.x(row.candidate.chainage_low95_m), frame.x(row.candidate.chainage_high95_m)
            drawing.rectangle(left, frame.top, right - left, frame.height, INTERVAL, 0.3)
        _curve(drawing, frame, chainage, along.background_db[near], SOFT, 0.9, "3 2")
        _curve(drawing, frame, chainage, along.threshold_db[near], THRESHOLD, 0.8, "1 2")
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
