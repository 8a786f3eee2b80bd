"""The tie points beside the plan: what each one says, how the path fits it, and where we would be without it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QItemSelectionModel, Qt, Signal
from PySide6.QtGui import QFont
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

from processing.survey import TiePoint
from widgets.throttle import Throttle
from widgets.tie_point_panel import Index, TiePointModel
from widgets.units import length_unit, quantities
from widgets.vocabulary import length_cell, warning_colour

FIELDS = ("enabled", "name", "time_s", "chainage_m", "sigma_m", "residual", "left_out")
FIT_EVERY_MS = 400
NAME, RESIDUAL, LEFT_OUT = FIELDS.index("name"), FIELDS.index("residual"), FIELDS.index("left_out")


@dataclass(frozen=True)
class MarkerCheck:
    """How a tie point agrees: residual of the fit, leave-one-out miss with its 95 %, and whether it is believed."""

    residual_m: float
    left_out_m: float
    left_out_95_m: float
    doubted: bool


class MarkerModel(TiePointModel):
    """Tie points with their checks, by the number of the tie point."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent, FIELDS)
        self._checks: Mapping[int, MarkerCheck] = {}

    def set_checks(self, checks: Mapping[int, MarkerCheck]) -> None:
        """Show these; a tie point without one has no part in the fit."""
        self._checks = checks
        if self.points:
            self.dataChanged.emit(self.index(0, RESIDUAL), self.index(len(self.points) - 1, LEFT_OUT))

    def title(self, field: str) -> str:
        """Return a column's title."""
        titles = {
            "residual": self.tr("Fits to"),
            "left_out": self.tr("Without it"),
            "enabled": "✓",
            "time_s": self.tr("Time (s)"),
            "chainage_m": self.tr("At ({unit})").format(unit=length_unit().sign),
            "sigma_m": self.tr("± 1σ"),
        }
        return titles.get(field) or super().title(field)

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Qt: the checks are not edited."""
        flags = super().flags(index)
        return flags & ~Qt.ItemFlag.ItemIsEditable if index.column() >= RESIDUAL else flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the content of a cell."""
        if role == Qt.ItemDataRole.TextAlignmentRole and index.column() > NAME:
            return int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        if role == Qt.ItemDataRole.ToolTipRole and index.column() == NAME:
            return self.points[index.row()].name
        if index.column() < RESIDUAL:
            return super().data(index, role)
        check = self._checks.get(index.row())
        if check is None:
            return "–" if role == Qt.ItemDataRole.DisplayRole else None
        if role == Qt.ItemDataRole.DisplayRole:
            return self._text(check, index.column())
        if role == Qt.ItemDataRole.ForegroundRole and check.doubted:
            return warning_colour()
        if role == Qt.ItemDataRole.FontRole and check.doubted:
            bold = QFont()
            bold.setBold(True)
            return bold
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._tip(check)
        return None

    def _text(self, check: MarkerCheck, column: int) -> str:
        if column == RESIDUAL:
            mark = "✗ " if check.doubted else ""
            return f"{mark}{length_cell(check.residual_m, 2)}"
        return f"{length_cell(check.left_out_m)} ± {length_cell(check.left_out_95_m)}"

    def _tip(self, check: MarkerCheck) -> str:
        if check.doubted:
            return self.tr("All others contradict it, so it is not believed: check its place and its time.")
        return self.tr("If we had not known it, the path would have been off here by {length}.").format(
            length=quantities().length(abs(check.left_out_m))
        )


class MarkerPanel(QWidget):
    """The table with its buttons; edits come out as a whole new tuple, as those of the data page do."""

    tie_points_changed = Signal(object)  # tuple[TiePoint, ...]
    chosen = Signal(int)  # number of the tie point that was selected by hand
    add_asked = Signal()
    loop_asked = Signal()
    process_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model = MarkerModel(self)
        self.model.edited.connect(self.tie_points_changed)
        self._quiet = False
        hint = QLabel(
            self.tr(
                "Drag a square on the plan to its place, or its flag on a strip to its moment; Esc puts it back. "
                "'Without it': how far off we would be here, had we not known it."
            )
        )
        hint.setWordWrap(True)
        self._table = self._make_table()
        self._fitted: tuple[int, ...] = ()  # the longest texts that the columns were made for
        self._fit_columns = Throttle(self._fit, FIT_EVERY_MS, self)
        self._state = QLabel()
        self._state.setObjectName("marker_state")
        self._state.setWordWrap(True)
        self._state.setTextFormat(Qt.TextFormat.PlainText)
        self._add = self._button("add_marker", self.tr("Add at cursor"), self.add_asked.emit)
        self._loop = self._button("marker_loop", self.tr("Ended where it began"), self.loop_asked.emit)
        self._remove = self._button("remove_marker", self.tr("Remove"), self._on_remove)
        self._process = self._button("process_markers", self.tr("Place the leaks anew"), self.process_asked.emit)
        self._process.hide()
        buttons = QHBoxLayout()
        for button in (self._add, self._loop, self._remove):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(hint)
        layout.addWidget(self._table, 1)
        layout.addWidget(self._state)
        layout.addWidget(self._process)
        layout.addLayout(buttons)

    def _make_table(self) -> QTableView:
        table = QTableView()
        table.setObjectName("markers")
        table.setModel(self.model)
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setAccessibleName(self.tr("Tie points"))
        table.setTabKeyNavigation(False)  # Tab goes on to the buttons; arrows go about the cells
        table.setWordWrap(True)  # a long name takes two lines
        table.setAlternatingRowColors(True)
        table.setShowGrid(False)
        table.verticalHeader().hide()
        table.verticalHeader().setDefaultSectionSize(40)
        header = table.horizontalHeader()
        # not ResizeToContents: that measures every cell at every change, and a drag changes some at every move
        header.setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        header.setMinimumSectionSize(30)
        table.selectionModel().currentRowChanged.connect(self._on_current)
        return table

    def _button(self, name: str, text: str, handler: Any) -> QPushButton:  # noqa: ANN401  # a slot
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        button.clicked.connect(handler)
        return button

    # --- what it is told ---

    def set_tie_points(self, points: Sequence[TiePoint], *, writable: bool) -> None:
        """Show these; the selection stays where it was."""
        self.model.writable = writable
        if tuple(points) != self.model.points:
            selected = self.selected
            self._quiet = True
            self.model.set_points(points)
            self._quiet = False
            if selected is not None and selected < len(points):
                self.select(selected)
        for button in (self._add, self._loop, self._remove):
            button.setEnabled(writable)
        self._fit_columns()

    def _fit(self) -> None:
        """Make the columns as wide as their texts, where those have become longer or shorter."""
        rows, columns = range(len(self.model.points)), range(len(FIELDS))
        texts = [[str(self.model.data(self.model.index(row, column)) or "") for row in rows] for column in columns]
        longest = tuple(max((len(text) for text in column), default=0) for column in texts)
        if longest != self._fitted:
            self._fitted = longest
            for column in columns:
                if column != NAME:  # that one has what is left
                    self._table.resizeColumnToContents(column)

    def set_checks(self, checks: Mapping[int, MarkerCheck]) -> None:
        """Show how the path fits them."""
        self.model.set_checks(checks)
        self._fit_columns()

    def set_state(self, text: str, *, stale: bool) -> None:
        """Say how the path stands; ``stale`` offers to place the leaks anew."""
        self._state.setText(text)
        self._state.setVisible(bool(text))
        self._process.setVisible(stale)

    @property
    def selected(self) -> int | None:
        """The number of the selected tie point."""
        index = self._table.currentIndex()
        return index.row() if index.isValid() else None

    def select(self, number_: int) -> None:
        """Select a tie point without a signal."""
        self._quiet = True
        flags = QItemSelectionModel.SelectionFlag
        index = self.model.index(number_, 0)
        self._table.selectionModel().setCurrentIndex(index, flags.ClearAndSelect | flags.Rows)
        self._quiet = False

    def _on_current(self, current: Index, _previous: Index) -> None:
        if not self._quiet and current.isValid():
            self.chosen.emit(current.row())

    def _on_remove(self) -> None:
        gone = {index.row() for index in self._table.selectionModel().selectedRows()}
        if gone:
            self.tie_points_changed.emit(tuple(p for i, p in enumerate(self.model.points) if i not in gone))
