"""Rebuilds the even clock of a sensor from the uneven stamps that a host gave to its packets, real gaps left in.

A host that reads a device through USB or Bluetooth stamps a whole packet at once: steps of 0.04 ms, then one of 72 ms,
at a true 250 Hz. Stamps are late, never early, so sample i lies at ``t_i − delay``; over many samples the line through
the stamps gives the true period. Where samples were lost the stamps step away from that line and stay away.
"""

import itertools

import numpy as np

from processing.importing.raw import RawImu
from processing.importing.time_stamps import sampled_steps
from processing.settings import ImportSettings
from processing.survey import FloatArray

_LAG = 500
_WINDOW_S = 1.0
_MIN_ROWS = 200


def long_period(time: FloatArray) -> float:
    """Return the period (s) over many samples of (n,) sorted times, which bursts do not touch: the median over lags."""
    lag = min(_LAG, max(len(time) // 4, 1))
    return float(np.median(sampled_steps(time, lag)) / lag)


def is_bursty(time: FloatArray) -> bool:
    """True where the steps of (n,) sorted times say little about the true period: packets stamped together."""
    if len(time) < _MIN_ROWS:
        return False
    period = long_period(time)
    steps = sampled_steps(time)
    if not period > 0:
        return False
    uneven = np.mean((steps < 0.3 * period) | (steps > 2.5 * period))
    return bool(np.median(steps) < 0.5 * period or uneven > 0.4)


def rebuild(raw: RawImu, settings: ImportSettings) -> tuple[float, float]:
    """Replace ``raw.time`` by an even clock; returns the rate found (Hz) and the old median step (s)."""
    time = raw.time
    median_step = float(np.median(np.diff(time)))
    index = _even_index(raw)
    lag = min(_LAG, max(len(time) // 4, 1))
    spans = index[lag:] - index[:-lag]
    period = float(np.median((time[lag:] - time[:-lag])[spans > 0] / spans[spans > 0]))
    edges = np.empty(0, dtype=np.intp)
    if raw.counter is None:
        edges = _real_gaps(time, time - period * index, period, settings)
    bounds = [0, *(edges + 1).tolist(), len(time)]
    period = _common_slope(index, time, bounds)
    delay = time - period * index
    for start, end in itertools.pairwise(bounds):
        smooth = _running_mean(delay[start:end], max(round(10.0 / period), 1))
        time[start:end] = period * index[start:end] + smooth
    return 1.0 / period, median_step


def _common_slope(index: FloatArray, time: FloatArray, bounds: list[int]) -> float:
    """The one period that fits all pieces between gaps best: a lag that is no multiple of the packets is biased."""
    products = squares = 0.0
    for start, end in itertools.pairwise(bounds):
        centred = index[start:end] - index[start:end].mean()
        products += float(np.dot(centred, time[start:end] - time[start:end].mean()))
        squares += float(np.dot(centred, centred))
    return products / squares


def _even_index(raw: RawImu) -> FloatArray:
    """The number of each sample on the sensor's own clock: its counter where that is sound, else its row."""
    if raw.counter is not None and len(raw.counter) > 1:
        steps = np.diff(raw.counter)
        if np.isfinite(steps).all() and np.all(steps >= 1) and np.median(steps) < 1e6:
            return np.asarray((raw.counter - raw.counter[0]) / max(float(np.median(steps)), 1.0))
    raw.counter = None
    return np.arange(len(raw.time), dtype=np.float64)


def _real_gaps(time: FloatArray, delay: FloatArray, period: float, settings: ImportSettings) -> np.ndarray:
    """Rows after which the stamps step away from the line for good: the least delay before and after differ."""
    from scipy.ndimage import minimum_filter1d

    steps = np.diff(time)
    burst = float(np.percentile(steps, 99.0))
    candidates = np.nonzero(steps > max(settings.gap_factor * period, 1.5 * burst))[0]
    if not len(candidates):
        return candidates
    window = min(max(round(_WINDOW_S / period), 4), len(delay))
    least = minimum_filter1d(delay, window, mode="nearest")
    before = least[np.maximum(candidates - window // 2, 0)]
    after = least[np.minimum(candidates + 1 + window // 2, len(delay) - 1)]
    return candidates[after - before > max(settings.gap_factor * period, 0.5 * burst)]


def _running_mean(values: FloatArray, window: int) -> FloatArray:
    """The mean over ``window`` samples, near the ends over those that are there."""
    if len(values) <= window:
        return np.full(len(values), float(values.mean()) if len(values) else 0.0)
    origin = float(values[0])
    sums = np.concatenate([[0.0], np.cumsum(values - origin)])
    at = np.arange(len(values))
    first, end = np.maximum(at - window // 2, 0), np.minimum(at + window // 2 + 1, len(values))
    return np.asarray((sums[end] - sums[first]) / (end - first) + origin, dtype=np.float64)
