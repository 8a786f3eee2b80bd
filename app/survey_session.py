"""The only mutable state: the open survey with its results, decisions, undo stack, selection and cursor.

Everything that changes the survey goes through one of the commands of :mod:`app.review_commands`, which call the
``write_…`` methods here; each of them is on disk before it returns, and only then changes what the window shows.
"""

import getpass
import logging
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from app import decision_book
from app.candidate_list import CandidateList
from app.review_view import ReviewView, visible_range
from app.view_data import extent_s
from processing.errors import ErrorCode, LeaklineError
from processing.settings import Settings
from processing.sound.sizes import LeakSize, size_of
from processing.storage.folder import SurveyFolder
from processing.storage.review import Orphan
from processing.survey import Candidate, Decision, Finding, Run, Survey
from widgets.candidate_row import CandidateFilter, CandidateRow
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor

if TYPE_CHECKING:
    from processing.results import Results

log = logging.getLogger(__name__)


class SurveySession(QObject):
    """Holds the state and tells of each change. Belongs to the GUI thread, as the open database does."""

    closing = Signal()  # the open survey is about to be left
    opened = Signal()  # another survey, or none
    results_changed = Signal()
    settled = Signal()  # all that a run found is shown, and its first candidate selected
    candidates_changed = Signal()  # which ones there are
    decision_changed = Signal(int)
    selection_changed = Signal()
    filter_changed = Signal()  # or the order: which candidates the list shows, and how
    survey_changed = Signal()  # form or tie points
    reviewer_changed = Signal()  # whose decisions they are
    opinions_changed = Signal()  # of second reviewers, by import
    annexes_changed = Signal(int)  # photos or digs, of the leak with this number
    refused = Signal(object)  # LeaklineError: a change that could not be written; nothing has changed

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.cursor = TimeCursor(self)
        self.undo_stack = QUndoStack(self)
        self.list = CandidateList(self._size_of)
        self._forget()

    def _forget(self) -> None:
        self.folder: SurveyFolder | None = None
        self.survey = Survey()
        self.settings = Settings()
        self.results: Results | None = None
        self.run: Run | None = None
        self.orphans: tuple[Orphan, ...] = ()
        self.reviewer = ""  # a second one, who does not see the first one's decisions; empty: the first
        self.list.selected = None
        self.list.set_candidates((), {}, frozenset())

    # --- opening and closing ---

    def open(self, folder: SurveyFolder) -> None:
        """Take an open folder; the one before is closed."""
        self._close_folder()
        self.folder = folder
        self.survey = folder.read_survey()
        self.settings = folder.read_settings()
        self.opened.emit()

    def close(self) -> None:
        """Close the survey; everything is on disk already."""
        self._close_folder()
        self.opened.emit()

    def _close_folder(self) -> None:
        folder = self.folder
        if folder is not None:
            self.closing.emit()
        self.undo_stack.clear()
        self.cursor.set_track(None)
        self._forget()
        if folder is not None:
            folder.close()

    @property
    def writable(self) -> bool:
        """Whether the survey may be changed."""
        return self.folder is not None and not self.folder.read_only

    @property
    def operator(self) -> str:
        """Who decides: a second reviewer, else the form's operator, else the user's name on this computer."""
        if self.reviewer:
            return self.reviewer
        if self.survey.info.operator:
            return self.survey.info.operator
        try:
            return getpass.getuser()
        except (OSError, KeyError):
            return ""

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What opening, import and processing noticed."""
        opening = self.folder.findings if self.folder is not None else ()
        return opening + (self.results.findings if self.results is not None else ())

    # --- results ---

    def set_results(self, results: "Results", relocate: Callable[[Candidate], Candidate] | None = None) -> None:
        """Take results: store their run (a known one is recognised), carry decisions over, and show them.

        Raises:
            LeaklineError: DISC_FULL or CANNOT_WRITE; then the results before stay.
        """
        review = self._folder().review
        if self.writable:
            stored = review.add_run(
                Run(0, "", results.run_hash), results.candidates, operator=self.operator, relocate=relocate
            )
            run: Run | None = stored.run
            candidates = stored.candidates
        else:
            run = review.latest_run()
            known = run is not None and run.settings_hash == results.run_hash
            candidates = review.candidates(run) if run is not None and known else results.candidates
            run = run if known else None
        self._show_run(results, run, candidates)

    def _show_run(self, results: "Results", run: Run | None, candidates: tuple[Candidate, ...]) -> None:
        review = self._folder().review
        self.undo_stack.clear()  # its commands speak of the ids of the run before
        self.run = run
        self.results = replace(results, candidates=candidates)
        decisions = decision_book.read(self._folder(), run, candidates, self.reviewer)
        self.list.selected = None
        self.list.set_candidates(candidates, decisions, review.manual_ids(run) if run is not None else frozenset())
        self.orphans = review.orphaned_decisions()
        self._set_axis(results)
        self.results_changed.emit()
        self.candidates_changed.emit()
        shown = self.list.shown_ids() or self.ordered_ids()
        self.select(self.next_undecided(after=None) or next(iter(shown), None))
        self.settled.emit()

    def _set_axis(self, results: "Results") -> None:
        self.cursor.set_track(results.track)
        self.cursor.set_extent(*extent_s(results))
        if results.track is not None:
            self.cursor.set_axis_mode(AxisMode.DISTANCE)

    def set_reviewer(self, reviewer: str) -> None:
        """Review as a second person who does not see the first one's decisions; empty: as the first one again.

        Undo begins anew: its steps were another's.
        """
        if reviewer == self.reviewer or self.results is None:
            return
        self.undo_stack.clear()
        self.reviewer = reviewer
        candidates = [row.candidate for row in self.list.rows()]
        decisions = decision_book.read(self._folder(), self.run, candidates, reviewer)
        self.list.set_candidates(candidates, decisions, self.list.manual_ids())
        self.reviewer_changed.emit()
        self.candidates_changed.emit()
        self.select(self.next_undecided(after=None) or self.selected)

    def keep_orphans(self) -> None:
        """Put the verdicts that lost their candidate into the present run as marks of the operator's."""
        review = self._folder().review
        for orphan in self.orphans:
            if not self._written(partial(review.keep_orphan, orphan.candidate.id, self.operator)):
                return
        run = self.run
        assert run is not None  # there are no orphans without a run
        assert self.results is not None
        self._show_run(self.results, run, review.candidates(run))

    def rows(self) -> list[CandidateRow]:
        """Return all candidates with their decisions, in the order of the list; no filter hides one here."""
        return self.list.rows()

    def row(self, candidate_id: int | None) -> CandidateRow | None:
        """Return one candidate with its decision."""
        return self.list.row(candidate_id)

    def _size_of(self, candidate: Candidate) -> LeakSize | None:
        """Return the size that a candidate would have as a leak, by the present form."""
        if self.results is None:
            return None
        return size_of(candidate, self.survey, self.results.settings.size, self.results.candidates)

    def ordered_ids(self) -> list[int]:
        """Return all ids in the order of the list."""
        return self.list.ids()

    def decision(self, candidate_id: int) -> Decision:
        """Return the decision on a candidate; an empty one where there is none."""
        row = self.list.row(candidate_id)
        return Decision() if row is None else row.decision

    @property
    def decisions(self) -> dict[int, Decision]:
        """All decisions of the present run that say something, by candidate id."""
        return self.list.decisions()

    # --- what the list shows, and how ---

    @property
    def filter(self) -> CandidateFilter:
        """Which candidates the list shows; the views show all."""
        return self.list.filter

    def set_filter(self, wanted: CandidateFilter) -> None:
        """Show other candidates in the list; the selection stays."""
        if wanted != self.list.filter:
            self.list.filter = wanted
            self.filter_changed.emit()

    def set_order(self, order: str) -> None:
        """Sort by ``score`` or ``chainage``."""
        if order != self.list.order:
            self.list.order = order
            self.filter_changed.emit()

    @property
    def view(self) -> ReviewView:
        """How the review is seen now."""
        cursor = self.cursor
        return ReviewView(self.selected, self.filter, cursor.axis_mode, cursor.x_range)

    def show_view(self, view: ReviewView) -> None:
        """See the review as it was: filter, range and selection; the selected candidate is in sight in any case."""
        self.set_filter(view.filter)
        visible_range(self.cursor, view)
        self.select(view.selected)

    # --- selection ---

    @property
    def selected(self) -> int | None:
        """The id of the selected candidate."""
        return self.list.selected

    def select(self, candidate_id: int | None, *, move_cursor: bool = True) -> None:
        """Select a candidate and bring the cursor to it."""
        row = self.list.row(candidate_id)
        if candidate_id is not None and row is None:
            return
        changed = candidate_id != self.list.selected
        self.list.selected = candidate_id
        if changed:
            self.selection_changed.emit()
        if move_cursor and row is not None:
            self.cursor.set_time(row.candidate.time_s)

    def neighbour(self, step: int) -> int | None:
        """Return the id ``step`` places down the shown list, the ends being the ends."""
        return self.list.neighbour(step)

    def next_undecided(self, after: int | None, *, upwards: bool = False) -> int | None:
        """Return the next shown candidate without a verdict, below ``after``, then from the top; None for none."""
        return self.list.next_undecided(after, upwards=upwards)

    # --- writing; called by the commands only ---

    def push(self, command: QUndoCommand) -> None:
        """Do a command and remember it for undo."""
        self.undo_stack.push(command)

    def write_decision(self, candidate_id: int, decision: Decision, reason: str) -> bool:
        """Put a decision on disk, then show it; returns False, having told why, where it could not be written."""
        return self.write_decisions({candidate_id: decision}, reason)

    def write_decisions(self, decisions: Mapping[int, Decision], reason: str) -> bool:
        """Put decisions on disk, all of them or none, then show them; False where they could not be written."""

        labels = {i: row.candidate.label for i in decisions if (row := self.list.row(i)) is not None}
        write = partial(decision_book.write, self._folder(), decisions, labels, self.operator, reason, self.reviewer)
        if not self._written(write):
            return False
        for candidate_id, decision in decisions.items():
            self.list.set_decision(candidate_id, decision)
        if len(decisions) == 1:
            self.decision_changed.emit(next(iter(decisions)))
        else:
            self.candidates_changed.emit()
        return True

    def write_mark(self, candidate: Candidate) -> Candidate | None:
        """Store a candidate marked by hand and return it with its id; None where it could not be written."""
        stored: list[Candidate] = []

        def write() -> None:
            run = self.run
            if run is None:
                raise LeaklineError(ErrorCode.SURVEY_READ_ONLY)
            stored.append(self._folder().review.add_manual_candidate(run, candidate, self.operator))

        if not self._written(write):
            return None
        self._show_mark(stored[0], shown=True)
        return stored[0]

    def write_mark_withdrawn(self, candidate: Candidate, *, withdrawn: bool) -> bool:
        """Take a mark back, or put it there again."""
        review = self._folder().review
        call = review.withdraw_manual_candidate if withdrawn else review.reinstate_manual_candidate
        if not self._written(lambda: call(candidate.id, self.operator)):
            return False
        self._show_mark(candidate, shown=not withdrawn)
        return True

    def write_mark_moved(self, before: Candidate, moved: Candidate) -> Candidate | None:
        """Put a mark to another place, under the same number and with its decision; None where it was refused."""
        stored: list[Candidate] = []
        review = self._folder().review
        if not self._written(lambda: stored.append(review.move_manual_candidate(before.id, moved, self.operator))):
            return None
        self._swap_marks(before, stored[0])
        return stored[0]

    def write_mark_back(self, now: Candidate, then: Candidate) -> bool:
        """Undo, or redo, the moving of a mark: ``then`` is one of its earlier (later) places."""
        review = self._folder().review
        if not self._written(lambda: review.swap_manual_candidates(now.id, then.id, self.operator)):
            return False
        self._swap_marks(now, then)
        return True

    def write_survey(self, survey: Survey) -> bool:
        """Put form and tie points on disk, then show them."""
        if not self._written(lambda: self._folder().write_survey(survey, self.operator)):
            return False
        self.survey = survey
        self.survey_changed.emit()
        return True

    def write_settings(self, settings: Settings) -> bool:
        """Put settings on disk; they count when the survey is processed again."""
        if not self._written(lambda: self._folder().write_settings(settings)):
            return False
        self.settings = settings
        self.survey_changed.emit()
        return True

    def _show_mark(self, candidate: Candidate, *, shown: bool) -> None:
        if shown:
            self.list.add_mark(candidate, decision_book.read_one(self._folder(), candidate, self.reviewer))
        else:
            self.list.remove(candidate.id)
        self._tell_marks()

    def _swap_marks(self, gone: Candidate, come: Candidate) -> None:
        """Show a mark at its other place; who was selected stays so, though it has another id."""
        selected = self.list.selected == gone.id
        self.list.remove(gone.id)
        self.list.add_mark(come, decision_book.read_one(self._folder(), come, self.reviewer))
        if selected:
            self.list.selected = come.id
        self._tell_marks()
        if selected:
            self.cursor.set_time(come.time_s)

    def _tell_marks(self) -> None:
        if self.results is not None:
            self.results = replace(self.results, candidates=tuple(row.candidate for row in self.list.rows()))
        self.candidates_changed.emit()

    def write(self, write: Callable[[], object]) -> bool:
        """Do what writes to a store of the folder; returns False, having told why, where it could not be written."""
        return self._written(write)

    def _written(self, write: Callable[[], object]) -> bool:
        if not self.writable:
            self.refused.emit(LeaklineError(ErrorCode.SURVEY_READ_ONLY))
            return False
        try:
            write()
        except LeaklineError as error:
            log.warning("not written: %s", error)
            self.refused.emit(error)
            return False
        return True

    def _folder(self) -> SurveyFolder:
        assert self.folder is not None  # the actions are off while no survey is open
        return self.folder
