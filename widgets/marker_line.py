"""Markers while recording: a large button for "passing now", a line to name it afterwards, the list of all."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QCompleter,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from processing.survey import TiePoint
from widgets.optional_number import OptionalNumber, converted_text
from widgets.recording_words import clock_text
from widgets.units import length_unit, quantities

BUTTON_HEIGHT = 64


class _NameField(QLineEdit):
    """A line in which Escape means: leave it as it is."""

    given_up = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: Escape gives up."""
        if event.key() == Qt.Key.Key_Escape:
            self.given_up.emit()
            return
        super().keyPressEvent(event)


class _ChainageField(OptionalNumber):
    """The same for the number beside it."""

    given_up = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: Escape gives up."""
        if event.key() == Qt.Key.Key_Escape:
            self.given_up.emit()
            return
        super().keyPressEvent(event)


class MarkerLine(QFrame):
    """The line under the button: name and chainage of a marker that is stored already."""

    named = Signal(str, object)  # name, chainage in metres or None
    given_up = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._title = QLabel()
        self._title.setTextFormat(Qt.TextFormat.PlainText)
        self._places: dict[str, float | None] = {}
        self._offered_m: float | None = None  # what stands in the number's field without having been typed
        self.name = _NameField()
        self.name.setObjectName("marker_name")
        self.name.setMinimumHeight(44)
        self.name.setAccessibleName(self.tr("Name of the marker"))
        unit = self._unit = length_unit()
        self.chainage = _ChainageField(
            -1e5, 1e6, factor=unit.factor, hint=self.tr("{unit} from launch").format(unit=unit.sign)
        )
        self.chainage.setObjectName("marker_chainage")
        self.chainage.setMaximumWidth(130)
        self.chainage.setAccessibleName(self.tr("Chainage ({unit})").format(unit=unit.sign))
        self._done = QPushButton("⏎")
        self._done.setObjectName("marker_done")
        self._done.setAccessibleName(self.tr("Store"))
        self._done.setToolTip(self.tr("Store (Enter); Escape keeps the moment with its number"))
        self._done.setMinimumSize(52, 44)
        for field in (self.name, self.chainage):
            field.returnPressed.connect(self._finish)
            field.given_up.connect(self.given_up)
        self._done.clicked.connect(self._finish)
        self.name.textEdited.connect(self._on_name)
        row = QHBoxLayout()
        row.addWidget(self.name, 1)
        row.addWidget(self.chainage)
        row.addWidget(self._done)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 4, 6, 6)
        column.setSpacing(2)
        column.addWidget(self._title)
        column.addLayout(row)
        self.hide()

    def ask(self, title: str, places: Sequence[tuple[str, float | None]], likely: int | None) -> None:
        """Show the line; ``places`` are offered, the one at ``likely`` is filled in ready to be typed over."""
        self._title.setText(title)
        self._places = dict(places)
        completer = QCompleter([name for name, _ in places], self)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        completer.activated.connect(self._on_name)
        self.name.setCompleter(completer)
        name, chainage_m = places[likely] if likely is not None else ("", None)
        self.name.setText(name)
        self.name.selectAll()
        self._offer(chainage_m)
        self.show()
        self.name.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def _on_name(self, text: str) -> None:
        """Put in the chainage of a place that is known; that of another place must not stay under a new name."""
        if text in self._places:
            self._offer(self._places[text])
        elif self._offered_m is not None and self.chainage.text() == converted_text(self._offered_m, self._unit.factor):
            self._offer(None)

    def _offer(self, chainage_m: float | None) -> None:
        self._offered_m = chainage_m
        self.chainage.set_value(chainage_m)

    def _finish(self) -> None:
        self.chainage.editingFinished.emit()
        self.named.emit(self.name.text().strip(), self.chainage.value)


class MarkerPanel(QWidget):
    """The button, the line and the list."""

    mark_asked = Signal()
    undo_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.button = QPushButton(self.tr("Passing now (M)"))
        self.button.setObjectName("mark_now")
        self.button.setMinimumHeight(BUTTON_HEIGHT)
        self.button.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # a space bar must not press it again
        self.button.setToolTip(self.tr("Keep this moment at once; name the place afterwards"))
        self.button.clicked.connect(self.mark_asked)
        self.undo = QPushButton(self.tr("Undo"))
        self.undo.setObjectName("undo_mark")
        self.undo.setMinimumHeight(BUTTON_HEIGHT)
        self.undo.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.undo.setToolTip(self.tr("Take the last marker back (Ctrl+Z)"))
        self.undo.clicked.connect(self.undo_asked)
        self.line = MarkerLine()
        self.list = QListWidget()
        self.list.setObjectName("marker_list")
        self.list.setAccessibleName(self.tr("Markers"))
        self.list.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.list.setMinimumHeight(60)
        row = QHBoxLayout()
        row.addWidget(self.button, 1)
        row.addWidget(self.undo)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addLayout(row)
        column.addWidget(self.line)
        column.addWidget(self.list, 1)
        self.set_ready(ready=False)
        self.set_marks(())

    def set_ready(self, *, ready: bool) -> None:
        """Switch the button on while it is recorded."""
        self.button.setEnabled(ready)

    def set_marks(self, marks: Sequence[TiePoint]) -> None:
        """List these, the newest on top."""
        self.undo.setEnabled(bool(marks) and self.button.isEnabled())
        self.list.clear()
        for mark in reversed(marks):
            place = "" if mark.chainage_m is None else f"   {quantities().length(mark.chainage_m, 2)}"
            self.list.addItem(f"{clock_text(mark.time_s)}   {mark.name}{place}")
        if not marks:
            self.list.addItem(self.tr("No markers yet"))
