"""Writes a recording so that all but the last moments survive whatever happens to the program or the computer.

At every moment the folder is an ordinary survey: it can be opened and processed while it is recorded and after a kill,
with nothing to repair. See :mod:`processing.storage.recording_streams` (who writes), ``recording_keeper`` (who syncs).
"""

import shutil
from dataclasses import fields, replace
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any, Protocol, Self

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.frames import Frames
from processing.live.stream import DiscStatus, SoundFrames
from processing.storage.creating import create_folder
from processing.storage.disc_space import RESERVE_BYTES, Aside
from processing.storage.journal import JournalEvent
from processing.storage.recording_keeper import Keeper
from processing.storage.recording_streams import Ending, Streams
from processing.storage.sound_parts import SoundForm, packed
from processing.storage.unfinished import RESERVE_NAME
from processing.survey import Finding, Survey, TiePoint

__all__ = ["PART_S", "ClockNumbers", "RecordingWriter", "SoundForm"]

PART_S = 3600.0
_CLOSE_S = 300.0  # a gigabyte on a slow stick; longer, and the disc is gone


class ClockNumbers(Protocol):
    """The sound's clock against survey time, as known by now; sigmas are 1 sigma."""

    @property
    def start_time_s(self) -> float:
        """Survey time of the first frame."""

    @property
    def drift_ppm(self) -> float:
        """Audio clock minus IMU clock."""

    @property
    def start_sigma_s(self) -> float:
        """Of the start."""

    @property
    def drift_sigma_ppm(self) -> float:
        """Of the drift."""


class RecordingWriter:
    """One recording. All methods may be called from any thread; none but :meth:`close` waits for the disc.

    A fault of the disc never raises: it stands in :attr:`fault`, what was accepted before is written as far as the disc
    takes it, and what comes later is ignored.
    """

    def __init__(
        self, path: Path, survey: Survey, sound: SoundForm | None, part_s: float, operator: str, reserve: int
    ) -> None:
        self.path = path
        self._sound = sound
        self._ending = Ending()
        recording = path / "recordings" / "1"
        aside = Aside(recording / RESERVE_NAME, reserve)
        self._keeper = Keeper(path, survey, operator, reserve, self._ending, aside)
        self._streams = Streams(recording / "original", sound, part_s, self._ending, aside, self._keeper.note)

    @classmethod
    def create(
        cls,
        target: Path,
        survey: Survey,
        sound: SoundForm | None,
        *,
        motion: bool,
        part_s: float = PART_S,
        operator: str = "",
        reserve_bytes: int = RESERVE_BYTES,
    ) -> Self:
        """Make the folder, lock it, and be ready.

        ``target`` is the folder to make, if its name ends in ``.leakline``, else the directory in which one is made
        that is called after the survey and its date (today where it has none); a name that is taken gets ``-2``.

        Raises:
            LeaklineError: DISC_FULL, CANNOT_WRITE.
        """
        if sound is None and not motion:
            raise ValueError("nothing to record")
        if not survey.info.date.strip():
            today = datetime.now(UTC).astimezone().date().isoformat()
            survey = replace(survey, info=replace(survey.info, date=today))
        path = create_folder(target, survey, [], operator=operator)
        try:
            writer = cls(path, survey, sound, part_s, operator, reserve_bytes)
            writer._start(motion=motion, part_s=part_s, operator=operator)
        except BaseException:
            shutil.rmtree(path, ignore_errors=True)
            raise
        return writer

    def _start(self, *, motion: bool, part_s: float, operator: str) -> None:
        sound = self._sound
        form = None if sound is None else {field.name: getattr(sound, field.name) for field in fields(sound)}
        started = {"version": _version(), "operator": operator, "part_s": part_s, "sound": form, "motion": motion}
        self._keeper.note(JournalEvent.STARTED, started, urgent=True)
        self._keeper.start(self._streams)
        self._streams.start()

    # --- the streams

    def write_sound(self, frames: SoundFrames) -> None:
        """Take frames, int32 (n, channels), full scale 2³¹; they are copied."""
        form = self._form()
        if frames.dtype != "int32" or frames.ndim != 2 or frames.shape[1] != form.channels:
            raise ValueError(f"not int32 (n, {form.channels}): {frames.dtype} {frames.shape}")
        self._streams.put_sound(packed(frames, form.subtype))

    def write_silence(self, frames: int) -> None:
        """Take as many frames of silence: what was lost keeps its place, so that the time axis goes on."""
        self._form()
        if frames < 0:
            raise ValueError("no number of frames")
        self._streams.put_sound(int(frames))

    def write_motion(self, frames: Frames) -> None:
        """Take motion samples, ``time_us`` strictly increasing over the whole recording; not to be changed later."""
        self._streams.put_motion(frames)

    def _form(self) -> SoundForm:
        if self._sound is None:
            raise ValueError("this recording has no sound")
        return self._sound

    # --- what is told beside

    def note(self, event: str, **values: Any) -> None:  # noqa: ANN401  # whatever JSON holds
        """Keep a line in the journal: see :class:`~processing.storage.journal.JournalEvent`."""
        self._keeper.note(event, values)

    def mark(self, point: TiePoint) -> None:
        """Keep a known place: in the survey and in the journal, on the disc within moments."""

        def marked(survey: Survey) -> Survey:
            return replace(survey, tie_points=(*survey.tie_points, point))

        self._keeper.change(marked, urgent=True)
        values = {field.name: getattr(point, field.name) for field in fields(point)}
        self._keeper.note(JournalEvent.MARK, values, urgent=True)

    def amend(self, old: TiePoint, new: TiePoint | None) -> None:
        """Put ``new`` in the place of a known place, or take it back where ``new`` is None."""

        def amended(survey: Survey) -> Survey:
            points = (new if point == old else point for point in survey.tie_points)
            return replace(survey, tie_points=tuple(point for point in points if point is not None))

        self._keeper.change(amended, urgent=True)
        values = None if new is None else {field.name: getattr(new, field.name) for field in fields(new)}
        self._keeper.note(JournalEvent.AMENDED, {"name": old.name, "time_s": old.time_s, "now": values}, urgent=True)

    def wait_stored(self, timeout_s: float) -> bool:
        """Wait until the survey as it is now is on the disc; False if that takes longer, or the recording has ended."""
        return self._keeper.wait_stored(timeout_s)

    def set_clock(self, clock: ClockNumbers) -> None:
        """Keep how the sound's clock goes; stored after ten seconds, then every ten minutes, and at the end."""
        start_s, ppm = float(clock.start_time_s), float(clock.drift_ppm)
        start_sigma_s, sigma_ppm = float(clock.start_sigma_s), float(clock.drift_sigma_ppm)
        values = {"start_time_s": start_s, "drift_ppm": ppm}
        values |= {"start_sigma_s": start_sigma_s, "drift_sigma_ppm": sigma_ppm}

        def told(survey: Survey) -> Survey:
            audio = replace(survey.audio, start_time_s=start_s, drift_ppm=ppm)
            return replace(survey, audio=replace(audio, start_sigma_s=start_sigma_s, drift_sigma_ppm=sigma_ppm))

        self._keeper.set_clock((told, values))

    @property
    def survey(self) -> Survey:
        """The survey with all marks, as it is or is about to be stored."""
        return self._keeper.survey

    # --- how it goes

    def status(self) -> DiscStatus:
        """Return what the disc still takes, at most a second old."""
        return self._keeper.disc

    @property
    def fault(self) -> LeaklineError | None:
        """Why the recording ended by itself; None while it has not."""
        return self._ending.fault

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is to be told about the disc: ``recording_disc_low`` ten minutes before it is full."""
        return self._keeper.findings

    def close(self) -> Path:
        """End the recording and return its folder: all files synced, their sums stored, the lock given back.

        Never raises for the disc's sake: see :attr:`fault`. A second call only waits.
        """
        self._ending.ask()
        if not self._keeper.join(_CLOSE_S):
            self._ending.fail(
                LeaklineError(ErrorCode.CANNOT_WRITE, Place(self.path), reason="the disc does not answer")
            )
        if self._ending.bug is not None:
            raise self._ending.bug
        return self.path


def _version() -> str:
    try:
        return metadata.version("leakline")
    except metadata.PackageNotFoundError:  # run from its sources
        return ""
