"""The real window on a tiny survey with as many candidates as wanted, and keys pressed in it."""

from contextlib import contextmanager

import numpy as np
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from small_survey import make_folder, make_results

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.storage.folder import SurveyFolder


def spread(count):
    """Return chainages of so many candidates along the pipe of 100 m, all within what was assessed."""
    return tuple(float(x) for x in np.linspace(8.0, 88.0, count))


@contextmanager
def review_window(place, count, *, preferences=None):
    """Open the leaks page with ``count`` candidates, the best score first; yields window and session."""
    preferences = preferences or PreferencesStore(place / "preferences.json")
    services = Services(SurveySession(), Jobs(), preferences, None, lambda _rate: CountingSink(), lambda: None)
    services.session.open(make_folder(place))
    services.session.set_results(make_results(services.session.folder, spread(count)))
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    window.show_page("leaks")
    window.resize(1366, 736)  # of 768 less the title of the window
    window.show()
    window.review_page.focus_views()
    try:
        yield window, services.session
    finally:
        services.jobs.stop_all()  # nothing comes to a window that is gone
        window.close()
        window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        services.session.close()


def press(window, key, modifier=Qt.KeyboardModifier.NoModifier):
    """Press a key where the keyboard is."""
    QTest.keyClick(QApplication.focusWidget() or window, key, modifier)


def on_disk(session):
    """Return candidate id → decision as another program would read it from the database now."""
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        return other.review.decisions(other.review.latest_run())
