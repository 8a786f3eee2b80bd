"""How long a disc still takes a recording, and the little that is set aside so that its end finds room."""

import os
import shutil
from contextlib import suppress
from pathlib import Path

from processing.storage.files import writing

WARN_S = 600.0  # told this long before a recording would have to end
RESERVE_BYTES = 64 << 20  # stays free: the database, its backup, what else runs on this computer
_ASIDE_SHARE = 8
_ASIDE_LEAST = 256 << 10


def free_bytes(folder: Path) -> int:
    """Return what is free on the disc of ``folder``; raises CANNOT_WRITE where the disc is gone."""
    with writing(folder):
        return shutil.disk_usage(folder).free


def seconds_left(free: int, reserve: int, bytes_per_s: float) -> float | None:
    """Return how long ``free`` bytes last until only ``reserve`` is left; None where nothing is written."""
    return max(0.0, (free - reserve) / bytes_per_s) if bytes_per_s > 0.0 else None


class Aside:
    """A file of a little room, given up when the disc is full so that what was already taken can still be written.

    Without it another program could take the last byte, and headers, the last frames and the database would have none.
    """

    def __init__(self, path: Path, reserve_bytes: int) -> None:
        self.path = path
        with writing(path):
            # written, not merely claimed: many file systems of sticks know no other way
            handle = os.open(path, os.O_CREAT | os.O_TRUNC | os.O_WRONLY | getattr(os, "O_BINARY", 0), 0o644)
            try:
                left = max(_ASIDE_LEAST, reserve_bytes // _ASIDE_SHARE)
                while left > 0:
                    # no zeros: some file systems store those as a hole
                    left -= os.write(handle, os.urandom(min(left, 1 << 20)))
            finally:
                os.close(handle)

    def release(self) -> None:
        """Give the room back; on a disc that is gone there is none to give."""
        with suppress(OSError):
            self.path.unlink(missing_ok=True)
