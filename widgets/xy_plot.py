"""A plot of its own axes, linear or logarithmic, for pages that have no common time: zoom, pan, ticks, a hint."""

import math
from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPen, QPolygonF, QWheelEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import Scale, ScaleKind, hertz_text, number_text, tick_digits
from widgets.plot_theme import LIGHT, Theme

ZOOM_STEP = 0.8
CLICK_PIXELS = 4
_LEAST_PART = 1e-4


class XyPlot(PaintedWidget):
    """Wheel zooms about the mouse, drag pans, double click or F shows all; subclasses paint their data.

    Keys: plus and minus (Page Up and Down too) zoom, Shift with the arrows pans.
    """

    pointed = Signal(str)  # what lies under the mouse, in words; empty when it has left

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._hint = ""
        self._x_name, self._y_name = "", ""
        self._whole = Scale(0.0, 1.0)
        self._x = self._whole
        self._y = Scale(0.0, 1.0)
        self._pressed: QPointF | None = None
        self._moved = False
        self._at_press = self._x
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    # --- what it is told ---

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def set_hint(self, text: str) -> None:
        """Say this where there is nothing to show; empty shows the data."""
        self._hint = text
        self.update()

    @property
    def x_range(self) -> tuple[float, float]:
        """What is visible of the horizontal axis."""
        return self._x.low, self._x.high

    def set_x_range(self, low: float, high: float) -> None:
        """Show this part, as far as there is anything."""
        low, high = max(low, self._whole.low), min(high, self._whole.high)
        if high - low > _LEAST_PART * (self._whole.high - self._whole.low):
            self._x = Scale(low, high, self._whole.kind)
            self.update()

    def fit(self) -> None:
        """Show everything."""
        self._x = self._whole
        self.update()

    def _set_whole(self, scale: Scale) -> None:
        """Let the axis reach this far; what was zoomed stays zoomed while it lies within."""
        same = scale.kind is self._whole.kind
        zoomed = self._x != self._whole and same and scale.low <= self._x.low and self._x.high <= scale.high
        self._whole = scale
        if not zoomed:
            self._x = scale

    # --- geometry ---

    def plot_rect(self) -> QRectF:
        """Return where data are drawn."""
        metrics = self._theme.metrics()
        left = 2.6 * metrics.height() + metrics.horizontalAdvance("0.00")
        top, bottom = self._room_above(), 2.7 * metrics.height()
        return QRectF(left, top, max(1.0, self.width() - left - 14.0), max(1.0, self.height() - top - bottom))

    def _room_above(self) -> float:
        return 8.0

    def x_pixel(self, value: float) -> float:
        """Return the pixel of a value of the horizontal axis."""
        rect = self.plot_rect()
        return rect.left() + float(self._x.fraction(value)) * rect.width()

    def x_value(self, pixel: float) -> float:
        """Return the value of a pixel of the horizontal axis."""
        rect = self.plot_rect()
        return float(self._x.value((pixel - rect.left()) / rect.width()))

    def y_pixel(self, value: float) -> float:
        """Return the pixel of a value of the vertical axis."""
        rect = self.plot_rect()
        return rect.bottom() - float(self._y.fraction(value)) * rect.height()

    def sizeHint(self) -> QSize:
        """Prefer a wide plot."""
        return QSize(560, 200)

    def minimumSizeHint(self) -> QSize:
        """Need room for axes and a curve."""
        return QSize(240, 110)

    # --- painting ---

    def _paint(self, painter: QPainter) -> None:
        rect = self.plot_rect()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        painter.fillRect(self.rect(), QColor(self._theme.background))
        painter.fillRect(rect, QColor(self._theme.canvas))
        if self._hint:
            painter.setPen(QColor(self._theme.text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(rect.adjusted(20, 4, -20, -4), flags, self._hint)
        else:
            self._paint_axes(painter, rect)
            painter.save()
            painter.setClipRect(rect)
            self._paint_data(painter, rect)
            painter.restore()
            self._paint_over(painter, rect)
        painter.setPen(QPen(QColor(self._theme.text), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(rect)
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.accent), 2))
            painter.drawRect(QRectF(self.rect()).adjusted(1, 1, -1, -1))

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        """Paint the data; clipped to ``rect``."""

    def _paint_over(self, painter: QPainter, rect: QRectF) -> None:
        """Paint what may stand over the frame: names, flags."""

    def _paint_axes(self, painter: QPainter, rect: QRectF) -> None:
        metrics = self._theme.metrics()
        grid, text = QPen(QColor(self._theme.grid), 1), QColor(self._theme.text)
        values = self._x.ticks(max(3, int(rect.width() / (5.0 * metrics.averageCharWidth() + 30))))
        step = min((b - a for a, b in pairwise(values)), default=1.0)
        for value in values:
            x = self.x_pixel(value)
            painter.setPen(grid)
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
            painter.setPen(text)
            box = QRectF(x - 60, rect.bottom() + 2, 120, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._x_text(value, step))
        ticks = self._y.ticks(max(2, int(rect.height() / (2.2 * metrics.height()))))
        rise = min((b - a for a, b in pairwise(ticks)), default=1.0)
        for value in ticks:
            y = self.y_pixel(value)
            painter.setPen(grid)
            painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
            painter.setPen(text)
            box = QRectF(0.0, y - metrics.height(), rect.left() - 5, 2 * metrics.height())
            shown = number_text(value, tick_digits(rise), self.locale())
            painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, shown)
        below = QRectF(rect.left(), rect.bottom() + 1.2 * metrics.height(), rect.width(), 1.4 * metrics.height())
        painter.drawText(below, Qt.AlignmentFlag.AlignCenter, self._x_name)
        painter.save()
        painter.translate(0.75 * metrics.height(), rect.center().y())
        painter.rotate(-90.0)
        along = QRectF(-0.5 * self.height(), -0.7 * metrics.height(), self.height(), 1.4 * metrics.height())
        painter.drawText(along, Qt.AlignmentFlag.AlignCenter, self._y_name)
        painter.restore()

    def _x_text(self, value: float, step: float) -> str:
        if self._x.kind is ScaleKind.LOG:
            return hertz_text(value, self.locale())
        return number_text(value, tick_digits(step), self.locale())

    def _curve(self, painter: QPainter, x: FloatArray, y: FloatArray, colour: str, width: float = 1.0) -> None:
        """Draw a curve; where many points share a pixel column, from their lowest to their highest."""
        pixels, low, high = self._columns(x, y)
        if not len(pixels):
            return
        painter.setPen(QPen(QColor(colour), width * self._theme.line_width))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        points = np.column_stack([np.repeat(pixels, 2), np.column_stack([low, high]).ravel()])
        painter.drawPolyline(QPolygonF([QPointF(a, b) for a, b in points.tolist()]))

    def _columns(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        rect = self.plot_rect()
        place = rect.left() + self._x.fraction(x) * rect.width()
        seen = (place >= rect.left() - 50) & (place <= rect.right() + 50)
        place, value = place[seen], y[seen]
        height = rect.bottom() - self._y.fraction(value) * rect.height()
        height = np.clip(height, rect.top() - 1e4, rect.bottom() + 1e4)
        if len(place) < 2:
            return place, height, height
        if place[0] > place[-1]:
            place, height = place[::-1], height[::-1]
        if len(place) <= 2 * rect.width():
            return place, height, height
        column = np.floor(place).astype(np.int64)
        first = np.flatnonzero(np.concatenate([[True], column[1:] != column[:-1]]))
        low, high = np.minimum.reduceat(height, first), np.maximum.reduceat(height, first)
        return column[first].astype(np.float64), low, high

    def _shade(self, painter: QPainter, low: float, high: float, colour: str, alpha: int) -> None:
        """Fill between two values of the horizontal axis."""
        rect = self.plot_rect()
        left, right = sorted((self.x_pixel(low), self.x_pixel(high)))
        ground = QColor(colour)
        ground.setAlpha(alpha)
        painter.fillRect(QRectF(left, rect.top(), max(right - left, 1.0), rect.height()), ground)

    def _legend(self, painter: QPainter, rect: QRectF, entries: Iterable[tuple[str, str]]) -> None:
        """Write names in their colours into the upper right corner, right to left."""
        metrics = self._theme.metrics()
        right = rect.right() - 8
        for name, colour in reversed(list(entries)):
            width = metrics.horizontalAdvance(name)
            box = QRectF(right - width - 6, rect.top() + 3, width + 8, metrics.height() + 2)
            ground = QColor(self._theme.canvas)
            ground.setAlpha(215)
            painter.fillRect(box, ground)
            painter.setPen(QColor(colour))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, name)
            right -= width + 14

    # --- mouse and keys ---

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click or a pan."""
        if event.button() is Qt.MouseButton.LeftButton and not self._hint:
            self._pressed, self._moved, self._at_press = event.position(), False, self._x
            self._begin(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan, and tell what lies under the mouse."""
        place = event.position()
        if self._pressed is not None:
            self._moved = self._moved or math.dist(place.toTuple(), self._pressed.toTuple()) >= CLICK_PIXELS
            if self._moved and not self._drag(place):
                self._pan_from(self._pressed, place)
        inside = self.plot_rect().contains(place) and not self._hint
        self.pointed.emit(self._words_at(place) if inside else "")

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a pan; without one it was a click."""
        if event.button() is Qt.MouseButton.LeftButton and self._pressed is not None:
            self._pressed = None
            if self._moved:
                self._drop()
            else:
                self._click(event.position())

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Show everything."""
        del event
        self.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse."""
        self._zoom(ZOOM_STEP ** (event.angleDelta().y() / 120.0), event.position().x())
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing lies under the mouse any more."""
        super().leaveEvent(event)
        self.pointed.emit("")

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Zoom and pan."""
        key, shift = event.key(), event.modifiers() & Qt.KeyboardModifier.ShiftModifier
        middle = self.plot_rect().center()
        if key in (Qt.Key.Key_F, Qt.Key.Key_Home):
            self.fit()
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_PageUp):
            self._zoom(ZOOM_STEP**2, middle.x())
        elif key in (Qt.Key.Key_Minus, Qt.Key.Key_PageDown):
            self._zoom(ZOOM_STEP**-2, middle.x())
        elif shift and key in (Qt.Key.Key_Left, Qt.Key.Key_Right):
            self._at_press = self._x
            away = 0.1 * self.plot_rect().width() * (1 if key == Qt.Key.Key_Left else -1)
            self._pan_from(middle, middle + QPointF(away, 0.0))
        else:
            super().keyPressEvent(event)

    def _zoom(self, factor: float, pixel: float) -> None:
        rect = self.plot_rect()
        limits = (self._whole.low, self._whole.high)
        least = _LEAST_PART * (self._whole.high - self._whole.low)
        self._x = self._x.zoomed(factor, (pixel - rect.left()) / rect.width(), limits, least)
        self.update()

    def _pan_from(self, start: QPointF, place: QPointF) -> None:
        shift = (start.x() - place.x()) / self.plot_rect().width()
        whole, old = self._whole, self._at_press
        room_low, room_high = float(old.fraction(whole.low)), float(old.fraction(whole.high)) - 1.0
        shift = min(max(shift, room_low), room_high)
        self._x = Scale(float(old.value(shift)), float(old.value(1.0 + shift)), old.kind)
        self.update()

    def _begin(self, place: QPointF) -> None:
        """Take note of what was pressed."""
        del place

    def _drag(self, place: QPointF) -> bool:
        """Return whether something else than the axis follows the mouse."""
        del place
        return False

    def _drop(self) -> None:
        """Let go what followed the mouse."""

    def _click(self, place: QPointF) -> None:
        """Do what a click does here."""
        del place

    def _words_at(self, place: QPointF) -> str:
        """Return what lies under the mouse, in words."""
        del place
        return ""
