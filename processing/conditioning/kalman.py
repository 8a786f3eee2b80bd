"""The scalar Kalman filter of a channel, forwards as a live filter, or smoothed backwards so that nothing lags."""

import numpy as np
from scipy.signal import lfilter

from processing.conditioning import kernels_conditioning as kernels
from processing.conditioning.channel import Conditioned, Readings, readings
from processing.conditioning.noise import Noise, channel_noise
from processing.conditioning.settings import ConditioningSettings
from processing.survey import BoolArray, FloatArray


def kalman(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) as a random walk read with noise (P2, eq. 3.7–3.11 with A = H = 1, no input).

    An invalid row is predicted: the value stays, sigma grows. Before the first valid row its value is held likewise.
    With ``phase`` zero the Rauch–Tung–Striebel smoother follows.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES.
    """
    data = readings(values, sample_rate_hz, valid)
    noise = channel_noise(data, settings)
    mean, variance = run(data, noise, zero_phase=settings.phase == "zero")
    return Conditioned(mean, np.sqrt(variance), figures=noise_figures(noise, sample_rate_hz))


def noise_figures(noise: Noise, sample_rate_hz: float) -> dict[str, float]:
    """Return what a noise model says, in the units of the settings."""
    return {"noise_sigma": float(np.sqrt(noise.r)), "wander_sigma": float(np.sqrt(noise.q * sample_rate_hz))}


def run(data: Readings, noise: Noise, *, zero_phase: bool) -> tuple[FloatArray, FloatArray]:
    """Return means and variances (n,) for constant variances."""
    q, r = np.array([noise.q]), np.array([noise.r])
    if data.complete:
        mean, variance = _complete(data.values, noise, q, r)
        if zero_phase:
            kernels.smooth(q, mean, variance)
        return mean, variance
    return run_varying(data, q, r, zero_phase=zero_phase)


def run_varying(data: Readings, q: FloatArray, r: FloatArray, *, zero_phase: bool) -> tuple[FloatArray, FloatArray]:
    """Return means and variances (n,); ``q`` and ``r`` hold one value or n, ``q[k]`` acts between rows k − 1 and k."""
    rows, first = len(data.values), data.first
    mean, variance = np.empty(rows), np.empty(rows)
    q_on, r_on = (each if len(each) == 1 else np.ascontiguousarray(each[first:]) for each in (q, r))
    kernels.kalman(data.values[first:], data.valid[first:].view(np.uint8), q_on, r_on, mean[first:], variance[first:])
    if zero_phase:
        kernels.smooth(q_on, mean[first:], variance[first:])
    mean[:first] = mean[first]
    steps = np.broadcast_to(q, (rows,))[1 : first + 1]
    variance[:first] = variance[first] + np.cumsum(steps[::-1])[::-1]
    return mean, variance


def _complete(values: FloatArray, noise: Noise, q: FloatArray, r: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Without holes the gain settles, and from there on the filter is one pass of constant coefficients."""
    rows, gain = len(values), noise.gain
    # the gain nears its limit as (1 − K)^2k; 18 time constants leave 1e-16 of the difference
    head = rows if gain < 1e-6 else min(rows, int(np.ceil(18.0 / gain)) + 1)
    mean, variance = np.empty(rows), np.empty(rows)
    kernels.kalman(values[:head], np.ones(head, dtype=np.uint8), q, r, mean[:head], variance[:head])
    if head < rows:
        keep = 1.0 - gain
        mean[head:], _ = lfilter([gain], [1.0, -keep], values[head:], zi=np.array([keep * mean[head - 1]]))
        variance[head:] = noise.filtered
    return mean, variance
