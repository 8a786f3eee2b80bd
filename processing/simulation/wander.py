"""Slow random quantities (slip, spin, drifts): first-order Gauss–Markov knots joined by a smooth spline."""

from collections.abc import Callable

import numpy as np

from processing.survey import FloatArray

Wander = Callable[[FloatArray], FloatArray]


def constant(value: float) -> Wander:
    """Return a quantity that stays at ``value``."""
    return lambda t: np.full(len(t), value)


def gauss_markov(span: tuple[float, float], sigma: float, tau: float, rng: np.random.Generator) -> Wander:
    """Return a stationary process with standard deviation ``sigma`` and correlation ``exp(−|Δ|/tau)`` over ``span``.

    Knots stand ``tau``/5 apart; beyond the span the end values hold.
    """
    if sigma == 0.0:
        return constant(0.0)
    from scipy.interpolate import CubicSpline
    from scipy.signal import lfilter

    start, end = span
    knots = max(int(np.ceil((end - start) / (tau / 5))) + 1, 4)
    step = (end - start) / (knots - 1)
    keep = np.exp(-step / tau)
    draws = rng.normal(size=knots) * sigma
    draws[1:] *= np.sqrt(1 - keep**2)
    values = lfilter([1.0], [1.0, -keep], draws)
    spline = CubicSpline(np.linspace(start, end, knots), values, bc_type="natural")
    return lambda t: np.asarray(spline(np.clip(t, start, end)))
