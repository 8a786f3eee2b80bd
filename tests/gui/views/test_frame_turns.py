import numpy as np
import pytest
from PySide6.QtCore import QObject

from widgets.frame_turns import FrameTurns
from widgets.level_view import LevelCurves, LevelView


class View(QObject):
    """Counts how often it was asked to come."""

    def __init__(self):
        super().__init__()
        self.asked = 0

    def refresh(self):
        self.asked += 1


@pytest.fixture
def turns(qapp):
    return FrameTurns(budget_ms=5.0)


def frame(turns, views, cost_ms):
    """Let every view come, as a frame does; return who painted anew."""
    painted = []
    for view in views:
        if turns.may_paint(view):
            turns.took(view, cost_ms)
            painted.append(view)
    return painted


def test_views_that_fit_into_the_budget_all_paint_at_once(turns):
    views = [View() for _ in range(4)]
    frame(turns, views, 1.0)
    turns._end()
    assert frame(turns, views, 1.0) == views


def test_dear_views_take_turns_and_none_is_forgotten_while_the_range_moves_on(turns):
    views = [View() for _ in range(4)]
    painted = []
    for _ in range(12):
        painted += frame(turns, views, 8.0)
        turns._end()
    assert len(painted) == 12  # one a frame
    assert all(painted.count(view) == 3 for view in views)


def test_who_waits_is_asked_again_until_it_has_come(turns, qtbot):
    first, second = View(), View()
    turns.took(first, 8.0)
    assert not turns.may_paint(second)
    qtbot.waitUntil(lambda: second.asked > 0)
    assert turns.may_paint(second)
    turns.took(second, 8.0)
    assert turns.waiting == 0


def test_a_view_that_is_never_painted_does_not_keep_the_others_waiting(turns, qtbot):
    hidden, seen = View(), View()
    turns.took(seen, 8.0)
    turns.may_paint(hidden)
    qtbot.waitUntil(lambda: turns.waiting == 0)
    assert turns.may_paint(seen)


def picture_of(view):
    image = view.grab().toImage()
    rect = view.plot_rect().toRect().adjusted(2, 2, -2, -2)
    image = image.copy(rect).convertToFormat(image.Format.Format_RGB32)
    return np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.width(), 4)[:, :, :3].astype(int)


def test_a_picture_laid_elsewhere_shows_what_the_new_one_will_show(cursor, shown):
    view = shown(LevelView(cursor), 900, 240)
    time_s = np.arange(0.0, 600.0, 0.5)
    step = np.where(time_s < 300.0, -80.0, -60.0)
    view.set_levels(LevelCurves(time_s, step))
    cursor.set_time(-10.0)
    cursor.set_range(200.0, 400.0)
    picture_of(view)
    cursor.turns.may_paint = lambda view: False
    cursor.set_range(220.0, 420.0)
    moved = picture_of(view)
    del cursor.turns.may_paint
    view.invalidate()
    anew = picture_of(view)
    width = moved.shape[1]
    both = slice(round(0.2 * width), round(0.85 * width))  # the last tenth was not in sight before; the legend stays
    differs = (np.abs(moved[40:, both] - anew[40:, both]).max(axis=2) > 60).mean()
    shifted_by_nothing = (
        np.abs(moved[40:, both] - np.roll(anew, width // 10, axis=1)[40:, both]).max(axis=2) > 60
    ).mean()
    assert differs < 0.25 * shifted_by_nothing


def test_once_the_range_rests_every_view_has_been_painted_anew(cursor, shown, qtbot):
    time_s = np.arange(0.0, 600.0, 0.5)
    views = [shown(LevelView(cursor), 900, 200) for _ in range(3)]
    for view in views:
        view.set_levels(LevelCurves(time_s, np.sin(time_s)))
    for k in range(5):
        cursor.set_range(100.0 + k, 300.0 + k)
        qtbot.wait(1)
    qtbot.waitUntil(lambda: all(view._kept.x_span == cursor.x_range for view in views))
