"""The unscented filter USQUE over attitude and gyro bias, with the readings and the noises of :mod:`ekf7`.

J. L. Crassidis, F. L. Markley, JGCD 26 (2003) 536–542. It carries points instead of derivatives through the turn, so it
forgives a first attitude that is far off; near the truth it is the extended filter.
"""

import numpy as np

from processing.orientation import kernels_ukf
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_START_SIGMA_RAD = np.radians(3.0)  # tilt and heading from a few seconds of readings


def ukf(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude and what bias remained after the calibration."""
    return run_recursion(samples, yaw_rad, progress, ukf_recursion(samples))


def ukf_recursion(samples: TrustedSamples) -> Recursion:
    """Return the filter for runs with these settings, calibration and field."""
    settings, scratch = samples.settings, np.empty(kernels_ukf.SCRATCH_SIZE)
    first_sigma = samples.calibration.sigma_at(samples.times(0, 1))[0]

    def begin(q_ws: FloatArray, state: FloatArray | None) -> FloatArray:
        bias = np.zeros(3) if state is None else state[4:7]
        bias_covariance = np.diag(first_sigma**2) if state is None else state[7:].reshape(6, 6)[3:, 3:]
        return start_state(q_ws, bias, bias_covariance)

    def advance(block: Block, state: FloatArray, quat: FloatArray, bias: FloatArray) -> None:
        kernels_ukf.ukf(
            block.turn,
            block.dt_s,
            block.acc_g,
            block.acc_weight,
            block.mag,
            block.mag_weight,
            np.radians(settings.ekf_gyr_noise_dps_rthz),
            np.radians(settings.ekf_bias_walk_dps_rts),
            settings.ekf_acc_noise_g_rthz,
            np.radians(settings.ekf_heading_noise_deg_rthz),
            state,
            scratch,
            quat,
            bias,
        )

    return Recursion(begin, advance, estimates_bias=True)


def start_state(q_ws: FloatArray, bias_radps: FloatArray, bias_covariance: FloatArray) -> FloatArray:
    """Return the filter's state (43,): an attitude (4,) ± 3° about every axis, and a known bias."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = _START_SIGMA_RAD**2 * np.eye(3)
    covariance[3:, 3:] = bias_covariance
    return np.concatenate([q_ws, bias_radps, covariance.ravel()])
