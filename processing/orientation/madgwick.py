"""Madgwick's gradient-descent filter (2011; P1, P3), with six axes or, where the field is trusted, nine."""

import numpy as np

from processing.orientation import kernels
from processing.orientation.gyro import begin_anew
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray


def madgwick(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude by ``q̇ = ½ q ⊗ ω − β ∇f/‖∇f‖``; readings count less where |a| is not g."""
    return run_recursion(samples, yaw_rad, progress, madgwick_recursion(samples))


def madgwick_recursion(samples: TrustedSamples) -> Recursion:
    """Return the filter for runs with these settings, calibration and field."""
    beta, scratch = samples.settings.madgwick_beta_radps, np.empty(8)

    def advance(block: Block, state: FloatArray, quat: FloatArray, _bias: FloatArray) -> None:
        kernels.madgwick(
            block.turn,
            block.dt_s,
            block.acc_g,
            block.acc_weight,
            block.mag,
            block.mag_weight,
            beta,
            state,
            scratch,
            quat,
        )

    return Recursion(begin_anew, advance, estimates_bias=False)
