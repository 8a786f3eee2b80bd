"""Where two reviewers differ, side by side: the first on the left, the second on the right, an arrow takes a side."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QScrollArea,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Decision, Verdict
from widgets.flow_layout import FlowLayout
from widgets.plot_theme import Theme
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import class_text, verdict_icon, verdict_text

BUTTON_HEIGHT = 52
ROW_HEIGHT = 44
ALL, VERDICT, OPEN = "all", "verdict", "open"
_ID = Qt.ItemDataRole.UserRole


@dataclass(frozen=True)
class DifferenceRow:
    """One leak on which two differ; ``settled`` says that the first has decided since."""

    candidate_id: int
    name: str
    place: str
    first: Decision
    second: Decision
    settled: bool


class DifferencesPanel(QWidget):
    """Signals out; it decides nothing."""

    keep_asked = Signal(int)
    take_asked = Signal(int)
    open_asked = Signal(int)
    reviewer_chosen = Signal(str)
    import_asked = Signal()
    back_asked = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._rows: tuple[DifferenceRow, ...] = ()
        self._shown: tuple[DifferenceRow, ...] = ()
        self._writable = False
        self._back = self._button("differences_back", self.tr("Leaks page"))
        self._import = self._button("differences_import", self.tr("Opinions of a colleague…"))
        self._reviewer = self._combo("differences_reviewer", self.tr("Second reviewer"))
        self._filter = self._combo("differences_filter", self.tr("Which differences"))
        for text, kind in (
            (self.tr("Not settled"), OPEN),
            (self.tr("Other verdict"), VERDICT),
            (self.tr("All differences"), ALL),
        ):
            self._filter.addItem(text, kind)
        self._agreement = QLabel()
        self._agreement.setObjectName("agreement")
        self._agreement.setWordWrap(True)
        self._table = self._make_table()
        self._sides = (_Side(self.tr("First")), _Side(self.tr("Second")))
        self._keep = self._button("differences_keep", self.tr("←  Keep the first"))
        self._take = self._button("differences_take", self.tr("Take the second  →"))
        self._open = self._button("differences_open", self.tr("Enter  Open"))
        self._lay_out()
        self._back.clicked.connect(self.back_asked)
        self._import.clicked.connect(self.import_asked)
        self._reviewer.activated.connect(lambda _row: self.reviewer_chosen.emit(str(self._reviewer.currentData())))
        self._filter.currentIndexChanged.connect(lambda _row: self._fill())
        self._keep.clicked.connect(lambda: self._ask(self.keep_asked.emit))
        self._take.clicked.connect(lambda: self._ask(self.take_asked.emit))
        self._open.clicked.connect(lambda: self._ask(self.open_asked.emit))
        self._fill()

    def _lay_out(self) -> None:
        top, foot = FlowLayout(), FlowLayout()
        for widget in (self._back, self._reviewer, self._filter, self._import):
            top.addWidget(widget)
        for button in (self._keep, self._open, self._take):
            foot.addWidget(button)
        sides = QHBoxLayout()
        for side in self._sides:
            sides.addWidget(side, 1)
        content = QWidget()
        layout = QVBoxLayout(content)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.addLayout(top)
        layout.addWidget(self._agreement)
        layout.addWidget(self._table, 1)
        layout.addLayout(sides)
        layout.addLayout(foot)
        area = QScrollArea()  # on a low screen with large letters not all of it has room
        area.setWidget(content)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.addWidget(area)

    def _make_table(self) -> QTableWidget:
        table = QTableWidget(0, 4)
        table.setObjectName("differences")
        table.setAccessibleName(self.tr("Differences between the reviewers"))
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        table.setTabKeyNavigation(False)
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        table.setIconSize(QSize(24, 24))
        table.verticalHeader().hide()
        table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        table.horizontalHeader().setStretchLastSection(True)
        table.currentCellChanged.connect(lambda *_cells: self._show_current())
        table.setMinimumHeight(4 * ROW_HEIGHT)
        table.installEventFilter(self)
        return table

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(BUTTON_HEIGHT)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _combo(self, name: str, title: str) -> QuietCombo:
        combo = QuietCombo()
        combo.setObjectName(name)
        combo.setMinimumHeight(BUTTON_HEIGHT)
        combo.setAccessibleName(title)
        return combo

    # --- what it is told ----------------------------------------------------------------------------------------

    def show_reviewers(self, first: str, reviewers: Sequence[str], chosen: str) -> None:
        """Say who reviewed."""
        self._reviewer.clear()
        for name in reviewers:
            self._reviewer.addItem(name, name)
        self._reviewer.setCurrentIndex(max(0, self._reviewer.findData(chosen)))
        self._reviewer.setEnabled(len(reviewers) > 1)
        first_title = self.tr("First: {name}").format(name=first)
        second_title = self.tr("Second: {name}").format(name=chosen or "–")
        self._sides[0].set_title(first_title)
        self._sides[1].set_title(second_title)
        self._table.setHorizontalHeaderLabels([self.tr("Leak"), self.tr("Place"), first_title, second_title])

    def show_agreement(self, text: str) -> None:
        """Say how well they agree."""
        self._agreement.setText(text)

    def show_rows(self, rows: Sequence[DifferenceRow], *, writable: bool) -> None:
        """Show differences; the chosen one stays chosen, or the next one where it has gone."""
        self._rows, self._writable = tuple(rows), writable
        self._fill()

    def focus(self) -> None:
        """Give the keyboard to the list."""
        self._table.setFocus()

    def apply_theme(self, theme: Theme) -> None:
        """Draw the verdicts as this theme does."""
        self._theme = theme
        self._fill()

    @property
    def shown(self) -> tuple[DifferenceRow, ...]:
        """The rows that the filter lets through."""
        return self._shown

    @property
    def current(self) -> DifferenceRow | None:
        """The chosen row."""
        row = self._table.currentRow()
        return self._shown[row] if 0 <= row < len(self._shown) else None

    def _fill(self) -> None:
        before, at = self.current, self._table.currentRow()
        kind = self._filter.currentData()
        self._shown = tuple(
            row
            for row in self._rows
            if kind == ALL or (not row.settled and (kind == OPEN or row.first.verdict is not row.second.verdict))
        )
        table = self._table
        table.blockSignals(True)
        table.setRowCount(len(self._shown))
        for place, row in enumerate(self._shown):
            table.setItem(place, 0, QTableWidgetItem(f"{row.name}  ✓" if row.settled else row.name))
            table.setItem(place, 1, QTableWidgetItem(row.place))
            for column, decision in ((2, row.first), (3, row.second)):
                item = QTableWidgetItem(_words(decision))
                item.setIcon(verdict_icon(self._theme, decision.verdict))
                table.setItem(place, column, item)
        ids = [row.candidate_id for row in self._shown]
        wanted = ids.index(before.candidate_id) if before is not None and before.candidate_id in ids else at
        if ids:
            table.setCurrentCell(min(max(wanted, 0), len(ids) - 1), 0)
        table.blockSignals(False)
        self._show_current()

    def _show_current(self) -> None:
        row = self.current
        for side, decision in zip(self._sides, (None, None) if row is None else (row.first, row.second), strict=True):
            side.show_decision(self._theme, decision)
        for button in (self._keep, self._take):
            button.setEnabled(row is not None and self._writable)
        self._open.setEnabled(row is not None)

    # --- keys ---------------------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: arrows take a side and Enter opens; up and down stay the list's."""
        if isinstance(event, QKeyEvent) and event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier == (
            Qt.KeyboardModifier.NoModifier
        ):
            key = Qt.Key(event.key())
            calls = {
                Qt.Key.Key_Left: self.keep_asked.emit, Qt.Key.Key_Right: self.take_asked.emit,
                Qt.Key.Key_Return: self.open_asked.emit, Qt.Key.Key_Enter: self.open_asked.emit,
            }  # fmt: skip
            if event.type() is QEvent.Type.ShortcutOverride and (key in calls or key in _LIST_KEYS):
                event.accept()
                return True
            if event.type() is QEvent.Type.KeyPress and key in calls:
                if not event.isAutoRepeat() and (self._writable or calls[key] == self.open_asked.emit):
                    self._ask(calls[key])
                return True
        return super().eventFilter(watched, event)

    def _ask(self, call: Callable[[int], object]) -> None:
        if self.current is not None:
            call(self.current.candidate_id)


_LIST_KEYS = frozenset({Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_Home, Qt.Key.Key_End, Qt.Key.Key_PageUp,
                        Qt.Key.Key_PageDown})  # fmt: skip


class _Side(QFrame):
    """One reviewer's verdict, class and note."""

    def __init__(self, title: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._title, self._icon, self._verdict, self._note = QLabel(title), QLabel(), QLabel(), QLabel()
        for label in (self._title, self._verdict, self._note):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
        bold = self._verdict.font()
        bold.setBold(True)
        self._verdict.setFont(bold)
        self._note.setMinimumHeight(48)
        self._note.setAlignment(Qt.AlignmentFlag.AlignTop)
        line = QHBoxLayout()
        line.addWidget(self._icon)
        line.addWidget(self._verdict, 1)
        layout = QVBoxLayout(self)
        layout.addWidget(self._title)
        layout.addLayout(line)
        layout.addWidget(self._note, 1)

    def set_title(self, title: str) -> None:
        """Say whose it is."""
        self._title.setText(title)

    def show_decision(self, theme: Theme, decision: Decision | None) -> None:
        """Show a decision, or nothing."""
        self._icon.setVisible(decision is not None)
        self._verdict.setText("" if decision is None else _words(decision))
        self._note.setText("" if decision is None else decision.note)
        if decision is not None:
            self._icon.setPixmap(verdict_icon(theme, decision.verdict, 28).pixmap(28, 28))


def _words(decision: Decision) -> str:
    words = verdict_text(decision.verdict if decision is not None else Verdict.NONE)
    return f"{words} · {class_text(decision.leak_class)}" if decision.leak_class is not None else words
