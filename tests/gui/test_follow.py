"""The views follow the playback as the operator wishes, and never fight the hand that moves them meanwhile."""

from itertools import pairwise

import pytest
from PySide6.QtCore import QObject, Signal

from app.follow_control import ENTERS_AT, Follow, FollowControl
from app.settings import PreferencesStore
from widgets.time_cursor import TimeCursor
from widgets.view_tools import ViewTools

STEP_S = 0.25


class Tape(QObject):
    """Plays by moving the cursor, as the player does."""

    played_on, stopped = Signal(), Signal()
    moves_cursor = looping = False

    def __init__(self, cursor):
        super().__init__()
        self.cursor, self.playing = cursor, True

    def play(self, seconds):
        for _ in range(round(seconds / STEP_S)):
            self.moves_cursor = True
            self.cursor.set_time(self.cursor.time_s + STEP_S, reveal=False)
            self.played_on.emit()
            self.moves_cursor = False


class Page:
    def __init__(self):
        self.view_tools = ViewTools()


@pytest.fixture
def cursor(qapp):
    cursor = TimeCursor()
    cursor.set_extent(0.0, 1000.0)
    cursor.set_range(100.0, 200.0)
    cursor.set_time(150.0)
    return cursor


@pytest.fixture
def tape(cursor):
    return Tape(cursor)


@pytest.fixture
def page(qtbot):
    page = Page()
    qtbot.addWidget(page.view_tools)
    return page


@pytest.fixture
def follow(cursor, tape, page, tmp_path):
    return FollowControl(cursor, tape, page, PreferencesStore(tmp_path / "preferences.json"))


def choose(follow, mode):
    while follow.mode is not mode:
        follow.next_mode()


def part(cursor):
    low, high = cursor.range_s
    return (cursor.time_s - low) / (high - low)


def test_a_page_is_turned_when_its_end_is_reached_and_not_before(cursor, tape, follow):
    tape.play(49.75)
    assert cursor.range_s == (100.0, 200.0)
    tape.play(1.0)
    assert part(cursor) == pytest.approx(ENTERS_AT, abs=0.01)
    assert cursor.range_s[1] - cursor.range_s[0] == pytest.approx(100.0)
    low = cursor.range_s[0]
    tape.play(90.0)
    assert cursor.range_s[0] == low


def test_a_loop_that_begins_anew_turns_the_page_back(cursor, tape, follow):
    tape.play(60.0)
    tape.moves_cursor = True
    cursor.set_time(150.0, reveal=False)
    tape.played_on.emit()
    assert 0.0 <= part(cursor) <= 1.0


def test_with_the_cursor_in_the_middle_the_view_glides_and_stays_centred_at_any_zoom(cursor, tape, follow):
    choose(follow, Follow.CENTRE)
    tape.play(10.0)
    assert part(cursor) == pytest.approx(0.5, abs=0.01)
    cursor.zoom(0.5, 130.0)  # by a wheel beside the cursor
    tape.play(1.0)
    assert part(cursor) == pytest.approx(0.5, abs=0.01)
    assert not follow.paused


def test_a_loop_that_is_shown_whole_does_not_make_the_view_glide(cursor, tape, follow):
    choose(follow, Follow.CENTRE)
    tape.looping = True
    cursor.set_range(140.0, 200.0)
    tape.play(40.0)
    assert cursor.range_s == (140.0, 200.0)


def test_without_following_nothing_moves(cursor, tape, follow):
    choose(follow, Follow.NONE)
    tape.play(300.0)
    assert cursor.range_s == (100.0, 200.0)


@pytest.mark.parametrize("mode", [Follow.PAGE, Follow.CENTRE])
def test_a_hand_that_pans_away_is_not_fought_until_the_playback_comes_by(cursor, tape, follow, page, mode):
    choose(follow, mode)
    tape.play(1.0)
    cursor.pan(300.0)
    panned = cursor.range_s
    assert follow.paused
    assert "waits" in page.view_tools.follow_text
    tape.play(100.0)
    assert cursor.range_s == panned
    tape.play(panned[0] + 60.0 - cursor.time_s)  # it comes by: past the middle
    assert not follow.paused
    tape.play(60.0)
    assert cursor.range_s != panned
    assert 0.0 <= part(cursor) <= 1.0


def test_following_goes_on_without_a_jump(cursor, tape, follow):
    choose(follow, Follow.CENTRE)
    tape.play(1.0)
    cursor.pan(30.0)
    places = []
    for _ in range(400):
        tape.play(STEP_S)
        places.append(cursor.range_s[0])
    steps = [b - a for a, b in pairwise(places)]
    assert not follow.paused
    assert max(steps) < 3.0  # of a view of 100 s


def test_the_key_goes_back_to_following_before_it_changes_how(cursor, tape, follow):
    tape.play(1.0)
    cursor.pan(300.0)
    follow.next_mode()
    assert (follow.mode, follow.paused) == (Follow.PAGE, False)
    assert 0.0 <= part(cursor) <= 1.0
    follow.next_mode()
    assert follow.mode is Follow.CENTRE


def test_a_click_elsewhere_takes_following_along(cursor, tape, follow):
    tape.play(1.0)
    cursor.pan(300.0)
    cursor.set_time(sum(cursor.range_s) / 2.0)
    assert not follow.paused


def test_stopping_moves_nothing(cursor, tape, follow):
    tape.play(1.0)
    cursor.pan(300.0)
    panned = cursor.range_s
    tape.playing = False
    tape.stopped.emit()
    assert cursor.range_s == panned
    assert not follow.paused


def test_the_mode_is_remembered_and_nonsense_means_pages(cursor, tape, page, tmp_path):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    follow = FollowControl(cursor, tape, page, preferences)
    choose(follow, Follow.CENTRE)
    again = PreferencesStore(tmp_path / "preferences.json")
    assert FollowControl(cursor, tape, page, again).mode is Follow.CENTRE
    again.change(layout={"views.follow": "sideways"})
    assert FollowControl(cursor, tape, page, again).mode is Follow.PAGE
