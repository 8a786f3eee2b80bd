import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest

from widgets.band_handles import GRIP_HEIGHT, BandHandles
from widgets.level_view import LevelView
from widgets.sound_selection import SoundSelection, measure
from widgets.spectrogram_view import SpectrogramView


class KnownTiles:
    """600 s in tenths, 81 bins to 8 kHz: -100 dB everywhere, -80 dB from 100 to 110 s between 2 and 4 kHz."""

    low_db, step_db, start_s, end_s, hop_s = -130.0, 0.5, 0.0, 600.0, 0.1

    def __init__(self):
        self.frequencies_hz = np.linspace(0.0, 8000.0, 81)
        self.levels = np.full((81, 6000), 60, np.uint8)
        self.levels[20:41, 1000:1100] = 100

    def columns(self, start_s, end_s, columns, plane="max"):
        middles = start_s + (np.arange(columns) + 0.5) * (end_s - start_s) / columns
        index = np.floor(middles / self.hop_s).astype(int)
        inside = (index >= 0) & (index < 6000)
        return np.where(inside, self.levels[:, index.clip(0, 5999)], 0).astype(np.uint8)


@pytest.fixture
def view(cursor, shown):
    view = shown(SpectrogramView(cursor), 1000, 300)
    view.set_frequency_scale("linear")
    view.set_source(KnownTiles())
    yield view
    view.set_source(None)


def place_of(view, time_s, hz):
    return QPoint(round(view.pixel_of_time(time_s)), round(view.y_of_frequency(hz)))


def drag(view, start, end, modifiers=Qt.KeyboardModifier.NoModifier):
    QTest.mousePress(view, Qt.MouseButton.LeftButton, modifiers, start)
    for part in (0.4, 1.0):
        QTest.mouseMove(view, start + QPoint(round(part * (end - start).x()), round(part * (end - start).y())))
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, modifiers, end)


@pytest.mark.parametrize("by_tool", [False, True])
def test_a_rectangle_is_selected_with_shift_or_with_the_tool_and_told_when_it_is_let_go(cursor, view, qtbot, by_tool):
    cursor.set_range(90.0, 130.0)
    view.select_tool = by_tool
    heard = []
    view.selection_changed.connect(lambda *four: heard.append(four))
    held = Qt.KeyboardModifier.NoModifier if by_tool else Qt.KeyboardModifier.ShiftModifier
    drag(view, place_of(view, 110.0, 2000.0), place_of(view, 100.0, 4000.0), held)
    assert len(heard) == 1
    assert heard[0][:2] == pytest.approx((100.0, 110.0), abs=0.1)
    assert heard[0][2:] == pytest.approx((2000.0, 4000.0), abs=40.0)
    assert cursor.selection_s == pytest.approx((100.0, 110.0), abs=0.1)


def test_the_read_out_tells_seconds_metres_hertz_and_decibels_inside_and_beside(cursor, view, qtbot):
    view.select(SoundSelection(100.0, 110.0, 2000.0, 4000.0))
    qtbot.waitUntil(lambda: view.figures is not None)
    # what was put in: -80 dB within, -100 dB before and after
    assert view.figures.level_db == pytest.approx(-80.0, abs=0.3)
    assert view.figures.excess_db == pytest.approx(20.0, abs=0.5)
    text = view.selection_text()
    assert "10.00 s" in text
    assert "5.00 m" in text  # at 0.5 m/s
    assert "2000 Hz" in text
    assert not view.grab().isNull()


def test_the_levels_of_half_a_loud_and_half_a_quiet_place_are_averaged_as_powers():
    figures = measure(KnownTiles(), SoundSelection(95.0, 105.0, 2000.0, 4000.0), ((50.0, 60.0),))
    assert figures.level_db == pytest.approx(10 * np.log10((10**-8 + 10**-10) / 2), abs=0.1)
    assert figures.beside_db == pytest.approx(-100.0)


def test_beside_sound_that_has_none_there_is_nothing_to_compare():
    figures = measure(KnownTiles(), SoundSelection(700.0, 710.0, 2000.0, 4000.0), ((690.0, 700.0),))
    assert figures.level_db is None
    assert figures.excess_db is None


def test_an_edge_of_the_selection_can_be_brought_elsewhere(cursor, view):
    cursor.set_range(90.0, 130.0)
    view.select(SoundSelection(100.0, 110.0, 2000.0, 4000.0))
    middle = round(view.y_of_frequency(3000.0))
    drag(view, QPoint(round(view.pixel_of_time(110.0)), middle), QPoint(round(view.pixel_of_time(120.0)), middle))
    assert view.selection.end_s == pytest.approx(120.0, abs=0.1)
    assert view.selection.start_s == 100.0
    assert view.selection.high_hz == 4000.0


def test_a_span_chosen_in_another_plot_holds_all_frequencies_and_a_click_clears_it(cursor, view, shown, qtbot):
    level = shown(LevelView(cursor), 1000, 200)
    with qtbot.waitSignal(view.selection_changed) as told:
        cursor.set_selection(30.0, 20.0)
    assert told.args == [20.0, 30.0, 0.0, 8000.0]
    rect = level.plot_rect()
    with qtbot.waitSignal(view.selection_cleared):
        qtbot.mouseClick(level, Qt.MouseButton.LeftButton, pos=QPoint(round(rect.center().x()), 100))
    assert view.selection is None
    assert view.selection_text() == ""


def test_escape_puts_a_dragged_band_back_and_clears_a_selection(cursor, view, qtbot):
    view.set_band(1000.0, 4000.0)
    view.select(SoundSelection(100.0, 110.0, 2000.0, 3000.0))
    heard = []
    view.band_changed.connect(lambda *band: heard.append(band))
    handles = view._handles()
    start = handles.grips(1, handles.high_y)[1].center().toPoint()
    QTest.mousePress(view, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
    for down in (10, 40):
        QTest.mouseMove(view, start + QPoint(0, down))
    assert view.band_hz[1] < 3900.0
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start + QPoint(0, 40))
    assert view.band_hz == (1000.0, 4000.0)
    assert heard == []
    assert view.selection is not None
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert view.selection is None


def test_beside_a_selection_lie_spans_as_long_in_the_unit_of_the_axis(cursor, view):
    cursor.set_axis_mode("distance")
    # 0.5 m/s to 200 s, a stop to 300 s, then 1 m/s: metres 95..100 and 100..105 take 10 s, and then 5 s after the stop
    of = SoundSelection(180.0, 190.0, 0.0, 8000.0)
    before, after = view.beside_s(of)
    assert before == pytest.approx((170.0, 180.0), abs=0.05)
    assert after == pytest.approx((190.0, 200.0), abs=0.15)
    wide = SoundSelection(300.0, 310.0, 0.0, 8000.0)  # 10 metres; the ten before it took 20 s and the stop
    assert view.beside_s(wide)[0] == pytest.approx((180.0, 300.0), abs=0.2)


@pytest.mark.parametrize(("low_y", "high_y"), [(150.0, 60.0), (100.0, 96.0), (199.0, 1.0)])
def test_the_grips_of_a_band_are_large_apart_and_inside_however_narrow_it_is(low_y, high_y):
    from PySide6.QtCore import QRectF

    handles = BandHandles(QRectF(50.0, 0.0, 600.0, 200.0), low_y, high_y)
    grips = {which: handles.grips(which, y) for which, y in handles.visible()}
    assert GRIP_HEIGHT >= 24.0
    for which, pair in grips.items():
        for grip in pair:
            assert handles.rect.contains(grip)
            free = grip.center() + QPointF(0.0, 8.0 if which == 0 else -8.0)
            assert handles.grabbed(free) == which
    assert handles.grabbed(QPointF(350.0, 0.5 * (low_y + high_y) + 30.0)) is None
