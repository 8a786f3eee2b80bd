"""Minimum and maximum of a long signal over any spans, at a cost that depends on the pixels and not on the hours."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray

Float32Array = npt.NDArray[np.float32]
ReadSamples = Callable[[int, int], npt.NDArray[np.floating]]
FACTOR = 8
CHUNK = FACTOR**6
FEWEST_BLOCKS = 512
BLOCKS_A_COLUMN = 4


@dataclass(frozen=True)
class EnvelopePyramid:
    """A signal over time (or chainage) ``x`` (n,), never falling, with extremes of blocks of 8, 64, 512 … samples.

    The samples themselves stay where they are and are asked for by ``read(start, stop)``, so that hours of them need
    little memory. ``lows[k]`` and ``highs[k]`` hold blocks of ``8**(k + 1)``. NaN is "no value" and is passed over. A
    hole in ``x`` longer than ``gap`` is shown as a hole.
    """

    x: FloatArray
    read: ReadSamples
    lows: tuple[Float32Array, ...]
    highs: tuple[Float32Array, ...]
    gap: float

    @classmethod
    def build(cls, x: FloatArray, samples: npt.ArrayLike | ReadSamples, gap: float | None = None) -> "EnvelopePyramid":
        """Return the pyramid of ``samples`` (n,), or of what ``samples(start, stop)`` returns, at ``x`` (n,)."""
        places = np.asarray(x, dtype=np.float64)
        if callable(samples):
            read: ReadSamples = samples
        else:
            values = np.asarray(samples, dtype=np.float64)

            def read(start: int, stop: int) -> npt.NDArray[np.floating]:
                return values[start:stop]

        lows, highs = _first_level(read, len(places))
        while len(lows[-1]) > FEWEST_BLOCKS:
            starts = np.arange(0, len(lows[-1]), FACTOR)
            lows.append(np.fmin.reduceat(lows[-1], starts))
            highs.append(np.fmax.reduceat(highs[-1], starts))
        return cls(places, read, tuple(lows), tuple(highs), _usual_gap(places) if gap is None else gap)

    def columns(self, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return minima and maxima (n,) over the spans between ``edges`` (n + 1,), NaN where there is nothing.

        Every sample between the first and the last edge shows in at least one column. Columns between two samples
        that are close enough carry the straight line between them.
        """
        count = max(len(edges) - 1, 0)
        if len(self.x) == 0 or count == 0:
            return np.full(count, np.nan), np.full(count, np.nan)
        index = np.searchsorted(self.x, edges)
        index[-1] = np.searchsorted(self.x, edges[-1], side="right")
        starts, ends = index[:-1], index[1:]
        first, last = max(int(index[0]) - 1, 0), min(int(index[-1]) + 1, len(self.x))
        level = self._level_for(last - first, count)
        if level == 0:
            samples = np.asarray(self.read(first, last), dtype=np.float64)
            low = _reduced(np.fmin, samples, starts - first, ends - first)
            high = _reduced(np.fmax, samples, starts - first, ends - first)
            low, high = _with_lines(self.x[first:last], samples, edges, self.gap, low, high)
        else:
            block = FACTOR**level
            low = _reduced(np.fmin, self.lows[level - 1], starts // block, -(-ends // block))
            high = _reduced(np.fmax, self.highs[level - 1], starts // block, -(-ends // block))
            low[ends <= starts], high[ends <= starts] = np.nan, np.nan
        return low, high

    def value_at(self, x: float) -> float:
        """Return the sample nearest to ``x``; NaN where there is none near."""
        if len(self.x) == 0:
            return float("nan")
        after = int(np.clip(np.searchsorted(self.x, x), 0, len(self.x) - 1))
        before = max(after - 1, 0)
        nearest = before if x - self.x[before] < self.x[after] - x else after
        if abs(float(self.x[nearest]) - x) > self.gap:
            return float("nan")
        return float(self.read(nearest, nearest + 1)[0])

    def span(self, part: float = 1.0) -> tuple[float, float] | None:
        """Return between which values the middle ``part`` of the signal lies; None where there is no value."""
        level = next((k for k, values in enumerate(self.lows) if len(values) <= 100_000), len(self.lows) - 1)
        low, high = (v[np.isfinite(v)] for v in (self.lows[level], self.highs[level]))
        if len(low) == 0:
            return None
        tail = 50.0 * (1.0 - part)
        return float(np.percentile(low, tail)), float(np.percentile(high, 100.0 - tail))

    def _level_for(self, samples: int, columns: int) -> int:
        level = 0
        # 4 blocks a column on average: a quick stretch beside a standstill still gets its own
        while level < len(self.lows) and samples // FACTOR ** (level + 1) >= BLOCKS_A_COLUMN * columns:
            level += 1
        return level


def _first_level(read: ReadSamples, count: int) -> tuple[list[Float32Array], list[Float32Array]]:
    blocks = -(-count // FACTOR)
    low, high = np.empty(blocks, dtype=np.float32), np.empty(blocks, dtype=np.float32)
    for start in range(0, count, CHUNK):
        values = np.asarray(read(start, min(start + CHUNK, count)), dtype=np.float32)
        starts = np.arange(0, len(values), FACTOR)
        place = slice(start // FACTOR, start // FACTOR + len(starts))
        low[place], high[place] = np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)
    return [low], [high]


def _usual_gap(x: FloatArray) -> float:
    steps = np.diff(x[:200_000])
    steps = steps[steps > 0]
    return 8.0 * float(np.median(steps)) if len(steps) else 1e-9


def _reduced(
    function: np.ufunc, values: npt.NDArray[np.floating], starts: npt.NDArray[np.intp], ends: npt.NDArray[np.intp]
) -> FloatArray:
    """Return ``function`` over ``values[start:end]`` for each pair; NaN for an empty one."""
    count = len(values)
    pairs = np.empty(2 * len(starts), dtype=np.intp)
    pairs[0::2] = np.minimum(starts, count - 1)
    pairs[1::2] = np.minimum(ends, count - 1)
    reduced = np.asarray(function.reduceat(values, pairs)[0::2], dtype=np.float64)
    # reduceat cannot name the end of the array: the last block is added by hand
    to_end = (ends >= count) & (starts < count)
    reduced[to_end] = function(reduced[to_end], float(values[-1]))
    reduced[ends <= starts] = np.nan
    return reduced


def _with_lines(
    x: FloatArray, samples: FloatArray, edges: FloatArray, gap: float, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Fill the columns between two samples with the straight line between them, unless there is a hole."""
    empty = np.isnan(low)
    if len(x) < 2 or not np.any(empty):
        return low, high
    middle = (0.5 * (edges[:-1] + edges[1:]))[empty]
    after = np.clip(np.searchsorted(x, middle), 1, len(x) - 1)
    width = x[after] - x[after - 1]
    inside = (middle >= x[after - 1]) & (middle <= x[after]) & (width <= gap) & (width > 0)
    part = np.where(inside, (middle - x[after - 1]) / np.where(width > 0, width, 1.0), np.nan)
    low[empty] = high[empty] = samples[after - 1] + part * (samples[after] - samples[after - 1])
    return low, high


def joined(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the columns of one curve stretched half way to their neighbours, so that no step breaks the curve."""
    rises, falls = low[1:] > high[:-1], high[1:] < low[:-1]
    up, down = 0.5 * (low[1:] + high[:-1]), 0.5 * (high[1:] + low[:-1])
    low, high = low.copy(), high.copy()
    # a spike reaches towards both neighbours: what one asks for must not take back what the other got
    low[1:], high[:-1] = np.where(rises, up, low[1:]), np.where(rises, up, high[:-1])
    high[1:] = np.where(falls, np.maximum(down, high[1:]), high[1:])
    low[:-1] = np.where(falls, np.minimum(down, low[:-1]), low[:-1])
    return low, high
