"""A colleague's opinions taken into the survey as one undoable step."""

from collections.abc import Mapping

from PySide6.QtGui import QUndoCommand

from app.survey_session import SurveySession
from processing.survey import Decision

Opinions = Mapping[str, Mapping[int, Decision]]  # reviewer → leak number → decision


class TakeOpinions(QUndoCommand):
    """Stores opinions; undo puts back what each reviewer had said before, if anything."""

    def __init__(self, session: SurveySession, text: str, after: Opinions) -> None:
        super().__init__(text)
        self._session = session
        self._after = {name: dict(decisions) for name, decisions in after.items()}
        folder = session.folder
        said = {name: folder.opinions.of(name) if folder is not None else {} for name in after}
        self._before = {name: {n: said[name].get(n, Decision()) for n in after[name]} for name in after}

    def redo(self) -> None:
        """Qt: store them."""
        self._store(self._after)

    def undo(self) -> None:
        """Qt: take them back."""
        self._store(self._before)

    def _store(self, opinions: Mapping[str, dict[int, Decision]]) -> None:
        session = self._session
        folder = session.folder
        if folder is None:
            self.setObsolete(True)
            return
        for name, decisions in opinions.items():
            if not session.write(lambda n=name, d=decisions: folder.opinions.give_all(d, n)):  # type: ignore[misc]
                self.setObsolete(True)
                return
        session.opinions_changed.emit()
