"""Sums of rows over bins of time, block by block, in memory that follows the rows and not the span of their stamps.

A log whose clock jumps by years has few rows and would have billions of bins: stretches without rows are cut short.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray

IndexArray = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Bins:
    """Bins in order of time: ``number`` (m,) says which, counted from time ``start_s``; ``sums`` (m, k), 0 if empty."""

    start_s: float
    width_s: float
    number: IndexArray
    sums: FloatArray

    @property
    def start_of(self) -> FloatArray:
        """Where each bin begins (m,)."""
        return np.asarray(self.start_s + self.width_s * self.number, dtype=np.float64)


class BinSums:
    """Collects rows in order of time; ``most_empty`` bins at most stand for a stretch without any."""

    def __init__(self, start_s: float, width_s: float, terms: int, most_empty: int) -> None:
        self._start_s, self._width_s, self._most_empty = start_s, width_s, most_empty
        self._numbers: list[IndexArray] = []
        self._sums: list[FloatArray] = [np.zeros((0, terms))]

    def add(self, time_s: FloatArray, terms: FloatArray) -> None:
        """Add rows at times (m,), none before those already added, with terms (m, k)."""
        if len(time_s):
            number, edges = self._numbered(time_s)
            self._append(number[edges], np.add.reduceat(terms, edges))

    def places(self, time_s: FloatArray) -> tuple[IndexArray, FloatArray]:
        """Return the place of each of the rows at times (m,), and the sums (k, terms) to add them to at these places.

        For terms that are summed as they are made; none of the rows comes before those already added.
        """
        number, edges = self._numbered(time_s)
        sums = np.zeros((len(edges), self._sums[0].shape[1]))
        if len(edges):
            self._append(number[edges], sums)
        return np.repeat(np.arange(len(edges)), np.diff(edges, append=len(number))), sums

    def _numbered(self, time_s: FloatArray) -> tuple[IndexArray, IndexArray]:
        """Return each row's bin (m,), and the first rows of the bins (k,)."""
        number = np.floor((time_s - self._start_s) / self._width_s).astype(np.intp)
        return number, np.flatnonzero(np.diff(number, prepend=number[:1] - 1))

    def _append(self, found: IndexArray, sums: FloatArray) -> None:
        """Take bins (k,), k ≥ 1, and their sums (k, terms); a bin that goes on moves to them."""
        if self._numbers and self._numbers[-1][-1] == found[0]:
            sums[0] += self._sums[-1][-1]
            self._numbers[-1], self._sums[-1] = self._numbers[-1][:-1], self._sums[-1][:-1]
        self._numbers.append(found)
        self._sums.append(sums)

    def result(self) -> Bins:
        """Return all bins from the first to the last with rows, empty ones between them included, up to the limit."""
        sums = np.concatenate(self._sums)
        if not self._numbers:
            return Bins(self._start_s, self._width_s, np.zeros(0, dtype=np.intp), sums)
        number = np.concatenate(self._numbers)
        place = np.concatenate([[0], np.cumsum(np.minimum(np.diff(number), self._most_empty + 1))])
        every = np.arange(place[-1] + 1)
        left = np.searchsorted(place, every, side="right") - 1
        filled = np.zeros((len(every), sums.shape[1]))
        filled[place] = sums
        return Bins(self._start_s, self._width_s, number[left] + every - place[left], filled)
