"""P3's quaternion Kalman filter: what it observes is a step of gradient descent towards gravity and the field.

As published the step begins at the attitude before the turn, so the observation lags by the turn about the vertical,
which gravity cannot see: with six axes every turn about up is held back. By default it therefore begins at the
predicted attitude, and never goes beyond the minimum; ``ekf_gd_form`` chooses.
"""

import numpy as np

from processing.orientation import kernels_ekf_gd
from processing.orientation.calibration import Calibration
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_START_SIGMA_RAD = np.radians(3.0)  # tilt and heading from a few seconds of readings
_LEAST_RADPS_RTHZ = np.radians(0.001)  # no consumer MEMS is quieter: what reads less is a coarse or dead channel
_GYR_NOISE_RADPS_RTHZ = np.radians(0.02)  # consumer MEMS, thrice the data sheet (navigation §6.4)


def ekf_gd(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude; the gyro's noise is that of its rests, where there were any."""
    return run_recursion(samples, yaw_rad, progress, ekf_gd_recursion(samples))


def ekf_gd_recursion(samples: TrustedSamples) -> Recursion:
    """Return the filter for runs with these settings, calibration and field."""
    settings, scratch = samples.settings, np.empty(kernels_ekf_gd.SCRATCH_SIZE)
    gyr_noise = gyro_noise(samples.calibration)

    def begin(q_ws: FloatArray, _state: FloatArray | None) -> FloatArray:
        return start_state(q_ws)

    def advance(block: Block, state: FloatArray, quat: FloatArray, _bias: FloatArray) -> None:
        kernels_ekf_gd.ekf_gd(
            block.turn,
            block.dt_s,
            block.acc_g,
            block.acc_weight,
            block.mag,
            block.mag_weight,
            gyr_noise,
            settings.ekf_gd_noise_rthz,
            settings.ekf_gd_alpha,
            settings.ekf_gd_form == "published",
            state,
            scratch,
            quat,
        )

    return Recursion(begin, advance, estimates_bias=False)


def gyro_noise(calibration: Calibration) -> FloatArray:
    """Return the gyro's noise (3,) in rad/s/√Hz as the turn's variance grows, from its rests (P3 eq. 5.19), or a usual.

    The axes' mean stands for all three: P3's differ by a tenth, and a rest whose edge moves would favour one.
    """
    measured = calibration.gyr_noise_radps_rthz
    if measured is None:
        return np.full(3, _GYR_NOISE_RADPS_RTHZ)
    # the calibration's density is one-sided, that of a random walk two-sided
    return np.full(3, max(measured / np.sqrt(2.0), _LEAST_RADPS_RTHZ))


def start_state(q_ws: FloatArray) -> FloatArray:
    """Return the filter's state (20,): an attitude (4,) ± 3° about every axis, none of it along q."""
    covariance = 0.25 * _START_SIGMA_RAD**2 * (np.eye(4) - np.outer(q_ws, q_ws))
    return np.concatenate([q_ws, covariance.ravel()])
