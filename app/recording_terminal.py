"""What ``leakline record`` says and hears: events as sentences, one moving line on a terminal, typed lines as marks."""

import os
import queue
import shutil
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from app.devices.audio_devices import list_inputs
from app.devices.audio_spec import AudioChoice
from app.devices.imu_spec import list_serial_ports
from processing import messages
from processing.errors import LeaklineError
from processing.live.stream import LinkState, MotionStatus, RecordingStatus, SoundStatus
from processing.survey import Finding

_LONGEST_NAME = 200
_BACKGROUND_S = 0.5


class Terminal:
    """Sentences go to standard output, the moving line to standard error where that is a terminal."""

    def __init__(self, language: str) -> None:
        self.language = language
        self._moves = sys.stderr is not None and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._hears = sys.stdin is not None and sys.stdin.isatty()
        self._typed: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._told: dict[tuple[str, object], Finding] = {}
        self._is_shown = False
        self._is_heard = True

    # --- what it says

    def say(self, key: str, **params: object) -> None:
        """Say a sentence of the table ``cli``."""
        self.write(self._text(key, **params))

    def begin(self, folder: Path) -> None:
        """Say that the recording runs, and listen to what is typed from now on."""
        self.say("record_begun_terminal" if self._hears else "record_begun", folder=folder.resolve())
        if self._hears:
            threading.Thread(target=self._hear, name="typed", daemon=True).start()

    def tell(self, status: RecordingStatus) -> None:
        """Say the findings that are new; one that only grew since is not said again before the end."""
        for finding in status.findings:
            if _key(finding) not in self._told:
                self._say_finding(finding)

    def show(self, status: RecordingStatus) -> None:
        """Draw the moving line."""
        if not self._moves:
            return
        parts = []
        if status.motion.state is not LinkState.OFF:
            parts.append(self._motion(status.motion))
        if status.sound.state is not LinkState.OFF:
            parts.append(self._sound(status.sound))
        if status.disc.seconds_left is not None:
            parts.append(self._text("record_status_disc", hours=status.disc.seconds_left / 3600.0))
        line = f"{clock_text(status.elapsed_s)}  {' | '.join(parts)}"
        self._draw(line[: shutil.get_terminal_size().columns - 1])
        self._is_shown = True

    def done(self, status: RecordingStatus, folder: Path) -> None:
        """Say what grew since it was told, and what the recording holds."""
        for finding in status.findings:
            if self._told.get(_key(finding)) != finding:
                self._say_finding(finding)
        parts = []
        sound, motion = status.sound, status.motion
        if sound.state is not LinkState.OFF:
            rate_hz = sound.sample_rate_hz or 1.0
            lost_s = sound.lost_frames / rate_hz
            parts.append(self._text("record_part_sound", seconds=sound.frames / rate_hz + lost_s, lost_s=lost_s))
        if motion.state is not LinkState.OFF:
            parts.append(self._text("record_part_motion", samples=motion.samples, lost=motion.lost))
        parts.append(self._text("record_part_marks", markers=status.markers))
        duration = clock_text(status.elapsed_s)
        self.say("record_done", duration=duration, folder=folder.resolve(), parts="; ".join(parts))

    def list_devices(self) -> None:
        """Say which microphones and serial ports there are, as they are named to the command."""
        self.say("record_list_sound")
        try:
            inputs = list_inputs()
        except LeaklineError as error:
            self.write("  " + messages.error_sentence(error, self.language))
        else:
            for device in inputs:
                spec = AudioChoice(device.name)
                about = {"channels": device.channels, "rate": device.default_rate_hz, "api": device.host_api}
                self.say("record_list_device", spec=spec, **about)
            if not inputs:
                self.say("record_list_none")
        self.say("record_list_motion")
        ports = list_serial_ports()
        for port in ports:
            self.say("record_list_port", spec=port, title=port.title)
        if not ports:
            self.say("record_list_none")

    # --- what it hears

    def typed(self) -> Iterator[str]:
        """Yield the lines that were typed since the last time, without the blanks at their ends."""
        while not self._typed.empty():
            yield self._typed.get().strip()[:_LONGEST_NAME]

    def _hear(self) -> None:
        while True:
            try:
                line = sys.stdin.readline()
            except (OSError, ValueError):  # in the background (SIGTTIN is ignored), or the terminal is gone
                time.sleep(_BACKGROUND_S)
                if sys.stdin.closed:
                    return
                continue
            if not line:
                return
            self._typed.put(line)

    # --- pieces

    def _say_finding(self, finding: Finding) -> None:
        self._told[_key(finding)] = finding
        self.write("- " + messages.finding_sentence(finding, self.language))

    def write(self, line: str) -> None:
        """Say a line."""
        if self._is_shown:
            self._draw("")
            self._is_shown = False
        if not self._is_heard:
            return
        try:
            sys.stdout.write(line + "\n")
            sys.stdout.flush()  # whoever watches through a pipe shall see it now
        except OSError:  # nobody reads any more: no reason to end a recording
            self._is_heard = False

    def _draw(self, line: str) -> None:
        try:
            sys.stderr.write(f"\r\x1b[K{line}")
            sys.stderr.flush()
        except OSError:  # the terminal was closed
            self._moves = False

    def _motion(self, motion: MotionStatus) -> str:
        state = messages.text("states", motion.state.value, self.language)
        return self._text("record_status_motion", state=state, rate=motion.rate_hz or 0.0, lost=motion.lost)

    def _sound(self, sound: SoundStatus) -> str:
        state = messages.text("states", sound.state.value, self.language)
        levels = " ".join(f"{level:.0f}{'!' if clip else ''}" for level, clip in zip(sound.rms_db, sound.clipped))
        lost_s = sound.lost_frames / (sound.sample_rate_hz or 1.0)
        return self._text("record_status_sound", state=state, levels=levels or "-", lost_s=lost_s)

    def _text(self, key: str, **params: object) -> str:
        return messages.text("cli", key, self.language, **params)


def _key(finding: Finding) -> tuple[str, object]:
    return finding.code, finding.params.get("at")


def clock_text(seconds: float) -> str:
    """Return a time as hours, minutes and seconds: ``1:02:03``."""
    whole = int(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"
