"""The picture of a sound that has not been gone through: what the running pass has finished, else single windows.

A window is read from the file here and there, the widest gaps first, as long as one may wait; what was read is kept.
So hours of sound show their course within a second, and become the picture of the pass while it runs.
"""

import threading
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from processing.sound.analysis import PART_LEVELS, TILE_FACTOR, power_of, scaled_hann
from processing.sound.bands import Grid
from processing.sound.rows import part_path, read_rows
from processing.sound.scan import SoundScan
from processing.sound.source import AudioReader
from processing.sound.tile_values import TILE_FLOOR_DB, TILE_STEP_DB, Bytes, to_tile
from processing.sound.tiles import PLANES, TilePyramid, pool_columns, spectrogram_detail, streamed_levels, tile_path
from processing.survey import AudioSource, FloatArray

_MOST_WINDOWS = 2048  # over the whole sound; finer gaps are read for what is looked at
_AT_ONCE = 16  # windows between two looks at the clock: on a disc that must turn, each takes 10 ms
_PATIENCE_S = 0.25
_LAST_STEPS_S = 5.0  # that the files of a pass may take to get into place
_DETAIL_S = 60.0

Indices = npt.NDArray[np.intp]


@dataclass(frozen=True)
class _Place:
    folder: Path
    grid: Grid
    columns: int


class GrowingPass:
    """How far the pass over one sound is: told by its thread, asked by others.

    When all columns are there the files are closed and renamed; until :meth:`finished` comes nobody may open them
    (one system refuses to rename what is open), and who asks waits for it.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._place: _Place | None = None
        self._tiles: TilePyramid | None = None
        self._reading = 0

    def grown(self, folder: Path, grid: Grid, columns: int) -> None:
        """Take it that so many picture columns lie in ``folder``; see :data:`processing.sound.scan.Grown`."""
        with self._changed:
            self._place = _Place(folder, grid, columns)
            if columns == grid.column_count:
                self._changed.wait_for(lambda: self._reading == 0, _LAST_STEPS_S)

    def finished(self, scan: SoundScan) -> None:
        """Take it that the pass is complete."""
        with self._changed:
            self._tiles = scan.tiles
            self._changed.notify_all()

    @property
    def tiles(self) -> TilePyramid | None:
        """The picture of the complete pass."""
        return self._tiles

    @property
    def share(self) -> float:
        """How much of the sound the pass has gone through, 0..1."""
        place = self._place
        return 1.0 if self._tiles is not None else 0.0 if place is None else place.columns / place.grid.column_count

    def columns(self, grid: Grid, edges: FloatArray, plane: str) -> tuple[Bytes, npt.NDArray[np.bool_]] | None:
        """Return pixels (n, bins) between ``edges`` (n + 1) in finest columns, and which of them are finished.

        None where nothing is, or the pass is of another sound. Waits while the files get into place.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._tiles is not None or not self._closing, _LAST_STEPS_S)
            place = self._place
            if self._tiles is not None or self._closing or place is None or place.grid != grid:
                return None
            self._reading += 1
        try:
            return _finished_columns(place, edges, plane)
        except (OSError, ValueError):  # the pass was stopped meanwhile, and its folder is elsewhere
            return None
        finally:
            with self._changed:
                self._reading -= 1
                self._changed.notify_all()

    @property
    def _closing(self) -> bool:
        return self._place is not None and self._place.columns == self._place.grid.column_count


def _finished_columns(place: _Place, edges: FloatArray, plane: str) -> tuple[Bytes, npt.NDArray[np.bool_]] | None:
    pixel = float(edges[1] - edges[0])
    top = min(PART_LEVELS, len(streamed_levels(place.grid)) - 1)
    level = max((k for k in range(top + 1) if TILE_FACTOR**k <= pixel), default=0)
    scaled, rows = edges / TILE_FACTOR**level, place.columns // TILE_FACTOR**level
    finished = (scaled[1:] <= rows) & (scaled[1:] > 0)
    if not finished.any():
        return None
    first = max(0, int(np.floor(scaled[0])))
    end = min(rows, int(np.ceil(scaled[np.flatnonzero(finished)[-1] + 1])))
    stored = read_rows(part_path(tile_path(place.folder, plane, level)), first, end - first)
    return pool_columns(stored.astype(np.uint8, copy=False), scaled - first, plane), finished


class CoarseTiles:
    """A picture of ``source`` from the first moment on; times are on the audio clock.

    Asked by several threads; each answer takes about a quarter of a second at most, be the disc ever so slow, and is
    the finer the more was asked before.
    """

    def __init__(self, source: AudioSource, growing: GrowingPass) -> None:
        self._source, self._growing = source, growing
        self._grid = Grid(source.sample_rate_hz, source.frames)
        self._window = scaled_hann(self._grid.window)
        self._lock = threading.Lock()
        count = int(min(_MOST_WINDOWS, max(1, source.frames // self._grid.hop)))
        self._centres = (np.arange(count) + 0.5) * source.frames / count  # samples
        self._read = np.zeros(count, np.bool_)
        self._hurried = 0  # answers that had to leave out some windows
        self._stored = {plane: np.zeros((count, self._grid.picture_bins), np.uint8) for plane in PLANES}

    @property
    def frequencies_hz(self) -> FloatArray:
        """Centres of the bins."""
        return self._grid.picture_hz()

    @property
    def low_db(self) -> float:
        """Level that 0 stands for."""
        return TILE_FLOOR_DB

    @property
    def step_db(self) -> float:
        """Decibels from one number to the next."""
        return TILE_STEP_DB

    @property
    def start_s(self) -> float:
        """First moment."""
        return 0.0

    @property
    def end_s(self) -> float:
        """Last moment."""
        return self._source.duration_s

    @property
    def known(self) -> float:
        """A number that grows when answers become finer: the pass went on, or not all was read that was asked for."""
        return self._growing.share + self._hurried

    def columns(self, start_s: float, end_s: float, columns: int, plane: str = "max") -> Bytes:
        """Return uint8 (bins, columns) between seconds: as finely as it is known by now; 0 outside.

        Raises:
            LeaklineError: AUDIO_UNREADABLE.
        """
        edges_s: FloatArray = start_s + np.arange(columns + 1, dtype=np.float64) * ((end_s - start_s) / columns)
        found = self._growing.columns(self._grid, np.asarray(edges_s / self._grid.column_s, np.float64), plane)
        if self._growing.tiles is not None:
            if end_s - start_s <= _DETAIL_S and edges_s[1] - edges_s[0] < 0.5 * self._grid.column_s:
                return spectrogram_detail(self._source, start_s, end_s, columns, plane)
            return self._growing.tiles.columns(start_s, end_s, columns, plane)
        if end_s - start_s <= _DETAIL_S:
            return spectrogram_detail(self._source, start_s, end_s, columns, plane)
        centres_s = 0.5 * (edges_s[1:] + edges_s[:-1])
        missing = (centres_s > 0) & (centres_s < self.end_s)
        picture = np.zeros((columns, self._grid.picture_bins), np.uint8)
        if found is not None:
            picture[found[1]] = found[0][found[1]]
            missing &= ~found[1]
        if missing.any():
            picture[missing] = self._sampled(centres_s[missing] * self._grid.sample_rate_hz, plane)
        return np.ascontiguousarray(picture.T)

    def _sampled(self, centres: FloatArray, plane: str) -> Bytes:
        """Return (n, bins): the window nearest to each of ``centres`` (samples, rising) that was or could be read."""
        if len(centres) > 1 and centres[1] - centres[0] < 0.5 * self._source.frames / len(self._centres):
            read = np.zeros(len(centres), np.bool_)
            out = {p: np.zeros((len(centres), self._grid.picture_bins), np.uint8) for p in PLANES}
            self._fill(centres, read, out, np.arange(len(centres)))
            return out[plane][_nearest(np.flatnonzero(read), np.arange(len(centres)))]
        with self._lock:
            places = np.clip(centres * (len(self._centres) / self._source.frames), 0, len(self._centres) - 1)
            wanted = places.astype(np.intp)
            if not self._fill(self._centres, self._read, self._stored, np.unique(wanted)):
                self._hurried += 1
            return self._stored[plane][_nearest(np.flatnonzero(self._read), wanted)]

    def _fill(self, centres: FloatArray, read: npt.NDArray[np.bool_], out: dict[str, Bytes], wanted: Indices) -> bool:
        """Read the windows ``wanted`` into ``out`` until one would wait too long, and mark them; True if all are."""
        until_s = time.monotonic() + _PATIENCE_S
        todo = wanted[_widest_gaps_first(len(wanted))]
        todo = todo[~read[todo]]
        with AudioReader(self._source) as reader:
            for first in range(0, len(todo), _AT_ONCE):
                some = todo[first : first + _AT_ONCE]
                windows = np.stack([self._cut(reader, round(centres[i])) for i in some])
                power = power_of(windows * self._window)[:, : self._grid.picture_bins * self._grid.bins_pooled]
                by_row = power.reshape(len(some), self._grid.picture_bins, self._grid.bins_pooled)
                out["max"][some], out["mean"][some] = to_tile(by_row.max(axis=2)), to_tile(by_row.mean(axis=2))
                read[some] = True
                if time.monotonic() > until_s and first + _AT_ONCE < len(todo):
                    return False
        return True

    def _cut(self, reader: AudioReader, centre: int) -> npt.NDArray[np.float32]:
        size, frames = self._grid.window, self._source.frames
        start = min(max(0, centre - size // 2), max(0, frames - size))
        out = np.zeros(size, np.float32)
        samples = reader.read(start, min(size, frames))
        out[: len(samples)] = samples
        return out


def open_coarse(source: AudioSource, growing: GrowingPass) -> CoarseTiles:
    """Return the picture of ``source``, with a first rough look at it already taken.

    Raises:
        LeaklineError: AUDIO_UNREADABLE.
    """
    tiles = CoarseTiles(source, growing)
    tiles.columns(0.0, max(source.duration_s, 1e-3), 64)
    return tiles


def _widest_gaps_first(count: int) -> Indices:
    """Return 0..count − 1 so that each next one halves the widest gap: the bits of a counter, reversed."""
    bits = max(1, (count - 1).bit_length())
    numbers = np.arange(1 << bits)
    turned = np.zeros(1 << bits, np.intp)
    for bit in range(bits):
        turned |= ((numbers >> bit) & 1) << (bits - 1 - bit)
    return turned[turned < count]


def _nearest(known: Indices, wanted: Indices) -> Indices:
    """Return for each of ``wanted`` the nearest of ``known`` (rising, not empty)."""
    after = np.clip(np.searchsorted(known, wanted), 0, len(known) - 1)
    before = np.maximum(after - 1, 0)
    closer = np.abs(known[before] - wanted) <= np.abs(known[after] - wanted)
    return np.where(closer, known[before], known[after])
