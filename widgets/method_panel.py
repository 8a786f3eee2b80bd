"""The table of methods: what each one is in plain words, tried on this recording side by side, and chosen from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from widgets.compared_paths import swatch
from widgets.units import quantities
from widgets.vocabulary import number

ROW_HEIGHT = 40
NAME, OFF, SHARE, ALONG = range(4)


@dataclass(frozen=True)
class MethodRow:
    """A method of one step: its name in the survey's file, its title and its description in plain words."""

    name: str
    title: str
    words: str
    ticked: bool = True


@dataclass(frozen=True)
class Outcome:
    """What a method gave: errors in metres (None where nothing tells), the way in metres, or why there is none."""

    end_error_m: float | None = None
    end_error_pct: float | None = None
    end_chainage_error_m: float | None = None
    length_m: float = 0.0
    trouble: str = ""
    style: int | None = None


class MethodPanel(QWidget):
    """Ticks say what is tried; ``compare_asked`` carries their names, ``use_asked`` the selected one."""

    compare_asked = Signal(object)  # tuple[str, ...]
    use_asked = Signal(str)
    cleared = Signal()
    selection_changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._rows: tuple[MethodRow, ...] = ()
        self._current = ""
        self._busy, self._writable = False, True
        self._hint = QLabel()
        self._hint.setWordWrap(True)
        self._hint.setTextFormat(Qt.TextFormat.PlainText)
        self._table = self._make_table()
        self._words = QLabel()
        self._words.setObjectName("method_words")
        self._words.setWordWrap(True)
        self._words.setTextFormat(Qt.TextFormat.PlainText)
        self._compare = self._button("compare_methods", self.tr("Try the ticked ones"), self._on_compare)
        self._use = self._button("use_method", self.tr("Use this one"), self._on_use)
        self._clear = self._button("clear_comparison", self.tr("Clear"), self.cleared.emit)
        buttons = QHBoxLayout()
        for button in (self._compare, self._use, self._clear):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._hint)
        layout.addWidget(self._table, 1)
        layout.addWidget(self._words)
        layout.addLayout(buttons)
        self.set_basis("")

    def _make_table(self) -> QTableWidget:
        table = QTableWidget(0, 4)
        table.setObjectName("methods")
        table.setAccessibleName(self.tr("Methods"))
        table.setHorizontalHeaderLabels([self.tr("Method"), self.tr("End off"), "%", self.tr("Length off")])
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        table.setIconSize(QSize(28, 16))
        table.setTabKeyNavigation(False)
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        table.verticalHeader().hide()
        table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        header = table.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        table.currentCellChanged.connect(lambda *_: self._on_selection())
        table.itemChanged.connect(lambda _item: self._show_state())
        return table

    def _button(self, name: str, text: str, handler: object) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        button.clicked.connect(handler)
        return button

    # --- what it is told ---

    def set_methods(self, rows: Sequence[MethodRow], current: str, *, writable: bool) -> None:
        """Show these methods; ``current`` is the name that the survey uses."""
        self._current, self._writable = current, writable
        if tuple(rows) != self._rows:
            self._rows = tuple(rows)
            self._table.blockSignals(True)
            self._table.setRowCount(len(rows))
            for k, row in enumerate(rows):
                item = QTableWidgetItem(row.title)
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
                item.setCheckState(Qt.CheckState.Checked if row.ticked else Qt.CheckState.Unchecked)
                item.setToolTip(row.words)
                self._table.setItem(k, NAME, item)
                for column in range(OFF, ALONG + 1):
                    cell = QTableWidgetItem("")
                    cell.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                    self._table.setItem(k, column, cell)
            self._table.blockSignals(False)
        for k, row in enumerate(self._rows):
            font = self._item(k, NAME).font()
            font.setBold(row.name == current)
            self._item(k, NAME).setFont(font)
        self._show_state()

    def set_basis(self, basis: str) -> None:
        """Say what the errors are measured against; empty says that nothing tells."""
        usual = self.tr("Each method's path by itself: no tie point, no length and no map pulls on it.")
        self._hint.setText(f"{usual} {basis}".strip())

    def set_outcomes(self, outcomes: Mapping[str, Outcome]) -> None:
        """Show what methods gave; those that are not in it have given nothing yet."""
        for k, row in enumerate(self._rows):
            outcome = outcomes.get(row.name)
            texts = ["", "", ""]
            icon = QIcon()
            if outcome is not None and not outcome.trouble:
                share = outcome.end_error_pct
                texts = [
                    _metres(outcome.end_error_m),
                    number(share, 2),
                    _metres(outcome.end_chainage_error_m, signed=True),
                ]
                icon = QIcon() if outcome.style is None else swatch(outcome.style)
            elif outcome is not None:
                texts = [self.tr("cannot"), "", ""]
            for column, text in enumerate(texts, start=OFF):
                self._item(k, column).setText(text)
            self._item(k, NAME).setIcon(icon)
            self._item(k, OFF).setToolTip(self._tip(outcome))
        self._show_state()

    def _tip(self, outcome: Outcome | None) -> str:
        if outcome is None or outcome.trouble:
            return outcome.trouble if outcome is not None else ""
        return self.tr("Way found: {length}").format(length=quantities().length(outcome.length_m))

    def set_busy(self, busy: bool) -> None:
        """While methods are tried, no others can be."""
        self._busy = busy
        self._show_state()

    # --- state ---

    @property
    def ticked(self) -> tuple[str, ...]:
        """The names of the ticked methods."""
        checked = Qt.CheckState.Checked
        return tuple(r.name for k, r in enumerate(self._rows) if self._item(k, NAME).checkState() is checked)

    @property
    def selected(self) -> str | None:
        """The name of the selected method."""
        row = self._table.currentRow()
        return self._rows[row].name if 0 <= row < len(self._rows) else None

    def _item(self, row: int, column: int) -> QTableWidgetItem:
        item = self._table.item(row, column)
        assert item is not None  # every cell is filled in set_methods
        return item

    def _show_state(self) -> None:
        selected = self.selected
        words = next((row.words for row in self._rows if row.name == (selected or self._current)), "")
        self._words.setText(words)
        self._compare.setEnabled(bool(self.ticked) and not self._busy)
        self._use.setEnabled(self._writable and selected is not None and selected != self._current)

    def _on_selection(self) -> None:
        self._show_state()
        self.selection_changed.emit()

    def _on_compare(self) -> None:
        self.compare_asked.emit(self.ticked)

    def _on_use(self) -> None:
        if self.selected is not None:
            self.use_asked.emit(self.selected)


def _metres(value: float | None, *, signed: bool = False) -> str:
    if value is None:
        return "–"
    return f"{'+' if signed and value > 0 else ''}{quantities().length(value, 2)}"
