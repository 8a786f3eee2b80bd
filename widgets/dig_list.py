"""The list of digs: each leak that was stated or dug up, what was found, how far off, and whether the interval held."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableWidget, QTableWidgetItem, QWidget

ROW_HEIGHT = 44
COLUMNS = 6


class Held(StrEnum):
    """Whether the stated interval held; each has a sign of its own, readable without colour."""

    INSIDE = "inside"
    OUTSIDE = "outside"
    DRY = "dry"  # no leak was found
    MISSED = "missed"  # a leak that nobody had stated
    OPEN = "open"  # not dug, or not measured


SIGNS = {Held.INSIDE: "✓", Held.OUTSIDE: "✗", Held.DRY: "○", Held.MISSED: "!", Held.OPEN: ""}


@dataclass(frozen=True)
class DigLine:
    """One line, in finished words."""

    number: int  # of the leak
    name: str
    stated: str
    found: str
    off: str
    held: Held
    day: str


class DigList(QTableWidget):
    """Emits ``chosen`` with the leak's number when another line is selected by hand."""

    chosen = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(0, COLUMNS, parent)
        self._numbers: list[int] = []
        self._filling = False
        self.setHorizontalHeaderLabels(
            [
                self.tr("Leak"),
                self.tr("Stated"),
                self.tr("Found"),
                self.tr("Off by"),
                self.tr("Interval"),
                self.tr("Dug on"),
            ]
        )
        off = QTableWidgetItem(self.tr("Off by"))
        off.setToolTip(self.tr("▶ away from the launch, ◀ towards it"))
        self.setHorizontalHeaderItem(3, off)
        self.setAccessibleName(self.tr("Digs of this survey"))
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setTabKeyNavigation(False)
        self.setWordWrap(False)
        self.verticalHeader().setVisible(False)
        self.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        header = self.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(3, QHeaderView.ResizeMode.Stretch)
        least = 9 * header.fontMetrics().averageCharWidth()  # else the stretched one gives way to the others
        header.setMinimumSectionSize(least)
        self.currentCellChanged.connect(self._on_current)

    def held_text(self, held: Held) -> str:
        """Return sign and word."""
        words = {
            Held.INSIDE: self.tr("inside"),
            Held.OUTSIDE: self.tr("outside"),
            Held.DRY: self.tr("no leak"),
            Held.MISSED: self.tr("not stated"),
            Held.OPEN: "–",
        }
        return f"{SIGNS[held]} {words[held]}".strip()

    def set_lines(self, lines: Sequence[DigLine], selected: int | None) -> None:
        """Show these, with one selected."""
        self._filling = True
        self._numbers = [line.number for line in lines]
        self.setRowCount(len(lines))
        for row, line in enumerate(lines):
            texts = (line.name, line.stated, line.found, line.off, self.held_text(line.held), line.day)
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                item.setFlags(Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled)
                self.setItem(row, column, item)
        if selected in self._numbers:
            self.selectRow(self._numbers.index(selected))
        else:
            self.clearSelection()
            self.setCurrentCell(-1, -1)
        self._filling = False

    @property
    def numbers(self) -> Sequence[int]:
        """The leaks in the order of the lines."""
        return tuple(self._numbers)

    def _on_current(self, row: int, _column: int, _old_row: int, _old_column: int) -> None:
        if not self._filling and 0 <= row < len(self._numbers):
            self.chosen.emit(self._numbers[row])
