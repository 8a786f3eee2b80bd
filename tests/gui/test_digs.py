"""What a dig showed goes back into the survey: entered, corrected, undone, remembered, and never silently used."""

import json
from dataclasses import replace

import pytest
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QPushButton, QStackedWidget, QWidget
from small_survey import make_folder, make_results, other_run

from app.dig_control import PAGE, DigControl
from app.dig_ledger import history_file
from app.jobs import Jobs
from app.main_window import MainWindow
from app.page_host import PageHost
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.dig_history import HistoryFile, kind_of
from processing.errors import ErrorCode
from processing.reporting.content import make_content
from processing.review_facts import DigFinding, DigResult
from processing.storage.digs import DigEntry
from processing.storage.folder import SurveyFolder
from processing.survey import Finding, Motion, PipeInfo, Severity, StatedIntervals, Verdict
from widgets.dig_list import Held


@pytest.fixture
def services(qapp, tmp_path):
    services = Services(
        SurveySession(), Jobs(), PreferencesStore(tmp_path / "preferences.json"), why_silent=lambda: None
    )
    services.session.open(make_folder(tmp_path))
    services.session.set_results(make_results(services.session.folder))
    yield services
    services.jobs.stop_all()
    services.session.close()


@pytest.fixture
def session(services):
    return services.session


@pytest.fixture
def control(qtbot, services):
    window, stack = QWidget(), QStackedWidget()
    shown = ["leaks"]
    host = PageHost({}, stack, shown.append, lambda: shown[-1])
    made = DigControl(services, host, "en", window)
    made.shown = shown
    yield made
    qtbot.waitUntil(lambda: not services.jobs.running)
    window.deleteLater()
    stack.deleteLater()


def press(control, *names):
    for name in names:
        control.page.findChild(QPushButton, name).click()


def fill(field, text):
    """Type as a keyboard does: the field is told of the text, and of its end."""
    field.setText(text)
    QLineEdit.textEdited.__get__(field).emit(text)
    field.editingFinished.emit()


def enter(control, number, distance="0.6", arrow="dig_away", finding="leak"):
    """Open the page at a leak, fill in the form and save."""
    row = next(r for r in control._session.rows() if r.candidate.label == number)
    control._session.select(row.candidate.id)
    if control.shown[-1] == PAGE:
        control._choose(number)
    else:
        control.toggle()
    press(control, f"dig_finding_{finding}")
    if distance:
        fill(control.page.form._distance, distance)
        press(control, arrow)
    press(control, "dig_save")


def on_disc(session):
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        return other.digs.results()


def said(control):
    return control.page.form._told.text()


def test_what_was_found_is_on_disc_with_the_statement_as_it_stood(control, session):
    enter(control, 2)
    found = on_disc(session)[2]
    assert (found.finding, found.off_along_m, found.stated_chainage_m) == (DigFinding.LEAK, 0.6, 40.0)
    assert (found.stated_low95_m, found.stated_high95_m) == (39.2, 40.8)
    assert found.run_id == session.run.id
    assert found.stated_score == pytest.approx(session.row(session.selected).candidate.score)
    (line,) = (line for line in control._words.lines(session, control.ledger.results) if line.number == 2)
    assert (line.held, line.off) == (Held.INSIDE, "0.6 m ▶")


def test_towards_the_launch_is_a_button_not_a_minus(control, session):
    enter(control, 2, "1,8", "dig_towards")
    assert on_disc(session)[2].off_along_m == -1.8
    assert "outside the stated interval" in said(control)


def test_a_distance_without_a_direction_is_not_saved_and_is_asked_for(control, session):
    control.toggle()
    press(control, "dig_finding_leak")
    fill(control.page.form._distance, "0.6")
    press(control, "dig_save")
    assert on_disc(session) == {}
    assert "Press one of the two arrows" in said(control)


def test_undo_and_redo_bring_each_entry_back_and_the_log_keeps_all(control, session):
    enter(control, 1)
    enter(control, 1, "0.2", "dig_towards")
    assert on_disc(session)[1].off_along_m == -0.2
    session.undo_stack.undo()
    assert on_disc(session)[1].off_along_m == 0.6
    session.undo_stack.undo()
    assert on_disc(session) == {}
    session.undo_stack.redo()
    assert on_disc(session)[1].off_along_m == 0.6
    assert [e.result is None for e in session.folder.digs.log()] == [False, False, False, True, False]


def test_taking_back_is_a_step_of_undo_too(control, session):
    enter(control, 1)
    press(control, "dig_clear")
    assert on_disc(session) == {}
    session.undo_stack.undo()
    assert on_disc(session)[1].off_along_m == 0.6


def test_a_later_run_does_not_change_what_had_been_stated(control, session):
    enter(control, 1)
    session.set_results(other_run(make_results(session.folder), (20.4, 40.0), "another"))
    enter(control, 1, "0.1")
    found = on_disc(session)[1]
    assert (found.stated_chainage_m, found.off_along_m) == (20.0, 0.1)
    control.page.form._statements.setCurrentIndex(0)  # the crew dug by the newer report after all
    press(control, "dig_save")
    assert on_disc(session)[1].stated_chainage_m == 20.4


def test_a_correction_after_a_like_run_and_a_widening_keeps_what_the_crew_dug_by(control, session):
    enter(control, 1, "1.5")
    before = on_disc(session)[1]
    session.set_results(other_run(make_results(session.folder), (20.0, 40.0), "settings that change nothing here"))
    session.write_survey(replace(session.survey, stated=StatedIntervals(3.0, 12, "rolling/*/*/*")))
    enter(control, 1, "1.6")
    after = on_disc(session)[1]
    assert after == replace(before, off_along_m=1.6, at_utc=after.at_utc)
    assert control._words.held(after) is Held.OUTSIDE


def test_chainage_and_coordinates_become_an_offset_from_the_statement(control, session):
    control.toggle()
    press(control, "dig_finding_leak", "dig_by_chainage")
    fill(control.page.form._chainage, "20.5")
    press(control, "dig_save")
    assert on_disc(session)[1].off_along_m == pytest.approx(0.5)
    control._choose(2)
    press(control, "dig_finding_leak", "dig_by_coordinates")
    fill(control.page.form._coordinates, "41.0 -2.0")  # the pipe runs east
    press(control, "dig_save")
    found = on_disc(session)[2]
    assert (found.off_along_m, found.off_across_m) == (pytest.approx(1.0), pytest.approx(2.0))
    assert found.measured == "coordinates"
    fill(control.page.form._coordinates, "forty one")
    control._choose(3)
    press(control, "dig_finding_leak", "dig_by_coordinates")
    fill(control.page.form._coordinates, "forty one")
    assert "is not a place" in said(control)
    fill(control.page.form._coordinates, "410 -2")
    assert "m beside the path of this survey" in said(control)  # the pipe is 100 m long
    press(control, "dig_save")
    assert 3 not in on_disc(session)
    unknown = replace(session.results, findings=(Finding("heading_unknown", Severity.WARNING),))
    session.set_results(unknown)
    control._choose(3)
    press(control, "dig_finding_leak", "dig_by_coordinates")
    fill(control.page.form._coordinates, "61 -2")
    assert "no path to put coordinates on" in said(control)


def test_a_leak_found_elsewhere_is_marked_confirmed_and_dug_in_one_step(control, session):
    marked = []
    control.marked.connect(marked.append)
    control.toggle()
    press(control, "dig_missed")
    fill(control.page.form._chainage, "71")
    press(control, "dig_save")
    mark = next(row for row in session.rows() if row.manual)
    assert marked[-1] == {mark.candidate.label: "!"}  # what list and plan are told
    assert mark.candidate.chainage_m == pytest.approx(71.0, abs=0.01)
    assert mark.decision.verdict is Verdict.CONFIRMED
    found = on_disc(session)[mark.candidate.label]
    assert found.missed
    assert found.stated_chainage_m is None
    session.undo_stack.undo()
    assert not any(row.manual for row in session.rows())
    assert on_disc(session) == {}


def test_a_survey_that_cannot_be_written_refuses_and_says_so(control, session, monkeypatch):
    control.toggle()
    refused = []
    session.refused.connect(refused.append)
    monkeypatch.setattr(type(session.folder), "read_only", property(lambda _self: True))
    assert not control.ledger.write(1, DigResult(1, DigFinding.LEAK))
    assert [error.code for error in refused] == [ErrorCode.SURVEY_READ_ONLY]
    assert control.ledger.results == {}


def test_the_history_of_the_computer_follows_the_survey_and_loses_what_was_taken_back(control, services, qtbot):
    enter(control, 1)
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert len(HistoryFile(history_file()).read().digs) == 1
    assert control.ledger.history.count == 1
    assert "The one measured dig on rolling runs" in control.page._history.text()
    services.session.undo_stack.undo()
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert HistoryFile(history_file()).read().digs == ()
    assert control.ledger.history is None


def test_a_result_entered_again_after_a_backup_came_back_reaches_the_history(control, session, services, qtbot):
    enter(control, 1, "40")
    press(control, "dig_clear")
    qtbot.waitUntil(lambda: not services.jobs.running)
    (entry,) = HistoryFile(history_file()).read().digs or (None,)
    assert entry is None
    lines = [json.loads(line) for line in history_file().read_text(encoding="utf-8").splitlines()]
    ahead = [json.dumps({**line, "revision": line["revision"] + 7}) for line in lines]  # as if more had been entered
    history_file().write_text("\n".join(ahead) + "\n", encoding="utf-8")
    enter(control, 1, "0.4")
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert [e.dig.off_along_m for e in HistoryFile(history_file()).read().digs] == [0.4]


def test_another_material_in_the_form_asks_the_history_of_that_material(control, session, services, qtbot):
    narrow_history(session)
    control.ledger.refresh()
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert control.ledger.history.kind.split("/")[1] == "?"
    other = replace(session.survey, pipe=PipeInfo("PVC"), device=replace(session.survey.device, motion=Motion.FOOT))
    session.write_survey(other)
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert control.ledger.history is None  # nobody has dug after a run on foot


def narrow_history(session, count=12):
    """Remember digs of another survey that all lay far outside what had been stated."""
    digs = [
        DigResult(i, DigFinding.LEAK, "", 1.5 * (-1) ** i, stated_chainage_m=50.0, stated_low95_m=49.2,
                  stated_high95_m=50.8, sigma_m=0.05)
        for i in range(1, count + 1)
    ]  # fmt: skip
    log = [DigEntry(dig.number, "", "", dig.number, dig) for dig in digs]
    HistoryFile(history_file()).take("elsewhere", session.survey, log)


def test_intervals_are_widened_only_by_hand_logged_and_undone(control, session, services, qtbot):
    narrow_history(session)
    control.ledger.refresh()
    qtbot.waitUntil(lambda: not services.jobs.running)
    control.toggle()
    factor = control.ledger.history.widen
    assert 3.0 < factor < 5.0  # errors of 1.5 m at a stated sigma of 0.41 m
    assert session.survey.stated == StatedIntervals()  # nothing by itself
    press(control, "dig_widen")
    stated = session.survey.stated
    assert factor <= stated.widen < factor + 0.1
    assert (stated.digs, stated.kind) == (12, control.ledger.history.kind)
    assert session.folder.read_survey().stated == stated
    content = make_content(replace(session.results, survey=session.survey), {})
    assert content.rows[0].interval_m == pytest.approx(0.8 * stated.widen)
    assert "have been widened" in control.page._history.text()
    session.undo_stack.undo()
    assert session.folder.read_survey().stated == StatedIntervals()
    session.undo_stack.redo()
    press(control, "dig_widen")  # the same button takes it back
    assert session.survey.stated == StatedIntervals()


def test_after_widening_a_dig_is_held_against_the_wider_statement(control, session):
    session.write_survey(replace(session.survey, stated=StatedIntervals(2.0, 12, "rolling/*/*/*")))
    session.select(next(row.candidate.id for row in session.rows() if row.candidate.label == 2))
    control.toggle()
    assert "± 1.6 m" in control.page.form._title.text()  # as the report states it, before anybody has dug
    (line,) = (line for line in control._words.lines(session, control.ledger.results) if line.number == 2)
    assert line.stated.endswith("± 1.6 m")
    enter(control, 2, "1.5")
    found = on_disc(session)[2]
    assert (found.stated_low95_m, found.stated_high95_m) == (pytest.approx(38.4), pytest.approx(41.6))
    assert found.stated_widen == 2.0
    assert "the stated interval holds it" in said(control)


def test_the_page_is_left_by_the_same_key_and_shows_the_selected_leak(control, session):
    session.select(session.ordered_ids()[2])
    control.toggle()
    assert control.shown[-1] == PAGE
    assert control.page.list.numbers[control.page.list.currentRow()] == session.row(session.selected).candidate.label
    control.toggle()
    assert control.shown[-1] == "leaks"


def test_causes_and_crews_are_offered_again_next_time(control, services):
    control.toggle()
    control.page.form._cause.setEditText("kök basıncı")
    control.page.form._crew.setEditText("Ekip 3")
    press(control, "dig_finding_leak", "dig_save")
    again = PreferencesStore(services.preferences.file)
    control._preferences = again
    assert control._remembered("causes") == ["kök basıncı"]
    assert control._remembered("crews") == ["Ekip 3"]


def test_the_histories_of_two_laptops_are_put_together_from_the_page(control, session, services, tmp_path, qtbot):
    other = HistoryFile(tmp_path / "other" / "dig-history.jsonl")
    dig = DigResult(1, DigFinding.LEAK, "", 0.2, stated_chainage_m=5.0, stated_low95_m=4.0, stated_high95_m=6.0)
    other.take("theirs", session.survey, [DigEntry(1, "", "", 1, dig)])
    other.write_out(tmp_path / "theirs.jsonl")
    told = []
    control.told.connect(told.append)
    control.ledger.take_in(tmp_path / "theirs.jsonl")
    qtbot.waitUntil(lambda: control.ledger.history is not None and not services.jobs.running)
    assert control.ledger.history.count == 1
    assert told == ["1 digs of other surveys taken in"]
    control.ledger.write_out(tmp_path / "ours.jsonl")
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert len(HistoryFile(tmp_path / "ours.jsonl").read().digs) == 1
    assert kind_of(session.survey).tied


def test_in_the_window_one_key_leads_to_the_digs_and_back_and_another_to_the_other_run(services, qtbot):
    window = MainWindow(services, "en")
    try:
        window.show_page("leaks")
        window.show()
        qtbot.waitUntil(lambda: not services.jobs.running)
        window.review_page.focus_views()
        for key, page in ((Qt.Key.Key_F, PAGE), (Qt.Key.Key_L, "repeat")):
            QTest.keyClick(QApplication.focusWidget() or window, key, Qt.KeyboardModifier.ControlModifier)
            assert window.page == page
            QTest.keyClick(QApplication.focusWidget() or window, key, Qt.KeyboardModifier.ControlModifier)
            assert window.page == "leaks"
        window.work.digs.ledger.write(1, DigResult(1, DigFinding.LEAK))
        assert window.review_page.table.model.data(window.review_page.table.model.index(0, 0)) == "L1 [•]"
        qtbot.waitUntil(lambda: not services.jobs.running)
    finally:
        window.close()
        window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def test_a_photo_of_a_leak_found_elsewhere_never_goes_to_the_leak_that_is_selected(control, session):
    asked, told = [], []
    control.photo_asked.connect(lambda: asked.append(session.row(session.selected).candidate.label))
    control.told.connect(told.append)
    control.toggle()
    press(control, "dig_missed", "dig_photo")
    assert asked == []
    assert "Save the dig first" in told[-1]
    control._choose(3)
    session.select(session.ordered_ids()[0])  # the list of leaks has gone on since
    press(control, "dig_photo")
    assert asked == [3]
