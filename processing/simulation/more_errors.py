"""What a gyro feels besides its own turning, and what iron at the joints adds to the field.

Each part alone: flicker noise; scale and misalignment of a stated size; acceleration (``Γ f``); Earth's rotation
``Ω (0, cos φ, sin φ)`` in the ENU world.
"""

import numpy as np

from processing.orientation import quaternions as qt
from processing.simulation.flicker import flicker
from processing.simulation.motion import TrueMotion
from processing.simulation.scenario import Imu, Joints
from processing.survey import FloatArray

EARTH_RATE_RADPS = 7.292115e-5  # WGS 84


def gyro_errors(imu: Imu, motion: TrueMotion, force_s_mps2: FloatArray, rng: np.random.Generator) -> FloatArray | None:
    """Return (n, 3) to be added to the gyro, None where the scenario has none of it."""
    out = np.zeros_like(motion.gyr_s_radps)
    if imu.latitude_deg is not None:
        out += qt.rotate_inverse(motion.quat_ws, earth_rate_w_radps(imu.latitude_deg))
    if imu.gyro_scale_range[1] > 0 or imu.gyro_misalignment_range_rad[1] > 0:
        departure = np.diag(_either_sign(imu.gyro_scale_range, (3,), rng))
        departure += (1 - np.eye(3)) * _either_sign(imu.gyro_misalignment_range_rad, (3, 3), rng)
        out += (motion.gyr_s_radps + out) @ departure.T
    if imu.gyro_g_sensitivity > 0:
        out += force_s_mps2 @ rng.normal(0, imu.gyro_g_sensitivity, (3, 3)).T
    if imu.gyro_instability_radps > 0:
        out += flicker(len(out), imu.rate_hz, imu.gyro_instability_radps, rng)
    return out if np.any(out) else None


def earth_rate_w_radps(latitude_deg: float) -> FloatArray:
    """Return Earth's rotation (3,) in the ENU world."""
    latitude = np.radians(latitude_deg)
    return EARTH_RATE_RADPS * np.array([0.0, np.cos(latitude), np.sin(latitude)])


def joint_field_w_ut(
    joints: Joints, chainages_m: FloatArray, motion: TrueMotion, rng: np.random.Generator
) -> FloatArray | None:
    """Return (n, 3) the field of the joints' iron along the way: across the pipe a bump, along it the bump's slope.

    Each joint has its own size and direction; it belongs to the place, so a ball that passes twice feels it twice.
    """
    if joints.magnetic_ut <= 0 or len(chainages_m) == 0:
        return None
    out = np.zeros((len(motion.time_s), 3))
    for chainage in chainages_m:
        size = joints.magnetic_ut * float(np.exp(rng.normal(0.0, 0.4)))
        across, along = rng.normal(size=3), rng.normal(size=3)
        x = (motion.chainage_m - chainage) / joints.magnetic_half_width_m
        near = np.flatnonzero(np.abs(x) < 6.0)
        bump = np.exp(-0.5 * x[near] ** 2)
        out[near] += size * bump[:, None] * across / np.linalg.norm(across)
        out[near] += size * (x[near] * bump)[:, None] * along / np.linalg.norm(along)
    return out


def _either_sign(between: tuple[float, float], shape: tuple[int, ...], rng: np.random.Generator) -> FloatArray:
    return np.asarray(rng.uniform(*between, shape) * rng.choice([-1.0, 1.0], shape))
