"""A level as one byte: steps of 0.5 dB above −130 dBFS, and how such bytes are pooled."""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Bytes = npt.NDArray[np.uint8]
Power = npt.NDArray[np.float32]
Pool = Callable[[npt.NDArray[Any]], npt.NDArray[Any]]

TILE_FLOOR_DB, TILE_STEP_DB = -130.0, 0.5
TILE_POWER: Power = (10.0 ** ((TILE_FLOOR_DB + TILE_STEP_DB * np.arange(256)) / 10)).astype(np.float32)
_DROPPED_BITS = 15  # of a float32's 23: 256 steps an octave, 0.012 dB each


def _tile_of_bits() -> Bytes:
    """Return the tile value of every leading part of a float32's bits: a logarithm is dearer than an FFT."""
    bits = (np.arange(1 << (32 - _DROPPED_BITS), dtype=np.uint32) << _DROPPED_BITS) + np.uint32(
        1 << (_DROPPED_BITS - 1)
    )
    with np.errstate(invalid="ignore"):  # some of them are no numbers
        middle = bits.view(np.float32).astype(np.float64)
    sound = np.isfinite(middle) & (middle > 0)
    level = 10 * np.log10(np.where(sound, middle, 1.0))
    steps = np.clip((level - TILE_FLOOR_DB) / TILE_STEP_DB + 0.5, 0, 255)
    beyond = np.where(middle > 0, 255, 0)  # infinite; or below nothing, which is not a power
    tile: Bytes = np.where(sound, steps, beyond).astype(np.uint8)
    return tile


_TILE_OF_BITS = _tile_of_bits()


def to_tile(power: Power) -> Bytes:
    """Return power ≥ 0 as steps of 0.5 dB above −130 dBFS, 0 to 255; right to 0.01 dB beside half a step."""
    bits = np.ascontiguousarray(power, np.float32).view(np.uint32) >> np.uint32(_DROPPED_BITS)
    tile: Bytes = _TILE_OF_BITS[bits]
    return tile


def tile_db(tile: Bytes) -> Power:
    """Return dBFS of tile values: 0 dB is a full-scale sine."""
    level: Power = tile.astype(np.float32) * np.float32(TILE_STEP_DB) + np.float32(TILE_FLOOR_DB)
    return level


def max_of_rows(rows: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the highest (n, columns) of ``rows`` (n, factor, columns)."""
    highest: npt.NDArray[Any] = rows.max(axis=1)
    return highest


def mean_of_rows(rows: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the power mean (n, columns) of tile values ``rows`` (n, factor, columns)."""
    return to_tile(TILE_POWER[rows].mean(axis=1))


def pooled(rows: npt.NDArray[Any], factor: int, pool: Pool) -> npt.NDArray[Any]:
    """Return ``rows`` (n, columns) pooled ``factor`` at a time; the last group may be smaller."""
    whole = len(rows) // factor * factor
    pieces = [pool(rows[:whole].reshape(-1, factor, rows.shape[1]))] if whole else []
    if whole < len(rows):
        pieces.append(pool(rows[whole:][None]))
    return np.concatenate(pieces) if len(pieces) != 1 else pieces[0]
