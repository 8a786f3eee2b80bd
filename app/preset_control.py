"""Offers the presets in the form, says which one fits the pipe, and opens the table for changes."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.data_page import DataPage
from app.presets import preset_rows, user_file
from app.survey_session import SurveySession
from processing.errors import LeaklineError
from widgets.message_boxes import MessageBoxes

if TYPE_CHECKING:
    from processing.sound.presets import Preset


class PresetControl(QObject):
    """Connects the form of the data page with the table of presets on disc."""

    def __init__(
        self,
        session: SurveySession,
        page: DataPage,
        boxes: Callable[[], MessageBoxes],
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._page, self._boxes, self._language = session, page, boxes, language
        page.form.presets_asked.connect(self.open)
        session.opened.connect(self._show)
        session.survey_changed.connect(self._show)
        page.form.survey_changed.connect(lambda _survey: self._show())
        self._show()

    def _rows(self) -> "tuple[Preset, ...]":
        """Return the table, the shipped one where the user's cannot be read: processing then says why."""
        from processing.sound.presets import shipped

        try:
            return preset_rows()
        except LeaklineError:
            return shipped()

    def _show(self) -> None:
        from dataclasses import replace

        from processing.sound.presets import AUTO, chosen

        rows, survey = self._rows(), self._page.form.survey()
        fitting = chosen(rows, replace(survey, processing=replace(survey.processing, preset=AUTO)))
        choices = [(row.key, row.title(self._language), ", ".join(row.materials)) for row in rows]
        self._page.form.set_presets(choices, fitting.title(self._language) if fitting is not None else "")

    def open(self) -> None:
        """Open the table; what is saved counts from the next processing on."""
        from processing.sound.presets import chosen, save_user_rows, shipped
        from widgets.preset_dialog import PresetDialog

        try:
            rows = preset_rows()
        except LeaklineError as error:
            self._boxes().error(error)
            return
        try:
            present = chosen(rows, self._session.survey)
        except LeaklineError:  # a survey from elsewhere names a preset that is not in this table
            present = None
        dialog = PresetDialog(rows, shipped(), present.key if present is not None else "", self._language, self._page)
        if dialog.exec() != PresetDialog.DialogCode.Accepted:
            return
        try:
            save_user_rows(user_file(), dialog.rows)
        except LeaklineError as error:
            self._boxes().error(error)
            return
        self._show()
        self._session.survey_changed.emit()
