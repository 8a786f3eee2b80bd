import threading

import numpy as np
import pyqtgraph
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QMouseEvent

from processing.errors import ErrorCode, LeaklineError
from widgets.color_maps import COLOR_MAPS, color_table, level_color_index
from widgets.latest_loader import LatestLoader
from widgets.plot_scale import Scale, ScaleKind
from widgets.spectrogram_view import SpectrogramView
from widgets.tile_source import pixel_levels


class FakeTiles:
    """Sound of so many seconds in columns of ``hop_s``: quiet (level 60), with loud columns (200) at ``events``."""

    low_db, step_db = -130.0, 0.5
    start_s = 0.0

    def __init__(self, end_s=600.0, hop_s=0.1, bins=65, events=(), loud_bins=slice(None)):
        self.end_s, self.hop_s = end_s, hop_s
        self.frequencies_hz = np.linspace(0.0, 8000.0, bins)
        self.levels = np.full((bins, round(end_s / hop_s)), 60, np.uint8)
        for event in events:
            self.levels[loud_bins, int(event / hop_s)] = 200
        self.calls = 0

    def columns(self, start_s, end_s, columns, plane="max"):
        self.calls += 1
        result = np.zeros((len(self.frequencies_hz), columns), np.uint8)
        edges = np.linspace(start_s, end_s, columns + 1) / self.hop_s
        first = np.floor(edges[:-1] + 1e-9).astype(int)
        end = np.maximum(np.ceil(edges[1:] - 1e-9).astype(int), first + 1)
        for k, (a, b) in enumerate(zip(first.clip(0), end.clip(0, self.levels.shape[1]), strict=True)):
            if b > a:
                result[:, k] = self.levels[:, a:b].max(axis=1)
        return result


@pytest.fixture
def view(cursor, shown, qtbot):
    view = shown(SpectrogramView(cursor), 1000, 300)
    yield view
    view.set_source(None)


def sharp(qtbot, view):
    qtbot.waitUntil(lambda: bool(view.grab()) and view.is_sharp)
    return view.grab().toImage()


def loud_columns(image, view):
    """Pixel columns of the plot that show the loudest colour in the middle row."""
    rect = view.plot_rect()
    y = int(rect.center().y())
    loudest = QColor(*color_table("viridis")[255].tolist())
    return [x for x in range(int(rect.left()) + 1, int(rect.right()) - 1) if image.pixelColor(x, y) == loudest]


@pytest.mark.parametrize("mode", ["time", "distance"])
@pytest.mark.parametrize("event", [50.05, 250.05, 480.05])  # slow, standing, fast
def test_an_event_appears_at_its_pixel_in_both_units_of_the_axis(cursor, view, qtbot, mode, event):
    view.set_source(FakeTiles(events=(event,)))
    view.set_db_range(-90.0, -40.0)
    cursor.set_axis_mode(mode)
    cursor.set_time(-10.0)
    found = loud_columns(sharp(qtbot, view), view)
    want = view.pixel_of_time(event)
    assert found
    assert min(found) - 1.5 <= want <= max(found) + 1.5
    assert max(found) - min(found) <= 2


@pytest.mark.parametrize("zoom", [1.0, 0.3, 0.01])
def test_a_single_frame_stays_visible_from_hours_to_seconds(cursor, view, qtbot, zoom):
    cursor.set_track(None)
    cursor.set_extent(0.0, 4 * 3600.0)
    view.set_source(FakeTiles(end_s=4 * 3600.0, events=(7000.05,)))
    view.set_db_range(-90.0, -40.0)
    cursor.zoom(zoom, 7000.0)
    assert loud_columns(sharp(qtbot, view), view)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(0.0, 30.0), min_size=2, max_size=60).filter(lambda steps: sum(steps) > 1.0),
    st.floats(0.001, 0.999),
)
def test_however_uneven_the_columns_an_event_is_in_the_one_that_holds_it(steps, part):
    edges = np.concatenate(([0.0], np.cumsum(steps)))
    tiles = FakeTiles(end_s=float(np.ceil(edges[-1])) + 1.0, hop_s=0.05, events=(part * edges[-1],))
    picture = pixel_levels(tiles, edges, Scale(0.0, 8000.0), 10)
    assert picture.shape == (10, len(steps))
    loud = np.flatnonzero((picture == 200).all(axis=0))
    event = int(part * edges[-1] / 0.05) * 0.05
    touching = [k for k in range(len(steps)) if edges[k] <= event + 0.05 and edges[k + 1] >= event and steps[k] > 0]
    assert set(touching) & set(loud.tolist())
    # never far off: within what a column of the asked picture, and a stored one, may add
    widths = np.diff(edges)
    slack = 0.05 + max(edges[-1] / 16384, np.percentile(widths[widths > 0], 2.0))
    assert all(edges[k] <= event + 0.05 + slack and edges[k + 1] >= event - slack for k in loud)


@pytest.mark.parametrize("kind", list(ScaleKind))
def test_a_tone_appears_at_its_frequency_on_every_scale(cursor, view, qtbot, kind):
    tiles = FakeTiles()
    tiles.levels[16] = 200  # 2000 Hz
    view.set_source(tiles)
    view.set_db_range(-90.0, -40.0)
    view.set_frequency_scale(kind)
    cursor.set_time(-10.0)
    image = sharp(qtbot, view)
    rect = view.plot_rect()
    x = int(rect.center().x())
    loudest = QColor(*color_table("viridis")[255].tolist())
    rows = [y for y in range(int(rect.top()) + 2, int(rect.bottom()) - 2) if image.pixelColor(x, y) == loudest]
    assert rows
    for y in (rows[0], rows[-1]):  # a bin is 125 Hz wide, a pixel a little more
        assert abs(view.frequency_of_pixel(y + 0.5) - 2000.0) < 125.0


def test_the_colours_of_the_picture_are_those_of_the_bar_at_the_same_decibels(cursor, view, qtbot):
    tiles = FakeTiles()
    tiles.levels[:] = 100  # −80 dB
    view.set_source(tiles)
    view.set_db_range(-93.0, -41.0)
    cursor.set_time(-10.0)
    image = sharp(qtbot, view)
    rect = view.plot_rect()
    shown_colour = image.pixelColor(int(rect.center().x()), int(rect.center().y()))
    want = color_table("viridis")[int(level_color_index(-80.0, -93.0, -41.0))]
    assert shown_colour == QColor(*want.tolist())
    # of the bar, each row shows the colour of the level in its middle
    bar_x, top, height = round(rect.right() + 4 + 6 + 10), int(rect.top()), rect.height()
    for y in range(top + 2, top + int(height) - 2):
        level = -130.0 + 127.5 * (1.0 - (y - top + 0.5) / height)
        if min(abs(level + 93.0), abs(level + 41.0)) > 1.5:  # the handles lie over the ends
            colour = color_table("viridis")[int(level_color_index(level, -93.0, -41.0))]
            assert image.pixelColor(bar_x, y) == QColor(*colour.tolist())


@pytest.mark.parametrize(("level", "index"), [(-200, 0), (-100, 0), (-75, 64), (-50, 128), (0, 255), (50, 255)])
def test_decibels_become_colours_by_a_straight_line_between_the_ends(level, index):
    assert level_color_index(level, -100.0, 0.0) == index


@pytest.mark.parametrize("name", ["viridis", "cividis", "magma"])
def test_colour_tables_are_those_that_their_authors_published(name):
    peer = pyqtgraph.colormap.get(name if name != "magma" else "CET-L3") if name != "magma" else None
    if peer is None:  # the peer has no magma: its ends and its middle as published
        table = color_table(name)
        assert table[0].tolist() == [0, 0, 4]
        assert table[255].tolist() == [252, 253, 191]
        return
    difference = color_table(name).astype(int) - peer.getLookupTable(nPts=256)[:, :3].astype(int)
    assert np.abs(difference).max() <= 7


def test_every_colour_table_grows_steadily_lighter_or_darker():
    for name in COLOR_MAPS:
        luminance = color_table(name) @ np.array([0.2126, 0.7152, 0.0722])
        steps = np.diff(luminance)
        assert np.all(steps > -0.5) or np.all(steps < 0.5), name


def test_panning_does_not_change_the_decibel_range_and_asking_does(cursor, view, qtbot):
    tiles = FakeTiles()
    tiles.levels[:, 3000:] = 160
    view.set_source(tiles)
    sharp(qtbot, view)
    before = view.db_range
    cursor.set_range(320.0, 330.0)
    sharp(qtbot, view)
    assert view.db_range == before
    with qtbot.waitSignal(view.db_range_changed):
        assert view.auto_db_range()
    low, high = view.db_range
    assert low < -50.0 <= high  # 160 is −50 dB
    assert high - low >= 30.0


def press_move_release(view, start, end):
    for kind, place in (
        (QEvent.Type.MouseButtonPress, start),
        (QEvent.Type.MouseMove, QPointF(0.5 * (start.x() + end.x()), 0.5 * (start.y() + end.y()))),
        (QEvent.Type.MouseMove, end),
        (QEvent.Type.MouseButtonRelease, end),
    ):
        button = Qt.MouseButton.LeftButton
        event = QMouseEvent(kind, place, view.mapToGlobal(place), button, button, Qt.KeyboardModifier.NoModifier)
        {
            QEvent.Type.MouseButtonPress: view.mousePressEvent,
            QEvent.Type.MouseMove: view.mouseMoveEvent,
            QEvent.Type.MouseButtonRelease: view.mouseReleaseEvent,
        }[kind](event)


def test_a_dragged_band_handle_is_told_once_when_it_is_let_go(view, qtbot):
    view.set_frequency_scale("linear")
    view.set_source(FakeTiles())
    view.set_band(1000.0, 4000.0)
    rect = view.plot_rect()
    heard = []
    view.band_changed.connect(lambda low, high: heard.append((low, high)))
    start = QPointF(rect.center().x(), rect.bottom() - 0.5 * rect.height())
    press_move_release(view, start, QPointF(start.x(), rect.bottom() - 0.75 * rect.height()))
    assert len(heard) == 1
    assert heard[0] == pytest.approx((1000.0, 6000.0))
    press_move_release(
        view, QPointF(start.x(), rect.bottom() - 0.125 * rect.height()), QPointF(start.x(), rect.top() - 40)
    )
    low, high = view.band_hz
    assert low == pytest.approx(high / 1.05)  # the handles never pass each other


def test_dragging_the_ends_of_the_bar_moves_the_decibel_range_exactly(view, qtbot):
    view.set_source(FakeTiles())
    view.set_db_range(-100.0, -40.0)
    rect = view.plot_rect()
    y = rect.bottom() - (-40.0 + 130.0) / 127.5 * rect.height()
    press_move_release(
        view, QPointF(rect.right() + 16, y), QPointF(rect.right() + 16, y + 20.0 / 127.5 * rect.height())
    )
    assert view.db_range == pytest.approx((-100.0, -60.0))
    middle = rect.bottom() - (-80.0 + 130.0) / 127.5 * rect.height()
    end = QPointF(rect.right() + 16, middle - 10.0 / 127.5 * rect.height())
    press_move_release(view, QPointF(rect.right() + 16, middle), end)
    assert view.db_range == pytest.approx((-90.0, -50.0))


def test_the_readout_tells_time_metres_place_frequency_and_decibels(cursor, view, qtbot):
    view.set_frequency_scale("linear")
    view.set_source(FakeTiles(events=(400.05,)))
    sharp(qtbot, view)
    cursor.set_range(390.0, 410.0)
    sharp(qtbot, view)
    rect = view.plot_rect()
    place = QPointF(view.pixel_of_time(400.05), rect.center().y())
    with qtbot.waitSignal(view.pointed) as told:
        press_move_release(view, place, place)
    readout = told.args[0]
    assert readout.time_s == pytest.approx(400.05, abs=0.05)
    assert readout.chainage_m == pytest.approx(200.05, abs=0.1)
    assert readout.position_w_m[0] == pytest.approx(200.05 * np.sin(0.7), abs=0.1)
    assert readout.frequency_hz == pytest.approx(4000.0, abs=30.0)
    assert readout.level_db == pytest.approx(-30.0)


def test_until_it_is_sharp_the_picture_is_drawn_stretched_from_what_is_at_hand(cursor, view, qtbot):
    tiles = FakeTiles()
    tiles.levels[:] = 200
    view.set_source(tiles)
    view.set_db_range(-90.0, -40.0)
    cursor.set_time(-10.0)
    sharp(qtbot, view)
    cursor.set_range(100.0, 200.0)
    image = view.grab().toImage()  # no event loop has run: nothing new can have been read
    assert not view.is_sharp
    assert len(loud_columns(image, view)) > 0.9 * view.plot_rect().width()


def test_a_read_that_fails_is_told_and_not_asked_for_again_and_again(cursor, view, qtbot):
    class Broken(FakeTiles):
        def columns(self, start_s, end_s, columns, plane="max"):
            self.calls += 1
            raise LeaklineError(ErrorCode.AUDIO_UNREADABLE)

    tiles = Broken()
    with qtbot.waitSignals([view.read_failed, view.read_failed]):
        view.set_source(tiles)
        view.grab()
    calls = tiles.calls
    for _ in range(5):
        view.invalidate()
        view.grab()
        qtbot.wait(5)
    assert tiles.calls == calls


def test_only_the_newest_request_is_answered(qtbot):
    loader = LatestLoader()
    answers, made = [], []
    loader.loaded.connect(answers.append)
    for number in range(50):
        loader.request(lambda number=number: (made.append(number), number)[1])
    qtbot.waitUntil(lambda: not loader.busy)
    assert answers == [49]
    assert len(made) <= 2  # the one that had begun, and the newest
    loader.request(lambda: 50)
    loader.stop()
    qtbot.wait(20)
    assert answers == [49]


def test_what_follows_a_hand_is_answered_even_where_a_newer_wish_has_overtaken_it(qtbot):
    loader = LatestLoader(overtaken=True)
    answers, begun, go = [], threading.Event(), threading.Event()
    loader.loaded.connect(answers.append)
    loader.request(lambda: (begun.set(), go.wait(20.0), "first")[2])
    assert begun.wait(20.0)
    loader.request(lambda: "second")
    loader.request(lambda: "third")
    go.set()
    qtbot.waitUntil(lambda: not loader.busy)
    assert answers == ["first", "third"]
    loader.request(lambda: "dropped")
    loader.cancel()
    qtbot.waitUntil(lambda: not loader.busy)
    assert answers == ["first", "third"]


def test_our_own_bug_in_a_worker_is_raised_where_the_crash_guard_sees_it(qtbot):
    loader = LatestLoader()
    with qtbot.captureExceptions() as caught:
        loader.request(lambda: 1 // 0)
        qtbot.waitUntil(lambda: not loader.busy)
        qtbot.wait(5)
    assert [kind for kind, *_ in caught] == [ZeroDivisionError]


def test_the_wheel_with_control_zooms_frequencies_about_the_mouse(view, qtbot):
    view.set_frequency_scale("linear")
    view.set_source(FakeTiles())
    rect = view.plot_rect()
    place = QPointF(rect.center().x(), rect.top() + 0.25 * rect.height())
    before = view.frequency_of_pixel(place.y())
    view._zoom_vertical(0.5, place)
    assert view.frequency_of_pixel(place.y()) == pytest.approx(before)
    low, high = view.frequency_range
    assert high - low == pytest.approx(4000.0)
    view._fit_vertical()
    assert view.frequency_range == (0.0, 8000.0)


def test_without_sound_it_says_so_and_takes_the_mouse(view, qtbot):
    view.grab()
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=QPoint(400, 100))
    assert view.level_at(QPointF(400, 100)) is None
    assert not view.auto_db_range()
