"""The adaptive Kalman filter: q and r estimated from the innovations over a window, wherever the noise changes."""

import numpy as np
from scipy.signal import lfilter

from processing.conditioning import kernels_conditioning as kernels
from processing.conditioning.channel import Conditioned, Readings, readings
from processing.conditioning.kalman import noise_figures, run_varying
from processing.conditioning.noise import Noise, channel_noise
from processing.conditioning.settings import ConditioningSettings
from processing.survey import BoolArray, FloatArray


def adaptive(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) with the variances that :func:`noise_over_time` finds around each row.

    ``figures`` hold the medians of both. The recordings are processed after the run, so the window looks both ways.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES.
    """
    data = readings(values, sample_rate_hz, valid)
    pilot = channel_noise(data, settings)
    q, r = noise_over_time(data, pilot, max(int(settings.window_s * sample_rate_hz), 3))
    mean, variance = run_varying(data, q, r, zero_phase=settings.phase == "zero")
    figures = noise_figures(Noise(float(np.median(q)), float(np.median(r))), sample_rate_hz)
    return Conditioned(mean, np.sqrt(variance), figures=figures)


def noise_over_time(data: Readings, pilot: Noise, window: int) -> tuple[FloatArray, FloatArray]:
    """Return q and r (n,), each from ``window`` rows around it, by the innovations of a pilot filter.

    A filter of constant gain K has innovations of variance ``C0 = P + r`` and lag-one covariance ``C1 = P − K·C0``,
    P being its true prediction variance, which obeys ``P = (1 − K)² P + K² r + q``: two covariances give q and r
    (R. K. Mehra, 1970, for this model). The rule ``q = K² C0``, ``r = C0 − P`` of innovation-based estimation
    (A. H. Mohamed, K. P. Schwarz 1999; P2 §3.4.2.2) has one equation for both and keeps a wrong ratio for ever.
    """
    gain = float(np.clip(pilot.gain, 1e-3, 0.999))
    innovation = _innovations(data, gain)
    rows, first = len(innovation), data.first
    one = data.valid.copy()
    one[first] = False  # the filter began there
    two = np.zeros(rows, dtype=np.bool_)
    two[1:] = one[1:] & one[:-1]
    product = np.zeros(rows)
    product[1:] = innovation[1:] * innovation[:-1]
    c0 = _window_mean(innovation**2, one, window)
    c1 = _window_mean(np.where(two, product, 0.0), two, window)
    predicted = np.clip(c1 + gain * c0, 0.0, 0.9999 * c0)
    r = c0 - predicted
    q = (1.0 - (1.0 - gain) ** 2) * predicted - gain**2 * r
    # c1 of a window is known to c0/√window only; a q no surer than that stays near the whole channel's
    doubt = ((1.0 - (1.0 - gain) ** 2) * c0) ** 2 / window
    off = q - pilot.q
    q = pilot.q + off * off**2 / (off**2 + doubt + np.finfo(float).tiny)
    floor = max(float(c0.max()), pilot.r) * 1e-12 + np.finfo(float).tiny
    return np.maximum(q, 0.1 * pilot.q + floor), np.maximum(r, floor)


def _innovations(data: Readings, gain: float) -> FloatArray:
    if data.complete:
        start = np.array([-data.values[0]])
        return np.asarray(lfilter([1.0, -1.0], [1.0, gain - 1.0], data.values, zi=start)[0], dtype=np.float64)
    out = np.zeros(len(data.values))
    kernels.innovations(data.values[data.first :], data.valid[data.first :].view(np.uint8), gain, out[data.first :])
    return out


def _window_mean(terms: FloatArray, counted: BoolArray, window: int) -> FloatArray:
    """Mean of the counted terms within ``window`` rows around each row; at the ends and in holes the nearest one."""
    rows = len(terms)
    window = min(window, rows)
    start = np.clip(np.arange(rows) - window // 2, 0, rows - window)
    count = np.concatenate([[0], np.cumsum(counted)])
    total = np.concatenate([[0.0], np.cumsum(np.where(counted, terms, 0.0))])
    inside = count[start + window] - count[start]
    enough = inside >= max(min(window // 2, int(count[-1])), 1)
    if not enough.any():
        return np.full(rows, total[-1] / max(int(count[-1]), 1))
    mean = (total[start + window] - total[start]) / np.maximum(inside, 1)
    known = np.flatnonzero(enough)
    return np.asarray(np.interp(np.arange(rows), known, mean[known]), dtype=np.float64)
