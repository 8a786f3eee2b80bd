"""The stacked plots follow one cursor and one range, pixel by pixel.

Longer than 400 lines because all plots share these fixtures and are held to the same behaviour.
"""

import math

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QWheelEvent
from PySide6.QtTest import QTest

from processing.survey import Channel, Decision, Stretch, TiePoint, Verdict
from widgets.imu_view import ImuView
from widgets.level_view import LevelCurves, LevelView
from widgets.overview_strip import OverviewStrip
from widgets.path_view import PathView
from widgets.plot_paint import coverage, edges_of, free_box
from widgets.plot_scale import Scale, ScaleKind, hertz_text, number_text
from widgets.plot_theme import LIGHT, SUN, THEMES, VERDICT_SIGNS
from widgets.profile_view import ProfileView
from widgets.spectrogram_view import SpectrogramView

STACKED = (SpectrogramView, LevelView, ProfileView, ImuView, OverviewStrip)
ALL = (*STACKED, PathView)


def levels(track, peak_m=150.0):
    metres = np.arange(0.0, track.chainage_m[-1], 0.25)
    first = np.searchsorted(track.chainage_m, metres)
    time_s = track.time_s[first]
    level = -60.0 + 12.0 * np.exp(-(((metres - peak_m) / 4.0) ** 2))
    return LevelCurves(time_s, level, metres, np.full(len(metres), -60.0), np.full(len(metres), -55.0))


def wheel(view, place, notches, modifiers=Qt.KeyboardModifier.NoModifier):
    event = QWheelEvent(
        place,
        view.mapToGlobal(place),
        QPoint(),
        QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton,
        modifiers,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    view.wheelEvent(event)


def drag(view, start, end, modifiers=Qt.KeyboardModifier.NoModifier):
    QTest.mousePress(view, Qt.MouseButton.LeftButton, modifiers, start)
    for part in (0.3, 0.7, 1.0):
        place = start + (end - start) * part
        QTest.mouseMove(view, QPoint(round(place.x()), round(place.y())))
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, modifiers, end)


@pytest.mark.parametrize("kind", ALL)
@pytest.mark.parametrize("theme", list(THEMES.values()), ids=list(THEMES))
def test_a_view_without_data_paints_in_every_theme_and_takes_the_mouse(cursor, shown, qtbot, kind, theme):
    cursor.set_track(None)
    view = shown(kind(cursor, theme), 500, 200)
    assert view.accessibleName()
    view.set_candidates(())
    view.set_selected(None)
    view.set_not_assessed(())
    view.apply_theme(theme.scaled(1.6))
    view.grab()
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(250, 100))
    qtbot.mouseDClick(view, Qt.MouseButton.LeftButton, pos=QPoint(250, 100))
    wheel(view, QPointF(250, 100), 1)
    wheel(view, QPointF(250, 100), -1, Qt.KeyboardModifier.ControlModifier)
    view.resize(40, 20)
    view.grab()


@pytest.mark.parametrize("kind", ALL)
def test_a_track_of_one_sample_and_candidates_without_place_paint(cursor, shown, make_track, make_candidate, kind):
    track = make_track([5.0], [0.0])
    cursor.set_track(track)
    view = shown(kind(cursor), 500, 200)
    if hasattr(view, "set_track"):
        view.set_track(track)
    nowhere = make_candidate(1, 5.0, math.nan, position=(math.nan, math.nan, math.nan))
    never = make_candidate(2, math.nan, math.nan, position=(math.nan,) * 3)
    view.set_candidates((nowhere, never), {1: Decision(Verdict.UNSURE)})
    view.set_selected(2)
    view.set_not_assessed((Stretch(-100.0, 1e9, Channel.PATH, "x"), Stretch(3.0, 3.0, Channel.SOUND, "x")))
    view.grab()


@pytest.fixture
def filled(cursor, track, imu, shown, qtbot):
    """All stacked views with data, in one column."""

    def fill(kind):
        view = kind(cursor)
        if kind is LevelView:
            view.set_levels(levels(track))
        elif kind is ProfileView:
            view.set_track(track)
        elif kind is ImuView:
            with qtbot.waitSignal(view.ready):
                view.set_imu(imu, track)
        elif kind is OverviewStrip:
            view.set_level(np.arange(600.0), np.sin(np.arange(600.0)))
        return shown(view)

    return fill


@pytest.mark.parametrize("kind", STACKED)
@pytest.mark.parametrize("mode", ["time", "distance"])
def test_a_click_moves_the_cursor_to_the_moment_under_the_mouse(cursor, filled, qtbot, kind, mode):
    cursor.set_axis_mode(mode)
    view = filled(kind)
    rect = view.plot_rect()
    x = round(rect.left() + 0.75 * rect.width())
    low, high = view.x_span()
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(x, round(rect.center().y())))
    want = low + (x - rect.left()) / rect.width() * (high - low)
    assert float(cursor.x_of_time(cursor.time_s)) == pytest.approx(want, rel=1e-9)


@pytest.mark.parametrize("kind", STACKED)
def test_the_cursor_line_stands_at_the_cursors_moment(cursor, filled, kind):
    view = filled(kind)
    for time_s in (100.0, 450.0):
        cursor.set_time(time_s)
        image = view.grab().toImage()
        x, y = round(view.pixel_of_time(time_s)), round(view.plot_rect().center().y()) + 7
        near = [image.pixelColor(x + d, y) for d in (-1, 0, 1)]
        assert QColor(LIGHT.cursor) in near


def test_stacked_views_of_one_width_have_their_axes_in_line(filled):
    edges = {(v.plot_rect().left(), v.plot_rect().right()) for v in (filled(kind) for kind in STACKED)}
    assert len(edges) == 1


@pytest.mark.parametrize("kind", [LevelView, ProfileView, ImuView])
def test_dragging_pans_all_views_by_as_much_as_the_mouse_moved(cursor, filled, kind):
    view = filled(kind)
    cursor.set_range(200.0, 300.0)
    rect = view.plot_rect()
    start = QPoint(round(rect.center().x()), round(rect.center().y()))
    before = view.x_of_pixel(start.x())
    drag(view, start, start + QPoint(80, 3))
    assert view.x_of_pixel(start.x() + 80) == pytest.approx(before)
    assert cursor.range_s[1] - cursor.range_s[0] == pytest.approx(100.0)


def test_the_wheel_zooms_about_the_mouse_and_with_shift_it_pans(cursor, filled):
    view = filled(LevelView)
    place = QPointF(300.0, 100.0)
    before = view.x_of_pixel(300.0)
    wheel(view, place, 3)
    assert view.x_of_pixel(300.0) == pytest.approx(before)
    span = cursor.range_s[1] - cursor.range_s[0]
    assert span == pytest.approx(630.0 * 0.8**3)
    start = cursor.range_s[0]
    wheel(view, place, -1, Qt.KeyboardModifier.ShiftModifier)
    assert cursor.range_s[0] == pytest.approx(start + 0.1 * span)
    assert cursor.range_s[1] - cursor.range_s[0] == pytest.approx(span)


def test_shift_and_drag_selects_a_span_and_a_click_ends_it(cursor, filled, qtbot):
    view = filled(LevelView)
    drag(view, QPoint(300, 100), QPoint(500, 100), Qt.KeyboardModifier.ShiftModifier)
    assert cursor.selection_s == pytest.approx((view.time_of_pixel(300), view.time_of_pixel(500)))
    view.grab()
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(400, 100))
    assert cursor.selection_s is None


def test_a_double_click_shows_everything(cursor, filled, qtbot):
    view = filled(LevelView)
    cursor.set_range(100.0, 110.0)
    view._zoom_vertical(0.2, QPointF(300, 100))
    whole = view._whole_scale
    qtbot.mouseDClick(view, Qt.MouseButton.LeftButton, pos=QPoint(400, 100))
    assert cursor.range_s == cursor.extent_s
    assert view.y_range == (whole.low, whole.high)


def test_a_click_on_a_candidate_tells_its_number_and_leaves_the_cursor(cursor, filled, make_candidate, qtbot):
    view = filled(LevelView)
    view.set_candidates((make_candidate(7, 400.0, 200.0), make_candidate(9, 250.0, 100.0)))
    centre = view._mark_centre(view._marks.candidates[0])
    with qtbot.waitSignal(view.candidate_clicked) as told:
        qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=centre.toPoint())
    assert told.args == [7]
    assert cursor.time_s == 0.0


def test_a_candidate_sits_on_the_peak_of_the_level_in_both_units(cursor, filled, make_candidate):
    view = filled(LevelView)
    time_s = 350.0  # 150 m
    view.set_candidates((make_candidate(1, time_s, 150.0),))
    for mode in ("time", "distance"):
        cursor.set_axis_mode(mode)
        centre = view._mark_centre(view._marks.candidates[0])
        assert centre.x() == pytest.approx(view.pixel_of_time(time_s), abs=0.5)
        assert 0.0 < view.y_of(-48.0) - centre.y() < 3.0 * view.mark_radius()


def test_the_highest_pixel_of_the_level_curve_is_at_its_peak_in_both_units(cursor, filled):
    view = filled(LevelView)
    cursor.set_time(-10.0)
    for mode in ("time", "distance"):
        cursor.set_axis_mode(mode)
        image = view.grab().toImage()
        rect = view.plot_rect()
        blue = QColor(LIGHT.curve)
        rows = {}
        for x in range(int(rect.left()) + 1, int(rect.right()) - 1):
            below_legend = range(int(rect.top()) + 25, int(rect.bottom()))
            column = [y for y in below_legend if image.pixelColor(x, y) == blue]
            if column:
                rows[x] = column[0]
        top = min(rows.values())
        at = [x for x, y in rows.items() if y == top]
        assert np.mean(at) == pytest.approx(view.pixel_of_time(350.0), abs=4.0)
        assert top == pytest.approx(view.y_of(-48.0), abs=2.0)


def test_a_single_knock_shows_in_the_imu_strip_when_the_whole_run_is_visible(cursor, filled):
    view = filled(ImuView)
    cursor.set_time(-10.0)
    low, high = view._strips[0].curves[0][0].columns(cursor, view.columns())
    column = int(np.nanargmax(high))
    assert high[column] > 69.0
    assert view.plot_rect().left() + column == pytest.approx(view.pixel_of_time(123.45), abs=1.5)
    assert np.nanmin(low) > 8.0


def test_the_imu_view_tells_the_values_at_the_cursor_and_can_show_three_axes(cursor, filled):
    view = filled(ImuView)
    assert [s.name for s in view._strips] == ["force", "turn rate", "speed"]
    cursor.set_time(400.0)
    gyr = view._strips[1].curves[0][0].value_at_cursor(cursor)
    assert gyr == pytest.approx(math.degrees(6.0), rel=0.02)
    assert view._strips[2].curves[0][0].value_at_cursor(cursor) == pytest.approx(1.0)
    view.set_gyro_axes(True)
    assert len(view._strips[1].curves) == 3
    view.grab()


def test_the_overview_window_is_the_visible_range_and_dragging_it_pans(cursor, filled):
    view = filled(OverviewStrip)
    cursor.set_range(100.0, 200.0)
    window = view.window_rect()
    assert window.left() == pytest.approx(view.pixel_of_time(100.0))
    assert window.right() == pytest.approx(view.pixel_of_time(200.0))
    start = window.center().toPoint()
    drag(view, start, start + QPoint(100, 0))
    per_pixel = 630.0 / view.plot_rect().width()
    assert cursor.range_s == pytest.approx((100.0 + 100 * per_pixel, 200.0 + 100 * per_pixel))
    drag(view, QPoint(round(view.window_rect().right()), 100), QPoint(round(view.window_rect().right()) + 50, 100))
    assert cursor.range_s == pytest.approx((100.0 + 100 * per_pixel, 200.0 + 150 * per_pixel), abs=per_pixel)


def test_a_click_beside_the_overview_window_brings_it_there(cursor, filled, qtbot):
    view = filled(OverviewStrip)
    cursor.set_range(100.0, 200.0)
    x = round(view.pixel_of_time(450.0))
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(x, 120))
    assert cursor.time_s == pytest.approx(450.0, abs=1.0)
    assert cursor.range_s == pytest.approx((400.0, 500.0), abs=1.0)


def test_moving_the_cursor_repaints_no_pixmap(cursor, filled, qtbot):
    views = [filled(kind) for kind in (LevelView, ProfileView, ImuView, OverviewStrip)]
    qtbot.wait(20)
    painted = []
    for view in views:
        view._paint_data = lambda *arguments, view=view: painted.append(view)
    for step in range(20):
        cursor.set_time(100.0 + step)
        qtbot.wait(1)
    assert painted == []


def test_a_paint_error_reaches_the_crash_guard_and_leaves_the_process_alive(cursor, filled, qtbot):
    view = filled(LevelView)
    with qtbot.captureExceptions() as caught:
        view._paint_data = lambda *arguments: 1 // 0
        view.invalidate()
        view.grab()
    assert caught
    assert caught[0][0] is ZeroDivisionError
    del view._paint_data


def test_a_paint_error_of_an_item_reaches_the_crash_guard_too(cursor, filled, qtbot):
    view = filled(LevelView)
    with qtbot.captureExceptions() as caught:
        view._level_item.render = lambda: 1 // 0
        view.invalidate()
        view.grab()
    assert caught
    assert caught[0][0] is ZeroDivisionError
    del view._level_item.render


@pytest.mark.parametrize("kind", STACKED)
@pytest.mark.parametrize("visible", [True, False])
def test_the_view_box_fills_the_plot_and_shows_the_range_of_the_cursor(cursor, filled, kind, visible):
    view = filled(kind)
    view.set_x_axis_visible(visible)
    cursor.set_range(120.0, 130.0)
    view.grab()
    box = view._plot.vb
    assert box.mapRectToScene(box.rect()) == view.plot_rect()
    assert tuple(box.viewRange()[0]) == pytest.approx(view.x_span(), rel=1e-12)


def test_known_places_are_drawn_on_the_profile(cursor, filled):
    view = filled(ProfileView)
    before = view.grab().toImage()
    view.set_tie_points(
        (TiePoint("vana", 400.0, up_m=-2.0), TiePoint("off", math.nan), TiePoint("", 100.0, enabled=False))
    )
    after = view.grab().toImage()
    x = round(view.pixel_of_time(400.0))
    y = round(view.y_of(-2.0))
    assert after.pixelColor(x + 2, y) == QColor(LIGHT.tie_point)
    assert before.pixelColor(x + 2, y) != after.pixelColor(x + 2, y)


def test_what_is_not_assessed_is_hatched_where_it_concerns_the_view(cursor, filled):
    view = filled(LevelView)
    plain = view.grab().toImage()
    view.set_not_assessed((Stretch(350.0, 400.0, Channel.PATH, "x"),))
    assert view.grab().toImage() == plain
    view.set_not_assessed((Stretch(350.0, 400.0, Channel.SOUND, "x"),))
    hatched = view.grab().toImage()
    left, right = round(view.pixel_of_time(350.0)), round(view.pixel_of_time(400.0))
    differing = [
        x
        for x in range(plain.width())
        if any(plain.pixelColor(x, y) != hatched.pixelColor(x, y) for y in range(10, 200, 3))
    ]
    assert left - 1 <= min(differing) <= left + 8
    assert right - 8 <= max(differing) <= right + 1


def test_every_verdict_has_a_sign_and_a_colour_of_its_own_in_every_theme():
    assert len(set(VERDICT_SIGNS.values())) == len(Verdict)
    for theme in THEMES.values():
        assert len({theme.verdicts[v] for v in Verdict}) == len(Verdict)


def contrast(first, second):
    """WCAG 2 contrast of two colours."""

    def luminance(name):
        colour = QColor(name)
        parts = (colour.redF(), colour.greenF(), colour.blueF())
        linear = [p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    high, low = sorted((luminance(first), luminance(second)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", list(THEMES.values()), ids=list(THEMES))
def test_letters_curves_and_marks_stand_out_of_their_ground(theme):
    assert contrast(theme.text, theme.background) >= 7.0
    for colour in (theme.curve, theme.curve_second, theme.curve_third, theme.cursor, theme.accent):
        assert contrast(colour, theme.canvas) >= 3.0, colour
    for colour in theme.verdicts.values():
        assert contrast(colour, theme.canvas) >= 3.0, colour
    assert contrast(SUN.text, SUN.background) == 21.0


def test_thick_noisy_curves_are_covered_exactly():
    picture, first = coverage(np.array([1.0, 2.5, np.nan, -5.0]), np.array([3.0, 3.5, np.nan, 9.0]), 5)
    assert first == 0
    np.testing.assert_array_equal(picture[:, 0], [0, 255, 255, 0, 0])
    np.testing.assert_array_equal(picture[:, 1], [0, 0, 127, 127, 0])
    np.testing.assert_array_equal(picture[:, 2], 0)
    np.testing.assert_array_equal(picture[:, 3], 255)
    picture, first = coverage(np.array([2.25, 3.0]), np.array([2.75, 4.0]), 500)
    assert first == 2
    np.testing.assert_array_equal(picture, [[127, 0], [0, 255]])
    assert coverage(np.array([np.nan]), np.array([np.nan]), 5)[0].shape == (0, 1)


def test_names_find_a_place_that_is_free_or_none():
    within, about = QRectF(0, 0, 200, 100), QPointF(100, 50)
    taken = []
    while (box := free_box(40, 12, about, 8, [edges_of(t) for t in taken], within)) is not None:
        assert within.contains(box)
        assert not box.contains(about)
        assert not any(box.intersects(other) for other in taken)
        taken.append(box)
    assert 4 <= len(taken) <= 8


@pytest.mark.parametrize("kind", list(ScaleKind))
def test_a_scale_and_its_inverse_agree(kind):
    scale = Scale(20.0, 22_050.0, kind)
    values = np.array([20.0, 100.0, 1000.0, 22_050.0])
    np.testing.assert_allclose(scale.value(scale.fraction(values)), values, rtol=1e-12)
    assert scale.fraction(20.0) == 0.0
    assert scale.fraction(22_050.0) == 1.0
    ticks = scale.ticks(8)
    assert 3 <= len(ticks) <= 9
    assert all(20.0 <= t <= 22_050.0 for t in ticks)


def test_numbers_are_written_in_the_readers_way():
    from PySide6.QtCore import QLocale

    turkish = QLocale(QLocale.Language.Turkish)
    assert number_text(1234.5, 1, turkish) == "1234,5"
    assert number_text(-0.25, 2, QLocale.c()) == "−0.25"
    assert hertz_text(2500.0, turkish) == "2,5k"
    assert [hertz_text(f, QLocale.c()) for f in (50, 999.5, 1000, 20_000)] == ["50", "999.5", "1k", "20k"]
