"""Drops and reorders the rows of a raw log in place, block by block, so that hours-long logs stay in their file."""

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from processing.importing.raw import RawImu
from processing.survey import BoolArray

BLOCK_ROWS = 1 << 20
Scalar = TypeVar("Scalar", np.float64, np.bool_)


def keep_rows(raw: RawImu, keep: BoolArray) -> None:
    """Leave only the rows where ``keep`` (n,) is True, in their order; costs no second copy of a big log."""
    if keep.all():
        return
    first = int(np.argmin(keep))
    for name, array in raw.arrays().items():
        at = first
        for start in range(first, len(array), BLOCK_ROWS):
            kept = array[start : start + BLOCK_ROWS][keep[start : start + BLOCK_ROWS]]
            array[at : at + len(kept)] = kept
            at += len(kept)
        setattr(raw, name, array[:at])


def reorder_rows(raw: RawImu, start: int, order: npt.NDArray[np.intp]) -> None:
    """Put the rows ``start`` … ``start + len(order)`` into ``order`` (indices relative to ``start``)."""
    for array in raw.arrays().values():
        array[start : start + len(order)] = array[start : start + len(order)][order]


def thinned(array: npt.NDArray[Scalar], most: int = 200_000) -> npt.NDArray[Scalar]:
    """Return at most about ``most`` rows, spread over the whole, for statistics."""
    return np.asarray(array[:: max(len(array) // most, 1)])


def runs(mask: BoolArray) -> npt.NDArray[np.intp]:
    """Return the runs of True in ``mask`` (n,) as (m, 2): first index, and index behind the last."""
    padded = np.concatenate([[False], mask, [False]]).astype(np.int8)
    edges = np.diff(padded)
    return np.column_stack([np.nonzero(edges == 1)[0], np.nonzero(edges == -1)[0]])
