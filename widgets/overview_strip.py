"""The whole run at a glance: its level, its candidates, and the visible range as a window that can be dragged."""

import math

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QWidget

from processing.survey import FloatArray
from widgets.curve_plot import Curve, CurvePlot, padded
from widgets.envelope import EnvelopePyramid, joined
from widgets.linked_plot import Drag
from widgets.plot_theme import LIGHT, Theme
from widgets.time_cursor import TimeCursor

EDGE_PIXELS = 6.0
LEAST_WINDOW_PIXELS = 4.0


class OverviewStrip(CurvePlot):
    """Always shows the whole extent. Drag the window to pan, its edges to zoom; a click elsewhere brings it there."""

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self.setAccessibleName(self.tr("Overview of the whole run"))
        self._curves: tuple[Curve, Curve] | None = None
        self._item = self._new_curve()
        # a new range only moves the window: what is drawn stays good
        cursor.range_changed.disconnect(self.invalidate_in_turn)
        cursor.range_changed.connect(self.refresh)

    def set_envelope(self, time_s: FloatArray, low: FloatArray, high: FloatArray) -> None:
        """Show the whole run as minima and maxima (n,) at survey seconds ``time_s`` (n,); empty shows none."""
        self._curves = None
        if len(time_s):
            first, second = (EnvelopePyramid.build(time_s, v, gap=math.inf) for v in (low, high))
            self._curves = (Curve(first), Curve(second))
            ends = [s for s in (first.span(), second.span()) if s is not None]
            whole = (min(s[0] for s in ends), max(s[1] for s in ends)) if ends else None
            self._set_whole(*padded(whole, 1e-6))
        self.invalidate()

    def set_level(self, time_s: FloatArray, level: FloatArray) -> None:
        """Show the whole run as one curve."""
        self.set_envelope(time_s, level, level)

    def x_span(self) -> tuple[float, float]:
        """Return the whole extent."""
        return self._cursor.x_extent

    def window_rect(self) -> QRectF:
        """Return the window of the visible range, in pixels."""
        rect, (low, high) = self.plot_rect(), self._cursor.x_range
        left, right = self.pixel_of_x(low), self.pixel_of_x(high)
        spare = 0.5 * max(0.0, LEAST_WINDOW_PIXELS - (right - left))
        return QRectF(left - spare, rect.top(), right - left + 2.0 * spare, rect.height())

    def sizeHint(self) -> QSize:
        """Prefer a low strip."""
        return QSize(640, round(4.5 * self._theme.metrics().height()))

    def _show_data(self) -> None:
        self._show_scale(None)
        if self._curves is None:
            self._item.hide()
            return
        count = self.columns()
        low = self._curves[0].columns(self._cursor, count, whole=True)[0]
        high = self._curves[1].columns(self._cursor, count, whole=True)[1]
        self._show_columns(self._item, *joined(low, high), QColor(self._theme.curve), 1.0)

    def _paint_over(self, painter: QPainter) -> None:
        rect, window = self.plot_rect(), self.window_rect()
        veil = QColor(self._theme.background)
        veil.setAlpha(170)
        painter.fillRect(QRectF(rect.topLeft(), QPointF(window.left(), rect.bottom())).intersected(rect), veil)
        painter.fillRect(QRectF(QPointF(window.right(), rect.top()), rect.bottomRight()).intersected(rect), veil)
        painter.setPen(QPen(QColor(self._theme.accent), 2))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(window)
        super()._paint_over(painter)

    def _grab(self, place: QPointF) -> Drag | None:
        window, rect = self.window_rect(), self.plot_rect()
        if not rect.adjusted(-EDGE_PIXELS, 0, EDGE_PIXELS, 0).contains(place):
            return None
        low, high = self._cursor.x_range
        if window.width() > 3 * EDGE_PIXELS:
            if abs(place.x() - window.left()) <= EDGE_PIXELS:
                return lambda p: self._cursor.set_x_range(min(self.x_of_pixel(p.x()), high), high)
            if abs(place.x() - window.right()) <= EDGE_PIXELS:
                return lambda p: self._cursor.set_x_range(low, max(self.x_of_pixel(p.x()), low))
        start = self.x_of_pixel(place.x())
        inside = window.left() - EDGE_PIXELS <= place.x() <= window.right() + EDGE_PIXELS
        from_low = low if inside else start - 0.5 * (high - low)

        def drag(p: QPointF) -> None:
            new = from_low + self.x_of_pixel(p.x()) - start
            first, last = self._cursor.x_extent
            new = min(max(new, first), last - (high - low))
            self._cursor.set_x_range(new, new + (high - low))

        return drag

    def _click(self, place: QPointF) -> None:
        low, high = self._cursor.x_range
        x = self.x_of_pixel(place.x())
        on_candidate = self.candidate_at(place) is not None
        if self.plot_rect().contains(place) and not on_candidate and not low <= x <= high:
            self._cursor.pan(x - 0.5 * (low + high))
        super()._click(place)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag, and show what the mouse would take hold of."""
        super().mouseMoveEvent(event)
        window, x = self.window_rect(), event.position().x()
        at_edge = min(abs(x - window.left()), abs(x - window.right())) <= EDGE_PIXELS
        if at_edge and window.width() > 3 * EDGE_PIXELS:
            self.setCursor(Qt.CursorShape.SizeHorCursor)

    def _pinch(self, factor: float, before: QPointF, now: QPointF) -> None:
        """Zoom about the fingers, and let the window go with them."""
        super()._pinch(factor, before, before)
        self._cursor.pan(self.x_of_pixel(now.x()) - self.x_of_pixel(before.x()))

    def mark_radius(self) -> float:
        """Return the size of a candidate's mark: small, there are many."""
        return 0.28 * self._theme.metrics().height()
