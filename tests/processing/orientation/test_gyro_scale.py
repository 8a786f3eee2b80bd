"""The gyro's scale along the spin axis, from gravity, on simulated rolling with a known error."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import attitude_error_deg, rolling, rolling_about_many_axes, samples_of

from processing.orientation import quaternions as qt
from processing.orientation.calibration import calibrate
from processing.orientation.gyro_scale import calibrate_scale
from processing.orientation.registry import estimate_attitude
from processing.orientation.samples import trusted_samples
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, Motion, ProcessingChoice, Survey

SETTINGS = OrientationSettings()
ERROR = np.array([0.006, -0.003, 0.008])


def scale_of(imu):
    return calibrate_scale(trusted_samples(imu, calibrate(imu, SETTINGS), SETTINGS, None), silent())


@pytest.mark.parametrize("factor", [1.0, -1.0, 0.3])
def test_the_error_along_the_spin_axis_is_found_within_a_hundredth_of_a_per_cent(factor):
    imu, _, axis_s = rolling(scale_error=factor * ERROR)
    found = scale_of(imu)
    error = axis_s @ (found.gyr_matrix - np.eye(3)) @ axis_s
    assert error == pytest.approx(factor * axis_s**2 @ ERROR, abs=1e-4)


def test_the_heading_drift_shrinks_to_a_tenth_and_the_operator_is_told():
    imu, truth, _ = rolling(scale_error=ERROR)
    survey = Survey(processing=ProcessingChoice(orientation="offline_vqf"))
    drift, codes = {}, {}
    for choice in ("auto", "off"):
        attitude, _, findings = estimate_attitude(imu, survey, replace(SETTINGS, gyro_scale=choice), silent())
        heading, _ = attitude_error_deg(attitude.quat_ws, truth)
        drift[choice] = abs(heading[-1] - heading[3000])
        codes[choice] = [f.code for f in findings]
    assert drift["auto"] < 0.1 * drift["off"]
    assert "gyro_scale_found" in codes["auto"]
    assert "gyro_scale_found" not in codes["off"]


def test_a_right_gyro_is_left_alone():
    imu, _, _ = rolling()
    matrix = scale_of(imu).gyr_matrix
    assert np.abs(matrix - np.eye(3)).max() < 2e-4


def test_a_device_that_does_not_roll_tells_nothing():
    time_s = np.arange(0.0, 60.0, 0.01)
    wobble = 0.2 * np.sin(time_s)[:, None] * np.array([1.0, 0.3, 0.5])
    imu = samples_of(time_s, qt.exp_map(wobble), noise=1.0)
    np.testing.assert_array_equal(scale_of(imu).gyr_matrix, np.eye(3))


def test_carried_devices_are_not_asked():
    imu, _, _ = rolling(60.0, scale_error=ERROR)
    survey = Survey(device=DeviceInfo(motion=Motion.CARRIED))
    _, calibration, _ = estimate_attitude(imu, survey, SETTINGS, silent())
    np.testing.assert_array_equal(calibration.gyr_matrix, np.eye(3))


def test_a_ball_that_has_turned_about_many_axes_shows_the_whole_error():
    error = 0.005 * np.array([[0.9, 0.4, -0.3], [0.4, -0.7, 0.5], [-0.3, 0.5, 0.8]])
    time_s, quat_ws, _, _, own_w = rolling_about_many_axes()
    imu = samples_of(time_s, quat_ws, own_w, noise=1.0)
    imu = replace(imu, gyr_s_radps=imu.gyr_s_radps @ np.linalg.inv(np.eye(3) + error).T)
    found = scale_of(imu)
    # what turns with the ball averages out, so only the symmetric part is seen well
    symmetric = 0.5 * (found.gyr_matrix + found.gyr_matrix.T) - np.eye(3)
    np.testing.assert_allclose(symmetric, error, atol=4e-4)
    assert np.diag(found.gyr_matrix_sigma).max() < 1e-3


def test_the_sigma_says_that_a_fixed_spin_axis_shows_no_single_scale():
    imu, _, _ = rolling(scale_error=ERROR)
    found = scale_of(imu)
    assert np.all(np.diag(found.gyr_matrix_sigma) > 2e-3)
