"""Starts the window: looks, language, log, crash guard; and makes the window again when the language changes."""

import logging
import sys
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QApplication

from app import appearance, diagnostics, text_scale
from app.devices.audio_output import Sink, open_sink, why_silent
from app.jobs import Jobs
from app.main_window import MainWindow
from app.recording_parts import RecordingKit
from app.report_choices import window_quantities
from app.services import Services
from app.settings import PreferencesStore, log_folder
from app.survey_session import SurveySession
from widgets import units
from widgets.message_boxes import Choice

log = logging.getLogger(__name__)


class Application(QObject):
    """Holds what outlives a window, and the window."""

    def __init__(
        self,
        qt: QApplication,
        preferences: PreferencesStore,
        log_file: Path | None,
        make_sink: Callable[[float], Sink] = open_sink,
        why_silent: Callable[[], str | None] = why_silent,
        recording: RecordingKit | None = None,
    ) -> None:
        super().__init__()
        self._qt = qt
        self._translation = appearance.Translation(qt)
        session, jobs = SurveySession(self), Jobs(self)
        self.services = Services(session, jobs, preferences, log_file, make_sink, why_silent, recording)
        self.guard = diagnostics.CrashGuard(self)
        self.guard.crashed.connect(self._tell_crash)
        self._telling = False
        self._anew: tuple[Path | None] | None = None  # the survey to open when starting again
        appearance.apply_theme(qt, appearance.theme_named(preferences.values.theme))
        self.guard.install()
        self.window = self._make_window(preferences.values.language or appearance.system_language())

    def _make_window(self, language: str) -> MainWindow:
        self._translation.use(language)
        units.use(window_quantities(self.services.preferences.values, language))
        window = MainWindow(self.services, language)
        window.language_asked.connect(self._change_language)
        window.restart_asked.connect(self._restart)
        return window

    def _change_language(self, language: str) -> None:
        self.services.preferences.change(language=language)
        old = self.window
        page = old.page
        old.close()
        self.window = self._make_window(language)
        self.window.show()
        built_when_asked = {"correlator": self.window.correlator.show, "recording": self.window.recording.show}
        if page in built_when_asked:
            built_when_asked[page]()
        elif not self.window.work.open_page(page) and page != "start":
            self.window.show_page(page)
        self.window.work.settings.came_from = old.work.settings.came_from
        old.deleteLater()

    def _restart(self) -> None:
        """End, and start again with what only a start can change; the survey is opened again."""
        folder = self.services.session.folder
        self._anew = (folder.path if folder is not None else None,)
        self.window.close()

    @property
    def wants_restart(self) -> bool:
        """Whether the program is to be started again when it has ended."""
        return self._anew is not None

    def start_again(self) -> None:
        """Start the program again; only after :meth:`shut_down`."""
        if self._anew is not None:
            text_scale.start_anew(self._anew[0])

    def _tell_crash(self, what: str) -> None:
        if self._telling:  # one message is enough, however often a timer stumbles
            return
        self._telling = True
        text = self.tr("Leakline has stumbled over a fault of its own. Every verdict and note is on disk. ({what})")
        answer = self.window.boxes.ask(
            text.format(what=what),
            (Choice("save", self.tr("Save diagnostics…")), Choice("go_on", self.tr("Go on"))),
        )
        if answer == "save":
            self.window.save_diagnostics()
        self._telling = False

    def warm_up(self) -> None:
        """Load what opening a survey needs, while the operator is still looking for it."""
        self.services.jobs.start(lambda _progress: _load_science(), title=self.tr("Loading"), quiet=True)

    def shut_down(self) -> None:
        """Stop all work and close the survey."""
        self.services.jobs.stop_all()
        self.services.session.close()
        self.guard.remove()


def _load_science() -> None:
    import processing.importing.folder
    import processing.pipeline
    import processing.sound.coarse  # noqa: F401


def run_window(path: Path | None, read_only: bool = False) -> int:
    """Show the window, open ``path`` in it if there is one, and return the exit status when it is closed."""
    QApplication.setApplicationName("Leakline")
    QApplication.setDesktopFileName("leakline")
    preferences = PreferencesStore()
    text_scale.prepare(preferences.values.text_scale)
    qt = QApplication.instance() or QApplication(sys.argv[:1])
    assert isinstance(qt, QApplication)
    application = Application(qt, preferences, diagnostics.start_log(log_folder()))
    application.window.show()
    application.warm_up()
    if path is None:
        application.window.work.tour.offer()
    else:
        QTimer.singleShot(0, application, lambda: application.window.files.open_path(path, read_only=read_only))
    status = qt.exec()
    application.shut_down()
    if application.wants_restart:
        application.start_again()
    return int(status)
