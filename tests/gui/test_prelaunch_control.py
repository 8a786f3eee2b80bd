"""The check as it is driven from the recording page: asked for, guided, kept."""

from pathlib import Path

import pytest
from bench_ball import HOST_S, IMU_RATE, IRREGULAR, RATE, Bench
from PySide6.QtCore import QObject, Signal

from app.battery import Battery
from app.prelaunch_control import PrelaunchControl, recall_check, remember_check
from app.recording_parts import RecordingWish
from app.settings import PreferencesStore
from processing.live.check_sheet import Light
from processing.live.stream import DiscStatus, LinkState, MotionStatus, RecordingState, RecordingStatus, SoundStatus
from processing.survey import DeviceInfo, Survey
from widgets.device_form import MotionWish, SoundWish
from widgets.prelaunch_panel import PrelaunchPanel


class Page(QObject):
    """Stands in for the recording page's control; its time passes when :meth:`live` is called."""

    looked = Signal()

    def __init__(self, bench):
        super().__init__()
        self.bench, self.now_s = bench, 0.0
        self.listeners, self.sheets = [], []
        self.recording = False
        self.alive = True
        survey = Survey(device=DeviceInfo(radius_m=0.0475))
        self.wish = RecordingWish(survey, Path(), SoundWish(), MotionWish(), 7200.0)

    @property
    def status(self):
        if not self.alive:
            return None
        sound = SoundStatus(LinkState.LIVE, "mic", float(RATE), 1, int(self.now_s * RATE))
        motion = MotionStatus(LinkState.LIVE, "ball", "frames", IMU_RATE, int(self.now_s * IMU_RATE))
        state = RecordingState.RECORDING if self.recording else RecordingState.MONITORING
        return RecordingStatus(state, sound=sound, motion=motion, disc=DiscStatus(10**12, 1e5, 90000.0))

    def listen(self, listener):
        self.listeners.append(listener)
        return lambda: self.listeners.remove(listener)

    def keep_sheet(self, sheet):
        self.sheets.append(sheet)

    def monotonic(self):
        return HOST_S + self.now_s

    def live(self, control, seconds):
        end_s = min(self.now_s + seconds, 29.9)
        while self.now_s < end_s and control.running:
            before, self.now_s = self.now_s, self.now_s + 0.1
            for listener in list(self.listeners):
                listener(self.bench.sound(before, self.now_s))
                listener(self.bench.motion(before, self.now_s))
            control.look()


@pytest.fixture
def made(qtbot):
    def make(knocks=IRREGULAR):
        panel, page = PrelaunchPanel("en"), Page(Bench(knocks))
        qtbot.addWidget(panel)
        panel.set_values(0.8, 2000.0)
        parent = QObject(panel)
        return panel, page, PrelaunchControl(panel, page, lambda: Battery(0.9, plugged=False), parent, page.monotonic)

    return make


def test_a_whole_check_ends_with_a_sheet_that_the_recording_keeps(made):
    panel, page, control = made()
    page.looked.emit()
    panel.start.click()
    assert control.running
    page.live(control, 30.0)
    assert not control.running
    assert page.listeners == page.sheets == []
    page.recording = True
    page.looked.emit()
    page.looked.emit()
    (sheet,) = page.sheets
    assert sheet.kind == "launch"
    assert {item.light for item in sheet.items if item.key != "field"} == {Light.GREEN}
    assert len(panel.texts()) == len(sheet.items)


def test_what_was_skipped_is_said_not_to_be_checked(made, qtbot):
    panel, page, control = made()
    control.begin("launch")
    page.live(control, 5.0)
    panel.skip.click()
    with qtbot.waitSignal(control.finished) as ended:
        page.live(control, 15.0)
    (sheet,) = ended.args
    assert {item.key: item.light for item in sheet.items}["rest"] is Light.OPEN


def test_a_check_that_is_broken_off_leaves_no_sheet(made):
    panel, page, control = made()
    control.begin("launch")
    page.live(control, 5.0)
    panel.cancel.click()
    assert not control.running
    assert page.sheets == page.listeners == []
    control.begin("launch")
    page.alive = False
    page.looked.emit()
    assert not control.running


def test_the_knocks_at_the_end_are_a_sheet_of_their_own(made):
    panel, page, control = made(knocks=(3.0, 3.9, 4.4, 5.6, 6.2))
    page.recording = True
    page.looked.emit()
    panel.knocks.click()
    page.live(control, 12.0)
    (sheet,) = page.sheets
    assert (sheet.kind, [item.key for item in sheet.items]) == ("end", ["knocks"])
    assert sheet.light is Light.GREEN


def test_speed_and_range_are_there_the_next_time(made, tmp_path):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    panel, _, _ = made()
    panel.set_values(0.65, 500.0)
    remember_check(panel, preferences)
    other, _, _ = made()
    recall_check(other, PreferencesStore(tmp_path / "preferences.json"))
    assert (other.speed_mps, other.gyro_range_dps) == (0.65, 500.0)
    preferences.change(recording={"check_speed_mps": "fast"})
    recall_check(other, preferences)
    assert other.speed_mps == 0.65
    preferences.change(recording={"check_speed_mps": "0"})  # which no run has; times are divided by it
    recall_check(other, preferences)
    assert other.speed_mps is None
