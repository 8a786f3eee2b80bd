"""An error-state Kalman filter over attitude, gyro bias and velocity: causal, so fit for live display as well.

Where a plain filter takes each specific force for up and is bent by every push, this one integrates it to a velocity
of which it knows that it stays bounded (navigation §3, note a): what accelerates must brake again, gravity does not.
"""

import numpy as np

from processing.orientation import kernels_eskf
from processing.orientation.recursion import Estimate, Recursion, run_recursion
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.settings import OrientationSettings
from processing.survey import FloatArray

_TILT_SIGMA_RAD = np.radians(2.0)  # from a few seconds of readings
_HEADING_SIGMA_RAD = np.radians(5.0)
_START_SPEED_MPS = 0.5
_STILL_MPS_RTHZ = 0.01 / np.sqrt(10.0)  # 1 cm/s at 10 Hz (navigation §3, note a)
_STILL_RADPS_RTHZ = np.radians(0.1)
_STILL_RATE_RADPS = np.radians(2.0)
_STILL_ACC_G = 0.05


def eskf(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return the attitude and what bias remained after the calibration."""
    return run_recursion(samples, yaw_rad, progress, eskf_recursion(samples))


def eskf_recursion(samples: TrustedSamples) -> Recursion:
    """Return the filter for runs with these settings, calibration and field."""
    settings, scratch = samples.settings, np.empty(kernels_eskf.SCRATCH_SIZE)
    noise = noises(settings, samples.field.dip_rad if samples.field is not None else 0.0)
    first_sigma = samples.calibration.sigma_at(samples.times(0, 1))[0]

    def begin(q_ws: FloatArray, state: FloatArray | None) -> FloatArray:
        bias = np.zeros(3) if state is None else state[4:7]
        bias_covariance = np.diag(first_sigma**2) if state is None else state[10:91].reshape(9, 9)[3:6, 3:6]
        return start_state(q_ws, bias, bias_covariance)

    def advance(block: Block, state: FloatArray, quat: FloatArray, bias: FloatArray) -> None:
        kernels_eskf.eskf(
            block.turn,
            block.dt_s,
            block.acc_g,
            block.acc_weight,
            block.mag,
            block.mag_weight,
            noise,
            state,
            scratch,
            quat,
            bias,
        )

    return Recursion(begin, advance, estimates_bias=True)


def noises(settings: OrientationSettings, dip_rad: float) -> FloatArray:
    """Return what the kernel wants to know (13,)."""
    return np.array(
        [
            np.radians(settings.eskf_gyr_noise_dps_rthz),
            np.radians(settings.eskf_bias_walk_dps_rts),
            settings.eskf_acc_noise_mps_rts,
            settings.eskf_velocity_noise_mps_rthz,
            _STILL_MPS_RTHZ,
            _STILL_RADPS_RTHZ,
            np.radians(settings.eskf_heading_sigma_deg),
            settings.eskf_heading_noise_deg_rthz / settings.eskf_heading_sigma_deg,
            dip_rad,
            settings.mag_norm_tolerance_pct / 100.0,
            np.radians(settings.mag_dip_tolerance_deg),
            _STILL_RATE_RADPS,
            _STILL_ACC_G,
        ]
    )


def start_state(q_ws: FloatArray, bias_radps: FloatArray, bias_covariance: FloatArray) -> FloatArray:
    """Return the filter's state (99,): attitude (4,) ± 2° of tilt and 5° of heading, a known bias, no velocity."""
    covariance = np.zeros((9, 9))
    covariance[:3, :3] = np.diag([_TILT_SIGMA_RAD, _TILT_SIGMA_RAD, _HEADING_SIGMA_RAD]) ** 2
    covariance[3:6, 3:6] = bias_covariance
    covariance[6:, 6:] = _START_SPEED_MPS**2 * np.eye(3)
    return np.concatenate([q_ws, bias_radps, np.zeros(3), covariance.ravel(), np.zeros(8)])
