"""A frame that floats over the window beside a widget: never modal, never outside of the window, closed by Escape."""

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QMainWindow, QWidget

GAP = 10  # pixels between the widget and the bubble
EDGE = 6  # pixels that stay free at the window's edge


class Bubble(QFrame):
    """A child of ``window``; :meth:`stand_beside` shows it, and it follows when the window changes its size."""

    closed = Signal()  # by the operator

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("bubble")
        self.setFrameShape(QFrame.Shape.Box)
        self.setLineWidth(3)
        self.setAutoFillBackground(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._host = window
        self._anchor: QWidget | None = None
        self._before: QWidget | None = None
        window.installEventFilter(self)
        self.hide()

    def stand_beside(self, anchor: QWidget | None) -> None:
        """Show the bubble beside ``anchor``, or in the middle of the window without one."""
        self._anchor = anchor
        if not self.isVisible():
            self._before = self.window().focusWidget()
        self.place()
        self.show()
        self.raise_()

    def close_bubble(self) -> None:
        """Take the bubble away and give the keyboard back to whom it belonged."""
        if not self.isVisible():
            return
        had_focus = self.isAncestorOf(self.window().focusWidget() or self.window())
        self.hide()
        if had_focus and self._before is not None and self._before.isVisible():
            self._before.setFocus()
        self._before = None
        self.closed.emit()

    def place(self) -> None:
        """Move beside the anchor: right of it, else left, else below, else above; always whole inside of the window."""
        window = self._host
        room = self.room()
        size = self.wanted_size(room.size())
        anchor = self._anchor
        if anchor is None or not anchor.isVisible():
            corner = QRect(QPoint(), size)
            corner.moveCenter(room.center())
            self.setGeometry(corner.intersected(room))
            return
        target = QRect(anchor.mapTo(window, QPoint()), anchor.size())
        self.setGeometry(place_beside(target, size, room))

    def room(self) -> QRect:
        """Return where in the window the bubble may stand: not over its menus."""
        room = self._host.rect().adjusted(EDGE, EDGE, -EDGE, -EDGE)
        if isinstance(self._host, QMainWindow):
            room.setTop(self._host.menuBar().height() + EDGE)
        return room

    def wanted_size(self, most: QSize) -> QSize:
        """Return the size that the content asks for, at most ``most``."""
        width = min(self.sizeHint().width(), most.width())
        height = self.heightForWidth(width) if self.hasHeightForWidth() else self.sizeHint().height()
        return QSize(width, min(height, most.height()))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: follow the window's size."""
        if watched is self.parent() and event.type() == QEvent.Type.Resize and self.isVisible():
            self.place()
        return super().eventFilter(watched, event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: Escape closes."""
        if event.key() == Qt.Key.Key_Escape:
            self.close_bubble()
            return
        super().keyPressEvent(event)


def place_beside(target: QRect, size: QSize, room: QRect) -> QRect:
    """Return where a frame of ``size`` stands best beside ``target``, whole inside of ``room``.

    It covers the target only where the room leaves no other choice.
    """
    centred_y = target.center().y() - size.height() // 2
    centred_x = target.center().x() - size.width() // 2
    wishes = (
        QPoint(target.right() + GAP, centred_y),
        QPoint(target.left() - GAP - size.width(), centred_y),
        QPoint(centred_x, target.bottom() + GAP),
        QPoint(centred_x, target.top() - GAP - size.height()),
    )
    places = [_inside(QRect(wish, size), room) for wish in wishes]
    return next((place for place in places if not place.intersects(target)), places[0])


def _inside(place: QRect, room: QRect) -> QRect:
    left = max(room.left(), min(place.left(), room.right() + 1 - place.width()))
    top = max(room.top(), min(place.top(), room.bottom() + 1 - place.height()))
    return QRect(QPoint(left, top), place.size())
