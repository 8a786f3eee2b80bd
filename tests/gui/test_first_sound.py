"""A sound can be looked at before it is processed: roughly at once, and never in the place of results."""

import threading

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication
from small_survey import make_device_folder, make_folder

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing import pipeline


@pytest.fixture
def window(qtbot, tmp_path):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    services = Services(SurveySession(), Jobs(), preferences, None, lambda _r: CountingSink(), lambda: None)
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    window.show()
    qtbot.waitUntil(lambda: not services.jobs.running)
    yield window
    window.close()
    services.jobs.stop_all()
    services.session.close()
    window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


@pytest.fixture
def held(monkeypatch):
    """Let processing wait before its first step until the event is set."""
    go, orient = threading.Event(), pipeline.estimate_attitude

    def wait_and_orient(*args):
        assert go.wait(30)
        return orient(*args)

    monkeypatch.setattr(pipeline, "estimate_attitude", wait_and_orient)
    yield go
    go.set()


def test_the_sound_is_shown_while_the_survey_is_processed_and_then_its_results(qtbot, window, held, tmp_path):
    make_folder(tmp_path).close()
    window.files.open_path(next(tmp_path.glob("*.leakline")))
    qtbot.waitUntil(lambda: window.first_sound.is_shown, timeout=30_000)
    assert window.page == "sound"
    picture = window.review_page.spectrogram
    qtbot.waitUntil(lambda: picture.is_sharp, timeout=30_000)
    assert (window._session.cursor.extent_s[0], window._session.results) == (0.0, None)
    assert "first look" in window.notices.banner.text()
    window.show_path()  # there is no path yet
    assert window.page == "data"
    window.show_sound()
    assert window.page == "sound"
    held.set()
    qtbot.waitUntil(lambda: window._session.results is not None, timeout=30_000)
    qtbot.waitUntil(lambda: window.page == "leaks")
    assert not window.first_sound.is_shown
    assert "first look" not in window.notices.banner.text()
    assert window.boxes.told == []
    qtbot.waitUntil(lambda: not window._services.jobs.running, timeout=30_000)


def test_processing_that_is_given_up_leaves_the_first_look_and_closing_ends_it(qtbot, window, held, tmp_path):
    make_folder(tmp_path).close()
    window.files.open_path(next(tmp_path.glob("*.leakline")))
    qtbot.waitUntil(lambda: window.first_sound.is_shown, timeout=30_000)
    for job in window._services.jobs.running:
        job.cancel()
    held.set()
    qtbot.waitUntil(lambda: not window._services.jobs.running, timeout=30_000)
    assert (window.page, window.first_sound.is_shown) == ("sound", True)
    window.files.close_survey()
    assert (window.page, window.first_sound.is_shown) == ("start", False)
    assert window.notices.banner.text() == ""


def test_a_device_folder_can_be_looked_at_but_its_form_stays_in_front(qtbot, window, tmp_path):
    window.files.open_path(make_device_folder(tmp_path))
    qtbot.waitUntil(lambda: window.first_sound.is_shown, timeout=30_000)
    assert window.page == "data"
    window.show_sound()
    assert window.page == "sound"
    qtbot.waitUntil(lambda: window.review_page.spectrogram.is_sharp, timeout=30_000)


def test_sound_that_cannot_be_read_is_no_first_look_and_no_crash(qtbot, window, held, tmp_path):
    make_folder(tmp_path).close()
    folder = next(tmp_path.glob("*.leakline"))
    (folder / "recordings" / "1" / "original" / "audio.wav").write_bytes(b"RIFF")
    window.files.open_path(folder)
    qtbot.waitUntil(lambda: len(window._services.jobs.running) == 1 or held.is_set(), timeout=30_000)
    qtbot.wait(400)
    assert not window.first_sound.is_shown
    held.set()
    qtbot.waitUntil(lambda: not window._services.jobs.running, timeout=30_000)
