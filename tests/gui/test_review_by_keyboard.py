"""The whole review with the keyboard alone: list, views and disk agree after each key."""

from dataclasses import replace
from itertools import pairwise

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent, QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPlainTextEdit, QTextBrowser
from small_survey import RATE_HZ, SPEED_MPS, make_folder, make_results

from app import actions
from app.actions import ACTIONS
from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.storage.folder import SurveyFolder
from processing.storage.review import replay
from processing.survey import Decision, LeakClass, Verdict
from widgets.time_axis import AxisMode

KEY, MODIFIER = Qt.Key, Qt.KeyboardModifier
LETTERS = "ABCDEFGHJKLMNOPRSTUVYZXWQ"  # without I, whose dotted twin a Turkish keyboard has


@pytest.fixture
def sinks():
    return []


@pytest.fixture
def services(qapp, tmp_path, sinks):
    def make_sink(_rate_hz):
        sinks.append(CountingSink())
        return sinks[-1]

    services = Services(
        SurveySession(), Jobs(), PreferencesStore(tmp_path / "preferences.json"), None, make_sink, lambda: None
    )
    services.session.open(make_folder(tmp_path))
    services.session.set_results(make_results(services.session.folder))
    yield services
    services.jobs.stop_all()
    services.session.close()


@pytest.fixture
def window(qtbot, services):
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    window.show_page("leaks")
    window.show()
    qtbot.waitUntil(lambda: not services.jobs.running)
    window.review_page.focus_views()
    yield window
    window.close()
    window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


@pytest.fixture
def session(services):
    return services.session


def press(window, key, modifier=MODIFIER.NoModifier):
    """Press a key where the keyboard is; afterwards list, panel and disk must agree."""
    QTest.keyClick(QApplication.focusWidget() or window, key, modifier)
    agree(window)


def agree(window):
    session = window._session
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        stored = other.review.decisions(other.review.latest_run())
        assert replay(other.review.decision_log()).items() >= stored.items()
    assert {k: v for k, v in session.decisions.items() if v != Decision()} == stored
    table = window.review_page.table
    assert {r.candidate.id: r.decision for r in table.model.rows if r.decision != Decision()} == stored
    assert table.selected_id() == session.selected
    return stored


def test_one_key_confirms_and_goes_on_until_nothing_is_undecided(window, session):
    ids = session.ordered_ids()
    for key, verdict in ((KEY.Key_1, Verdict.CONFIRMED), (KEY.Key_2, Verdict.REJECTED), (KEY.Key_3, Verdict.UNSURE)):
        at = session.selected
        press(window, key)
        assert session.decision(at).verdict is verdict
    assert session.selected == ids[3]
    press(window, KEY.Key_1)
    assert [session.decision(i).verdict for i in ids] == [
        Verdict.CONFIRMED,
        Verdict.REJECTED,
        Verdict.UNSURE,
        Verdict.CONFIRMED,
    ]
    assert session.selected == ids[3]  # the last one stays: there is nowhere to go


def test_undo_and_redo_by_key_bring_verdict_and_selection_back(window, session):
    ids = session.ordered_ids()
    for _ in ids:
        press(window, KEY.Key_2)
    for expected in reversed(ids):
        press(window, KEY.Key_Z, MODIFIER.ControlModifier)
        assert session.selected == expected
        assert session.decision(expected).verdict is Verdict.NONE
    press(window, KEY.Key_Y, MODIFIER.ControlModifier)
    assert session.decision(ids[0]).verdict is Verdict.REJECTED
    assert session.selected == ids[1]


def test_zero_takes_the_verdict_away_and_stays(window, session):
    first = session.selected
    press(window, KEY.Key_1)
    press(window, KEY.Key_Up)
    assert session.selected == first
    press(window, KEY.Key_0)
    assert session.selected == first
    assert session.decision(first).verdict is Verdict.NONE


def test_arrows_move_in_the_list_and_bring_the_cursor_along(window, session):
    ids = session.ordered_ids()
    for expected in (ids[1], ids[2], ids[3], ids[3]):
        press(window, KEY.Key_Down)
        assert session.selected == expected
        assert session.cursor.time_s == session.row(expected).candidate.time_s


def test_u_skips_what_is_decided(window, session):
    ids = session.ordered_ids()
    session.select(ids[1])
    press(window, KEY.Key_1)
    session.select(ids[0])
    press(window, KEY.Key_U)
    assert session.selected == ids[2]


def test_a_note_is_typed_with_all_letters_and_digits_and_changes_no_verdict(window, session, qtbot):
    first = session.selected
    press(window, KEY.Key_Return)
    typed = "1 2 3 0 mug UFG, 12.5 m "
    QTest.keyClicks(QApplication.focusWidget(), typed)
    QApplication.focusWidget().insertPlainText("ıİşğ")  # QTest knows only ASCII keys
    note = f"{typed}ıİşğ"
    qtbot.waitUntil(lambda: session.decision(first).note == note)
    assert agree(window)[first] == Decision(note=note)
    press(window, KEY.Key_Return)
    assert not isinstance(QApplication.focusWidget(), QPlainTextEdit)
    press(window, KEY.Key_1)
    assert session.decision(first) == Decision(Verdict.CONFIRMED, None, note)


def test_a_note_that_is_left_by_a_page_change_is_on_disk(window, session):
    first = session.selected
    press(window, KEY.Key_Return)
    QTest.keyClicks(QApplication.focusWidget(), "half a no")
    press(window, KEY.Key_5, MODIFIER.ControlModifier)
    assert window.page == "report"
    assert agree(window)[first].note == "half a no"
    assert "half a no" in window.report_panel.plain_text()


def test_closing_the_window_saves_what_is_being_typed(window, session):
    first = session.selected
    press(window, KEY.Key_Return)
    QTest.keyClicks(QApplication.focusWidget(), "quick")
    window.close()
    assert agree(window)[first].note == "quick"


def test_undoing_a_note_takes_back_what_was_typed_in_one_go(window, session, qtbot):
    first = session.selected
    press(window, KEY.Key_Return)
    QTest.keyClicks(QApplication.focusWidget(), "one")
    qtbot.waitUntil(lambda: session.decision(first).note == "one")
    QTest.keyClicks(QApplication.focusWidget(), " two")
    press(window, KEY.Key_Return)
    assert session.decision(first).note == "one two"
    press(window, KEY.Key_Z, MODIFIER.ControlModifier)
    assert session.decision(first).note == ""
    assert window.review_page.decision._note.toPlainText() == ""


def test_m_marks_a_leak_at_the_cursor_and_undo_takes_it_away(window, session):
    session.cursor.set_time(25.0)
    press(window, KEY.Key_M)
    row = session.row(session.selected)
    assert row.manual
    assert row.candidate.chainage_m == pytest.approx(25.0 * SPEED_MPS)
    assert row.candidate.chainage_low95_m < 50.0 < row.candidate.chainage_high95_m
    press(window, KEY.Key_1)
    assert session.decision(row.candidate.id).verdict is Verdict.CONFIRMED
    press(window, KEY.Key_Z, MODIFIER.ControlModifier)
    press(window, KEY.Key_Z, MODIFIER.ControlModifier)
    assert session.row(row.candidate.id) is None


@pytest.mark.qt_log_ignore("does not support grabbing", extend=True)
def test_a_class_is_chosen_by_key(window, session, qtbot):
    first = session.selected
    press(window, KEY.Key_C)
    assert QApplication.activePopupWidget() is not None
    view = QApplication.focusWidget()
    QTest.keyClick(view, KEY.Key_Down)
    QTest.keyClick(view, KEY.Key_Down)
    QTest.keyClick(view, KEY.Key_Return)
    qtbot.waitUntil(lambda: session.decision(first).leak_class is not None)
    assert agree(window)[first].leak_class is LeakClass.VALVE


def test_steps_zoom_and_axis_by_key(window, session):
    cursor = session.cursor
    cursor.set_time(20.0)
    press(window, KEY.Key_Right, MODIFIER.ShiftModifier)
    assert cursor.time_s == pytest.approx(21.0)
    press(window, KEY.Key_Left, MODIFIER.ControlModifier)
    assert cursor.time_s == pytest.approx(11.0)
    low, high = cursor.x_range
    press(window, KEY.Key_Right)
    assert cursor.chainage_m == pytest.approx(11.0 * SPEED_MPS + (high - low) / 50)
    press(window, KEY.Key_Z)
    assert cursor.x_range[1] - cursor.x_range[0] == pytest.approx((high - low) / 2)
    press(window, KEY.Key_F)
    assert cursor.x_range == (low, high)
    press(window, KEY.Key_D)
    assert cursor.axis_mode is AxisMode.TIME


def test_the_selection_follows_a_cursor_that_is_put_on_a_candidate(window, session):
    last = session.ordered_ids()[-1]
    session.cursor.set_time(session.row(last).candidate.time_s + 0.2)
    assert session.selected == last
    agree(window)
    session.cursor.set_time(48.0)
    assert session.selected == last  # nothing is there: what was selected stays


def test_space_plays_from_the_cursor_and_the_selection_stays_under_the_finger(window, session, sinks, qtbot):
    first = session.selected
    session.cursor.set_time(session.row(first).candidate.time_s - 0.5)
    before = session.cursor.time_s
    press(window, KEY.Key_Space)
    assert window.player.playing
    qtbot.waitUntil(lambda: session.cursor.time_s > before + 0.5)
    press(window, KEY.Key_Space)
    assert not window.player.playing
    assert sinks[-1].closed
    assert session.selected == first


def test_shift_space_loops_the_candidate_with_its_lead_in(window, session, sinks, qtbot):
    candidate = session.row(session.selected).candidate
    times = []
    session.cursor.moved.connect(times.append)
    press(window, KEY.Key_Space, MODIFIER.ShiftModifier)
    qtbot.waitUntil(lambda: len(times) > 20 and any(b < a for a, b in pairwise(times)), timeout=10_000)
    assert window.player.looping
    span = window.player._playback._stretch
    assert span.start / RATE_HZ == span.loop_start / RATE_HZ == pytest.approx(candidate.time_s - 2.5)  # half + lead-in
    assert min(times) >= candidate.time_s - 2.5
    press(window, KEY.Key_1)  # the verdict moves on, and so does the loop
    assert window.player.looping
    assert session.selected != candidate.id
    press(window, KEY.Key_Space, MODIFIER.ShiftModifier)
    assert not window.player.playing
    assert all(sink.closed for sink in sinks)


def test_without_a_sound_card_playing_is_off_with_a_hint(window, session):
    window.player.set_unavailable("no card")
    press(window, KEY.Key_Space)
    assert not window.player.playing
    assert window.review_page.playback._hint.text()
    assert "no card" in window.review_page.playback._hint.toolTip()
    assert not window.review_page.playback._play.isEnabled()


def test_a_refused_verdict_is_told_and_nothing_moves(window, session):
    path, results, first = session.folder.path, session.results, session.selected
    session.close()
    session.open(SurveyFolder.open(path, read_only=True))
    session.set_results(results)
    window.show_page("leaks")
    press(window, KEY.Key_1)
    assert [code.value for code in window.boxes.told] == ["survey_read_only"]
    assert session.selected == first


def test_the_data_page_uses_its_keys_itself(window, session):
    press(window, KEY.Key_1, MODIFIER.ControlModifier)
    assert window.page == "data"
    for name in ("confirm", "play", "next", "mark"):
        assert not window.actions_by_id[name].isEnabled()


def test_a_form_edit_is_saved_and_undone(window, session):
    press(window, KEY.Key_1, MODIFIER.ControlModifier)
    survey = replace(session.survey, pipe=replace(session.survey.pipe, length_m=99.0))
    window.data_page.form.survey_changed.emit(survey)
    assert session.folder.read_survey().pipe.length_m == 99.0
    window.review.undo()
    assert session.folder.read_survey().pipe.length_m is None


def test_a_theme_key_works_blind_and_is_remembered(window, services):
    press(window, KEY.Key_F9)
    assert services.preferences.values.theme == "sun"
    press(window, KEY.Key_F9)
    press(window, KEY.Key_F9)
    assert services.preferences.values.theme == "light"


# --- the table of actions ---


def test_no_key_is_used_twice():
    keys = [key for row in ACTIONS for key in row.keys]
    assert len(keys) == len(set(keys))
    assert len({row.id for row in ACTIONS}) == len(ACTIONS)


def test_every_key_can_be_typed_on_a_turkish_keyboard_without_altgr():
    named = {"Space", "Return", "Enter", "Up", "Down", "Left", "Right", "Home", "PgUp", "PgDown"}
    named |= {f"F{n}" for n in range(1, 13)} | set("0123456789") | set(LETTERS)
    for row in ACTIONS:
        for key in row.keys:
            *modifiers, plain = key.split("+")
            assert plain in named, row.id
            assert set(modifiers) <= {"Ctrl", "Shift"}, row.id  # AltGr is Ctrl and Alt
            assert not (plain.isdigit() and "Shift" in modifiers), row.id  # that is a sign, another on each keyboard
            assert not QKeySequence(key).isEmpty()


def test_every_action_has_its_handler_its_menu_and_its_words(window):
    menus = {action for menu in window.menuBar().actions() for action in menu.menu().actions()}
    for row in ACTIONS:
        assert callable(actions.resolve(window, row.handler))
        assert window.actions_by_id[row.id] in menus
        assert row.text
        assert row.tip


def test_the_key_sheet_lists_every_key(window):
    window.help.show_keys()
    shown = window.help.shown.findChild(QTextBrowser).toPlainText()
    for row in ACTIONS:
        if row.keys:
            assert actions.shown_keys(row) in shown
    window.help.shown.close()


def test_plain_keys_rest_while_a_text_field_has_the_focus(window):
    press(window, KEY.Key_Return)
    confirm, undo = window.actions_by_id["confirm"], window.actions_by_id["keys"]
    assert confirm.shortcuts() == []
    assert undo.shortcuts() == [QKeySequence("F2")]
    press(window, KEY.Key_Escape)
    assert confirm.shortcuts() == [QKeySequence("1")]


def test_a_dropped_folder_is_opened(window, services, qtbot, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr(window.files, "open_path", lambda path, **_: opened.append(path))
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(tmp_path))])
    event = QDropEvent(QPointF(10, 10), Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, MODIFIER.NoModifier)
    window.dropEvent(event)
    assert event.isAccepted()
    qtbot.waitUntil(lambda: opened == [tmp_path])


def test_the_window_fits_a_small_laptop(window):
    for page in ("leaks", "path", "sound", "data", "report"):
        window.show_page(page)
        size = window.minimumSizeHint()
        assert size.width() <= 1366
        assert size.height() <= 680  # 768 less the title and the task bar


def test_a_recording_that_cannot_be_read_ends_the_playback_with_a_word(window, session, qtbot):
    for part in session.results.recording.audio.parts:
        part.path.unlink()
    session.cursor.set_time(5.0)
    press(window, KEY.Key_Space)
    qtbot.waitUntil(lambda: not window.player.playing)
    assert window.notices.told.isVisible()
    assert "audio.wav" in window.notices.told.text()
    assert window.review_page.playback._play.isEnabled()
