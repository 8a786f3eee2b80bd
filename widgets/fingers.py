"""Fingers on a screen or a touch pad: one is a mouse, two zoom about themselves and move what lies under them.

Touches are read as they come: Qt's own pinch is told twice a step, and its zoom would be squared.
"""

import math
from collections.abc import Callable

from PySide6.QtCore import QEvent, QLineF, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent, QEventPoint, QMouseEvent, QNativeGestureEvent, QTouchEvent
from PySide6.QtWidgets import QApplication, QWidget

# factor by which things grow, where the middle of the fingers was and where it is now, in the widget's pixels
Pinched = Callable[[float, QPointF, QPointF], None]
LEAST_FACTOR, MOST_FACTOR = 0.5, 2.0  # in one step: fingers that touch each other tell nonsense
NEAREST_PIXELS = 24.0  # closer than that, two fingers of a glove are one
STILL_PIXELS = 12.0
HELD_MS = 600  # a finger that stays so long opens the menu
_TOUCH = {QEvent.Type.TouchBegin, QEvent.Type.TouchUpdate, QEvent.Type.TouchEnd, QEvent.Type.TouchCancel}


class Fingers:
    """Reads touches and gestures for a widget, which hands every event to :meth:`take`.

    ``begun`` is called when the second finger comes down: what the first one has begun to drag is no drag any more.
    """

    def __init__(self, widget: QWidget, begun: Callable[[], None], pinched: Pinched) -> None:
        self._widget, self._begun, self._pinched = widget, begun, pinched
        self._pair: tuple[QPointF, QPointF] | None = None  # where two fingers were
        self._alone: QPointF | None = None  # where one finger came down, as long as it is a mouse
        self._still = True
        self._down_ms = self._tapped_ms = 0
        self._tapped = QPointF()
        widget.setAttribute(Qt.WidgetAttribute.WA_AcceptTouchEvents)

    def take(self, event: QEvent) -> bool:
        """Return whether this was the fingers'."""
        if event.type() in _TOUCH and isinstance(event, QTouchEvent):
            event.accept()
            self._take_touch(event)
            return True
        if event.type() is QEvent.Type.NativeGesture and isinstance(event, QNativeGestureEvent):
            return self._take_native(event)
        return False

    def _take_touch(self, event: QTouchEvent) -> None:
        if event.type() is QEvent.Type.TouchCancel:
            self._let_go()
            return
        down = [self._place(p) for p in event.points() if p.state() is not QEventPoint.State.Released]
        if len(down) >= 2:
            self._take_pair((down[0], down[1]))
        elif event.type() is QEvent.Type.TouchBegin and down:
            self._press(down[0], event.timestamp())
        elif event.type() is QEvent.Type.TouchEnd:
            if self._alone is not None:
                self._release(self._place(event.points()[0]), event.timestamp())
            self._pair = self._alone = None
        elif self._alone is not None and down:
            self._still = self._still and math.dist(down[0].toTuple(), self._alone.toTuple()) < STILL_PIXELS
            self._send(QEvent.Type.MouseMove, down[0])
        else:
            self._pair = None  # of two fingers one was lifted: the other one waits for its company

    def _place(self, point: QEventPoint) -> QPointF:
        return self._widget.mapFromGlobal(point.globalPosition())

    def _take_pair(self, pair: tuple[QPointF, QPointF]) -> None:
        if self._alone is not None:
            self._let_go()
        before, self._pair = self._pair, pair
        if before is None:
            self._begun()
            return
        apart, now = (max(math.dist(a.toTuple(), b.toTuple()), NEAREST_PIXELS) for a, b in (before, pair))
        self._pinched(_sane(now / apart), QLineF(*before).center(), QLineF(*pair).center())

    def _press(self, place: QPointF, now_ms: int) -> None:
        near = math.dist(place.toTuple(), self._tapped.toTuple()) < 2 * STILL_PIXELS
        again = near and 0 < now_ms - self._tapped_ms < QApplication.doubleClickInterval()
        self._alone, self._still, self._down_ms = place, True, now_ms
        self._widget.setFocus(Qt.FocusReason.MouseFocusReason)
        self._send(QEvent.Type.MouseButtonDblClick if again else QEvent.Type.MouseButtonPress, place)

    def _release(self, place: QPointF, now_ms: int) -> None:
        if self._still and now_ms - self._down_ms >= HELD_MS:
            self._let_go()
            at = place.toPoint()
            menu = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, self._widget.mapToGlobal(at))
            QApplication.sendEvent(self._widget, menu)
            return
        self._tapped, self._tapped_ms = place, now_ms if self._still else 0
        self._send(QEvent.Type.MouseButtonRelease, place)

    def _let_go(self) -> None:
        self._alone = self._pair = None
        self._begun()

    def _send(self, kind: QEvent.Type, place: QPointF) -> None:
        left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
        button = none if kind is QEvent.Type.MouseMove else left
        held = none if kind is QEvent.Type.MouseButtonRelease else left
        at = self._widget.mapToGlobal(place)
        QApplication.sendEvent(self._widget, QMouseEvent(kind, place, at, button, held, Qt.KeyboardModifier.NoModifier))

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
