"""Mahony's complementary filter (2008; P1), with six axes or, where the field is trusted, nine."""

import numpy as np

from processing.orientation import kernels
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_BIAS_LIMIT_RADPS = float(np.radians(2.0))  # what rest calibration leaves is smaller; more is wind-up


def mahony(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude by ``ω' = ω + Kp e + ∫Ki e``; readings count less where |a| is not g."""
    return run_recursion(samples, yaw_rad, progress, mahony_recursion(samples))


def mahony_recursion(samples: TrustedSamples) -> Recursion:
    """Return the filter for runs with these settings, calibration and field."""
    settings = samples.settings

    def begin(q_ws: FloatArray, state: FloatArray | None) -> FloatArray:
        return np.concatenate([q_ws, np.zeros(3) if state is None else state[4:]])

    def advance(block: Block, state: FloatArray, quat: FloatArray, bias: FloatArray) -> None:
        kernels.mahony(
            block.turn,
            block.dt_s,
            block.acc_g,
            block.acc_weight,
            block.mag,
            block.mag_weight,
            settings.mahony_kp_radps,
            settings.mahony_ki_radps2,
            settings.mahony_kp_mag_radps,
            _BIAS_LIMIT_RADPS,
            state,
            quat,
            bias,
        )

    return Recursion(begin, advance, estimates_bias=True)
