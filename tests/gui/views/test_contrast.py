"""Colours that cannot hide a weak sound: fixed decibels, the same everywhere, and a word where they would hide it."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest

from widgets.color_maps import COLOR_MAPS
from widgets.contrast import USUAL_DB
from widgets.spectrogram_picture import Plane
from widgets.spectrogram_view import SpectrogramView

BACKGROUND, TONE, EVENT = 120, 126, 240  # −70, −67 and −10 dB
VISIBLE = 2.0  # steps of CIE lightness; two areas side by side are told apart from about one


class WeakTone:
    """Even noise with a tone 3 dB over it from 100 s on, and from 200 s for as long as told something 60 dB louder."""

    low_db, step_db = -130.0, 0.5
    start_s, end_s = 0.0, 600.0
    frequencies_hz = np.linspace(0.0, 8000.0, 65)

    def __init__(self, loud_s=60.0, shift=0):
        self.loud_s, self.shift = loud_s, shift

    def columns(self, start_s, end_s, columns, plane="max"):
        time_s = start_s + (np.arange(columns) + 0.5) * (end_s - start_s) / columns
        levels = np.full((65, columns), BACKGROUND, np.uint8)
        levels[30:36, time_s > 100.0] = TONE
        levels[:, (time_s > 200.0) & (time_s < 200.0 + self.loud_s)] = EVENT
        return (levels.astype(int) + self.shift).clip(1, 255).astype(np.uint8)


@pytest.fixture
def view(cursor, shown):
    cursor.set_track(None)
    cursor.set_extent(0.0, 600.0)
    view = shown(SpectrogramView(cursor), 1000, 300)
    view.set_frequency_scale("linear")
    yield view
    view.set_source(None)


def sharp(qtbot, view):
    qtbot.waitUntil(lambda: bool(view.grab()) and view.is_sharp)
    view.invalidate()  # not only when it is its turn
    return view.grab().toImage()


def lightness(colour):
    """CIE 1976 L* of an sRGB colour, 0 to 100."""
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in colour.getRgbF()[:3]]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return 116.0 * luminance ** (1 / 3) - 16.0 if luminance > 0.008856 else 903.3 * luminance


@pytest.mark.parametrize("name", COLOR_MAPS)
@pytest.mark.parametrize("auto", [False, True], ids=["fixed", "auto"])
def test_a_tone_of_three_decibels_is_seen_beside_something_sixty_decibels_louder(view, qtbot, name, auto):
    view.set_color_map(name)
    view.set_source(WeakTone())
    sharp(qtbot, view)
    if auto:
        assert view.auto_db_range()
    image = view.grab().toImage()
    x, y = view.pixel_of_time(400.0), view.y_of_frequency(33 / 64 * 8000.0)
    tone = lightness(image.pixelColor(round(x), round(y)))
    beside = lightness(image.pixelColor(round(view.pixel_of_time(50.0)), round(y)))
    assert abs(tone - beside) >= VISIBLE


def test_how_much_is_loud_does_not_change_the_fixed_colours_of_what_is_weak(view, qtbot):
    seen = []
    for loud_s in (0.0, 5.0, 300.0):
        view.set_source(WeakTone(loud_s))
        image = sharp(qtbot, view)
        seen.append(image.pixelColor(round(view.pixel_of_time(150.0)), round(view.y_of_frequency(4125.0))).name())
    assert len(set(seen)) == 1
    assert view.db_range == USUAL_DB


def test_auto_is_said_on_the_bar_and_one_key_goes_back_to_the_fixed_range(view, qtbot):
    view.set_source(WeakTone())
    sharp(qtbot, view)
    room = view._value_rect().toRect()

    def words():
        line = round(view._theme.metrics().height())
        return view.grab(room.adjusted(24, line, 0, 0)).toImage().copy(0, 0, room.width() - 24, line)

    fixed = words()
    view.auto_db_range()
    assert view.contrast_is_auto
    assert words() != fixed
    view.fixed_db_range()
    assert not view.contrast_is_auto
    assert view.db_range == view.fixed_range == USUAL_DB
    assert words() == fixed


def test_a_drag_of_an_end_changes_the_fixed_range_and_tells_it_once(view, qtbot):
    view.set_source(WeakTone())
    sharp(qtbot, view)
    view.auto_db_range()
    room, told = view._value_rect(), []
    view.fixed_range_chosen.connect(lambda: told.append(view.fixed_range))
    high = QPointF(room.left() + 12, view._bar.y_of(room, view.db_range[1])).toPoint()
    QTest.mousePress(view, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, high)
    for dy in (5, 15, 25):
        QTest.mouseMove(view, high + QPoint(0, dy))
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, high + QPoint(0, 25))
    assert told == [view.db_range]
    assert not view.contrast_is_auto
    assert view.fixed_range[1] != USUAL_DB[1]


def test_keys_move_either_end_within_what_there_is(view):
    view.set_source(WeakTone())
    view.move_db_range("low", -3.0)
    view.move_db_range("high", -6.0)
    assert view.fixed_range == (USUAL_DB[0] - 3.0, USUAL_DB[1] - 6.0)
    for _ in range(100):
        view.move_db_range("low", 3.0)
    assert view.fixed_range[0] < view.fixed_range[1] == USUAL_DB[1] - 6.0


def test_levels_and_their_excess_keep_ranges_of_their_own(view, qtbot):
    view.set_source(WeakTone())
    view.set_db_range(-100.0, -50.0)
    view.set_plane(Plane.EXCESS)
    view.set_db_range(-8.0, 8.0)
    view.set_plane(Plane.STEADY)
    assert view.fixed_range == (-100.0, -50.0)
    view.set_plane(Plane.EXCESS)
    assert view.fixed_range == (-8.0, 8.0)


@pytest.mark.parametrize(("shift", "hides"), [(0, False), (-80, True)])
def test_where_the_colours_hide_most_of_it_that_is_said(view, qtbot, shift, hides):
    view.set_source(WeakTone(0.0, shift))
    before = sharp(qtbot, view)
    assert (view.hidden_share > 0.5) is hides
    foot = view.plot_rect().toRect()
    foot.setTop(foot.bottom() - 30)
    colours = {before.pixelColor(x, foot.center().y()).name() for x in range(foot.left() + 5, foot.right() - 5, 2)}
    assert (len(colours) > 4) is hides  # letters, or nothing but the even background
    view.auto_db_range()
    assert view.hidden_share < 0.5
