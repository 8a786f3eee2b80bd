"""Two fingers zoom about themselves and move what lies between them, in every view; one finger is a mouse."""

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QEventPoint, QTouchEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from widgets.level_view import LevelView
from widgets.overview_strip import OverviewStrip
from widgets.path_view import PathView
from widgets.plan_geometry import PlanScale
from widgets.spectrogram_view import SpectrogramView

STEPS = 12


@pytest.fixture(scope="module")
def screen():
    return QTest.createTouchDevice()


def two_fingers(view, screen, start, end):
    """Let two fingers go from one pair of places to another, as a screen tells it."""
    touch = QTest.touchEvent(view, screen)
    places = [[a + (b - a) * step / STEPS for a, b in zip(start, end, strict=True)] for step in range(STEPS + 1)]
    for number, place in enumerate(places[0]):
        touch.press(number, place.toPoint(), view)
    touch.commit()
    for pair in places[1:]:
        for number, place in enumerate(pair):
            touch.move(number, place.toPoint(), view)
        touch.commit()
    for number, place in enumerate(places[-1]):
        touch.release(number, place.toPoint(), view)
    touch.commit()


def touch_down_up(view, screen, place, held_ms):
    """Tell of one finger at moments of our own: Qt's tests cannot hold one down."""
    states = ((QEvent.Type.TouchBegin, QEventPoint.State.Pressed), (QEvent.Type.TouchEnd, QEventPoint.State.Released))
    for when, (kind, state) in zip((5000, 5000 + held_ms), states, strict=True):
        point = QEventPoint(0, state, QPointF(place), QPointF(view.mapToGlobal(place)))
        event = QTouchEvent(kind, screen, Qt.KeyboardModifier.NoModifier, [point])
        event.setTimestamp(when)
        QApplication.sendEvent(view, event)


@pytest.mark.parametrize("kind", [SpectrogramView, LevelView])
def test_spreading_fingers_zoom_about_their_middle(cursor, shown, screen, kind):
    view = shown(kind(cursor), 900, 240)
    cursor.set_range(100.0, 500.0)
    y = 120.0
    before = cursor.x_range
    under = view.x_of_pixel(450.0)
    two_fingers(view, screen, (QPointF(400, y), QPointF(500, y)), (QPointF(300, y), QPointF(600, y)))
    low, high = cursor.x_range
    assert (before[1] - before[0]) / (high - low) == pytest.approx(3.0, rel=0.02)  # three times as far apart
    assert view.x_of_pixel(450.0) == pytest.approx(under, abs=1.0)


def test_fingers_that_move_together_pan(cursor, shown, screen):
    view = shown(LevelView(cursor), 900, 240)
    cursor.set_range(100.0, 300.0)
    before = cursor.x_range
    two_fingers(view, screen, (QPointF(300, 100), QPointF(420, 100)), (QPointF(500, 100), QPointF(620, 100)))
    low, high = cursor.x_range
    assert high - low == pytest.approx(before[1] - before[0], rel=0.02)
    moved = (before[0] - low) / (high - low) * view.plot_rect().width()
    assert moved == pytest.approx(200.0, abs=2.0)


def test_what_the_first_finger_began_to_drag_is_no_drag_any_more(cursor, shown, screen):
    view = shown(LevelView(cursor), 900, 240)
    cursor.set_time(200.0)
    two_fingers(view, screen, (QPointF(300, 100), QPointF(420, 100)), (QPointF(200, 100), QPointF(520, 100)))
    assert cursor.time_s == 200.0  # the release was no click
    assert view._drag is None


def test_in_the_overview_the_window_goes_with_the_fingers(cursor, shown, screen):
    view = shown(OverviewStrip(cursor), 900, 100)
    cursor.set_range(200.0, 260.0)
    before = cursor.x_range
    two_fingers(view, screen, (QPointF(300, 50), QPointF(420, 50)), (QPointF(400, 50), QPointF(520, 50)))
    assert cursor.x_range[0] > before[0]


def test_the_plan_zooms_and_pans_under_two_fingers(cursor, track, shown, screen):
    view = shown(PathView(cursor), 500, 500)
    view.set_track(track)
    before: PlanScale = view.plan_scale
    under = before.metres(250.0, 250.0)
    two_fingers(view, screen, (QPointF(200, 250), QPointF(300, 250)), (QPointF(120, 250), QPointF(380, 250)))
    assert view.plan_scale.pixels_per_m / before.pixels_per_m == pytest.approx(2.6, rel=0.02)
    assert view.plan_scale.metres(250.0, 250.0) == pytest.approx(under, abs=1.0 / before.pixels_per_m)
    assert not view.fitted


def test_one_finger_drags_as_a_mouse(cursor, shown, screen):
    view = shown(LevelView(cursor), 900, 240)
    cursor.set_range(100.0, 300.0)
    before = cursor.x_range
    touch = QTest.touchEvent(view.window(), screen)
    for step in range(STEPS):
        place = QPoint(400 + 10 * step, 100)
        (touch.press if step == 0 else touch.move)(0, place, view.window())
        touch.commit()
    touch.release(0, QPoint(400 + 10 * STEPS, 100), view.window())
    touch.commit()
    assert cursor.x_range[0] < before[0]


@pytest.mark.parametrize("kind", [SpectrogramView, PathView])
def test_a_finger_that_stays_opens_the_menu_and_a_tap_is_a_click(cursor, track, shown, screen, qtbot, kind):
    view = shown(kind(cursor), 500, 300)
    if kind is PathView:
        view.set_track(track)
    view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
    asked = []
    view.customContextMenuRequested.connect(asked.append)
    place = (view.pixel_of_moment(400.0) if kind is PathView else QPointF(view.pixel_of_time(400.0), 120)).toPoint()
    for held_ms, menus in ((50, 0), (700, 1)):
        touch_down_up(view, screen, place, held_ms)
        assert len(asked) == menus
    assert cursor.time_s == pytest.approx(400.0, abs=3.0)
    assert asked == [place]


@pytest.mark.parametrize("kind", [LevelView, PathView])
def test_the_wheel_with_shift_pans_in_every_view_and_without_it_zooms(cursor, track, shown, kind):
    view = shown(kind(cursor), 600, 300)
    if kind is PathView:
        view.set_track(track)
    cursor.set_range(100.0, 300.0)

    def state():
        scale = view.plan_scale if kind is PathView else None
        low, high = cursor.x_range
        return (scale.pixels_per_m, scale.centre_m) if scale is not None else (1.0 / (high - low), low)

    def turn(modifiers):
        place, none = QPointF(300, 150), Qt.MouseButton.NoButton
        phase = Qt.ScrollPhase.NoScrollPhase
        at = view.mapToGlobal(place)
        view.wheelEvent(QWheelEvent(place, at, QPoint(), QPoint(0, 120), none, modifiers, phase, False))

    size, place = state()
    turn(Qt.KeyboardModifier.ShiftModifier)
    assert state()[0] == pytest.approx(size)
    assert state()[1] != place
    turn(Qt.KeyboardModifier.NoModifier)
    assert state()[0] > size
