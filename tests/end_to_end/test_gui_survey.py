"""The whole job in the window by key: a simulated folder is opened, its leak confirmed, and the files are written."""

import csv

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run

LEAK_M = 13.4  # where P0's straight run has its leak


def make_sink(_rate_hz):
    return CountingSink()


@pytest.fixture
def window(qtbot, tmp_path):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    services = Services(SurveySession(), Jobs(), preferences, None, make_sink, lambda: None)
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    window.show()
    QTest.qWaitForWindowActive(window)
    yield window
    window.close()
    services.jobs.stop_all()
    services.session.close()
    window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def test_a_simulated_folder_becomes_a_confirmed_leak_in_the_files(window, qtbot, tmp_path):
    write_run(simulate(load_scenario("p0-straight"), 1), tmp_path / "device")
    session, jobs = window._session, window._services.jobs

    window.files.open_path(tmp_path / "device")
    qtbot.waitUntil(lambda: window.page == "leaks" and not jobs.running, timeout=60_000)
    assert session.survey.info.simulated
    assert "simulated" in window.notices.banner.text()
    nearest = min(session.rows(), key=lambda row: abs(row.candidate.chainage_m - LEAK_M))
    keys = 0
    while session.selected is not None and not all(
        session.decision(i).verdict.value != "none" for i in session.ordered_ids()
    ):
        verdict = Qt.Key.Key_1 if session.selected == nearest.candidate.id else Qt.Key.Key_2
        QTest.keyClick(QApplication.focusWidget(), verdict)
        keys += 1
    assert keys == len(session.ordered_ids())  # one key a verdict

    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: not jobs.running, timeout=60_000)
    assert window.boxes.told == []
    with (window.report.last_export / "leaks.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    (confirmed,) = [row for row in rows if row["status"] == "confirmed"]
    assert float(confirmed["chainage_m"]) == pytest.approx(LEAK_M, abs=0.5)
    assert (window.report.last_export / "report.pdf").read_bytes().startswith(b"%PDF")
