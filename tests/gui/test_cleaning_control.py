"""One key changes ear and eye between raw and cleaned; where that cannot be, the button says why."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from rolling_sound import noise, recorded, roll
from small_survey import candidate, make_folder, make_results

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.survey import ClockMap, DeviceInfo, Motion

RUN = roll(36.0, seed=6)
KEY = Qt.Key


@pytest.fixture
def services(qapp, tmp_path):
    services = Services(
        SurveySession(),
        Jobs(),
        PreferencesStore(tmp_path / "preferences.json"),
        None,
        lambda _rate_hz: CountingSink(),
        lambda: None,
    )
    services.session.open(make_folder(tmp_path))
    yield services
    services.jobs.stop_all()
    services.session.close()


@pytest.fixture
def window(qtbot, services):
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    window.show()
    qtbot.waitUntil(lambda: not services.jobs.running)
    yield window
    window.close()
    window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A recording in which the rolling is heard."""
    sound = noise(len(RUN.time_s), 0.004) + RUN.swelling(0.01) + RUN.lines(0.01)
    return recorded(tmp_path_factory.mktemp("made"), RUN, sound)


@pytest.fixture
def rolling(services, made):
    """Results of a run in which the rolling is heard."""
    plain = make_results(services.session.folder)
    recording = replace(plain.recording, imu=made.imu, audio=made.audio)
    return replace(
        plain,
        recording=recording,
        scan=made.scan,
        track=made.track,
        clock=ClockMap(),
        candidates=(candidate(1, 20.0, 0.9),),
    )


def show(window, services, results):
    services.session.set_results(results)
    window.show_page("sound")
    window.review_page.focus_views()


def press(window, key):
    QTest.keyClick(QApplication.focusWidget() or window, key)


def button(window):
    return window.review_page.playback.findChild(object, "cleaned")


def test_the_key_a_switches_sound_and_picture_while_it_plays_and_keeps_the_place(window, services, rolling, qtbot):
    show(window, services, rolling)
    cursor = services.session.cursor
    cursor.set_range(15.0, 25.0)
    cursor.set_time(20.0)
    tiles = window.review_page.spectrogram._source
    raw = tiles.columns(15.0, 25.0, 200)
    press(window, KEY.Key_Space)
    press(window, KEY.Key_A)
    qtbot.waitUntil(lambda: window.cleaning.on, timeout=20_000)
    assert window.player.playing
    assert window.player.hearing.cleaned
    assert button(window).isChecked()
    assert cursor.time_s >= 20.0
    cleaned = tiles.columns(15.0, 25.0, 200)
    row = int(np.argmin(abs(tiles.frequencies_hz - 1.4 * 220)))  # the highest line of the helper
    assert cleaned.shape == raw.shape
    assert cleaned[row - 4 : row + 5].astype(int).mean() < raw[row - 4 : row + 5].astype(int).mean() - 2
    press(window, KEY.Key_A)
    assert not window.player.hearing.cleaned
    assert not button(window).isChecked()
    assert window.player.playing
    np.testing.assert_array_equal(tiles.columns(15.0, 25.0, 200), raw)
    press(window, KEY.Key_Space)


def test_beside_the_buttons_stands_what_the_cleaning_does_in_the_visible_span(window, services, rolling, qtbot):
    show(window, services, rolling)
    services.session.cursor.set_range(10.0, 20.0)
    press(window, KEY.Key_A)
    note = window.review_page.playback._hint
    qtbot.waitUntil(lambda: "turns/s" in note.text(), timeout=20_000)
    turned = np.interp([10.0, 20.0], RUN.time_s, RUN.angle_rad)
    assert f"{(turned[1] - turned[0]) / 20 / np.pi:.2f} turns/s" in note.text()
    assert "rolling noise −" in note.text()
    press(window, KEY.Key_A)
    assert note.text() == ""


def test_where_nothing_rolls_audibly_the_button_says_so_and_is_off(window, services, qtbot):
    show(window, services, make_results(services.session.folder))
    press(window, KEY.Key_A)
    qtbot.waitUntil(lambda: not button(window).isEnabled(), timeout=20_000)
    assert "not heard" in button(window).toolTip()
    assert not button(window).isChecked()
    press(window, KEY.Key_A)
    assert not services.jobs.running


def test_a_carried_device_and_one_without_motion_record_have_no_rolling_to_take_out(window, services):
    results = make_results(services.session.folder)
    carried = replace(results.survey, device=DeviceInfo(motion=Motion.CARRIED))
    show(window, services, replace(results, survey=carried))
    assert "does not roll" in button(window).toolTip()
    show(window, services, replace(results, recording=replace(results.recording, imu=None)))
    assert "motion record" in button(window).toolTip()
    assert not button(window).isEnabled()


def test_band_and_speed_are_chosen_by_key_and_remembered(window, services, rolling):
    show(window, services, rolling)
    assert window.player.hearing.band_hz is None
    press(window, KEY.Key_B)
    sound = rolling.settings.sound
    assert window.player.hearing.band_hz == (sound.band_low_hz, sound.band_high_hz)
    press(window, KEY.Key_B)
    assert window.player.hearing.band_hz == rolling.candidates[0].band_hz
    press(window, KEY.Key_S)
    assert window.player.hearing.slow == 2
    again = PreferencesStore(services.preferences.file).values
    assert (again.play_band, again.play_slow) == ("candidate", 2)
    bar = window.review_page.playback
    assert bar._band.currentData() == "candidate"
    assert bar._slow.currentData() == 2


def test_a_selection_is_played_in_a_loop_half_as_fast(window, services, rolling, qtbot):
    show(window, services, rolling)
    services.preferences.change(play_slow=2)
    services.session.cursor.set_selection(12.0, 12.6)
    times = []
    services.session.cursor.moved.connect(times.append)
    window.player.toggle_selection_loop()
    qtbot.waitUntil(lambda: any(b < a for a, b in pairwise(times)), timeout=10_000)
    assert window.player.looping
    assert min(times) >= 11.99
    assert max(times) <= 12.61
    window.player.toggle_selection_loop()
    assert not window.player.playing


def test_a_click_elsewhere_while_it_plays_goes_on_from_there_on_the_same_card(window, services, rolling, qtbot):
    show(window, services, rolling)
    services.session.cursor.set_time(5.0)
    press(window, KEY.Key_Space)
    playback = window.player._playback
    services.session.cursor.set_time(30.0)
    assert window.player._playback is playback
    qtbot.waitUntil(lambda: services.session.cursor.time_s > 30.2, timeout=10_000)
    press(window, KEY.Key_Space)
