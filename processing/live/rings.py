"""A ring of rows that are counted from the beginning of the stream, of which the last ones are kept."""

from typing import Any

import numpy as np
import numpy.typing as npt


class Ring:
    """The last ``capacity`` of all rows ever appended; a row keeps its number for ever."""

    def __init__(self, capacity: int, width: tuple[int, ...], dtype: npt.DTypeLike, empty: float = 0.0) -> None:
        """Begin without rows; what is skipped by :meth:`skip_to` reads as ``empty``."""
        self._rows: npt.NDArray[Any] = np.full((capacity, *width), empty, dtype)
        self._empty = empty
        self.stop = 0  # number of the row to come

    @property
    def start(self) -> int:
        """The number of the oldest row that is still here."""
        return max(self.stop - len(self._rows), 0)

    def append(self, rows: npt.NDArray[Any]) -> None:
        """Add rows (k, …)."""
        kept = rows[-len(self._rows) :]
        self.stop += len(rows)
        self._rows[np.arange(self.stop - len(kept), self.stop) % len(self._rows)] = kept

    def skip_to(self, number: int) -> None:
        """Leave rows empty up to ``number``, which is then the next one to come."""
        count = number - self.stop
        if count <= 0:
            return
        self.stop = number
        gone = np.arange(max(number - min(count, len(self._rows)), 0), number)
        self._rows[gone % len(self._rows)] = self._empty

    def since(self, number: int) -> tuple[int, npt.NDArray[Any]]:
        """Return the number of the first row and a copy of all rows from ``number`` on that are still here."""
        first = min(max(number, self.start), self.stop)
        return first, self._rows[np.arange(first, self.stop) % len(self._rows)]

    def update(self, number: int, rows: npt.NDArray[Any]) -> None:
        """Overwrite rows from ``number`` on, all of which have been appended before; those no longer here are not."""
        numbers = np.arange(number, number + len(rows))
        here = (numbers >= self.start) & (numbers < self.stop)
        self._rows[numbers[here] % len(self._rows)] = rows[here]
