"""The frame that all stacked plots share: common axis, cursor line, candidates and hatched stretches.

A plot is a pyqtgraph plot item whose ranges follow the common cursor; pyqtgraph takes no mouse. All of it is painted
into a picture that is kept: a moving cursor only lays it down again under its line, and while the range moves it is
shifted or stretched until it is the plot's turn to be painted anew. Subclasses show their data.
"""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFocusEvent, QPainter, QPen, QPixmap, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import Candidate, Channel, Decision, Stretch
from widgets.plot_axes import CommonAxis, ValueAxis
from widgets.plot_canvas import Keep, KeptCanvas, PaintedItem, plot_item
from widgets.plot_marks import Marks
from widgets.plot_near import near
from widgets.plot_paint import lay_elsewhere, paint_hatch
from widgets.plot_theme import LIGHT, Theme, VerdictMarks
from widgets.ruler import paint_ruler, paint_ruler_label
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor
from widgets.units import quantities

SPLIT_MS = 3.0  # a step that takes longer is done in two turns


@dataclass(frozen=True)
class _Kept:
    """A painted plot and the span of the axis that it shows."""

    picture: QPixmap
    x_span: tuple[float, float]


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
        self._names_ruler = False  # one of several plots above one another is enough
        self._stale = self._is_urgent = True
        self._kept: _Kept | None = None
        self._ready_span: tuple[float, float] | None = None  # for which the items are up to date, but not yet painted
        self._painted_span: tuple[float, float] | None = None  # while they are
        self._rect: QRectF | None = None
        self._laid_out: QRectF | None = None
        self._mark_pixmaps: VerdictMarks | None = None
        self._painted_cursor_x = math.nan
        self._canvas = KeptCanvas(self, self._prepare, self._paint)
        self._common_axis, self._value_axis = CommonAxis(theme), ValueAxis(theme)
        self._plot = plot_item(left=self._value_axis, bottom=self._common_axis)
        self._canvas.setCentralItem(self._plot)
        # the view box with the data stands at −100: between the ground and the details
        self._ground = PaintedItem(self._plot, self._paint_ground, -200.0, Keep.NOTHING)
        self._details = PaintedItem(self._plot, self._paint_details, 10.0, Keep.NOTHING)
        self._mark_item = PaintedItem(self._plot, self._paint_marks, 11.0, Keep.NOTHING)
        self._mark_places: list[tuple[Candidate, QPointF]] = []
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        cursor.moved.connect(self._follow_cursor)
        cursor.range_changed.connect(self.invalidate_in_turn)
        cursor.axis_changed.connect(self.invalidate)
        cursor.selection_changed.connect(self.refresh)
        cursor.ruler.changed.connect(self.refresh)

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
        return self._cursor.x_range if self._painted_span is None else self._painted_span

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

    # --- what subclasses show -----------------------------------------------------------------------------------

    def _show_data(self) -> None:
        """Bring the items of the plot, its vertical axis and range up to date."""

    def _value_axes(self, rect: QRectF) -> list[tuple[QRectF, ValueAxis]]:
        """Return the vertical axes whose ticks shall have grid lines, each with its part of the plot."""
        return [(rect, self._value_axis)]

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        """Paint what lies over the curves: names, hints, known places; called when something has changed."""

    def _paint_values(self, painter: QPainter, rect: QRectF) -> None:
        """Write into ``rect``, right of the plot, what the data are at the cursor; called at every move."""

    # --- bringing up to date ------------------------------------------------------------------------------------

    def invalidate(self) -> None:
        """Have everything brought up to date and painted anew with the next frame."""
        self._stale = self._is_urgent = True
        self.refresh()

    def invalidate_in_turn(self) -> None:
        """Have everything brought up to date when it is this plot's turn: what it shows is right, but elsewhere."""
        self._stale = True
        self.refresh()

    def refresh(self) -> None:
        """Lay down again what is there, and the cursor over it."""
        self._canvas.viewport().update()

    def _paint(self, painter: QPainter) -> None:
        """Lay down what is kept, painted anew where that is due, and the cursor over it."""
        ratio = self.devicePixelRatioF()
        if self._kept is None or self._kept.picture.devicePixelRatio() != ratio or (self._stale and self._is_urgent):
            self._prepare()
            self._kept = self._new_picture()
        elif (self._stale or self._ready_span is not None) and self._cursor.turns.may_paint(self):
            self._kept = self._step(self._kept)
        if self._kept.x_span == self.x_span():
            painter.drawPixmap(0, 0, self._kept.picture)
        else:
            left, right = (self.pixel_of_x(x) for x in self._kept.x_span)
            lay_elsewhere(painter, self._kept.picture, self.plot_rect(), (left, right), self._theme)
        self._paint_over(painter)

    def _step(self, kept: _Kept) -> _Kept:
        """Use the turn: bring the items up to date, or paint them; both in one where that takes little."""
        began, turns = time.perf_counter(), self._cursor.turns
        dear = turns.cost_ms(self) > SPLIT_MS
        if self._ready_span is None:
            self._prepare()
            if dear:
                turns.took(self, 1e3 * (time.perf_counter() - began), done=False)
                return kept
        new = self._new_picture()
        turns.took(self, 1e3 * (time.perf_counter() - began), done=not self._stale)
        return new

    def _new_picture(self) -> _Kept:
        """Paint the items for the span that they were brought up to date for, which may have moved on since."""
        span = self._ready_span if self._ready_span is not None else self.x_span()
        self._painted_span = span
        try:
            return _Kept(self._canvas.picture(), span)
        finally:
            self._painted_span = self._ready_span = None

    def _prepare(self) -> None:
        self._stale = self._is_urgent = False
        self._ready_span = self.x_span()
        rect, whole = self.plot_rect(), QRectF(self.rect())
        self._lay_out(rect)
        self._plot.vb.setRange(xRange=self.x_span(), padding=0.0, disableAutoRange=False)
        mode, write = self._cursor.axis_mode, quantities()
        name = write.length_unit if mode is AxisMode.DISTANCE else self.tr("time")
        self._common_axis.show_unit(mode, name, self.locale(), write)
        self._show_data()
        around = near(self._marks, self._cursor, self.x_span())
        self._mark_places = [(c, place) for c in around if (place := self._mark_centre(c)) is not None]
        self._value_axis.set_room(whole.translated(0.0, -rect.top()))
        self._common_axis.set_room(whole.translated(-rect.left(), -rect.bottom()))
        for item in (self._ground, self._details, self._mark_item):
            item.renew(whole)

    def _lay_out(self, rect: QRectF) -> None:
        """Let the view box stand exactly in ``rect``."""
        for axis in (self._value_axis, self._common_axis):
            axis.apply_theme(self._theme)
        if self._laid_out is rect:
            return
        self._laid_out = rect
        below = self.height() - rect.bottom()
        self._plot.showAxis("bottom", self._show_x_axis)
        self._value_axis.setWidth(rect.left())
        self._common_axis.setHeight(below)
        right = max(0.0, self.width() - rect.right())
        self._plot.layout.setContentsMargins(0.0, rect.top(), right, 0.0 if self._show_x_axis else max(0.0, below))
        self._plot.layout.activate()

    # --- painting -----------------------------------------------------------------------------------------------

    def _paint_ground(self, painter: QPainter) -> None:
        rect = self.plot_rect()
        painter.fillRect(self.rect(), QColor(self._theme.background))
        painter.fillRect(rect, QColor(self._theme.canvas))
        painter.setPen(QPen(QColor(self._theme.grid), 1))
        for value in self._common_axis.ticks(rect.width())[0]:
            x = self.pixel_of_x(value)
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
        for room, axis in self._value_axes(rect):
            for _, y in axis.ticks(room.height()):
                painter.drawLine(QPointF(room.left(), room.top() + y), QPointF(room.right(), room.top() + y))

    def _paint_details(self, painter: QPainter) -> None:
        rect = self.plot_rect()
        painter.setFont(self._theme.font())
        self._paint_data(painter, rect)
        self._paint_not_assessed(painter, rect)

    def _paint_not_assessed(self, painter: QPainter, rect: QRectF) -> None:
        low, high = self.x_span()
        start_s, end_s = float(self._cursor.time_of_x(low)), float(self._cursor.time_of_x(high))
        end_s = max(end_s, self._cursor.range_s[1])  # a stop at the end of the span belongs to it
        for stretch in self._not_assessed:
            if stretch.end_s < start_s or stretch.start_s > end_s:
                continue
            left, right = self.pixel_of_time(stretch.start_s), self.pixel_of_time(stretch.end_s)
            area = QRectF(left, rect.top(), max(right - left, 2.0), rect.height()).intersected(rect)
            if not area.isEmpty():
                paint_hatch(painter, area, self._theme)

    def _paint_marks(self, painter: QPainter) -> None:
        rect = self.plot_rect()
        painter.save()
        painter.setClipRect(rect.adjusted(-self.mark_radius(), 0, self.mark_radius(), 0))
        marks, ratio = self._mark_pixmaps, self.devicePixelRatioF()
        if marks is None or not marks.fits(self._theme, self.mark_radius(), ratio):
            marks = self._mark_pixmaps = VerdictMarks(self._theme, self.mark_radius(), ratio)
        for candidate, centre in self._mark_places:
            selected = candidate.id == self._marks.selected
            marks.paint(painter, self._marks.verdict(candidate), centre, selected=selected)
        painter.restore()
        painter.setPen(QPen(QColor(self._theme.text), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(rect)

    def _paint_hint(self, painter: QPainter, rect: QRectF, text: str) -> None:
        colour = QColor(self._theme.text)
        colour.setAlpha(170)
        painter.setPen(colour)
        painter.drawText(rect, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, text)

    def _paint_over(self, painter: QPainter) -> None:
        rect = self.plot_rect()
        painter.setFont(self._theme.font())
        self._paint_selection(painter, rect)
        ruler = self._cursor.ruler
        ends = (
            None if ruler.ends_s is None else (self.pixel_of_time(ruler.ends_s[0]), self.pixel_of_time(ruler.ends_s[1]))
        )
        if ends is not None:
            paint_ruler(painter, self._theme, rect, ends)
        x = self._painted_cursor_x = self.pixel_of_time(self._cursor.time_s)
        if rect.left() <= x <= rect.right():
            painter.setPen(QPen(QColor(self._theme.cursor), self._theme.line_width))
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
        if ends is not None and self._names_ruler:
            paint_ruler_label(painter, self._theme, rect, ends, ruler.label)
        self._paint_values(painter, self._value_rect())
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.accent), 2))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self.rect()).adjusted(1, 1, -1, -1))

    def _paint_selection(self, painter: QPainter, rect: QRectF) -> None:
        """Shade the selected span."""
        if self._cursor.selection_s is None:
            return
        left, right = (self.pixel_of_time(t) for t in self._cursor.selection_s)
        area = QRectF(left, rect.top(), max(right - left, 1.0), rect.height()).intersected(rect)
        colour = QColor(self._theme.accent)
        colour.setAlpha(50)
        painter.fillRect(area, colour)

    def _value_rect(self) -> QRectF:
        rect = self.plot_rect()
        return QRectF(rect.right() + 4, rect.top(), max(0.0, self.width() - rect.right() - 5), rect.height())

    def _follow_cursor(self) -> None:
        new = self.pixel_of_time(self._cursor.time_s)
        half = math.ceil(self._theme.line_width) + 2
        for x in (self._painted_cursor_x, new):
            if math.isfinite(x) and -half <= x <= self.width() + half:
                self._canvas.viewport().update(QRect(math.floor(x) - half, 0, 2 * half + 1, self.height()))
        self._canvas.viewport().update(self._value_rect().toAlignedRect())

    # --- what Qt tells ------------------------------------------------------------------------------------------

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Paint for the new size."""
        super().resizeEvent(event)
        self._rect = None
        self._canvas.setGeometry(self.rect())
        self.invalidate()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show that keys act here."""
        super().focusInEvent(event)
        self.refresh()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show that keys act elsewhere."""
        super().focusOutEvent(event)
        self.refresh()
