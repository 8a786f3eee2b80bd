"""What the recording page tells besides its live views: links, time, disc, battery, and what happened, as sentences."""

import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from app.battery import Battery
from app.ordered_calls import OrderedCalls
from app.recording_page import RecordingPage
from app.recording_parts import RecordingWish
from processing import messages
from processing.errors import LeaklineError
from processing.live.stream import DiscStatus, LinkState, MotionStatus, RecordingState, RecordingStatus, SoundStatus
from processing.survey import Finding, Severity
from widgets.device_form import NONE
from widgets.recording_panel import BATTERY_LOW
from widgets.units import quantities

BATTERY_EVERY_S = 10.0
SPACE_EVERY_S = 5.0
BANNER_S = 20.0  # how long a warning stands above the views; what still holds is said on
_SOUND_BYTES, _MOTION_BYTES = 3, 64  # a sample, about: before anything is written the writer's own figure is not known


class RecordingTelling:
    """Shows one status after the other; knows what was told already."""

    def __init__(
        self,
        page: RecordingPage,
        calls: OrderedCalls,
        battery: Callable[[], Battery | None],
        monotonic: Callable[[], float],
    ) -> None:
        self._page, self._calls, self._battery, self._monotonic = page, calls, battery, monotonic
        self._battery_s = self._space_s = -1e9
        self._told_battery = False
        self._free: tuple[Path, int] | None = None
        self._findings: tuple[Finding, ...] = ()
        self._lines: list[str] = []  # the same as sentences
        self._trouble = ""  # what went wrong outside a recorder
        self._banner, self._banner_until_s = "", 0.0

    def forget(self) -> None:
        """Another recorder, or another recording: what it tells is new."""
        self._findings, self._lines, self._trouble = (), [], ""

    def fail(self, error: Exception) -> None:
        """Tell what the operator can mend; anything else is our fault, and the crash guard's."""
        if not isinstance(error, LeaklineError):
            sys.excepthook(type(error), error, error.__traceback__)
            return
        self._trouble = messages.error_sentence(error, self._page.language)
        self._warn(self._trouble)

    def show(
        self, status: RecordingStatus | None, wish: RecordingWish, sound_fault: LeaklineError | None, *, done: bool
    ) -> None:
        """Show how everything is; None while no device is open, ``done`` after a recording."""
        now = self._monotonic()
        page = self._page
        told = status or _closed(wish, done=done)
        why = "" if sound_fault is None else messages.error_sentence(sound_fault, page.language)
        page.show_links(told.sound, told.motion, why)
        if not done:
            if told.state is RecordingState.MONITORING:
                told = replace(told, disc=self._space(wish.folder, told, now))
            page.panel.show_status(told, now)
        self._show_battery(now)
        self._show_findings(told, now)

    def _space(self, folder: Path, status: RecordingStatus, now: float) -> DiscStatus:
        """Return what the disc would take at the rate of the devices as they are."""
        if now - self._space_s >= SPACE_EVERY_S and self._calls.idle:
            self._space_s = now
            self._calls.run(lambda: _free_bytes(folder), self._take_free)
        if self._free is None or self._free[0] != folder:
            return DiscStatus()
        sound, motion = status.sound, status.motion
        rate = _SOUND_BYTES * sound.sample_rate_hz * sound.channels + _MOTION_BYTES * (motion.rate_hz or 0.0)
        free = self._free[1]
        return DiscStatus(free, rate, free / rate if rate else None)

    def _take_free(self, found: tuple[Path, int] | None) -> None:
        self._free = found

    def _show_battery(self, now: float) -> None:
        if now - self._battery_s < BATTERY_EVERY_S:
            return
        self._battery_s = now
        found = self._battery()
        low = found is not None and found.part < BATTERY_LOW and not found.plugged
        self._page.panel.show_battery(
            None if found is None else found.part, plugged=found is not None and found.plugged
        )
        if low and not self._told_battery:
            self._warn(self._page.panel.battery.text())
        self._told_battery = low

    def _show_findings(self, status: RecordingStatus, now: float) -> None:
        findings = status.findings
        if findings != self._findings:  # some hundred sentences are not to be made ten times a second
            self._lines = [
                messages.finding_sentence(finding, self._page.language, quantities().units) for finding in findings
            ]
            is_new = bool(findings) and (not self._findings or findings[-1] != self._findings[-1])
            if is_new and findings[-1].severity is Severity.WARNING:
                self._warn(self._lines[-1])
            self._findings = findings
        lines = self._lines
        banner = self._banner if now < self._banner_until_s else ""
        recording = status.state is RecordingState.RECORDING
        bad = (LinkState.LOST, LinkState.SILENT, LinkState.WAITING) if recording else (LinkState.LOST,)
        badges = (self._page.sound_badge, self._page.imu_badge)
        lost = ["⚠ " + badge.text.partition(" · ")[0] for badge in badges if badge.state in bad]
        if self._trouble:
            lines = [*lines, self._trouble]
        self._page.messages.show_lines(lines, banner or "   ·   ".join(lost))

    def _warn(self, text: str) -> None:
        self._banner, self._banner_until_s = text, self._monotonic() + BANNER_S


def _closed(wish: RecordingWish, *, done: bool) -> RecordingStatus:
    """Return what is shown while no recorder is open: a device that was chosen is closed, not absent."""
    there = LinkState.ENDED if done else LinkState.WAITING
    return RecordingStatus(
        sound=SoundStatus(LinkState.OFF if wish.sound.name == NONE else there),
        motion=MotionStatus(LinkState.OFF if wish.motion.kind == NONE else there),
    )


def _free_bytes(folder: Path) -> tuple[Path, int] | None:
    """Return the folder and what is free where it is, or would be made; None where that cannot be told."""
    for place in (folder, *folder.parents):
        try:
            return folder, shutil.disk_usage(place).free
        except FileNotFoundError:
            continue
        except OSError:  # a stick that was pulled out: the recorder's own words come when it is to write there
            return None
    return None
