import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QWheelEvent
from PySide6.QtTest import QTest

from processing.survey import Channel, Decision, Stretch, TiePoint, Track, Verdict
from widgets.path_paint import ellipse_95
from widgets.path_view import PathView
from widgets.plan_geometry import (
    PlanScale,
    ThinnedPath,
    band_outline,
    fitting,
    nearest_moment,
    visible_runs,
)
from widgets.plot_theme import LIGHT


def wheel(view, place, notches):
    view.wheelEvent(
        QWheelEvent(
            place,
            view.mapToGlobal(place),
            QPoint(),
            QPoint(0, 120 * notches),
            Qt.MouseButton.NoButton,
            Qt.KeyboardModifier.NoModifier,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
    )


def loop_track(count=6001, radius_m=50.0, turns=2.0):
    """Twice around a circle: every place is passed twice."""
    time_s = np.arange(count) / 10.0
    angle = 2 * np.pi * turns * np.arange(count) / (count - 1)
    position = np.stack((radius_m * np.sin(angle), radius_m * (1 - np.cos(angle)), 0 * angle), axis=1)
    chainage = radius_m * angle
    sigma = np.full(count, 2.0)
    quat = np.tile([1.0, 0, 0, 0], (count, 1))
    return Track(time_s, chainage, position, sigma, sigma, sigma, quat, np.ones(count), "loop")


@pytest.fixture
def view(cursor, track, shown):
    view = shown(PathView(cursor), 600, 500)
    view.set_track(track)
    return view


scales = st.builds(
    PlanScale, st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)), st.floats(0.01, 100.0), st.just((640.0, 480.0))
)


@given(scales, st.floats(0, 640), st.floats(0, 480), st.floats(0.2, 5.0))
def test_pixels_become_metres_and_the_same_pixels_again_at_any_zoom(scale, x, y, factor):
    east, north = scale.metres(x, y)
    assert scale.pixel(east, north) == pytest.approx((x, y), abs=1e-6)
    zoomed = scale.zoomed(factor, x, y)
    assert zoomed.pixel(east, north) == pytest.approx((x, y), abs=1e-6)
    assert scale.moved(5.0, -7.0).pixel(east, north) == pytest.approx((x + 5.0, y - 7.0), abs=1e-6)


def test_east_is_right_north_is_up_and_both_have_one_scale():
    scale = fitting(np.array([[0.0, 0.0], [100.0, 10.0]]), (400.0, 300.0), 20.0)
    (x0, y0), (x1, y1), (x2, y2) = (scale.pixel(e, n) for e, n in ((0, 0), (10, 0), (0, 10)))
    assert x1 > x0
    assert y1 == y0
    assert y2 < y0
    assert x2 == x0
    assert x1 - x0 == pytest.approx(y0 - y2)


def test_everything_is_in_view_at_first_and_after_resizing(view, track):
    for size in ((600, 500), (300, 700), (900, 200)):
        view.resize(*size)
        pixels = view.plan_scale.pixels(track.position_w_m)
        assert pixels.min() >= 0
        assert pixels[:, 0].max() <= size[0]
        assert pixels[:, 1].max() <= size[1]


def test_a_cursor_that_moves_before_the_plan_is_laid_out_leaves_everything_in_view(view, cursor, track):
    view.resize(20, 14)  # as a page that has not been in front yet
    cursor.set_time(track.time_s[-1])
    view.resize(500, 400)
    pixels = view.plan_scale.pixels(track.position_w_m[:, :2])
    assert np.ptp(pixels, axis=0).max() > 200
    assert pixels.min() > 0


@given(st.floats(0.001, 100.0))
def test_the_thinned_path_is_never_a_pixel_off(metres_per_pixel):
    track = loop_track()
    path = ThinnedPath.from_track(track)
    rows = path.rows_for(metres_per_pixel)
    assert rows[0] == 0
    assert rows[-1] == len(track.time_s) - 1
    drawn = np.stack([np.interp(track.time_s, path.time_s[rows], path.plane_m[rows, k]) for k in (0, 1)], axis=1)
    off = np.hypot(*(drawn - track.position_w_m[:, :2]).T)
    assert off.max() <= max(metres_per_pixel, 0.06)


def test_hours_of_path_are_drawn_from_few_points():
    path = ThinnedPath.from_track(loop_track(count=400_000, radius_m=1500.0))
    assert len(path.rows_for(20.0)) < 2000
    assert sum(len(level) for level in path.levels) < 2.1 * 400_000


def test_a_click_on_the_path_moves_the_cursor_to_that_moment(view, cursor, qtbot):
    for time_s in (100.0, 380.0, 500.0):
        place = view._cursor_pixel(time_s)
        QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=place.toPoint() + QPoint(3, -2))
        east, north, _ = cursor.position_at(time_s)
        got = cursor.position_at(cursor.time_s)
        assert math.dist((east, north), got[:2]) < 6.0 / view.plan_scale.pixels_per_m
    before = cursor.time_s
    QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(590, 490))
    assert cursor.time_s == before


def test_where_the_path_passes_twice_the_click_takes_the_pass_nearest_in_time(cursor, shown):
    track = loop_track()
    cursor.set_track(track)
    view = shown(PathView(cursor), 500, 500)
    view.set_track(track)
    place = view._cursor_pixel(100.0)
    for now, want in ((80.0, 100.0), (390.0, 400.0)):
        cursor.set_time(now)
        assert view.moment_at(place) == pytest.approx(want, abs=0.5)


def test_the_nearest_moment_lies_on_segments_too():
    pixels = np.array([[0.0, 0.0], [100.0, 0.0]])
    assert nearest_moment(np.array([10.0, 20.0]), pixels, (25.0, 5.0), 0.0, 40.0) == pytest.approx(12.5)
    assert nearest_moment(np.array([10.0, 20.0]), pixels, (25.0, 50.0), 0.0, 40.0) is None
    assert nearest_moment(np.array([10.0]), pixels[:1], (3.0, 0.0), 0.0, 40.0) == 10.0


def test_the_wheel_zooms_and_a_drag_pans_and_a_double_click_shows_everything(view, qtbot):
    whole = view.plan_scale
    place = QPointF(200.0, 300.0)
    under = whole.metres(200.0, 300.0)
    wheel(view, place, 2)
    assert view.plan_scale.metres(200.0, 300.0) == pytest.approx(under)
    assert view.plan_scale.pixels_per_m == pytest.approx(whole.pixels_per_m / 0.8**2)
    QTest.mousePress(view, Qt.MouseButton.LeftButton, pos=QPoint(200, 300))
    QTest.mouseMove(view, QPoint(230, 280))
    QTest.mouseMove(view, QPoint(260, 250))
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, pos=QPoint(260, 250))
    assert view.plan_scale.metres(260.0, 250.0) == pytest.approx(under)
    QTest.mouseDClick(view, Qt.MouseButton.LeftButton, pos=QPoint(300, 480))
    assert view.plan_scale == whole


def test_the_cursor_is_brought_into_view_when_it_leaves_it(view, cursor):
    view.centre_on(0.0, 0.0)
    for _ in range(8):
        view.zoom(2.0)
    cursor.set_time(500.0)
    place = view._cursor_pixel()
    assert 0 < place.x() < 600
    assert 0 < place.y() < 500


def test_the_view_box_counts_metres_as_the_plan_does(view):
    view.centre_on(30.0, 40.0)
    view.zoom(3.0)
    view.grab()
    box = view._plot.vb
    for pixel in (QPointF(0.0, 0.0), QPointF(123.0, 456.0)):
        place = box.mapSceneToView(pixel)
        assert (place.x(), place.y()) == pytest.approx(view.plan_scale.metres(pixel.x(), pixel.y()), abs=1e-6)


def test_a_click_on_a_leak_tells_its_number(view, cursor, make_candidate, qtbot):
    here, there = cursor.position_at(380.0), cursor.position_at(500.0)
    view.set_candidates(
        (make_candidate(3, 380.0, 180.0, position=here), make_candidate(8, 500.0, 300.0, position=there))
    )
    centre = QPointF(*view.plan_scale.pixel(*there[:2])).toPoint()
    with qtbot.waitSignal(view.candidate_clicked) as told:
        QTest.mouseClick(view, Qt.MouseButton.LeftButton, pos=centre)
    assert told.args == [8]


def test_known_places_stand_where_they_are_told_else_where_the_device_was(view, cursor):
    ties = (TiePoint("valve", 380.0), TiePoint("map", 100.0, latitude=1.0), TiePoint("never", math.nan))
    view.set_tie_points(ties, lambda tie: (7.0, 9.0) if tie.latitude is not None else None)
    pins = {pin.name: (pin.east_m, pin.north_m) for pin in view._pins.pins}
    assert pins == {"valve": cursor.position_at(380.0)[:2], "map": (7.0, 9.0)}


def test_what_is_not_assessed_is_drawn_otherwise(view, cursor):
    view.set_interval_visible(False)
    cursor.set_time(0.0)
    place = view._cursor_pixel(400.0).toPoint()

    def blueness():
        colour = view.grab().toImage().pixelColor(place)
        return colour.blue() - colour.red()

    assert blueness() > 150
    view.set_not_assessed((Stretch(380.0, 420.0, Channel.SOUND, "x"),))
    assert blueness() < 60


def test_the_band_is_as_wide_as_the_interval():
    plane = np.stack((np.arange(5.0), np.zeros(5)), axis=1)
    outline = band_outline(plane, np.arange(1.0, 6.0))
    np.testing.assert_allclose(outline[:5, 1], np.arange(1.0, 6.0))
    np.testing.assert_allclose(outline[5:, 1], -np.arange(1.0, 6.0)[::-1])


def test_a_segment_that_crosses_the_picture_with_both_ends_outside_is_drawn():
    pixels = np.array([[-500.0, 50.0], [-400.0, 50.0], [900.0, 60.0], [950.0, 500.0], [1000.0, 900.0]])
    assert visible_runs(pixels, (200.0, 100.0), 5.0) == [(1, 3)]


def test_a_closed_loop_with_everything_on_it_paints(cursor, shown, make_candidate):
    track = loop_track()
    cursor.set_track(track)
    view = shown(PathView(cursor), 400, 400)
    view.set_route(track.position_w_m[::50])
    view.set_track(track)
    cursor.set_range(100.0, 200.0)
    many = tuple(make_candidate(k, 10.0 * k, k, position=cursor.position_at(10.0 * k)) for k in range(1, 40))
    view.set_candidates(many, {k: Decision(list(Verdict)[k % 4]) for k in range(1, 40)})
    view.set_selected(5)
    view.set_tie_points((TiePoint("retrieval", 600.0), TiePoint("Şişli vanası", 300.0, enabled=False)))
    image = view.grab().toImage()
    assert image.pixelColor(view._cursor_pixel(150.0).toPoint()) != QColor(LIGHT.canvas)
    view.set_track(None)
    view.set_route(None)
    view.grab()


def test_the_ellipse_of_a_place_holds_it_in_95_of_100_cases():
    cov = np.array([[4.0, 1.5], [1.5, 1.0]])
    places = np.random.default_rng(5).multivariate_normal([0.0, 0.0], cov, 40_000)
    ellipse = ellipse_95(cov[0, 0], cov[0, 1], cov[1, 1])
    cos, sin = math.cos(ellipse.angle_rad), math.sin(ellipse.angle_rad)
    ahead = (places @ np.array([cos, sin])) / ellipse.half_axes_m[0]
    aside = (places @ np.array([-sin, cos])) / ellipse.half_axes_m[1]
    assert np.mean(ahead**2 + aside**2 <= 1.0) == pytest.approx(0.95, abs=0.004)
