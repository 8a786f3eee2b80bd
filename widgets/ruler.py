"""The ruler that all views share: two moments to be measured between, and how it is drawn."""

import math

from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen

from widgets.plot_paint import paint_tag
from widgets.plot_theme import Theme

REACH_PIXELS = 20.0  # within which an end can be taken hold of: a finger in a glove
_TICK = 7.0


class Ruler(QObject):
    """Begins at a moment; while ``live`` its other end follows the cursor, then it stays until it is removed.

    Nothing that is not a finite moment changes it. Whoever knows the figures keeps ``label`` up to date.
    """

    changed = Signal()  # its ends, or whether it is there at all
    tool_changed = Signal(bool)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._ends_s: tuple[float, float] | None = None
        self._live = self._tool = False
        self.label = ""

    @property
    def ends_s(self) -> tuple[float, float] | None:
        """Where it began and where it ends, survey seconds; None while there is none."""
        return self._ends_s

    @property
    def live(self) -> bool:
        """Whether its second end follows the cursor."""
        return self._live

    @property
    def tool(self) -> bool:
        """Whether a plain drag in a view measures."""
        return self._tool

    def set_tool(self, on: bool) -> None:
        """Let a plain drag measure, or pan again."""
        if on != self._tool:
            self._tool = on
            self.tool_changed.emit(on)

    def press(self, time_s: float) -> None:
        """Begin at the cursor; the second time, end there; the third time, or where it has no length, remove it."""
        if self._ends_s is None:
            self._set((time_s, time_s), live=True)
        elif self._live and self._ends_s[0] != self._ends_s[1]:
            self._set(self._ends_s, live=False)
        else:
            self.remove()

    def follow(self, time_s: float) -> None:
        """Let the live end be where the cursor is."""
        if self._live and self._ends_s is not None:
            self._set((self._ends_s[0], time_s), live=True)

    def set_ends(self, first_s: float, second_s: float) -> None:
        """Measure between two moments, and stay there."""
        self._set((first_s, second_s), live=False)

    def take_other_end(self) -> float | None:
        """Let the cursor move the end that stood still; returns where that is, None without a ruler."""
        if self._ends_s is None:
            return None
        first, second = self._ends_s
        self._set((second, first), live=True)
        return first

    def remove(self) -> None:
        """Measure nothing."""
        if self._ends_s is not None:
            self._ends_s, self._live, self.label = None, False, ""
            self.changed.emit()

    def _set(self, ends_s: tuple[float, float], *, live: bool) -> None:
        if all(map(math.isfinite, ends_s)) and (ends_s, live) != (self._ends_s, self._live):
            self._ends_s, self._live = ends_s, live
            self.changed.emit()


def paint_ruler(painter: QPainter, theme: Theme, rect: QRectF, ends: tuple[float, float]) -> None:
    """Draw a ruler between two pixels of the common axis into a plot."""
    left, right = sorted(ends)
    area = QRectF(left, rect.top(), max(right - left, 1.0), rect.height()).intersected(rect)
    if right < rect.left() or left > rect.right():
        return
    painter.save()
    painter.setClipRect(rect)
    veil = QColor(theme.curve_second)
    veil.setAlpha(38)
    painter.fillRect(area, veil)
    middle = rect.top() + 0.5 * rect.height()
    lines = [(QPointF(x, rect.top()), QPointF(x, rect.bottom())) for x in (left, right)]
    lines.append((QPointF(left, middle), QPointF(right, middle)))
    for colour, more in ((theme.outline, 3.0), (theme.curve_second, 0.0)):
        painter.setPen(QPen(QColor(colour), 1.0 + 0.5 * theme.line_width + more))
        for start, stop in lines:
            painter.drawLine(start, stop)
        for x, ahead in ((left, _TICK), (right, -_TICK)):
            if right - left > 3 * _TICK:
                painter.drawPolyline(
                    [QPointF(x + ahead, middle - _TICK), QPointF(x, middle), QPointF(x + ahead, middle + _TICK)]
                )
    painter.restore()


def paint_ruler_label(painter: QPainter, theme: Theme, rect: QRectF, ends: tuple[float, float], label: str) -> None:
    """Write what a ruler tells above its line, where the plot has room for that."""
    left, right = sorted(ends)
    if right < rect.left() or left > rect.right() or not label:
        return
    metrics = theme.metrics()
    width, height = metrics.horizontalAdvance(label) + 14.0, metrics.height() + 4.0
    if rect.height() >= 3.0 * height and rect.width() >= width:
        centre = 0.5 * (max(left, rect.left()) + min(right, rect.right()))
        x = min(max(centre - 0.5 * width, rect.left() + 2), rect.right() - width - 2)
        y = rect.center().y() - height - 6.0
        paint_tag(painter, theme, label, QRectF(x, y, width, height), strong=True)


def paint_ruler_on_plan(painter: QPainter, theme: Theme, pixels: list[QPointF]) -> None:
    """Draw a ruler along the path, ``pixels`` being its way from end to end."""
    if not pixels:
        return
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for colour, more in ((theme.outline, 4.0), (theme.curve_second, 0.0)):
        painter.setPen(QPen(QColor(colour), 2.0 + 1.5 * theme.line_width + more, Qt.PenStyle.SolidLine,
                            Qt.PenCapStyle.FlatCap, Qt.PenJoinStyle.RoundJoin))  # fmt: skip
        painter.drawPolyline(pixels)
    for place in (pixels[0], pixels[-1]):
        painter.setPen(QPen(QColor(theme.outline), 2.0))
        painter.setBrush(QColor(theme.curve_second))
        painter.drawEllipse(place, _TICK, _TICK)
    painter.restore()


def paint_ruler_label_on_plan(painter: QPainter, theme: Theme, pixels: list[QPointF], label: str, room: QRectF) -> None:
    """Write what a ruler tells above the middle of its way, within ``room``."""
    if not pixels:
        return
    metrics, middle = theme.metrics(), pixels[len(pixels) // 2]
    width, height = metrics.horizontalAdvance(label) + 14.0, metrics.height() + 4.0
    if label and room.width() > width and room.adjusted(-40, -40, 40, 40).contains(middle):
        x = min(max(middle.x() - 0.5 * width, room.left() + 4), room.right() - width - 4)
        y = min(max(middle.y() - height - 28.0, room.top() + 4), room.bottom() - height - 4)
        paint_tag(painter, theme, label, QRectF(x, y, width, height), strong=True)
