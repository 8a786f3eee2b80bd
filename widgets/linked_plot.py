"""A framed plot that takes the mouse; what it does to the common cursor, all plots follow.

Click moves the cursor, drag pans (with the ruler's tool: measures), Shift+drag selects a span, wheel zooms about the
mouse, Shift+wheel pans, Ctrl+wheel zooms vertically, two fingers zoom and pan, double click shows everything, or what
lies there.
"""

import math
from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QEnterEvent, QKeyEvent, QMouseEvent, QPainter, QWheelEvent
from PySide6.QtWidgets import QWidget

from processing.survey import TiePoint
from widgets.fingers import Fingers
from widgets.plot_frame import PlotFrame
from widgets.plot_marks import Readout
from widgets.plot_theme import LIGHT, Theme
from widgets.ruler import REACH_PIXELS
from widgets.tie_flags import TieFlags
from widgets.time_cursor import TimeCursor

__all__ = ["DRAG_PIXELS", "ZOOM_STEP", "Drag", "LinkedPlot", "Readout"]

ZOOM_STEP = 0.8
CLOSER = 0.1  # a double click on the whole shows this part of it
DRAG_PIXELS = 4
Drag = Callable[[QPointF], None]


class LinkedPlot(PlotFrame):
    """A plot with the mouse; subclasses paint, and may let other things than the axis be dragged."""

    pointed = Signal(object)  # Readout, or None when the mouse has left
    candidate_clicked = Signal(int)
    candidate_opened = Signal(int)  # by a double click
    tie_clicked = Signal(int)
    tie_dragged = Signal(int, float)  # number, moment: while it moves
    tie_dropped = Signal(int, float)
    tie_drag_ended = Signal()  # it was let go, or taken back by Escape
    _fingers: Fingers | None = None

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self._pressed: QPointF | None = None
        self._drag: Drag | None = None
        self._dragged = False
        self._flags = TieFlags(self.pixel_of_time, self._tie_height)
        self._flagged: int | None = None  # the tie point under the hand
        self.ties_movable = False
        self._fingers = Fingers(self, self._let_go, self._pinch)
        self.setMouseTracking(True)

    def set_tie_points(self, tie_points: Sequence[TiePoint]) -> None:
        """Show the known places at the moments the device passed."""
        self._flags.set_tie_points(tie_points)
        self.invalidate()

    def _paint_details(self, painter: QPainter) -> None:
        painter.setFont(self._theme.font())
        self._flags.paint(painter, self._theme, self.plot_rect())
        super()._paint_details(painter)

    # --- what subclasses may add --------------------------------------------------------------------------------

    def _tie_height(self, tie: TiePoint, rect: QRectF) -> float | None:
        """Return the pixel of a tie point's height; None for the foot of the plot."""
        del tie, rect
        return None

    def _readout(self, place: QPointF) -> Readout:
        """Return what lies under the mouse."""
        time_s = self.time_of_pixel(place.x())
        return Readout(time_s, self._cursor.chainage_at(time_s), self._cursor.position_at(time_s))

    def _grab(self, place: QPointF) -> Drag | None:
        """Return what shall follow the mouse when it is pressed here; None pans."""
        del place
        return None

    def _drop(self) -> None:
        """Take note that what followed the mouse has been let go."""

    def _zoom_vertical(self, factor: float, place: QPointF) -> None:
        """Zoom the vertical axis about a pixel."""

    def _fit_vertical(self) -> None:
        """Show the whole vertical axis."""

    # --- what Qt tells ------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click, a pan, a selection, or whatever the subclass has here; a menu speaks of where it opens."""
        if event.button() is Qt.MouseButton.RightButton:
            self._point_at(event.position())
        if event.button() is not Qt.MouseButton.LeftButton:
            super().mousePressEvent(event)
            return
        self._pressed, self._dragged = event.position(), False
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self._drag = self._selecting(event.position())
        else:
            here = event.position()
            self._drag = self._tie_drag(here) or self._grab(here) or self._measuring(here) or self._panning(here)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag, and say what lies under the mouse."""
        place = event.position()
        if self._pressed is not None and self._drag is not None:
            self._dragged = self._dragged or math.dist(place.toTuple(), self._pressed.toTuple()) >= DRAG_PIXELS
            if self._dragged:
                self._drag(place)
        elif self.ties_movable and self._flags.at(place, self.plot_rect()) is not None:
            self.setCursor(Qt.CursorShape.SizeHorCursor)
        elif self._grab(place) is not None or self.candidate_at(place) is not None:
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        elif self._measuring(place) is not None:
            self.setCursor(Qt.CursorShape.SplitHCursor)
        else:
            self.unsetCursor()
        self.pointed.emit(self._readout(place) if self.plot_rect().contains(place) else None)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a drag; without one it was a click: on a candidate, or for the cursor."""
        if event.button() is not Qt.MouseButton.LeftButton:
            super().mouseReleaseEvent(event)
            return
        if self._pressed is not None:
            if not self._dragged:
                self._click(event.position())
            elif self._flagged is not None:
                self.tie_dropped.emit(self._flagged, self.time_of_pixel(event.position().x()))
                self.tie_drag_ended.emit()
            else:
                self._drop()
        self._pressed = self._drag = self._flagged = None

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Escape puts a tie point back that is being dragged."""
        if event.key() == Qt.Key.Key_Escape and self._flagged is not None:
            self._let_go()
            return
        super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Qt: fingers, and everything else."""
        fingers = self._fingers  # none yet while the widget is being made
        return (fingers is not None and fingers.take(event)) or super().event(event)

    def _let_go(self) -> None:
        """Forget what is being dragged."""
        carried = self._flagged is not None
        self._pressed = self._drag = self._flagged = None
        if carried:
            self.tie_drag_ended.emit()

    def _pinch(self, factor: float, before: QPointF, now: QPointF) -> None:
        """Zoom about the fingers, and let what lies between them go with them."""
        self._cursor.zoom(1.0 / factor, self.x_of_pixel(before.x()))
        low, high = self._cursor.x_range
        self._cursor.pan((before.x() - now.x()) * (high - low) / self.plot_rect().width())

    def _tie_drag(self, start: QPointF) -> Drag | None:
        number = self._flags.at(start, self.plot_rect()) if self.ties_movable else None
        if number is None:
            return None
        self._flagged = number

        def move(place: QPointF) -> None:
            self.tie_dragged.emit(number, self.time_of_pixel(place.x()))

        return move

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Go to a candidate; else show everything, or of everything what lies here."""
        if event.button() is not Qt.MouseButton.LeftButton:
            return
        candidate_id = self.candidate_at(event.position())
        if candidate_id is not None:
            self.candidate_opened.emit(candidate_id)
        elif self._cursor.x_range == self._cursor.x_extent and self.plot_rect().contains(event.position()):
            self._cursor.zoom(CLOSER, self.x_of_pixel(event.position().x()))
        else:
            self._fit_vertical()
            self._cursor.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse, or pan."""
        turned = _turned(event)
        sideways = event.angleDelta().x() if not event.modifiers() & Qt.KeyboardModifier.AltModifier else 0
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self._zoom_vertical(ZOOM_STEP**turned, event.position())
        elif event.modifiers() & Qt.KeyboardModifier.ShiftModifier or abs(sideways) > abs(event.angleDelta().y()):
            low, high = self._cursor.x_range
            self._cursor.pan(-0.1 * turned * (high - low))
        elif turned:
            self._cursor.zoom(ZOOM_STEP**turned, self.x_of_pixel(event.position().x()))
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing lies under the mouse any more."""
        super().leaveEvent(event)
        self.pointed.emit(None)

    def enterEvent(self, event: QEnterEvent) -> None:
        """Say at once what lies under the mouse."""
        super().enterEvent(event)
        if self.plot_rect().contains(event.position()):
            self.pointed.emit(self._readout(event.position()))

    def _click(self, place: QPointF) -> None:
        candidate_id = self.candidate_at(place)
        if candidate_id is not None:
            self.candidate_clicked.emit(candidate_id)
        elif (number := self._flags.at(place, self.plot_rect())) is not None:
            self.tie_clicked.emit(number)
        elif self.plot_rect().contains(place):
            self._cursor.set_time(self.time_of_pixel(place.x()))
            self._cursor.clear_selection()

    def zoom_vertical(self, factor: float) -> None:
        """Multiply the span of the vertical axis by ``factor``, about its middle."""
        self._zoom_vertical(factor, self.plot_rect().center())

    def _point_at(self, place: QPointF) -> None:
        """Take the candidate or the moment that a menu opens on; a selection that it may be about stays."""
        candidate_id = self.candidate_at(place)
        if candidate_id is not None:
            self.candidate_clicked.emit(candidate_id)
        elif self.plot_rect().contains(place):
            self._cursor.set_time(self.time_of_pixel(place.x()))

    def _panning(self, start: QPointF) -> Drag:
        low, high = self._cursor.x_range
        per_pixel = (high - low) / self.plot_rect().width()

        def pan(place: QPointF) -> None:
            dx = (start.x() - place.x()) * per_pixel
            self._cursor.set_x_range(low + dx, high + dx)

        return pan

    def _measuring(self, start: QPointF) -> Drag | None:
        """Return the drag of a ruler's end, or with the tool that of a new ruler; None where there is neither."""
        ruler, rect = self._cursor.ruler, self.plot_rect()
        if not rect.contains(start):
            return None
        fixed_s: float | None = None
        if ruler.ends_s is not None:
            away, fixed = min(
                (abs(self.pixel_of_time(mine) - start.x()), other) for mine, other in (ruler.ends_s, ruler.ends_s[::-1])
            )
            fixed_s = fixed if away <= REACH_PIXELS else None
        if fixed_s is None and ruler.tool:
            fixed_s = self.time_of_pixel(start.x())
        if fixed_s is None:
            return None
        anchor_s = fixed_s
        return lambda place: ruler.set_ends(anchor_s, self.time_of_pixel(place.x()))

    def _selecting(self, start: QPointF) -> Drag:
        first = self.time_of_pixel(start.x())

        def select(place: QPointF) -> None:
            self._cursor.set_selection(first, self.time_of_pixel(place.x()))

        return select


def _turned(event: QWheelEvent) -> float:
    """Return the notches a wheel was turned; Qt swaps the axes with Alt, and touch pads give parts of a notch."""
    delta: QPoint = event.angleDelta()
    return (delta.y() or delta.x()) / 120.0
