"""Takes, joins and changes rows of :class:`~processing.importing.frames.Frames`."""

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np
import numpy.typing as npt

from processing.importing.frames import Frames

Rows = npt.NDArray[np.int64] | npt.NDArray[np.bool_] | slice


def no_frames() -> Frames:
    """Return no sample at all."""
    nothing = np.zeros(0, np.float32)
    three = np.zeros((0, 3), np.float32)
    return Frames(
        np.zeros(0, np.uint32),
        np.zeros(0, np.uint64),
        three,
        three,
        three,
        nothing,
        nothing,
        np.zeros((0, 4), np.float32),
        np.zeros(0, np.float64),
    )


def rows_of(frames: Frames, rows: Rows) -> Frames:
    """Return some of the samples."""
    return Frames(*(getattr(frames, field.name)[rows] for field in fields(Frames)))


def joined(parts: Sequence[Frames]) -> Frames:
    """Return the samples of all parts, one after the other."""
    if len(parts) == 1:
        return parts[0]
    if not parts:
        return no_frames()
    return Frames(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Frames)))


def arrived(frames: Frames, host_s: float) -> Frames:
    """Return the samples with the host time at which they came; where they have one already, it stays."""
    told = frames.host_s
    return replace(frames, host_s=np.where(np.isfinite(told), told, host_s))


def placed_at(frames: Frames, axis_us: npt.NDArray[np.int64], counter: npt.NDArray[np.int64]) -> Frames:
    """Return the samples with other times and counters, which begin anew from 4294967295."""
    return replace(frames, time_us=axis_us.astype(np.uint64), counter=(counter % (1 << 32)).astype(np.uint32))
