"""The tie points on a stacked plot: a dashed line and a flag at the moment the device passed, which can be dragged."""

import math
from collections.abc import Callable, Sequence

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from processing.survey import TiePoint
from widgets.plot_paint import edges_of, free_box, paint_tag
from widgets.plot_theme import Theme

REACH_PIXELS = 14.0  # about a flag at the foot of the plot
HALF_FLAG = 5.0


class TieFlags:
    """Knows the tie points of a plot; ``pixel_of_time`` places them, ``height_of`` may lift a flag off the foot."""

    def __init__(
        self, pixel_of_time: Callable[[float], float], height_of: Callable[[TiePoint, QRectF], float | None]
    ) -> None:
        self.tie_points: tuple[TiePoint, ...] = ()
        self._pixel_of_time, self._height_of = pixel_of_time, height_of

    def set_tie_points(self, tie_points: Sequence[TiePoint]) -> None:
        """Take these."""
        self.tie_points = tuple(tie_points)

    def at(self, place: QPointF, rect: QRectF) -> int | None:
        """Return the number of the tie point whose flag lies under a pixel of a plot, the nearest one."""
        away = []
        for number, tie in enumerate(self.tie_points):
            centre = self._centre(tie, rect)
            if centre is not None:
                away.append((math.dist(centre.toTuple(), place.toTuple()), number))
        near = [pair for pair in away if pair[0] <= REACH_PIXELS]
        return min(near)[1] if near else None

    def _centre(self, tie: TiePoint, rect: QRectF) -> QPointF | None:
        x = self._pixel_of_time(tie.time_s) if math.isfinite(tie.time_s) else math.nan
        if not rect.left() <= x <= rect.right():
            return None
        y = self._height_of(tie, rect)
        return QPointF(x, rect.bottom() - HALF_FLAG if y is None else y)

    def paint(self, painter: QPainter, theme: Theme, rect: QRectF) -> None:
        """Draw lines, flags (hollow where they do not pull), and names where there is room."""
        taken: list[tuple[float, float, float, float]] = []
        metrics, colour = theme.metrics(), QColor(theme.tie_point)
        for tie in self.tie_points:
            centre = self._centre(tie, rect)
            if centre is None:
                continue
            painter.setPen(QPen(colour, 1, Qt.PenStyle.DashLine))
            painter.drawLine(QPointF(centre.x(), rect.top()), QPointF(centre.x(), rect.bottom()))
            flag = QRectF(centre.x() - HALF_FLAG, centre.y() - HALF_FLAG, 2 * HALF_FLAG, 2 * HALF_FLAG)
            if tie.enabled:
                painter.fillRect(flag, colour)
            else:
                painter.setPen(QPen(colour, 1.5))
                painter.setBrush(QColor(theme.canvas))
                painter.drawRect(flag)
            width = metrics.horizontalAdvance(tie.name) + 8
            box = free_box(width, metrics.height(), centre, HALF_FLAG + 2, taken, rect)
            if box is not None and tie.name:
                taken.append(edges_of(box))
                paint_tag(painter, theme, tie.name, box)
