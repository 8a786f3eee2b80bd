"""Which actions make sense now, from what they need; undo and redo say what they would do."""

from collections.abc import Mapping

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QAbstractSpinBox, QComboBox, QLineEdit, QPlainTextEdit, QTextEdit, QWidget

from app.actions import ACTIONS, Needs
from app.recording_entry import RecordingEntry
from app.survey_session import SurveySession


def show_enabled(
    actions_by_id: Mapping[str, QAction], session: SurveySession, recording: RecordingEntry, *, reviewing: bool
) -> None:
    """Enable what can be done; ``reviewing`` tells whether a review page with results is in front."""
    met = {
        Needs.NOTHING: True,
        Needs.SURVEY: session.folder is not None,
        Needs.RESULTS: reviewing,
        Needs.CANDIDATE: reviewing and session.selected is not None,
        Needs.WRITABLE: session.writable,
        Needs.RECORDING: recording.in_front,
    }
    for row in ACTIONS:
        actions_by_id[row.id].setEnabled(met[row.needs])
    actions_by_id["mark"].setEnabled((reviewing and session.writable) or recording.can_mark)
    actions_by_id["tie"].setEnabled(reviewing and session.writable)
    for name in ("export", "preview_report"):
        actions_by_id[name].setEnabled(session.results is not None)
    stack = session.undo_stack
    for name, able, text in (
        ("undo", stack.canUndo(), stack.undoText()),
        ("redo", stack.canRedo(), stack.redoText()),
    ):
        action = actions_by_id[name]
        action.setEnabled(able and session.folder is not None)
        action.setStatusTip(text)
        action.setToolTip(f"{action.text()}: {text}" if text else action.text())
    if recording.in_front:
        actions_by_id["undo"].setEnabled(recording.can_undo)
        actions_by_id["redo"].setEnabled(False)


def is_typing(widget: QWidget | None) -> bool:
    """Tell whether a widget takes letters, so that keys without Ctrl are its own."""
    fields = QLineEdit | QTextEdit | QPlainTextEdit | QAbstractSpinBox
    return isinstance(widget, fields) or (isinstance(widget, QComboBox) and widget.isEditable())
