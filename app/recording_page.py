"""The recording page: button, markers and choices at the left; what the device hears, feels and where it is, right."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from processing import messages
from processing.live.picture import STRIP_CHANNELS
from processing.live.stream import LinkState, MotionStatus, SoundStatus
from processing.survey import FloatArray, TiePoint
from widgets.attitude_ball import AttitudeBall
from widgets.device_form import DeviceForm
from widgets.level_meter import LevelMeter
from widgets.live_path_view import LivePathView, LivePlace
from widgets.live_spectrogram import LiveSpectrogram
from widgets.live_strips import LiveStrips, StripKind
from widgets.marker_line import MarkerPanel
from widgets.plot_scale import number_text
from widgets.plot_theme import Theme
from widgets.recording_form import RecordingForm
from widgets.recording_panel import MessageList, RecordingPanel
from widgets.recording_words import rate_text
from widgets.state_badge import StateBadge

if TYPE_CHECKING:
    from processing.live.picture import LivePicture, LivePolyline

PRELAUNCH = "prelaunch"  # the name under which the check before the launch is added
LEFT_WIDTH = 430
_FORCE, _TURN = STRIP_CHANNELS.index("acc_x_mps2"), STRIP_CHANNELS.index("gyr_x_radps")


class RecordingPage(QWidget):
    """Holds the widgets; :class:`app.recording_control.RecordingControl` fills them and listens to them."""

    process_asked = Signal()
    another_asked = Signal()

    def __init__(self, theme: Theme, language: str) -> None:
        super().__init__()
        self.language = language
        self.panel = RecordingPanel(theme)
        self.messages = MessageList()
        self.markers = MarkerPanel()
        self.devices = DeviceForm()
        self.form = RecordingForm()
        self.sound_badge, self.imu_badge = StateBadge(self.tr("Sound"), theme), StateBadge(self.tr("IMU"), theme)
        self.meter = LevelMeter(theme)
        self.spectrogram = LiveSpectrogram(theme)
        kinds = (
            StripKind(self.tr("force"), "m/s²", 12.0, slice(_FORCE, _FORCE + 3)),
            StripKind(self.tr("turn rate"), "°/s", 20.0, slice(_TURN, _TURN + 3), math.degrees(1.0)),
        )
        self.strips = LiveStrips(kinds, theme)
        self.ball = AttitudeBall(theme)
        self.path = LivePathView(theme)
        views = (self.meter, self.spectrogram, self.strips, self.ball, self.path)
        self._themed = (self.panel, self.sound_badge, self.imu_badge, *views)
        self._tabs = QTabWidget()
        self._names: list[str] = []
        self._sound_form: tuple[int, int] | None = None
        self._strip_columns = 0
        self._path: LivePolyline | None = None
        self._way: FloatArray = np.zeros((0, 2))
        self._marks: Sequence[TiePoint] = ()
        self._lay_out()

    # --- building ---

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(8)
        row.addWidget(self._left())
        row.addWidget(self._right(), 1)
        row.setContentsMargins(6, 6, 6, 6)
        self.setLayout(row)

    def _left(self) -> QWidget:
        left = QWidget()
        left.setFixedWidth(LEFT_WIDTH)
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addWidget(self.panel)
        column.addWidget(self._build_done())
        column.addWidget(self.markers)
        column.addWidget(self._tabs, 1)
        self.add_panel("setup", self.tr("Set-up"), self._scrolled(self._setup()))
        self.add_panel("markers", self.tr("Markers"), self.markers.list)
        self.add_panel("messages", self.tr("Messages"), self.messages)
        return left

    def _setup(self) -> QWidget:
        setup = QWidget()
        column = QVBoxLayout(setup)
        column.setContentsMargins(6, 6, 6, 6)
        column.addWidget(self.devices)
        line = QFrame()
        line.setFrameShape(QFrame.Shape.HLine)
        column.addWidget(line)
        column.addWidget(self.form)
        column.addStretch(1)
        return setup

    def _scrolled(self, inner: QWidget) -> QScrollArea:
        area = QScrollArea()
        area.setWidget(inner)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        return area

    def _build_done(self) -> QWidget:
        self._done = QFrame()
        self._done.setFrameShape(QFrame.Shape.StyledPanel)
        self._done_text = QLabel()
        self._done_text.setWordWrap(True)
        self._done_text.setTextFormat(Qt.TextFormat.PlainText)
        self._done_text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.process = QPushButton(self.tr("Process now"))
        self.process.setObjectName("process_recording")
        self.process.clicked.connect(self.process_asked)
        self.another = QPushButton(self.tr("Record another"))
        self.another.setObjectName("record_another")
        self.another.clicked.connect(self.another_asked)
        row = QHBoxLayout()
        for button in (self.process, self.another):
            button.setMinimumHeight(56)
            row.addWidget(button)
        column = QVBoxLayout(self._done)
        column.setContentsMargins(8, 6, 8, 6)
        column.addWidget(self._done_text)
        column.addLayout(row)
        self._done.hide()
        return self._done

    def _right(self) -> QWidget:
        right = QWidget()
        head = QHBoxLayout()
        badges = QVBoxLayout()
        badges.setSpacing(2)
        badges.addWidget(self.sound_badge)
        badges.addWidget(self.imu_badge)
        head.addLayout(badges, 3)
        head.addWidget(self.meter, 2)
        foot = QHBoxLayout()
        foot.setSpacing(4)
        foot.addWidget(self.ball, 1)
        foot.addWidget(self.path, 3)
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addWidget(self.messages.banner)  # not above all: the button must not move away under the hand
        column.addLayout(head)
        column.addWidget(self.spectrogram, 4)
        column.addWidget(self.strips, 3)
        column.addLayout(foot, 3)
        return right

    # --- panels ---

    def add_panel(self, name: str, title: str, widget: QWidget) -> None:
        """Add a tab at the left under a name; the check before the launch comes second, whenever it is added."""
        at = 1 if name == PRELAUNCH and self._names else len(self._names)
        self._names.insert(at, name)
        self._tabs.insertTab(at, widget, title)

    def show_panel(self, name: str) -> None:
        """Bring a tab to the front."""
        self._tabs.setCurrentIndex(self._names.index(name))

    # --- what is shown ---

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        for widget in self._themed:
            widget.apply_theme(theme)

    def show_done(self, text: str) -> None:
        """Say what was recorded and offer what comes next; empty hides it."""
        self._done_text.setText(text)
        self._done.setVisible(bool(text))
        self.markers.setVisible(not text)

    def show_links(self, sound: SoundStatus, motion: MotionStatus, sound_reason: str = "") -> None:
        """Say how the devices are; ``sound_reason`` is why there is no sound, as a sentence."""
        self.meter.set_status(sound)
        detail = []
        if sound.sample_rate_hz:
            detail.append(rate_text(sound.sample_rate_hz) + (f" × {sound.channels}" if sound.channels > 1 else ""))
        detail.append(sound.device)
        silent = sound.state is LinkState.LIVE and sound.is_digital_silence
        state = LinkState.SILENT if silent else sound.state
        self.sound_badge.set_state(state, " · ".join(part for part in detail if part))
        detail = [motion.protocol, motion.device]
        if motion.rate_hz:
            detail.insert(0, f"{number_text(motion.rate_hz, 0, self.locale())} Hz")
        self.imu_badge.set_state(motion.state, " · ".join(part for part in detail if part))
        self.path.set_stale(stale=motion.state is not LinkState.LIVE)
        good = (LinkState.LIVE, LinkState.ENDED)
        why = messages.table("reasons", self.language).get(motion.reason, "")
        for view, badge, is_good, reason in (
            (self.spectrogram, self.sound_badge, state in good, sound_reason),
            (self.strips, self.imu_badge, motion.state in good, why),
        ):
            words = badge.text.partition(" · ")[0] + (f"\n{reason}" if reason else "")
            view.set_hint("" if is_good else words)

    def forget_views(self) -> None:
        """Begin the live views anew with the next picture."""
        self._sound_form, self._strip_columns, self._path, self._marks = None, 0, None, ()
        self._way = np.zeros((0, 2))

    def show_picture(self, picture: "LivePicture") -> None:
        """Draw what is new."""
        sound, strips, pose = picture.sound, picture.strips, picture.pose
        if sound is not None:
            form = (len(sound.frequency_hz), sound.capacity)
            if form != self._sound_form:
                self._sound_form = form
                self.spectrogram.set_axes(sound.frequency_hz, sound.capacity, sound.column_s)
            self.spectrogram.add_columns(sound.first, sound.tiles, sound.is_gap)
        if strips is not None:
            if strips.capacity != self._strip_columns:
                self._strip_columns = strips.capacity
                self.strips.set_columns(strips.capacity)
            self.strips.add_columns(strips.first, strips.low, strips.high)
        if picture.path is not None:
            self._path, self._way = picture.path, picture.path.position_w_m[:, :2]
        if pose is None:
            self.ball.set_attitude(None)
            self.path.set_place(LivePlace())
            return
        self.ball.set_attitude(np.array(pose.q_ws))
        here = pose.position_w_m[:2]
        marks = self._placed_marks()
        self.path.set_place(
            LivePlace(self._way, here, pose.chainage_m, pose.sigma_along_m, pose.speed_mps, pose.is_still, marks)
        )

    def set_marks(self, marks: Sequence[TiePoint]) -> None:
        """Draw these on the path from the next picture on."""
        self._marks = marks

    def _placed_marks(self) -> list[tuple[str, float, float]]:
        """Return name, east and north of the markers that the path has reached."""
        path = self._path
        if path is None or not len(path.time_s):
            return []
        placed = []
        for mark in self._marks:
            if mark.time_s <= path.time_s[-1]:
                east, north = (float(np.interp(mark.time_s, path.time_s, path.position_w_m[:, k])) for k in (0, 1))
                placed.append((mark.name, east, north))
        return placed
