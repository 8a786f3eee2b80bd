"""A step from 0 to 1 with three vanishing derivatives at both ends, its derivatives and its integral: closed forms."""

import numpy as np

from processing.survey import FloatArray


def step(u: FloatArray) -> FloatArray:
    """Rise from 0 to 1 over ``u`` (n,) in 0..1, with three vanishing derivatives at both ends."""
    return np.asarray(u**4 * (35 - 84 * u + 70 * u**2 - 20 * u**3))


def step_d1(u: FloatArray) -> FloatArray:
    """Return the first derivative of :func:`step`."""
    return np.asarray(140 * (u * (1 - u)) ** 3)


def step_d2(u: FloatArray) -> FloatArray:
    """Return the second derivative of :func:`step`."""
    return np.asarray(420 * (u * (1 - u)) ** 2 * (1 - 2 * u))


def step_integral(u: FloatArray) -> FloatArray:
    """Return the integral of :func:`step` from 0; ½ at 1."""
    return np.asarray(u**5 * (7 - 14 * u + 10 * u**2 - 2.5 * u**3))


def ramped(u: FloatArray, ramp: float) -> FloatArray:
    """Return the way from 0 to 1 over ``u`` in 0..1: speed rises over a share ``ramp`` (< ½), holds, falls likewise."""
    top = 1.0 / (1.0 - ramp)
    rising = ramp * step_integral(np.clip(u / ramp, 0.0, 1.0))
    falling = ramp * (0.5 - step_integral(np.clip((1.0 - u) / ramp, 0.0, 1.0)))
    middle = np.clip(u, ramp, 1.0 - ramp) - ramp
    return np.asarray(top * (rising + middle + falling))
