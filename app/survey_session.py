"""The only mutable state: the open survey with its results, decisions, undo stack, selection and cursor.

Everything that changes the survey goes through one of the commands of :mod:`app.review_commands`, which call the
``write_…`` methods here; each of them is on disk before it returns, and only then changes what the window shows.
"""

import getpass
import logging
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from app.view_data import extent_s
from processing.errors import ErrorCode, LeaklineError
from processing.settings import Settings
from processing.sound.sizes import size_of
from processing.storage.folder import SurveyFolder
from processing.storage.review import Orphan
from processing.survey import Candidate, Decision, Finding, Run, Survey, Verdict
from widgets.candidate_table import CandidateRow, sort_rows
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor

if TYPE_CHECKING:
    from processing.results import Results

log = logging.getLogger(__name__)


class SurveySession(QObject):
    """Holds the state and tells of each change. Belongs to the GUI thread, as the open database does."""

    opened = Signal()  # another survey, or none
    results_changed = Signal()
    candidates_changed = Signal()  # which ones there are
    decision_changed = Signal(int)
    selection_changed = Signal()
    survey_changed = Signal()  # form or tie points
    refused = Signal(object)  # LeaklineError: a change that could not be written; nothing has changed

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.cursor = TimeCursor(self)
        self.undo_stack = QUndoStack(self)
        self.order = "score"
        self._forget()

    def _forget(self) -> None:
        self.folder: SurveyFolder | None = None
        self.survey = Survey()
        self.settings = Settings()
        self.results: Results | None = None
        self.run: Run | None = None
        self.orphans: tuple[Orphan, ...] = ()
        self._candidates: dict[int, Candidate] = {}
        self._decisions: dict[int, Decision] = {}
        self._manual: frozenset[int] = frozenset()
        self._selected: int | None = None

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
        """Who decides: the form's operator, else the user's name on this computer."""
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
        self._candidates = {c.id: c for c in candidates}
        self._decisions = review.decisions(run) if run is not None else {}
        self._manual = review.manual_ids(run) if run is not None else frozenset()
        self.orphans = review.orphaned_decisions()
        self._selected = None
        self._set_axis(results)
        self.results_changed.emit()
        self.candidates_changed.emit()
        self.select(self.next_undecided(after=None) or next(iter(self.ordered_ids()), None))

    def _set_axis(self, results: "Results") -> None:
        self.cursor.set_track(results.track)
        self.cursor.set_extent(*extent_s(results))
        if results.track is not None:
            self.cursor.set_axis_mode(AxisMode.DISTANCE)

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
        """Return all candidates with their decisions, in the order of the list."""
        return sort_rows([self._row(c) for c in self._candidates.values()], self.order)

    def row(self, candidate_id: int | None) -> CandidateRow | None:
        """Return one candidate with its decision."""
        candidate = self._candidates.get(candidate_id) if candidate_id is not None else None
        if candidate is None:
            return None
        return self._row(candidate)

    def _row(self, candidate: Candidate) -> CandidateRow:
        """Return a candidate with its decision and the size that it would have as a leak, by the present form."""
        size = None
        if self.results is not None:
            size = size_of(candidate, self.survey, self.results.settings.size, self.results.candidates)
        return CandidateRow(candidate, self.decision(candidate.id), candidate.id in self._manual, size)

    def ordered_ids(self) -> list[int]:
        """Return the ids in the order of the list."""
        return [row.candidate.id for row in self.rows()]

    def decision(self, candidate_id: int) -> Decision:
        """Return the decision on a candidate; an empty one where there is none."""
        return self._decisions.get(candidate_id, Decision())

    @property
    def decisions(self) -> dict[int, Decision]:
        """All decisions of the present run, by candidate id."""
        return dict(self._decisions)

    # --- selection ---

    @property
    def selected(self) -> int | None:
        """The id of the selected candidate."""
        return self._selected

    def select(self, candidate_id: int | None, *, move_cursor: bool = True) -> None:
        """Select a candidate and bring the cursor to it."""
        if candidate_id is not None and candidate_id not in self._candidates:
            return
        changed = candidate_id != self._selected
        self._selected = candidate_id
        if changed:
            self.selection_changed.emit()
        if move_cursor and candidate_id is not None:
            self.cursor.set_time(self._candidates[candidate_id].time_s)

    def neighbour(self, step: int) -> int | None:
        """Return the id ``step`` places down the list, the ends being the ends."""
        ids = self.ordered_ids()
        if not ids:
            return None
        at = ids.index(self._selected) if self._selected in ids else -1 if step > 0 else len(ids)
        return ids[min(max(at + step, 0), len(ids) - 1)]

    def next_undecided(self, after: int | None) -> int | None:
        """Return the next candidate without a verdict, below ``after``, then from the top; None for none."""
        ids = self.ordered_ids()
        start = ids.index(after) + 1 if after in ids else 0
        around = ids[start:] + ids[:start]
        return next((i for i in around if i != after and self.decision(i).verdict is Verdict.NONE), None)

    # --- writing; called by the commands only ---

    def push(self, command: QUndoCommand) -> None:
        """Do a command and remember it for undo."""
        self.undo_stack.push(command)

    def write_decision(self, candidate_id: int, decision: Decision, reason: str) -> bool:
        """Put a decision on disk, then show it; returns False, having told why, where it could not be written."""

        def write() -> None:
            self._folder().review.decide(candidate_id, decision, self.operator, reason)

        if not self._written(write):
            return False
        self._decisions[candidate_id] = decision
        self.decision_changed.emit(candidate_id)
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
        self._candidates.pop(candidate.id, None)
        self._manual = self._manual - {candidate.id}
        if shown:
            self._candidates[candidate.id] = candidate
            self._manual = self._manual | {candidate.id}
        if self.results is not None:
            self.results = replace(self.results, candidates=tuple(self._candidates.values()))
        if self._selected not in self._candidates:
            self._selected = None
        self.candidates_changed.emit()

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
