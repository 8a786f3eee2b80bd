"""The height along the run: a chain of its own, from slope, tie points that tell a height, and pressure."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from processing.position.chain import Chain, Readings, smooth
from processing.position.evidence import HeightSeries
from processing.position.keyframes import Keyframes
from processing.position.ties import Observation
from processing.survey import FloatArray

_SLOPE_M = 10.0  # half of what a slope is taken over: pressure's noise is no slope
_MISFIT = 4.0
_ROUNDS = 3


@dataclass(frozen=True)
class Heights:
    """Height and its variance at the keyframes (k,), and the cosine of the slope of each step (k − 1,)."""

    up_m: FloatArray
    variance_m2: FloatArray
    shorter: FloatArray


def find_heights(
    frames: Keyframes, ties: Sequence[Observation], series: Sequence[HeightSeries], slope_sigma: float, start_m: float
) -> Heights:
    """Return the height given all that tells of it; readings that all the rest contradicts lose their weight."""
    chain = _chain(frames, series, slope_sigma, start_m)
    size = len(chain.prior_mean)
    told = [_of_ties(ties, size), *(_of_series(frames, heights, k, size) for k, heights in enumerate(series))]
    node = np.concatenate([t.node for t in told])
    order = np.argsort(node, kind="stable")
    given = Readings(
        node[order],
        np.vstack([t.row for t in told])[order],
        np.concatenate([t.value for t in told])[order],
        np.concatenate([t.variance for t in told])[order],
    )
    found = smooth(chain, given)
    for _ in range(_ROUNDS if series else 0):
        # Baarda: a reading that the rest misses by more than its due gets the variance that makes it fit
        excess = found.pull**2 / found.weight / _MISFIT**2
        if not np.any(excess > 1.0):
            break
        grown = given.variance + np.where(excess > 1.0, (excess - 1.0) / found.weight, 0.0)
        given = Readings(given.node, given.row, given.value, grown)
        found = smooth(chain, given)
    up = found.mean[:, 0]
    return Heights(up, np.maximum(found.cov[:, 0, 0], 1e-6), _shorter(frames, up))


def _chain(frames: Keyframes, series: Sequence[HeightSeries], slope_sigma: float, start_m: float) -> Chain:
    """Unknowns: height, slope, and per series its wandering error, its offset, and its slope along the way."""
    count, size = len(frames.rows) - 1, 2 + 3 * len(series)
    step = np.tile(np.eye(size), (count, 1, 1))
    step[:, 0, 1] = frames.way_m
    shift, noise = np.zeros((count, size)), np.zeros((count, size, size))
    shift[:, 0] = np.diff(frames.odometry.position_w_m[:, 2])
    noise[:, 0, 0] = np.diff(frames.odometry.up_var_m2)
    mean, cov = np.zeros(size), np.zeros((size, size))
    mean[0] = frames.odometry.position_w_m[0, 2]
    cov[0, 0], cov[1, 1] = start_m**2, slope_sigma**2
    for k, heights in enumerate(series):
        wander, offset, gradient = 2 + 3 * k, 3 + 3 * k, 4 + 3 * k
        a = frames.step_s / heights.correlation_s
        step[:, wander, wander] = np.exp(-a)
        noise[:, wander, wander] = heights.wander_sigma_m**2 * -np.expm1(-2.0 * a)
        cov[wander, wander], cov[offset, offset] = heights.wander_sigma_m**2, heights.offset_sigma_m**2
        cov[gradient, gradient] = heights.gradient_sigma**2
    return Chain(step, shift, noise, mean, cov)


def _of_ties(ties: Sequence[Observation], size: int) -> Readings:
    told = [t for t in ties if len(t.value) == 3]
    row = np.zeros((len(told), size))
    row[:, 0] = 1.0
    node = np.array([t.row for t in told], dtype=np.intp)
    value, variance = (
        np.array([float(v) for v in values])
        for values in ([t.value[2] for t in told], [t.covariance_m2[2, 2] for t in told])
    )
    return Readings(node, row, value, variance)


def _of_series(frames: Keyframes, heights: HeightSeries, number: int, size: int) -> Readings:
    """One reading a keyframe: the mean of what lies nearest to it."""
    time_s = frames.odometry.time_s
    inside = (heights.time_s >= time_s[0]) & (heights.time_s <= time_s[-1])
    middle = 0.5 * (time_s[1:] + time_s[:-1])
    cell = np.searchsorted(middle, heights.time_s[inside])
    count = np.bincount(cell, minlength=len(time_s))
    told = np.flatnonzero(count)
    mean = np.bincount(cell, heights.up_m[inside], len(time_s))[told] / count[told]
    row = np.zeros((len(told), size))
    row[:, 0] = row[:, 2 + 3 * number] = row[:, 3 + 3 * number] = 1.0
    row[:, 4 + 3 * number] = frames.odometry.chainage_m[told]
    return Readings(told, row, mean, heights.sigma_m**2 / count[told])


def _shorter(frames: Keyframes, up: FloatArray) -> FloatArray:
    if frames.odometry.follows_slope:
        return np.ones(len(up) - 1)
    distinct, first = np.unique(frames.odometry.chainage_m, return_index=True)
    if len(distinct) < 2:
        return np.ones(len(up) - 1)
    middle = 0.5 * (frames.odometry.chainage_m[1:] + frames.odometry.chainage_m[:-1])
    low, high = np.maximum(middle - _SLOPE_M, distinct[0]), np.minimum(middle + _SLOPE_M, distinct[-1])
    rise = np.interp(high, distinct, up[first]) - np.interp(low, distinct, up[first])
    slope = rise / np.maximum(high - low, 1e-6)
    return np.asarray(np.sqrt(1.0 - np.clip(slope, -0.9, 0.9) ** 2))
