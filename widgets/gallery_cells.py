"""How one candidate looks in the gallery: mark, name, place ± interval, sound in metres, level, score and class.

All pictures share the axis, the frequencies, the colours and the decibels, so that they can be compared at a glance.
"""

import math
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QPen, QPolygonF

from processing.survey import FloatArray, Verdict
from widgets.candidate_row import CandidateRow
from widgets.gallery_pictures import GallerySound
from widgets.plot_paint import paint_hatch
from widgets.plot_theme import Theme, paint_verdict
from widgets.tile_source import Levels
from widgets.units import quantities
from widgets.vocabulary import class_text, half_width_m, number, verdict_text

WIDTHS = (180, 240, 320, 440)
_PAD = 6
_MARK_RADIUS = 8.0
_LOW_DB = -3.0  # lower end of the level curves
_TICK_M = 4.0
_LONG_NAME, _LONG_PLACE = "M888", "88888.8 m ± 88.8 m"
_BRACKET = 0.16  # of the picture's height


@dataclass(frozen=True)
class CellShape:
    """Where the parts of a cell stand, in its own pixels."""

    size: QSize
    head: QRectF
    picture: QRectF
    level: QRectF
    foot: QRectF

    @classmethod
    def of(cls, width: int, theme: Theme) -> "CellShape":
        """Return the shape of a cell that is at least ``width`` wide and takes its texts.

        A narrow one has its place below its name: neither the place nor its ± is ever cut.
        """
        metrics = theme.metrics()
        line = metrics.height()
        place_width = math.ceil(1.06 * metrics.horizontalAdvance(_LONG_PLACE))
        width = max(width, place_width + 2 * _PAD)
        one_line = width >= place_width + metrics.horizontalAdvance(_LONG_NAME) + 2 * _PAD + 5 * _MARK_RADIUS
        inner = width - 2 * _PAD
        head = QRectF(_PAD, _PAD - 2, inner, line + 6 if one_line else 2 * line + 8)
        picture = QRectF(_PAD, head.bottom() + 2, inner, round(0.52 * inner))
        level = QRectF(_PAD, picture.bottom() + 3, inner, round(0.14 * inner + 8))
        foot = QRectF(_PAD, level.bottom() + 2, inner, line + 4)
        return cls(QSize(width, math.ceil(foot.bottom() + _PAD - 2)), head, picture, level, foot)


def cell_text(row: CandidateRow) -> str:
    """Return a candidate as words, for screen readers."""
    parts = [row.name, place(row), _foot(row), verdict_text(row.decision.verdict)]
    return ", ".join(part for part in parts if part)


def place(row: CandidateRow) -> str:
    """Return a candidate's place with the half of its 95 % interval."""
    words = quantities()
    return f"{words.place(row.candidate.chainage_m)} ± {words.length(half_width_m(row.candidate))}"


def _foot(row: CandidateRow) -> str:
    score = "" if row.manual else number(row.candidate.score, 2)
    return " · ".join(part for part in (score, class_text(row.kind)) if part)


def paint_cell(
    painter: QPainter,
    theme: Theme,
    shape: CellShape,
    row: CandidateRow,
    sound: GallerySound | None,
    levels: Levels | None,
    top_db: float,
) -> None:
    """Draw one candidate; ``levels`` is its picture, None while it is being read."""
    painter.setFont(theme.font())
    painter.fillRect(QRectF(QPointF(0, 0), shape.size.toSizeF()), QColor(theme.canvas))
    decided = row.decision.verdict is not Verdict.NONE
    painter.setPen(QPen(theme.verdict_colour(row.decision.verdict) if decided else QColor(theme.grid), 2))
    painter.drawRect(QRectF(1, 1, shape.size.width() - 2, shape.size.height() - 2))
    _paint_head(painter, theme, shape.head, row)
    painter.fillRect(shape.picture, QColor(theme.grid))
    if sound is not None:
        painter.save()
        painter.setClipRect(shape.picture)
        _paint_sound(painter, theme, shape.picture, row, sound, levels)
        painter.restore()
        _paint_level(painter, theme, shape.level, row, sound, top_db)
    painter.setPen(QColor(theme.text))
    foot = theme.metrics().elidedText(_foot(row), Qt.TextElideMode.ElideRight, shape.foot.width())
    painter.drawText(shape.foot, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, foot)
    if decided:
        painter.setPen(theme.verdict_colour(row.decision.verdict))
        left = theme.metrics().horizontalAdvance(foot) + 12
        rest = shape.foot.adjusted(left, 0, 0, 0)
        word = theme.metrics().elidedText(verdict_text(row.decision.verdict), Qt.TextElideMode.ElideRight, rest.width())
        painter.drawText(rest, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignRight, word)


def _paint_head(painter: QPainter, theme: Theme, rect: QRectF, row: CandidateRow) -> None:
    two_lines = rect.height() > 1.6 * theme.metrics().height()
    first = rect.adjusted(0, 0, 0, -rect.height() / 2.0) if two_lines else rect
    centre = QPointF(rect.left() + _MARK_RADIUS + 3, first.center().y())
    paint_verdict(painter, theme, row.decision.verdict, centre, _MARK_RADIUS)
    bold = QFont(theme.font())
    bold.setBold(True)
    painter.setFont(bold)
    painter.setPen(QColor(theme.text))
    align = Qt.AlignmentFlag.AlignVCenter
    left = 2 * _MARK_RADIUS + 12
    painter.drawText(first.adjusted(left, 0, 0, 0), align | Qt.AlignmentFlag.AlignLeft, row.name)
    painter.setFont(theme.font())
    if two_lines:
        second = rect.adjusted(0, rect.height() / 2.0, 0, 0)
        painter.drawText(second, align | Qt.AlignmentFlag.AlignLeft, place(row))
    else:
        painter.drawText(first, align | Qt.AlignmentFlag.AlignRight, place(row))


def _paint_sound(
    painter: QPainter, theme: Theme, rect: QRectF, row: CandidateRow, sound: GallerySound, levels: Levels | None
) -> None:
    if levels is not None:
        rows, columns = levels.shape
        image = QImage(levels.data, columns, rows, columns, QImage.Format.Format_Indexed8)
        image.setColorTable(list(sound.colours))
        painter.drawImage(rect, image)
    middle = sound.middle(row.candidate)
    if not math.isfinite(middle):
        return
    for low, high in sound.stretches:
        left, right = _x(rect, sound, middle, low), _x(rect, sound, middle, high)
        if right > rect.left() and left < rect.right():
            paint_hatch(painter, QRectF(left, rect.top(), right - left, rect.height()), theme)
    _paint_interval(painter, theme, rect, row, sound)
    _paint_band(painter, theme, rect, row, sound)


def _x(rect: QRectF, sound: GallerySound, middle: float, value: float) -> float:
    part = (value - middle + sound.half) / (2.0 * sound.half)
    return rect.left() + min(max(part, -1.0), 2.0) * rect.width()


def _paint_interval(painter: QPainter, theme: Theme, rect: QRectF, row: CandidateRow, sound: GallerySound) -> None:
    """Draw from where to where the leak lies in 95 of 100 cases: a bracket above and one below, hiding no sound."""
    if sound.distances is None:
        return  # the interval is in metres
    candidate = row.candidate
    middle = candidate.chainage_m
    ends = [_x(rect, sound, middle, end) for end in (candidate.chainage_low95_m, candidate.chainage_high95_m)]
    if not all(map(math.isfinite, ends)):
        return
    for colour, width in ((theme.outline, 4.0), (theme.cursor, 2.0)):
        painter.setPen(QPen(QColor(colour), width))
        for edge, inwards in ((rect.top() + 2, 1.0), (rect.bottom() - 2, -1.0)):
            for x in ends:
                painter.drawLine(QPointF(x, edge), QPointF(x, edge + inwards * _BRACKET * rect.height()))
            painter.drawLine(QPointF(ends[0], edge), QPointF(ends[1], edge))


def _paint_band(painter: QPainter, theme: Theme, rect: QRectF, row: CandidateRow, sound: GallerySound) -> None:
    """Draw the band in which the candidate stood out: short strokes at both sides, so that they hide no sound."""
    for hz in row.candidate.band_hz:
        y = rect.bottom() - float(sound.frequency.fraction(max(hz, 1.0))) * rect.height()
        y = min(max(y, rect.top() + 1), rect.bottom() - 1)
        stroke = 0.09 * rect.width()
        for colour, width in ((theme.outline, 4.0), (theme.curve_second, 2.0)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawLine(QPointF(rect.left(), y), QPointF(rect.left() + stroke, y))
            painter.drawLine(QPointF(rect.right() - stroke, y), QPointF(rect.right(), y))


def _paint_level(
    painter: QPainter, theme: Theme, rect: QRectF, row: CandidateRow, sound: GallerySound, top_db: float
) -> None:
    """Draw the level over the local background, 0 dB and the threshold dashed, and ticks every four metres."""
    painter.save()
    painter.setClipRect(rect)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    middle = sound.middle(row.candidate)
    per_db = (rect.height() - 6) / (top_db - _LOW_DB)
    zero = rect.bottom() - 4 + _LOW_DB * per_db
    painter.setPen(QPen(QColor(theme.grid), 1))
    painter.drawLine(QPointF(rect.left(), zero), QPointF(rect.right(), zero))
    painter.setPen(QPen(QColor(theme.text), 1))
    for step in range(-1, 2):
        x = _x(rect, sound, 0.0, step * _TICK_M)
        painter.drawLine(QPointF(x, rect.bottom() - 4), QPointF(x, rect.bottom()))
    places, over, limit = sound.curve(row.candidate)
    if len(places) > 1:
        xs = rect.left() + (places - middle + sound.half) / (2.0 * sound.half) * rect.width()
        lines = ((limit, QPen(QColor(theme.curve_second), 1.2, Qt.PenStyle.DashLine)),
                 (over, QPen(QColor(theme.curve), max(1.5, theme.line_width))))  # fmt: skip
        for values, pen in lines:
            painter.setPen(pen)
            for line in _polylines(xs, rect.bottom() - 4 - (values - _LOW_DB) * per_db):
                painter.drawPolyline(line)
    painter.restore()


def _polylines(xs: FloatArray, ys: FloatArray) -> list[QPolygonF]:
    """Return the curve in pieces, in pixels: there is none where it is not known."""
    known = np.isfinite(ys)
    breaks = np.flatnonzero(np.diff(known.astype(np.int8))) + 1
    return [
        QPolygonF(list(map(QPointF, xs[piece].tolist(), ys[piece].tolist())))
        for piece in np.split(np.arange(len(xs)), breaks)
        if len(piece) > 1 and known[piece[0]]
    ]
