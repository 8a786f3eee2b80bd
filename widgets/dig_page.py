"""The page of digs: what was found, leak by leak, and what all digs on this computer say of the stated intervals."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from widgets.dig_form import HEIGHT, DigForm, scrolled
from widgets.dig_list import DigList

NARROW = 820  # pixels: less is not enough for two columns
FORM_HEIGHT, LIST_HEIGHT = 480, 180


class DigPage(QWidget):
    """List on the left, form on the right, the history below the list."""

    back_asked = Signal()
    missed_asked = Signal()
    widen_asked = Signal()
    export_asked = Signal()
    import_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.list = DigList()
        self.form = DigForm()
        self._back = self._button(self.tr("Back"), "dig_back", self.back_asked)
        self._missed = self._button(self.tr("Leak found elsewhere…"), "dig_missed", self.missed_asked)
        self._widen = self._button("", "dig_widen", self.widen_asked)
        self._export = self._button(self.tr("Write history…"), "dig_export", self.export_asked)
        self._import = self._button(self.tr("Take in history…"), "dig_import", self.import_asked)
        self._history = QLabel()
        self._history.setObjectName("dig_history")
        self._history.setWordWrap(True)
        self._history.setTextFormat(Qt.TextFormat.PlainText)
        self._history.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._history.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._lay_out()
        self.set_history("", "")

    def _lay_out(self) -> None:
        title = QLabel(self.tr("Digs"))
        title.setStyleSheet("font-weight: bold")
        head = QHBoxLayout()
        head.addWidget(self._back)
        head.addWidget(title, 1)
        head.addWidget(self._missed)
        about = QLabel(self.tr("What all digs on this computer say"))
        about.setStyleSheet("font-weight: bold")
        words = scrolled(self._history)
        words.setMinimumHeight(130)
        files = QHBoxLayout()
        files.addWidget(self._export)
        files.addWidget(self._import)
        left = QVBoxLayout()
        left.addLayout(head)
        left.addWidget(self.list, 3)
        left.addWidget(about)
        left.addWidget(words, 1)
        left.addWidget(self._widen)
        left.addLayout(files)
        self.form.setMinimumWidth(420)
        self._columns = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._columns.setContentsMargins(8, 8, 8, 6)
        self._columns.addLayout(left, 3)
        self._columns.addWidget(self.form, 2)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: in a narrow window, or with large letters, the form stands over the list."""
        super().resizeEvent(event)
        narrow = self.width() < NARROW
        direction = QBoxLayout.Direction.BottomToTop if narrow else QBoxLayout.Direction.LeftToRight
        if direction != self._columns.direction():
            self._columns.setDirection(direction)
            self.form.setMinimumHeight(FORM_HEIGHT if narrow else 0)
            self.list.setMinimumHeight(LIST_HEIGHT if narrow else 0)

    def _button(self, text: str, name: str, signal: object) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(HEIGHT)
        button.clicked.connect(signal)
        return button

    def set_history(self, words: str, widen: str) -> None:
        """Show what the history says; ``widen`` is what its button offers, empty for nothing."""
        self._history.setText(words)
        self._widen.setText(widen)
        self._widen.setVisible(bool(widen))

    def set_writable(self, writable: bool) -> None:
        """Let nobody change a survey that cannot be changed."""
        self.form.set_writable(writable)
        self._missed.setEnabled(writable)
        self._widen.setEnabled(writable)
