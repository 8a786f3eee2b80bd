"""A second reviewer judges blind, every word is on disc at once, and the first one's decisions are never touched."""

import shutil
from dataclasses import replace

import pytest
from kept_window import kept_fixture, window_fixture
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QLineEdit
from small_survey import candidate, make_folder, make_results, other_run

from app.review_commands import Decide, DecideMany, Mark, WriteNote
from app.survey_session import SurveySession
from processing.errors import ErrorCode
from processing.review_facts import DigFinding, DigResult
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, LeakClass, Run, Survey, Verdict
from widgets.reviewer_dialog import ReviewerDialog

KEY, CONTROL = Qt.Key, Qt.KeyboardModifier.ControlModifier
YES = Decision(Verdict.CONFIRMED, LeakClass.LEAK, "hears it well")
NO = Decision(Verdict.REJECTED)
SECOND = "Bülent Iğdır"


@pytest.fixture
def session(qtbot, tmp_path):
    folder = make_folder(tmp_path)
    session = SurveySession()
    session.open(folder)
    session.set_results(make_results(folder))
    for candidate_id in session.ordered_ids()[:3]:
        session.push(Decide(session, "first", candidate_id, YES))
    yield session
    session.close()


def on_disk(session):
    """The first one's decisions by id, and the second one's by number, as another program would read them now."""
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        run = other.review.latest_run()
        return other.review.decisions(run), other.opinions.of(SECOND)


def test_nothing_of_the_first_review_is_seen_by_the_second(session):
    ids = session.ordered_ids()
    session.set_reviewer(SECOND)
    assert session.decisions == {}
    assert all(row.decision == Decision() for row in session.rows())
    assert all(row.kind is row.candidate.leak_class for row in session.rows())
    assert session.selected == ids[0]  # the first undecided one: all are
    assert session.operator == SECOND


def test_a_second_verdict_is_an_opinion_and_the_first_ones_stay(session):
    ids = session.ordered_ids()
    before = on_disk(session)[0]
    session.set_reviewer(SECOND)
    label = session.row(ids[0]).candidate.label
    session.push(Decide(session, "second", ids[0], NO, ids[1]))
    assert on_disk(session) == (before, {label: NO})
    assert session.selected == ids[1]
    session.push(WriteNote(session, "note", ids[1], Decision(note="vana"), typing=1))
    session.push(DecideMany(session, "many", {ids[2]: NO, ids[3]: NO}))
    assert len(on_disk(session)[1]) == 4
    while session.undo_stack.canUndo():
        session.undo_stack.undo()
    assert on_disk(session) == (before, {})
    while session.undo_stack.canRedo():
        session.undo_stack.redo()
    assert len(on_disk(session)[1]) == 4
    assert on_disk(session)[0] == before


def test_leaving_brings_the_first_review_back_and_no_undo_of_the_second_can_touch_it(session):
    ids = session.ordered_ids()
    before = session.decisions
    session.set_reviewer(SECOND)
    session.push(Decide(session, "second", ids[0], NO))
    session.set_reviewer("")
    assert session.decisions == before
    assert not session.undo_stack.canUndo()
    assert session.operator == "A. Şahin"
    session.set_reviewer(SECOND)
    assert session.decision(ids[0]) == NO
    assert not session.undo_stack.canUndo()


def test_a_run_made_anew_while_the_second_reviews_stays_blind(session):
    ids = session.ordered_ids()
    session.set_reviewer(SECOND)
    session.push(Decide(session, "second", ids[0], NO))
    session.set_results(other_run(session.results, (20.1, 40.0, 60.0, 80.0), "again"))
    assert [d.verdict for d in session.decisions.values()] == [Verdict.REJECTED]
    session.set_reviewer("")
    assert [d.verdict for d in session.decisions.values()] == [Verdict.CONFIRMED] * 3


def test_a_mark_of_the_second_reviewer_is_theirs_in_the_log(session):
    session.set_reviewer(SECOND)
    session.push(Mark(session, "mark", candidate(0, 50.0, 0.5)))
    marked = session.selected
    session.push(Decide(session, "second", marked, YES))
    assert session.folder.review.decision_log()[-1].operator == SECOND
    session.undo_stack.undo()
    session.undo_stack.undo()
    session.undo_stack.redo()
    assert session.decision(session.selected) == Decision()
    session.set_reviewer("")
    assert session.decision(marked) == Decision()


def test_a_survey_opened_anew_is_reviewed_by_the_first(session, tmp_path):
    session.set_reviewer(SECOND)
    path = session.folder.path
    session.close()
    session.open(SurveyFolder.open(path))
    assert session.reviewer == ""


def test_a_refused_opinion_changes_nothing_and_is_told(session):
    ids = session.ordered_ids()
    path = session.folder.path
    session.close()
    session.open(SurveyFolder.open(path, read_only=True))
    session.set_results(make_results(session.folder))
    session.set_reviewer(SECOND)
    told = []
    session.refused.connect(lambda error: told.append(error.code))
    session.push(Decide(session, "second", ids[0], NO))
    assert told == [ErrorCode.SURVEY_READ_ONLY]
    assert session.decisions == {}
    assert not session.undo_stack.canUndo()


# --- in the window


kept = kept_fixture()
window = window_fixture()


@pytest.fixture
def services(kept, window):
    return kept.services


def press(window, key, modifier=Qt.KeyboardModifier.NoModifier):
    QTest.keyClick(QApplication.focusWidget() or window, key, modifier)


def answer(monkeypatch, name):
    """Let the dialog be answered with a name."""

    def fill(dialog):
        dialog.findChild(QLineEdit, "reviewer_name").setText(name)
        return ReviewerDialog.DialogCode.Accepted

    monkeypatch.setattr(ReviewerDialog, "exec", fill)


def reviewed_twice(window, monkeypatch):
    """First: yes yes no. Second, by keys alone: yes no no."""
    for key in (KEY.Key_1, KEY.Key_1, KEY.Key_2):
        press(window, key)
    answer(monkeypatch, f"  {SECOND} ")
    press(window, KEY.Key_J, CONTROL)
    for key in (KEY.Key_1, KEY.Key_2, KEY.Key_2):
        press(window, key)


def test_the_blind_review_by_keys_hides_the_first_everywhere_and_ends_with_the_differences(
    window, services, monkeypatch
):
    session = services.session
    ids = session.ordered_ids()
    for key in (KEY.Key_1, KEY.Key_1, KEY.Key_2):
        press(window, key)
    answer(monkeypatch, SECOND)
    press(window, KEY.Key_J, CONTROL)
    assert services.preferences.values.reviewer == SECOND
    assert SECOND in window.notices.banner.text()
    assert all(row.decision == Decision() for row in window.review_page.table.model.rows)
    assert not any(d != Decision() for view in window.review_page.views for d in view._marks.decisions.values())
    assert not window.actions_by_id["export"].isEnabled()
    assert not window.actions_by_id["differences"].isEnabled()
    press(window, KEY.Key_O)
    grid = window.work.gallery.panel.grid
    assert all(row.decision == Decision() for row in grid._rows)
    press(window, KEY.Key_1)
    assert window.page == "gallery"
    assert [row.decision.verdict for row in grid._rows][:2] == [Verdict.CONFIRMED, Verdict.NONE]
    window.show_page("report")  # as the lights beside the steps lead there
    assert window.page == "leaks"
    window.report.export()
    assert not services.jobs.running  # no report of what one of two says
    press(window, KEY.Key_J, CONTROL)
    assert session.reviewer == ""
    assert window.page == "differences"
    assert session.decision(ids[1]).verdict is Verdict.CONFIRMED
    assert window.actions_by_id["export"].isEnabled()


def test_arrows_keep_the_first_or_take_the_second_logged_and_undone(window, services, monkeypatch):
    session = services.session
    ids = session.ordered_ids()
    session.push(WriteNote(session, "note", ids[1], Decision(note="wet road"), typing=1))
    reviewed_twice(window, monkeypatch)
    session.push(WriteNote(session, "note", ids[1], Decision(Verdict.REJECTED, note="a valve"), typing=2))
    press(window, KEY.Key_J, CONTROL)
    panel = window.work.second.panel
    assert [(row.candidate_id, row.first.verdict, row.second.verdict) for row in panel.shown] == [
        (ids[1], Verdict.CONFIRMED, Verdict.REJECTED)
    ]
    assert "Judged by both: 3, alike: 2." in panel.findChild(QLabel, "agreement").text()
    press(window, KEY.Key_Left)
    assert panel.shown == ()
    assert session.folder.review.decision_log()[-1].after.verdict is Verdict.CONFIRMED
    press(window, KEY.Key_Z, CONTROL)
    assert len(panel.shown) == 1
    press(window, KEY.Key_Right)
    assert session.decision(ids[1]) == Decision(Verdict.REJECTED, note=f"wet road\n{SECOND}: a valve")
    assert session.folder.review.decision(ids[1]) == session.decision(ids[1])
    assert session.folder.opinions.of(SECOND)[session.row(ids[1]).candidate.label].verdict is Verdict.REJECTED
    press(window, KEY.Key_Z, CONTROL)
    assert session.decision(ids[1]) == Decision(Verdict.CONFIRMED, note="wet road")
    press(window, KEY.Key_Return)
    assert window.page == "leaks"
    assert session.selected == ids[1]


def test_the_first_reviewer_cannot_be_the_second(qtbot):
    dialog = ReviewerDialog("A. Şahin", "a.  şahin".upper().replace("İ", "I"), ())
    qtbot.addWidget(dialog)
    field = dialog.findChild(QLineEdit, "reviewer_name")
    for name, able in (("", False), (" ", False), ("a. şahin", False), ("Bülent", True)):
        field.setText(name)
        assert dialog._go.isEnabled() is able, name


def test_opinions_of_a_colleagues_copy_come_in_and_go_with_undo(qtbot, window, services, tmp_path):
    session = services.session
    ids = session.ordered_ids()
    press(window, KEY.Key_1)
    label = session.row(ids[0]).candidate.label
    copy = tmp_path / "copy" / session.folder.path.name
    shutil.copytree(session.folder.path, copy, ignore=shutil.ignore_patterns("survey.lock"))
    with SurveyFolder.open(copy) as theirs:
        theirs.opinions.give(label, "Cem", NO)
    window.work.second.import_from(copy)
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert window.page == "differences"
    assert session.folder.opinions.of("Cem") == {label: NO}
    assert len(window.work.second.panel.shown) == 1
    session.undo_stack.undo()
    assert session.folder.opinions.of("Cem") == {}
    assert window.work.second.panel.shown == ()
    session.undo_stack.redo()
    assert len(window.work.second.panel.shown) == 1


def test_another_survey_or_a_copy_without_opinions_is_told(qtbot, window, services, tmp_path):
    window.work.second.import_from(services.session.folder.path)
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert window.boxes.told == [ErrorCode.OPINIONS_NONE]
    with SurveyFolder.create(tmp_path / "other", Survey(), []) as other:
        run = other.review.add_run(Run(0, "", "h"), [candidate(0, 55.0, 0.5)])
        other.opinions.give(run.candidates[0].label, "Cem", NO)
        path = other.path
    window.work.second.import_from(path)
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert window.boxes.told[-1] is ErrorCode.OPINIONS_OTHER_SURVEY
    assert services.session.folder.opinions.opinions() == ()


def test_without_results_there_is_nothing_to_review_twice(window, services):
    assert window.actions_by_id["second_review"].isEnabled()
    path = services.session.folder.path
    services.session.close()
    services.session.open(SurveyFolder.open(path))
    for name in ("second_review", "differences", "opinions_import"):
        assert not window.actions_by_id[name].isEnabled()


def test_what_was_settled_stays_so_when_the_survey_is_processed_again(window, services, monkeypatch):
    session = services.session
    reviewed_twice(window, monkeypatch)
    press(window, KEY.Key_J, CONTROL)
    panel = window.work.second.panel
    press(window, KEY.Key_Left)
    assert panel.shown == ()
    ids = session.ordered_ids()
    found_again = make_results(session.folder).candidates
    session.set_results(replace(session.results, run_hash="another run", candidates=found_again))
    assert set(session.ordered_ids()).isdisjoint(ids)
    window.work.second.show_differences()
    if window.page != "differences":
        window.work.second.show_differences()
    assert panel.shown == ()


def test_what_digs_showed_and_the_firsts_progress_are_hidden_from_the_second(window, services, monkeypatch, tmp_path):
    session = services.session
    number = session.row(session.ordered_ids()[0]).candidate.label
    window.work.digs.ledger.write(number, DigResult(number, DigFinding.LEAK))
    services.preferences.remember_recent(session.folder.path)
    for _ in range(4):
        press(window, KEY.Key_1)
    shown = window.review_page
    assert shown.table.model._dug
    assert shown.path._marks.dug
    card = window.work.start._cards.read(str(session.folder.path))
    assert (card.decided, card.confirmed) == (4, 4)
    answer(monkeypatch, SECOND)
    press(window, KEY.Key_J, CONTROL)
    assert shown.table.model._dug == shown.path._marks.dug == {}
    assert not window.actions_by_id["dig"].isEnabled()
    press(window, KEY.Key_2)
    assert window.work.start._cards.read(str(session.folder.path)) == card  # an opinion is not how far the survey is
    window.work.start._show()
    (shown_row,) = window.work.start._page.recent.shown
    assert shown_row.lines()[2].startswith("1 of 4 decided")
    assert "confirmed" not in shown_row.lines()[2]
    window.show_page("leaks")
    for _ in range(3):
        press(window, KEY.Key_2)
    assert "Ctrl+J" in shown.table.tools.progress_text
    window.work.next_step()
    assert (session.reviewer, window.page) == ("", "differences")
    assert shown.table.model._dug
