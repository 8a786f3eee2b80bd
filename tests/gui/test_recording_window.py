"""Recording in the whole window: reached by button and keys, marked and stopped by keys, and never ended by mistake."""

import threading

import pytest
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton, QToolButton
from scripted_recorder import Laptop

from app.application import Application
from app.settings import PreferencesStore
from processing.live.live_view import LiveView
from processing.live.stream import RecordingState

KEY, LEFT = Qt.Key, Qt.MouseButton.LeftButton
CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def laptop(tmp_path):
    assert LiveView  # imported before anything waits for it
    return Laptop(tmp_path / "Main-2026-11-22.leakline")


@pytest.fixture
def application(qapp, qtbot, tmp_path, laptop):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.change(language="en", recording={"sound": "USB Mic", "folder": str(tmp_path)})
    application = Application(qapp, preferences, None, why_silent=lambda: None, recording=laptop.kit)
    application.window.show()
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    yield application
    for recorder in laptop.recorders:
        recorder.change(state=RecordingState.STOPPED)
    if application.window.recording.control is not None:
        application.window.recording.control.look()
        qtbot.waitUntil(lambda: not application.window.recording.recording)
    application.window.close()
    application.shut_down()
    application.window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    qapp.setStyleSheet(before[0])
    qapp.setFont(before[1])
    qapp.setPalette(before[2])


@pytest.fixture
def window(application):
    return application.window


class Hand:
    """Presses keys, and lets the time of the presses go by."""

    def __init__(self, qtbot, window, monkeypatch):
        self.qtbot, self.window, self.later_s = qtbot, window, 0.0
        self.clock = lambda: 1000.0 + self.later_s  # a slow computer makes no slow hand
        monkeypatch.setattr(window.recording, "_monotonic", self.clock)
        monkeypatch.setattr(window.recording._closing, "_monotonic", self.clock)

    def press(self, key, modifier=Qt.KeyboardModifier.NoModifier, after_s=0.0):
        self.later_s += after_s
        QTest.keyClick(self.window, key, modifier)
        self.settle()

    def settle(self):
        control = self.window.recording.control
        if control is not None:
            self.qtbot.waitUntil(lambda: control._calls.idle)
            self.qtbot.wait(1)
            self.qtbot.waitUntil(lambda: control._calls.idle)
            self.qtbot.wait(1)
            control.look()

    def record(self):
        self.press(KEY.Key_N, CTRL)
        self.press(KEY.Key_F5)
        assert self.window.recording.recording
        self.later_s += 10.0


@pytest.fixture
def hand(qtbot, window, monkeypatch):
    return Hand(qtbot, window, monkeypatch)


def test_the_start_pages_large_button_leads_to_a_page_that_fits_a_small_laptop(window, hand, laptop):
    button = window.findChild(QPushButton, "start_record")
    assert button.height() >= 64
    QTest.mouseClick(button, LEFT)
    hand.settle()
    assert window.page == "recording"
    assert laptop.recorder.asked == ["open"]
    assert window.recording.page.panel.button.height() >= 64
    assert window.recording.page.markers.button.height() >= 64
    hand.press(KEY.Key_F5)
    for theme in ("light", "sun"):
        while window._preferences.values.theme != theme:
            window.next_theme()
        size = window.minimumSizeHint()
        assert size.width() <= 1366
        assert size.height() <= 680  # 768 less the title and the task bar


def test_a_run_by_keys_alone(window, hand, laptop, monkeypatch):
    opened = []
    monkeypatch.setattr(window.files, "open_path", opened.append)
    window.recording.process_asked.connect(opened.append)
    hand.record()
    hand.press(KEY.Key_M)
    line = window.recording.page.markers.line.name
    QTest.keyClicks(line, "valve m 12")  # an m in a name is no marker
    QTest.keyClick(line, KEY.Key_Return)
    hand.settle()
    hand.press(KEY.Key_F6)
    QTest.keyClick(line, KEY.Key_Escape)
    hand.press(KEY.Key_M)
    QTest.keyClick(line, KEY.Key_Escape)
    hand.press(KEY.Key_Z, CTRL)
    assert [point.name for point in laptop.recorder.points] == ["valve m 12", "marker 2"]
    hand.press(KEY.Key_F5)
    assert laptop.recorder.current.state is RecordingState.RECORDING
    hand.press(KEY.Key_F5, after_s=1.0)
    assert laptop.recorder.current.state is RecordingState.STOPPED
    recent = window.start_page.recent.shown  # who does not process it now finds it there
    assert recent[0].row.path == str(laptop.folder)
    QTest.mouseClick(window.recording.page.process, LEFT)
    assert opened[-1] == laptop.folder


def test_neither_the_space_bar_nor_another_page_ends_a_run(window, hand, laptop):
    hand.record()
    QTest.mouseClick(window.recording.page.panel.button, LEFT)
    for _ in range(3):
        hand.press(KEY.Key_Space, after_s=0.7)
        hand.press(KEY.Key_Return, after_s=0.7)
    assert laptop.recorder.current.state is RecordingState.RECORDING
    window.show_page("start")
    strip = window.recording.strip
    assert strip.isVisible()
    assert "0:00:00" in strip.text()
    assert "close" not in laptop.recorder.asked
    hand.press(KEY.Key_M)  # nothing to mark here
    assert not laptop.recorder.points
    QTest.mouseClick(strip, LEFT)
    assert window.page == "recording"
    assert not strip.isVisible()


def test_closing_the_window_needs_a_second_time_and_stops_cleanly(window, hand, laptop, qtbot):
    hand.record()
    window.close()
    assert window.isVisible()
    assert "running" in window.notices.told.text()
    window.close()  # at once: a hand that trembles
    assert window.isVisible()
    hand.later_s += 1.0
    window.close()
    qtbot.waitUntil(lambda: not window.isVisible())
    assert laptop.recorder.asked[-2:] == ["stop", "close"]


def test_a_window_that_is_closed_while_a_recording_begins_closes_once_that_has_begun(window, hand, laptop, qtbot):
    hand.press(KEY.Key_N, CTRL)
    begins, begin = threading.Event(), laptop.recorder.begin

    def slowly(wish):
        assert begins.wait(5.0)
        return begin(wish)

    laptop.recorder.begin = slowly
    QTest.keyClick(window, KEY.Key_F5)
    window.close()
    hand.later_s += 1.0
    window.close()
    assert window.isVisible()
    begins.set()
    qtbot.waitUntil(lambda: not window.isVisible())
    assert laptop.recorder.asked == ["open", "begin", "stop", "close"]


def test_a_page_that_is_built_when_asked_is_there_again_in_the_other_language(application, hand, monkeypatch):
    application.window.correlator.show()
    application.window.toggle_language()
    assert application.window.page == "correlator"
    assert application.window.findChild(QToolButton, "tool_record").text() == "Kayıt"
    application.window.recording.show()
    hand.window = application.window
    hand.settle()
    application.window.toggle_language()
    assert application.window.page == "recording"


def test_keys_are_the_recordings_only_on_its_page_and_the_language_waits_for_its_end(window, hand, monkeypatch):
    told, actions = [], window.actions_by_id
    monkeypatch.setattr(window.boxes, "tell", told.append)
    assert not actions["mark"].isEnabled()
    assert not actions["record_press"].isEnabled()
    assert not actions["record_press"].autoRepeat()  # a key held down is one press
    assert not actions["mark"].autoRepeat()
    hand.record()
    assert actions["mark"].isEnabled()
    assert actions["record_press"].isEnabled()
    assert not actions["undo"].isEnabled()
    hand.press(KEY.Key_M)
    assert actions["undo"].isEnabled()
    hand.press(KEY.Key_F8)
    assert told
    window.show_page("start")
    assert not actions["mark"].isEnabled()
    assert not actions["undo"].isEnabled()
