"""Where the ball goes, as far as can be told while it runs: a small plan, chainage ±, speed, still or moving."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray, Verdict
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.units import length_unit, quantities, speed_text

_MOST_POINTS = 2000  # of the path that are drawn
_LEAST_M = 4.0  # the plan is never closer than this


@dataclass(frozen=True)
class LivePlace:
    """What is known of the ball's place: ``points_m`` (n, 2) east and north so far, and ``here_m`` where it is now."""

    points_m: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    here_m: tuple[float, float] | None = None
    chainage_m: float | None = None
    sigma_m: float | None = None
    speed_mps: float | None = None
    is_still: bool | None = None
    marks: Sequence[tuple[str, float, float]] = ()  # name, east, north


class LivePathView(PaintedWidget):
    """Draws a :class:`LivePlace`."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._place = LivePlace()
        self._way = QPolygonF()  # of the place's points, in metres, north down
        self._bounds = np.zeros((2, 2))
        self._is_stale = False
        self.setAccessibleName(self.tr("Live path"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(180, 110)

    def sizeHint(self) -> QSize:
        """Prefer some height."""
        return QSize(320, 200)

    def set_place(self, place: LivePlace) -> None:
        """Show this."""
        if place.points_m is not self._place.points_m:
            every = max(1, -(-len(place.points_m) // _MOST_POINTS))
            self._way = QPolygonF([QPointF(east, -north) for east, north in place.points_m[::every].tolist()])
            self._bounds = _bounds(place.points_m)
        self._place = place
        self.update()

    def set_stale(self, *, stale: bool) -> None:
        """Say that what is shown is where it was when it was last heard of."""
        if stale != self._is_stale:
            self._is_stale = stale
            self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def words(self) -> tuple[str, str]:
        """Return the two lines of figures: place, and motion."""
        place = self._place
        where = "–"
        if place.chainage_m is not None:
            where = quantities().place(place.chainage_m)
            if place.sigma_m is not None:
                where += f" ± {quantities().length(2.0 * place.sigma_m)}"
        if self._is_stale and place.chainage_m is not None:
            return where, self.tr("? last known place")
        speed = "" if place.speed_mps is None else speed_text(place.speed_mps)
        how = {True: self.tr("■ still"), False: self.tr("▶ moving"), None: ""}[place.is_still]
        return where, "   ".join(part for part in (how, speed) if part)

    def _paint(self, painter: QPainter) -> None:
        theme = self._theme
        font = theme.font()
        painter.fillRect(self.rect(), QColor(theme.canvas))
        big = theme.font()
        big.setPointSizeF(1.5 * big.pointSizeF())
        big.setBold(True)
        painter.setFont(big)
        line = painter.fontMetrics().height()
        where, how = self.words()
        painter.setPen(QColor(theme.text))
        painter.drawText(QRectF(8, 2, self.width() - 16, line), Qt.AlignmentFlag.AlignLeft, where)
        font.setBold(True)
        painter.setFont(font)
        below = theme.metrics().height()
        unsure = self._place.is_still or self._is_stale
        painter.setPen(QColor(theme.verdicts[Verdict.UNSURE if unsure else Verdict.CONFIRMED]))
        painter.drawText(QRectF(8, line + 2, self.width() - 16, below), Qt.AlignmentFlag.AlignLeft, how)
        plan = QRectF(8, line + below + 6, self.width() - 16, self.height() - line - below - 14)
        if plan.height() > 30:
            self._paint_plan(painter, plan)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.drawRect(QRectF(self.rect()).adjusted(0, 0, -1, -1))

    def _paint_plan(self, painter: QPainter, rect: QRectF) -> None:
        here, theme = self._place.here_m, self._theme
        if here is None:
            painter.setPen(QColor(theme.text))
            painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, self.tr("No path yet"))
            return
        points = self._place.points_m
        low, high = (
            (np.minimum(self._bounds[0], here), np.maximum(self._bounds[1], here)) if len(points) else (here, here)
        )
        middle, size = 0.5 * np.add(low, high), np.maximum(np.subtract(high, low), _LEAST_M)
        scale = float(min(rect.width() / (1.1 * size[0]), rect.height() / (1.1 * size[1])))

        def pixel(east: float, north: float) -> QPointF:
            x = rect.center().x() + scale * (east - middle[0])
            return QPointF(x, rect.center().y() - scale * (north - middle[1]))

        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        pen = QPen(QColor(theme.curve), 1.5 + theme.line_width)
        pen.setCosmetic(True)
        painter.setPen(pen)
        painter.save()
        painter.translate(rect.center().x() - scale * middle[0], rect.center().y() + scale * middle[1])
        painter.scale(scale, scale)
        painter.drawPolyline(self._way)
        if len(points):
            painter.drawLine(QPointF(points[-1, 0], -points[-1, 1]), QPointF(here[0], -here[1]))
        painter.restore()
        start = pixel(*points[0]) if len(points) else pixel(*here)
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.setBrush(QColor(theme.canvas))
        painter.drawRect(QRectF(start - QPointF(4, 4), start + QPointF(4, 4)))
        for name, east, north in self._place.marks:
            at = pixel(east, north)
            painter.setPen(QPen(QColor(theme.tie_point), 2))
            painter.drawLine(at + QPointF(0, -10), at)
            painter.drawText(at + QPointF(3, -4), name)
        painter.setPen(QPen(QColor(theme.canvas), 2))
        painter.setBrush(QColor(theme.cursor))
        painter.drawEllipse(pixel(*here), 7, 7)
        self._paint_length(painter, rect, scale)

    def _paint_length(self, painter: QPainter, rect: QRectF, scale: float) -> None:
        """Draw a bar of a round number of metres or feet."""
        theme = self._theme
        unit = length_unit()
        wanted = 0.25 * rect.width() / (scale * unit.factor)
        ten = 10.0 ** np.floor(np.log10(wanted))
        length = float(ten * max(step for step in (1, 2, 5) if step * ten <= wanted))
        left, right, y = rect.right() - scale * unit.factor * length, rect.right(), rect.bottom() - 2
        painter.setPen(QPen(QColor(theme.text), 2))
        painter.drawLine(QPointF(left, y), QPointF(right, y))
        text = f"{number_text(length, 0 if length >= 1 else 1, self.locale())} {unit.sign}"
        height = theme.metrics().height()
        box = QRectF(right - 100, y - height - 2, 100, height)
        painter.drawText(box, Qt.AlignmentFlag.AlignRight, text)


def _bounds(points_m: FloatArray) -> FloatArray:
    """Return least and greatest east and north (2, 2)."""
    return np.array([points_m.min(axis=0), points_m.max(axis=0)]) if len(points_m) else np.zeros((2, 2))
