"""The table of tie points: known places at known moments; edits come out as a whole new tuple."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Launch, TiePoint
from widgets.optional_number import converted_text, number_text, parse_number
from widgets.units import length_unit

Index = QModelIndex | QPersistentModelIndex
ROOT = QModelIndex()
FIELDS = (
    "enabled", "name", "time_s", "chainage_m", "sigma_m", "latitude", "longitude", "east_m", "north_m", "up_m",
)  # fmt: skip
DEGREES = ("latitude", "longitude")  # a millimetre needs eight decimals
REQUIRED = ("time_s", "sigma_m")
LENGTHS = ("chainage_m", "sigma_m", "up_m")  # east and north are coordinates: in the metres of their system


def factor_of(field: str) -> float:
    """Return how much one of the unit that a field is shown in is in the survey's unit."""
    return length_unit().factor if field in LENGTHS else 1.0


def _short(value: float) -> str:
    return number_text(round(value, 3))


class TiePointModel(QAbstractTableModel):
    """Tie points as Qt wants them; a valid edit emits ``edited`` with the new tuple and changes nothing itself."""

    edited = Signal(object)  # tuple[TiePoint, ...]

    def __init__(self, parent: QWidget | None = None, fields: tuple[str, ...] = FIELDS) -> None:
        super().__init__(parent)
        self._fields = fields
        self.points: tuple[TiePoint, ...] = ()
        self.writable = True

    def set_points(self, points: Sequence[TiePoint]) -> None:
        """Show these; of as many as before only the changed rows are told, so that a drag costs no new layout."""
        before = self.points
        if len(before) != len(points) or not before:
            self.beginResetModel()
            self.points = tuple(points)
            self.endResetModel()
            return
        self.points = tuple(points)
        for row, (old, new) in enumerate(zip(before, self.points, strict=True)):
            if old != new:
                self.dataChanged.emit(self.index(row, 0), self.index(row, len(self._fields) - 1))

    def rowCount(self, parent: Index = ROOT) -> int:
        """Qt: number of rows."""
        return 0 if parent.isValid() else len(self.points)

    def columnCount(self, parent: Index = ROOT) -> int:
        """Qt: number of columns."""
        return 0 if parent.isValid() else len(self._fields)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the column titles."""
        if role != Qt.ItemDataRole.DisplayRole or orientation is not Qt.Orientation.Horizontal:
            return None
        return self.title(self._fields[section])

    def title(self, field: str) -> str:
        """Return a column's title."""
        titles = {
            "enabled": self.tr("Use"),
            "name": self.tr("Name"),
            "time_s": self.tr("Time (s)"),
            "chainage_m": self.tr("Chainage ({unit})").format(unit=length_unit().sign),
            "sigma_m": self.tr("± 1σ ({unit})").format(unit=length_unit().sign),
            "latitude": self.tr("Latitude"),
            "longitude": self.tr("Longitude"),
            "east_m": self.tr("East (m)"),
            "north_m": self.tr("North (m)"),
            "up_m": self.tr("Up ({unit})").format(unit=length_unit().sign),
        }
        return titles[field]

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Qt: what can be done with a cell."""
        flags = Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled
        if not self.writable:
            return flags
        return flags | (Qt.ItemFlag.ItemIsUserCheckable if index.column() == 0 else Qt.ItemFlag.ItemIsEditable)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the content of a cell."""
        value = getattr(self.points[index.row()], self._fields[index.column()])
        if index.column() == 0:
            checked = Qt.CheckState.Checked if value else Qt.CheckState.Unchecked
            return checked if role == Qt.ItemDataRole.CheckStateRole else None
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.EditRole):
            if isinstance(value, str):
                return value
            name = self._fields[index.column()]
            if value is None or name in DEGREES:
                return number_text(value)
            factor = factor_of(name)
            return converted_text(value, factor) if role == Qt.ItemDataRole.EditRole else _short(value / factor)
        return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:  # noqa: ANN401
        """Qt: take an edit; what is no number is refused and the cell keeps its value."""
        name = self._fields[index.column()]
        new: Any
        if name == "enabled" and role == Qt.ItemDataRole.CheckStateRole:
            new = Qt.CheckState(value) is Qt.CheckState.Checked
        elif name == "name":
            new = str(value).strip()
        else:
            try:
                new = parse_number(str(value))
            except ValueError:
                return False
            if str(value) == self.data(index, Qt.ItemDataRole.EditRole):
                return True  # in feet it may stand there rounded: who typed nothing changes nothing
            new = None if new is None else new * factor_of(name)
            if (name in REQUIRED and new is None) or (name == "sigma_m" and new <= 0.0):
                return False
        changed = replace(self.points[index.row()], **{name: new})
        points = tuple(changed if i == index.row() else p for i, p in enumerate(self.points))
        if points != self.points:
            self.edited.emit(points)
        return True


def closed_loop(launch: Launch, end_s: float, name: str) -> TiePoint:
    """Return the tie point of a run that ended where it began: the launch's own place at the run's end."""
    point = TiePoint(
        name,
        round(end_s, 3),
        latitude=launch.latitude,
        longitude=launch.longitude,
        east_m=launch.east_m,
        north_m=launch.north_m,
        up_m=0.0 if launch.elevation_m is None else launch.elevation_m,
    )
    if launch.latitude is None and launch.east_m is None:
        point = replace(point, east_m=0.0, north_m=0.0)
    return point


class TiePointPanel(QWidget):
    """The table with its buttons. ``end_s`` is the last moment of the run, for the closed loop."""

    tie_points_changed = Signal(object)  # tuple[TiePoint, ...]

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model = TiePointModel(self)
        self.model.edited.connect(self.tie_points_changed)
        self._launch = Launch()
        self._cursor_s = 0.0
        self._end_s: float | None = None
        hint = QLabel(self.tr("Places the device is known to have passed, and when. They carry the accuracy."))
        hint.setWordWrap(True)
        self._table = QTableView()
        self._table.setModel(self.model)
        self._table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self._table.setAccessibleName(self.tr("Tie points"))
        self._table.setTabKeyNavigation(False)
        self._table.verticalHeader().hide()
        self._table.verticalHeader().setDefaultSectionSize(40)
        self._table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self._add = self._button("add_tie_point", self.tr("Add at cursor"), self._on_add)
        self._loop = self._button("closed_loop", self.tr("Ended where it began"), self._on_loop)
        self._loop.setToolTip(self.tr("Declare a closed loop: a tie point at the launch at the end of the run"))
        self._remove = self._button("remove_tie_point", self.tr("Remove"), self._on_remove)
        buttons = QHBoxLayout()
        for button in (self._add, self._loop, self._remove):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(hint)
        layout.addWidget(self._table, 1)
        layout.addLayout(buttons)

    def _button(self, name: str, text: str, handler: Any) -> QPushButton:  # noqa: ANN401  # a slot
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        button.clicked.connect(handler)
        return button

    def set_tie_points(self, points: Sequence[TiePoint], launch: Launch, *, writable: bool) -> None:
        """Show these tie points; ``launch`` is where a closed loop ends."""
        self._launch = launch
        self.model.writable = writable
        self.model.set_points(points)
        self._table.setMinimumHeight(40 * (min(len(points), 5) + 2))
        for button in (self._add, self._loop, self._remove):
            button.setEnabled(writable)
        self._show_loop()

    def set_moments(self, cursor_s: float, end_s: float | None) -> None:
        """Tell where the cursor is, and when the run ended (None where that is not known)."""
        self._cursor_s, self._end_s = cursor_s, end_s
        self._show_loop()

    def _show_loop(self) -> None:
        self._loop.setEnabled(self.model.writable and self._end_s is not None)

    def _on_add(self) -> None:
        name = self.tr("mark {number}").format(number=len(self.model.points) + 1)
        self.tie_points_changed.emit((*self.model.points, TiePoint(name, round(self._cursor_s, 3))))

    def _on_loop(self) -> None:
        if self._end_s is None:
            return
        point = closed_loop(self._launch, self._end_s, self.tr("back at the launch"))
        self.tie_points_changed.emit((*self.model.points, point))

    def _on_remove(self) -> None:
        gone = {index.row() for index in self._table.selectionModel().selectedRows()}
        if gone:
            self.tie_points_changed.emit(tuple(p for i, p in enumerate(self.model.points) if i not in gone))
