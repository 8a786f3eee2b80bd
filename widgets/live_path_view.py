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

_MOST_POINTS = 2000  # of the path that are drawn
_LEAST_M = 4.0  # the plan is never closer than this


@dataclass(frozen=True)
class LivePlace:
    """What is known of the ball's place: ``points_m`` (n, 2) east and north so far, the newest last."""

    points_m: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
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
        self.setAccessibleName(self.tr("Live path"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(180, 110)

    def sizeHint(self) -> QSize:
        """Prefer some height."""
        return QSize(320, 200)

    def set_place(self, place: LivePlace) -> None:
        """Show this."""
        self._place = place
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def words(self) -> tuple[str, str]:
        """Return the two lines of figures: place, and motion."""
        place, locale = self._place, self.locale()
        where = "–"
        if place.chainage_m is not None:
            where = f"{number_text(place.chainage_m, 1, locale)} m"
            if place.sigma_m is not None:
                where += f" ± {number_text(2.0 * place.sigma_m, 1, locale)} m"
        speed = "" if place.speed_mps is None else f"{number_text(place.speed_mps, 2, locale)} m/s"
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
        still = QColor(theme.verdicts[Verdict.UNSURE] if self._place.is_still else theme.verdicts[Verdict.CONFIRMED])
        painter.setPen(still)
        painter.drawText(QRectF(8, line + 2, self.width() - 16, below), Qt.AlignmentFlag.AlignLeft, how)
        plan = QRectF(8, line + below + 6, self.width() - 16, self.height() - line - below - 14)
        if plan.height() > 30:
            self._paint_plan(painter, plan)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.drawRect(QRectF(self.rect()).adjusted(0, 0, -1, -1))

    def _paint_plan(self, painter: QPainter, rect: QRectF) -> None:
        points, theme = self._place.points_m, self._theme
        if not len(points):
            painter.setPen(QColor(theme.text))
            painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, self.tr("No path yet"))
            return
        low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
        middle, size = 0.5 * (low + high), np.maximum(high - low, _LEAST_M)
        scale = min(rect.width() / (1.1 * size[0]), rect.height() / (1.1 * size[1]))

        def pixel(east: float, north: float) -> QPointF:
            x = rect.center().x() + scale * (east - middle[0])
            return QPointF(x, rect.center().y() - scale * (north - middle[1]))

        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        shown = points[:: -max(1, -(-len(points) // _MOST_POINTS))][::-1]
        painter.setPen(QPen(QColor(theme.curve), 1.5 + theme.line_width))
        painter.drawPolyline(QPolygonF([pixel(float(east), float(north)) for east, north in shown]))
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.setBrush(QColor(theme.canvas))
        painter.drawRect(QRectF(pixel(*points[0]) - QPointF(4, 4), pixel(*points[0]) + QPointF(4, 4)))
        for name, east, north in self._place.marks:
            at = pixel(east, north)
            painter.setPen(QPen(QColor(theme.tie_point), 2))
            painter.drawLine(at + QPointF(0, -10), at)
            painter.drawText(at + QPointF(3, -4), name)
        painter.setPen(QPen(QColor(theme.canvas), 2))
        painter.setBrush(QColor(theme.cursor))
        painter.drawEllipse(pixel(*points[-1]), 7, 7)
        self._paint_length(painter, rect, scale)

    def _paint_length(self, painter: QPainter, rect: QRectF, scale: float) -> None:
        """Draw a bar of a round number of metres."""
        theme = self._theme
        wanted = 0.25 * rect.width() / scale
        ten = 10.0 ** np.floor(np.log10(wanted))
        metres = float(ten * max(step for step in (1, 2, 5) if step * ten <= wanted))
        left, right, y = rect.right() - scale * metres, rect.right(), rect.bottom() - 2
        painter.setPen(QPen(QColor(theme.text), 2))
        painter.drawLine(QPointF(left, y), QPointF(right, y))
        text = f"{number_text(metres, 0 if metres >= 1 else 1, self.locale())} m"
        height = theme.metrics().height()
        box = QRectF(right - 100, y - height - 2, 100, height)
        painter.drawText(box, Qt.AlignmentFlag.AlignRight, text)
