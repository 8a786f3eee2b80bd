"""Filter, progress, many at once and undo in the real window: list, views and disk agree, nothing jumps."""

import pytest
from kept_window import kept_fixture, window_fixture
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDoubleSpinBox, QLabel, QPushButton
from review_window import on_disk, press, spread

from app.review_commands import WriteNote
from app.settings import PreferencesStore
from processing.survey import Decision, Verdict
from widgets.candidate_row import CandidateFilter

KEY, CONTROL, SHIFT = Qt.Key, Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


kept = kept_fixture(spread(9), size=(1366, 736))  # of a small laptop, less the title of the window
window = window_fixture()


@pytest.fixture
def opened(window, kept):
    return window, kept.services.session


def test_in_a_list_of_undecided_ones_the_next_one_comes_under_the_finger(opened):
    window, session = opened
    table, ids = window.review_page.table, session.ordered_ids()
    press(window, KEY.Key_Down)
    press(window, KEY.Key_Down)
    press(window, KEY.Key_N)
    assert session.filter == CandidateFilter(Verdict.NONE)
    row = table._table.currentIndex().row()
    for k in range(3):
        assert session.selected == ids[2 + k]
        press(window, KEY.Key_1)
        assert table._table.currentIndex().row() == row
        assert ids[2 + k] not in table.ids()
    assert "6 of 9 shown" in table.tools.progress_text
    assert on_disk(session) == dict.fromkeys(ids[2:5], Decision(Verdict.CONFIRMED))


def test_undo_brings_filter_range_and_selection_back_and_says_what_it_undid(opened):
    window, session = opened
    cursor, first = session.cursor, session.selected
    press(window, KEY.Key_N)
    press(window, KEY.Key_Z)
    press(window, KEY.Key_Z)
    seen = session.view
    press(window, KEY.Key_2)
    after = session.view
    press(window, KEY.Key_N, SHIFT | CONTROL)
    press(window, KEY.Key_F)
    press(window, KEY.Key_D)
    session.select(session.ordered_ids()[-1])
    press(window, KEY.Key_Z, CONTROL)
    assert session.view == seen
    assert session.decision(first) == Decision()
    assert first in window.review_page.table.ids()
    assert window.review_page.toast.isVisible()
    assert session.row(first).name in window.review_page.toast.text()
    press(window, KEY.Key_F)
    press(window, KEY.Key_Y, CONTROL)
    assert session.view == after
    assert on_disk(session) == {first: Decision(Verdict.REJECTED)}
    assert cursor.x_range == after.x_range


def test_undo_shows_a_candidate_that_another_filter_hides(opened):
    window, session = opened
    first = session.selected
    press(window, KEY.Key_1)
    session.set_filter(CandidateFilter(Verdict.REJECTED, least_score=0.5))
    press(window, KEY.Key_Z, CONTROL)
    assert session.selected == first
    assert window.review_page.table.selected_id() == first


def test_a_filter_is_remembered_and_never_silent(opened, tmp_path):
    window, session = opened
    tools = window.review_page.table.tools
    clear = tools.findChild(QPushButton, "clear_filter")
    assert not clear.isVisible()
    session.set_filter(CandidateFilter(least_score=0.7))
    shown = len(window.review_page.table.ids())
    assert 0 < shown < 9
    assert f"{shown} of 9 shown" in tools.progress_text
    assert clear.isVisible()
    again = PreferencesStore(tmp_path / "preferences.json")
    assert CandidateFilter.from_texts(again.values.layout) == CandidateFilter(least_score=0.7)
    clear.click()
    assert not session.filter.is_on
    assert len(window.review_page.table.ids()) == 9


def test_progress_counts_to_the_end_and_leads_to_the_report(opened, qtbot):
    window, _session = opened
    tools = window.review_page.table.tools
    for decided in range(9):
        assert f"{decided} of 9 decided" in tools.progress_text
        press(window, KEY.Key_3)
    assert "All 9 decided" in tools.progress_text
    assert "Ctrl+5" in window.review_page.toast.text()
    press(window, KEY.Key_U)
    assert "Ctrl+5" in window.review_page.toast.text()
    tools.findChild(QPushButton, "all_decided").click()
    assert window.page == "report"


def test_many_are_rejected_in_one_step_that_says_which_and_one_undo_takes_it_back(opened, qtbot):
    window, session = opened
    ids = session.ordered_ids()
    scores = [session.row(i).candidate.score for i in ids]
    press(window, KEY.Key_1)  # the best one: stays as it is
    session.cursor.set_time(46.0)
    press(window, KEY.Key_M)
    mark = session.selected
    press(window, KEY.Key_B, CONTROL)
    panel = window.work.list._batch
    assert panel.isVisible()
    assert not panel.isModal()
    limit = (scores[4] + scores[5]) / 2
    panel.findChild(QDoubleSpinBox, "batch_score").setValue(limit)
    told = panel.findChild(QLabel, "batch_told").text()
    assert "4 of 9 undecided" in told  # the mark is one of them
    assert "4 × leak" in told
    assert all(session.row(i).name in told for i in ids[5:])
    steps = session.undo_stack.index()
    panel.findChild(QPushButton, "batch_reject").click()
    assert session.undo_stack.index() == steps + 1
    kept, rejected = {ids[0]: Decision(Verdict.CONFIRMED)}, dict.fromkeys(ids[5:], Decision(Verdict.REJECTED))
    assert on_disk(session) == kept | rejected
    assert session.decision(mark) == Decision()
    assert not panel.findChild(QPushButton, "batch_reject").isEnabled()  # nothing is left below
    window.review.undo()
    assert on_disk(session) == kept
    panel.close()


def test_six_rows_of_the_list_are_in_sight_on_a_small_laptop(opened, qtbot):
    window, _session = opened
    for _ in range(3):
        assert window.review_page.table.rows_in_sight >= 6
        window.next_theme()
        qtbot.wait(20)


@pytest.mark.qt_log_ignore("does not support grabbing", extend=True)
def test_a_note_used_before_is_written_again_by_key_behind_what_stands_there(opened, qtbot):
    window, session = opened
    first, second, *_ = session.ordered_ids()
    session.push(WriteNote(session, "note", first, Decision(note="wet road\nask again"), typing=1))
    session.push(WriteNote(session, "note", second, Decision(note="loud"), typing=2))
    session.select(second)
    press(window, KEY.Key_Return, SHIFT)
    menu = QApplication.activePopupWidget()
    assert [a.text() for a in menu.actions()] == ["wet road ask again"]
    QTest.keyClick(menu, KEY.Key_Return)
    assert on_disk(session)[second] == Decision(note="loud; wet road\nask again")
    window.review.undo()
    assert on_disk(session)[second] == Decision(note="loud")
