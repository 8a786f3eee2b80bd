"""A line over the views that says what has just happened and goes away by itself; nothing moves to make room for it."""

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtWidgets import QLabel, QWidget

SHOWN_MS = 6000
ABOVE_FOOT = 64  # pixels: the buttons for listening stay free


class Toast(QLabel):
    """Lies over its parent's foot; the mouse goes through it."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._over = parent
        self.setObjectName("banner")  # the same looks
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(SHOWN_MS)
        self._timer.timeout.connect(self.hide)
        parent.installEventFilter(self)
        self.hide()

    def tell(self, text: str) -> None:
        """Say this now, instead of what was said before."""
        self.setText(text)
        self.setAccessibleName(text)
        self._place()
        self.show()
        self.raise_()
        self._timer.start()

    def stop(self) -> None:
        """Say nothing any more: the window closes."""
        self._timer.stop()
        self.hide()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: stay in place when the parent is resized, and go when it goes."""
        if watched is self._over:
            if event.type() == QEvent.Type.Resize:
                self._place()
            elif event.type() == QEvent.Type.Hide:
                self.stop()
        return super().eventFilter(watched, event)

    def _place(self) -> None:
        parent = self._over
        most = parent.width() - 20
        self.setWordWrap(False)
        wide = self.sizeHint().width() > most  # with large letters a sentence takes two lines
        self.setWordWrap(wide)
        self.resize(most, self.heightForWidth(most)) if wide else self.adjustSize()
        self.move((parent.width() - self.width()) // 2, max(0, parent.height() - self.height() - ABOVE_FOOT))
