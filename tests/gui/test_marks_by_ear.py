"""Marking while listening: the moment heard, moved by key, taken back; and listening to each on arrival."""

from dataclasses import dataclass

import pytest
from kept_window import kept_fixture, window_fixture
from PySide6.QtCore import Qt
from review_window import on_disk, press, spread
from small_survey import DURATION_S, RATE_HZ, SPEED_MPS

from app.marking import REACTION_S, candidate_at
from app.player import LEAD_IN_S, TAIL_S, LoopSpan
from processing.survey import Decision, Verdict
from widgets.candidate_row import CandidateFilter

KEY, CONTROL, SHIFT = Qt.Key, Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


kept = kept_fixture(spread(5), size=(1366, 736))  # of a small laptop, less the title of the window
window = window_fixture()


@pytest.fixture
def opened(window, kept):
    return window, kept.services.session


@dataclass
class _At:
    """A playback whose loudspeaker lets out this frame."""

    position: int

    def stop(self):
        """Nothing plays."""


def heard_at(player, time_s, *, slow=1, loop=None):
    player._playback, player._looping = _At(round(time_s * RATE_HZ)), loop
    player._preferences.values.play_slow = slow
    heard = player.heard_s(REACTION_S)
    player._playback = player._looping = None
    player._preferences.values.play_slow = 1
    return heard


def test_the_moment_heard_is_a_reaction_before_the_key_and_in_slow_sound_less_of_the_recording(opened):
    player = opened[0].player
    assert heard_at(player, 20.0) == pytest.approx(20.0 - 0.5)
    assert heard_at(player, 20.0, slow=4) == pytest.approx(20.0 - 0.125)
    assert heard_at(player, 0.2) == 0.0
    loop = LoopSpan(10.0, 14.0)
    assert heard_at(player, 12.0, loop=loop) == pytest.approx(11.5)
    assert heard_at(player, 10.2, loop=loop) == pytest.approx(13.7)  # its end was heard before it began anew


def test_a_mark_in_silence_is_where_the_cursor_is(opened):
    window, session = opened
    session.cursor.set_time(33.0)
    press(window, KEY.Key_M)
    assert session.row(session.selected).candidate.time_s == 33.0
    assert session.selected in window.review_page.table.ids()


def test_a_mark_made_while_listening_stops_nothing_and_is_before_the_cursor(opened, qtbot):
    window, session = opened
    session.cursor.set_time(20.0)
    press(window, KEY.Key_Space)
    qtbot.waitUntil(lambda: session.cursor.time_s > 21.0)
    press(window, KEY.Key_M)
    mark, now_s = session.row(session.selected), session.cursor.time_s
    assert mark.manual
    assert window.player.playing
    assert now_s - 3.0 < mark.candidate.time_s <= now_s - REACTION_S + 0.2
    half_m = (mark.candidate.chainage_high95_m - mark.candidate.chainage_low95_m) / 2
    path_m, reaction_m = 1.959964 * 0.4, 1.959964 * 0.5 * SPEED_MPS
    assert half_m == pytest.approx((path_m**2 + reaction_m**2) ** 0.5, rel=1e-6)
    press(window, KEY.Key_Space, SHIFT)
    assert window.player.looping
    window.player.stop()


def test_a_mark_is_moved_by_key_keeps_its_number_and_verdict_and_nudges_are_one_undo(opened):
    window, session = opened
    session.cursor.set_time(22.0)
    press(window, KEY.Key_M)
    session.select(session.selected)
    name = session.row(session.selected).name
    press(window, KEY.Key_3)
    session.select(next(r.candidate.id for r in session.rows() if r.manual))
    low, high = session.cursor.x_range
    for _ in range(3):
        press(window, KEY.Key_Right, SHIFT | CONTROL)
    row = session.row(session.selected)
    assert row.candidate.chainage_m == pytest.approx(44.0 + 3 * (high - low) / 50)
    assert (row.name, row.decision.verdict) == (name, Verdict.UNSURE)
    assert on_disk(session) == {row.candidate.id: Decision(Verdict.UNSURE)}
    assert window.review_page.table.selected_id() == row.candidate.id
    session.cursor.set_time(24.0)
    session.select(row.candidate.id, move_cursor=False)
    press(window, KEY.Key_M, SHIFT)
    assert session.row(session.selected).candidate.time_s == 24.0
    press(window, KEY.Key_Z, CONTROL)
    assert session.row(session.selected).candidate.time_s == row.candidate.time_s
    press(window, KEY.Key_Z, CONTROL)
    assert session.row(session.selected).candidate.chainage_m == pytest.approx(44.0)
    assert list(on_disk(session).values()) == [Decision(Verdict.UNSURE)]
    press(window, KEY.Key_Y, CONTROL)
    assert session.row(session.selected).candidate.time_s == row.candidate.time_s
    press(window, KEY.Key_Z, CONTROL)
    press(window, KEY.Key_Z, CONTROL)
    press(window, KEY.Key_Z, CONTROL)
    assert not any(r.manual for r in session.rows())


def test_what_the_machine_found_is_not_moved_and_a_line_says_so(opened):
    window, session = opened
    before = session.row(session.selected)
    press(window, KEY.Key_Left, SHIFT | CONTROL)
    assert session.row(session.selected) == before
    assert window.review_page.toast.isVisible()


def test_each_candidate_is_played_on_arrival_where_that_is_wanted_and_all_that_is_heard_is_shown(opened):
    window, session = opened
    for _ in range(5):
        press(window, KEY.Key_Z)  # so close that the view is narrower than what is played
    press(window, KEY.Key_N)
    press(window, KEY.Key_A, SHIFT)
    assert window._services.preferences.values.layout["list.autoplay"] == "on"
    for key in (KEY.Key_Down, KEY.Key_1, KEY.Key_2):
        press(window, key)
        candidate, span = session.row(session.selected).candidate, window.player._looping
        half_s = candidate.width_m / 2 / SPEED_MPS
        assert span.start_s == pytest.approx(candidate.time_s - half_s - LEAD_IN_S)
        assert span.end_s == pytest.approx(candidate.time_s + half_s + TAIL_S)
        low_s, high_s = session.cursor.range_s
        assert low_s <= span.start_s + 1e-6
        assert span.end_s <= high_s + 1e-6
    assert session.filter == CandidateFilter(Verdict.NONE)
    window.player.stop()


def test_a_mark_at_either_end_of_the_run_stays_in_it(opened):
    _window, session = opened
    for time_s in (0.0, DURATION_S):
        mark = candidate_at(session.results, time_s)
        assert mark.chainage_low95_m >= 0.0
        assert mark.chainage_low95_m <= mark.chainage_m <= mark.chainage_high95_m
