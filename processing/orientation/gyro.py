"""The gyro alone: exact integration by the exponential map, no correction; drifts, but nothing disturbs it."""

import numpy as np

from processing.orientation import kernels
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray


def integrate_gyro(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude from the calibrated rates alone; tilt and heading are found at each segment's start."""
    return run_recursion(samples, yaw_rad, progress, gyro_recursion(samples))


def gyro_recursion(_samples: TrustedSamples) -> Recursion:
    """Return the integration of the gyro."""

    def advance(block: Block, state: FloatArray, quat: FloatArray, _bias: FloatArray) -> None:
        kernels.integrate(block.turn, state, quat)

    return Recursion(begin_anew, advance, estimates_bias=False)


def begin_anew(q_ws: FloatArray, _state: FloatArray | None) -> FloatArray:
    """Return the state of a recursion that knows only its attitude."""
    return np.array(q_ws)
