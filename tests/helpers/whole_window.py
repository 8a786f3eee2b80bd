"""The whole window with a small survey in it, as the user has it: language, theme, units; put away afterwards."""

import contextlib
import time

from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QCoreApplication, QEvent, QLocale
from PySide6.QtWidgets import QApplication, QWidget
from small_survey import make_folder, make_results

from app.application import Application
from app.settings import PreferencesStore

WAIT_S = 15.0
BUILT_WHEN_ASKED = ("settings",)


def settle(done=lambda: True, wait_s=WAIT_S):
    """Let Qt work until ``done``."""
    until = time.monotonic() + wait_s
    while True:
        QCoreApplication.processEvents()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        if done():
            return
        assert time.monotonic() < until, "it takes too long"
        time.sleep(0.002)


@contextlib.contextmanager
def whole_window(qapp, place, survey=True, **wanted):
    """Yield the application with its window shown; ``wanted`` are preferences; ``survey`` opens the small one."""
    before = qapp.styleSheet(), qapp.font(), qapp.palette(), QLocale(), qapp.property("leakline_quantities")
    place.mkdir(parents=True, exist_ok=True)
    preferences = PreferencesStore(place / "preferences.json")
    preferences.change(**({"language": "en", "tour_seen": True} | wanted))
    application = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
    window = application.window
    window.boxes = AnsweringBoxes()
    window.show()
    try:
        if survey:
            session = application.services.session
            session.open(make_folder(place))
            session.set_results(make_results(session.folder))
            window.files._show_survey()
            window.show_page("leaks")
            session.select(session.ordered_ids()[0])
        settle(lambda: not application.services.jobs.running)
        yield application
    finally:
        settle(lambda: not application.services.jobs.running)
        application.window.close()
        application.shut_down()
        application.window.deleteLater()
        application._translation.use("en")
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        qapp.setStyleSheet(before[0])
        qapp.setFont(before[1])
        qapp.setPalette(before[2])
        QLocale.setDefault(before[3])
        qapp.setProperty("leakline_quantities", before[4])


def visible_children(widget, kind=QWidget):
    """Return all widgets below that are seen."""
    return [child for child in widget.findChildren(kind) if child.isVisible()]
