"""The list of candidates with verdict, place and score; its selection is the session's, in both directions."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QItemSelectionModel,
    QModelIndex,
    QPersistentModelIndex,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QHideEvent, QIcon, QResizeEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QLabel,
    QPushButton,
    QSizePolicy,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Decision, Verdict
from widgets.candidate_row import CandidateRow
from widgets.list_tools import ListTools
from widgets.plot_theme import Theme
from widgets.vocabulary import (
    class_text,
    half_width_m,
    length_cell,
    number,
    place_cell,
    place_title,
    size_text,
    verdict_icon,
    verdict_text,
    width_title,
)

Index = QModelIndex | QPersistentModelIndex
ROOT = QModelIndex()
ROW_HEIGHT = 40
WIDE = 520  # pixels: a narrower list leaves columns away

ID, VERDICT, CHAINAGE, PLUS_MINUS, SCORE, CLASS, LEVEL, NOTE = range(8)


class CandidateModel(QAbstractTableModel):
    """The rows as Qt wants them."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.rows: list[CandidateRow] = []
        self.narrow = False
        self._dug: dict[int, str] = {}  # by number: the sign of what a dig showed
        self.set_theme(theme)

    def set_theme(self, theme: Theme) -> None:
        """Draw the verdicts as this theme does."""
        self._icons: dict[Verdict, QIcon] = {v: verdict_icon(theme, v) for v in Verdict}

    def set_rows(self, rows: Sequence[CandidateRow]) -> None:
        """Show these rows in this order."""
        self.beginResetModel()
        self.rows = list(rows)
        self.endResetModel()

    def update_rows(self, rows: Sequence[CandidateRow]) -> None:
        """Show these rows, which are the same candidates in the same order: only what differs is drawn anew."""
        for i, (before, after) in enumerate(zip(self.rows, rows, strict=True)):
            if before is not after:
                self.rows[i] = after
                self.dataChanged.emit(self.index(i, 0), self.index(i, NOTE))

    def set_narrow(self, narrow: bool) -> None:
        """Tell verdicts by their marks alone, whose word is in the tool tip, and the ± beside the place."""
        self.narrow = narrow
        if self.rows:
            self.dataChanged.emit(self.index(0, 0), self.index(len(self.rows) - 1, NOTE))
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, NOTE)

    def set_dug(self, signs: Mapping[int, str]) -> None:
        """Show behind their names which leaks, by number, were dug up, each with the sign of what that showed."""
        self._dug = dict(signs)
        if self.rows:
            self.dataChanged.emit(self.index(0, ID), self.index(len(self.rows) - 1, ID))

    def set_decision(self, candidate_id: int, decision: Decision) -> None:
        """Change one row's decision."""
        for i, row in enumerate(self.rows):
            if row.candidate.id == candidate_id:
                self.rows[i] = replace(row, decision=decision)
                self.dataChanged.emit(self.index(i, 0), self.index(i, NOTE))

    def rowCount(self, parent: Index = ROOT) -> int:
        """Qt: number of rows."""
        return 0 if parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index = ROOT) -> int:
        """Qt: number of columns."""
        return 0 if parent.isValid() else NOTE + 1

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the column titles."""
        if orientation is not Qt.Orientation.Horizontal:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return (
                self.tr("No."),
                "" if self.narrow else self.tr("Verdict"),
                place_title(),
                width_title(),
                self.tr("Score"),
                self.tr("Class"),
                self.tr("dB"),
                self.tr("Note"),
            )[section]
        if role == Qt.ItemDataRole.ToolTipRole:
            return (
                self.tr("L: found by the machine, M: marked by hand"),
                self.tr("What you decided"),
                self.tr("Chainage from the launch"),
                self.tr("The true place is within this with 95 % probability"),
                self.tr("Probability that it is a leak"),
                self.tr("What it is taken for"),
                self.tr("Level above its surroundings"),
                self.tr("Your note"),
            )[section]
        return None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:  # noqa: ANN401
        """Qt: the content of a cell."""
        row, column = self.rows[index.row()], index.column()
        if role == Qt.ItemDataRole.DisplayRole:
            return "" if self.narrow and column == VERDICT else self._text(row, column)
        if role == Qt.ItemDataRole.AccessibleTextRole:
            return self._text(row, column)
        if role == Qt.ItemDataRole.ToolTipRole:
            return row.decision.note if column == NOTE or row.decision.note else self._text(row, column)
        if role == Qt.ItemDataRole.DecorationRole and column == VERDICT:
            return self._icons.get(row.decision.verdict)
        if role == Qt.ItemDataRole.TextAlignmentRole and column in (CHAINAGE, PLUS_MINUS, SCORE, LEVEL):
            return int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        return None

    def _text(self, row: CandidateRow, column: int) -> str:
        candidate, decision = row.candidate, row.decision
        match column:
            case 0:
                sign = self._dug.get(candidate.label)
                return row.name if sign is None else f"{row.name} [{sign}]"
            case 1:
                return "" if decision.verdict is Verdict.NONE else verdict_text(decision.verdict)
            case 2:
                return place_cell(candidate.chainage_m)
            case 3:
                return length_cell(half_width_m(candidate))
            case 4:
                return "–" if row.manual else number(candidate.score, 2)
            case 5:
                kind, size = class_text(row.kind), size_text(row.leak_size)
                told = f"{kind}, {size}" if size else kind
                return f"✎ {told}" if self.narrow and decision.note else told
            case 6:
                return number(candidate.level_db, 1)
            case _:
                return " ".join(decision.note.split())


class CandidateTable(QWidget):
    """The table with its tools: filter, order, progress. It shows the rows that it is given and filters none itself."""

    candidate_chosen = Signal(int)  # by mouse or keyboard in the table
    process_asked = Signal()  # place them anew: the path has moved since they were found

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model = CandidateModel(theme, self)
        self.tools = ListTools()
        self._empty = QLabel()
        self._empty.setWordWrap(True)
        self._empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._table = self._make_table()
        self._stale = self._make_stale()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.tools)
        layout.addWidget(self._stale)
        layout.addWidget(self._empty, 1)
        layout.addWidget(self._table, 1)
        self._quiet = False
        self.set_rows(())

    def _make_stale(self) -> QPushButton:
        """Return the word on a path that has moved, which is the way on too: there is no room for both."""
        button = QPushButton(self.tr("Old places: place the leaks anew"))
        button.setObjectName("process_candidates")
        button.setToolTip(self.tr("Tie points were changed: these places are of the path before."))
        button.setAccessibleDescription(button.toolTip())
        button.setMinimumHeight(44)
        button.clicked.connect(self.process_asked.emit)
        button.hide()
        return button

    def _make_table(self) -> QTableView:
        table = QTableView(self)
        table.setModel(self.model)
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        table.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        table.setIconSize(QSize(24, 24))
        # the list gives way before the verdict's buttons below it do
        table.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)
        table.setMinimumHeight(2 * ROW_HEIGHT)
        table.setAccessibleName(self.tr("Leak candidates"))
        table.setWordWrap(False)
        table.setTabKeyNavigation(False)
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        table.verticalHeader().hide()
        table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        header = table.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setResizeContentsPrecision(0)  # by what is in sight: of hundreds of rows all would be asked each time
        header.setMinimumSectionSize(24)
        header.setStretchLastSection(True)
        header.setSectionsClickable(True)
        header.sectionClicked.connect(self._on_header)
        table.selectionModel().currentRowChanged.connect(self._on_current)
        return table

    def hideEvent(self, event: QHideEvent) -> None:
        """Qt: measure no rows that nobody sees; of a hidden list all would be asked with each verdict."""
        super().hideEvent(event)
        self._table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)

    def showEvent(self, event: QShowEvent) -> None:
        """Qt: bring what was selected meanwhile into view."""
        super().showEvent(event)
        self._table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        if self._table.currentIndex().isValid():
            self._table.scrollTo(self._table.currentIndex())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: in a narrow list the columns that can be read elsewhere give way; the verdict stays as its mark."""
        super().resizeEvent(event)
        narrow = self.width() < WIDE
        if narrow != self.model.narrow:
            self.model.set_narrow(narrow)
            for column in (LEVEL, NOTE):
                self._table.setColumnHidden(column, narrow)

    def set_theme(self, theme: Theme) -> None:
        """Draw the verdicts as this theme does."""
        self.model.set_theme(theme)
        self._table.viewport().update()

    def set_dug(self, signs: Mapping[int, str]) -> None:
        """Show which leaks, by number, were dug up."""
        self.model.set_dug(signs)

    def set_rows(self, rows: Sequence[CandidateRow], *, searched: bool = True) -> None:
        """Show these candidates in this order; the selection is kept where it still exists.

        An empty list says that nothing was found, or that nothing has been ``searched`` yet.
        """
        if [row.candidate.id for row in rows] == self.ids():
            self.model.update_rows(rows)
            self._show_empty(searched=searched)
            return
        kept = self.selected_id()
        self._quiet = True
        self.model.set_rows(rows)
        self._quiet = False
        self._show_empty(searched=searched)
        if kept is not None:
            self.select(kept)

    def _show_empty(self, *, searched: bool) -> None:
        rows = self.model.rows
        found_none = self.tr("No leak candidates were found. M marks one by hand at the cursor.")
        if self.tools.filtered:
            found_none = self.tr("No candidate fits the filter. Choose All above.")
        self._empty.setText(
            found_none if searched else self.tr("Leaks have not been looked for yet: process the recording first.")
        )
        self._empty.setVisible(not rows)
        self._table.setVisible(bool(rows))

    def set_decision(self, candidate_id: int, decision: Decision) -> None:
        """Change one candidate's verdict, class and note."""
        self.model.set_decision(candidate_id, decision)

    def set_stale(self, stale: bool) -> None:
        """Say that the path has moved since the candidates were placed."""
        self._stale.setVisible(stale)

    def select(self, candidate_id: int | None) -> None:
        """Select a candidate without a signal; None selects nothing."""
        self._quiet = True
        ids = self.ids()
        if candidate_id in ids:
            index = self.model.index(ids.index(candidate_id), 0)
            flags = QItemSelectionModel.SelectionFlag
            self._table.selectionModel().setCurrentIndex(index, flags.ClearAndSelect | flags.Rows)
            if self.isVisible():
                self._table.scrollTo(index)
        else:
            self._table.selectionModel().clear()
        self._quiet = False

    def selected_id(self) -> int | None:
        """Return the id of the selected candidate."""
        index = self._table.currentIndex()
        return self.model.rows[index.row()].candidate.id if index.isValid() else None

    def ids(self) -> list[int]:
        """Return all ids in the order shown."""
        return [row.candidate.id for row in self.model.rows]

    @property
    def rows_in_sight(self) -> int:
        """How many whole rows there is room for."""
        return self._table.viewport().height() // ROW_HEIGHT

    def _on_header(self, column: int) -> None:
        """Let the heads of place and score choose the order, as they do elsewhere."""
        order = {ID: "chainage", CHAINAGE: "chainage", PLUS_MINUS: "chainage", SCORE: "score"}.get(column)
        if order is not None:
            self.tools.order_chosen.emit(order)

    def _on_current(self, current: QModelIndex, _previous: QModelIndex) -> None:
        if not self._quiet and current.isValid():
            self.candidate_chosen.emit(self.model.rows[current.row()].candidate.id)
