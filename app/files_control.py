"""Opening, previewing, processing and closing surveys: every road ends in a page or in a message with a way on."""

import logging
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app import opening
from app.data_page import DataPage
from app.jobs import Job, Jobs
from app.presets import settings_in_force
from app.preview_content import errors_of, imported_files, previewed_files
from app.review_commands import EditSettings, EditSurvey
from app.settings import PreferencesStore, mappings_file, surveys_folder
from app.survey_session import SurveySession
from processing import messages
from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.column_mapping import ColumnMapping
from processing.progress import Progress
from processing.storage.folder import SurveyFolder, is_survey_folder
from processing.survey import Survey
from widgets.message_boxes import Choice, MessageBoxes
from widgets.raw_form import RawAnswer
from widgets.units import quantities
from widgets.vocabulary import frequency_text, place_text, verdict_text

if TYPE_CHECKING:
    from processing.importing.folder import ImportOptions
    from processing.importing.preview import FolderPreview
    from processing.results import Results

log = logging.getLogger(__name__)


class FilesControl(QObject):
    """Owns the preview of a device's folder; everything open is the session's."""

    page_asked = Signal(str)
    told = Signal(str)
    band_settled = Signal(float, float)  # Hz: what is looked for now
    sound_met = Signal(object)  # opening.FirstLook: it can be looked at before it is processed

    def __init__(
        self,
        session: SurveySession,
        jobs: Jobs,
        preferences: PreferencesStore,
        page: DataPage,
        boxes: Callable[[], MessageBoxes],
        parent: QWidget,
    ) -> None:
        super().__init__(parent)
        self._session, self._jobs, self._preferences, self._page = session, jobs, preferences, page
        self._boxes, self._window = boxes, parent
        self._preview: FolderPreview | None = None
        self._options: ImportOptions | None = None  # what the operator said of the previewed folder
        self._job: Job | None = None
        page.process_asked.connect(self.process)
        page.survey_edited.connect(self._edit_survey)
        page.preview.mapping_chosen.connect(self._choose_mapping)
        page.preview.raw_form_answered.connect(self._answer_raw_form)
        session.survey_changed.connect(self._show_survey)
        session.results_changed.connect(self._show_survey)
        session.cursor.moved.connect(self._show_moments)
        if session.folder is not None:
            self._show_survey()

    @property
    def previewing(self) -> bool:
        """Whether a device's folder is being looked at that has not been processed."""
        return self._preview is not None

    @property
    def ready(self) -> bool:
        """Whether all that was found in the device's folder can be read."""
        return self._preview is not None and opening.is_ready(self._preview)

    # --- opening ---

    def ask_open(self) -> None:
        """Ask for a folder and open it."""
        recent = self._preferences.values.recent
        start = str(Path(recent[0]).parent) if recent else str(Path.home())
        chosen = QFileDialog.getExistingDirectory(self._window, self.tr("Open the device's folder or a survey"), start)
        if chosen:
            self.open_path(Path(chosen))

    def open_demo(self) -> None:
        """Open the demonstration survey, made at its first use."""
        from app.demonstration import demonstration_folder

        self._start(demonstration_folder, self.tr("Demonstration"), self.open_path)

    def open_path(self, path: Path, *, read_only: bool = False) -> None:
        """Open a survey folder at once, or look at a device's folder or file."""
        path = path.absolute()
        if path.name == "survey.db" and is_survey_folder(path.parent):
            path = path.parent
        if not path.exists():
            self._preferences.forget_recent(path)
            self._boxes().error(LeaklineError(ErrorCode.FILE_MISSING, Place(path)))
        elif is_survey_folder(path):
            self.open_project(path, read_only=read_only)
        else:
            self._look_at(path)

    def open_project(self, path: Path, *, read_only: bool = False, take_over: bool = False) -> bool:
        """Open a survey folder and show its results, from the cache where it holds them."""
        self._cancel_job()
        session = self._session
        if session.folder is not None and session.folder.path == path:
            session.close()
        try:
            folder = SurveyFolder.open(path, read_only=read_only, take_over=take_over)
        except LeaklineError as error:
            return self._offer_way_out(path, error, tried_take_over=take_over)
        self._take(folder)
        return True

    def _take(self, folder: SurveyFolder) -> None:
        self._preview = None
        try:
            self._session.open(folder)
        except LeaklineError as error:
            folder.close()
            self._boxes().error(error)
            return
        self._preferences.remember_recent(folder.path)
        self._show_survey()
        self.page_asked.emit("data")
        self._load(show="leaks")

    def _offer_way_out(self, path: Path, error: LeaklineError, *, tried_take_over: bool) -> bool:
        sentence = messages.error_sentence(error, self._boxes().language, quantities().units)
        cancel = Choice("cancel", self.tr("Cancel"))
        if error.code is ErrorCode.SURVEY_LOCKED:
            choices = [Choice("read_only", self.tr("Open read-only"))]
            if not tried_take_over:
                choices.append(Choice("take_over", self.tr("Nobody uses it: open anyway")))
            answer = self._boxes().ask(sentence, (*choices, cancel))
            if answer == "read_only":
                return self.open_project(path, read_only=True)
            return answer == "take_over" and self.open_project(path, take_over=True)
        if error.code is ErrorCode.SURVEY_DAMAGED:
            answer = self._boxes().ask(sentence, (Choice("restore", self.tr("Restore the newest backup")), cancel))
            return answer == "restore" and self._restore(path)
        self._boxes().error(error)
        return False

    def _restore(self, path: Path) -> bool:
        try:
            self._take(SurveyFolder.restore(path))
        except LeaklineError as error:
            self._boxes().error(error)
            return False
        return True

    def close_survey(self) -> None:
        """Close what is open, and go back to the start."""
        self._cancel_job()
        self._preview = None
        self._session.close()
        self.page_asked.emit("start")

    # --- a device's folder ---

    def _look_at(self, path: Path, options: "ImportOptions | None" = None) -> None:
        from processing.importing.folder import ImportOptions

        wanted = ImportOptions(mapping_store=mappings_file()) if options is None else options

        def show(preview: "FolderPreview") -> None:
            self._options = wanted
            if options is None:
                self._show_preview(preview)
            else:
                self._show_files(preview)

        title = self.tr("Looking at {name}").format(name=path.name)
        self._start(lambda progress: opening.preview_of(path, wanted, progress), title, show)

    def _choose_mapping(self, name: str, mapping: ColumnMapping) -> None:
        preview, options = self._preview, self._options
        if preview is not None and options is not None:
            log_file = next(file.path for file in preview.files if file.path.name == name)
            self._look_at(preview.path, replace(options, imu_file=log_file, mapping=mapping))

    def _answer_raw_form(self, answer: RawAnswer) -> None:
        if self._preview is not None and self._options is not None:
            self._look_at(self._preview.path, opening.with_raw_form(self._options, answer))

    def _show_preview(self, preview: "FolderPreview") -> None:
        if self._session.folder is not None:
            self._session.close()
        self._page.set_survey(opening.with_operator(preview.survey, self._preferences.values.operator), writable=True)
        self._show_files(preview)
        self.page_asked.emit("data")
        if opening.told_everything(preview):
            self.process()  # it told everything itself: nothing to ask

    def _show_files(self, preview: "FolderPreview") -> None:
        self._preview = preview
        self._page.set_path(str(preview.path))
        self._page.set_files(previewed_files(preview))
        findings = [*preview.findings, *(finding for file in preview.files for finding in file.findings)]
        language = self._boxes().language
        notes = [messages.error_sentence(error, language, quantities().units) for error in errors_of(preview)]
        self._page.set_findings(findings, (), notes)
        self._page.tie_points.set_moments(0.0, opening.end_of(preview))
        self._show_process()
        if self._options is not None and opening.is_ready(preview):
            self.sound_met.emit(opening.first_look(preview.path, self._options, self._page.survey))

    def process(self) -> None:
        """Process the previewed folder, or the open survey again."""
        if self._preview is None or self._options is None:
            self.reprocess()
            return
        preview, survey = self._preview, self._page.survey
        files, options = opening.used_files(preview), opening.settled(preview, self._options)
        place = opening.target_folder(preview.path, surveys_folder())
        earlier = opening.earlier_project(preview.path, files, survey, (place,))
        if earlier is not None:
            self.told.emit(self.tr("This folder was processed before: its survey is opened."))
            self.open_project(earlier)
            return
        operator = survey.info.operator

        def made(path: Path) -> None:
            if self._open_made(path, options):
                self.told.emit(self.tr("Survey made: {path}").format(path=path))

        opening.remember(preview, options)
        self._start(
            lambda progress: opening.make_project(place, survey, files, operator, progress),
            self.tr("Copying the recording"),
            made,
        )

    def _open_made(self, path: Path, options: "ImportOptions") -> bool:
        """Open a survey folder that was just made, remembering in it how its files are to be read."""
        try:
            folder = SurveyFolder.open(path)
            folder.write_import_options(options.to_json())
        except LeaklineError as error:
            self._boxes().error(error)
            return False
        self._take(folder)
        return True

    # --- processing ---

    def reprocess(self, show: str = "leaks") -> None:
        """Compute everything anew that form, tie points, route or settings have changed; then show a page."""
        if self._session.folder is not None:
            self._load(show)

    def _load(self, show: str) -> None:
        folder = self._session.folder
        assert folder is not None
        try:
            source = opening.source_of(folder)
        except (LeaklineError, ValueError) as error:
            self._boxes().tell(str(error))
            return

        def take(results: "Results") -> None:
            if self._session.folder is folder:
                self._take_results(results, show)

        self._page.set_process(self.tr("Processing …"), enabled=False)
        look = opening.first_look(source.original_dir, source.options, source.survey)
        self._start(lambda progress: opening.results_of(source, progress, look.growing), self.tr("Processing"), take)
        self.sound_met.emit(look)

    def _take_results(self, results: "Results", show: str) -> None:
        from app.marking import candidate_at

        opening.complete(self._session.folder, results)
        try:
            self._session.set_results(
                results, relocate=lambda mark: replace(candidate_at(results, mark.time_s), leak_class=mark.leak_class)
            )
        except LeaklineError as error:
            self._boxes().error(error)
            return
        self.page_asked.emit(show)
        self._offer_orphans()

    def _offer_orphans(self) -> None:
        session = self._session
        if not session.orphans or not session.writable:
            return
        listed = "\n".join(
            f"• {place_text(orphan.candidate)}: {verdict_text(orphan.decision.verdict)} {orphan.decision.note}"
            for orphan in session.orphans
        )
        text = self.tr("These earlier verdicts found no candidate any more. Nothing is lost; keep them as marks?")
        keep = Choice("keep", self.tr("Keep as marks"))
        if self._boxes().ask(f"{text}\n\n{listed}", (keep, Choice("later", self.tr("Leave them listed")))) == "keep":
            session.keep_orphans()

    # --- edits ---

    def change_band(self, low_hz: float, high_hz: float) -> None:
        """Look for leaks in another band, if the operator means it: that takes a whole pass over the sound."""
        session = self._session
        text = self.tr("Look for leaks from {low} to {high}? The sound is gone through again.")
        yes = Choice("process", self.tr("Process again"))
        question = text.format(low=frequency_text(low_hz), high=frequency_text(high_hz))
        if self._boxes().ask(question, (yes, Choice("keep", self.tr("Keep the band")))) == "process":
            sound = replace(session.settings.sound, band_low_hz=low_hz, band_high_hz=high_hz)
            settings = replace(session.settings, sound=sound)
            session.push(EditSettings(session, self.tr("leak band"), settings))
            if session.settings == settings:
                self.reprocess()
        self.band_settled.emit(session.settings.sound.band_low_hz, session.settings.sound.band_high_hz)

    def _edit_survey(self, survey: Survey, what: str) -> None:
        if self._preview is not None:
            self._page.set_survey(survey, writable=True)
            self._show_process()
            return
        text = {"tie_points": self.tr("tie points"), "route": self.tr("route")}.get(what, self.tr("form"))
        self._session.push(EditSurvey(self._session, text, survey))
        self._show_survey()

    def _show_survey(self) -> None:
        session = self._session
        folder = session.folder
        if folder is None or self._preview is not None:
            return
        results = session.results
        self._page.set_path(str(folder.path))
        self._page.set_survey(session.survey, writable=session.writable)
        self._page.set_files(imported_files(folder.files()))
        told = self.tr("Verdict without a candidate at {place}: {verdict} {note}")
        notes = [
            told.format(place=place_text(o.candidate), verdict=verdict_text(o.decision.verdict), note=o.decision.note)
            for o in session.orphans
        ]
        self._page.set_findings(session.findings, results.not_assessed if results is not None else (), notes)
        self._show_moments()
        self._show_process()

    def _show_moments(self) -> None:
        results = self._session.results
        if results is not None and self._preview is None:
            imu = results.recording.imu
            end_s = float(imu.time_s[-1]) if imu is not None else None
            self._page.tie_points.set_moments(self._session.cursor.time_s, end_s)

    def _show_process(self) -> None:
        if self._job is not None:
            return
        preview, session = self._preview, self._session
        if preview is not None:
            ready = opening.is_ready(preview)
            state = "" if ready else self.tr("Something is missing: see the findings and the list of files.")
            self._page.set_process(self.tr("Process"), enabled=ready, state=state)
            return
        results = session.results
        present = (session.survey, settings_in_force(session))
        fresh = results is not None and (results.survey, results.settings) == present
        state = self.tr("The results are up to date.") if fresh else self.tr("Form or tie points have changed.")
        if results is None:
            state = self.tr("Not processed yet: press Process.")
        self._page.set_process(
            self.tr("Process again") if results is not None else self.tr("Process"),
            enabled=session.folder is not None,
            state=state,
        )

    # --- jobs ---

    def _start(self, step: Callable[[Progress], object], title: str, on_success: Callable[..., None]) -> None:
        self._cancel_job()

        def ended() -> None:
            if self._job is job:
                self._job = None
                self._show_process()

        def failed(error: Exception) -> None:
            if not job.cancelled:
                self._jobs.failed.emit(error)

        job = self._jobs.start(step, title=title, on_success=on_success, on_failure=failed)
        self._job = job
        job.finished.connect(ended)

    def _cancel_job(self) -> None:
        if self._job is not None:
            self._job.cancel()
            self._job.forget_callbacks()
            self._job = None
