"""Every change of a survey as an undoable command that holds ids and the values before and after.

A command whose write was refused makes itself obsolete: it never enters the undo stack, or leaves it.
"""

from PySide6.QtGui import QUndoCommand

from app.survey_session import SurveySession
from processing.settings import Settings
from processing.survey import Candidate, Decision, Survey

NOTE_COMMAND = 1
DECIDE, UNDO, REDO = "decide", "undo", "redo"  # why a row of the decision log is written


class Decide(QUndoCommand):
    """Gives a verdict, class or note; ``then_select`` is where the selection goes, undo brings it back."""

    def __init__(
        self, session: SurveySession, text: str, candidate_id: int, after: Decision, then_select: int | None = None
    ) -> None:
        super().__init__(text)
        self._session = session
        self._candidate_id = candidate_id
        self._before, self._after = session.decision(candidate_id), after
        self._then_select = candidate_id if then_select is None else then_select
        self._done_before = False

    def redo(self) -> None:
        """Qt: do it, for the first time or again."""
        reason = REDO if self._done_before else DECIDE
        self._done_before = True
        if self._session.write_decision(self._candidate_id, self._after, reason):
            self._session.select(self._then_select)
        else:
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: take it back, and select the candidate again."""
        if self._session.write_decision(self._candidate_id, self._before, UNDO):
            self._session.select(self._candidate_id)
        else:
            self.setObsolete(True)


class WriteNote(QUndoCommand):
    """Writes a note; what is typed in one go (``typing``) on one candidate is one step of undo, though each
    moment of it is on disk.
    """

    def __init__(self, session: SurveySession, text: str, candidate_id: int, after: Decision, typing: int) -> None:
        super().__init__(text)
        self._session = session
        self.candidate_id = candidate_id
        self.before, self.after = session.decision(candidate_id), after
        self.typing = typing
        self._done_before = False

    def id(self) -> int:
        """Qt: notes can be merged."""
        return NOTE_COMMAND

    def mergeWith(self, other: QUndoCommand) -> bool:
        """Qt: take the newer note into this step."""
        if not isinstance(other, WriteNote) or (other.candidate_id, other.typing) != (self.candidate_id, self.typing):
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
            self._session.select(self.candidate_id)
        else:
            self.setObsolete(True)


class Mark(QUndoCommand):
    """Marks a leak by hand; undo withdraws the mark (the database keeps its trace)."""

    def __init__(self, session: SurveySession, text: str, candidate: Candidate) -> None:
        super().__init__(text)
        self._session = session
        self._new = candidate
        self._stored: Candidate | None = None
        self._selected_before = session.selected

    def redo(self) -> None:
        """Qt: store the mark, or put it there again."""
        if self._stored is None:
            self._stored = self._session.write_mark(self._new)
            done = self._stored is not None
        else:
            done = self._session.write_mark_withdrawn(self._stored, withdrawn=False)
        if done and self._stored is not None:
            self._session.select(self._stored.id)
        else:
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: take the mark back."""
        if self._stored is not None and self._session.write_mark_withdrawn(self._stored, withdrawn=True):
            self._session.select(self._selected_before)
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
