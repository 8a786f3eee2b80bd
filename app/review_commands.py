"""Every change of a survey as an undoable command that holds ids and the values before and after.

A command whose write was refused makes itself obsolete: it never enters the undo stack, or leaves it.
"""

from collections.abc import Mapping

from PySide6.QtGui import QUndoCommand

from app.review_view import ReviewView
from app.survey_session import SurveySession
from processing.settings import Settings
from processing.survey import Candidate, Decision, Survey

NOTE_COMMAND, NUDGE_COMMAND = 1, 2
DECIDE, UNDO, REDO = "decide", "undo", "redo"  # why a row of the decision log is written


class _ReviewStep(QUndoCommand):
    """A step of the review; undo and redo show again what was seen before and after it was first done."""

    def __init__(self, session: SurveySession, text: str) -> None:
        super().__init__(text)
        self._session = session
        self._seen_before = session.view
        self._seen_after: ReviewView | None = None  # until it has been done

    @property
    def _reason(self) -> str:
        return DECIDE if self._seen_after is None else REDO

    def _show_before(self) -> None:
        self._session.show_view(self._seen_before)

    def _show_after(self, then_select: int | None) -> None:
        """Select what comes next; a step that is done again shows what was seen then."""
        if self._seen_after is None:
            self._session.select(then_select)
            self._seen_after = self._session.view
        else:
            self._session.show_view(self._seen_after)


class Decide(_ReviewStep):
    """Gives a verdict, class or note; ``then_select`` is where the selection goes, undo brings it back."""

    def __init__(
        self, session: SurveySession, text: str, candidate_id: int, after: Decision, then_select: int | None = None
    ) -> None:
        super().__init__(session, text)
        self._candidate_id = candidate_id
        self._before, self._after = session.decision(candidate_id), after
        self._then_select = candidate_id if then_select is None else then_select

    def redo(self) -> None:
        """Qt: do it, for the first time or again."""
        if self._session.write_decision(self._candidate_id, self._after, self._reason):
            self._show_after(self._then_select)
        else:
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: take it back, and select the candidate again."""
        if self._session.write_decision(self._candidate_id, self._before, UNDO):
            self._show_before()
            self._session.select(self._candidate_id)
        else:
            self.setObsolete(True)


class DecideMany(_ReviewStep):
    """Gives many candidates their verdict in one step; the selection goes on to what is left to judge."""

    def __init__(self, session: SurveySession, text: str, after: Mapping[int, Decision]) -> None:
        super().__init__(session, text)
        self._before, self._after = {i: session.decision(i) for i in after}, dict(after)

    def redo(self) -> None:
        """Qt: do it, for the first time or again."""
        session = self._session
        if not session.write_decisions(self._after, self._reason):
            self.setObsolete(True)
            return
        selected = session.selected
        self._show_after(session.next_undecided(selected) if selected in self._after else selected)

    def undo(self) -> None:
        """Qt: take all of it back."""
        if self._session.write_decisions(self._before, UNDO):
            self._show_before()
        else:
            self.setObsolete(True)


class WriteNote(_ReviewStep):
    """Writes a note; what is typed in one go (``typing``) on one candidate is one step of undo, though each
    moment of it is on disk.
    """

    def __init__(self, session: SurveySession, text: str, candidate_id: int, after: Decision, typing: int) -> None:
        super().__init__(session, text)
        self.candidate_id = candidate_id
        self.before, self.after = session.decision(candidate_id), after
        self.typing = typing
        self._done_before = False

    def id(self) -> int:
        """Qt: notes can be merged."""
        return NOTE_COMMAND

    def mergeWith(self, other: QUndoCommand) -> bool:
        """Qt: take the newer note into this step."""
        if (
            not isinstance(other, WriteNote)
            or other.isObsolete()
            or (other.candidate_id, other.typing) != (self.candidate_id, self.typing)
        ):
            return False
        self.after = other.after
        return True

    def redo(self) -> None:
        """Qt: write the note; the selection stays where the operator is."""
        reason = REDO if self._done_before else DECIDE
        if not self._session.write_decision(self.candidate_id, self.after, reason):
            self.setObsolete(True)
        elif self._done_before:
            self._session.select(self.candidate_id)
        self._done_before = True

    def undo(self) -> None:
        """Qt: put the note before back."""
        if self._session.write_decision(self.candidate_id, self.before, UNDO):
            self._show_before()
            self._session.select(self.candidate_id)
        else:
            self.setObsolete(True)


class Mark(_ReviewStep):
    """Marks a leak by hand; undo withdraws the mark (the database keeps its trace).

    ``move_cursor`` False leaves the cursor to the playback, which goes on while somebody listens and marks.
    """

    def __init__(self, session: SurveySession, text: str, candidate: Candidate, *, move_cursor: bool = True) -> None:
        super().__init__(session, text)
        self._new = candidate
        self._stored: Candidate | None = None
        self._move_cursor = move_cursor

    def redo(self) -> None:
        """Qt: store the mark, or put it there again."""
        if self._stored is None:
            self._stored = self._session.write_mark(self._new)
            done = self._stored is not None
        else:
            done = self._session.write_mark_withdrawn(self._stored, withdrawn=False)
        if done and self._stored is not None:
            self._session.select(self._stored.id, move_cursor=self._move_cursor)
        else:
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: take the mark back."""
        if self._stored is not None and self._session.write_mark_withdrawn(self._stored, withdrawn=True):
            self._show_before()
        else:
            self.setObsolete(True)


class MoveMark(_ReviewStep):
    """Puts a mark of the operator's to another place; nudges of one mark in a row are one step of undo."""

    def __init__(self, session: SurveySession, text: str, before: Candidate, moved: Candidate, *, nudge: bool) -> None:
        super().__init__(session, text)
        self.before, self._moved, self._nudge = before, moved, nudge
        self.after: Candidate | None = None  # once it is stored

    def id(self) -> int:
        """Qt: nudges can be merged, other moves not."""
        return NUDGE_COMMAND if self._nudge else -1

    def mergeWith(self, other: QUndoCommand) -> bool:
        """Qt: take the next nudge into this step."""
        if not isinstance(other, MoveMark) or self.after is None or other.after is None:
            return False
        if other.before.id != self.after.id:
            return False
        self.after = other.after
        return True

    def redo(self) -> None:
        """Qt: move it, or put it there again."""
        if self.after is None:
            self.after = self._session.write_mark_moved(self.before, self._moved)
            done = self.after is not None
        else:
            done = self._session.write_mark_back(self.before, self.after)
        if not done:
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: put it back to where it was."""
        if self.after is not None and self._session.write_mark_back(self.after, self.before):
            self._show_before()
        else:
            self.setObsolete(True)


class EditSurvey(QUndoCommand):
    """Changes the form, the tie points or the route; with ``before`` given, it is a change that was made already."""

    def __init__(self, session: SurveySession, text: str, after: Survey, *, before: Survey | None = None) -> None:
        super().__init__(text)
        self._session = session
        self._before, self._after = session.survey if before is None else before, after
        self._made = before is not None

    def redo(self) -> None:
        """Qt: write the new values."""
        made, self._made = self._made, False
        if made:
            return
        if not self._session.write_survey(self._after):
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: write the values before."""
        if not self._session.write_survey(self._before):
            self.setObsolete(True)


class EditSettings(QUndoCommand):
    """Changes a tunable of the processing."""

    def __init__(self, session: SurveySession, text: str, after: Settings) -> None:
        super().__init__(text)
        self._session = session
        self._before, self._after = session.settings, after

    def redo(self) -> None:
        """Qt: write the new settings."""
        if not self._session.write_settings(self._after):
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: write the settings before."""
        if not self._session.write_settings(self._before):
            self.setObsolete(True)
