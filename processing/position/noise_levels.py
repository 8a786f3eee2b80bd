"""How slippery this run was, and how much its gyro wandered: the noise of the model, weighed by the run itself.

Runs differ: on real wheels the slip walk is log-normal, 0.084 m/√m in the median and twice that in the worst tenth
(navigation §4.4). So a level of noise is a factor on the model's standard deviations with a log-normal prior, and the
likelihood of all that is known (ties above all) tells which levels remain. Few ties leave many: the path's error is
then a mixture of normal ones, with longer tails than any single one, as a t distribution has for few readings.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from processing.position.motion_model import Levels
from processing.survey import FloatArray

SLIP_FACTORS = np.array([0.3, 0.45, 0.67, 1.0, 1.5, 2.25, 3.4, 5.0])
HEADING_FACTORS = np.array([0.06, 0.12, 0.25, 0.5, 1.0, 2.0, 4.0])
SLIP_MEDIAN = 0.78
SLIP_SPREAD = 0.555  # sigma of the logarithm (navigation §4.4: 0.171 / 0.084 at the 90th percentile)
_HEADING_MEDIAN = 0.5
_HEADING_SPREAD = 1.0
_STRATA = np.array([0.0, 0.1, 0.35, 0.65, 0.9, 1.0])
_ONE_LEVEL = 1.15
_NEWTON_TURNS = 4
_Q95 = 1.959964


@dataclass(frozen=True)
class Weighed:
    """A level of noise with its probability."""

    weight: float
    levels: Levels


def weigh(likelihood: Callable[[Levels], float]) -> tuple[Weighed, ...]:
    """Return a few levels that stand for what the log-likelihood leaves of the prior."""
    slip = _posterior(SLIP_FACTORS, SLIP_MEDIAN, SLIP_SPREAD, lambda f: likelihood(Levels(slip=f**2)))
    best = float(SLIP_FACTORS[np.argmax(slip)]) ** 2
    heading = _posterior(HEADING_FACTORS, _HEADING_MEDIAN, _HEADING_SPREAD, lambda f: likelihood(Levels(best, f**2)))
    slips, headings = _strata(SLIP_FACTORS, slip), _strata(HEADING_FACTORS, heading)
    if max(slips) < _ONE_LEVEL * min(slips) and max(headings) < _ONE_LEVEL * min(headings):
        return (Weighed(1.0, Levels(float(np.mean(slips)), float(np.mean(headings)))),)
    # both have the same strata; laid across each other, so that neither goes with the other
    return tuple(
        Weighed(float(share), Levels(s, h)) for share, s, h in zip(np.diff(_STRATA), slips, reversed(headings))
    )


def log_prior(levels: Levels) -> float:
    """Return the log of the prior density of a level, without its constant."""
    slip = np.log(np.sqrt(levels.slip) / SLIP_MEDIAN) / SLIP_SPREAD
    heading = np.log(np.sqrt(levels.heading) / _HEADING_MEDIAN) / _HEADING_SPREAD
    return float(-0.5 * (slip**2 + heading**2))


def mean_levels(weighed: Sequence[Weighed]) -> Levels:
    """Return the one level that lies amid all (geometric mean)."""
    slip, heading = (
        float(np.exp(sum(w.weight * np.log(value) for w, value in zip(weighed, values))))
        for values in ([w.levels.slip for w in weighed], [w.levels.heading for w in weighed])
    )
    return Levels(slip, heading)


def mixed_sigma(weights: FloatArray, off_m: FloatArray, variance_m2: FloatArray) -> FloatArray:
    """Return the sigma (k,) of which ±1.96 hold 95 % of a mixture of normal errors, by Newton's method.

    ``off_m`` (j, k) are the j parts' means off the overall one, ``variance_m2`` (j, k) their variances.
    """
    from scipy.special import ndtr

    total = np.sqrt(np.einsum("j,jk->k", weights, variance_m2 + off_m**2))
    if len(weights) == 1:
        return np.asarray(total)
    sigma = np.sqrt(variance_m2)
    reach = _Q95 * total
    for _ in range(_NEWTON_TURNS):
        high, low = (reach - off_m) / sigma, (-reach - off_m) / sigma
        held = np.einsum("j,jk->k", weights, ndtr(high) - ndtr(low))
        density = (np.exp(-0.5 * high**2) + np.exp(-0.5 * low**2)) / (sigma * np.sqrt(2.0 * np.pi))
        step = (held - 0.95) / np.maximum(np.einsum("j,jk->k", weights, density), 1e-12)
        reach = np.clip(reach - step, 0.7 * reach, 1.4 * reach)
    return np.asarray(reach / _Q95)


def _posterior(factors: FloatArray, median: float, spread: float, likelihood: Callable[[float], float]) -> FloatArray:
    score = np.array([likelihood(float(f)) for f in factors]) - 0.5 * (np.log(factors / median) / spread) ** 2
    weight = np.exp(score - score.max())
    return np.asarray(weight / weight.sum())


def _strata(factors: FloatArray, weight: FloatArray) -> list[float]:
    """Mean variance factor within each share of the probability: log-linear between the factors of the table."""
    edge = np.concatenate([[0.0], np.cumsum(weight)])
    log = np.log(factors)
    half = 0.5 * np.diff(log)
    bounds = np.concatenate([[log[0] - half[0]], log[:-1] + half, [log[-1] + half[-1]]])
    fine = np.interp(np.linspace(0.0, 1.0, 401), edge, bounds)
    middle = np.exp(fine[1:] + fine[:-1])  # the variance factor is the square
    at = (np.arange(400) + 0.5) / 400.0
    return [float(np.mean(middle[(at > low) & (at < high)])) for low, high in pairwise(_STRATA)]
