"""The little pictures of sound around the candidates: the same metres, frequencies and decibels for all of them.

What a picture shows is a :class:`~widgets.spectrogram_picture.PictureKey`, which also names it in the memory; a worker
reads it from the stored tiles. Without a path the axis counts seconds.
"""

import math
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from processing.survey import Candidate, FloatArray
from widgets.level_view import LevelCurves
from widgets.plot_scale import Scale
from widgets.spectrogram_picture import (
    BACKGROUND_M,
    BACKGROUND_S,
    FEWEST_HALF,
    MOST_HALF,
    PictureKey,
    PictureWish,
    Plane,
)
from widgets.tile_source import Levels, TileSource
from widgets.time_axis import AxisMode, DistanceMap

HALF_M, HALF_S = 8.0, 8.0
MOST_BYTES = 48_000_000  # of pictures that are kept


@dataclass(frozen=True)
class GallerySound:
    """What the pictures are read from and how: the same for all of them.

    ``stretches`` are spans of the axis that were not assessed; ``colours`` the 256 colours (0xffrrggbb) of the levels.
    """

    source: TileSource
    distances: DistanceMap | None
    levels: LevelCurves | None
    stretches: tuple[tuple[float, float], ...]
    frequency: Scale
    plane: Plane
    colours: tuple[int, ...]
    version: int  # of the results: pictures of other results are others

    @property
    def mode(self) -> AxisMode:
        """What the pictures' axis counts."""
        return AxisMode.TIME if self.distances is None else AxisMode.DISTANCE

    @property
    def half(self) -> float:
        """From the middle of a picture to its end."""
        return HALF_S if self.distances is None else HALF_M

    def middle(self, candidate: Candidate) -> float:
        """Return where a candidate is on the axis; NaN where it has no place there."""
        return candidate.time_s if self.distances is None else candidate.chainage_m

    def key(self, candidate: Candidate, columns: int, rows: int) -> PictureKey | None:
        """Return what the picture of a candidate shows, in device pixels; None for one without a place."""
        middle = self.middle(candidate)
        if not math.isfinite(middle):
            return None
        low, high = middle - self.half, middle + self.half
        return PictureKey(low, high, self.mode, self.frequency, columns, rows, self.version, self.plane)

    def read(self, keys: Sequence[PictureKey]) -> dict[PictureKey, Levels]:
        """Read pictures, uint8 (rows, columns), highest frequency first; for a worker. 0 is outside of the run."""
        return {key: self._read_one(key) for key in keys}

    def _read_one(self, key: PictureKey) -> Levels:
        edges = np.linspace(key.x_low, key.x_high, key.columns + 1)
        ground, half = self._ground(key)
        wish = PictureWish(
            key, self._moments(edges), 0.5 * (ground[1:] + ground[:-1]), self._moments(ground), half
        )  # fmt: skip
        levels = np.array(wish.read(self.source).levels)
        first, last = self._ends()
        levels[:, (edges[1:] <= first) | (edges[:-1] >= last)] = 0
        return levels

    def _moments(self, edges: FloatArray) -> FloatArray:
        """Return survey seconds of places on the axis, never falling; what stood still belongs to one column."""
        if self.distances is None or not len(edges):
            return edges
        return np.maximum.accumulate(self.distances.first_time_at(edges))

    def _ends(self) -> tuple[float, float]:
        if self.distances is None:
            return self.source.start_s, self.source.end_s
        return float(self.distances.chainage_m[0]), float(self.distances.chainage_m[-1])

    def _ground(self, key: PictureKey) -> tuple[FloatArray, int]:
        """Return the edges of the columns of the local background, and how many are half a window of it."""
        if key.plane is not Plane.EXCESS:
            return np.zeros(0), 0
        reach = BACKGROUND_S if self.distances is None else BACKGROUND_M
        column = max((key.x_high - key.x_low) / key.columns, reach / MOST_HALF)
        half = max(FEWEST_HALF, round(reach / column))
        first, last = self._ends()
        low, high = max(key.x_low - 2 * half * column, first), min(key.x_high + 2 * half * column, last)
        return np.linspace(low, high, max(1, round((high - low) / column)) + 1), half

    def curve(self, candidate: Candidate) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return places on the axis, levels over the local background and the threshold over it (dB) near a candidate.

        NaN is "not assessed"; all empty where no levels are known.
        """
        curves, middle = self.levels, self.middle(candidate)
        none = np.zeros(0)
        if curves is None or not math.isfinite(middle):
            return none, none, none
        x = curves.time_s if self.distances is None else curves.chainage_m
        if x is None:
            return none, none, none
        first, last = np.searchsorted(x, [middle - self.half, middle + self.half])
        part = slice(max(int(first) - 1, 0), int(last) + 1)
        ground = np.zeros(len(x[part])) if curves.background_db is None else curves.background_db[part]
        limit = np.full(len(x[part]), np.nan) if curves.threshold_db is None else curves.threshold_db[part] - ground
        return x[part], curves.level_db[part] - ground, limit


def curve_top_db(sound: GallerySound, candidates: Iterable[Candidate]) -> float:
    """Return the upper end of the level curves, one for all: what the loudest candidate needs, 12 to 30 dB."""
    highest = 0.0
    for candidate in candidates:
        over = sound.curve(candidate)[1]
        known = over[np.isfinite(over)]
        highest = max(highest, float(known.max())) if len(known) else highest
    return float(min(max(math.ceil(highest / 3.0) * 3.0, 12.0), 30.0))


class KeptPictures:
    """Pictures by their key, the least used ones forgotten; never more bytes than :data:`MOST_BYTES`."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._most = most_bytes
        self._bytes = 0
        self._kept: OrderedDict[PictureKey, Levels] = OrderedDict()

    def __contains__(self, key: PictureKey) -> bool:
        return key in self._kept

    @property
    def size_bytes(self) -> int:
        """What is kept now."""
        return self._bytes

    def take(self, pictures: dict[PictureKey, Levels]) -> None:
        """Keep pictures."""
        for key, levels in pictures.items():
            if key not in self._kept:
                self._bytes += levels.nbytes
            self._kept[key] = levels
            self._kept.move_to_end(key)
        while self._bytes > self._most and len(self._kept) > 1:
            self._bytes -= self._kept.popitem(last=False)[1].nbytes

    def find(self, key: PictureKey | None) -> Levels | None:
        """Return a picture, if it is there."""
        if key is None or key not in self._kept:
            return None
        self._kept.move_to_end(key)
        return self._kept[key]

    def clear(self) -> None:
        """Forget all."""
        self._kept.clear()
        self._bytes = 0
