"""The frame that all stacked plots share: common axis, cursor line, candidates and hatched stretches.

A plot is painted once into a pixmap; a moving cursor only lays that pixmap down again under its line. Subclasses paint
their data and their vertical axes.
"""

import math
from collections.abc import Mapping, Sequence

from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFocusEvent, QPainter, QPaintEvent, QPen, QPixmap, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import Candidate, Channel, Decision, Stretch
from widgets.plot_marks import Marks, report_paint_error
from widgets.plot_paint import paint_hatch
from widgets.plot_theme import LIGHT, Theme, VerdictMarks
from widgets.time_axis import AxisMode, x_text, x_ticks
from widgets.time_cursor import TimeCursor


class PlotFrame(QWidget):
    """A plot over the common axis; ``cursor`` is shared by all of them."""

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(parent)
        self._cursor, self._theme = cursor, theme
        self._show_x_axis = show_x_axis
        self._marks = Marks()
        self._not_assessed: tuple[Stretch, ...] = ()
        self._channel: Channel | None = None  # which stretches concern this plot; None: all
        self._pixmap = QPixmap()
        self._stale = True
        self._rect: QRectF | None = None
        self._mark_pixmaps: VerdictMarks | None = None
        self._painted_cursor_x = math.nan
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        cursor.moved.connect(self._follow_cursor)
        cursor.range_changed.connect(self.invalidate)
        cursor.axis_changed.connect(self.invalidate)
        cursor.selection_changed.connect(self.update)

    # --- what it is told ----------------------------------------------------------------------------------------

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme, self._rect = theme, None
        self.updateGeometry()
        self.invalidate()

    def set_x_axis_visible(self, visible: bool) -> None:
        """Show or hide the ticks of the common axis; of stacked plots only the lowest needs them."""
        self._show_x_axis, self._rect = visible, None
        self.invalidate()

    def set_candidates(self, candidates: Sequence[Candidate], decisions: Mapping[int, Decision] | None = None) -> None:
        """Show these candidates, each with the mark of its verdict."""
        self._marks = Marks(tuple(candidates), dict(decisions or {}), self._marks.selected)
        self.invalidate()

    def set_selected(self, candidate_id: int | None) -> None:
        """Ring one candidate; None rings none."""
        self._marks = Marks(self._marks.candidates, self._marks.decisions, candidate_id)
        self.invalidate()

    def set_not_assessed(self, stretches: Sequence[Stretch]) -> None:
        """Hatch what cannot be assessed, as far as it concerns this plot."""
        wanted = tuple(s for s in stretches if self._channel is None or s.channel is self._channel)
        self._not_assessed = wanted
        self.invalidate()

    # --- geometry -----------------------------------------------------------------------------------------------

    def plot_rect(self) -> QRectF:
        """Return where data are drawn; its left and right edge are the same for all plots of one width and theme."""
        if self._rect is None:
            metrics = self._theme.metrics()
            left = math.ceil(self._axis_left() + metrics.horizontalAdvance("00000") + 8)
            right = math.ceil(metrics.horizontalAdvance("−100.0 dB") + 10)
            bottom = math.ceil(1.5 * metrics.height()) if self._show_x_axis else 3
            width, height = self.width() - left - right, self.height() - 4 - bottom
            self._rect = QRectF(left, 4.0, max(1.0, width), max(1.0, height))
        return self._rect

    def x_span(self) -> tuple[float, float]:
        """Return which span of the common axis the plot shows, in the axis' unit."""
        return self._cursor.x_range

    def columns(self) -> int:
        """Return how many device pixels the plot is wide."""
        return max(1, round(self.plot_rect().width() * self.devicePixelRatioF()))

    def pixel_of_x(self, x: float) -> float:
        """Return the widget's pixel of a place on the common axis."""
        rect, (low, high) = self.plot_rect(), self.x_span()
        return rect.left() + (x - low) / (high - low) * rect.width()

    def x_of_pixel(self, pixel: float) -> float:
        """Return the place on the common axis of one of the widget's pixels."""
        rect, (low, high) = self.plot_rect(), self.x_span()
        return low + (pixel - rect.left()) / rect.width() * (high - low)

    def pixel_of_time(self, time_s: float) -> float:
        """Return the widget's pixel of a moment."""
        return self.pixel_of_x(float(self._cursor.x_of_time(time_s)))

    def time_of_pixel(self, pixel: float) -> float:
        """Return the moment of one of the widget's pixels."""
        return float(self._cursor.time_of_x(self.x_of_pixel(pixel)))

    def candidate_pixel(self, candidate: Candidate) -> float:
        """Return the widget's pixel of a candidate; NaN where its place is unknown."""
        in_metres = self._cursor.axis_mode is AxisMode.DISTANCE and math.isfinite(candidate.chainage_m)
        if in_metres:
            return self.pixel_of_x(candidate.chainage_m)
        return self.pixel_of_time(candidate.time_s) if math.isfinite(candidate.time_s) else math.nan

    def candidate_at(self, place: QPointF) -> int | None:
        """Return the id of the candidate whose mark lies under a pixel."""
        radius = self.mark_radius() + 4
        for candidate in reversed(self._marks.in_drawing_order):
            centre = self._mark_centre(candidate)
            if centre is not None and math.dist(centre.toTuple(), place.toTuple()) <= radius:
                return candidate.id
        return None

    def mark_radius(self) -> float:
        """Return the size of a candidate's mark."""
        return 0.42 * self._theme.metrics().height()

    def sizeHint(self) -> QSize:
        """Prefer a wide and low plot."""
        return QSize(640, round(9 * self._theme.metrics().height()))

    def minimumSizeHint(self) -> QSize:
        """Need room for the axes and a little curve."""
        return QSize(220, round(3.2 * self._theme.metrics().height()))

    def _axis_left(self) -> float:
        return 1.3 * self._theme.metrics().height()

    def _mark_centre(self, candidate: Candidate) -> QPointF | None:
        """Return where a candidate's mark stands: at the top edge; subclasses may know better."""
        x, rect = self.candidate_pixel(candidate), self.plot_rect()
        if not (math.isfinite(x) and rect.left() - 1 <= x <= rect.right() + 1):
            return None
        return QPointF(x, rect.top() + self.mark_radius() + 3)

    # --- what subclasses paint ----------------------------------------------------------------------------------

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        """Paint grid, vertical axis and data."""
        raise NotImplementedError

    def _paint_values(self, painter: QPainter, rect: QRectF) -> None:
        """Write into ``rect``, right of the plot, what the data are at the cursor; called at every move."""

    # --- painting -----------------------------------------------------------------------------------------------

    def invalidate(self) -> None:
        """Have everything painted anew."""
        self._stale = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Lay down the pixmap, made anew if it is stale, and the cursor over it."""
        painter = QPainter()
        try:
            if self._stale:
                self._paint_pixmap()
            painter.begin(self)
            ratio = self._pixmap.devicePixelRatioF()
            area = event.rect()
            source = QRectF(area.x() * ratio, area.y() * ratio, area.width() * ratio, area.height() * ratio)
            painter.drawPixmap(QRectF(area), self._pixmap, source)
            self._paint_over(painter)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()
        finally:
            if painter.isActive():
                painter.end()

    def _paint_pixmap(self) -> None:
        ratio = self.devicePixelRatioF()
        self._pixmap = QPixmap(round(self.width() * ratio), round(self.height() * ratio))
        self._pixmap.setDevicePixelRatio(ratio)
        self._stale = False
        painter = QPainter(self._pixmap)
        try:
            rect = self.plot_rect()
            painter.fillRect(self.rect(), QColor(self._theme.background))
            painter.fillRect(rect, QColor(self._theme.canvas))
            painter.setFont(self._theme.font())
            self._paint_x_axis(painter, rect)
            self._paint_data(painter, rect)
            self._paint_not_assessed(painter, rect)
            self._paint_marks(painter, rect)
            painter.setPen(QPen(QColor(self._theme.text), 1))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(rect)
        finally:
            painter.end()

    def _paint_x_axis(self, painter: QPainter, rect: QRectF) -> None:
        metrics, mode = self._theme.metrics(), self._cursor.axis_mode
        low, high = self.x_span()
        locale = self.locale()
        widest = max(metrics.horizontalAdvance(x_text(v, (high - low) / 10, mode, locale)) for v in (low, high))
        ticks, step = x_ticks(low, high, mode, max(2, int(rect.width() / (1.6 * widest + 8))))
        for value in ticks:
            x = self.pixel_of_x(value)
            painter.setPen(QPen(QColor(self._theme.grid), 1))
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
            if not self._show_x_axis:
                continue
            painter.setPen(QColor(self._theme.text))
            painter.drawLine(QPointF(x, rect.bottom()), QPointF(x, rect.bottom() + 4))
            label = x_text(value, step, mode, locale)
            # the last one gives way to the name of the axis
            half = 0.5 * metrics.horizontalAdvance(label)
            middle = min(x, rect.right() + 2 - half)
            box = QRectF(middle - widest, rect.bottom() + 4, 2 * widest, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, label)
        if self._show_x_axis:
            name = self.tr("m") if mode is AxisMode.DISTANCE else self.tr("time")
            box = QRectF(rect.right() + 6, rect.bottom() + 4, self.width() - rect.right() - 6, metrics.height())
            fitted = metrics.elidedText(name, Qt.TextElideMode.ElideRight, box.width())
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, fitted)

    def _paint_not_assessed(self, painter: QPainter, rect: QRectF) -> None:
        for stretch in self._not_assessed:
            left, right = self.pixel_of_time(stretch.start_s), self.pixel_of_time(stretch.end_s)
            area = QRectF(left, rect.top(), max(right - left, 2.0), rect.height()).intersected(rect)
            if not area.isEmpty():
                paint_hatch(painter, area, self._theme)

    def _paint_marks(self, painter: QPainter, rect: QRectF) -> None:
        painter.save()
        painter.setClipRect(rect.adjusted(-self.mark_radius(), 0, self.mark_radius(), 0))
        marks, ratio = self._mark_pixmaps, self.devicePixelRatioF()
        if marks is None or not marks.fits(self._theme, self.mark_radius(), ratio):
            marks = self._mark_pixmaps = VerdictMarks(self._theme, self.mark_radius(), ratio)
        for candidate in self._marks.in_drawing_order:
            centre = self._mark_centre(candidate)
            if centre is not None:
                verdict = self._marks.verdict(candidate)
                marks.paint(painter, verdict, centre, selected=candidate.id == self._marks.selected)
        painter.restore()

    def _paint_hint(self, painter: QPainter, rect: QRectF, text: str) -> None:
        colour = QColor(self._theme.text)
        colour.setAlpha(170)
        painter.setPen(colour)
        painter.drawText(rect, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, text)

    def _paint_over(self, painter: QPainter) -> None:
        rect = self.plot_rect()
        painter.setFont(self._theme.font())
        if self._cursor.selection_s is not None:
            left, right = (self.pixel_of_time(t) for t in self._cursor.selection_s)
            area = QRectF(left, rect.top(), max(right - left, 1.0), rect.height()).intersected(rect)
            colour = QColor(self._theme.accent)
            colour.setAlpha(50)
            painter.fillRect(area, colour)
        x = self._painted_cursor_x = self.pixel_of_time(self._cursor.time_s)
        if rect.left() <= x <= rect.right():
            painter.setPen(QPen(QColor(self._theme.cursor), self._theme.line_width))
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
        self._paint_values(painter, self._value_rect())
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.accent), 2))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self.rect()).adjusted(1, 1, -1, -1))

    def _value_rect(self) -> QRectF:
        rect = self.plot_rect()
        return QRectF(rect.right() + 4, rect.top(), max(0.0, self.width() - rect.right() - 5), rect.height())

    def _follow_cursor(self) -> None:
        new = self.pixel_of_time(self._cursor.time_s)
        half = math.ceil(self._theme.line_width) + 2
        for x in (self._painted_cursor_x, new):
            if math.isfinite(x) and -half <= x <= self.width() + half:
                self.update(QRect(math.floor(x) - half, 0, 2 * half + 1, self.height()))
        self.update(self._value_rect().toAlignedRect())

    # --- what Qt tells ------------------------------------------------------------------------------------------

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Paint for the new size."""
        super().resizeEvent(event)
        self._rect = None
        self.invalidate()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show that keys act here."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show that keys act elsewhere."""
        super().focusOutEvent(event)
        self.update()
