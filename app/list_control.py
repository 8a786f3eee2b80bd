"""The list of candidates: filter and order (remembered), progress, and the rejecting of many in one step."""

from collections import Counter
from dataclasses import replace

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.review_commands import DecideMany
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.survey import Verdict
from widgets.batch_reject import BatchReject, rejected_below
from widgets.candidate_row import ORDERS, CandidateFilter
from widgets.candidate_table import CandidateTable
from widgets.vocabulary import number, verdict_text


class ListControl(QObject):
    """Connects the session with the tools over the list; its methods without arguments are handlers of actions."""

    told = Signal(str)
    report_asked = Signal()
    autoplay_changed = Signal(bool)

    def __init__(
        self, session: SurveySession, table: CandidateTable, preferences: PreferencesStore, parent: QWidget
    ) -> None:
        super().__init__(parent)
        self._session, self._table, self._preferences, self._window = session, table, preferences, parent
        self._batch: BatchReject | None = None  # while it is open
        tools = table.tools
        tools.filter_chosen.connect(self._choose)
        tools.order_chosen.connect(self._choose_order)
        tools.report_asked.connect(self.report_asked)
        tools.autoplay_chosen.connect(self._set_autoplay)
        session.filter_changed.connect(self._remember)
        for changed in (
            session.opened,
            session.results_changed,
            session.candidates_changed,
            session.decision_changed,
            session.selection_changed,
            session.filter_changed,
        ):
            changed.connect(self._show)
        remembered = preferences.values.layout
        session.set_filter(CandidateFilter.from_texts(remembered))
        order = remembered.get("list.order", ORDERS[0])
        session.set_order(order if order in ORDERS else ORDERS[0])
        tools.set_autoplay(on=self.autoplay)
        self._show()

    @property
    def autoplay(self) -> bool:
        """Whether each candidate is played on arrival."""
        return self._preferences.values.layout.get("list.autoplay") == "on"

    def toggle_autoplay(self) -> None:
        """Play each candidate on arrival, or wait for the key."""
        self._set_autoplay(not self.autoplay)
        on, off = self.tr("Each candidate is played on arrival"), self.tr("Candidates are played by key only")
        self.told.emit(on if self.autoplay else off)

    def _set_autoplay(self, on: bool) -> None:
        self._preferences.change(layout={**self._preferences.values.layout, "list.autoplay": "on" if on else ""})
        self._table.tools.set_autoplay(on=on)
        self.autoplay_changed.emit(on)

    # --- which are shown ---

    def next_filter(self) -> None:
        """Show the candidates of the next verdict: all, undecided, unsure, confirmed, rejected."""
        self._choose(self._session.filter.next_verdict())
        wanted = self._session.filter.verdict
        self.told.emit(self.tr("List: {what}").format(what=self.tr("all") if wanted is None else verdict_text(wanted)))

    def open_filter(self) -> None:
        """Open the rest of the filter: class and score."""
        self._table.tools.open_more()

    def clear_filter(self) -> None:
        """Show all candidates."""
        self._choose(CandidateFilter())

    def _choose(self, wanted: CandidateFilter) -> None:
        session = self._session
        session.set_filter(wanted)
        row = session.row(session.selected)
        if row is not None and not wanted.accepts(row):
            # the first one of what was asked for; where there is none the selection stays, and stays in sight
            first = next((r.candidate.id for r in session.rows() if wanted.accepts(r)), None)
            session.select(row.candidate.id if first is None else first)

    def _choose_order(self, order: str) -> None:
        self._session.set_order(order)

    def _remember(self) -> None:
        texts = {**self._session.filter.as_texts(), "list.order": self._session.list.order}
        before = self._preferences.values.layout
        if any(before.get(key) != value for key, value in texts.items()):
            self._preferences.change(layout={**before, **texts})

    def _show(self) -> None:
        session, tools = self._session, self._table.tools
        rows, shown = session.rows(), session.list.shown()
        counts = Counter(row.decision.verdict for row in rows)
        in_sight = {row.candidate.id for row in shown}
        hidden = sum(r.decision.verdict is Verdict.NONE and r.candidate.id not in in_sight for r in rows)
        tools.set_filter(session.filter)
        tools.set_order(session.list.order)
        tools.set_counts(counts)
        tools.set_progress(
            decided=len(rows) - counts[Verdict.NONE],
            all_=len(rows),
            shown=len(shown),
            undecided_hidden=hidden,
            second=bool(session.reviewer),
        )
        if self._batch is not None:
            self._batch.set_rows(shown)

    # --- many at once ---

    def open_batch(self) -> None:
        """Open the panel that rejects all undecided candidates of the list below a score."""
        if self._batch is None:
            self._batch = BatchReject(self._window)
            self._batch.reject_asked.connect(self.reject_below)
            self._batch.finished.connect(self._forget_batch)
        self._batch.set_rows(self._session.list.shown())
        self._batch.show()
        self._batch.raise_()
        self._batch.activateWindow()

    def reject_below(self, score: float) -> None:
        """Reject what is undecided, shown and scored below ``score``, as one step of undo."""
        rows = rejected_below(self._session.list.shown(), score)
        if rows:
            text = self.tr("reject {count} below {score}").format(count=len(rows), score=number(score, 2))
            after = {row.candidate.id: replace(row.decision, verdict=Verdict.REJECTED) for row in rows}
            self._session.push(DecideMany(self._session, text, after))

    def _forget_batch(self) -> None:
        if self._batch is not None:
            self._batch.deleteLater()
            self._batch = None

    def stop(self) -> None:
        """Close what is open: the window closes."""
        if self._batch is not None:
            self._batch.close()
