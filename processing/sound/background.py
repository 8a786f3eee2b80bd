"""The local background: a running median that neither a leak nor a bump can lift."""

import numpy as np
from scipy import ndimage

from processing.survey import BoolArray, FloatArray


def running_median(values: FloatArray, half: int) -> FloatArray:
    """Return the median (n,) of ``values`` (n,) within ±``half`` places, mirrored at the ends, in O(n log half).

    Where NaN stands nothing is known: it is bridged by a straight line before the median and NaN again after it.
    All NaN gives all NaN.
    """
    known = np.isfinite(values)
    if not known.any():
        return np.full(len(values), np.nan)
    half = max(0, min(half, len(values) - 1))
    median: FloatArray = ndimage.median_filter(bridged(values, known), 2 * half + 1, mode="reflect")
    return np.where(known, median, np.nan)


def bridged(values: FloatArray, known: BoolArray) -> FloatArray:
    """Return ``values`` with straight lines where not ``known``; the nearest known value beyond the ends."""
    if known.all():
        return values
    places = np.arange(len(values))
    return np.asarray(np.interp(places, places[known], values[known]), np.float64)


def robust_sigma(values: FloatArray) -> float:
    """Return 1.4826 times the median absolute deviation of the finite values: sigma, for a normal distribution."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 0.0
    return float(1.4826 * np.median(np.abs(finite - np.median(finite))))


def lower_sigma(values: FloatArray) -> float:
    """Return sigma from the finite values below the median: what stands out lies above and does not widen it."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 0.0
    low, middle = np.quantile(finite, (0.158655, 0.5))
    return float(middle - low)
