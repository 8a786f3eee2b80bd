"""Which actions make sense now, from what they need; undo and redo say what they would do."""

from collections.abc import Mapping

from PySide6.QtGui import QAction

from app.actions import ACTIONS, Needs
from app.survey_session import SurveySession


def show_enabled(actions_by_id: Mapping[str, QAction], session: SurveySession, *, reviewing: bool) -> None:
    """Enable what can be done; ``reviewing`` tells whether a review page with results is in front."""
    met = {
        Needs.NOTHING: True,
        Needs.SURVEY: session.folder is not None,
        Needs.RESULTS: reviewing,
        Needs.CANDIDATE: reviewing and session.selected is not None,
        Needs.WRITABLE: session.writable,
    }
    for row in ACTIONS:
        actions_by_id[row.id].setEnabled(met[row.needs])
    for name in ("mark", "tie"):
        actions_by_id[name].setEnabled(reviewing and session.writable)
    actions_by_id["export"].setEnabled(session.results is not None)
    stack = session.undo_stack
    for name, able, text in (
        ("undo", stack.canUndo(), stack.undoText()),
        ("redo", stack.canRedo(), stack.redoText()),
    ):
        action = actions_by_id[name]
        action.setEnabled(able and session.folder is not None)
        action.setStatusTip(text)
        action.setToolTip(f"{action.text()}: {text}" if text else action.text())
