"""One line per running job: what it does, how far it is, and a button that stops it."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from processing import messages


class JobLine(QFrame):
    """The line of one job."""

    cancel_asked = Signal()

    def __init__(self, title: str, language: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._language = language
        self._title = QLabel(title)
        self._title.setStyleSheet("font-weight: bold")
        self._phrase = QLabel()
        self._bar = QProgressBar()
        self._bar.setRange(0, 1000)
        self._bar.setMinimumWidth(120)
        self._cancel = QPushButton(self.tr("Cancel"))
        self._cancel.setObjectName("cancel_job")
        self._cancel.setMinimumHeight(40)
        self._cancel.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._cancel.clicked.connect(self._ask_cancel)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(8, 4, 8, 4)
        layout.addWidget(self._title)
        layout.addWidget(self._phrase)
        layout.addWidget(self._bar, 1)
        layout.addWidget(self._cancel)

    def report(self, fraction: float, phrase: str) -> None:
        """Show how far the job is; ``phrase`` is a key of [progress], shown as it is if no sentence knows it."""
        self._bar.setValue(round(1000 * fraction))
        self._phrase.setText(messages.table("progress", self._language).get(phrase, phrase))

    def _ask_cancel(self) -> None:
        self._cancel.setEnabled(False)
        self._phrase.setText(self.tr("Stopping …"))
        self.cancel_asked.emit()


class JobStrip(QWidget):
    """Stacks the lines; takes no room while nothing runs."""

    def __init__(self, language: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._language = language
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.setSpacing(0)
        self.hide()

    def add_line(self, title: str) -> JobLine:
        """Show a line for a job and return it."""
        line = JobLine(title, self._language, self)
        self._layout.addWidget(line)
        self.show()
        return line

    def remove_line(self, line: JobLine) -> None:
        """Take a line away."""
        self._layout.removeWidget(line)
        line.hide()
        line.deleteLater()
        self.setVisible(self._layout.count() > 0)
