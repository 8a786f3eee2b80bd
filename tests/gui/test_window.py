"""The window by mouse, in another language, on its first start, and when it stumbles."""

import subprocess
import sys
import threading

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt, QUrl
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton, QToolButton
from small_survey import make_folder, make_results

from app.application import Application
from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.storage.folder import SurveyFolder
from processing.survey import Severity, Verdict
from widgets.findings_panel import severity_pixmap

LEFT = Qt.MouseButton.LeftButton


def make_sink(_rate_hz):
    return CountingSink()


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.change(language="en")
    application = Application(qapp, preferences, None, make_sink, lambda: None)
    application.window.boxes = AnsweringBoxes()
    application.window.show()
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    yield application
    application.window.close()
    application.shut_down()
    application.window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    qapp.setStyleSheet(before[0])
    qapp.setFont(before[1])
    qapp.setPalette(before[2])


@pytest.fixture
def opened(application, tmp_path):
    session = application.services.session
    session.open(make_folder(tmp_path))
    session.set_results(make_results(session.folder))
    application.window.show_page("leaks")
    return session


def test_without_a_survey_only_opening_is_offered(application):
    window = application.window
    assert window.page == "start"
    enabled = {name for name, action in window.actions_by_id.items() if action.isEnabled()}
    assert {"open", "demo", "help", "keys", "theme", "quit"} <= enabled
    assert not enabled & {"export", "process", "undo", "confirm", "play", "mark", "page_leaks", "close"}
    assert not window.findChild(QToolButton, "page_leaks").isEnabled()


def test_the_review_by_mouse_alone(application, opened):
    window = application.window
    first, second, *_ = opened.ordered_ids()
    QTest.mouseClick(window.findChild(QToolButton, "verdict_confirmed"), LEFT)
    QTest.mouseClick(window.findChild(QToolButton, "verdict_rejected"), LEFT)
    window.review_page.path.candidate_clicked.emit(first)
    assert opened.selected == first
    QTest.mouseClick(window.findChild(QToolButton, "verdict_none"), LEFT)
    QTest.mouseClick(window.findChild(QToolButton, "tool_undo"), LEFT)
    with SurveyFolder.open(opened.folder.path, read_only=True) as other:
        stored = other.review.decisions(other.review.latest_run())
    assert {k: v.verdict for k, v in stored.items()} == {first: Verdict.CONFIRMED, second: Verdict.REJECTED}


def test_pages_are_reached_by_their_buttons(application, opened):
    window = application.window
    for page in ("data", "path", "sound", "report", "leaks"):
        QTest.mouseClick(window.findChild(QToolButton, f"page_{page}"), LEFT)
        assert window.page == page
        assert window.findChild(QToolButton, f"page_{page}").isChecked()


def test_a_stretch_that_was_not_assessed_leads_to_its_sound(application, opened):
    window = application.window
    window.files._show_survey()
    stretch = opened.results.not_assessed[0]
    assert any("not assessed" in text for text in window.data_page.findings.texts())
    window.data_page.findings._browser.anchorClicked.emit(QUrl(f"moment:{stretch.start_s!r}"))
    assert window.page == "sound"
    assert opened.cursor.time_s == stretch.start_s


def test_severities_differ_in_sign_not_only_in_colour(qapp):
    signs = set()
    for severity in Severity:
        image = severity_pixmap(severity).toImage()
        size = range(image.width())
        signs.add(bytes(int(image.pixelColor(x, y).lightness() > 200) for y in size for x in size))
    assert len(signs) == len(Severity)


def test_another_language_keeps_the_survey_the_page_and_the_undo(application, opened, qtbot):
    first = opened.selected
    application.window.review.confirm()
    old = application.window
    old.toggle_language()
    window = application.window
    window.boxes = AnsweringBoxes()
    assert window is not old
    assert (window.page, opened.decision(first).verdict) == ("leaks", Verdict.CONFIRMED)
    assert application.services.preferences.values.language == "tr"
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    opened.cursor.set_time(12.0)  # what listens to it must be the new window alone
    window.review.undo()
    assert opened.decision(first).verdict is Verdict.NONE
    qtbot.waitUntil(lambda: not application.services.jobs.running)


def test_a_fault_of_ours_is_told_once_and_the_review_goes_on(application, opened):
    window = application.window
    application.guard.tell(ZeroDivisionError("x" * 5000))
    assert len(window.boxes.told) == 1
    assert len(window.boxes.told[0]) < 500
    first = opened.selected
    window.review.confirm()
    assert opened.decision(first).verdict is Verdict.CONFIRMED


def test_a_sound_card_that_is_found_late_finds_no_window_that_is_gone(qapp, qtbot, tmp_path):
    go = threading.Event()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    services = Services(SurveySession(), Jobs(), preferences, None, make_sink, lambda: None if go.wait(20.0) else "")
    window = MainWindow(services, "en")
    with qtbot.captureExceptions() as caught:
        window.close()  # as when the language changes in the first second
        window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        go.set()
        qtbot.waitUntil(lambda: not services.jobs.running)
    assert caught == []
    services.jobs.stop_all()


def test_a_job_that_stumbles_is_told_by_the_guard(application, opened, qtbot, caplog):
    def step(_progress):
        raise ZeroDivisionError("in a job")

    application.services.jobs.start(step, title="broken")
    qtbot.waitUntil(application.window.boxes.told.__len__)
    assert "in a job" in application.window.boxes.told[0]


def test_a_long_job_shows_its_line_and_can_be_cancelled_there(application, qtbot):
    window = application.window

    def step(progress):
        import threading

        while True:
            progress.update(0.4, "position")
            threading.Event().wait(0.002)

    application.services.jobs.start(step, title="endless")
    qtbot.waitUntil(window._strip.isVisible, timeout=5000)
    QTest.mouseClick(window.findChild(QPushButton, "cancel_job"), LEFT)
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    assert not window._strip.isVisible()
    assert window.boxes.told == []


def test_the_window_shows_before_any_heavy_library_is_read():
    script = (
        "import sys; import app.application\n"
        "heavy = {'scipy', 'pyproj', 'matplotlib', 'vqf'} & {name.split('.')[0] for name in sys.modules}\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
