"""One ruler over all views: by keys with the cursor, by a drag in any of them, and drawn in every one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest

from widgets.imu_view import ImuView
from widgets.level_view import LevelCurves, LevelView
from widgets.overview_strip import OverviewStrip
from widgets.path_view import PathView
from widgets.plan_geometry import PlanScale, ThinnedPath, way_between
from widgets.profile_view import ProfileView
from widgets.ruler import Ruler
from widgets.spectrogram_view import SpectrogramView

DRAGGED = (SpectrogramView, LevelView, ProfileView, ImuView)
ALL = (*DRAGGED, OverviewStrip, PathView)
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def drag(view, *places):
    points = [place.toPoint() for place in places]
    QTest.mousePress(view, LEFT, NONE, points[0])
    for point in points[1:]:
        QTest.mouseMove(view, point)
    QTest.mouseRelease(view, LEFT, NONE, points[-1])


def test_the_key_begins_ends_and_removes_and_the_cursor_moves_the_live_end(cursor):
    ruler = cursor.ruler
    cursor.set_time(50.0)
    ruler.press(cursor.time_s)
    cursor.set_time(80.0)
    assert (ruler.ends_s, ruler.live) == ((50.0, 80.0), True)
    ruler.press(cursor.time_s)
    cursor.set_time(300.0)
    assert (ruler.ends_s, ruler.live) == ((50.0, 80.0), False)
    ruler.press(cursor.time_s)
    assert ruler.ends_s is None


def test_the_other_end_can_be_moved_too(cursor):
    ruler = cursor.ruler
    ruler.set_ends(50.0, 80.0)
    assert ruler.take_other_end() == 50.0
    cursor.set_time(40.0)
    assert ruler.ends_s == (80.0, 40.0)


def test_a_ruler_without_length_is_removed_and_another_survey_takes_it_away(cursor):
    cursor.ruler.press(10.0)
    cursor.ruler.press(10.0)
    assert cursor.ruler.ends_s is None
    cursor.ruler.set_ends(10.0, 20.0)
    cursor.set_extent(0.0, 5.0)
    assert cursor.ruler.ends_s is None


@settings(max_examples=40)
@given(st.lists(st.tuples(st.sampled_from(["press", "follow", "set", "other", "remove"]), st.floats()), max_size=12))
def test_whatever_is_done_its_ends_are_moments(steps):
    ruler = Ruler()
    for what, time_s in steps:
        if what == "set":
            ruler.set_ends(time_s, 1.0)
        elif what == "other":
            ruler.take_other_end()
        elif what == "remove":
            ruler.remove()
        else:
            getattr(ruler, what)(time_s)
        assert ruler.ends_s is None or np.all(np.isfinite(ruler.ends_s))


@pytest.mark.parametrize("kind", ALL)
def test_every_view_draws_it_from_end_to_end_and_takes_it_away(cursor, track, shown, kind):
    view = shown(kind(cursor), 700, 300)
    if kind is PathView:
        view.set_track(track)
    before = view.grab().toImage()
    cursor.ruler.label = "10.0 ± 0.5 m"
    cursor.ruler.set_ends(320.0, 500.0)
    image = view.grab().toImage()
    if kind is PathView:
        inside, outside = (view.pixel_of_moment(t).toPoint() for t in (400.0, 150.0))
    else:
        y = round(view.plot_rect().top() + 0.8 * view.plot_rect().height())  # clear of the line with its arrows
        inside, outside = (QPoint(round(view.pixel_of_time(t)), y) for t in (400.0, 150.0))
    assert image.pixelColor(inside) != before.pixelColor(inside)
    assert image.pixelColor(outside) == before.pixelColor(outside)
    cursor.ruler.remove()
    assert view.grab().toImage() == before


@pytest.mark.parametrize("kind", DRAGGED)
def test_with_its_tool_a_drag_measures_and_without_it_pans(cursor, shown, kind):
    view = shown(kind(cursor), 700, 240)
    cursor.set_range(100.0, 500.0)
    y = view.plot_rect().center().y()
    from_place, to_place = QPointF(200, y), QPointF(400, y)
    cursor.ruler.set_tool(True)
    wanted = [view.time_of_pixel(x) for x in (200, 400)]
    before = cursor.range_s
    drag(view, from_place, QPointF(300, y), to_place)
    assert cursor.ruler.ends_s == pytest.approx(wanted)
    assert cursor.range_s == before
    cursor.ruler.remove()
    cursor.ruler.set_tool(False)
    drag(view, from_place, QPointF(300, y), to_place)
    assert cursor.ruler.ends_s is None
    assert cursor.range_s != before


def test_an_end_is_taken_hold_of_within_a_fingers_breadth(cursor, shown):
    view = shown(LevelView(cursor), 700, 240)
    y = view.plot_rect().center().y()
    cursor.ruler.set_ends(view.time_of_pixel(200), view.time_of_pixel(400))
    drag(view, QPointF(410, y), QPointF(450, y), QPointF(500, y))
    first, second = (view.pixel_of_time(t) for t in cursor.ruler.ends_s)
    assert (first, second) == (pytest.approx(200), pytest.approx(500, abs=1))


def test_a_drag_on_the_plan_measures_along_the_path(cursor, track, shown):
    view = shown(PathView(cursor), 500, 500)
    view.set_track(track)
    cursor.ruler.set_tool(True)
    start, end = (view.pixel_of_moment(t) for t in (100.0, 500.0))
    drag(view, start, 0.5 * (start + end), end + QPointF(30, -30))  # beside the path: its nearest place counts
    first_s, second_s = cursor.ruler.ends_s
    assert cursor.chainage_at(first_s) == pytest.approx(cursor.chainage_at(100.0), abs=1.5)
    assert second_s > 400.0
    moved = view.pixel_of_moment(second_s)
    drag(view, moved, 0.5 * (start + end), start + QPointF(60, -60))
    assert cursor.ruler.ends_s[0] == first_s
    assert cursor.ruler.ends_s[1] < second_s


def test_a_ruler_on_the_plan_hides_no_leak(cursor, track, shown, make_candidate):
    view = shown(PathView(cursor), 500, 500)
    view.set_track(track)
    view.set_candidates([make_candidate(1, 400.0, cursor.chainage_at(400.0), position=cursor.position_at(400.0))])
    mark = view.pixel_of_moment(400.0).toPoint()
    before = view.grab().toImage().pixelColor(mark)
    cursor.ruler.set_ends(320.0, 500.0)
    assert view.grab().toImage().pixelColor(mark) == before


@settings(max_examples=40)
@given(st.floats(0.0, 600.0), st.floats(0.0, 600.0))
def test_the_way_on_the_plan_is_as_long_as_the_ruler(first_s, second_s):
    time_s = np.arange(0.0, 600.5, 0.5)
    angle = time_s / 120.0
    plane = np.column_stack([100.0 * np.sin(angle), 100.0 * np.cos(angle), 0.0 * angle])
    path = ThinnedPath(time_s, plane[:, :2], (np.arange(len(time_s)),))
    way = way_between(path, PlanScale((0.0, 0.0), 2.0, (500.0, 500.0)), (first_s, second_s))
    length_m = np.sum(np.hypot(*np.diff(way, axis=0).T)) / 2.0
    assert length_m == pytest.approx(100.0 * abs(second_s - first_s) / 120.0, rel=1e-3, abs=1e-6)


def test_the_level_at_a_moment_is_that_of_its_metres(cursor, track, shown):
    view = shown(LevelView(cursor), 500, 200)
    assert view.level_at(100.0) is None
    metres = np.arange(0.0, 400.0, 0.5)
    at = track.time_s[np.searchsorted(track.chainage_m, metres)]
    view.set_levels(LevelCurves(at, -60.0 + 0.1 * metres, metres))
    assert view.level_at(100.0) == pytest.approx(-60.0 + 0.1 * cursor.chainage_at(100.0), abs=0.06)
