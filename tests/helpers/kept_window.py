"""One window for all tests of a module, with a fresh copy of the same small survey for each: building it anew costs a
second a test.

A module makes ``kept = kept_fixture(...)`` and ``window = window_fixture()``; what a test opens or leaves running is
put back after it.
"""

import shutil
from dataclasses import dataclass

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, QTimer
from PySide6.QtWidgets import QApplication
from small_survey import make_folder, make_results

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import Preferences, PreferencesStore
from app.survey_session import SurveySession
from processing.storage.folder import SurveyFolder
from widgets.candidate_row import CandidateFilter


@dataclass
class KeptWindow:
    """The window with its services, and the survey that each test gets a copy of."""

    window: MainWindow
    services: Services
    pristine: object  # its folder's path
    results: object

    def begin(self, place):
        """Open a copy of the survey under ``place`` on the leaks page, with the usual preferences."""
        window, services = self.window, self.services
        copy = place / self.pristine.name
        shutil.copytree(self.pristine, copy, ignore=shutil.ignore_patterns("cache", "survey.lock"))
        services.preferences.file = place / "preferences.json"
        services.preferences.values = Preferences(tour_seen=True)
        window.boxes = AnsweringBoxes()
        services.session.set_filter(CandidateFilter())
        services.session.set_order("score")
        services.session.open(SurveyFolder.open(copy))
        services.session.set_results(self.results)
        window.show_page("leaks")
        window.review_page.tools.leave("why")
        window.show()
        window.review_page.focus_views()

    def end(self):
        """Close the survey, and leave nothing running."""
        self.window.player.stop()
        self.services.jobs.stop_all()
        self.services.session.close()
        self.window.close()  # after a mere hiding it would not become the active window again
        QApplication.sendPostedEvents()
        for timer in self.window.findChildren(QTimer):
            timer.stop()


def kept_fixture(chainages_m=(20.0, 40.0, 60.0, 80.0), size=(1100, 700)):
    """Return a fixture of a module's window."""

    @pytest.fixture(scope="module")
    def kept(qapp, tmp_path_factory):
        place = tmp_path_factory.mktemp("kept")
        preferences = PreferencesStore(place / "preferences.json")
        services = Services(SurveySession(), Jobs(), preferences, None, lambda _rate: CountingSink(), lambda: None)
        with make_folder(place) as folder:
            pristine, results = folder.path, make_results(folder, chainages_m)
        window = MainWindow(services, "en")
        window.resize(*size)
        services.jobs.stop_all()
        yield KeptWindow(window, services, pristine, results)
        services.jobs.stop_all()
        window.close()
        window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)

    return kept


def window_fixture():
    """Return a fixture of the window with a survey of the test's own."""

    @pytest.fixture
    def window(qtbot, kept, tmp_path):
        kept.begin(tmp_path)
        kept.window.activateWindow()
        qtbot.waitUntil(lambda: not kept.services.jobs.running and kept.window.isActiveWindow())
        kept.window.review_page.focus_views()
        yield kept.window
        kept.end()

    return window
