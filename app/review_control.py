"""What the review keys and buttons do: verdicts, notes, marks, moving among candidates and along the run."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.evidence import evidence_brief, evidence_text
from app.marking import REACTION_S, candidate_at
from app.player import Player
from app.review_commands import Decide, Mark, WriteNote
from app.survey_session import SurveySession
from processing.survey import LeakClass, Verdict
from widgets.time_axis import AxisMode
from widgets.vocabulary import verdict_text

if TYPE_CHECKING:
    from app.review_page import ReviewPage

STEPS_A_VIEW = 50  # one press of an arrow key moves by this part of what is shown
MOST_PHRASES = 9
CLOSE_S = 1.0  # a cursor this close to a candidate means it, however narrow it is


class ReviewControl(QObject):
    """Connects the session with the review page; each public method without arguments is an action's handler."""

    told = Signal(str)  # what has just happened, for a line that goes away

    def __init__(
        self, session: SurveySession, page: "ReviewPage", player: Player, language: str, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._session, self._page, self._player, self._language = session, page, player, language
        self._typing = 0  # counts the visits to the note field: what is typed in one visit is one undo step
        self._in_selection = False
        self._refused = False
        self._autoplay = False  # play each candidate on arrival
        session.results_changed.connect(self._show_results)
        session.opened.connect(self._show_results)
        session.candidates_changed.connect(self._show_candidates)
        session.decision_changed.connect(self._show_decision)
        session.selection_changed.connect(self._show_selection)
        session.filter_changed.connect(self._show_list)
        session.refused.connect(self._on_refused)
        session.survey_changed.connect(self._show_tie_points)
        session.survey_changed.connect(self._show_sizes)
        session.cursor.moved.connect(self._on_cursor)
        page.table.candidate_chosen.connect(self._choose)
        page.candidate_clicked.connect(self._choose)
        page.decision.verdict_chosen.connect(self.decide)
        page.decision.class_chosen.connect(self._decide_class)
        page.decision.note_changed.connect(self._write_note)
        page.decision.note_left.connect(self._end_note)
        page.decision.phrase_chosen.connect(self._add_phrase)
        self._show_results()

    # --- verdicts ---

    def confirm(self) -> None:
        """Confirm the selected candidate and go on."""
        self.decide(Verdict.CONFIRMED)

    def reject(self) -> None:
        """Reject the selected candidate and go on."""
        self.decide(Verdict.REJECTED)

    def unsure(self) -> None:
        """Leave the selected candidate open and go on."""
        self.decide(Verdict.UNSURE)

    def clear(self) -> None:
        """Take the verdict away and stay."""
        self.decide(Verdict.NONE)

    def decide(self, verdict: Verdict) -> None:
        """Give a verdict; any but NONE moves on to the next undecided candidate."""
        self._page.decision.flush()
        row = self._session.row(self._session.selected)
        if row is None:
            return
        looping = self._player.looping
        candidate_id = row.candidate.id
        then = candidate_id if verdict is Verdict.NONE else self._session.list.next_to_judge(candidate_id)
        text = self.tr("{name}: {verdict}").format(name=row.name, verdict=verdict_text(verdict))
        after = replace(row.decision, verdict=verdict)
        if after == row.decision:
            self._session.select(candidate_id if then is None else then)
        else:
            self._session.push(Decide(self._session, text, candidate_id, after, then))
        if self._session.selected != candidate_id:
            self._arrive(listening=looping)
        elif verdict is not Verdict.NONE and self._session.decision(candidate_id) == after:
            self._tell_end()

    def set_autoplay(self, on: bool) -> None:
        """Play each candidate on arrival, or wait for the key."""
        self._autoplay = on

    def _arrive(self, *, listening: bool) -> None:
        """Let who listens in a loop go on listening where the selection has gone, and who wants to hear each."""
        if listening or self._autoplay:
            self._player.loop_selected()

    def _tell_end(self) -> None:
        """Say that nothing is left to judge, or that the filter hides it."""
        left = sum(row.decision.verdict is Verdict.NONE for row in self._session.rows())
        if left:
            text = self.tr("Nothing undecided is left in this list; undecided ones that the filter hides: {count}")
            self.told.emit(text.format(count=left))
        elif self._session.reviewer:
            self.told.emit(self.tr("All candidates are judged: end the second review and compare (Ctrl+J)"))
        else:
            self.told.emit(self.tr("All candidates are decided: go to the report (Ctrl+5)"))

    def _decide_class(self, leak_class: LeakClass | None) -> None:
        row = self._session.row(self._session.selected)
        if row is not None and row.decision.leak_class is not leak_class:
            text = self.tr("class of {name}").format(name=row.name)
            after = replace(row.decision, leak_class=leak_class)
            self._session.push(Decide(self._session, text, row.candidate.id, after))
        self._page.focus_views()

    def _write_note(self, candidate_id: int, note: str) -> None:
        row = self._session.row(candidate_id)
        if row is None or row.decision.note == note:
            return
        text = self.tr("note on {name}").format(name=row.name)
        after = replace(row.decision, note=note)
        self._session.push(WriteNote(self._session, text, candidate_id, after, self._typing))

    def _end_note(self) -> None:
        self._typing += 1
        self._page.focus_views()

    def _add_phrase(self, phrase: str) -> None:
        """Write a note that was written before: as it is, or behind what stands there."""
        self._page.decision.flush()
        row = self._session.row(self._session.selected)
        if row is not None:
            self._typing += 1
            note = row.decision.note.rstrip()
            self._write_note(row.candidate.id, f"{note}; {phrase}" if note else phrase)

    def choose_phrase(self) -> None:
        """Open the list of the notes that were written in this survey."""
        self._page.decision.open_phrases()

    def choose_class(self) -> None:
        """Open the list of classes."""
        self._page.decision.open_classes()

    def edit_note(self) -> None:
        """Put the caret into the note."""
        self._typing += 1
        self._page.decision.focus_note()

    def undo(self) -> None:
        """Take the last change back."""
        stack = self._session.undo_stack
        self._again(stack.undoText, stack.undo, self.tr("Undone: {what}"))

    def redo(self) -> None:
        """Do it again."""
        stack = self._session.undo_stack
        self._again(stack.redoText, stack.redo, self.tr("Done again: {what}"))

    def _again(self, name: Callable[[], str], step: Callable[[], None], words: str) -> None:
        self._page.decision.flush()
        text, self._refused = name(), False
        step()
        if text and not self._refused:
            self.told.emit(words.format(what=text))

    def _on_refused(self) -> None:
        self._refused = True

    def mark_here(self) -> None:
        """Add a candidate at the cursor, or while listening where it was heard."""
        results = self._session.results
        if results is None:
            return
        playing = self._player.playing
        candidate = candidate_at(results, self._player.heard_s(REACTION_S))
        text = self.tr("mark by hand")
        self._session.push(Mark(self._session, text, candidate, move_cursor=not playing))

    # --- moving ---

    def next_candidate(self) -> None:
        """Select the candidate below."""
        self._go(self._session.neighbour(+1))

    def previous_candidate(self) -> None:
        """Select the candidate above."""
        self._go(self._session.neighbour(-1))

    def next_undecided(self) -> None:
        """Select the next candidate without a verdict."""
        self._go_undecided(upwards=False)

    def previous_undecided(self) -> None:
        """Select the candidate above without a verdict."""
        self._go_undecided(upwards=True)

    def _go_undecided(self, *, upwards: bool) -> None:
        found = self._session.next_undecided(self._session.selected, upwards=upwards)
        row = self._session.row(self._session.selected)
        if found is not None:
            self._go(found)
        elif row is None or row.decision.verdict is not Verdict.NONE:
            self._tell_end()

    def _go(self, candidate_id: int | None) -> None:
        listening, before = self._player.looping, self._session.selected
        self._session.select(candidate_id)
        if self._session.selected != before:
            self._arrive(listening=listening)

    def go_to_candidate(self) -> None:
        """Bring cursor and views to the selected candidate, close enough to see it."""
        row = self._session.row(self._session.selected)
        if row is None:
            return
        self._session.select(row.candidate.id)
        cursor = self._session.cursor
        x = float(cursor.x_of_time(row.candidate.time_s))
        first, last = cursor.x_extent
        half = max((last - first) / 20.0, row.candidate.width_m if cursor.axis_mode is AxisMode.DISTANCE else 5.0)
        cursor.set_x_range(x - half, x + half)

    def step_back(self) -> None:
        """Move the cursor by a small part of the view."""
        self._step(-1)

    def step_forward(self) -> None:
        """Move the cursor by a small part of the view."""
        self._step(+1)

    def _step(self, sign: int) -> None:
        cursor = self._session.cursor
        low, high = cursor.x_range
        x = float(cursor.x_of_time(cursor.time_s)) + sign * (high - low) / STEPS_A_VIEW
        before = cursor.time_s
        cursor.set_time(float(cursor.time_of_x(x)))
        if cursor.time_s == before:  # it stood still here: metres lead nowhere, seconds do
            cursor.move_by(sign * 1.0)

    def step_back_1s(self) -> None:
        """Move the cursor one second back."""
        self._session.cursor.move_by(-1.0)

    def step_forward_1s(self) -> None:
        """Move the cursor one second forward."""
        self._session.cursor.move_by(1.0)

    def step_back_10s(self) -> None:
        """Move the cursor ten seconds back."""
        self._session.cursor.move_by(-10.0)

    def step_forward_10s(self) -> None:
        """Move the cursor ten seconds forward."""
        self._session.cursor.move_by(10.0)

    def fit(self) -> None:
        """Show the whole run."""
        self._session.cursor.fit()
        self._page.fit_path()

    # --- showing ---

    def _show_results(self) -> None:
        self._page.show_results(self._session.results)
        self._show_tie_points()
        self._show_candidates()

    def _show_tie_points(self) -> None:
        self._page.show_tie_points(self._session.survey.tie_points)

    def _show_sizes(self) -> None:
        """Tell the sizes anew: they rest on the pressure and on a known leak, which the form may have changed."""
        self._session.list.measure_sizes()
        self._show_list()
        self._show_selected_row()

    def _show_candidates(self) -> None:
        self._page.show_candidates(self._session.rows())
        self._show_selection()

    def _show_list(self) -> None:
        """Show what the filter lets through; who was decided leaves it here, when the selection has moved on."""
        self._page.table.set_rows(self._session.list.shown(), searched=self._session.results is not None)
        self._page.table.select(self._session.selected)

    def _show_decision(self, candidate_id: int) -> None:
        self._show_list()
        self._page.show_candidates(self._session.rows())
        if candidate_id == self._session.selected:
            self._show_selected_row()

    def _show_selection(self) -> None:
        self._show_list()
        self._page.select_candidate(self._session.selected)
        self._show_selected_row()

    def _show_selected_row(self) -> None:
        row = self._session.row(self._session.selected)
        story = "" if row is None else evidence_text(row, self._language)
        brief = "" if row is None else evidence_brief(row)
        self._page.decision.show_row(row, writable=self._session.writable, evidence=brief, story=story)
        notes = Counter(r.decision.note for r in self._session.rows() if r.decision.note and r is not row)
        self._page.decision.set_phrases([note for note, _ in notes.most_common(MOST_PHRASES)])

    def _choose(self, candidate_id: int) -> None:
        self._in_selection = True
        self._go(candidate_id)
        self._in_selection = False

    def _on_cursor(self, time_s: float) -> None:
        """Let the selection follow a cursor that the operator moved; never one that the playback moves.

        While listening, the selection must not slip away under the finger that is about to give the verdict.
        """
        if self._in_selection or self._player.moves_cursor or self._session.results is None:
            return
        selected = self._session.row(self._session.selected)
        if selected is not None and selected.candidate.time_s == time_s:
            return
        chainage_m = self._session.cursor.chainage_at(time_s)
        best: tuple[float, int] | None = None
        for row in self._session.list.shown():
            candidate = row.candidate
            away_s = abs(candidate.time_s - time_s)
            inside = chainage_m is not None and abs(candidate.chainage_m - chainage_m) <= candidate.width_m / 2.0
            if (inside or away_s <= CLOSE_S) and (best is None or away_s < best[0]):
                best = (away_s, candidate.id)
        if best is not None:
            self._session.select(best[1], move_cursor=False)
