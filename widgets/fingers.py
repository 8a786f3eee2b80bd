"""Two fingers on a screen or a touch pad: zoom about them, and move what lies under them."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QNativeGestureEvent
from PySide6.QtWidgets import QGestureEvent, QPinchGesture, QWidget

# factor by which things grow, where the middle of the fingers was and where it is now, in the widget's pixels
Pinched = Callable[[float, QPointF, QPointF], None]
LEAST_FACTOR, MOST_FACTOR = 0.5, 2.0  # in one step: fingers that touch each other tell nonsense


class Fingers:
    """Reads gestures for a widget, which hands every event to :meth:`take`; one finger is a mouse, as Qt makes it.

    ``begun`` is called when the second finger comes down: what the first one has begun to drag is no drag any more.
    """

    def __init__(self, widget: QWidget, begun: Callable[[], None], pinched: Pinched) -> None:
        self._widget, self._begun, self._pinched = widget, begun, pinched
        widget.grabGesture(Qt.GestureType.PinchGesture)

    def take(self, event: QEvent) -> bool:
        """Return whether this was a gesture of two fingers."""
        if event.type() is QEvent.Type.Gesture and isinstance(event, QGestureEvent):
            return self._take_pinch(event)
        if event.type() is QEvent.Type.NativeGesture and isinstance(event, QNativeGestureEvent):
            return self._take_native(event)
        return False

    def _take_pinch(self, event: QGestureEvent) -> bool:
        gesture = event.gesture(Qt.GestureType.PinchGesture)
        if not isinstance(gesture, QPinchGesture):
            return False
        event.accept(gesture)
        if gesture.state() is Qt.GestureState.GestureStarted:
            self._begun()
            return True
        before, now = (self._widget.mapFromGlobal(p) for p in (gesture.lastCenterPoint(), gesture.centerPoint()))
        self._pinched(_sane(gesture.scaleFactor()), before, now)
        return True

    def _take_native(self, event: QNativeGestureEvent) -> bool:
        kind, place = event.gestureType(), event.position()
        if kind is Qt.NativeGestureType.ZoomNativeGesture:  # each event tells by how much more
            self._pinched(_sane(1.0 + event.value()), place, place)
        elif kind is Qt.NativeGestureType.PanNativeGesture:
            self._pinched(1.0, place, place + event.delta())
        else:
            return False
        return True


def _sane(factor: float) -> float:
    return min(max(factor, LEAST_FACTOR), MOST_FACTOR)
