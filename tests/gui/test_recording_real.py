"""The recording page with the real recorder: a ball on a socket of this computer, written to a real folder."""

import threading
import time

import pytest
from fake_devices import motion, sent
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget

from app.devices.simulated.ports import TcpPort
from app.recording_control import RecordingControl
from app.recording_devices import make_recorder
from app.recording_page import RecordingPage
from app.recording_parts import FoundDevices, RecordingKit
from app.settings import PreferencesStore
from processing.live.live_view import LiveView
from processing.live.stream import LinkState, RecordingState
from processing.storage.folder import SurveyFolder
from widgets.device_form import MotionWish, SoundWish
from widgets.plot_theme import LIGHT

LEFT = Qt.MouseButton.LeftButton
PATIENCE_MS = 15_000


class Ball(threading.Thread):
    """Sends 400 samples a second to whoever is connected."""

    def __init__(self):
        super().__init__(name="ball", daemon=True)
        self.port, self.end = TcpPort("127.0.0.1", 0), threading.Event()

    @property
    def number(self):
        return int(self.port.spec.rpartition(":")[2])

    def run(self):
        count, begun = 0, None
        while not self.end.wait(0.01):
            if not self.port.is_heard():
                continue
            begun = begun or time.monotonic()
            due = int(400 * (time.monotonic() - begun)) - count
            if due > 0:
                self.port.write([sent(motion(due, count))])
                count += due
        self.port.close()


@pytest.fixture
def ball():
    ball = Ball()
    ball.start()
    yield ball
    ball.end.set()
    ball.join(5.0)
    assert not ball.is_alive()


@pytest.fixture
def control(qtbot, tmp_path, ball):
    assert LiveView  # imported before anything waits for it
    page, window = RecordingPage(LIGHT, "en"), QWidget()
    for widget in (window, page):
        qtbot.addWidget(widget)
    kit = RecordingKit(
        make_recorder=make_recorder, find_devices=FoundDevices, battery=lambda: None, keep_awake=lambda: lambda: None
    )
    control = RecordingControl(page, PreferencesStore(tmp_path / "p.json"), kit, window)
    control.page = page
    page.devices.set_wishes(SoundWish("none"), MotionWish("tcp", "127.0.0.1", ball.number))
    page.form.set_folder(tmp_path / "new" / "recordings")  # not there yet
    page.form.set_places("valve 12 = 3.5")
    page.show()
    control.enter()
    yield control
    control.shut()


def wait(qtbot, condition):
    qtbot.waitUntil(lambda: bool(condition()), timeout=PATIENCE_MS)


def test_a_run_from_the_device_to_a_folder_that_opens(control, qtbot, tmp_path):
    page = control.page
    wait(qtbot, lambda: control.status and control.status.motion.state is LinkState.LIVE)
    assert "frames" in page.imu_badge.text
    name = page.findChild(QWidget, "recording_name")
    name.setText("Gül Sokağı")
    name.editingFinished.emit()
    QTest.mouseClick(page.panel.button, LEFT)
    wait(qtbot, lambda: control.status.state is RecordingState.RECORDING and control.status.elapsed_s > 0.7)
    control.look()
    before_s = control.status.elapsed_s
    QTest.mouseClick(page.markers.button, LEFT)
    control.look()
    after_s = control.status.elapsed_s
    qtbot.wait(700)  # the typing takes its time
    QTest.keyClick(page.markers.line.name, Qt.Key.Key_Return)
    control.markers.mark()
    page.markers.line.given_up.emit()
    control.markers.undo()
    wait(qtbot, lambda: control.status.elapsed_s > 1.8 and control._calls.idle)
    wait(qtbot, lambda: control.status.disc.synced_host_s)
    assert control.status.motion.lost == 0
    control.stop()
    wait(qtbot, page.process.isVisible)
    with qtbot.waitSignal(control.process_asked, timeout=PATIENCE_MS) as asked:
        QTest.mouseClick(page.process, LEFT)
    (path,) = asked.args
    assert path.parent == tmp_path / "new" / "recordings"
    with SurveyFolder.open(path) as folder:
        survey = folder.read_survey()
        assert survey.info.name == "Gül Sokağı"
        (tie,) = survey.tie_points
        assert (tie.name, tie.chainage_m) == ("valve 12", 3.5)
        assert before_s - 0.3 < tie.time_s < after_s + 0.3  # of the press, not of the typing
        assert [file.role for file in folder.files()].count("imu") == 1


def test_a_ball_that_is_not_there_is_waited_for(control, ball, qtbot):
    ball.end.set()
    wait(qtbot, lambda: control.status and control.status.motion.state in (LinkState.WAITING, LinkState.LOST))
    control.look()
    assert "alive" not in control.page.imu_badge.text
