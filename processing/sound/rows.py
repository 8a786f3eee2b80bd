"""Writes the rows of an array to a .npy file as they come, and takes it into place only when it is complete."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place


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


class RowFile:
    """A .npy file of known shape that is filled in order: :meth:`add` rows, then :meth:`finish`; or :meth:`discard`.

    Plain writes instead of a memory map: dirty pages of a map count as our memory. Rows beyond ``rows`` are dropped.
    """

    def __init__(self, path: Path, dtype: npt.DTypeLike, rows: int, columns: int | None = None) -> None:
        self._path, self._dtype, self._rows = path, np.dtype(dtype), rows
        self._part = path.with_name(path.name + ".part")
        self._done = 0
        shape = (rows,) if columns is None else (rows, columns)
        header = {"descr": np.lib.format.dtype_to_descr(self._dtype), "fortran_order": False, "shape": shape}
        with disc_errors(path):
            self._file = self._part.open("wb")
            np.lib.format.write_array_header_2_0(self._file, header)

    def add(self, rows: npt.NDArray[np.generic]) -> None:
        """Append rows (k, columns)."""
        keep = np.ascontiguousarray(rows[: self._rows - self._done], self._dtype)
        self._done += len(keep)
        with disc_errors(self._path):
            self._file.write(keep.data)

    def finish(self) -> None:
        """Take the complete file into place."""
        if self._done != self._rows:
            raise ValueError(f"{self._path.name}: {self._done} of {self._rows} rows")
        with disc_errors(self._path):
            self._file.close()
            self._part.replace(self._path)

    def discard(self) -> None:
        """Leave nothing behind; harmless after :meth:`finish`."""
        self._file.close()
        self._part.unlink(missing_ok=True)


def read_blocks(path: Path, rows: int) -> Iterator[npt.NDArray[np.generic]]:
    """Yield the array in a .npy file, ``rows`` at a time, by plain reads: a map's pages would count as our memory."""
    with path.open("rb") as file:
        np.lib.format.read_magic(file)
        shape, _, dtype = np.lib.format.read_array_header_2_0(file)
        per_row = int(np.prod(shape[1:], dtype=np.int64))
        for start in range(0, shape[0], rows):
            count = min(rows, shape[0] - start)
            yield np.fromfile(file, dtype, count * per_row).reshape(count, *shape[1:])


def load_rows(path: Path) -> npt.NDArray[np.generic]:
    """Return the array in a .npy file as a read-only memory map.

    Raises:
        ValueError, OSError: the file is missing, damaged or holds objects.
    """
    array: npt.NDArray[np.generic] = np.load(path, mmap_mode="r", allow_pickle=False)
    return array
