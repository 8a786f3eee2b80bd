"""Over the list of candidates: which of them are shown and in which order, how many are decided, what comes after."""

from collections.abc import Mapping

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QDoubleSpinBox,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from processing.survey import LeakClass, Verdict
from widgets.candidate_row import FILTER_ROUND, ORDERS, CandidateFilter
from widgets.progress_line import ProgressLine
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import class_text, verdict_text

TOUCH = 40
_ALL = "all"


class ListTools(QWidget):
    """Signals out; what it shows it is told, and telling it emits nothing."""

    filter_chosen = Signal(object)  # CandidateFilter
    order_chosen = Signal(str)  # score or chainage
    autoplay_chosen = Signal(bool)
    report_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._filter = CandidateFilter()
        self._verdict = self._verdict_box()
        self._more = QToolButton()
        self._more.setObjectName("filter_more")
        self._more.setText(self.tr("More…"))
        self._more.setToolTip(self.tr("Order, filter by class and score, listening on arrival (Shift+N)"))
        self._more.setMinimumHeight(TOUCH)
        self._more.setCheckable(True)
        self._more.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._more.clicked.connect(self.open_more)
        self._panel = _FilterPanel(self)
        self._panel.class_chosen.connect(self._on_class)
        self._panel.order_chosen.connect(self.order_chosen)
        self._panel.score_chosen.connect(self._on_score)
        self._panel.autoplay_chosen.connect(self.autoplay_chosen)
        self._panel.closed.connect(self._show_more)
        self._progress = ProgressLine()
        self._progress.setObjectName("review_progress")
        self._report = self._button("all_decided", "")
        self._report.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._report.clicked.connect(self.report_asked.emit)
        self._clear = self._button("clear_filter", self.tr("✕ Filter"))
        self._clear.setToolTip(self.tr("Clear the filter: show all candidates"))
        self._clear.setAccessibleName(self.tr("Clear filter"))
        self._clear.clicked.connect(lambda: self._choose(CandidateFilter()))
        self._lay_out()
        self.set_progress(decided=0, all_=0, shown=0, undecided_hidden=0)

    def _lay_out(self) -> None:
        first, second = QHBoxLayout(), QHBoxLayout()
        first.setSpacing(4)
        second.setSpacing(4)
        first.addWidget(self._verdict, 1)
        first.addWidget(self._more)
        second.addWidget(self._progress, 1)
        second.addWidget(self._report, 1)
        second.addWidget(self._clear)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addLayout(first)
        layout.addLayout(second)

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(TOUCH)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _verdict_box(self) -> QuietCombo:
        box = _combo("filter_verdict", self.tr("Which candidates are shown (N)"))
        for verdict in FILTER_ROUND:
            box.addItem(self._verdict_name(verdict), _ALL if verdict is None else verdict.value)
        box.activated.connect(self._on_verdict)
        return box

    def _verdict_name(self, verdict: Verdict | None, count: int | None = None) -> str:
        name = self.tr("All") if verdict is None else verdict_text(verdict)
        return name if count is None else f"{name}  {count}"

    # --- what it is told ---

    def set_order(self, order: str) -> None:
        """Show an order, ``score`` or ``chainage``."""
        self._panel.set_order(order)

    def set_filter(self, shown: CandidateFilter) -> None:
        """Show a filter."""
        self._filter = shown
        self._verdict.setCurrentIndex(FILTER_ROUND.index(shown.verdict))
        self._panel.set_filter(shown)
        self._clear.setVisible(shown.is_on)
        self._show_more()

    @property
    def filtered(self) -> bool:
        """Whether a filter is on."""
        return self._filter.is_on

    def set_autoplay(self, *, on: bool) -> None:
        """Show whether each candidate is played on arrival."""
        self._panel.set_autoplay(on=on)

    def set_counts(self, counts: Mapping[Verdict, int]) -> None:
        """Show how many candidates have each verdict."""
        for row, verdict in enumerate(FILTER_ROUND):
            count = sum(counts.values()) if verdict is None else counts.get(verdict, 0)
            self._verdict.setItemText(row, self._verdict_name(verdict, count))

    def set_progress(self, *, decided: int, all_: int, shown: int, undecided_hidden: int, second: bool = False) -> None:
        """Show how many of all are decided and shown; when none is left, what comes next (``second``: to compare)."""
        done = all_ > 0 and decided == all_
        text = tip = self.tr("{decided} of {all} decided").format(decided=decided, all=all_)
        texts = [text]
        if shown != all_ or self._filter.is_on:
            part = self.tr("{shown} of {all} shown").format(shown=shown, all=all_)
            texts, tip = [f"{text} · {part}", part], f"{text}\n{part}"  # that not all are shown is never left out
        if undecided_hidden:
            tip += "\n" + self.tr("Undecided and hidden by the filter: {count}").format(count=undecided_hidden)
        self._progress.setVisible(not done)
        self._progress.show_part(decided / max(all_, 1), *texts)
        self._progress.setToolTip(tip)
        self._report.setVisible(done)
        to_compare, to_report = (
            self.tr("All {all} judged: compare (Ctrl+J)"),
            self.tr("All {all} decided: to the report (Ctrl+5)"),
        )
        self._report.setText((to_compare if second else to_report).format(all=all_))

    @property
    def progress_text(self) -> str:
        """What it says on how far the review has come."""
        return self._progress.text if not self._progress.isHidden() else self._report.text()

    def open_more(self) -> None:
        """Open the panel of class, score and listening, with the keyboard in it."""
        self._show_more(open_=True)
        self._panel.show_below(self._more)

    def _show_more(self, *, open_: bool = False) -> None:
        narrowed = self._filter.leak_class is not None or self._filter.least_score > 0.0
        self._more.setChecked(open_ or narrowed)

    # --- what is chosen ---

    def _choose(self, wanted: CandidateFilter) -> None:
        self.set_filter(wanted)
        self.filter_chosen.emit(wanted)

    def _on_verdict(self, row: int) -> None:
        self._choose(CandidateFilter(FILTER_ROUND[row], self._filter.leak_class, self._filter.least_score))

    def _on_class(self, leak_class: LeakClass | None) -> None:
        self._choose(CandidateFilter(self._filter.verdict, leak_class, self._filter.least_score))

    def _on_score(self, least: float) -> None:
        self._choose(CandidateFilter(self._filter.verdict, self._filter.leak_class, least))


class _FilterPanel(QFrame):
    """What is asked for less often; Escape or a press elsewhere closes it."""

    order_chosen = Signal(str)
    class_chosen = Signal(object)  # LeakClass, or None for any
    score_chosen = Signal(float)
    autoplay_chosen = Signal(bool)
    closed = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._class = _combo("filter_class", self.tr("Class"))
        self._class.addItem(self.tr("any class"), _ALL)
        for leak_class in LeakClass:
            self._class.addItem(class_text(leak_class), leak_class.value)
        self._class.activated.connect(self._on_class)
        self._score = QDoubleSpinBox()
        self._score.setObjectName("filter_score")
        self._score.setAccessibleName(self.tr("Least score"))
        self._score.setRange(0.0, 1.0)
        self._score.setSingleStep(0.05)
        self._score.setMinimumHeight(TOUCH)
        self._score.setToolTip(self.tr("Marks made by hand have no score; a least score never hides them"))
        self._score.valueChanged.connect(self.score_chosen)
        self._order = _combo("list_order", self.tr("Order of the list"))
        for order, text in zip(ORDERS, (self.tr("By score"), self.tr("By place")), strict=True):
            self._order.addItem(text, order)
        self._order.activated.connect(lambda _row: self.order_chosen.emit(str(self._order.currentData())))
        self._autoplay = QCheckBox(self.tr("Listen to each on arrival"))
        self._autoplay.setObjectName("autoplay")
        self._autoplay.setMinimumHeight(TOUCH)
        self._autoplay.clicked.connect(self.autoplay_chosen)
        for box in (self._order, self._class):
            box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        form = QFormLayout(self)
        form.addRow(self.tr("Order"), self._order)
        form.addRow(self.tr("Class"), self._class)
        form.addRow(self.tr("Least score"), self._score)
        form.addRow(self._autoplay)

    def set_filter(self, shown: CandidateFilter) -> None:
        """Show a filter without announcing it."""
        self._class.setCurrentIndex(0 if shown.leak_class is None else 1 + list(LeakClass).index(shown.leak_class))
        self._score.blockSignals(True)
        self._score.setValue(shown.least_score)
        self._score.blockSignals(False)

    def set_order(self, order: str) -> None:
        """Show an order without announcing it."""
        self._order.setCurrentIndex(max(0, self._order.findData(order)))

    def set_autoplay(self, *, on: bool) -> None:
        """Show the choice without announcing it."""
        self._autoplay.setChecked(on)

    def show_below(self, button: QWidget) -> None:
        """Open under a button, its right edge at the button's."""
        self.adjustSize()
        corner = button.mapToGlobal(QPoint(button.width() - self.width(), button.height() + 2))
        self.move(corner)
        self.show()
        self._class.setFocus(Qt.FocusReason.PopupFocusReason)

    def hideEvent(self, event: QHideEvent) -> None:
        """Qt: it has been closed."""
        super().hideEvent(event)
        self.closed.emit()

    def _on_class(self, row: int) -> None:
        self.class_chosen.emit(None if row == 0 else list(LeakClass)[row - 1])


def _combo(name: str, title: str) -> QuietCombo:
    box = QuietCombo()
    box.setObjectName(name)
    box.setAccessibleName(title)
    box.setToolTip(title)
    box.setMinimumHeight(TOUCH)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
    return box
