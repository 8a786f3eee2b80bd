"""A recording whose program was killed is opened, processed and completed by the window like any survey."""

import shutil
import time

import pytest
from answering import AnsweringBoxes, CountingSink
from killed_recording import known_motion, known_sound
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.storage.recording_writer import RecordingWriter, SoundForm
from processing.survey import Survey, SurveyInfo


@pytest.fixture
def killed(tmp_path):
    """What a kill leaves of a recording of two seconds."""
    writer = RecordingWriter.create(tmp_path / "a", Survey(SurveyInfo("Kayıt")), SoundForm(48000), motion=True)
    try:
        writer.write_sound(known_sound(0, 96000))
        writer.write_motion(known_motion(0, 800))
        deadline, now = time.monotonic() + 20.0, time.monotonic()
        while (writer.status().synced_host_s or 0.0) <= now:
            assert time.monotonic() < deadline
            time.sleep(0.02)
        return shutil.copytree(writer.path, tmp_path / "left.leakline", ignore=shutil.ignore_patterns("survey.lock"))
    finally:
        writer.close()


def test_the_sums_of_a_killed_recording_are_stored_when_it_was_processed(qtbot, tmp_path, killed):
    services = Services(
        SurveySession(), Jobs(), PreferencesStore(tmp_path / "p.json"), None, lambda _r: CountingSink(), lambda: None
    )
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    try:
        assert window.files.open_project(killed)
        assert {file.sha256 for file in services.session.folder.files()} == {""}
        qtbot.waitUntil(lambda: services.session.results is not None, timeout=30_000)
        assert window.boxes.told == []
        assert "recording_unfinished" in [finding.code for finding in services.session.findings]
        files = services.session.folder.files()
        assert [file.role for file in files] == ["audio", "imu", "journal"]
        assert all(len(file.sha256) == 64 for file in files)
        assert services.session.folder.verify_originals() == ()
    finally:
        window.close()
        services.jobs.stop_all()
        services.session.close()
        window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
