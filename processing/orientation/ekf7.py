"""P0's extended Kalman filter over quaternion and gyro bias: accelerometer vector and tilt-compensated heading.

Beyond the paper: it starts from the resting accelerometer, integrates by the exponential map, keeps its covariance
consistent with the unit norm, and doubts the accelerometer where |a| is not g (a fixed noise is not competitive under
acceleration: navigation §3, note c).
"""

import numpy as np

from processing.orientation import kernels_ekf7
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_START_SIGMA_RAD = np.radians(3.0)  # tilt and heading from a few seconds of readings


def ekf7(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude and what bias remained after the calibration."""
    return run_recursion(samples, yaw_rad, progress, ekf7_recursion(samples))


def ekf7_recursion(samples: TrustedSamples) -> Recursion:
    """Return the filter for runs with these settings, calibration and field."""
    settings, scratch = samples.settings, np.empty(kernels_ekf7.SCRATCH_SIZE)
    first_sigma = samples.calibration.sigma_at(samples.times(0, 1))[0]

    def begin(q_ws: FloatArray, state: FloatArray | None) -> FloatArray:
        bias = np.zeros(3) if state is None else state[4:7]
        bias_covariance = np.diag(first_sigma**2) if state is None else state[7:].reshape(7, 7)[4:, 4:]
        return start_state(q_ws, bias, bias_covariance)

    def advance(block: Block, state: FloatArray, quat: FloatArray, bias: FloatArray) -> None:
        kernels_ekf7.ekf7(
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
    """Return the filter's state (56,): an attitude ± 3° about every axis, none of it along q, and a known bias."""
    covariance = np.zeros((7, 7))
    covariance[:4, :4] = 0.25 * _START_SIGMA_RAD**2 * (np.eye(4) - np.outer(q_ws, q_ws))
    covariance[4:, 4:] = bias_covariance
    return np.concatenate([q_ws, bias_radps, covariance.ravel()])
