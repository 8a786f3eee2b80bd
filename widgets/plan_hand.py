"""The plan in the operator's hands: what mouse, fingers and Escape do to it, whatever is drawn on it."""

import math

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from widgets.fingers import Fingers
from widgets.plan_geometry import PlanScale
from widgets.plan_mouse import PlanMouse
from widgets.plot_marks import Readout
from widgets.time_cursor import TimeCursor

CLOSER = 5.0  # a double click on the whole zooms in so far
REACH_PIXELS = 40.0


class PlanHand(QWidget):
    """A plan that is panned, zoomed, clicked and measured on; subclasses know what lies where."""

    pointed = Signal(object)  # Readout, or None when the mouse has left
    candidate_clicked = Signal(int)
    candidate_opened = Signal(int)  # by a double click
    tie_clicked = Signal(int)
    tie_dragged = Signal(int, float, float)  # number, east, north: while it moves
    tie_dropped = Signal(int, float, float)
    tie_drag_ended = Signal()  # it was let go, or taken back by Escape

    _fingers: Fingers | None = None

    def __init__(self, cursor: TimeCursor, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._cursor = cursor
        self._scale = PlanScale((0.0, 0.0), 10.0, (1.0, 1.0))
        self._fitted = True
        self._mouse = PlanMouse(self, cursor.ruler)
        self._fingers = Fingers(self, self._mouse.let_go, self._mouse.pinch)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    @property
    def plan_scale(self) -> PlanScale:
        """Where metres lie in the picture."""
        return self._scale

    @property
    def fitted(self) -> bool:
        """Whether everything is shown, and shall be."""
        return self._fitted

    def pan_to(self, scale: PlanScale) -> None:
        """Show another part of the map, by hand: it no longer follows what there is to show."""
        self._fitted = False
        self._set_scale(scale)

    # --- what subclasses know -----------------------------------------------------------------------------------

    def fit(self) -> None:
        """Show everything."""
        raise NotImplementedError

    def refresh(self) -> None:
        """Lay down again what is there."""
        raise NotImplementedError

    def candidate_at(self, place: QPointF) -> int | None:
        """Return the id of the candidate whose mark lies under a pixel."""
        raise NotImplementedError

    def tie_at(self, place: QPointF) -> int | None:
        """Return the tie point whose pin lies under a pixel."""
        raise NotImplementedError

    def movable_tie_at(self, place: QPointF) -> int | None:
        """Return the tie point that a press takes up."""
        raise NotImplementedError

    def moment_at(self, place: QPointF, reach: float = REACH_PIXELS) -> float | None:
        """Return the moment at which the path passes nearest to a pixel; None where it is farther than ``reach``."""
        raise NotImplementedError

    def pixel_of_moment(self, time_s: float) -> QPointF | None:
        """Return the pixel of where the device was at a moment; None without a path."""
        raise NotImplementedError

    def _set_scale(self, scale: PlanScale) -> None:
        raise NotImplementedError

    # --- what Qt tells ------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a click, a pan, or the drag of a tie point; a menu speaks of where it opens."""
        if event.button() is Qt.MouseButton.RightButton:
            self._click(event.position())
        if event.button() is not Qt.MouseButton.LeftButton:
            super().mousePressEvent(event)
            return
        self._mouse.press(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Pan or drag, and say what lies under the mouse."""
        place = event.position()
        if self._mouse.holds:
            self._mouse.move(place)
            return
        self.setCursor(self._mouse.shape_over(place))
        east, north = self._scale.metres(place.x(), place.y())
        self.pointed.emit(Readout(None, None, (east, north, math.nan)))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a pan or a drag; without one it was a click."""
        if event.button() is not Qt.MouseButton.LeftButton:
            super().mouseReleaseEvent(event)
        elif self._mouse.release(event.position()):
            self._click(event.position())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Escape puts a tie point back that is being dragged."""
        if event.key() != Qt.Key.Key_Escape or not self._mouse.escape():
            super().keyPressEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Go to a candidate; else show everything, or of everything what lies here."""
        place = event.position()
        if event.button() is not Qt.MouseButton.LeftButton:
            return
        candidate_id = self.candidate_at(place)
        if candidate_id is not None:
            self.candidate_opened.emit(candidate_id)
        elif self._fitted:
            self.pan_to(self._scale.zoomed(CLOSER, place.x(), place.y()))
        else:
            self.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the mouse, or pan."""
        self._mouse.wheel(event)
        event.accept()

    def event(self, event: QEvent) -> bool:
        """Qt: fingers, and everything else."""
        fingers = self._fingers  # none yet while the widget is being made
        return (fingers is not None and fingers.take(event)) or super().event(event)

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing lies under the mouse any more."""
        super().leaveEvent(event)
        self.pointed.emit(None)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show that keys act here."""
        super().focusInEvent(event)
        self.refresh()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show that keys act elsewhere."""
        super().focusOutEvent(event)
        self.refresh()

    def _click(self, place: QPointF) -> None:
        candidate_id = self.candidate_at(place)
        if candidate_id is not None:
            self.candidate_clicked.emit(candidate_id)
            return
        tie = self.tie_at(place)
        if tie is not None:
            self.tie_clicked.emit(tie)
            return
        moment = self.moment_at(place)
        if moment is not None:
            self._cursor.set_time(moment)
