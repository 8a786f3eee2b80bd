"""The main window: a step bar of pages (data, path, sound, leaks, report), menus from the action table, job strip."""

import time
from pathlib import Path

from PySide6.QtCore import QTimer, Signal
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QHBoxLayout, QMainWindow, QVBoxLayout, QWidget

from app import actions, appearance, enabling, window_links
from app.actions import ACTIONS, PAGE_TITLES, Page
from app.band_control import BandControl
from app.channel_control import ChannelControl
from app.cleaning_control import CleaningControl
from app.clock_control import ClockControl
from app.correlator_entry import CorrelatorEntry
from app.data_page import DataPage
from app.evidence_control import EvidenceControl
from app.files_control import FilesControl
from app.first_sound import FirstSound
from app.help_control import HelpControl
from app.jobs import Job
from app.methods import methods
from app.notices import Notices
from app.page_host import PageHost
from app.path_controls import PathControls
from app.player import Player
from app.preset_control import PresetControl
from app.recording_entry import RecordingEntry
from app.report_control import ReportControl
from app.review_control import ReviewControl
from app.review_page import ReviewPage
from app.route_control import RouteControl
from app.services import Services
from app.shared_keys import SharedKeys
from app.spectrogram_control import SpectrogramControl
from app.spectrum_control import SpectrumControl
from app.window_memory import WindowMemory
from app.workplace import Workplace
from processing.errors import LeaklineError
from widgets.job_strip import JobStrip
from widgets.message_boxes import MessageBoxes
from widgets.page_stack import PageStack
from widgets.report_panel import ReportPanel
from widgets.start_page import StartPage
from widgets.step_bar import StepBar

REVIEW_PAGES = ("path", "sound", "leaks")
STEP_PAGES = ("data", *REVIEW_PAGES, "report")  # they have a button in the step bar
TOOLS = ("record", "open", "undo", "redo", "mark", "gallery", "export", "correlator")


class MainWindow(QMainWindow):
    """Composes; its methods without arguments are the handlers of the window's actions."""

    language_asked = Signal(str)
    restart_asked = Signal()

    def __init__(self, services: Services, language: str) -> None:
        super().__init__()
        self._services, self._language = services, language
        self._session, self._preferences = services.session, services.preferences
        self._theme = appearance.theme_named(services.preferences.values.theme)
        self._typing = False
        self.setAcceptDrops(True)
        self.boxes = MessageBoxes(self, language)
        self.notices = Notices(language, self)
        self._build_pages()
        self.player = Player(self._session, self.review_page.playback, self._preferences, services.make_sink, self)
        self.review = ReviewControl(self._session, self.review_page, self.player, language, self)
        self.files = FilesControl(
            self._session, services.jobs, self._preferences, self.data_page, lambda: self.boxes, self
        )
        self.presets = PresetControl(self._session, self.data_page, lambda: self.boxes, language, self)
        self.first_sound = FirstSound(self._session, services.jobs, self.review_page, self)
        self.path = PathControls(self._session, services.jobs, self.review_page, language, self)
        self.cleaning = CleaningControl(self._session, services.jobs, self.review_page, self.player, language, self)
        self.clock = ClockControl(self._session, self.review_page.tools, self.review_page.clock, language, self)
        self.evidence = EvidenceControl(self._session, self.review_page.tools, self.review_page.why, language, self)
        page = self.review_page
        self.channels = ChannelControl(self._session, page.tools, page.channels, language, self)
        self.bands = BandControl(self._session, page.spectrogram, page.bands, language, self)
        self.route = RouteControl(
            self._session, services.jobs, self._preferences, self.data_page, self.files, lambda: self.boxes, self
        )
        self.sound_view = SpectrogramControl(self._session, self.review_page, self._preferences, self)
        self.spectrum = SpectrumControl(
            self._session, self.review_page.spectrogram, self.review_page.spectrum, language, self
        )
        self.report = ReportControl(self, services, language)
        self.correlator = CorrelatorEntry(
            services.jobs, self._preferences, language, self._plain_pages, self._stack, self, lambda: self.page
        )
        self.recording = RecordingEntry(
            self._preferences, language, self._plain_pages, self._stack, self, services.recording, time.monotonic
        )
        self.shared = SharedKeys(self.recording, self.review)
        self.help = HelpControl(
            self, services.log_file, self._preferences, language, lambda: self.page, self.notices.tell
        )
        host = PageHost(self._plain_pages, self._stack, self.show_page, lambda: self.page)
        self.work = Workplace(self, services, language, host)
        self.actions_by_id = actions.build(self, self)
        self._build_menus()
        self._lay_out()
        self._connect()
        window_links.connect(self)
        self._memory = WindowMemory(self, self.review_page, self._preferences)
        self._memory.restore()
        actions.arm_keys(self.actions_by_id, typing=False)
        self._on_opened()

    # --- building ---

    def _build_pages(self) -> None:
        self.start_page = StartPage()
        self.data_page = DataPage(self._language, methods(self._language))
        self.review_page = ReviewPage(self._session.cursor, self._theme)
        self.report_panel = ReportPanel(self._language)
        self._plain_pages: dict[str, QWidget] = {
            "start": self.start_page, "data": self.data_page, "report": self.report_panel
        }  # fmt: skip
        self.step_bar = StepBar(
            (
                ("data", self.tr("Data")),
                ("path", self.tr("Path")),
                ("sound", self.tr("Sound")),
                ("leaks", self.tr("Leaks")),
                ("report", self.tr("Report")),
            )
        )
        self._stack = PageStack()
        for page in (*self._plain_pages.values(), self.review_page):
            self._stack.addWidget(page)
        self.page = "start"

    def _build_menus(self) -> None:
        for page in Page:
            menu = self.menuBar().addMenu(actions.translated(PAGE_TITLES[page]))
            menu.setToolTipsVisible(True)
            menu.addActions([self.actions_by_id[row.id] for row in ACTIONS if row.page is page])

    def _lay_out(self) -> None:
        self.step_bar.add_tools([self.actions_by_id[name] for name in TOOLS])
        self.step_bar.page_chosen.connect(self.show_page)
        self._strip = JobStrip(self._language)
        right = QVBoxLayout()
        right.setSpacing(0)
        right.addWidget(self.notices.banner)
        right.addWidget(self.recording.strip)
        right.addWidget(self._stack, 1)
        right.addWidget(self.notices.told)
        right.addWidget(self._strip)
        central = QWidget()
        layout = QHBoxLayout(central)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.step_bar)
        layout.addLayout(right, 1)
        self.setCentralWidget(central)

    def _connect(self) -> None:
        session, jobs = self._session, self._services.jobs
        session.opened.connect(self._on_opened)
        session.results_changed.connect(self._on_results)
        session.survey_changed.connect(self._show_title)
        for changed in (session.survey_changed, session.selection_changed, session.candidates_changed):
            changed.connect(self._show_enabled)
        session.refused.connect(self._on_failure)
        session.undo_stack.indexChanged.connect(self._show_enabled)
        jobs.started.connect(self._on_job)
        jobs.failed.connect(self._on_failure)
        self.recording.changed.connect(self._show_enabled)
        self.first_sound.told.connect(lambda text: self.notices.show_listening(text, session))
        self.first_sound.changed.connect(self._on_first_sound)
        self.path.reprocess_asked.connect(lambda: self.files.reprocess(show=self.page))
        self.data_page.findings.moment_chosen.connect(self._show_moment)
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._on_focus)
        self._looking = jobs.start(
            lambda _progress: self._services.why_silent() or "",
            title=self.tr("Looking for a sound card"),
            on_success=self.player.set_unavailable,
            quiet=True,
        )

    # --- pages ---

    def show_page(self, page: str) -> None:
        """Show ``start``, ``data``, ``path``, ``sound``, ``leaks``, ``report``, ``correlator`` or ``recording``."""
        if page in REVIEW_PAGES and self._session.results is None:
            page = "sound" if page == "sound" and self.first_sound.is_shown else "data"
        if page == "report" and self.report.told_blind():  # its pages may show what the first reviewer said
            page = "leaks"
        self.page = page
        if page in REVIEW_PAGES:
            self.review_page.arrange(page)
            self._stack.setCurrentWidget(self.review_page)
            self.review_page.focus_views()
        else:
            self.review_page.decision.flush()
            self._stack.setCurrentWidget(self._plain_pages[page])
        if page == "report":
            self.report.refresh()
        if page in (*STEP_PAGES, "start"):
            self.step_bar.set_current(page)
        self._show_enabled()

    def show_data(self) -> None:
        """Show the data page."""
        self.show_page("data")

    def show_path(self) -> None:
        """Show the path page."""
        self.show_page("path")

    def show_sound(self) -> None:
        """Show the sound page."""
        self.show_page("sound")

    def spectrum_of_selection(self) -> None:
        """Measure the selection, and bring its spectrum to the front."""
        if self.page != "sound":
            self.show_page("sound")
        self.review_page.tools.choose("spectrum")
        self.spectrum.use_a()

    def show_leaks(self) -> None:
        """Show the leaks page."""
        self.show_page("leaks")

    def show_report(self) -> None:
        """Show the report page."""
        self.show_page("report")

    def _show_moment(self, time_s: float) -> None:
        if self._session.results is not None:
            self._session.cursor.set_time(time_s)
            self.show_page("sound")

    # --- state ---

    def _on_opened(self) -> None:
        if self._session.folder is None and not self.files.previewing:
            self.show_page("start")
        self._show_title()
        self._show_enabled()

    def _on_first_sound(self) -> None:
        """Show the sound while the survey is processed, but to nobody who fills in a form before that."""
        working = any(not job.quiet for job in self._services.jobs.running)
        if self.first_sound.is_shown and working and self.page == "data":
            self.show_page("sound")
        elif self._session.results is None and not self.first_sound.is_shown and self.page == "sound":
            self.show_page("data")
        else:
            self._show_enabled()

    def _on_results(self) -> None:
        self.report.refresh()
        self._show_title()
        self._show_enabled()

    def _show_title(self) -> None:
        session = self._session
        name = session.survey.info.name or (session.folder.path.stem if session.folder is not None else "")
        self.setWindowTitle(f"{name} – Leakline" if session.folder is not None else "Leakline")
        self.notices.show_state(session)

    def _show_enabled(self) -> None:
        session = self._session
        reviewing = session.results is not None and (self.page in REVIEW_PAGES or self.work.gallery.in_front)
        enabling.show_enabled(self.actions_by_id, session, self.recording, reviewing=reviewing)
        self.actions_by_id["route"].setEnabled(self.route.ready)
        self.actions_by_id["route_remove"].setEnabled(self.route.ready and self.data_page.survey.route is not None)
        for page in (*REVIEW_PAGES, "report"):
            first = page == "sound" and self.first_sound.is_shown
            self.step_bar.set_enabled(page, enabled=session.results is not None or first)
        self.step_bar.set_enabled("data", enabled=session.folder is not None or self.files.previewing)
        self.work.show_enabled(self.actions_by_id)

    def _on_focus(self, _old: QWidget | None, new: QWidget | None) -> None:
        typing = enabling.is_typing(new)
        if typing != self._typing:
            self._typing = typing
            actions.arm_keys(self.actions_by_id, typing=typing)

    # --- jobs, messages, help ---

    def _on_job(self, job: Job) -> None:
        if job.quiet:
            return

        def show() -> None:
            line = self._strip.add_line(job.title)
            job.reported.connect(line.report)
            line.cancel_asked.connect(job.cancel)
            job.finished.connect(lambda: self._strip.remove_line(line))

        job.shown.connect(show)

    def _on_failure(self, error: Exception) -> None:
        if isinstance(error, LeaklineError):
            self.boxes.error(error)
            return
        raise error  # the crash guard logs and tells it

    def save_diagnostics(self) -> None:
        """Write the zip for support."""
        trouble = self.help.save_diagnostics()
        if trouble:
            self.boxes.tell(trouble)

    # --- looks ---

    def next_theme(self) -> None:
        """Sun, light, dark."""
        self.use_theme(appearance.next_theme(self._theme.name))

    def use_theme(self, name: str) -> None:
        """Look like this from now on."""
        self._preferences.change(theme=name)
        self._theme = appearance.theme_named(name)
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        appearance.apply_theme(application, self._theme)
        self.review_page.apply_theme(self._theme)
        self.correlator.apply_theme(self._theme)
        self.recording.apply_theme(self._theme)
        self.work.apply_theme(self._theme)

    @property
    def is_busy(self) -> bool:
        """Whether work is in progress that the window must not be remade under."""
        return bool(self._services.jobs.running) or self.recording.recording

    def toggle_language(self) -> None:
        """Ask for the window again in the other language."""
        if self.is_busy:
            self.boxes.tell(self.tr("Please wait until the work in progress has ended."))
            return
        self.language_asked.emit("tr" if self._language == "en" else "en")

    # --- Qt's events ---

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Qt: a folder may be dropped anywhere."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Qt: open what was dropped, or import its route, once the drag has ended on the other side."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            QTimer.singleShot(0, self, lambda: self.route.take_dropped(paths[0]))

    def closeEvent(self, event: QCloseEvent) -> None:
        """Qt: put what is still being typed on disk; everything else is there already, unless a recording runs."""
        if not self.recording.may_close():
            event.ignore()
            return
        self.recording.stop()
        self.review_page.decision.flush()
        self._looking.forget_callbacks()  # with another language the player goes with this window
        self.player.stop()
        self.spectrum.forget()
        self.evidence.stop()
        self.correlator.stop()
        self.cleaning.stop()
        self.bands.stop()
        self.notices.stop()
        self.work.stop()
        self._memory.save()
        super().closeEvent(event)
