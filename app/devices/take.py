"""One recording under way: its writer, its markers, and how the clocks of its streams lie to each other."""

import logging
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from app.devices.motion_intake import MotionIntake
from app.devices.recorder_events import Happenings
from app.devices.sound_intake import SoundIntake
from processing.live.sound_timeline import ClockGuess, sound_to_survey
from processing.storage.recording_writer import RecordingWriter
from processing.survey import Finding, Severity, TiePoint

log = logging.getLogger(__name__)

CLOCK_EVERY_S = 5.0
CLOCK_FIRST_S = 2.0
MARK_S = 2.0  # a marker is on the disc within this time, or the disc is in trouble and says so itself
PLAN_TOLD_AFTER_S = 5.0  # the rate of writing is known by then
_MOTION_COUNTS = ("samples", "lost", "repeated", "garbage_bytes", "bad_sums", "gaps", "restarts", "clock_ppm")


@dataclass(frozen=True)
class Mark:
    """A marker, and when it was set: survey time may be known better, or at all, only later."""

    point: TiePoint
    told: TiePoint  # as it was when it was set
    host_s: float
    is_on_motion: bool  # its time is that of the IMU's clock, which all others give way to


class Take:
    """Any thread may call; ``ended_s``, ``findings`` and ``done`` are its recorder's."""

    def __init__(
        self,
        writer: RecordingWriter,
        sound: SoundIntake | None,
        motion: MotionIntake | None,
        told: Happenings,
        planned_s: float,
    ) -> None:
        self.writer = writer
        self.began_s = time.monotonic()
        self.ended_s: float | None = None
        self.findings: tuple[Finding, ...] | None = None  # once it has ended
        self.done = threading.Event()
        self._sound, self._motion, self._told, self._planned_s = sound, motion, told, planned_s
        self._marks: tuple[Mark, ...] = ()
        self._lock = threading.Lock()  # of the markers
        self._clock_due_s = self.began_s + CLOCK_FIRST_S
        self._is_plan_told = False

    # --- time

    @property
    def elapsed_s(self) -> float:
        """How long it lasts, or lasted."""
        return (self.ended_s or time.monotonic()) - self.began_s

    def survey_s(self, host_s: float) -> float:
        """Return survey time, on the axis that there is: motion, else sound, else this computer's; waits for nobody."""
        motion_s = self._motion_s(host_s)
        if motion_s is not None:
            return motion_s
        sound_s = None if self._sound is None else self._sound.audio_s(host_s)
        return host_s - self.began_s if sound_s is None else sound_s

    def clock(self) -> ClockGuess | None:
        """Return how the sound lies on survey time, as known by now; None where either is missing."""
        sound, motion = self._sound, self._motion
        if sound is None or motion is None:
            return None
        with sound.lock, motion.lock:
            return None if sound.axis is None else sound_to_survey(sound.axis, motion.timeline)

    def _motion_s(self, host_s: float) -> float | None:
        return None if self._motion is None else self._motion.survey_s(host_s)

    # --- markers

    @property
    def points(self) -> tuple[TiePoint, ...]:
        """The markers, in the order in which they were set."""
        return tuple(mark.point for mark in self._marks)

    def mark(self, host_s: float, name: str, place: Mapping[str, Any]) -> TiePoint:
        """Keep a known place; see :meth:`app.devices.recorder.Recorder.mark`."""
        with self._lock:
            point = TiePoint(name, round(self.survey_s(host_s), 3), **place)
            self.writer.mark(point)
            self._marks += (Mark(point, point, host_s, self._motion_s(host_s) is not None),)
        self._wait_stored()
        return point

    def amend(self, old: TiePoint, new: TiePoint | None) -> TiePoint | None:
        """Put another tie point in the place of a marker, or take it back, and return it with the time known by now.

        Raises:
            ValueError: no such marker was set.
        """
        with self._lock:
            at = next((at for at, mark in enumerate(self._marks) if old in (mark.point, mark.told)), None)
            if at is None:
                raise ValueError(f"no such marker: {old}")
            mark = self._marks[at]
            if new is not None and new.time_s == old.time_s:
                new = replace(new, time_s=mark.point.time_s)
            self.writer.amend(mark.point, new)
            kept = () if new is None else (replace(mark, point=new, told=new),)
            self._marks = self._marks[:at] + kept + self._marks[at + 1 :]
        self._wait_stored()
        return new

    def _wait_stored(self) -> None:
        if not self.writer.wait_stored(MARK_S):
            log.warning("the disc has not taken a marker within %.0f s", MARK_S)

    # --- what is looked after now and then

    def look(self, now: float) -> None:
        """Keep the clocks, and warn of a disc that is too small for the plan; a few times a second."""
        if now >= self._clock_due_s:
            self._clock_due_s = now + CLOCK_EVERY_S
            self.settle()
        left_s, planned_s = self.writer.status().seconds_left, self._planned_s
        if self._is_plan_told or not planned_s or left_s is None or now - self.began_s < PLAN_TOLD_AFTER_S:
            return
        self._is_plan_told = True
        if left_s < planned_s - (now - self.began_s):
            self._told.tell("recorder_disc_plan", Severity.WARNING, minutes=left_s / 60.0, planned=planned_s / 60.0)

    def settle(self) -> None:
        """Keep what is known by now about the clocks, and with it the times of markers set before there was motion."""
        guess = self.clock()
        if guess is not None:
            self.writer.set_clock(guess)
        with self._lock:
            self._marks = tuple(self._settled(mark) for mark in self._marks)

    def _settled(self, mark: Mark) -> Mark:
        survey_s = None if mark.is_on_motion else self._motion_s(mark.host_s)
        if survey_s is None:
            return mark
        point = replace(mark.point, time_s=round(survey_s, 3))
        self.writer.amend(mark.point, point)
        return replace(mark, point=point, is_on_motion=True)

    def counts(self) -> dict[str, Any]:
        """Return what the journal keeps at the end: how much came, and how much did not."""
        counts: dict[str, Any] = {}
        if self._sound is not None:
            sound = self._sound.status()
            counts["sound"] = {"frames": sound.frames, "lost": sound.lost_frames, "gaps": sound.gaps}
        if self._motion is not None:
            motion = self._motion.status()
            counts["motion"] = {name: getattr(motion, name) for name in _MOTION_COUNTS}
        return counts
