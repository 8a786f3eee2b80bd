"""The accelerometer's errors from rolling and from rests, on samples made with known ones."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import GRAVITY_MPS2, attitude_error_deg, rolling, rolling_about_many_axes, samples_of

from processing.orientation import quaternions as qt
from processing.orientation.accelerometer import calibrate_at_rests, calibrate_rolling
from processing.orientation.calibration import calibrate
from processing.orientation.registry import estimate_attitude
from processing.orientation.rests import Rest
from processing.orientation.samples import trusted_samples
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, Motion, Survey

SETTINGS = OrientationSettings()
BIAS = np.array([0.06, -0.04, 0.08])
ARM = np.array([0.004, -0.006, 0.003])
MATRIX = np.eye(3) + 0.004 * np.array([[1.0, 0.5, -0.4], [0.3, -1.0, 0.6], [-0.5, 0.2, 0.0]])


def spoilt(bias=BIAS, arm=ARM, matrix=MATRIX):
    """Return samples of a ball that has rolled about many axes, spoilt as told, and its true attitudes."""
    time_s, quat_ws, rate_w, slope_w, own_w = rolling_about_many_axes()
    imu = samples_of(time_s, quat_ws, own_w, noise=1.0)
    rate, slope = qt.rotate_inverse(quat_ws, rate_w), qt.rotate_inverse(quat_ws, slope_w)
    felt = imu.acc_s_mps2 + np.cross(slope, arm) + np.cross(rate, np.cross(rate, arm))
    return replace(imu, acc_s_mps2=felt @ matrix.T + bias), quat_ws


def calibrated(imu):
    return calibrate_rolling(trusted_samples(imu, calibrate(imu, SETTINGS), SETTINGS, None), silent())


def test_a_ball_that_has_turned_all_ways_shows_offset_arm_and_scale():
    found = calibrated(spoilt()[0])
    assert found.acc_basis == "rolling"
    np.testing.assert_allclose(found.acc_bias_mps2, BIAS, atol=0.006)
    np.testing.assert_allclose(found.lever_arm_m, ARM, atol=3e-4)
    # the common scale is the unit of gravity and stays unknown
    error = found.acc_matrix - MATRIX
    np.testing.assert_allclose(error - np.eye(3) * np.trace(error) / 3.0, 0.0, atol=1e-3)


def test_the_errors_found_are_within_their_sigmas():
    found = calibrated(spoilt()[0])
    assert np.all(np.abs(found.acc_bias_mps2 - BIAS) < 4.0 * found.acc_bias_sigma_mps2)
    assert np.all(np.abs(found.lever_arm_m - ARM) < 4.0 * found.lever_arm_sigma_m)
    assert found.lever_arm_sigma_m.max() < 5e-4


def test_a_straight_way_shows_the_arm_across_the_spin_axis_and_not_along_it():
    imu, _, axis_s = rolling()  # its sensor lies at (4, 2, −3) mm
    found = calibrated(imu)
    arm = np.array([0.004, 0.002, -0.003])
    across = np.eye(3) - np.outer(axis_s, axis_s)
    np.testing.assert_allclose(across @ found.lever_arm_m, across @ arm, atol=2e-4)
    assert abs(axis_s @ found.lever_arm_m) < 1e-3
    # those with a share along the axis keep an uncertainty of the prior's size
    assert found.lever_arm_sigma_m[0] > 2e-3
    assert found.acc_bias_sigma_mps2[0] > 0.02
    assert abs(axis_s @ found.acc_bias_mps2) < 0.01


def test_the_operator_is_told_what_was_found():
    _, _, findings = estimate_attitude(spoilt()[0], Survey(), SETTINGS, silent())
    (told,) = [f for f in findings if f.code == "accelerometer_calibrated"]
    assert told.params["offset_mps2"] == pytest.approx(np.linalg.norm(BIAS), abs=0.01)
    assert told.params["arm_mm"] == pytest.approx(1e3 * np.linalg.norm(ARM), abs=0.5)


def test_a_faultless_accelerometer_is_left_alone():
    imu, _ = spoilt(bias=np.zeros(3), arm=np.zeros(3), matrix=np.eye(3))
    assert calibrated(imu).acc_basis == "none"


def test_the_estimators_are_given_the_force_without_the_errors():
    imu, _ = spoilt()
    time_s, quat_ws, _, _, own_w = rolling_about_many_axes()
    true = samples_of(time_s, quat_ws, own_w).acc_s_mps2[1000:2000] / GRAVITY_MPS2

    def error(calibration):
        block = trusted_samples(imu, calibration, SETTINGS, None).block(1000, 2000, first=True)
        unit = block.acc_g * np.mean(np.linalg.norm(true, axis=1)) / np.mean(np.linalg.norm(block.acc_g, axis=1))
        return np.sqrt(np.mean((unit - true) ** 2))

    noise = 0.03 / GRAVITY_MPS2
    assert error(calibrate(imu, SETTINGS)) > 2.0 * noise
    assert error(calibrated(imu)) < 1.1 * noise


def test_the_inclination_profits():
    imu, truth = spoilt()
    survey = Survey()
    errors = {}
    for choice in ("auto", "off"):
        attitude, _, _ = estimate_attitude(imu, survey, replace(SETTINGS, accelerometer=choice), silent())
        errors[choice] = float(np.sqrt(np.mean(attitude_error_deg(attitude.quat_ws, truth)[1] ** 2)))
    assert errors["auto"] < 0.9 * errors["off"]


def test_errors_that_no_sensor_has_are_not_believed():
    # hand-held turning, whose acceleration goes with the turn, looks like this (BROAD's fast trials)
    assert calibrated(spoilt(bias=np.array([1.2, 0.0, -0.8]))[0]).acc_basis == "none"


def test_a_device_that_does_not_roll_is_left_alone():
    time_s = np.arange(0.0, 60.0, 0.01)
    wobble = 0.2 * np.sin(time_s)[:, None] * np.array([1.0, 0.3, 0.5])
    imu = samples_of(time_s, qt.exp_map(wobble), noise=1.0)
    imu = replace(imu, acc_s_mps2=imu.acc_s_mps2 + BIAS)
    assert calibrated(imu).acc_basis == "none"


SCALES = np.array([1.006, 0.995, 1.003])


def at_rests(count, seed=0):
    """Return a calibration that has seen so many rests, each in another attitude, of a spoilt accelerometer."""
    rng = np.random.default_rng(seed)
    golden = np.pi * (3.0 - np.sqrt(5.0))
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    side = np.sqrt(1.0 - height**2)
    up = np.column_stack([side * np.cos(golden * np.arange(count)), side * np.sin(golden * np.arange(count)), height])
    means = GRAVITY_MPS2 * up * SCALES + BIAS + 0.002 * rng.standard_normal((count, 3))
    still = np.zeros(3)
    rests = tuple(Rest(10.0 * k, 10.0 * k + 5.0, 500, still, still, mean, still) for k, mean in enumerate(means))
    base = calibrate(samples_of(np.arange(0.0, 9.0, 0.01), np.tile(qt.IDENTITY, (900, 1)), noise=1.0), SETTINGS)
    return replace(base, rests=rests)


@pytest.mark.parametrize("count", [9, 14])
def test_rests_in_many_attitudes_show_offset_and_scales(count):
    found = calibrate_at_rests(at_rests(count))
    assert found.acc_basis == "rests"
    np.testing.assert_allclose(found.acc_bias_mps2, BIAS, atol=0.01)
    np.testing.assert_allclose(np.diag(found.acc_matrix), SCALES, atol=1e-3)
    assert np.all(np.abs(found.acc_bias_mps2 - BIAS) < 4.0 * found.acc_bias_sigma_mps2)


def test_rests_in_few_attitudes_are_not_enough():
    few = at_rests(8)
    assert calibrate_at_rests(few) is few
    often = replace(few, rests=few.rests * 3)
    assert calibrate_at_rests(often) is often


def test_rests_that_gravity_already_fits_change_nothing():
    rng = np.random.default_rng(2)
    right = at_rests(12)
    rests = tuple(
        replace(r, acc_mean_mps2=(r.acc_mean_mps2 - BIAS) / SCALES + 0.01 * rng.standard_normal(3)) for r in right.rests
    )
    right = replace(right, rests=rests)
    assert calibrate_at_rests(right) is right


def test_carried_devices_are_calibrated_from_rests_alone():
    imu, _ = spoilt()
    _, calibration, _ = estimate_attitude(imu, Survey(device=DeviceInfo(motion=Motion.CARRIED)), SETTINGS, silent())
    assert calibration.acc_basis == "none"
