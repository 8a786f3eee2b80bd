"""The mapped route of a survey: imported from a file by a dialog or taken away, undoably; the path is computed anew."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app import appearance
from app.data_page import DataPage
from app.files_control import FilesControl
from app.jobs import Job, Jobs
from app.review_commands import EditSurvey
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.errors import LeaklineError
from processing.progress import Progress
from processing.survey import Route, Survey
from widgets.message_boxes import MessageBoxes
from widgets.route_dialog import RouteDialog

if TYPE_CHECKING:
    from processing.importing.route_files.building import BuiltRoute
    from processing.importing.route_files.crs import CrsEntry
    from processing.importing.route_files.lines import RouteFile
    from processing.importing.route_files.proposal import RouteAnswer, RouteProposal

MAX_RECENT_CRS = 6


class RouteControl(QObject):
    """Works on the open survey, or on the device's folder that is being looked at."""

    told = Signal(str)

    def __init__(
        self,
        session: SurveySession,
        jobs: Jobs,
        preferences: PreferencesStore,
        page: DataPage,
        files: FilesControl,
        boxes: Callable[[], MessageBoxes],
        parent: QWidget,
    ) -> None:
        super().__init__(parent)
        self._session, self._jobs, self._preferences = session, jobs, preferences
        self._page, self._files, self._boxes, self._window = page, files, boxes, parent
        self.dialog: RouteDialog | None = None
        self._job: Job | None = None
        self._fitted: tuple[Survey, Survey] | None = None  # before and after the change that is being computed
        page.form.route_import_asked.connect(self.ask_import)
        page.form.route_removed.connect(self.remove)
        session.results_changed.connect(self._keep_undo)

    @property
    def ready(self) -> bool:
        """Whether there is a survey that may be given a route."""
        return self._session.writable or self._files.previewing

    def ask_import(self) -> None:
        """Ask for a map file and import it."""
        from processing.importing.route_files.registry import ROUTE_FORMATS

        known = " ".join(f"*{suffix}" for entry in ROUTE_FORMATS for suffix in entry.suffixes)
        filters = f"{self.tr('Map files')} ({known});;{self.tr('All files')} (*)"
        folder = self._session.folder
        start = str(folder.path.parent) if folder is not None else str(Path.home())
        chosen, _ = QFileDialog.getOpenFileName(self._window, self.tr("Import route"), start, filters)
        if chosen:
            self.import_file(Path(chosen))

    def import_file(self, path: Path) -> None:
        """Read a map file, and show what it gives."""
        if not self.ready:
            self._boxes().tell(self.tr("Open a recording first; its route can then be imported."))
            return
        title = self.tr("Reading {name}").format(name=path.name)
        self._start(partial(_read, path, self._page.survey), title, self._open_dialog)

    def take_dropped(self, path: Path) -> None:
        """Import the route of a map file; anything else is a recording, which is opened."""
        from processing.importing.route_files.registry import looks_like_route

        if path.is_file() and looks_like_route(path):
            self.import_file(path)
        else:
            self._files.open_path(path)

    def remove(self) -> None:
        """Take the route away."""
        if self.ready and self._page.survey.route is not None:
            self._change(None)

    # --- the dialog ---

    def _open_dialog(self, read: "_Read") -> None:
        theme = appearance.theme_named(self._preferences.values.theme)
        dialog = RouteDialog(self._boxes().language, theme, self._window)
        self.dialog = dialog
        recent = self._preferences.values.recent_crs
        dialog.set_file(
            read.file, read.proposal.answer, self._page.survey, read.systems, recent, read.near, read.fitting
        )
        dialog.show_proposal(read.proposal)
        dialog.asked.connect(lambda answer: self._propose(read.file, answer))
        dialog.taken.connect(lambda built: self._take(read.file, built))
        dialog.finished.connect(self._on_closed)
        dialog.resize(self._window.size().boundedTo(dialog.maximumSize()) * 0.96)
        dialog.open()

    def _propose(self, file: "RouteFile", answer: "RouteAnswer") -> None:
        def show(proposal: "RouteProposal") -> None:
            if self.dialog is not None:
                self.dialog.show_proposal(proposal)

        self._start(partial(_propose, file, answer, self._page.survey), self.tr("Joining the lines"), show)

    def _on_closed(self) -> None:
        self._cancel()
        if self.dialog is not None:
            self.dialog.deleteLater()
        self.dialog = None

    def _take(self, file: "RouteFile", built: "BuiltRoute") -> None:
        code = built.route.crs
        if file.crs is None and code.startswith("EPSG:"):
            recent = [code, *(c for c in self._preferences.values.recent_crs if c != code)]
            self._preferences.change(recent_crs=recent[:MAX_RECENT_CRS])
        self._change(built.route)

    # --- the change ---

    def _change(self, route: Route | None) -> None:
        session = self._session
        before = session.survey
        self._page.edit_route(route)
        if self._files.previewing:
            return
        done = session.folder is not None and session.survey.route == route and session.survey != before
        if done and session.results is not None:
            self._fitted = (before, session.survey)
            self._files.reprocess("path")

    def _keep_undo(self) -> None:
        """New results clear the undo stack, whose verdicts speak of old candidates; the route stays undoable."""
        fitted, self._fitted = self._fitted, None
        session = self._session
        if fitted is not None and session.survey == fitted[1] and session.writable:
            session.push(EditSurvey(session, self.tr("route"), fitted[1], before=fitted[0]))

    # --- jobs ---

    def _start(self, step: Callable[[Progress], object], title: str, on_success: Callable[..., None]) -> None:
        self._cancel()

        def ended() -> None:
            if self._job is job:
                self._job = None

        job = self._jobs.start(step, title=title, on_success=on_success)
        self._job = job
        job.finished.connect(ended)

    def _cancel(self) -> None:
        if self._job is not None:
            self._job.cancel()
            self._job.forget_callbacks()
            self._job = None


class _Read:
    """What the first look at a file gives."""

    def __init__(
        self,
        file: "RouteFile",
        proposal: "RouteProposal",
        systems: "tuple[CrsEntry, ...]",
        near: tuple[float, float] | None,
        fitting: tuple[tuple[str, float], ...],
    ) -> None:
        self.file, self.proposal, self.systems, self.near, self.fitting = file, proposal, systems, near, fitting


def _read(path: Path, survey: Survey, progress: Progress) -> _Read:
    from processing.importing.route_files.crs import all_systems
    from processing.importing.route_files.proposal import first_answer, fitting_systems, propose
    from processing.importing.route_files.registry import read_route_file

    file = read_route_file(path, progress.part(0.0, 0.7))
    proposal = propose(file, first_answer(file, survey), survey, progress.part(0.7, 0.95))
    systems, near = all_systems(), _launch_place(survey)
    return _Read(file, proposal, systems, near, fitting_systems(file, systems, near))


def _propose(file: "RouteFile", answer: "RouteAnswer", survey: Survey, progress: Progress) -> "RouteProposal":
    from processing.importing.route_files.proposal import propose

    return propose(file, answer, survey, progress)


def _launch_place(survey: Survey) -> tuple[float, float] | None:
    """Longitude and latitude of the launch, None where they are not known."""
    from processing.coordinates import local_frame

    try:
        frame = local_frame(survey.launch)
    except LeaklineError:
        return None  # told when the route is built
    if frame.latitude is None or frame.longitude is None:
        return None
    return frame.longitude, frame.latitude
