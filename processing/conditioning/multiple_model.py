"""Multiple-model estimation: a bank of filters runs side by side, and the readings say how probable each model is."""

from collections.abc import Sequence

import numpy as np

from processing.conditioning import kernels_conditioning as kernels
from processing.conditioning.channel import Conditioned, Readings, readings
from processing.conditioning.kalman import noise_figures, run_varying
from processing.conditioning.noise import Noise, channel_noise
from processing.conditioning.settings import ConditioningSettings
from processing.conditioning.state_space import StateEstimates
from processing.survey import BoolArray, FloatArray

Probabilities = np.ndarray[tuple[int, int], np.dtype[np.float32]]
_STEPS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])


def multiple_model(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) by five models, from a calm to a restless true value, weighed row by row.

    The bank is centred on the channel's own noise. With ``phase`` zero the smoother runs with the variances averaged
    by the probabilities. ``probabilities`` (n, 5), calmest first.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES.
    """
    data = readings(values, sample_rate_hz, valid)
    centre = channel_noise(data, settings)
    models = [Noise(centre.q * float(settings.bank_span**step), centre.r) for step in _STEPS]
    switch = min(1.0 / (settings.dwell_s * sample_rate_hz), 0.5)
    mean, variance, probabilities = run_bank(data, models, switch)
    if settings.phase == "zero":
        q = probabilities @ np.array([model.q for model in models])
        mean, variance = run_varying(data, q, np.array([centre.r]), zero_phase=True)
    figures = noise_figures(centre, sample_rate_hz) | {"likeliest_model": float(probabilities.mean(axis=0).argmax())}
    return Conditioned(mean, np.sqrt(variance), probabilities, figures)


def run_bank(data: Readings, models: Sequence[Noise], switch: float) -> tuple[FloatArray, FloatArray, Probabilities]:
    """Return the mixed means and variances (n,) of ``models`` and their probabilities (n, m), all alike at the start.

    By Bayes' rule from the likelihood of each innovation (D. T. Magill 1965; P2 §3.4.2.2, MMAE). ``switch`` is the
    probability that between two rows another model takes over; 0 is for a model that holds throughout.
    """
    rows, first, count = len(data.values), data.first, len(models)
    mean, variance = np.empty(rows), np.empty(rows)
    probabilities = np.full((rows, count), 1.0 / count, dtype=np.float32)
    state = np.zeros((4, count))
    state[2] = 1.0 / count
    q, r = np.array([model.q for model in models]), np.array([model.r for model in models])
    kernels.bank(
        data.values[first:],
        data.valid[first:].view(np.uint8),
        q,
        r,
        switch,
        state,
        mean[first:],
        variance[first:],
        probabilities[first:],
    )
    mean[:first] = mean[first]
    variance[:first] = variance[first] + float(q.mean()) * np.arange(first, 0, -1)
    return mean, variance, probabilities


def weigh_models(estimates: Sequence[StateEstimates], switch: float = 0.0) -> FloatArray:
    """Return the probability (n, m) of each of m models after each row, from the filters' likelihoods."""
    log_likelihood = np.ascontiguousarray(np.stack([each.log_likelihood for each in estimates], axis=1))
    probability = np.empty_like(log_likelihood)
    kernels.weigh(log_likelihood, switch, probability)
    return probability


def mix(estimates: Sequence[StateEstimates], probability: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean (n, d) and covariance (n, d, d) of models that share a state, weighed by ``probability`` (n, m)."""
    means = np.stack([each.mean for each in estimates], axis=1)
    covariances = np.stack([each.covariance for each in estimates], axis=1)
    mean = np.einsum("km,kmi->ki", probability, means)
    off = means - mean[:, None, :]
    covariances = covariances + off[..., :, None] * off[..., None, :]
    return mean, np.einsum("km,kmij->kij", probability, covariances)
