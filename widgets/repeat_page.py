"""The page of repeat runs: which other run, both side by side in metres, and the list of what has changed."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSplitter,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from widgets.dig_form import scrolled
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.repeat_view import RepeatView

HEIGHT = 48  # pixels: for gloves
ROW_HEIGHT = 44


@dataclass(frozen=True)
class RepeatLine:
    """One place, in finished words."""

    name: str
    place: str
    change: str
    growth: str


class RepeatPage(QWidget):
    """Signals out; knows how to show, not what to compare."""

    back_asked = Signal()
    other_chosen = Signal(str)  # path of a recent survey
    browse_asked = Signal()
    open_asked = Signal()
    turned = Signal(bool)
    place_chosen = Signal(int)
    go_asked = Signal()
    listen_asked = Signal(int)  # 0: this run, 1: the other; again: silence
    switch_asked = Signal()  # the other one of both
    export_asked = Signal()

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._filling = False
        self.view = RepeatView(theme)
        self._others = QuietCombo()
        self._others.setMinimumHeight(HEIGHT)
        self._others.setAccessibleName(self.tr("The other run"))
        self._others.setSizeAdjustPolicy(QuietCombo.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._others.setMinimumContentsLength(16)
        self._others.activated.connect(self._on_other)
        self._turned = self._button(self.tr("Opposite way"), "repeat_turned")
        self._turned.setCheckable(True)
        self._turned.setToolTip(self.tr("The other run went through the pipe the other way round"))
        self._turned.clicked.connect(self.turned)
        self._open = self._button(self.tr("Open that survey"), "repeat_open")
        self._open.clicked.connect(self.open_asked)
        self._words = QLabel()
        self._words.setObjectName("repeat_words")
        self._words.setWordWrap(True)
        self._words.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._words.setTextFormat(Qt.TextFormat.PlainText)
        self.table = self._make_table()
        self._ears = [self._button("", f"repeat_listen_{run}") for run in range(2)]
        for run, button in enumerate(self._ears):
            button.setCheckable(True)
            button.clicked.connect(lambda _checked=False, which=run: self.listen_asked.emit(which))
        self._go = self._button(self.tr("Go to the leak"), "repeat_go")
        self._go.clicked.connect(self.go_asked)
        self._export = self._button(self.tr("Write table…"), "repeat_export")
        self._export.clicked.connect(self.export_asked)
        self.view.mark_chosen.connect(self.choose)
        for key, signal in (("A", self.switch_asked), ("G", self.go_asked)):
            shortcut = QShortcut(QKeySequence(key), self)
            shortcut.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
            shortcut.activated.connect(signal)
        self._lay_out()
        self.set_names(self.tr("This run"), self.tr("Other run"))
        self.set_ready(ready=False)

    def _make_table(self) -> QTableWidget:
        table = QTableWidget(0, 4)
        table.setHorizontalHeaderLabels([self.tr("Leak"), self.tr("Place"), self.tr("Change"), self.tr("Growth")])
        table.setAccessibleName(self.tr("Places of both runs"))
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        table.setTabKeyNavigation(False)
        table.verticalHeader().setVisible(False)
        table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        table.horizontalHeader().setSectionResizeMode(2, QHeaderView.ResizeMode.Stretch)
        table.currentCellChanged.connect(self._on_row)
        table.cellDoubleClicked.connect(lambda _row, _column: self.go_asked.emit())
        return table

    def _lay_out(self) -> None:
        back = self._button(self.tr("Back"), "repeat_back")
        back.clicked.connect(self.back_asked)
        browse = self._button(self.tr("Choose folder…"), "repeat_browse")
        browse.clicked.connect(self.browse_asked)
        head = QHBoxLayout()
        head.addWidget(back)
        head.addWidget(QLabel(self.tr("Compare with")))
        head.addWidget(self._others, 1)
        for button in (browse, self._turned, self._open):
            head.addWidget(button)
        foot = QHBoxLayout()
        for button in (*self._ears, self._go, self._export):
            foot.addWidget(button)
        lists = QWidget()
        beside = QHBoxLayout(lists)
        beside.setContentsMargins(0, 0, 0, 0)
        beside.addWidget(self.table, 3)
        beside.addWidget(scrolled(self._words), 2)
        split = QSplitter(Qt.Orientation.Vertical)
        split.setChildrenCollapsible(False)
        split.addWidget(self.view)
        split.addWidget(lists)
        split.setSizes([400, 220])
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 6)
        layout.addLayout(head)
        layout.addWidget(split, 1)
        layout.addLayout(foot)

    # --- what it is told ---

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.view.apply_theme(theme)

    def set_others(self, others: Sequence[tuple[str, str]], chosen: str) -> None:
        """Offer surveys: path and name; the chosen one in front."""
        self._others.clear()
        if not chosen:
            self._others.addItem(self.tr("Choose another run of this pipe"), "")
        for path, name in others:
            self._others.addItem(name, path)
        self._others.setCurrentIndex(max(0, self._others.findData(chosen)))

    def set_names(self, ours: str, theirs: str) -> None:
        """Say on the buttons which run is which."""
        for button, name in zip(self._ears, (ours, theirs), strict=True):
            button.setText(self.tr("Hear {name}").format(name=name if len(name) < 26 else f"{name[:24]}…"))

    def set_words(self, text: str, *, may_open: bool = False) -> None:
        """Say what was found, or why nothing could be; ``may_open`` offers to open the other survey."""
        self._words.setText(text)
        self._open.setVisible(may_open)

    def set_ready(self, *, ready: bool) -> None:
        """Let listening, going and writing wait until there is something."""
        for button in (*self._ears, self._go, self._export, self._turned):
            button.setEnabled(ready)

    def set_turned(self, turned: bool) -> None:
        """Show whether the other run is taken the other way round."""
        self._turned.setChecked(turned)

    def set_heard(self, run: int | None) -> None:
        """Show which run is heard."""
        for number, button in enumerate(self._ears):
            button.setChecked(number == run)

    def set_lines(self, lines: Sequence[RepeatLine]) -> None:
        """Show the places."""
        self._filling = True
        self.table.setRowCount(len(lines))
        for row, line in enumerate(lines):
            for column, text in enumerate((line.name, line.place, line.change, line.growth)):
                item = QTableWidgetItem(text)
                item.setFlags(Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled)
                self.table.setItem(row, column, item)
        self._filling = False
        if lines:
            self.choose(0)

    def choose(self, row: int) -> None:
        """Choose a place."""
        self.table.setCurrentCell(row, 0)

    # --- inner workings ---

    def _on_other(self, row: int) -> None:
        path = self._others.itemData(row)
        if path:
            self.other_chosen.emit(path)

    def _on_row(self, row: int, _column: int, _old_row: int, _old_column: int) -> None:
        if row >= 0:
            self.view.choose(row)
            if not self._filling:
                self.place_chosen.emit(row)

    def _button(self, text: str, name: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(HEIGHT)
        return button
