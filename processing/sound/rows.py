"""Writes the rows of an array to a .npy file as they come, and takes it into place only when it is complete."""

import contextlib
import errno
import io
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place

_BLOCK_BYTES = 1 << 20


@contextmanager
def disc_errors(path: Path) -> Iterator[None]:
    """Turn what the disc refuses into LeaklineError DISC_FULL or CANNOT_WRITE."""
    try:
        yield
    except OSError as error:
        if error.errno == errno.ENOSPC:
            raise LeaklineError(ErrorCode.DISC_FULL, Place(path)) from error
        reason = error.strerror or str(error)
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=reason) from error


@dataclass(frozen=True)
class Kept:
    """How much of a file that is not complete can be relied on: its first rows, and their checksum."""

    rows: int
    crc32: int


class RowFile:
    """A .npy file of known shape that is filled in order: :meth:`add` rows, then :meth:`finish`; or :meth:`discard`.

    Plain writes instead of a memory map: dirty pages of a map count as our memory. Rows beyond ``rows`` are dropped.
    With ``kept`` it goes on with the rows that an earlier one left with :meth:`leave`.

    Raises:
        ValueError: ``kept`` is not what lies in the file.
    """

    def __init__(
        self, path: Path, dtype: npt.DTypeLike, rows: int, columns: int | None = None, kept: Kept | None = None
    ) -> None:
        self._path, self._dtype, self._rows = path, np.dtype(dtype), rows
        self._part = part_path(path)
        self._row_bytes = self._dtype.itemsize * (1 if columns is None else columns)
        shape = (rows,) if columns is None else (rows, columns)
        header = {"descr": np.lib.format.dtype_to_descr(self._dtype), "fortran_order": False, "shape": shape}
        head = io.BytesIO()
        np.lib.format.write_array_header_2_0(head, header)
        self._head = head.getvalue()
        self._done = 0 if kept is None else kept.rows
        self._crc = 0 if kept is None else kept.crc32
        with disc_errors(path):
            if kept is not None:
                self._check(kept)
            self._file: BinaryIO = self._part.open("wb" if kept is None else "r+b")
            if kept is None:
                self._file.write(self._head)
            else:
                self._file.truncate(self._file.seek(len(self._head) + kept.rows * self._row_bytes))

    @property
    def rows_added(self) -> int:
        """How many rows there are."""
        return self._done

    def add(self, rows: npt.NDArray[np.generic]) -> None:
        """Append rows (k, columns)."""
        keep = np.ascontiguousarray(rows[: self._rows - self._done], self._dtype)
        self._done += len(keep)
        if len(keep):
            self._crc = zlib.crc32(keep.data, self._crc)
            with disc_errors(self._path):
                self._file.write(keep.data)

    def flush(self, *, to_disc: bool = False) -> Kept:
        """Hand what was added to the system, and wait for the disc; return what is there now."""
        with disc_errors(self._path):
            self._file.flush()
            if to_disc:
                os.fsync(self._file.fileno())
        return Kept(self._done, self._crc)

    def finish(self) -> None:
        """Take the complete file into place."""
        if self._done != self._rows:
            raise ValueError(f"{self._path.name}: {self._done} of {self._rows} rows")
        with disc_errors(self._path):
            self._file.close()
            self._part.replace(self._path)

    def leave(self) -> None:
        """Close it as it is, for another one to go on with; harmless after :meth:`finish`."""
        with contextlib.suppress(OSError):  # a full disc: what was flushed before is told apart by its checksum
            self._file.close()

    def discard(self) -> None:
        """Leave nothing behind; harmless after :meth:`finish`."""
        self._file.close()
        self._part.unlink(missing_ok=True)

    def _check(self, kept: Kept) -> None:
        if not 0 <= kept.rows <= self._rows:
            raise ValueError(f"{self._path.name}: {kept.rows} of {self._rows} rows")
        with self._part.open("rb") as file:
            sound = file.read(len(self._head)) == self._head
            left, crc = kept.rows * self._row_bytes, 0
            while left and (block := file.read(min(left, _BLOCK_BYTES))):
                left, crc = left - len(block), zlib.crc32(block, crc)
        if not sound or left or crc != kept.crc32:
            raise ValueError(f"{self._path.name} is not what was left there")


def part_path(path: Path) -> Path:
    """Return where the rows of a file lie while it is not complete."""
    return path.with_name(path.name + ".part")


def read_blocks(path: Path, rows: int) -> Iterator[npt.NDArray[np.generic]]:
    """Yield the array in a .npy file, ``rows`` at a time, by plain reads: a map's pages would count as our memory."""
    with path.open("rb") as file:
        np.lib.format.read_magic(file)
        shape, _, dtype = np.lib.format.read_array_header_2_0(file)
        per_row = int(np.prod(shape[1:], dtype=np.int64))
        for start in range(0, shape[0], rows):
            count = min(rows, shape[0] - start)
            yield np.fromfile(file, dtype, count * per_row).reshape(count, *shape[1:])


def read_rows(path: Path, first: int, count: int) -> npt.NDArray[np.generic]:
    """Return some rows of the array in a .npy file that may still grow, by a plain read.

    Raises:
        ValueError, OSError: they are not there.
    """
    with path.open("rb") as file:
        np.lib.format.read_magic(file)
        shape, _, dtype = np.lib.format.read_array_header_2_0(file)
        per_row = int(np.prod(shape[1:], dtype=np.int64))
        file.seek(first * per_row * dtype.itemsize, os.SEEK_CUR)
        return np.fromfile(file, dtype, count * per_row).reshape(count, *shape[1:])


def load_rows(path: Path) -> npt.NDArray[np.generic]:
    """Return the array in a .npy file as a read-only memory map.

    Raises:
        ValueError, OSError: the file is missing, damaged or holds objects.
    """
    array: npt.NDArray[np.generic] = np.load(path, mmap_mode="r", allow_pickle=False)
    return array
