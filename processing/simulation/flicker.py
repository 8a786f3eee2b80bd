"""Bias instability: flicker noise as a sum of Gauss–Markov processes half a decade apart, by its Allan deviation.

A process of standard deviation σ and correlation time T has the Allan variance (IEEE Std 952-1997, annex C, integrated)
``2σ²T/τ [1 − T/2τ (3 − 4e^(−τ/T) + e^(−2τ/T))]``, which peaks at 0.618 σ; nine of them with equal σ are level within
6 % between five seconds and an hour.
"""

import numpy as np

from processing.survey import FloatArray

_TIMES_S = np.asarray(10.0 ** np.arange(0.0, 4.01, 0.5))
_LEVEL_S = np.geomspace(3.0, 1000.0, 40)


def allan_variance(tau_s: FloatArray, sigma: float, time_s: float) -> FloatArray:
    """Return the Allan variance (n,) at averaging times ``tau_s`` (n,) of one Gauss–Markov process."""
    x = np.asarray(tau_s) / time_s
    return np.asarray(2 * sigma**2 / x * (1 - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / (2 * x)))


def flicker_variance(tau_s: FloatArray, floor: float) -> FloatArray:
    """Return the Allan variance (n,) of :func:`flicker`."""
    of_one = sum((allan_variance(tau_s, 1.0, t) for t in _TIMES_S), start=np.zeros(len(tau_s)))
    return np.asarray(of_one * _sigma(floor) ** 2)


def flicker(count: int, rate_hz: float, floor: float, rng: np.random.Generator) -> FloatArray:
    """Return (count, 3) noise whose Allan deviation is ``floor`` (its unit) from five seconds to an hour, on each axis.

    It starts as it would after hours of running: the slow parts are an offset from the first sample on.
    """
    from scipy.signal import lfilter

    out = np.zeros((count, 3))
    for time_s in _TIMES_S:
        keep = np.exp(-1.0 / (rate_hz * time_s))
        draws = rng.normal(size=(count, 3))
        draws *= _sigma(floor) * np.sqrt(1 - keep**2)
        draws[0] /= np.sqrt(1 - keep**2)
        out += lfilter([1.0], [1.0, -keep], draws, axis=0)
    return out


def _sigma(floor: float) -> float:
    """The standard deviation of each process."""
    of_one = sum((allan_variance(_LEVEL_S, 1.0, t) for t in _TIMES_S), start=np.zeros(len(_LEVEL_S)))
    return float(floor / np.sqrt(np.mean(of_one)))
