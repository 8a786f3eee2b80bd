"""The sound along the pipe as a field of cells and bands with known noise, and shapes of passed sources fitted into it.

A cell's log power varies by what few frames tell (a variance per band over the number of frames), by speed and by slow
drift. The last two are taken out here; what is left of them, :mod:`processing.sound.whitening` learns.
"""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from processing.sound.background import robust_sigma, running_median
from processing.sound.cells import CELL_M, Cells
from processing.survey import BoolArray, FloatArray

WIDTHS_M = (0.8, 1.3, 2.2, 3.6, 6.0)
OVERLAP = 1.5  # cells share frames with their neighbours (weights ½ 1 ½): variance of a sum over that of single cells
_REACH = 6.0  # half length of a shape in half-widths
_WEIGHT_CAP = 2.0  # in medians: where the ball crept, drift, not the number of frames, limits what a cell tells
_LAG_CELLS = 4  # a metre: cells so far apart share no frames
_SPEED_TERMS = 3
_SPEED_RANGE = 2.0  # of the logarithm on either side of the usual speed
_HUBER, _ROUNDS = 1.5, 12
_LEAST_INFORMATION = 1e-3


@dataclass(frozen=True)
class SoundField:
    """``log_power`` (n, b) of the cells, NaN where not ``heard``; ``variance`` (b,) of a cell of ``weight`` (n,) 1."""

    chainage_m: FloatArray
    speed_mps: FloatArray
    heard: BoolArray
    log_power: FloatArray
    weight: FloatArray
    variance: FloatArray


def sound_field(cells: Cells) -> SoundField:
    """Return the field of all bands but the chosen one.

    The variance comes from second differences over a metre, in which neither drift nor a leak counts for much:
    Var(x₋ − 2x₀ + x₊) = 6 Var(x).
    """
    log_power = cells.log_power[:, :-1]
    heard = cells.heard
    usual = float(np.median(cells.frames[heard]))
    share = cells.frames / max(usual, 1e-9)
    weight = np.where(heard, share * (1 + 1 / _WEIGHT_CAP) / (1 + share / _WEIGHT_CAP), 0.0)
    bent = log_power[2 * _LAG_CELLS :] - 2 * log_power[_LAG_CELLS:-_LAG_CELLS] + log_power[: -2 * _LAG_CELLS]
    variance = np.array([robust_sigma(column) ** 2 / 6 for column in bent.T])
    return SoundField(cells.chainage_m, cells.speed_mps, heard, log_power, weight, np.maximum(variance, 1e-6))


def flattened(field: SoundField, log_power: FloatArray, background_m: float) -> FloatArray:
    """Return (n, b) how far ``log_power`` stands above drift and speed; 0 where not heard.

    Rolling noise grows with the cube of speed, flow noise with the square, and they add: each band follows a polynomial
    in log speed, found robustly beside the running median, so that neither a slow stretch nor a leak bends it.
    """
    half = max(1, round(background_m / CELL_M))
    known = np.isfinite(log_power[:, 0]) & np.isfinite(field.speed_mps)
    out = np.zeros_like(log_power)
    if np.count_nonzero(known) < 8:
        return out
    log_speed = np.log(np.maximum(field.speed_mps, 0.05))
    log_speed = np.clip(log_speed - np.median(log_speed[known]), -_SPEED_RANGE, _SPEED_RANGE)
    terms = np.column_stack([log_speed**k for k in range(1, _SPEED_TERMS + 1)])
    moved = np.column_stack([t - running_median(np.where(known, t, np.nan), half) for t in terms.T])[known]
    normal = moved.T @ moved
    normal += 1e-5 * (np.trace(normal) / _SPEED_TERMS + len(moved) * 1e-4) * np.eye(_SPEED_TERMS)
    for column, level in enumerate(log_power.T):
        above = (level - running_median(level, half))[known]
        follows = np.zeros(_SPEED_TERMS)
        for _ in range(_ROUNDS):
            rest = above - moved @ follows
            rest -= np.median(rest)
            limit = _HUBER * robust_sigma(rest)
            follows += np.linalg.solve(normal, moved.T @ np.clip(rest, -limit, limit))
        steady = level - terms @ follows
        out[:, column] = steady - running_median(steady, half)
    return np.where(np.isfinite(out), out, 0.0)


def passing(distance_m: FloatArray, width_m: float) -> FloatArray:
    """Return 1/(1+(d/w)²), the rise and fall of a point source's power."""
    return np.asarray(1.0 / (1.0 + (distance_m / width_m) ** 2), np.float64)


def amplitudes(excess: FloatArray, weight: FloatArray, width_m: float) -> tuple[FloatArray, FloatArray]:
    """Return (n, b) the height of a shape of ``width_m`` at each cell, and (n,) its information.

    Weighted least squares of ``excess`` (n, b) on shape and a constant over ±6 half-widths; the height's variance is
    that of a cell of weight 1, over the information.
    """
    half = min(int(np.ceil(_REACH * width_m / CELL_M)), max(len(excess) - 1, 1))
    shape = passing(np.arange(-half, half + 1, dtype=np.float64) * CELL_M, width_m)
    ones = np.ones_like(shape)
    number = np.maximum(_correlated(weight, ones), 1e-9)
    first = _correlated(weight, shape)
    information = _correlated(weight, shape**2) - first**2 / number
    information = np.maximum(information, _LEAST_INFORMATION * max(float(np.median(information)), 1e-9))
    weighted = weight[:, None] * excess
    mean = (first / number)[:, None] * _correlated(weighted, ones)
    return (_correlated(weighted, shape) - mean) / information[:, None], information / OVERLAP


def _correlated(values: FloatArray, shape: FloatArray) -> FloatArray:
    """Return the sums of ``values`` (n,) or (n, b) under the symmetric ``shape`` laid about each place."""
    half = len(shape) // 2
    kernel = shape if values.ndim == 1 else shape[:, None]
    full = signal.oaconvolve(values, kernel, mode="full", axes=0)
    return np.asarray(full[half : half + len(values)], np.float64)
