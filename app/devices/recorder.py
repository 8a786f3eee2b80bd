"""Records from the devices of a plan: heard from :meth:`Recorder.open` on, written from ``start`` to ``stop``.

Plain threads, no window: sound and motion come on threads of their own and never wait for each other, for the disc or
for whoever looks; one more thread looks after what happened a few times a second. A recording that can no longer be
written ends by itself; a device that goes and comes back does not end it.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from app.devices.audio_input import AudioInput
from app.devices.imu_link import ImuLink
from app.devices.live_feed import LiveFeed
from app.devices.motion_intake import LinkMaker, MotionIntake
from app.devices.recorder_events import Happenings
from app.devices.recording_plan import RecordingPlan, dated, writer_target
from app.devices.sound_intake import InputMaker, SoundIntake
from app.devices.take import Take
from processing.errors import ErrorCode, LeaklineError
from processing.live.check_sheet import CheckSheet
from processing.live.decoders import decoder_named
from processing.live.sound_timeline import ClockGuess
from processing.live.stream import DiscStatus, MotionStatus, RecordingState, RecordingStatus, SoundStatus
from processing.storage.journal import JournalEvent
from processing.storage.recording_writer import RecordingWriter
from processing.survey import Severity, Survey, TiePoint

log = logging.getLogger(__name__)

LOOK_S = 0.2
SOUND_DRAIN_S = 1.0  # stopping waits this long for the sound of the last moment, which is on its way
_STOP_S = 330.0  # a little longer than the writer takes at most

WriterMaker = Callable[..., RecordingWriter]


@dataclass(frozen=True)
class Makers:
    """What a recorder is composed of; tests put simple devices in their places."""

    sound_input: InputMaker = AudioInput
    imu_link: LinkMaker = ImuLink
    writer: WriterMaker = RecordingWriter.create


class Recorder:
    """All methods may be called from any thread; :meth:`close` ends everything and may be called at any time.

    With ``is_shown`` False nobody takes from :attr:`feed`, and nothing is put into it.
    """

    def __init__(
        self,
        plan: RecordingPlan,
        makers: Makers | None = None,
        *,
        is_shown: bool = True,
        drain_s: float = SOUND_DRAIN_S,
    ) -> None:
        makers = makers or Makers()
        self._drain_s = drain_s
        self.plan = plan
        self.feed = LiveFeed(is_open=is_shown)
        self._make_writer = makers.writer
        self._told = Happenings(time.monotonic)
        self._sound = None if plan.sound is None else SoundIntake(plan.sound, makers.sound_input, self._told, self.feed)
        self._motion: MotionIntake | None = None
        if plan.motion is not None:
            decoder = decoder_named(plan.motion.protocol)
            self._motion = MotionIntake(plan.motion, makers.imu_link, decoder, self._told, self.feed)
        self._lock = threading.RLock()  # of starting, stopping and marking; never held while a stream waits
        self._state = RecordingState.MONITORING
        self._take: Take | None = None
        self._fault: LeaklineError | None = None
        self._opened_s = time.monotonic()
        self._is_closed = False
        self._wake = threading.Event()
        self._keeper = threading.Thread(target=self._look_after, name="recorder", daemon=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # --- the devices

    def open(self) -> None:
        """Let the devices run: they are heard, nothing is written.

        Raises:
            LeaklineError: SOUND_LIBRARY_MISSING; whatever else is wrong with a device is told by :meth:`status`.
        """
        self._opened_s = time.monotonic()
        if self._sound is not None:
            self._sound.open()
        if self._motion is not None:
            self._motion.open()
        self._keeper.start()

    def close(self) -> None:
        """Stop a recording, let the devices go and end all threads; a second call does no harm."""
        try:
            self.stop()
        finally:  # a fault of ours while it ends is no reason to keep the devices
            self._let_go()

    def _let_go(self) -> None:
        with self._lock:
            if self._is_closed:
                return
            self._is_closed = True
        self._wake.set()
        closers = [intake.close for intake in (self._sound, self._motion) if intake is not None]
        threads = [threading.Thread(target=close, name="closing", daemon=True) for close in closers]
        for thread in threads:  # side by side: either may hang for some seconds
            thread.start()
        for thread in threads:
            thread.join(5.0)
        if self._keeper.ident is not None and self._keeper is not threading.current_thread():
            self._keeper.join(5.0)

    @property
    def fault(self) -> LeaklineError | None:
        """Why the last recording ended by itself, None where it did not."""
        return self._fault

    @property
    def sound_fault(self) -> LeaklineError | None:
        """Why there is no sound at this moment."""
        return None if self._sound is None else self._sound.fault

    def clear_clip(self) -> None:
        """Let the meter forget that the sound was too loud."""
        if self._sound is not None:
            self._sound.clear_clip()

    # --- a recording

    def start(self, survey: Survey | None = None, target: Path | None = None) -> Path:
        """Begin to write into a new folder and return it; the devices run on as they are.

        ``survey`` and ``target`` take the place of the plan's for this and later recordings.

        Raises:
            LeaklineError: RECORDING_RUNNING, DISC_FULL, CANNOT_WRITE.
        """
        with self._lock:
            if self._state in (RecordingState.RECORDING, RecordingState.STOPPING) or self._is_closed:
                raise LeaklineError(ErrorCode.RECORDING_RUNNING)
            if survey is not None or target is not None:
                self.plan = replace(self.plan, survey=survey or self.plan.survey, target=target or self.plan.target)
            plan = self.plan
            writer = self._make_writer(
                writer_target(plan.target),
                dated(plan.survey, plan.target),
                None if self._sound is None else self._sound.form(),
                motion=self._motion is not None,
                part_s=plan.part_s,
                operator=plan.operator,
            )
            take = Take(writer, self._sound, self._motion, self._told, plan.planned_s)
            self._fault = None
            self._told.clear()
            self._told.attach(writer)
            self._told.note("devices", **self._devices())
            self.feed.clear()
            if self._sound is not None:
                self._sound.begin(writer)
            if self._motion is not None:
                self._motion.begin(writer)
            self._take = take
            self._state = RecordingState.RECORDING
            return writer.path

    def mark(
        self,
        name: str,
        chainage_m: float | None = None,
        *,
        host_s: float | None = None,
        **place: Any,  # noqa: ANN401  # the other fields of a TiePoint, which checks them
    ) -> TiePoint:
        """Keep that the device is at a known place now, or was at ``host_s``; it is on the disc when this returns.

        ``place`` are the fields of a :class:`~processing.survey.TiePoint`: ``latitude``, ``sigma_m`` … Without any
        the marker only has a name and a time, and its place can be told later.

        Raises:
            LeaklineError: RECORDING_NOT_RUNNING.
        """
        now = time.monotonic() if host_s is None else host_s
        return self._running().mark(now, name, {"chainage_m": chainage_m, **place})

    def amend(self, old: TiePoint, new: TiePoint | None) -> TiePoint | None:
        """Put another tie point in the place of one that was marked, or take it back; on the disc when this returns.

        Returns what is kept: a time that is known better by now stays so. Raises RECORDING_NOT_RUNNING.
        """
        return self._running().amend(old, new)

    def unmark(self) -> TiePoint | None:
        """Take the last marker back and return it, None where there is none; raises RECORDING_NOT_RUNNING."""
        take = self._running()
        last = take.points[-1] if take.points else None
        if last is not None:
            take.amend(last, None)
        return last

    @property
    def marks(self) -> tuple[TiePoint, ...]:
        """The markers of the recording under way, or of the last one, in the order in which they were set."""
        take = self._take
        return () if take is None else take.points

    def stop(self) -> Path | None:
        """End the recording and return its folder; the devices run on. None where nothing was ever recorded.

        Any thread may call it, several at once; it returns when all is on the disc, or the disc answers no more.
        """
        with self._lock:
            take = self._take
            is_mine = take is not None and self._state is RecordingState.RECORDING
            if is_mine:
                self._state = RecordingState.STOPPING
        if take is None:
            return None
        if is_mine:
            self._finish(take)
        take.done.wait(_STOP_S)
        return take.writer.path

    def keep_sheet(self, sheet: CheckSheet) -> None:
        """Keep the sheet of a check with the recording under way; without one it is passed over."""
        self._told.note(JournalEvent.CHECK, **sheet.to_json())

    # --- one look

    def status(self) -> RecordingStatus:
        """Return how everything is; cheap, and waits for nobody."""
        now, take, state = time.monotonic(), self._take, self._state
        findings = self._told.findings if take is None or take.findings is None else take.findings
        if take is None:
            elapsed_s, survey_s, disc = 0.0, None, DiscStatus()
        else:
            elapsed_s, survey_s = take.elapsed_s, take.survey_s(take.ended_s or now)
            disc, findings = take.writer.status(), (*take.writer.findings, *findings)
        return RecordingStatus(
            state=state,
            elapsed_s=elapsed_s,
            survey_s=survey_s,
            folder=None if take is None else take.writer.path,
            sound=SoundStatus() if self._sound is None else self._sound.status(),
            motion=MotionStatus() if self._motion is None else self._motion.status(),
            disc=disc,
            markers=0 if take is None else len(take.points),
            feed_dropped=self.feed.dropped,
            findings=findings,
        )

    def clock(self) -> ClockGuess | None:
        """Return how the recording's sound lies on survey time, as known by now; None where either is missing."""
        take = self._take
        return None if take is None else take.clock()

    # --- inside

    def _running(self) -> Take:
        take = self._take
        if take is None or self._state is not RecordingState.RECORDING:
            raise LeaklineError(ErrorCode.RECORDING_NOT_RUNNING)
        return take

    def _devices(self) -> dict[str, dict[str, str]]:
        sound, motion = self._sound, self._motion
        told: dict[str, dict[str, str]] = {}
        if sound is not None:
            status = sound.status()
            told["sound"] = {"asked": str(sound.choice), "device": status.device, "source": status.source}
        if motion is not None:
            felt = motion.status()
            told["motion"] = {"asked": str(motion.choice), "device": felt.device, "protocol": felt.protocol}
        return told

    def _finish(self, take: Take) -> None:
        """Bring a recording to its end: in the thread that asked, once."""
        take.ended_s = time.monotonic()
        try:
            try:
                self._take_last(take, take.ended_s)
            finally:  # the files come to their end whatever happened before
                self._told.attach(None)
                take.writer.close()
        finally:
            fault = take.writer.fault
            if fault is not None:
                self._fault = fault
                is_full = fault.code is ErrorCode.DISC_FULL
                self._told.tell("recorder_ended_disc" if is_full else "recorder_ended_fault", Severity.WARNING)
                take.findings = (*(take.findings or ()), self._told.findings[-1])
            with self._lock:
                self._state = RecordingState.STOPPED if fault is None else RecordingState.FAILED
            take.done.set()

    def _take_last(self, take: Take, ended_s: float) -> None:
        if self._sound is not None:
            self._sound.end(ended_s, self._drain_s)
        if self._motion is not None:
            self._motion.end()
        take.findings = self._told.findings  # what is noticed from here on is not of this recording
        take.settle()
        self._told.note("counts", **take.counts())

    # --- the thread that looks after everything

    def _look_after(self) -> None:
        while not self._is_closed:
            self._wake.wait(LOOK_S)
            try:
                self._look()
            except Exception:  # what it would have told is lost, the recording is not
                log.exception("looking after the recording failed")

    def _look(self) -> None:
        now = time.monotonic()
        take = self._take if self._state is RecordingState.RECORDING else None
        if take is not None and take.writer.fault is not None:
            self.stop()
            return
        if self._sound is not None:
            self._sound.look(now)
        if self._motion is not None:
            self._motion.look(now)
        if take is not None:
            take.look(now)
