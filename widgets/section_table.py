"""The list of lines in a map file: which are used for the route, what they are called and how long they are."""

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt, Signal
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableView, QWidget

from processing.importing.route_files.joining import Section
from widgets.units import quantities

Index = QModelIndex | QPersistentModelIndex
ROOT = QModelIndex()
USE, NAME, LENGTH, LAYER = range(4)


class SectionModel(QAbstractTableModel):
    """Sections as Qt wants them; a tick emits ``toggled`` and changes nothing itself."""

    toggled = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._sections: tuple[Section, ...] = ()
        self._lengths_m: tuple[float, ...] = ()
        self._chosen: frozenset[int] = frozenset()

    def set_sections(self, sections: Sequence[Section], lengths_m: Sequence[float], chosen: frozenset[int]) -> None:
        """Show these."""
        if tuple(sections) is self._sections or len(sections) == len(self._sections):
            self._sections, self._lengths_m, self._chosen = tuple(sections), tuple(lengths_m), chosen
            self.dataChanged.emit(self.index(0, 0), self.index(max(len(sections) - 1, 0), LAYER))
            return
        self.beginResetModel()
        self._sections, self._lengths_m, self._chosen = tuple(sections), tuple(lengths_m), chosen
        self.endResetModel()

    def rowCount(self, parent: Index = ROOT) -> int:
        """Qt: number of rows."""
        return 0 if parent.isValid() else len(self._sections)

    def columnCount(self, parent: Index = ROOT) -> int:
        """Qt: number of columns."""
        return 0 if parent.isValid() else 4

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the column titles."""
        if role != Qt.ItemDataRole.DisplayRole or orientation is not Qt.Orientation.Horizontal:
            return None
        return (
            self.tr("Use"),
            self.tr("Line"),
            self.tr("Length ({unit})").format(unit=quantities().length_unit),
            self.tr("Layer"),
        )[section]

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Qt: what can be done with a cell."""
        flags = Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled
        return flags | Qt.ItemFlag.ItemIsUserCheckable if index.column() == USE else flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the content of a cell."""
        row, column = index.row(), index.column()
        if column == USE:
            checked = Qt.CheckState.Checked if row in self._chosen else Qt.CheckState.Unchecked
            return checked if role == Qt.ItemDataRole.CheckStateRole else None
        if role == Qt.ItemDataRole.TextAlignmentRole and column == LENGTH:
            return int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        if role not in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            return None
        if column == LENGTH:
            told = quantities()
            return told.number(self._lengths_m[row] * told.length_factor, 1)
        section = self._sections[row]
        return section.layer if column == LAYER else section.name or self.tr("line {number}").format(number=row + 1)

    def setData(self, index: Index, _value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:  # noqa: ANN401
        """Qt: a tick."""
        if index.column() != USE or role != Qt.ItemDataRole.CheckStateRole:
            return False
        self.toggled.emit(index.row())
        return True


class SectionTable(QTableView):
    """A tap anywhere on a row ticks it."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.sections = SectionModel(self)
        self.setModel(self.sections)
        self.setAccessibleName(self.tr("Lines of the file"))
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setTabKeyNavigation(False)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(40)
        header = self.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setResizeContentsPrecision(50)  # of a whole city's pipes the first rows tell enough
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        self.clicked.connect(self._on_click)

    def _on_click(self, index: QModelIndex) -> None:
        if index.column() != USE:  # the tick box has told already
            self.sections.toggled.emit(index.row())
