"""What the left button does on the plan: a click, a pan of the map, or a tie point carried to another place."""

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt

from widgets.linked_plot import DRAG_PIXELS
from widgets.plan_geometry import PlanScale

if TYPE_CHECKING:
    from widgets.path_view import PathView


class PlanMouse:
    """Lives from press to release and speaks through its view's signals; Escape ends it without a drop."""

    def __init__(self, view: "PathView") -> None:
        self._view = view
        self._pressed: QPointF | None = None
        self._scale_pressed: PlanScale = view.plan_scale
        self._moved = False
        self._carried: int | None = None  # the tie point under the hand

    @property
    def holds(self) -> bool:
        """Whether the button is down."""
        return self._pressed is not None

    @property
    def carries(self) -> bool:
        """Whether the button went down on a tie point that may be moved."""
        return self._carried is not None

    def press(self, place: QPointF) -> None:
        """Begin: a tie point that may move is taken up."""
        self._pressed, self._scale_pressed, self._moved = place, self._view.plan_scale, False
        self._carried = self._view.movable_tie_at(place)

    def move(self, place: QPointF) -> None:
        """Carry on; a hand that trembles within a few pixels still clicks."""
        if self._pressed is None:
            return
        self._moved = self._moved or math.dist(place.toTuple(), self._pressed.toTuple()) >= DRAG_PIXELS
        if self._moved and self._carried is not None:
            self._view.tie_dragged.emit(self._carried, *self._view.plan_scale.metres(place.x(), place.y()))
        elif self._moved:
            by = place - self._pressed
            self._view.pan_to(self._scale_pressed.moved(by.x(), by.y()))

    def release(self, place: QPointF) -> bool:
        """End; returns whether it was a click."""
        pressed, moved, carried = self._pressed, self._moved, self._carried
        self._pressed = self._carried = None
        if pressed is not None and moved and carried is not None:
            self._view.tie_dropped.emit(carried, *self._view.plan_scale.metres(place.x(), place.y()))
            self._view.tie_drag_ended.emit()
        return pressed is not None and not moved

    def escape(self) -> bool:
        """Put a carried tie point back; returns whether there was one."""
        if self._carried is None:
            return False
        self._pressed = self._carried = None
        self._view.tie_drag_ended.emit()
        return True

    def shape_over(self, place: QPointF) -> Qt.CursorShape:
        """Return how the mouse looks over a pixel."""
        if self._view.movable_tie_at(place) is not None:
            return Qt.CursorShape.OpenHandCursor
        over = self._view.candidate_at(place) is not None
        return Qt.CursorShape.PointingHandCursor if over else Qt.CursorShape.ArrowCursor
