"""The recording page with a scripted recorder: opening, levels, recording, markers, stopping, and what goes wrong."""

import dataclasses
import threading

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from scripted_recorder import RATE_HZ, Laptop, disc_full, motion_block, sound_block

from app.battery import Battery
from app.recording_control import RecordingControl
from app.recording_page import RecordingPage
from app.settings import PreferencesStore
from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.live.live_view import LiveView
from processing.live.stream import LinkState, RecordingState
from processing.survey import Finding, Severity
from widgets.device_form import MotionWish, SoundWish
from widgets.plot_theme import LIGHT, SUN

LEFT = Qt.MouseButton.LeftButton
SERIAL = MotionWish("serial", "usb:0403:6015", 0, 115_200, "auto")


class Clock:
    def __init__(self):
        self.now_s = 1000.0

    def __call__(self):
        return self.now_s


class Bench:
    """The page with everything behind it but the devices."""

    def __init__(self, qtbot, folder):
        self.qtbot, self.clock = qtbot, Clock()
        self.window = QWidget()
        self.preferences = PreferencesStore(folder / "preferences.json")
        self.laptop = Laptop(folder / "Main-2026-11-22.leakline")
        self.page = RecordingPage(LIGHT, "en")
        self.page.resize(1250, 690)
        self.control = RecordingControl(self.page, self.preferences, self.laptop.kit, self.window, self.clock)
        self.processed = []
        self.control.process_asked.connect(self.processed.append)
        qtbot.addWidget(self.window)
        qtbot.addWidget(self.page)
        self.page.devices.set_wishes(SoundWish("USB Mic"), SERIAL)
        self.page.form.set_folder(folder)

    @property
    def recorder(self):
        return self.laptop.recorder

    def wait(self):
        self.qtbot.waitUntil(lambda: self.control._calls.idle)
        self.qtbot.wait(1)

    def enter(self):
        self.page.show()
        self.control.enter()
        self.wait()
        self.wait()
        self.control.look()

    def press(self, after_s=0.0):
        self.clock.now_s += after_s
        QTest.mouseClick(self.page.panel.button, LEFT)
        self.wait()
        self.control.look()

    def record(self):
        self.enter()
        self.press()
        self.clock.now_s += 10.0


@pytest.fixture
def bench(qtbot, tmp_path):
    assert LiveView  # imported before the clock runs
    bench = Bench(qtbot, tmp_path)
    yield bench
    bench.control.shut()


def test_the_chosen_devices_are_opened_before_anything_is_recorded(bench):
    bench.enter()
    assert bench.recorder.asked == ["open"]
    assert bench.recorder.wish.sound.name == "USB Mic"
    assert bench.recorder.wish.motion == SERIAL
    assert "alive" in bench.page.sound_badge.text
    assert "400 Hz" in bench.page.imu_badge.text
    assert bench.page.panel.button.isEnabled()


def test_another_device_closes_the_first_and_opens_the_new_one(bench):
    bench.enter()
    first = bench.recorder
    bench.page.devices._sound.setCurrentIndex(bench.page.devices._sound.findData("Field recorder"))
    bench.wait()
    assert first.asked == ["open", "close"]
    assert bench.recorder is not first
    assert bench.recorder.wish.sound.name == "Field recorder"


def test_without_a_device_nothing_can_be_recorded(bench):
    bench.page.devices.set_wishes(SoundWish("none"), MotionWish())
    bench.enter()
    assert not bench.laptop.recorders
    assert not bench.page.panel.button.isEnabled()


def test_one_press_records_and_two_presses_stop(bench):
    bench.record()
    assert bench.recorder.asked == ["open", "begin"]
    assert bench.control.recording
    bench.press()
    assert bench.recorder.current.state is RecordingState.RECORDING
    assert "Once more" in bench.page.panel.button.text()
    bench.press(after_s=1.0)
    assert bench.recorder.asked[-2:] == ["stop", "close"]
    assert not bench.control.recording


def test_a_double_click_neither_stops_nor_a_late_second_press(bench):
    bench.enter()
    bench.press()
    bench.press(after_s=0.2)
    bench.press(after_s=0.4)
    bench.press(after_s=5.0)
    bench.press(after_s=3.5)
    assert "stop" not in bench.recorder.asked


def test_the_form_of_the_moment_is_what_is_recorded(bench):
    bench.enter()
    name = bench.page.findChild(QWidget, "recording_name")
    name.setText("Second Street")
    name.editingFinished.emit()
    bench.press()
    assert bench.recorder.wish.survey.info.name == "Second Street"
    assert len(bench.laptop.recorders) == 1  # the devices ran on


def test_choices_are_remembered_for_the_next_time(bench, qtbot):
    bench.page.form.set_places("valve 12 = 120.5")
    bench.enter()
    bench.control.leave()
    page = RecordingPage(LIGHT, "en")
    qtbot.addWidget(page)
    again = RecordingControl(page, PreferencesStore(bench.preferences.file), bench.laptop.kit, page, bench.clock)
    assert page.devices.sound == SoundWish("USB Mic")
    assert page.devices.motion == SERIAL
    assert page.form.places == (("valve 12", 120.5),)
    again.shut()


def test_a_remembered_device_that_is_away_stays_chosen_and_is_said_to_be_away(bench):
    bench.page.devices.set_wishes(SoundWish("Lost Mic", 96_000, 2), SERIAL)
    bench.enter()
    assert bench.page.devices.sound == SoundWish("Lost Mic", 96_000, 2)
    assert "not there now" in bench.page.devices._sound.currentText()


def test_leaving_the_page_lets_the_devices_go_but_not_while_they_are_recorded(bench):
    bench.enter()
    bench.control.leave()
    bench.wait()
    assert bench.recorder.asked == ["open", "close"]
    bench.record()
    bench.control.leave()
    bench.wait()
    assert "close" not in bench.recorder.asked
    assert bench.control.recording


def test_blocks_reach_the_live_views(bench):
    bench.enter()
    for k in range(20):
        bench.recorder.feed.add(sound_block(800 * k), motion_block(0.1 * k))
    bench.qtbot.waitUntil(lambda: bool(bench.page.spectrogram._ring and bench.page.strips._strips))
    bench.qtbot.waitUntil(lambda: bench.page.spectrogram._heard > 20)
    picture = bench.page.spectrogram
    heard = picture._tiles[~picture._is_gap]
    loudest = picture._edges[heard.max(axis=0).argmax()]
    assert 900.0 < loudest < 1100.0  # the tone of the blocks
    assert bench.page.grab().width() >= 1250


def test_the_computer_is_kept_awake_only_while_it_records(bench):
    bench.enter()
    assert bench.laptop.awake == 0
    bench.press()
    assert bench.laptop.awake == 1
    bench.clock.now_s += 10.0
    bench.press()
    bench.press(after_s=1.0)
    assert bench.laptop.awake == 0


def test_a_disc_that_is_full_at_the_start_is_told_and_the_button_works_again(bench):
    bench.enter()
    bench.recorder.fail_begin = disc_full()
    bench.press()
    assert "full" in bench.page.messages.banner.text()
    assert bench.page.panel.button.isEnabled()
    bench.recorder.fail_begin = None
    bench.press()
    assert bench.control.recording


def test_a_device_that_does_not_open_is_told(bench):
    bench.laptop.refusal = disc_full()
    bench.enter()
    assert "full" in bench.page.messages.banner.text()
    assert not bench.page.panel.button.isEnabled()


def test_a_recording_that_ends_by_itself_brings_the_page_to_the_same_end(bench):
    bench.record()
    bench.control.look()
    bench.recorder.change(state=RecordingState.FAILED)
    bench.control.look()
    bench.wait()
    assert "stop" in bench.recorder.asked
    assert bench.page.process.isVisible()


def test_what_happens_is_told_as_a_sentence_at_once(bench):
    bench.record()
    finding = Finding("recorder_imu_lost", Severity.WARNING, {"at": "12:00:05", "device": "/dev/ttyUSB0"})
    bench.recorder.change(findings=(finding,))
    bench.recorder.change_motion(state=LinkState.LOST)
    bench.control.look()
    assert "12:00:05" in bench.page.messages.banner.text()
    assert "12:00:05" in bench.page.messages.list.item(0).text()
    bench.clock.now_s += 60.0
    bench.control.look()
    assert "input lost" in bench.page.messages.banner.text()  # it still is
    bench.recorder.change_motion(state=LinkState.LIVE)
    bench.control.look()
    assert not bench.page.messages.banner.isVisible()


def test_process_now_hands_the_folder_on_and_record_another_opens_the_devices_again(bench):
    bench.record()
    bench.press()
    bench.press(after_s=1.0)
    QTest.mouseClick(bench.page.process, LEFT)
    assert bench.processed == [bench.laptop.folder]
    bench.record()
    bench.press()
    bench.press(after_s=1.0)
    QTest.mouseClick(bench.page.another, LEFT)
    bench.wait()
    assert bench.recorder.asked == ["open"]
    assert not bench.page.process.isVisible()


def test_another_device_chosen_after_a_recording_waits_for_the_next_one(bench):
    bench.record()
    bench.press()
    bench.press(after_s=1.0)
    bench.page.devices._sound.setCurrentIndex(bench.page.devices._sound.findData("Field recorder"))
    bench.wait()
    assert len(bench.laptop.recorders) == 1
    QTest.mouseClick(bench.page.another, LEFT)
    bench.wait()
    assert bench.recorder.wish.sound.name == "Field recorder"


def test_counters_disc_and_battery_warn_in_words(bench):
    bench.record()
    bench.laptop.left = Battery(0.11, plugged=False)
    bench.recorder.change_motion(lost=234)
    bench.recorder.change_disc(seconds_left=600.0, synced_host_s=bench.clock.now_s - 0.4)
    bench.clock.now_s += 20.0
    bench.recorder.change_disc(synced_host_s=bench.clock.now_s - 0.4)
    bench.control.look()
    panel = bench.page.panel
    assert "234" in panel.counts.text()
    assert "⚠" in panel.disc.text()
    assert "11 %" in panel.battery.text()
    assert "11 %" in bench.page.messages.banner.text()
    assert "⚠" in panel.battery.text()
    assert panel.synced.text() == "✓ on disc"
    bench.recorder.change_disc(synced_host_s=bench.clock.now_s - 30.0)
    bench.control.look()
    assert "30 s late" in panel.synced.text()


def test_the_clip_light_stays_on_until_it_is_clicked(bench):
    bench.enter()
    bench.recorder.change_sound(clipped=(True,))
    bench.control.look()
    assert "too loud" in bench.page.meter.words
    QTest.mouseClick(bench.page.meter, LEFT)
    bench.wait()
    bench.control.look()
    assert "clear_clip" in bench.recorder.asked
    assert "too loud" not in bench.page.meter.words


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"state": LinkState.LOST}, "input lost"),
        ({"state": LinkState.SILENT}, "no signal"),
        ({"is_digital_silence": True}, "no signal"),
        ({"state": LinkState.WAITING}, "waiting for it"),
    ],
)
def test_the_meter_says_in_words_what_is_wrong(bench, changes, words):
    bench.enter()
    bench.recorder.change_sound(**changes)
    bench.control.look()
    assert words in bench.page.meter.words
    assert words in bench.page.sound_badge.text


def test_why_a_device_is_not_there_is_said_where_it_would_be_seen(bench):
    bench.enter()
    bench.recorder.change_sound(state=LinkState.WAITING)
    bench.recorder.sound_fault = LeaklineError(ErrorCode.SOUND_DEVICE_MISSING, name="USB Mic", known="Built-in")
    bench.recorder.change_motion(state=LinkState.WAITING, reason="imu_denied")
    bench.control.look()
    assert "Built-in" in bench.page.spectrogram._hint
    assert messages.text("reasons", "imu_denied") in bench.page.strips._hint
    assert not bench.page.messages.banner.isVisible()  # nothing is being lost yet
    bench.press()
    bench.control.look()
    assert "waiting for it" in bench.page.messages.banner.text()


# --- markers ---


def test_a_marker_takes_the_moment_of_the_press_and_its_name_later(bench):
    bench.record()
    bench.clock.now_s = 2000.0
    QTest.mouseClick(bench.page.markers.button, LEFT)
    line = bench.page.markers.line
    assert line.isVisible()
    bench.wait()
    assert bench.recorder.points[0].name == "marker 1"
    bench.clock.now_s = 2030.0  # the typing takes its time
    line.name.setText("valve 12")
    line.chainage.setText("120,5")
    QTest.keyClick(line.name, Qt.Key.Key_Return)
    bench.wait()
    (point,) = bench.recorder.points
    assert (point.name, point.chainage_m, point.time_s) == ("valve 12", 120.5, 2000.0)
    assert not line.isVisible()
    assert "valve 12" in bench.page.markers.list.item(0).text()


def test_escape_keeps_the_moment_under_its_number(bench):
    bench.record()
    for number in (1, 2, 3):
        bench.control.markers.mark()
        QTest.keyClick(bench.page.markers.line.name, Qt.Key.Key_Escape)
        bench.wait()
        assert bench.recorder.points[-1].name == f"marker {number}"


def test_a_second_marker_stores_what_was_typed_for_the_first(bench):
    bench.record()
    bench.control.markers.mark()
    bench.page.markers.line.name.setText("bend")
    bench.control.markers.mark()
    bench.wait()
    bench.page.markers.line.given_up.emit()
    assert [point.name for point in bench.recorder.points] == ["bend", "marker 2"]


def test_undo_takes_the_last_marker_back(bench):
    bench.record()
    for _ in range(2):
        bench.control.markers.mark()
        bench.page.markers.line.given_up.emit()
    bench.control.markers.undo()
    bench.wait()
    assert [point.name for point in bench.recorder.points] == ["marker 1"]
    assert bench.page.markers.list.count() == 1
    assert bench.control.markers.points == tuple(bench.recorder.points)


def test_expected_places_are_offered_in_their_order(bench):
    bench.page.form.set_places("valve 12 = 120.5\nhydrant 3 = 240")
    bench.record()
    line = bench.page.markers.line
    bench.control.markers.mark()
    assert (line.name.text(), line.chainage.value) == ("valve 12", 120.5)
    QTest.keyClick(line.name, Qt.Key.Key_Return)
    bench.control.markers.mark()
    assert line.name.text() == "hydrant 3"
    line.given_up.emit()
    bench.wait()
    assert bench.recorder.points[0].chainage_m == 120.5


def test_another_name_takes_the_offered_chainage_away_but_not_a_typed_one(bench):
    bench.page.form.set_places("valve 12 = 120.5\nhydrant 3 = 240")
    bench.record()
    line = bench.page.markers.line
    bench.control.markers.mark()
    line.name.setCompleter(None)  # its list cannot be shown without a screen
    QTest.keyClicks(line.name, "manhole")
    assert line.chainage.text() == ""
    line.name.selectAll()
    QTest.keyClicks(line.name, "hydrant 3")
    assert line.chainage.text() == "240"
    line.chainage.selectAll()
    QTest.keyClicks(line.chainage, "237")
    QTest.keyClicks(line.name, " old")
    QTest.keyClick(line.name, Qt.Key.Key_Return)
    bench.wait()
    assert [(point.name, point.chainage_m) for point in bench.recorder.points] == [("hydrant 3 old", 237.0)]


def test_a_marker_that_cannot_be_stored_is_told_and_not_listed(bench):
    bench.record()
    bench.recorder.fail_mark = disc_full()
    bench.control.markers.mark()
    bench.wait()
    assert not bench.control.markers.points
    assert "full" in bench.page.messages.banner.text()


def test_stopping_stores_the_name_that_was_being_typed(bench):
    bench.record()
    bench.control.markers.mark()
    bench.page.markers.line.name.setText("hydrant")
    bench.press()
    bench.press(after_s=1.0)
    assert bench.recorder.points[0].name == "hydrant"
    assert bench.recorder.asked.index("stop") > bench.recorder.asked.index(("amend", "marker 1", "hydrant"))


# --- the engine room ---


def test_no_call_of_the_recorder_but_a_look_is_made_in_the_windows_thread(bench):
    bench.record()
    bench.control.markers.mark()
    bench.press()
    bench.press(after_s=1.0)
    assert threading.main_thread() not in bench.recorder.threads


def test_a_view_that_stumbles_is_begun_anew_and_the_recording_goes_on(bench, monkeypatch):
    told = []
    monkeypatch.setattr("sys.excepthook", lambda *what: told.append(what[1]))
    bench.record()
    bad = dataclasses.replace(sound_block(0), frames=None)
    bench.recorder.feed.add(bad, sound_block(0))
    bench.qtbot.waitUntil(lambda: bool(told))
    for k in range(20):
        bench.recorder.feed.add(sound_block(800 * k))
    bench.qtbot.waitUntil(lambda: bench.page.spectrogram._ring is not None)
    assert bench.control.recording
    assert len(told) == 1


def test_a_panel_for_the_check_stands_second(bench):
    panel = QWidget()
    bench.page.add_panel("prelaunch", "Check", panel)
    assert bench.page._tabs.indexOf(panel) == 1
    bench.page.show_panel("prelaunch")
    assert bench.page._tabs.currentWidget() is panel


def test_a_listener_hears_every_block_until_it_has_had_enough(bench):
    heard = []
    end = bench.control.listen(heard.append)
    bench.enter()
    bench.recorder.feed.add(sound_block(0), motion_block(0.0))
    bench.qtbot.waitUntil(lambda: len(heard) == 2)
    end()
    bench.recorder.feed.add(sound_block(800))
    bench.qtbot.waitUntil(lambda: not bench.recorder.feed.blocks)
    bench.qtbot.wait(30)
    assert len(heard) == 2
    assert heard[0].first_frame == 0
    assert RATE_HZ == 8000


@pytest.mark.parametrize("theme", [LIGHT, SUN])
def test_every_theme_draws_without_a_word(bench, theme, capsys):
    bench.enter()
    bench.page.apply_theme(theme)
    levels = {"rms_db": (-1.0, -40.0), "peak_db": (0.0, -30.0), "held_peak_db": (0.0, -20.0)}
    bench.recorder.change_sound(clipped=(True, False), **levels)
    bench.recorder.feed.add(*(sound_block(800 * k) for k in range(5)), *(motion_block(0.1 * k) for k in range(20)))
    bench.control.look()
    bench.qtbot.waitUntil(lambda: bool(bench.page.strips._strips))
    bench.page.grab()
    assert capsys.readouterr().err == ""
