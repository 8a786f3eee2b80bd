"""The parts of the recording page one by one, against what they must show by their own definitions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from scipy.spatial.transform import Rotation

from processing.live.stream import LinkState, SoundStatus
from widgets.attitude_ball import AttitudeBall, rotation_matrix, seen
from widgets.device_form import DeviceForm, FoundPort, FoundSound, MotionWish, SoundWish
from widgets.level_meter import LevelMeter
from widgets.live_path_view import LivePathView, LivePlace
from widgets.live_spectrogram import ROWS, LiveSpectrogram
from widgets.live_strips import LiveStrips, StripKind
from widgets.plot_theme import DARK, LIGHT, SUN
from widgets.press_twice import PressTwice
from widgets.recording_form import parse_places
from widgets.ring_image import RingImage
from widgets.state_badge import StateBadge


class Clock:
    now_s = 50.0

    def __call__(self):
        return self.now_s


# --- pressing twice ---


@pytest.mark.parametrize(
    ("presses_s", "stops"),
    [
        ([0.0], False),
        ([0.0, 1.0], True),
        ([0.0, 2.9], True),
        ([0.0, 0.1], False),  # one hand's double click
        ([0.0, 0.1, 0.9], True),
        ([0.0, 3.5], False),  # too late: it counts as a first one
        ([0.0, 3.5, 4.5], True),
    ],
)
def test_the_second_press_counts_if_it_comes_neither_at_once_nor_late(presses_s, stops):
    clock = Clock()
    guard = PressTwice(clock)
    answers = []
    for at_s in presses_s:
        clock.now_s = 50.0 + at_s
        answers.append(guard.press())
    assert answers[-1] is stops
    assert not any(answers[:-1])


def test_a_deaf_guard_takes_no_press():
    clock = Clock()
    guard = PressTwice(clock)
    guard.reset(1.5)
    answers = []
    for _ in range(3):
        answers.append(guard.press())
        clock.now_s += 0.5
    assert not any(answers)
    assert not guard.armed


# --- pictures that scroll ---


def painted(ring, width, height):
    image = QImage(width, height, QImage.Format.Format_RGB32)
    painter = QPainter(image)
    ring.paint(painter, QRectF(0, 0, width, height))
    painter.end()
    return np.frombuffer(image.constBits(), np.uint32).reshape(height, width) & 0xFFFFFF


@settings(deadline=None, max_examples=40)
@given(st.integers(1, 12), st.lists(st.integers(0, 15), max_size=8))
def test_a_ring_shows_the_last_columns_in_order_however_they_came(qapp, columns, counts):
    ring = RingImage(columns, 3, 0xFF000000)
    whole = np.full((3, columns), 0xFF000000, np.uint32)
    number = 0
    for count in counts:
        new = np.uint32(0xFF000000) + np.arange(number, number + 3 * count, dtype=np.uint32).reshape(3, count)
        number += 3 * count
        ring.append(new)
        whole = np.concatenate([whole, new], axis=1)
    expected = whole[:, -columns:]
    assert np.array_equal(ring.in_order(), expected)
    assert np.array_equal(painted(ring, columns, 3), expected & 0xFFFFFF)
    assert np.array_equal(painted(ring, 2 * columns, 6), np.kron(expected, np.ones((2, 2), np.uint32)) & 0xFFFFFF)


def spectrogram(qtbot, columns=40):
    view = LiveSpectrogram()
    qtbot.addWidget(view)
    view.resize(500, 260)
    view.set_axes(np.linspace(50.0, 20_000.0, 400), columns, 0.05)
    return view


def tone_columns(count, bin_number, loud=200, quiet=40):
    tiles = np.full((count, 400), quiet, np.uint8)
    tiles[:, bin_number] = loud
    return tiles, np.zeros(count, bool)


def test_a_tone_stands_in_the_row_of_its_frequency(qtbot):
    view = spectrogram(qtbot)
    view.add_columns(0, *tone_columns(30, 100))
    row = view._tiles[-1].argmax()
    assert view._edges[row] <= 5050.0 <= view._edges[row + 1] + 50.0
    rect = view.plot_rect()
    assert view.y_of(view._edges[0]) == pytest.approx(rect.bottom())
    assert view.y_of(view._edges[-1]) == pytest.approx(rect.top())


def test_columns_that_come_again_are_passed_over_and_skipped_ones_are_a_gap(qtbot):
    view = spectrogram(qtbot)
    tiles, fine = tone_columns(30, 100)
    view.add_columns(0, tiles[:10], fine[:10])
    view.add_columns(5, tiles[5:12], fine[5:12])
    view.add_columns(15, tiles[15:20], fine[15:20])
    assert view._stop == 20
    assert view._is_gap[-20:].tolist() == [False] * 12 + [True] * 3 + [False] * 5


def test_the_picture_of_a_column_stays_when_others_come(qtbot):
    """Colours settle at first; after that a column scrolls and is not drawn anew."""
    view = spectrogram(qtbot, columns=400)
    random = np.random.default_rng(3)
    tiles = random.integers(30, 120, (380, 400)).astype(np.uint8)
    fine = np.zeros(380, bool)
    view.add_columns(0, tiles[:250], fine[:250])
    before = view._ring.in_order()[:, -100:]
    view.add_columns(250, tiles[250:], fine[250:])
    assert np.array_equal(view._ring.in_order()[:, -230:-130], before)
    assert len(np.unique(before)) > 50
    assert before.shape[0] == ROWS


def strips(qtbot):
    view = LiveStrips((StripKind("force", "m/s²", 10.0, slice(0, 3)), StripKind("turn", "°/s", 1.0, slice(3, 6), 2.0)))
    qtbot.addWidget(view)
    view.resize(400, 200)
    view.set_columns(50)
    return view


def test_the_growing_column_of_a_strip_is_replaced_by_its_next_form(qtbot):
    view = strips(qtbot)
    values = np.arange(60, dtype=np.float32).reshape(10, 6) / 60.0
    view.add_columns(0, values[:4], values[:4])
    view.add_columns(3, values[3:] - 0.5, values[3:] + 0.5)  # column 3 had not ended
    force, turn = view._strips
    assert force.low[-10:-7].tolist() == values[:3, :3].tolist()
    assert force.high[-7:].tolist() == (values[3:, :3] + 0.5).tolist()
    assert np.allclose(turn.high[-7:], 2.0 * (values[3:, 3:] + 0.5))
    assert np.all(np.isnan(force.low[:-10]))


def test_a_strip_holds_what_it_shows_within_its_range(qtbot):
    view = strips(qtbot)
    random = np.random.default_rng(1)
    for number in range(30):
        loud = 100.0 if 8 <= number < 12 else 1.0
        values = (loud * random.normal(size=(5, 6))).astype(np.float32)
        view.add_columns(5 * number, values, values)
        shown = view._strips[0]
        assert np.nanmax(np.abs(shown.high)) <= shown.half
    assert view._strips[0].half == 10.0  # narrow again when the loud part has gone by


def test_a_curve_that_jumps_is_drawn_without_a_hole(qtbot):
    view = strips(qtbot)
    low = np.zeros((50, 6), np.float32)
    low[25:, 0] = 9.0
    view.add_columns(0, low, low)
    pixels = view._strips[0].ring.in_order()
    column = pixels[:, 25]
    colour = view._colours().curves[0]
    rows = np.flatnonzero(column == colour)
    assert len(rows) >= 0.35 * len(column)  # from 0 to 9 of ±10


# --- attitude, path, level, badge ---


@settings(deadline=None)
@given(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4))
def test_the_ball_turns_as_scipy_turns(parts):
    q = np.array(parts)
    if np.linalg.norm(q) < 0.1:
        return
    q /= np.linalg.norm(q)
    expected = Rotation.from_quat([q[1], q[2], q[3], q[0]]).as_matrix()
    assert np.allclose(rotation_matrix(q), expected, atol=1e-12)


def test_the_eye_sees_up_above_and_itself_in_front():
    right, up, near = seen(np.array([[0.0, 0.0, 1.0]]))[0]
    assert abs(right) < 1e-12
    assert up > 0.8
    assert near > 0.0
    assert np.allclose(np.linalg.norm(seen(np.eye(3)), axis=1), 1.0)


@pytest.mark.parametrize("theme", [LIGHT, DARK, SUN])
def test_path_ball_and_badge_paint_whatever_is_known(qtbot, theme):
    path, ball, badge = LivePathView(theme), AttitudeBall(theme), StateBadge("IMU", theme)
    for widget in (path, ball, badge):
        qtbot.addWidget(widget)
        widget.resize(300, 200)
    way = np.cumsum(np.random.default_rng(2).normal(size=(500, 2)), axis=0)
    for place in (
        LivePlace(),
        LivePlace(here_m=(0.0, 0.0), chainage_m=0.0),
        LivePlace(way, (1.0, 2.0), 120.21, 0.8, 0.45, False, (("valve 12", 1.0, 1.0),)),
        LivePlace(way, (1.0, 2.0), 120.21, 0.8, 0.0, True),
    ):
        path.set_place(place)
        path.grab()
    assert path.words()[0] == "120.2 m ± 1.6 m"
    path.set_stale(stale=True)
    assert "last known" in path.words()[1]
    for q in (None, np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0, 0.0])):
        ball.set_attitude(q)
        ball.grab()
    for state in LinkState:
        badge.set_state(state, "400 Hz")
        badge.grab()
        assert badge.text.startswith("IMU: ")


def test_levels_lie_evenly_on_the_meter_and_a_click_clears_it(qtbot):
    meter = LevelMeter()
    qtbot.addWidget(meter)
    meter.resize(500, 60)
    assert meter.x_of(-48.0) == pytest.approx((meter.x_of(-96.0) + meter.x_of(0.0)) / 2)
    assert meter.x_of(-200.0) == meter.x_of(-96.0)
    status = SoundStatus(LinkState.LIVE, rms_db=(-20.0, -30.0), peak_db=(-9.0, -200.0), held_peak_db=(-3.0, -200.0))
    meter.set_status(status)
    assert meter.words == "−20 dB"
    image = meter.grab().toImage()
    left, right = (image.pixelColor(QPointF(meter.x_of(db), 10).toPoint()) for db in (-60.0, -15.0))
    assert left.green() > left.red()  # within the bar
    assert right.name() == LIGHT.canvas  # beyond it
    with qtbot.waitSignal(meter.clear_asked):
        QTest.mouseClick(meter, Qt.MouseButton.LeftButton)


# --- forms ---


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("", ()),
        ("valve 12", (("valve 12", None),)),
        ("valve 12 = 120.5", (("valve 12", 120.5),)),
        ("vana 12; 120,5", (("vana 12", 120.5),)),
        ("vana 12 120,5", (("vana 12", 120.5),)),
        ("manhole 40 m", (("manhole", 40.0),)),
        ("\n  bend  \n= =\n", (("bend", None),)),
    ],
)
def test_places_are_read_as_people_write_them(text, places):
    assert parse_places(text) == places


def test_what_is_chosen_survives_a_search_that_finds_something_else(qtbot):
    form = DeviceForm()
    qtbot.addWidget(form)
    sound, motion = SoundWish("USB Mic", 96_000, 2), MotionWish("serial", "/dev/serial/by-id/x", 0, 921_600, "csv")
    form.set_wishes(sound, motion)
    heard = []
    form.changed.connect(lambda: heard.append((form.sound, form.motion)))
    form.set_found((FoundSound("Other", 1),), (FoundPort("/dev/ttyUSB9", "ttyUSB9"),))
    assert (form.sound, form.motion) == (sound, motion)
    assert not heard
    form.set_wishes(sound, MotionWish("udp", "", 8001))
    assert form.motion == MotionWish("udp", "", 8001)
    form._sound.setCurrentIndex(form._sound.findData("Other"))
    assert heard[-1][0].name == "Other"
    assert len(heard) == 1
