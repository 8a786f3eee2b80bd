"""A straight line through points of which some lie anywhere, with an offset of its own for each block of them."""

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter

from processing.survey import BoolArray, FloatArray

Whole = npt.NDArray[np.int64]
_FEW = 8  # windows; below it a slope through pairs is only noise
_ROUNDS = 6
_FAR = 3.5  # robust standard deviations
_MOST_WANDER_S = 0.05  # that a clock leaves its line by
_NEIGHBOURS = 9  # windows
_LEAST_SCATTER_S = 2e-5  # what a host can time at best


def robust_line(x: FloatArray, y: FloatArray, which: Whole, prior: float) -> tuple[float, FloatArray, BoolArray, float]:
    """Return slope, an offset for each block, which points (n,) are near the line, and their standard deviation.

    The first slope is the median of those between points half a block apart (Theil 1950, by incomplete pairs, which
    lets a quarter of the points be anything), the last the least squares of what is near, held by ``prior``. Near is
    what lies with its neighbours, if these are not far off either: a clock that wanders with its temperature leaves
    the line by many times its scatter, and all of it counts.
    """
    blocks = int(which.max()) + 1
    slope = _first_slope(x, y, which, blocks)
    offsets = np.array([np.median((y - slope * x)[which == block]) for block in range(blocks)])
    near, scatter = np.ones(len(x), np.bool_), _LEAST_SCATTER_S
    for _ in range(_ROUNDS):
        residual = y - slope * x - offsets[which]
        beside = residual - _course(residual, which, blocks)
        near = (np.abs(residual) <= _MOST_WANDER_S) & (np.abs(beside) <= _FAR * _spread(beside))
        near |= np.abs(residual) <= max(_FAR * _spread(residual), _FAR * _LEAST_SCATTER_S)
        counts = np.bincount(which, near)
        mean_x = np.bincount(which, x * near) / np.maximum(counts, 1)
        mean_y = np.bincount(which, y * near) / np.maximum(counts, 1)
        dx, dy = (x - mean_x[which])[near], (y - mean_y[which])[near]
        freedom = max(len(dx) - blocks - 1, 1)
        scatter = max(float(np.sqrt(np.sum((dy - slope * dx) ** 2) / freedom)), _LEAST_SCATTER_S)
        slope = float(dx @ dy / (dx @ dx + (scatter / prior) ** 2))
        offsets = np.where(counts > 0, mean_y - slope * mean_x, offsets)
    return slope, offsets, near, scatter


def _course(residual: FloatArray, which: Whole, blocks: int) -> FloatArray:
    """Return the running median of each block, the median of all where a block is short."""
    course = np.zeros(len(residual))
    for block in range(blocks):
        mine = which == block
        part = residual[mine]
        course[mine] = median_filter(part, _NEIGHBOURS, mode="reflect") if len(part) > _NEIGHBOURS else np.median(part)
    return course


def _spread(values: FloatArray) -> float:
    """Return the standard deviation by the median of the absolute values."""
    return 1.4826 * float(np.median(np.abs(values))) if len(values) else 0.0


def _first_slope(x: FloatArray, y: FloatArray, which: Whole, blocks: int) -> float:
    slopes = []
    for block in range(blocks):
        mine = np.flatnonzero(which == block)
        if len(mine) >= _FEW:
            half = len(mine) // 2
            slopes.append((y[mine[half:]] - y[mine[:-half]]) / (x[mine[half:]] - x[mine[:-half]]))
    return float(np.median(np.concatenate(slopes))) if slopes else 0.0
