"""The gyro alone: exact integration by the exponential map, no correction; drifts, but nothing disturbs it."""

import numpy as np

from processing.orientation import kernels
from processing.orientation.recursion import Estimate, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray


def integrate_gyro(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude from the calibrated rates alone; tilt and heading are found at each segment's start."""

    def advance(block: Block, state: FloatArray, quat: FloatArray, _bias: FloatArray) -> None:
        kernels.integrate(block.turn, state, quat)

    return run_recursion(samples, yaw_rad, progress, begin=begin_anew, advance=advance, estimates_bias=False)


def begin_anew(q_ws: FloatArray, _state: FloatArray | None) -> FloatArray:
    """Return the state of a recursion that knows only its attitude."""
    return np.array(q_ws)
