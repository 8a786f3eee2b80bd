"""A file that grows while it is recorded: what is appended is in it wholly or not at all, and can be synced beside."""

import os
from contextlib import suppress
from pathlib import Path

from processing.storage.files import writing

_FLAGS = os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_BINARY", 0)


class GrowingFile:
    """One new file. One thread appends; another may :meth:`sync` and, once ``is_finished``, :meth:`close` it.

    Unbuffered: what :meth:`append` has taken survives the death of the program, and the computer's once it is synced.
    All raise LeaklineError, DISC_FULL or CANNOT_WRITE.
    """

    def __init__(self, path: Path, role: str, head: bytes = b"") -> None:
        self.path, self.role = path, role
        self.size = 0
        self.synced_size = 0  # bytes that even a power cut leaves
        self.is_finished = False
        self._is_closed = False
        with writing(path):
            self._handle = os.open(path, _FLAGS, 0o644)
        try:
            self.append(head)
        except BaseException:
            self.close()
            with suppress(OSError):
                path.unlink()
            raise

    def append(self, data: bytes) -> None:
        """Write at the end; where that fails nothing of ``data`` stays, so that it can be tried again."""
        with writing(self.path):
            try:
                self._write(self.size, data)
            except OSError:
                with suppress(OSError):  # on a disc that is gone there is nothing to take back
                    os.ftruncate(self._handle, self.size)
                raise
        self.size += len(data)

    def rewrite(self, offset: int, data: bytes) -> None:
        """Write over bytes that are there already."""
        if offset + len(data) > self.size:
            raise ValueError("only what is there can be written over")
        with writing(self.path):
            self._write(offset, data)

    def sync(self) -> None:
        """Put on the disc what was appended before this call."""
        size = self.size
        with writing(self.path):
            os.fsync(self._handle)
        self.synced_size = size

    def close(self) -> None:
        """Close it; a second time does no harm."""
        if not self._is_closed:
            self._is_closed = True
            with writing(self.path):
                os.close(self._handle)

    def _write(self, offset: int, data: bytes) -> None:
        os.lseek(self._handle, offset, os.SEEK_SET)
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self._handle, rest) :]
