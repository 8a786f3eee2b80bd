"""The picture of the sound at every zoom: a spectrogram and a waveform, each pooled four or sixteen times over.

An event of a single window stays visible in the ``max`` plane at any zoom; the ``mean`` plane shows steady sounds,
which the maximum of noise hides (acoustics §4.3).
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from processing.sound.analysis import PART_LEVELS, TILE_FACTOR, Halves, power_of, scaled_hann
from processing.sound.bands import Grid
from processing.sound.rows import RowFile, load_rows, read_blocks
from processing.sound.source import AudioReader
from processing.sound.tile_values import TILE_POWER, Bytes, Pool, max_of_rows, mean_of_rows, pooled, tile_db, to_tile
from processing.survey import AudioSource, FloatArray

__all__ = [
    "PLANES",
    "TilePyramid",
    "WavePyramid",
    "build_upper_levels",
    "load_pyramids",
    "pool_columns",
    "spectrogram_detail",
    "streamed_levels",
    "tile_db",
    "tile_path",
    "wave_block_count",
    "wave_path",
]

PLANES = ("max", "mean")
_TILE_TOP = 1024
_WAVE_FACTOR, _WAVE_TOP = 16, 4096
_READ_BLOCK = 1 << 12
_DETAIL_BLOCK = 64


@dataclass(frozen=True)
class TilePyramid:
    """Spectrogram columns (rows of the arrays) and their pooled levels, memory-mapped; see :meth:`columns`."""

    grid: Grid
    levels: dict[str, tuple[Bytes, ...]]  # plane → finest first, each (columns, bins)

    @property
    def frequency_hz(self) -> FloatArray:
        """Centre frequencies (bins,) of the rows of a picture."""
        return self.grid.picture_hz()

    @property
    def finest_column_s(self) -> float:
        """Seconds in the finest column; a closer look needs :func:`spectrogram_detail`."""
        return self.grid.column_s

    def columns(self, start_s: float, end_s: float, n_columns: int, plane: str = "max") -> Bytes:
        """Return the picture uint8 (bins, n_columns) of ``start_s``..``end_s`` of audio time, exact to the pixel.

        Each pixel pools every stored column that it touches, from the coarsest level that still has one for each
        pixel. What lies outside the recording is 0. ``tile_db`` makes decibels of it.
        """
        if plane not in PLANES:
            raise ValueError(f"no plane {plane!r}")
        if n_columns < 1 or not end_s > start_s:
            raise ValueError("an empty picture")
        pixel_s = (end_s - start_s) / n_columns
        stack = self.levels[plane]
        level = max((k for k in range(len(stack)) if self._column_s(k) <= pixel_s), default=0)
        edges: FloatArray = np.asarray((start_s + np.arange(n_columns + 1) * pixel_s) / self._column_s(level), float)
        return pool_columns(stack[level], edges, plane).T

    def _column_s(self, level: int) -> float:
        return self.grid.column_s * float(TILE_FACTOR**level)


def pool_columns(columns: Bytes, edges: FloatArray, plane: str) -> Bytes:
    """Return (pixels, bins): ``columns`` pooled between fractional ``edges`` (pixels + 1,)."""
    first = np.floor(edges[:-1] + 1e-9).astype(np.int64)
    end = np.maximum(np.ceil(edges[1:] - 1e-9).astype(np.int64), first + 1)
    out = np.zeros((len(first), columns.shape[1]), np.uint8)
    inside = (end > 0) & (first < len(columns))
    if not inside.any():
        return out
    first, end = np.maximum(first[inside], 0), np.minimum(end[inside], len(columns))
    base = int(first[0])
    piece = np.asarray(columns[base : int(end[-1])])
    out[inside] = _pool_ranges(piece, first - base, end - base, plane)
    return out


def _pool_ranges(piece: Bytes, first: npt.NDArray[np.int64], end: npt.NDArray[np.int64], plane: str) -> Bytes:
    """Return the maximum or the power mean of the rows ``first``..``end`` of ``piece``, one row a range."""
    # reduceat takes the starts of neighbouring ranges: of each pair the even result is ours, the odd one fills the gap;
    # the row added behind makes every end a valid mark and is never inside a range
    marks = np.column_stack([first, end]).ravel()
    closed = np.concatenate([piece, piece[-1:]])
    if plane == "max":
        highest: Bytes = np.maximum.reduceat(closed, marks, axis=0)[::2]
        return highest
    total = np.add.reduceat(TILE_POWER[closed], marks, axis=0)[::2]
    return to_tile((total / (end - first)[:, None]).astype(np.float32))


class Reads(Protocol):
    """Gives samples from anywhere, as :class:`processing.sound.source.AudioReader` does."""

    def read(self, start: int, count: int) -> npt.NDArray[np.float32]:
        """Return up to ``count`` samples from frame ``start`` on."""


@dataclass(frozen=True)
class WavePyramid:
    """Lowest, highest and rms value of short blocks of the waveform, and pooled levels; memory-mapped float16."""

    grid: Grid
    levels: tuple[Halves, ...]  # finest first, each (blocks, 3)

    def columns(self, start_s: float, end_s: float, n_columns: int) -> npt.NDArray[np.float32]:
        """Return (3, n_columns): lowest, highest and rms in each pixel of ``start_s``..``end_s``; 0 outside."""
        if n_columns < 1 or not end_s > start_s:
            raise ValueError("an empty picture")
        pixel_s = (end_s - start_s) / n_columns
        block_s = self.grid.wave_block / self.grid.sample_rate_hz
        sizes = [block_s * float(_WAVE_FACTOR**k) for k in range(len(self.levels))]
        level = max((k for k, size in enumerate(sizes) if size <= pixel_s), default=0)
        edges = (start_s + np.arange(n_columns + 1) * pixel_s) / sizes[level]
        blocks = self.levels[level]
        first = np.floor(edges[:-1] + 1e-9).astype(np.int64)
        end = np.maximum(np.ceil(edges[1:] - 1e-9).astype(np.int64), first + 1)
        out = np.zeros((3, n_columns), np.float32)
        inside = (end > 0) & (first < len(blocks))
        if inside.any():
            first, end = np.maximum(first[inside], 0), np.minimum(end[inside], len(blocks))
            piece = np.asarray(blocks[int(first[0]) : int(end[-1])], np.float32)
            out[:, inside] = _pool_wave(piece, first - first[0], end - first[0])
        return out


def _pool_wave(
    piece: npt.NDArray[np.float32], first: npt.NDArray[np.int64], end: npt.NDArray[np.int64]
) -> npt.NDArray[np.float32]:
    closed = np.concatenate([piece, piece[-1:]])  # so that every end is a valid mark; never inside a range
    marks = np.column_stack([first, end]).ravel()
    low = np.minimum.reduceat(closed[:, 0], marks)[::2]
    high = np.maximum.reduceat(closed[:, 1], marks)[::2]
    square = np.add.reduceat(np.square(closed[:, 2]), marks)[::2] / (end - first)
    return np.vstack([low, high, np.sqrt(square)]).astype(np.float32)


# --- building and loading --------------------------------------------------------------------------------------------


def tile_path(folder: Path, plane: str, level: int) -> Path:
    """Return where a level of the spectrogram lies."""
    return folder / f"tiles_{plane}_{level}.npy"


def wave_path(folder: Path, level: int) -> Path:
    """Return where a level of the waveform envelope lies."""
    return folder / f"wave_{level}.npy"


def streamed_levels(grid: Grid) -> list[int]:
    """Return how many rows each level of the picture has that the pass itself pools, finest first."""
    rows = [grid.column_count]
    for _ in range(min(PART_LEVELS, _tile_level_count(grid) - 1)):
        rows.append(-(-rows[-1] // TILE_FACTOR))
    return rows


def build_upper_levels(folder: Path, grid: Grid) -> None:
    """Pool what the pass left in ``folder`` until each picture is small."""
    for plane in PLANES:
        pool = max_of_rows if plane == "max" else mean_of_rows
        for level in range(len(streamed_levels(grid)), _tile_level_count(grid)):
            _pool_file(tile_path(folder, plane, level - 1), tile_path(folder, plane, level), TILE_FACTOR, pool)
    for level in range(1, _wave_level_count(grid)):
        _pool_file(wave_path(folder, level - 1), wave_path(folder, level), _WAVE_FACTOR, _wave_of_rows)


def load_pyramids(folder: Path, grid: Grid) -> tuple[TilePyramid, WavePyramid]:
    """Return both pyramids, memory-mapped.

    Raises:
        ValueError, OSError: a file is missing, damaged or of another shape.
    """
    levels: dict[str, tuple[Bytes, ...]] = {}
    for plane in PLANES:
        maps, rows = [], grid.column_count
        for level in range(_tile_level_count(grid)):
            maps.append(_checked(tile_path(folder, plane, level), np.uint8, (rows, grid.picture_bins)))
            rows = -(-rows // TILE_FACTOR)
        levels[plane] = tuple(maps)
    waves, rows = [], wave_block_count(grid)
    for level in range(_wave_level_count(grid)):
        waves.append(_checked(wave_path(folder, level), np.float16, (rows, 3)))
        rows = -(-rows // _WAVE_FACTOR)
    return TilePyramid(grid, levels), WavePyramid(grid, tuple(waves))


def wave_block_count(grid: Grid) -> int:
    """Return how many blocks of the waveform envelope cover the recording."""
    return max(1, -(-grid.frames // grid.wave_block))


def _checked(path: Path, dtype: npt.DTypeLike, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    array = load_rows(path)
    if array.dtype != np.dtype(dtype) or array.shape != shape:
        raise ValueError(f"{path.name} is not what it should be")
    return array


def _tile_level_count(grid: Grid) -> int:
    return _level_count(grid.column_count, TILE_FACTOR, _TILE_TOP)


def _wave_level_count(grid: Grid) -> int:
    return _level_count(wave_block_count(grid), _WAVE_FACTOR, _WAVE_TOP)


def _level_count(rows: int, factor: int, top: int) -> int:
    count = 1
    while rows > top:
        rows, count = -(-rows // factor), count + 1
    return count


def _pool_file(fine: Path, coarse: Path, factor: int, pool: Pool) -> None:
    whole_map = load_rows(fine)
    out = RowFile(coarse, whole_map.dtype, -(-len(whole_map) // factor), whole_map.shape[1])
    try:
        for block in read_blocks(fine, _READ_BLOCK):
            out.add(pooled(block, factor, pool))
        out.finish()
    finally:
        out.discard()


def _wave_of_rows(rows: npt.NDArray[Any]) -> npt.NDArray[Any]:
    square = np.square(rows[:, :, 2].astype(np.float32)).mean(axis=1)
    return np.column_stack([rows[:, :, 0].min(axis=1), rows[:, :, 1].max(axis=1), np.sqrt(square)])


# --- closer than the stored columns ----------------------------------------------------------------------------------


def spectrogram_detail(
    source: AudioSource, start_s: float, end_s: float, n_columns: int, plane: str = "max", cleaned: Reads | None = None
) -> Bytes:
    """Return the picture uint8 (bins, n_columns) computed from the sound itself, for zooms finer than the pyramid.

    A pixel shorter than a hop gets the window around its middle; a longer one pools windows at most a hop apart. The
    rows are those of the pyramid. Meant for pixels below one stored column: the work grows with ``end_s - start_s``.
    ``cleaned`` reads other sound of the same length in the place of the recording's own.
    """
    grid = Grid(source.sample_rate_hz, source.frames)
    pixel = (end_s - start_s) * grid.sample_rate_hz / n_columns
    per_pixel = max(1, int(np.ceil(pixel / grid.hop)))
    window = scaled_hann(grid.window)
    out = np.empty((n_columns, grid.picture_bins), np.float32)
    rows = grid.picture_bins * grid.bins_pooled
    with AudioReader(source) as reader:
        for first in range(0, n_columns, _DETAIL_BLOCK):
            count = min(_DETAIL_BLOCK, n_columns - first)
            centres = start_s * grid.sample_rate_hz + (
                first * pixel + (np.arange(count * per_pixel) + 0.5) * (pixel / per_pixel)
            )
            starts = np.rint(centres).astype(np.int64) - grid.window // 2
            piece = _padded(cleaned or reader, int(starts[0]), int(starts[-1]) + grid.window, source.frames)
            view = np.lib.stride_tricks.sliding_window_view(piece, grid.window)[starts - starts[0]]
            power = power_of(view * window)[:, :rows].reshape(count, per_pixel, -1)
            pooled = power.max(axis=1) if plane == "max" else power.mean(axis=1)
            by_row = pooled.reshape(count, grid.picture_bins, grid.bins_pooled)
            out[first : first + count] = by_row.max(axis=2) if plane == "max" else by_row.mean(axis=2)
    return to_tile(out).T


def _padded(reader: Reads, start: int, end: int, frames: int) -> npt.NDArray[np.float32]:
    """Return samples ``start``..``end``, zeros where there is no recording."""
    inside_start, inside_end = min(max(start, 0), frames), max(min(end, frames), 0)
    samples = reader.read(inside_start, max(0, inside_end - inside_start))
    out = np.zeros(end - start, np.float32)
    if len(samples):
        out[inside_start - start : inside_start - start + len(samples)] = samples
    return out
