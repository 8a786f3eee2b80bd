"""The motion of a recording on disc: ``imu-001.lkf``, ``imu-002.lkf`` …, binary frames that continue each other."""

from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path

import numpy as np

from processing.importing.frame_log import SUFFIX
from processing.importing.frames import Frames, encode
from processing.storage.growing_file import GrowingFile
from processing.storage.sound_parts import LARGEST_PART

_MOST_ROWS = 1 << 14  # encoded at once


class MotionParts:
    """Writes frames into parts of ``part_s`` seconds of survey time; ``begun`` is told each file and its first time.

    ``time_us`` must not go back. :meth:`put` only remembers; :meth:`flush` writes, and may be called again after it
    failed. One thread only.
    """

    def __init__(self, folder: Path, part_s: float, begun: Callable[[GrowingFile, int], None]) -> None:
        self.samples = 0  # that are written
        self.written_bytes = 0
        self._folder, self._begun = folder, begun
        self._part_us = max(1, round(1e6 * part_s))
        self._waiting: list[Frames] = []
        self._file: GrowingFile | None = None
        self._first_us: int | None = None
        self._part_end_us = 0
        self._parts = 0

    def put(self, frames: Frames) -> None:
        """Take frames."""
        if len(frames):
            self._waiting.append(frames)

    def flush(self) -> None:
        """Write all that was put; raises DISC_FULL or CANNOT_WRITE, and keeps what is not written."""
        if not self._waiting:
            return
        rows, at = joined(self._waiting), 0
        try:
            while at < len(rows):
                at += self._write(rows, at)
        finally:
            self._waiting = [sliced(rows, at, len(rows))] if at < len(rows) else []

    def finish(self) -> None:
        """End the last part: nothing follows."""
        if self._file is not None:
            self._file.is_finished, self._file = True, None

    def _write(self, rows: Frames, at: int) -> int:
        """Write rows from ``at`` on, as many as belong to one part, and return their number."""
        begin_us = int(rows.time_us[at])
        if self._first_us is None:
            self._first_us = begin_us
            self._part_end_us = begin_us + self._part_us
        if begin_us >= self._part_end_us:
            self.finish()
            self._part_end_us += self._part_us * (1 + (begin_us - self._part_end_us) // self._part_us)
        elif self._file is not None and self._file.size > LARGEST_PART:
            self.finish()
        later = rows.time_us[at : at + _MOST_ROWS] >= np.uint64(self._part_end_us)
        count = int(np.argmax(later)) if later.any() else len(later)
        data = encode(sliced(rows, at, at + count))
        if self._file is None:
            self._file = GrowingFile(self._folder / f"imu-{self._parts + 1:03d}{SUFFIX}", "imu", data)
            self._parts += 1
            self._begun(self._file, begin_us)
        else:
            self._file.append(data)
        self.samples += count
        self.written_bytes += len(data)
        return count


def sliced(frames: Frames, start: int, end: int) -> Frames:
    """Return the rows from ``start`` to before ``end``."""
    return Frames(**{field.name: getattr(frames, field.name)[start:end] for field in fields(frames)})


def joined(pieces: Sequence[Frames]) -> Frames:
    """Return the rows of all pieces, in order."""
    if len(pieces) == 1:
        return pieces[0]
    names = [field.name for field in fields(Frames)]
    return Frames(**{name: np.concatenate([getattr(piece, name) for piece in pieces]) for name in names})
