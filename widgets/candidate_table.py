"""The list of candidates with verdict, place and score; its selection is the session's, in both directions."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
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
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSizePolicy,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from processing.sound.sizes import LeakSize
from processing.survey import Candidate, Decision, LeakClass, Verdict
from widgets.plot_theme import Theme
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import class_text, half_width_m, number, size_text, verdict_icon, verdict_text

Index = QModelIndex | QPersistentModelIndex
ROOT = QModelIndex()
ROW_HEIGHT = 40

ID, VERDICT, CHAINAGE, PLUS_MINUS, SCORE, CLASS, LEVEL, NOTE = range(8)


@dataclass(frozen=True)
class CandidateRow:
    """A candidate with what a human said of it; ``manual`` ones were marked by hand."""

    candidate: Candidate
    decision: Decision
    manual: bool = False
    size: LeakSize | None = None  # that it would have as a leak

    @property
    def kind(self) -> LeakClass:
        """What it is taken for: by the operator, else by the machine."""
        return self.decision.leak_class or self.candidate.leak_class

    @property
    def leak_size(self) -> LeakSize | None:
        """The size, None for what is no leak."""
        return self.size if self.kind in (LeakClass.LEAK, LeakClass.UNKNOWN) else None

    @property
    def name(self) -> str:
        """The name on the list and in the views: L3, or M4 for a manual mark."""
        return f"{'M' if self.manual else 'L'}{self.candidate.label}"


def sort_rows(rows: Sequence[CandidateRow], order: str) -> list[CandidateRow]:
    """Return the rows best score first (``score``) or from the launch on (``chainage``), unknown ones last."""
    if order == "chainage":
        return sorted(rows, key=lambda r: (_known_first(r.candidate.chainage_m), r.candidate.id))
    return sorted(rows, key=lambda r: (_known_first(-r.candidate.score), r.candidate.id))


def _known_first(value: float) -> float:
    return math.inf if math.isnan(value) else value


class CandidateModel(QAbstractTableModel):
    """The rows as Qt wants them."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.rows: list[CandidateRow] = []
        self.set_theme(theme)

    def set_theme(self, theme: Theme) -> None:
        """Draw the verdicts as this theme does."""
        self._icons: dict[Verdict, QIcon] = {v: verdict_icon(theme, v) for v in Verdict}

    def set_rows(self, rows: Sequence[CandidateRow]) -> None:
        """Show these rows in this order."""
        self.beginResetModel()
        self.rows = list(rows)
        self.endResetModel()

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
                self.tr("Verdict"),
                self.tr("At (m)"),
                self.tr("± m"),
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
            return self._text(row, column)
        if role == Qt.ItemDataRole.ToolTipRole:
            return row.decision.note if column == NOTE else self._text(row, column)
        if role == Qt.ItemDataRole.DecorationRole and column == VERDICT:
            return self._icons.get(row.decision.verdict)
        if role == Qt.ItemDataRole.TextAlignmentRole and column in (CHAINAGE, PLUS_MINUS, SCORE, LEVEL):
            return int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        return None

    def _text(self, row: CandidateRow, column: int) -> str:
        candidate, decision = row.candidate, row.decision
        match column:
            case 0:
                return row.name
            case 1:
                return "" if decision.verdict is Verdict.NONE else verdict_text(decision.verdict)
            case 2:
                return number(candidate.chainage_m, 1)
            case 3:
                return number(half_width_m(candidate), 1)
            case 4:
                return "–" if row.manual else number(candidate.score, 2)
            case 5:
                kind, size = class_text(row.kind), size_text(row.leak_size)
                return f"{kind}, {size}" if size else kind
            case 6:
                return number(candidate.level_db, 1)
            case _:
                return " ".join(decision.note.split())


class CandidateTable(QWidget):
    """The table with its order and its count of decided candidates."""

    candidate_chosen = Signal(int)  # by mouse or keyboard in the table
    order_changed = Signal(str)
    process_asked = Signal()  # place them anew: the path has moved since they were found

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model = CandidateModel(theme, self)
        self._order = QuietCombo()
        self._order.setMinimumHeight(40)
        self._order.setAccessibleName(self.tr("Order of the list"))
        self._order.addItem(self.tr("Best score first"), "score")
        self._order.addItem(self.tr("From the launch on"), "chainage")
        self._order.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._order.currentIndexChanged.connect(self._reorder)
        self._count = QLabel()
        self._empty = QLabel()
        self._empty.setWordWrap(True)
        self._empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._table = self._make_table()
        self._stale = self._make_stale()
        top = QHBoxLayout()
        top.addWidget(self._order, 1)
        top.addWidget(self._count)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(top)
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
        table.setMinimumHeight(3 * ROW_HEIGHT)
        table.setAccessibleName(self.tr("Leak candidates"))
        table.setWordWrap(False)
        table.setTabKeyNavigation(False)
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        table.verticalHeader().hide()
        table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        table.horizontalHeader().setMinimumSectionSize(24)
        table.horizontalHeader().setStretchLastSection(True)
        table.selectionModel().currentRowChanged.connect(self._on_current)
        return table

    @property
    def order(self) -> str:
        """``score`` or ``chainage``."""
        return str(self._order.currentData())

    def set_order(self, order: str) -> None:
        """Sort by ``score`` or ``chainage``."""
        self._order.setCurrentIndex(max(0, self._order.findData(order)))

    def set_theme(self, theme: Theme) -> None:
        """Draw the verdicts as this theme does."""
        self.model.set_theme(theme)
        self._table.viewport().update()

    def set_rows(self, rows: Sequence[CandidateRow], *, searched: bool = True) -> None:
        """Show these candidates; the selection is kept where it still exists.

        An empty list says that nothing was found, or that nothing has been ``searched`` yet.
        """
        kept = self.selected_id()
        self._quiet = True
        self.model.set_rows(sort_rows(rows, self.order))
        self._quiet = False
        found_none = self.tr("No leak candidates were found. M marks one by hand at the cursor.")
        self._empty.setText(found_none if searched else self.tr("Leaks have not been looked for yet."))
        self._empty.setVisible(not rows)
        self._table.setVisible(bool(rows))
        self._show_count()
        if kept is not None:
            self.select(kept)

    def set_decision(self, candidate_id: int, decision: Decision) -> None:
        """Change one candidate's verdict, class and note."""
        self.model.set_decision(candidate_id, decision)
        self._show_count()

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

    def _reorder(self) -> None:
        self.set_rows(self.model.rows)
        self.order_changed.emit(self.order)

    def _show_count(self) -> None:
        decided = sum(row.decision.verdict is not Verdict.NONE for row in self.model.rows)
        self._count.setText(self.tr("{decided} of {all} decided").format(decided=decided, all=len(self.model.rows)))

    def _on_current(self, current: QModelIndex, _previous: QModelIndex) -> None:
        if not self._quiet and current.isValid():
            self.candidate_chosen.emit(self.model.rows[current.row()].candidate.id)
