"""Keeps the folder of a running recording in a thread of its own: survey, journal, syncs, free space, and the end.

The survey's database belongs to this thread. Each second everything that was written is put on the disc; a mark and
its journal line at once.
"""

import hashlib
import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.live.stream import DiscStatus, JournalLine
from processing.storage.database import BUSY_TIMEOUT_S
from processing.storage.disc_space import WARN_S, Aside, free_bytes, seconds_left
from processing.storage.files import CHUNK, reading, sync_folder, writing
from processing.storage.folder import SurveyFolder
from processing.storage.growing_file import GrowingFile
from processing.storage.journal import JOURNAL_NAME, JournalEvent, journal_line, line_bytes
from processing.storage.recording_streams import Ending, Streams
from processing.survey import Finding, ImportedFile, Severity, Survey

log = logging.getLogger(__name__)

Clock = tuple[Callable[[Survey], Survey], Mapping[str, object]]  # what it makes of the survey, and the journal's values

SYNC_S = 1.0
CLOCK_FIRST_S = 10.0  # by then the arrivals tell a millisecond
CLOCK_EVERY_S = 600.0  # each is a line in the survey's log for ever
HASHED_AT_ONCE = 32 << 20  # bytes a second: finished parts are read again beside the recording, not instead of it
HASH_AT_END_S = 10.0  # an hour of two channels at 96 kHz takes two, but a minute if a stick has to read it
_STREAMS_WAIT_S = 120.0
_LEAST_MEASURED_S = 2.0
_PATIENCE_S = 0.2  # with who reads the survey meanwhile: the syncs must not wait for him


class Keeper:
    """The thread; :meth:`start` returns when the folder is open and locked, or raises why it is not."""

    def __init__(
        self, path: Path, survey: Survey, operator: str, reserve_bytes: int, ending: Ending, aside: Aside
    ) -> None:
        self.path = path
        self.disc = DiscStatus()
        self.findings: tuple[Finding, ...] = ()
        self._original = path / "recordings" / "1" / "original"
        self._operator, self._reserve, self._ending, self._aside = operator, reserve_bytes, ending, aside
        self._lock = threading.Lock()  # of what waits
        self._lines: list[JournalLine] = []
        self._survey = survey
        self._is_stored, self._is_urgent = True, False
        self._is_now_stored = threading.Condition(self._lock)
        self._changes = self._stored_changes = 0
        self._is_over = False
        self._folder: SurveyFolder | None = None
        self._streams: Streams | None = None
        self._journal: GrowingFile | None = None
        self._known: set[Path] = set()
        self._to_hash: deque[GrowingFile] = deque()
        self._hashing: Iterator[None] | None = None
        self._began = time.monotonic()
        self._clock: Clock | None = None
        self._clock_due = self._began + CLOCK_FIRST_S
        self._open_fault: BaseException | None = None
        self._is_open = threading.Event()
        self._thread = threading.Thread(target=self._run, name="recording-keeper", daemon=True)

    # --- from any thread

    def start(self, streams: Streams) -> None:
        """Open the folder and begin; raises what opening it raises."""
        self._streams = streams
        self._thread.start()
        self._is_open.wait()
        if self._open_fault is not None:
            raise self._open_fault

    def join(self, timeout_s: float) -> bool:
        """Wait until all is on the disc and the folder is given back; False if that takes longer."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def note(self, event: str, values: Mapping[str, object], *, urgent: bool = False) -> None:
        """Keep a line; an urgent one is on the disc within moments."""
        line = journal_line(event, values)
        with self._lock:
            self._lines.append(line)
            self._is_urgent |= urgent
        self._ending.wake.set()

    @property
    def survey(self) -> Survey:
        """The survey as it is, or is about to be, stored."""
        return self._survey

    def change(self, changed: Callable[[Survey], Survey], *, urgent: bool) -> None:
        """Change the survey; it is stored at once if ``urgent``, else with the next sync."""
        with self._lock:
            self._survey, self._is_stored = changed(self._survey), False
            self._changes += 1
            self._is_urgent |= urgent
        if urgent:
            self._ending.wake.set()

    def wait_stored(self, timeout_s: float) -> bool:
        """Wait until the survey with all changes until now is on the disc; False if that takes longer, or fails."""
        with self._lock:
            wanted = self._changes
            self._is_now_stored.wait_for(lambda: self._stored_changes >= wanted or self._is_over, timeout_s)
            return self._stored_changes >= wanted

    def set_clock(self, clock: Clock) -> None:
        """Keep how the sound's clock goes: stored after ten seconds, then every ten minutes, and at the end."""
        self._clock = clock

    # --- in the thread

    def _run(self) -> None:
        try:
            self._open()
        except BaseException as error:  # noqa: BLE001  # start() raises it in the thread that asked
            self._open_fault = error
            return
        finally:
            self._is_open.set()
        try:
            self._keep()
        except LeaklineError as error:
            self._ending.fail(error)
        except BaseException as error:  # noqa: BLE001  # nothing may end this thread without ending the recording
            self._ending.fail_by_bug(error, self.path)
        self._end()
        with self._lock:
            self._is_over = True
            self._is_now_stored.notify_all()

    def _open(self) -> None:
        self._folder = SurveyFolder.open(self.path)
        try:
            self._folder.set_patience(_PATIENCE_S)
            self._journal = GrowingFile(self._original / JOURNAL_NAME, "journal")
            with writing(self._original):
                sync_folder(self._original)
            self._watch_disc()
        except BaseException:
            self._folder.close()
            raise

    def _keep(self) -> None:
        next_sync = time.monotonic()
        while not self._ending.asked.is_set():
            self._ending.wake.wait(max(0.0, next_sync - time.monotonic()))
            self._ending.wake.clear()
            with self._lock:
                is_urgent, self._is_urgent = self._is_urgent, False
            self._write_lines()
            if is_urgent:
                self._journal_file.sync()
                self._store_survey()
            if time.monotonic() >= next_sync:
                next_sync = time.monotonic() + SYNC_S
                self._sync()
                self._take_clock()
                self._store_survey()
                self._watch_disc()
                self._hash_some()

    @property
    def _journal_file(self) -> GrowingFile:
        assert self._journal is not None  # the thread has opened it
        return self._journal

    def _write_lines(self) -> None:
        with self._lock:
            lines, self._lines = self._lines, []
        try:
            self._journal_file.append(b"".join(line_bytes(line) for line in lines))
        except BaseException:
            with self._lock:
                self._lines = lines + self._lines
            raise

    def _store_survey(self, *, is_last: bool = False) -> None:
        with self._lock:
            survey, is_stored, self._is_stored = self._survey, self._is_stored, True
            changes = self._changes
        if is_stored or self._folder is None:
            return
        try:
            if is_last:
                self._folder.set_patience(BUSY_TIMEOUT_S)
            self._folder.write_survey(survey, self._operator)
        except LeaklineError as error:
            with self._lock:
                self._is_stored = False
            if is_last or error.code is not ErrorCode.SURVEY_LOCKED:
                raise
            # somebody reads it for long: the next second will do
            return
        with self._lock:
            self._stored_changes = changes
            self._is_now_stored.notify_all()

    def _take_clock(self, *, is_last: bool = False) -> None:
        clock, now = self._clock, time.monotonic()
        if clock is None or (now < self._clock_due and not is_last):
            return
        self._clock, self._clock_due = None, now + CLOCK_EVERY_S
        changed, values = clock
        self.change(changed, urgent=False)
        self.note(JournalEvent.CLOCK, values)

    def _sync(self) -> None:
        assert self._streams is not None
        up_to = self._streams.written_host_s
        first: LeaklineError | None = None
        for file in (*self._streams.files(), self._journal_file):
            try:
                self._sync_file(file)
            except LeaklineError as error:  # the other files have their turn nevertheless
                first = first or error
        if first is not None:
            raise first
        self.disc = replace(self.disc, synced_host_s=up_to)

    def _sync_file(self, file: GrowingFile) -> None:
        is_finished = file.is_finished
        if file.path not in self._known:
            with writing(self._original):
                sync_folder(self._original)
            self._known.add(file.path)
        file.sync()
        if is_finished and self._streams is not None:
            file.close()
            self._streams.forget(file)
            self._to_hash.append(file)

    def _watch_disc(self) -> None:
        with writing(self.path):
            if not self._journal_file.path.exists():
                raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(self.path), reason="the folder is no longer there")
        free = free_bytes(self.path)
        rate = self._bytes_per_s()
        left = seconds_left(free, self._reserve, rate)
        self.disc = replace(self.disc, free_bytes=free, bytes_per_s=rate, seconds_left=left)
        if left is not None and left < WARN_S and not self.findings:
            self.findings = (Finding("recording_disc_low", Severity.WARNING, {"minutes": left / 60.0}),)
            self.note(JournalEvent.DISC_LOW, {"seconds_left": left, "free_bytes": free})
        if free <= self._reserve:
            raise LeaklineError(ErrorCode.DISC_FULL, Place(self.path))

    def _bytes_per_s(self) -> float:
        """Sound comes at the rate of its form, also what is filled up later; motion as it came by now."""
        streams = self._streams
        if streams is None:
            return 0.0
        elapsed = time.monotonic() - self._began
        motion = streams.motion_bytes / elapsed if elapsed > _LEAST_MEASURED_S else 0.0
        return motion + (streams.form.bytes_per_s if streams.form is not None else 0.0)

    # --- sums of what is finished

    def _hash_some(self) -> None:
        if self._hashing is None and self._to_hash:
            self._hashing = self._hash(self._to_hash.popleft())
        if self._hashing is None:
            return
        try:
            next(self._hashing)
        except StopIteration:
            self._hashing = None
        except LeaklineError as error:  # it has no sum then, as after a kill; the sound itself is there
            log.warning("%s", error)
            self._hashing = None

    def _hash(self, file: GrowingFile) -> Iterator[None]:
        """Read a finished part again, a piece at each step, and store what it is."""
        digest, size = hashlib.sha256(), 0
        with reading(file.path), file.path.open("rb") as reader:
            while chunk := reader.read(CHUNK):
                digest.update(chunk)
                size += len(chunk)
                if size % HASHED_AT_ONCE == 0:
                    yield
        if self._folder is not None:
            self._folder.add_files([ImportedFile(file.path, file.role, size, digest.hexdigest())])

    # --- the end

    def _end(self) -> None:
        """Bring everything to its end; a step that the disc refuses keeps none of the others from being tried."""
        self._ending.ask()
        steps = (
            self._await_streams,
            lambda: self._take_clock(is_last=True),
            self._aside.release,
            self._write_lines,
            self._sync,
            self._write_last_line,
            lambda: self._store_survey(is_last=True),
            self._hash_all,
            self._close,
        )
        for step in steps:
            try:
                step()
            except LeaklineError as error:
                self._ending.fail(error)
            except BaseException as error:  # noqa: BLE001  # the next steps matter all the more
                self._ending.fail_by_bug(error, self.path)

    def _await_streams(self) -> None:
        assert self._streams is not None
        if not self._streams.join(_STREAMS_WAIT_S):
            reason = "the disc does not answer"
            raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(self.path), reason=reason)

    def _write_last_line(self) -> None:
        assert self._streams is not None
        fault = self._ending.fault
        if fault is not None:
            self.note(JournalEvent.FAULT, {"code": fault.code.value, "reason": str(fault.params.get("reason", ""))})
        totals = {"sound_frames": self._streams.sound_frames, "motion_samples": self._streams.motion_samples}
        self.note(JournalEvent.STOPPED, totals)
        self._write_lines()
        self._journal_file.sync()

    def _hash_all(self) -> None:
        """Count the sums that are not counted yet; on a slow stick the import does the rest, which reads it anyway."""
        self._to_hash.appendleft(self._journal_file)
        until = time.monotonic() + HASH_AT_END_S
        while (self._hashing is not None or self._to_hash) and time.monotonic() < until:
            self._hash_some()

    def _close(self) -> None:
        assert self._streams is not None
        try:
            for file in (*self._streams.files(), self._journal_file):
                file.close()
        finally:
            if self._folder is not None:
                self._folder.close()
