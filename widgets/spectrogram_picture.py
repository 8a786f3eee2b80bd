"""What a picture of sound shows, which part of it a view needs, how it is read: levels, or levels over their ground.

The excess view takes from each level the running median of its own row along the axis: a sound that stays where it is
stands out, whatever the pipe sounds like there. It is drawn from mean levels; the maximum of noise has no zero.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray
from widgets.plot_scale import Scale
from widgets.tile_source import Levels, TileSource, pixel_levels
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor

EXCESS_LOW_DB, EXCESS_STEP_DB = -64.0, 0.5
BACKGROUND_M, BACKGROUND_S = 24.0, 40.0  # half the window; metres as the detector's background
FEWEST_HALF, MOST_HALF = 4, 12  # columns in half a window
_NEUTRAL = 128


class Plane(StrEnum):
    """What of the sound is shown."""

    SHORT = "max"  # a short event is visible at any zoom
    STEADY = "mean"  # steady sounds are not hidden under the maxima of noise
    EXCESS = "excess"  # steady sounds over the local background

    @property
    def of_tiles(self) -> str:
        """Which plane of the tiles it is drawn from."""
        return "max" if self is Plane.SHORT else "mean"


@dataclass(frozen=True)
class PictureKey:
    """What a picture shows; two pictures with the same key are the same."""

    x_low: float
    x_high: float
    mode: AxisMode
    frequency: Scale
    columns: int
    rows: int
    map_version: int
    plane: Plane = Plane.SHORT

    def is_of_same_axes(self, other: "PictureKey") -> bool:
        """Return whether one can be drawn stretched in the place of the other."""
        mine = (self.mode, self.map_version, self.frequency.kind, self.plane)
        return mine == (other.mode, other.map_version, other.frequency.kind, other.plane)

    def covers(self, other: "PictureKey") -> bool:
        """Return whether all that the other shows is within this one."""
        has, wants = self.frequency, other.frequency
        across = self.x_low <= other.x_low and other.x_high <= self.x_high
        return self.is_of_same_axes(other) and across and has.low <= wants.low and wants.high <= has.high


@dataclass(frozen=True)
class Picture:
    """Levels (rows, columns), highest frequency first, and what they show."""

    key: PictureKey
    levels: Levels

    def visible_part(self, wanted: PictureKey) -> tuple[Levels, tuple[float, float], tuple[float, float]]:
        """Return the levels that ``wanted`` shows, and from where to where they reach: along x, and down the axis.

        Qt counts in 1/65536 of a pixel when it stretches: what is far outside must not be part of the image.
        """
        has, (rows, columns) = self.key, self.levels.shape
        top, bottom = has.frequency.spread(has.frequency.high), has.frequency.spread(has.frequency.low)
        upper, lower = wanted.frequency.spread(wanted.frequency.high), wanted.frequency.spread(wanted.frequency.low)
        across, xs = _cut(has.x_low, has.x_high, columns, wanted.x_low, wanted.x_high)
        down, ys = _cut(top, bottom, rows, upper, lower)
        return self.levels[down, across], xs, ys


def _cut(first: float, last: float, count: int, start: float, end: float) -> tuple[slice, tuple[float, float]]:
    """Return which of ``count`` cells from ``first`` to ``last`` touch ``start`` to ``end``, and where those reach."""
    cell = (last - first) / count
    begin = min(max(math.floor((start - first) / cell + 1e-6), 0), count)
    stop = min(max(math.ceil((end - first) / cell - 1e-6), begin), count)
    return slice(begin, stop), (first + begin * cell, last if stop == count else first + stop * cell)


@dataclass(frozen=True)
class PictureWish:
    """All that a worker needs to read one picture: plain data, taken from the cursor on the window's thread."""

    key: PictureKey
    edges_s: FloatArray  # (columns + 1,)
    ground_x: FloatArray  # (m,) middles of the columns of the background, in the axis' unit
    ground_edges_s: FloatArray  # (m + 1,)
    half: int  # columns of the background in half a window

    @classmethod
    def of(cls, key: PictureKey, cursor: TimeCursor) -> "PictureWish":
        """Return the wish for what ``key`` shows."""
        edges = cursor.edges_s(key.x_low, key.x_high, key.columns)
        if key.plane is not Plane.EXCESS:
            return cls(key, edges, np.zeros(0), np.zeros(0), 0)
        reach = BACKGROUND_M if key.mode is AxisMode.DISTANCE else BACKGROUND_S
        column = max((key.x_high - key.x_low) / key.columns, reach / MOST_HALF)
        half = max(FEWEST_HALF, round(reach / column))
        first, last = cursor.x_extent
        low, high = max(key.x_low - 2 * half * column, first), min(key.x_high + 2 * half * column, last)
        count = max(1, round((high - low) / column))
        places = np.linspace(low, high, count + 1)
        return cls(key, edges, 0.5 * (places[1:] + places[:-1]), cursor.edges_s(low, high, count), half)

    def read(self, source: TileSource) -> Picture:
        """Read the picture."""
        key = self.key
        levels = pixel_levels(source, self.edges_s, key.frequency, key.rows, key.plane.of_tiles)
        if key.plane is Plane.EXCESS:
            ground = pixel_levels(source, self.ground_edges_s, key.frequency, key.rows, key.plane.of_tiles)
            x = key.x_low + (np.arange(key.columns) + 0.5) * (key.x_high - key.x_low) / key.columns
            levels = excess(levels, x, ground, self.ground_x, self.half)
        return Picture(key, levels)


def excess(levels: Levels, x: FloatArray, ground: Levels, ground_x: FloatArray, half: int) -> Levels:
    """Return levels (rows, n) at ``x`` (n,) over the running median of ``ground`` (rows, m) at ``ground_x`` (m,).

    128 is the background itself, a step is half a decibel, 0 is where there is no level or no background.
    """
    known = ground.any(axis=0)
    out = np.zeros_like(levels)
    if not known.any():
        return out
    places, middles = _medians(ground[:, known], half)
    at = np.interp(x, ground_x[known][places], np.arange(len(places)))
    first = np.minimum(at.astype(np.intp), len(places) - 1)
    after = np.minimum(first + 1, len(places) - 1)
    part = (at - first).astype(np.float32)
    under = middles[:, first] * (1.0 - part) + middles[:, after] * part
    over = np.rint(levels.astype(np.float32) - under) + np.float32(_NEUTRAL)
    return np.where(levels > 0, np.clip(over, 1, 255), out).astype(np.uint8)


def _medians(ground: Levels, half: int) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.float32]]:
    """Return some columns' numbers (k,), and the medians (rows, k) of the columns within ±``half`` of each."""
    count = ground.shape[1]
    half = min(half, count - 1)
    places = np.unique(np.append(np.arange(0, count, max(1, half // 3)), count - 1))
    mirrored = np.pad(ground, ((0, 0), (half, half)), mode="reflect") if half else ground
    windows = np.lib.stride_tricks.sliding_window_view(mirrored, 2 * half + 1, axis=1)
    medians = np.empty((len(ground), len(places)), np.float32)
    for row, place in enumerate(places):
        medians[:, row] = np.partition(windows[:, place], half, axis=1)[:, half]
    return places, medians
