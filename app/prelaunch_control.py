"""Drives the check before the launch with the blocks of the recording page, and has its sheet kept with the survey.

The blocks are judged in the live views' thread; the window only looks, ten times a second.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from typing import Protocol

from PySide6.QtCore import QObject, QTimer, Signal, SignalInstance

from app.battery import Battery
from app.recording_parts import Block, RecordingWish
from app.settings import PreferencesStore
from processing.live.check_sheet import CheckSheet, CheckView, Phase
from processing.live.prelaunch import CheckPlan, PrelaunchCheck, Surroundings
from processing.live.stream import LinkState, RecordingState, RecordingStatus
from widgets.optional_number import parse_number
from widgets.prelaunch_panel import SPEEDS_MPS, PrelaunchPanel

LOOK_MS = 100
PLANNED_S = 3600.0  # where nobody said how long it takes


def remember_check(panel: PrelaunchPanel, preferences: PreferencesStore) -> None:
    """Keep the panel's numbers for the next time."""
    speed = "" if panel.speed_mps is None else repr(panel.speed_mps)
    kept = {"check_speed_mps": speed, "check_range_dps": repr(panel.gyro_range_dps)}
    preferences.change(recording={**preferences.values.recording, **kept})


def recall_check(panel: PrelaunchPanel, preferences: PreferencesStore) -> None:
    """Put them back; what is no number is left as a new panel has it."""
    kept = preferences.values.recording
    try:
        speed = parse_number(kept.get("check_speed_mps", ""))
        full_scale = parse_number(kept.get("check_range_dps", ""))
    except ValueError:
        return
    if speed is not None and not SPEEDS_MPS[0] <= speed <= SPEEDS_MPS[1]:
        speed = None
    panel.set_values(speed, full_scale or panel.gyro_range_dps)


class Host(Protocol):
    """The recording page's control, as far as the check needs it."""

    looked: SignalInstance  # ten times a second

    @property
    def status(self) -> RecordingStatus | None:
        """The last look at the recorder."""

    @property
    def wish(self) -> RecordingWish:
        """What is to be recorded."""

    @property
    def recording(self) -> bool:
        """Whether it is being recorded."""

    def listen(self, listener: Callable[[Block], None]) -> Callable[[], None]:
        """Hand every block to ``listener`` too; returns what ends that."""

    def keep_sheet(self, sheet: CheckSheet) -> None:
        """Store the sheet with the recording under way."""


class _Running:
    """One check under way, shared by the thread that brings blocks and the window's."""

    def __init__(self, check: PrelaunchCheck, monotonic: Callable[[], float]) -> None:
        self._check, self._monotonic = check, monotonic
        self._lock = threading.Lock()
        self._rate_hz = 0.0

    def add(self, block: Block) -> None:
        """Take a block, in the live views' thread."""
        with self._lock:
            self._check.add(block, self._rate_hz)

    def look(self, around: Surroundings) -> CheckView:
        """Go on to the next phase where it is time."""
        with self._lock:
            self._rate_hz = around.sound.sample_rate_hz
            return self._check.tick(self._monotonic(), around)

    def skip(self) -> None:
        """Leave the present phase."""
        with self._lock:
            self._check.skip(self._monotonic())

    def sheet(self) -> CheckSheet:
        """Return the lights so far."""
        with self._lock:
            return self._check.sheet()


class PrelaunchControl(QObject):
    """Lives as long as the panel; ``finished`` brings the sheet."""

    finished = Signal(object)  # CheckSheet

    def __init__(
        self,
        panel: PrelaunchPanel,
        host: Host,
        battery: Callable[[], Battery | None],
        parent: QObject,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(parent)
        self._panel, self._host, self._battery, self._monotonic = panel, host, battery, monotonic
        self._running: _Running | None = None
        self._forget: Callable[[], None] | None = None
        self._power: Battery | None = None
        self._waiting: CheckSheet | None = None  # for the recording that comes
        self._timer = QTimer(self)
        self._timer.setInterval(LOOK_MS)
        self._timer.timeout.connect(self.look)
        panel.check_asked.connect(self.begin)
        panel.skip_asked.connect(self._skip)
        panel.stop_asked.connect(self.break_off)
        host.looked.connect(self.show_ready)

    @property
    def running(self) -> bool:
        """Whether a check is under way."""
        return self._running is not None

    def show_ready(self) -> None:
        """Say what can be asked for now."""
        status = self._host.status
        alive = status is not None and LinkState.LIVE in (status.sound.state, status.motion.state)
        self._panel.set_ready(devices=alive, recording=self._host.recording)
        self._hand_over()
        if status is None and self._running is not None:  # the devices were let go
            self.break_off()

    def begin(self, kind: str) -> None:
        """Begin the check before the launch, or (``end``) the knocks at the end."""
        self.break_off()
        self._power = self._battery()
        check = PrelaunchCheck(self._plan(kind), self._monotonic(), datetime.now(UTC).isoformat(timespec="seconds"))
        running = _Running(check, self._monotonic)
        self._running = running
        self._forget = self._host.listen(running.add)
        self._panel.show_sheet(None)
        self._timer.start()
        self.look()

    def _plan(self, kind: str) -> CheckPlan:
        wish, status, panel = self._host.wish, self._host.status, self._panel
        has_sound = status is not None and status.sound.state is not LinkState.OFF
        has_motion = status is not None and status.motion.state is not LinkState.OFF
        device = wish.survey.device
        return CheckPlan(
            kind,
            device.motion,
            device.radius_m,
            panel.speed_mps,
            panel.gyro_range_dps,
            wish.planned_s or PLANNED_S,
            has_sound,
            has_motion,
        )

    def look(self) -> None:
        """Show how far it is; at its end keep the sheet."""
        running = self._running
        if running is None:
            return
        view = running.look(self._around())
        self._panel.show_view(view)
        if view.phase is Phase.DONE:
            self._end()
            sheet = running.sheet()
            self._panel.show_sheet(sheet)
            self._waiting = sheet
            self._hand_over()
            self.finished.emit(sheet)

    def _hand_over(self) -> None:
        """Have the last sheet stored: at once while it is recorded, else when the recording begins."""
        status = self._host.status
        if self._waiting is not None and status is not None and status.state is RecordingState.RECORDING:
            self._host.keep_sheet(self._waiting)
            self._waiting = None

    def _around(self) -> Surroundings:
        status = self._host.status or RecordingStatus()
        known = Surroundings(status.sound, status.motion, status.disc)
        if self._power is None:
            return known
        return replace(known, battery_pct=100.0 * self._power.part, is_plugged=self._power.plugged)

    def _skip(self) -> None:
        if self._running is not None:
            self._running.skip()
            self.look()

    def _end(self) -> None:
        self._timer.stop()
        self._running = None
        if self._forget is not None:
            self._forget()
            self._forget = None

    def break_off(self) -> None:
        """End a check without a sheet."""
        if self._running is not None:
            self._end()
            self._panel.show_broken_off()
