"""What the sensors make of the true motion: scale, misalignment, bias that walks, noise, range, steps; field, pressure.

Densities are per √Hz, so a sample's standard deviation is ``density·√rate``; bias walks are per √s.
"""

import numpy as np

from processing.orientation import quaternions as qt
from processing.simulation.more_errors import gyro_errors, joint_field_w_ut
from processing.simulation.motion import TrueMotion
from processing.simulation.scenario import Imu, Joints, Magnetics
from processing.simulation.wander import gauss_markov
from processing.survey import FloatArray, ImuSamples

_WATER_KPA_PER_M = 9.81


def measured(
    imu: Imu,
    motion: TrueMotion,
    blows_w_mps2: FloatArray,
    rng: np.random.Generator,
    of_more: np.random.Generator,
    joints: tuple[Joints, FloatArray],
) -> ImuSamples:
    """Return what the log will hold, before faults; ``blows_w_mps2`` (n, 3) is felt on top of the smooth motion.

    ``of_more`` draws what was added to the model later, so that it leaves everything else as it was; ``joints`` are
    those of the pipe with their chainages.
    """
    force = motion.force_s_mps2 + qt.rotate_inverse(motion.quat_ws, blows_w_mps2)
    count = len(motion.time_s)
    acc = _spoilt(
        force, imu, rng, imu.acc_scale_sigma, imu.acc_misalignment_sigma_rad,
        imu.acc_bias_sigma_mps2, imu.acc_walk, imu.acc_noise, imu.acc_range_mps2, imu.acc_step_mps2,
    )  # fmt: skip
    more = gyro_errors(imu, motion, force, of_more)
    gyr = _spoilt(
        motion.gyr_s_radps, imu, rng, imu.gyro_scale_sigma, imu.gyro_misalignment_sigma_rad,
        imu.gyro_bias_sigma_radps, imu.gyro_walk, imu.gyro_noise, imu.gyro_range_radps, imu.gyro_step_radps, more,
    )  # fmt: skip
    iron = joint_field_w_ut(*joints, motion, of_more)
    time_s = motion.time_s
    if imu.stamp_jitter_s > 0:
        limit = 0.45 / imu.rate_hz  # stamps are noisy but stay in order
        time_s = time_s + np.clip(rng.normal(0, imu.stamp_jitter_s, count), -limit, limit)
    return ImuSamples(
        time_s=time_s,
        acc_s_mps2=acc,
        gyr_s_radps=gyr,
        valid=np.ones(count, dtype=np.bool_),
        mag_s_ut=_field(imu.magnetics, motion, rng, iron) if imu.magnetics.enabled else None,
        quat_ws=_own_quaternion(imu, motion, rng) if imu.device_quaternion else None,
        pressure_kpa=_pressure(imu, motion, rng) if imu.pressure else None,
        temperature_c=_temperature(motion, rng) if imu.pressure else None,
    )


def _spoilt(
    true_s: FloatArray, imu: Imu, rng: np.random.Generator, scale: float, misalignment: float,
    bias: float, walk: float, noise: float, limit: float, step: float, more: FloatArray | None = None,
) -> FloatArray:  # fmt: skip
    matrix = np.eye(3) + np.diag(rng.normal(0, 1, 3) * scale)
    matrix += (1 - np.eye(3)) * rng.normal(0, 1, (3, 3)) * misalignment
    out: FloatArray = true_s @ matrix.T + rng.normal(0, 1, 3) * bias
    if more is not None:
        out += more
    if walk > 0:
        out += np.cumsum(rng.normal(0, walk / np.sqrt(imu.rate_hz), true_s.shape), axis=0)
    if noise > 0:
        out += rng.normal(0, noise * np.sqrt(imu.rate_hz), true_s.shape)
    np.clip(out, -limit, limit, out=out)
    return np.round(out / step) * step if step > 1e-12 else out


def earth_field_w_ut(magnetics: Magnetics) -> FloatArray:
    """Return Earth's field (3,) in the ENU world: horizontal towards magnetic north, and down."""
    east_of_north = np.radians(magnetics.declination_deg)
    h = magnetics.horizontal_ut
    return np.array([h * np.sin(east_of_north), h * np.cos(east_of_north), -magnetics.down_ut])


def _field(
    magnetics: Magnetics, motion: TrueMotion, rng: np.random.Generator, joints_w_ut: FloatArray | None
) -> FloatArray:
    field_w = np.tile(earth_field_w_ut(magnetics), (len(motion.time_s), 1))
    span = (0.0, max(float(motion.chainage_m[-1]), 1.0))
    for axis in range(3):  # iron stays where it is: the disturbance belongs to the place
        field_w[:, axis] += gauss_markov(span, magnetics.pipe_sigma_ut, magnetics.pipe_scale_m, rng)(motion.chainage_m)
    if joints_w_ut is not None:
        field_w += joints_w_ut
    read = qt.rotate_inverse(motion.quat_ws, field_w) + np.asarray(magnetics.hard_iron_s_ut)
    return np.asarray(read + rng.normal(0, magnetics.noise_ut, read.shape))


def _own_quaternion(imu: Imu, motion: TrueMotion, rng: np.random.Generator) -> FloatArray:
    """The device's own filter: right in tilt to 0.3°, its heading drifting at a steady rate of its own."""
    heading = rng.normal(0, imu.device_quaternion_drift_radps) * motion.time_s
    turned = qt.multiply(qt.turn_about_up(heading), motion.quat_ws)
    tilt = np.zeros((len(heading), 3))
    for axis in range(2):
        tilt[:, axis] = gauss_markov((0.0, float(motion.time_s[-1])), np.radians(0.3), 2.0, rng)(motion.time_s)
    return qt.normalise(qt.multiply(qt.exp_map(tilt), turned))


def _pressure(imu: Imu, motion: TrueMotion, rng: np.random.Generator) -> FloatArray:
    """Static pressure, the head of the height above the launch, friction of 0.2 kPa in 100 m, and noise."""
    height = motion.position_w_m[:, 2] - motion.position_w_m[0, 2]
    true = imu.static_pressure_kpa - _WATER_KPA_PER_M * height - 0.002 * motion.chainage_m
    surge = gauss_markov((0.0, float(motion.time_s[-1])), 0.4 if imu.pressure_noise_kpa > 0 else 0.0, 20.0, rng)
    return np.asarray(true + surge(motion.time_s) + rng.normal(0, 1, len(true)) * imu.pressure_noise_kpa)


def _temperature(motion: TrueMotion, rng: np.random.Generator) -> FloatArray:
    """The electronics cool from the hand's warmth towards the water's."""
    water = 13.0 + rng.normal(0, 1.0)
    return np.asarray(water + (21.0 - water) * np.exp(-motion.time_s / 180.0))
