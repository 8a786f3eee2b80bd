"""What a spectrogram view asks of sound, and how its columns become the pixels of a picture.

The science's tile pyramid answers :class:`TileSource`; the pixels are pooled in time, in metres and in frequency: by
the maximum, so that an event of a single frame stays visible at any zoom, or by the mean of the powers.
"""

from typing import Protocol

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray
from widgets.plot_scale import Scale

Levels = npt.NDArray[np.uint8]
MOST_COLUMNS = 16384


class TileSource(Protocol):
    """Levels of sound over survey time and frequency; asked from a worker thread, never from the window's."""

    @property
    def frequencies_hz(self) -> FloatArray:
        """Centres of the bins, (bins,), rising."""

    @property
    def low_db(self) -> float:
        """Level that 0 stands for."""

    @property
    def step_db(self) -> float:
        """Decibels from one number of a tile to the next."""

    @property
    def start_s(self) -> float:
        """First moment that it covers, in survey seconds."""

    @property
    def end_s(self) -> float:
        """Last moment that it covers, in survey seconds."""

    def columns(self, start_s: float, end_s: float, columns: int, plane: str = "max") -> Levels:
        """Return uint8 (bins, columns): the level within each of equal spans of survey time; 0 outside.

        ``plane`` is ``max``, the highest level in a span, or ``mean``, the level of the mean power.
        """


def pixel_levels(source: TileSource, edges_s: FloatArray, frequency: Scale, rows: int, plane: str = "max") -> Levels:
    """Return the picture (rows, columns) over spans between ``edges_s`` (columns + 1), highest frequency first.

    ``edges_s`` never falls but may be uneven (metres): the source is asked finely enough for the quickest stretch, and
    what is finer than a pixel is pooled, as the plane is.
    """
    columns = len(edges_s) - 1
    steps = np.diff(edges_s)
    span = float(edges_s[-1] - edges_s[0])
    usable = steps[steps > 0]
    if span <= 0.0 or len(usable) == 0 or rows < 1:
        return np.zeros((max(rows, 0), columns), dtype=np.uint8)
    even = float(usable.max()) <= 1.001 * float(usable.min()) and len(usable) == columns
    asked = (
        columns
        if even
        else int(min(np.ceil(2.0 * span / max(float(np.percentile(usable, 2.0)), 1e-9 * span)), MOST_COLUMNS))
    )
    asked = max(asked, columns)
    levels = source.columns(float(edges_s[0]), float(edges_s[-1]), asked, plane)
    step_db = source.step_db if plane == "mean" else None
    levels = pooled_rows(levels, source.frequencies_hz, frequency, rows, step_db)
    return levels if even else pooled_columns(levels, edges_s, step_db)


def pooled_columns(levels: Levels, edges_s: FloatArray, step_db: float | None = None) -> Levels:
    """Return even columns pooled over uneven spans that together cover the same time.

    Pooled are maxima, or with ``step_db`` the means of the powers of levels that are steps of so many decibels.
    """
    count = levels.shape[1]
    places = (edges_s - edges_s[0]) / (edges_s[-1] - edges_s[0]) * count
    starts = np.clip(np.floor(places[:-1] + 1e-6).astype(np.intp), 0, count - 1)
    ends = np.clip(np.ceil(places[1:] - 1e-6).astype(np.intp), starts + 1, count)
    if step_db is not None:
        return np.ascontiguousarray(mean_levels(levels, starts, ends, step_db, axis=1))
    pairs = np.empty(2 * len(starts), dtype=np.intp)
    pairs[0::2], pairs[1::2] = starts, np.minimum(ends, count - 1)
    # a reduceat whose end is not beyond its start returns the start alone: right for spans of one column
    pooled = np.maximum.reduceat(levels, pairs, axis=1)[:, 0::2]
    to_end = ends == count
    pooled[:, to_end] = np.maximum(pooled[:, to_end], levels[:, -1:])
    return np.ascontiguousarray(pooled)


def bin_rows(
    frequencies_hz: FloatArray, frequency: Scale, rows: int
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return for each pixel row, top first, the first bin that it shows and the one after its last; equal for none."""
    edges = np.asarray(frequency.value(np.linspace(1.0, 0.0, rows + 1)))
    middles = 0.5 * (frequencies_hz[1:] + frequencies_hz[:-1])
    half = 0.5 * float(frequencies_hz[1] - frequencies_hz[0]) if len(frequencies_hz) > 1 else np.inf
    # the bins whose own span touches the row's
    starts = np.searchsorted(middles, edges[1:], side="right")
    ends = np.searchsorted(middles, edges[:-1], side="left") + 1
    outside = (edges[:-1] <= frequencies_hz[0] - half) | (edges[1:] >= frequencies_hz[-1] + half)
    ends = np.where(outside, starts, np.maximum(ends, starts + 1))
    return starts, np.minimum(ends, len(frequencies_hz))


def pooled_rows(
    levels: Levels, frequencies_hz: FloatArray, frequency: Scale, rows: int, step_db: float | None = None
) -> Levels:
    """Return (rows, columns): each pixel row pools the bins that it shows, as :func:`pooled_columns`; 0 for none."""
    starts, ends = bin_rows(frequencies_hz, frequency, rows)
    if step_db is None:
        # of each pair the even result is the row's; the row added behind makes every end a valid mark
        closed = np.concatenate((levels, levels[-1:]))
        marks = np.stack((np.minimum(starts, len(levels) - 1), ends), axis=1).ravel()
        pooled: Levels = np.maximum.reduceat(closed, marks, axis=0)[0::2]
    else:
        first = np.minimum(starts, len(levels) - 1)
        pooled = mean_levels(levels, first, np.maximum(ends, first + 1), step_db, axis=0)
    pooled[ends <= starts] = 0
    return np.ascontiguousarray(pooled)


def mean_levels(
    levels: Levels, starts: npt.NDArray[np.intp], ends: npt.NDArray[np.intp], step_db: float, axis: int
) -> Levels:
    """Return the level of the mean power over ``starts``..``ends`` (each not empty) along an axis.

    What is 0, "nothing there", does not count; a span of nothing is 0.
    """
    power = np.asarray(10.0 ** (0.1 * step_db * np.arange(256)), np.float32)
    power[0] = 0.0
    there = np.ones(256, np.float32)
    there[0] = 0.0
    total, count = (_summed(table[levels], starts, ends, axis) for table in (power, there))
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = np.rint(10.0 * np.log10(total / count) / step_db)
    return np.where(count > 0, np.clip(steps, 1, 255), 0).astype(np.uint8)


def _summed(
    values: npt.NDArray[np.float32], starts: npt.NDArray[np.intp], ends: npt.NDArray[np.intp], axis: int
) -> npt.NDArray[np.float32]:
    """Return the sums over spans along an axis."""
    room = [(0, 0), (0, 0)]
    room[axis] = (0, 1)  # so that every end is a valid mark; never inside a span
    closed = np.pad(values, room)
    marks = np.stack((starts, ends), axis=1).ravel()
    sums = np.add.reduceat(closed, marks, axis=axis)
    return sums[0::2] if axis == 0 else sums[:, 0::2]
