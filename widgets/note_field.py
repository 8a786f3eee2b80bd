"""A text field that hands its text over while it is being typed: at most a moment late, and at once when it is left."""

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QPlainTextEdit, QWidget

SAVED_AFTER_MS = 400


class NoteField(QPlainTextEdit):
    """Enter or Escape ends the note, Shift+Enter makes a new line."""

    note_changed = Signal(str)
    left = Signal()  # by Enter or Escape

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTabChangesFocus(True)
        self._saved = ""
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(SAVED_AFTER_MS)
        self._timer.timeout.connect(self.flush)
        self.textChanged.connect(self._on_text)

    def set_note(self, text: str) -> None:
        """Show another text without announcing it; a text equal to what stands there leaves the caret alone."""
        self._timer.stop()
        self._saved = text
        if text != self.toPlainText():
            self.blockSignals(True)
            self.setPlainText(text)
            self.blockSignals(False)

    def flush(self) -> None:
        """Announce what has not been announced yet."""
        self._timer.stop()
        text = self.toPlainText()
        if text != self._saved:
            self._saved = text
            self.note_changed.emit(text)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Qt: leaving the field saves it."""
        self.flush()
        super().focusOutEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: Enter and Escape end the note."""
        ends = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Escape)
        if ends and not event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            self.flush()
            self.left.emit()
            return
        super().keyPressEvent(event)

    def _on_text(self) -> None:
        if self.toPlainText() != self._saved and not self._timer.isActive():
            self._timer.start()  # not restarted by each key: a fast typist is saved too
