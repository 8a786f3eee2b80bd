"""Takes what the devices' threads bring, at once and from any thread, and writes it from a thread of its own.

A stick may take seconds for a write, a serial line has room for a quarter of one: so nobody who brings samples waits
for the disc. What was brought is written within ``DRAIN_S``, many small pieces together.
"""

import logging
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.frames import Frames
from processing.storage.disc_space import Aside
from processing.storage.growing_file import GrowingFile
from processing.storage.journal import JournalEvent
from processing.storage.motion_parts import MotionParts
from processing.storage.sound_parts import SoundForm, SoundParts

log = logging.getLogger(__name__)

DRAIN_S = 0.05  # a kill loses no more than this, and a thousand blocks a second cost no more than twenty
MOST_WAITING = 128 << 20  # bytes; minutes of sound: a disc that is slower than that for so long does not do
_FRAME_BYTES = 100  # of a motion sample in memory, about

Note = Callable[[JournalEvent, Mapping[str, object]], None]


class Ending:
    """Whether a recording is to end, and why; shared by its threads."""

    def __init__(self) -> None:
        self.asked = threading.Event()
        self.wake = threading.Event()  # of the thread that keeps the folder
        self.bug: BaseException | None = None
        self._fault: LeaklineError | None = None
        self._lock = threading.Lock()

    @property
    def fault(self) -> LeaklineError | None:
        """The first thing that went wrong; the recording ends by it."""
        return self._fault

    @property
    def is_over(self) -> bool:
        """Whether nothing more is taken: from the moment on at which the fault can be seen."""
        return self._fault is not None or self.asked.is_set()

    def ask(self) -> None:
        """End the recording: nothing more is taken."""
        self.asked.set()
        self.wake.set()

    def fail(self, error: LeaklineError) -> None:
        """End the recording because of ``error``."""
        with self._lock:
            if self._fault is None:
                self._fault = error
                log.warning("the recording ends: %s", error)
        self.ask()

    def fail_by_bug(self, error: BaseException, path: Path) -> None:
        """End the recording because of a fault of ours, which closing will raise again."""
        log.error("the recording ends by a fault of the program", exc_info=error)
        self.bug = self.bug or error
        self.fail(LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=repr(error)))


class Streams:
    """The files of sound and motion, and the thread that writes them; ``begun`` is noted for each new file."""

    def __init__(
        self, original: Path, form: SoundForm | None, part_s: float, ending: Ending, aside: Aside, note: Note
    ) -> None:
        self.written_host_s: float | None = None  # all that was brought before this moment is in the files
        self.form = form
        self._original, self._ending, self._aside, self._note = original, ending, aside, note
        self._sound = SoundParts(original, form, part_s, self._sound_begun) if form is not None else None
        self._motion = MotionParts(original, part_s, self._motion_begun)
        self._lock = threading.Lock()  # of what waits and of the files; never held while the disc is waited for
        self._pieces: list[bytes | int] = []
        self._frames: list[Frames] = []
        self._waiting_bytes = 0
        self._files: list[GrowingFile] = []
        self._thread = threading.Thread(target=self._run, name="recording-streams", daemon=True)

    # --- from any thread

    def start(self) -> None:
        """Begin to write."""
        self._thread.start()

    def put_sound(self, piece: bytes | int) -> None:
        """Take packed frames or a number of silent ones; nothing once the recording ends."""
        with self._lock:
            if not self._ending.is_over:
                self._pieces.append(piece)
                self._waiting_bytes += 0 if isinstance(piece, int) else len(piece)
        self._check_waiting()

    def put_motion(self, frames: Frames) -> None:
        """Take motion samples; nothing once the recording ends."""
        with self._lock:
            if not self._ending.is_over:
                self._frames.append(frames)
                self._waiting_bytes += _FRAME_BYTES * len(frames)
        self._check_waiting()

    def files(self) -> tuple[GrowingFile, ...]:
        """Return the files that are not closed yet."""
        with self._lock:
            return tuple(self._files)

    def forget(self, file: GrowingFile) -> None:
        """Take a file off the list: it is finished, synced and closed."""
        with self._lock:
            self._files.remove(file)

    def join(self, timeout_s: float) -> bool:
        """Wait until all is written; False where the disc does not answer in time."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    @property
    def sound_frames(self) -> int:
        """Frames in the files."""
        return self._sound.frames if self._sound is not None else 0

    @property
    def motion_samples(self) -> int:
        """Samples in the files."""
        return self._motion.samples

    @property
    def motion_bytes(self) -> int:
        """Bytes of motion in the files."""
        return self._motion.written_bytes

    def _check_waiting(self) -> None:
        if self._waiting_bytes > MOST_WAITING:
            reason = "the disc is too slow for this recording"
            self._ending.fail(LeaklineError(ErrorCode.CANNOT_WRITE, Place(self._original), reason=reason))

    # --- in the thread

    def _run(self) -> None:
        try:
            is_last = False
            while not is_last:
                is_last = self._ending.asked.wait(DRAIN_S)
                now = time.monotonic()
                is_last = self._drain() or is_last
                self.written_host_s = now
        except LeaklineError as error:
            self._ending.fail(error)
        except BaseException as error:  # noqa: BLE001  # nothing may end this thread without ending the recording
            self._ending.fail_by_bug(error, self._original)
        finally:
            if self._sound is not None:
                self._sound.finish()
            self._motion.finish()

    def _drain(self) -> bool:
        """Write all that waits; True where the disc is full, and that was the last."""
        self._hand_over()
        try:
            self._flush()
        except LeaklineError as error:
            self._ending.fail(error)  # nothing more is taken from here on
            self._aside.release()
            self._hand_over()
            self._flush()
            return True
        return False

    def _hand_over(self) -> None:
        with self._lock:
            pieces, frames = self._pieces, self._frames
            self._pieces, self._frames, self._waiting_bytes = [], [], 0
        if self._sound is not None:
            for piece in pieces:
                self._sound.put(piece)
        for block in frames:
            self._motion.put(block)

    def _flush(self) -> None:
        """Write both streams; where one fails the other one has its turn nevertheless."""
        try:
            if self._sound is not None:
                self._sound.flush()
        finally:
            self._motion.flush()

    def _sound_begun(self, file: GrowingFile, first_frame: int) -> None:
        with self._lock:
            self._files.append(file)
        self._note(JournalEvent.PART, {"stream": "sound", "file": file.path.name, "first_frame": first_frame})

    def _motion_begun(self, file: GrowingFile, first_us: int) -> None:
        with self._lock:
            self._files.append(file)
        self._note(JournalEvent.PART, {"stream": "motion", "file": file.path.name, "first_time_us": first_us})
