"""Makes IMU samples from known attitudes: what an ideal sensor would say, and what a plain one adds."""

import numpy as np

from processing.orientation import quaternions as qt
from processing.survey import ImuSamples

GRAVITY_MPS2 = 9.80665
FIELD_W_UT = np.array([0.0, 25.0, -40.0])  # north and down, as in the Marmara region


def samples_of(time_s, quat_ws, acceleration_w_mps2=0.0, *, bias_radps=0.0, noise=0.0, seed=0):
    """Return samples whose rates are the mean turn since the row before; ``noise`` 1 is a plain consumer MEMS."""
    rng = np.random.default_rng(seed)
    turn = qt.log_map(qt.multiply(qt.conjugate(quat_ws[:-1]), quat_ws[1:])) / np.diff(time_s)[:, None]
    gyr = np.vstack([turn[:1], turn]) + bias_radps
    acc = qt.rotate_inverse(quat_ws, np.array([0.0, 0.0, GRAVITY_MPS2]) + np.asarray(acceleration_w_mps2))
    mag = qt.rotate_inverse(quat_ws, FIELD_W_UT)
    shape = gyr.shape
    return ImuSamples(
        time_s=np.asarray(time_s, dtype=float),
        acc_s_mps2=acc + noise * 0.03 * rng.standard_normal(shape),
        gyr_s_radps=gyr + noise * np.radians(0.1) * rng.standard_normal(shape),
        valid=np.ones(len(time_s), dtype=bool),
        mag_s_ut=mag + noise * 0.3 * rng.standard_normal(shape),
    )


def turning(axis, rate_radps, seconds, rate_hz=100.0, start=qt.IDENTITY, rest_s=3.0):
    """Return times and attitudes: ``rest_s`` at rest, then a constant rate about a sensor axis, then rest again."""
    time_s = np.arange(0.0, seconds + 2 * rest_s, 1.0 / rate_hz)
    angle = rate_radps * np.clip(time_s - rest_s, 0.0, seconds)
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    return time_s, qt.multiply(np.asarray(start), qt.exp_map(angle[:, None] * axis))


def rolling(seconds=200.0, rate_hz=200.0, spin_radps=12.0, scale_error=(0.0, 0.0, 0.0), tilt_rad=0.02, seed=0):
    """Return a ball that rolls straight about an axis tilted by ``tilt_rad``, off-centre sensor, noise; its truth.

    The gyro reads ``ω/(1 + scale_error)`` plus an offset.
    """
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, seconds, 1.0 / rate_hz)
    spin = spin_radps * np.clip((time_s - 8.0) / 3.0, 0.0, 1.0) * (1.0 + 0.15 * np.sin(2 * np.pi * time_s / 37.0))
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (spin[1:] + spin[:-1])) / rate_hz])
    axis_s = np.array([0.8, 0.1, 0.6]) / np.linalg.norm([0.8, 0.1, 0.6])
    start = qt.from_two_vectors(axis_s, np.array([0.0, np.cos(tilt_rad), np.sin(tilt_rad)]))
    quat_ws = qt.multiply(start, qt.exp_map(angle[:, None] * axis_s))
    arm = np.array([0.004, 0.002, -0.003])
    ideal = samples_of(time_s, quat_ws)
    spin_s, slope_s = spin[:, None] * axis_s, np.gradient(spin, time_s)[:, None] * axis_s
    acc = ideal.acc_s_mps2 + np.cross(slope_s, arm) + np.cross(spin_s, np.cross(spin_s, arm))
    gyr = ideal.gyr_s_radps / (1.0 + np.array(scale_error)) + np.radians([0.2, -0.3, 0.1])
    imu = ImuSamples(
        time_s=time_s,
        acc_s_mps2=acc + 0.03 * rng.standard_normal(acc.shape),
        gyr_s_radps=gyr + np.radians(0.05) * rng.standard_normal(gyr.shape),
        valid=np.ones(len(time_s), dtype=bool),
    )
    return imu, quat_ws, axis_s


def rolling_about_many_axes(spells=20, spell_s=20.0, rate_hz=100.0, radius_m=0.1, seed=3):
    """Return times, attitudes, angular rate and slope in the world (n, 3) and own acceleration of a ball that stops,
    is turned another way and rolls on: each spell about another axis of the sensor, level to a hundredth."""
    rng = np.random.default_rng(seed)
    rows = int(spell_s * rate_hz)
    time_s = np.arange(spells * rows) / rate_hz
    quat_ws, rate_w, slope_w = (np.empty((len(time_s), k)) for k in (4, 3, 3))
    q = qt.normalise(rng.standard_normal(4))
    u = (np.arange(rows) + 0.5) / rows
    speed = 9.0 * np.sin(np.pi * u) ** 2
    slope = 9.0 * np.pi * np.sin(2.0 * np.pi * u) / spell_s
    for spell in range(spells):
        part = slice(spell * rows, (spell + 1) * rows)
        heading = rng.uniform(0.0, 2.0 * np.pi)
        axis_w = np.array([np.cos(heading), np.sin(heading), 0.02])
        quat_ws[part] = qt.multiply(qt.exp_map((np.cumsum(speed) / rate_hz)[:, None] * axis_w), q)
        rate_w[part], slope_w[part] = speed[:, None] * axis_w, slope[:, None] * axis_w
        # between two spells a hand turns it, within one sample, too little to be felt
        q = quat_ws[part][-1]
    return time_s, quat_ws, rate_w, slope_w, radius_m * np.cross(slope_w, [0.0, 0.0, 1.0])


def attitude_error_deg(quat_ws, truth_ws):
    """Return heading (unwrapped) and inclination errors in degrees, row by row."""
    error = qt.multiply(quat_ws, qt.conjugate(truth_ws))
    heading = np.degrees(np.unwrap(2.0 * np.arctan2(error[:, 3], error[:, 0]), period=2 * np.pi))
    inclination = np.degrees(2.0 * np.arccos(np.clip(np.hypot(error[:, 0], error[:, 3]), 0.0, 1.0)))
    return heading, inclination
