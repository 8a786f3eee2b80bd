"""What mouse and fingers do on the plan: a click, a pan, a zoom, a tie point carried elsewhere, a ruler drawn."""

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QWheelEvent

from widgets.linked_plot import DRAG_PIXELS, ZOOM_STEP
from widgets.plan_geometry import PlanScale
from widgets.ruler import REACH_PIXELS, Ruler

if TYPE_CHECKING:
    from widgets.plan_hand import PlanHand


class PlanMouse:
    """Lives from press to release and speaks through its view's signals; Escape ends it without a drop."""

    def __init__(self, view: "PlanHand", ruler: Ruler) -> None:
        self._view, self._ruler = view, ruler
        self._pressed: QPointF | None = None
        self._scale_pressed: PlanScale = view.plan_scale
        self._moved = False
        self._carried: int | None = None  # the tie point under the hand
        self._fixed_s: float | None = None  # the end of the ruler that stays while the other one is drawn

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
        self._fixed_s = self._measured_from(place) if self._carried is None else None

    def move(self, place: QPointF) -> None:
        """Carry on; a hand that trembles within a few pixels still clicks."""
        if self._pressed is None:
            return
        self._moved = self._moved or math.dist(place.toTuple(), self._pressed.toTuple()) >= DRAG_PIXELS
        if self._moved and self._carried is not None:
            self._view.tie_dragged.emit(self._carried, *self._view.plan_scale.metres(place.x(), place.y()))
        elif self._moved and self._fixed_s is not None:
            moment_s = self._view.moment_at(place, math.inf)
            if moment_s is not None:
                self._ruler.set_ends(self._fixed_s, moment_s)
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

    def let_go(self) -> None:
        """Forget what is under the hand: another finger has come down."""
        if not self.escape():
            self._pressed = None

    def pinch(self, factor: float, before: QPointF, now: QPointF) -> None:
        """Zoom about the fingers, and let what lies between them go with them."""
        scale = self._view.plan_scale.zoomed(factor, before.x(), before.y())
        self._view.pan_to(scale.moved(now.x() - before.x(), now.y() - before.y()))

    def wheel(self, event: QWheelEvent) -> None:
        """Zoom about the mouse; with Shift, or a wheel that turns sideways, pan: as in all views."""
        place, delta = event.position(), event.angleDelta()
        scale = self._view.plan_scale
        sideways = delta.x() if not event.modifiers() & Qt.KeyboardModifier.AltModifier else 0
        turned = (delta.y() or delta.x()) / 120.0
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier or abs(sideways) > abs(delta.y()):
            self._view.pan_to(scale.moved(0.1 * turned * scale.size[0], 0.0))
        else:
            self._view.pan_to(scale.zoomed(ZOOM_STEP**-turned, place.x(), place.y()))

    def _measured_from(self, place: QPointF) -> float | None:
        """Return the end that stays when a ruler is drawn from here; None where nothing is measured."""
        if self._ruler.ends_s is not None:
            for mine, other in (self._ruler.ends_s, self._ruler.ends_s[::-1]):
                end = self._view.pixel_of_moment(mine)
                if end is not None and math.dist(end.toTuple(), place.toTuple()) <= REACH_PIXELS:
                    return other
        return self._view.moment_at(place) if self._ruler.tool else None

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
        if not over and self._measured_from(place) is not None:
            return Qt.CursorShape.CrossCursor
        return Qt.CursorShape.PointingHandCursor if over else Qt.CursorShape.ArrowCursor
