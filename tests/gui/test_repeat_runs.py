"""Another run of the same pipe beside the open one: chosen, compared, walked through, heard, written; never changed."""

import csv
import hashlib

import pytest
from answering import CountingSink
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QPushButton, QStackedWidget, QWidget
from small_survey import make_folder

from app.jobs import Jobs
from app.page_host import PageHost
from app.repeat_control import PAGE, RepeatControl
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.quantities import Quantities
from processing.repeat_runs import Change
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, Verdict


@pytest.fixture
def surveys(main_twice):
    """The older survey's folder, the newer one's, and the newer one's results."""
    (old, _), (new, results) = main_twice
    return old, new, results


@pytest.fixture
def services(qapp, tmp_path, surveys):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.remember_recent(surveys[1])
    preferences.remember_recent(surveys[0])
    sinks = []

    def make_sink(_rate_hz):
        sinks.append(CountingSink())
        return sinks[-1]

    services = Services(SurveySession(), Jobs(), preferences, None, make_sink)
    services.session.open(SurveyFolder.open(surveys[1]))
    services.session.set_results(surveys[2])
    services.session.sinks = sinks
    yield services
    services.jobs.stop_all()
    services.session.close()


@pytest.fixture
def control(services):
    window, stack = QWidget(), QStackedWidget()
    shown = ["leaks"]
    made = RepeatControl(services, PageHost({}, stack, shown.append, lambda: shown[-1]), "en", window)
    made.shown = shown
    yield made
    made.stop()
    window.deleteLater()
    stack.deleteLater()


@pytest.fixture
def compared(control, surveys, qtbot):
    control.toggle()
    control.compare_with(surveys[0])
    qtbot.waitUntil(lambda: control.comparison is not None, timeout=20_000)
    return control


def files_of(folder):
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_the_other_run_is_offered_among_the_recent_ones_and_is_not_touched(control, surveys, qtbot):
    before = files_of(surveys[0])
    control.toggle()
    offered = [control.page._others.itemData(row) for row in range(control.page._others.count())]
    assert offered == ["", str(surveys[0])]
    control.page._others.setCurrentIndex(1)
    control.page._on_other(1)
    qtbot.waitUntil(lambda: control.comparison is not None, timeout=20_000)
    assert files_of(surveys[0]) == before
    assert [place.change for place in control.comparison.places] == [Change.SAME, Change.SAME, Change.NEW, Change.GONE]


def test_the_list_says_what_changed_and_its_places_lead_through_both_runs(compared, services):
    table = compared.page.table
    words = [table.item(row, 2).text() for row in range(table.rowCount())]
    assert words == ["= in both runs", "= in both runs, louder", "+ new", "− gone"]
    table.setFocus()
    QTest.keyClick(table, Qt.Key.Key_Down)
    QTest.keyClick(table, Qt.Key.Key_Down)
    new = compared.comparison.places[2]
    assert services.session.selected == new.ours.id
    assert services.session.cursor.chainage_m == pytest.approx(new.chainage_m, abs=0.5)
    QTest.keyClick(table, Qt.Key.Key_Down)
    assert services.session.cursor.chainage_m == pytest.approx(80.0, abs=2.0)  # where ours found nothing
    assert "1 new, 1 gone" in compared.page._words.text()


def test_a_click_in_the_picture_moves_the_common_cursor(compared, services):
    view = compared.page.view
    view.resize(900, 400)
    rect = view.plot_rect()
    QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=rect.center().toPoint())
    middle = view.x_value(rect.center().x())
    assert services.session.cursor.chainage_m == pytest.approx(middle, abs=0.3)
    assert view._cursor_m == pytest.approx(services.session.cursor.chainage_m)
    assert not view.grab().isNull()


def test_both_runs_are_heard_in_turn_and_silence_comes_with_leaving(compared, services):
    sinks = services.session.sinks
    compared._switch()
    assert (compared._heard, len(sinks)) == (0, 1)
    compared._switch()
    assert (compared._heard, len(sinks)) == (1, 2)
    assert sinks[0].closed
    compared.page.findChild(QPushButton, "repeat_listen_1").click()
    assert compared._heard is None
    assert not compared.listening.playing


def test_a_disc_that_is_gone_meanwhile_is_told_and_all_else_goes_on(compared, services, surveys):
    told = []
    compared.told.connect(told.append)
    lost = [part.path for part in compared.comparison.theirs.results.recording.audio.parts]
    for path in lost:
        path.rename(path.with_suffix(".unplugged"))
    try:
        compared._hear(1)
    finally:
        for path in lost:
            path.with_suffix(".unplugged").rename(path)
    assert "→" in told[0]  # a sentence that says what to do
    assert not compared.listening.playing
    compared._hear(0)
    assert compared._heard == 0


def test_what_the_operator_rejects_afterwards_is_no_change_any_more(compared, services):
    new = compared.comparison.places[2]
    services.session.write_decision(new.ours.id, Decision(Verdict.REJECTED), "decide")
    assert [place.change for place in compared.present().places] == [Change.SAME, Change.SAME, Change.GONE]
    compared.toggle()
    compared.toggle()
    assert compared.page.table.rowCount() == 3
    services.session.write_decision(new.ours.id, Decision(), "undo")
    assert len(compared.present().places) == 4
    assert compared.for_report()(Quantities("en"))[0].startswith("Changes since 4 May 2025")


def test_the_table_of_changes_is_written(compared, tmp_path, monkeypatch):
    file = tmp_path / "changes.csv"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_args: (str(file), ""))
    compared.page.findChild(QPushButton, "repeat_export").click()
    rows = list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
    assert [row["change"] for row in rows] == ["same", "same", "new", "gone"]


def test_a_survey_that_was_never_processed_is_said_to_be_and_can_be_opened(control, tmp_path, qtbot):
    make_folder(tmp_path).close()
    other = next(tmp_path.glob("*.leakline"))
    asked = []
    control.open_asked.connect(asked.append)
    control.toggle()
    control.compare_with(other)
    qtbot.waitUntil(lambda: control._job is None, timeout=20_000)
    assert "has not been processed" in control.page.view._hint
    control.page.findChild(QPushButton, "repeat_open").click()
    assert asked == [other]


def test_the_survey_itself_is_no_other_run(control, surveys, qtbot):
    control.toggle()
    control.compare_with(surveys[1])
    qtbot.waitUntil(lambda: control._job is None, timeout=20_000)
    assert "This is the same survey" in control.page.view._hint


def test_new_results_take_the_comparison_away(compared, services, surveys):
    services.session.set_results(surveys[2])
    assert compared.comparison is None
    assert compared.page.table.rowCount() == 0
    compared.toggle()
    compared.toggle()
    assert compared.shown[-1] == PAGE
