"""What the step chooses, why, and what it tells."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import attitude_error_deg, rolling, samples_of, turning

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.orientation import quaternions as qt
from processing.orientation.registry import ESTIMATORS, estimate_attitude
from processing.progress import Progress, silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, ImuSamples, Motion, PipeInfo, ProcessingChoice, Survey

CARRIED = Survey(device=DeviceInfo(motion=Motion.CARRIED))


def chosen(name):
    return replace(CARRIED, processing=ProcessingChoice(orientation=name))


@pytest.fixture
def imu():
    time_s, truth = turning([0.3, 0.2, 1.0], 1.0, 10.0)
    return replace(samples_of(time_s, truth, noise=1.0), quat_ws=truth)


def estimate(imu, survey=CARRIED, **settings):
    return estimate_attitude(imu, survey, OrientationSettings(**settings), silent())


def test_every_row_has_a_title_in_both_languages():
    assert len({e.name for e in ESTIMATORS}) == len(ESTIMATORS)
    for language in messages.LANGUAGES:
        assert {e.title for e in ESTIMATORS} <= set(messages.table("orientation", language))


@pytest.mark.parametrize(
    ("change", "survey", "method", "reason", "heading_from"),
    [
        ({}, CARRIED, "batch", "orientation_auto_field_steady", "magnetometer"),
        ({"mag_s_ut": None}, CARRIED, "batch", "orientation_auto_no_magnetometer", "launch"),
        ({}, replace(CARRIED, pipe=PipeInfo("steel")), "batch", "orientation_auto_pipe_ferrous", "launch"),
        ({}, chosen("mahony"), "mahony", "orientation_chosen", "magnetometer"),
        ({}, chosen("gyro"), "gyro", "orientation_chosen", "launch"),
        ({}, chosen("device"), "device", "orientation_chosen", "device"),
    ],
)
def test_the_method_is_chosen_by_the_data_and_the_reason_is_a_sentence(
    imu, change, survey, method, reason, heading_from
):
    attitude, _, findings = estimate(replace(imu, **change), survey)
    assert (attitude.method, attitude.reason, attitude.heading_from) == (method, reason, heading_from)
    for language in messages.LANGUAGES:
        assert messages.text("reasons", attitude.reason, language)
        assert all(messages.finding_sentence(f, language) for f in findings)


def test_every_code_that_the_step_can_give_has_a_sentence_in_both_languages():
    reasons = ["no_magnetometer", "magnetometer_ignored", "magnetometer_dead", "magnetometer_forced", "pipe_ferrous"]
    reasons += ["field_not_earths", "field_unsteady", "field_steady", "no_gyro"]
    for language in messages.LANGUAGES:
        table = messages.table("reasons", language)
        assert {f"orientation_auto_{r}" for r in reasons} <= set(table)
        told = {"pipe_ferrous", "field_not_earths", "field_unsteady", "magnetometer_dead"}
        assert {f"magnetometer_{r}" for r in told} <= set(messages.table("findings", language))


def test_without_a_gyro_the_devices_own_quaternions_are_taken(imu):
    attitude, _, findings = estimate(replace(imu, gyr_s_radps=np.zeros_like(imu.gyr_s_radps)))
    assert (attitude.method, attitude.reason) == ("device", "orientation_auto_no_gyro")
    assert "gyro_dead" in [f.code for f in findings]
    np.testing.assert_allclose(attitude.quat_ws, imu.quat_ws, atol=1e-12)


def test_device_quaternions_that_turn_the_other_way_are_turned_round_and_told(imu):
    roll = qt.from_euler_zyx(0.8, 0.5, 0.0)
    tilted = samples_of(imu.time_s, qt.multiply(roll, imu.quat_ws), noise=1.0)
    truth = qt.multiply(roll, imu.quat_ws)
    attitude, _, findings = estimate(replace(tilted, quat_ws=qt.conjugate(truth)), chosen("device"))
    assert "device_quaternions_conjugated" in [f.code for f in findings]
    np.testing.assert_allclose(attitude.quat_ws, truth, atol=1e-12)


def test_device_quaternions_that_contradict_the_accelerometer_are_told(imu):
    nonsense = np.broadcast_to(qt.from_euler_zyx(2.0, 0.3, 0.0), imu.quat_ws.shape)
    _, _, findings = estimate(replace(imu, quat_ws=nonsense), chosen("device"))
    assert "device_quaternions_disagree" in [f.code for f in findings]


def test_device_without_quaternions_and_an_unknown_method_are_the_users_to_mend(imu):
    for survey, change in ((chosen("device"), {"quat_ws": None}), (chosen("magic"), {})):
        with pytest.raises(LeaklineError) as error:
            estimate(replace(imu, **change), survey)
        assert error.value.code is ErrorCode.SETTING_INVALID


def test_accmag_without_a_field_says_that_its_heading_means_nothing(imu):
    _, _, findings = estimate(imu, chosen("accmag"), magnetometer="ignore")
    assert "estimator_lacks_field" in [f.code for f in findings]


def test_too_few_trusted_rows_are_told(imu):
    with pytest.raises(LeaklineError) as error:
        estimate(replace(imu, valid=np.arange(len(imu.time_s)) < 5))
    assert error.value.code is ErrorCode.TOO_FEW_SAMPLES


@pytest.mark.parametrize("rows", [10, 11, 37, 120])
@pytest.mark.parametrize("method", [e.name for e in ESTIMATORS])
def test_short_recordings_give_an_attitude_for_each_row(imu, method, rows):
    short = ImuSamples(
        imu.time_s[:rows], imu.acc_s_mps2[:rows], imu.gyr_s_radps[:rows], imu.valid[:rows],
        imu.mag_s_ut[:rows], imu.quat_ws[:rows],
    )  # fmt: skip
    attitude, _, _ = estimate(short, chosen(method))
    assert attitude.quat_ws.shape == (rows, 4)
    assert np.all(np.isfinite(attitude.quat_ws))


def test_declination_turns_the_magnetic_heading_to_true_north(imu):
    magnetic, _, _ = estimate(imu)
    true, _, _ = estimate(imu, declination_deg=6.0)
    yaw = np.degrees(qt.to_roll_pitch_yaw(true.quat_ws)[:, 2] - qt.to_roll_pitch_yaw(magnetic.quat_ws)[:, 2])
    # magnetic north lies 6° clockwise of true north, so what was called north is in truth heading 6°: yaw 6° less
    np.testing.assert_allclose((yaw + 180.0) % 360.0 - 180.0, -6.0, atol=1e-6)


@pytest.mark.parametrize("method", ["offline_vqf", "ekf7", "mahony", "madgwick", "gyro"])
def test_what_was_taken_off_leaves_the_true_rates(method):
    imu, _, axis_s = rolling(100.0, scale_error=(0.006, 0.006, 0.006))
    survey = Survey(processing=ProcessingChoice(orientation=method))
    attitude, calibration, _ = estimate(imu, survey)
    assert np.abs(calibration.gyr_scale - 1.006).max() < 3e-3
    rates = imu.gyr_s_radps - attitude.bias_radps
    moving = slice(6000, 18000)
    expected = (imu.gyr_s_radps[moving] - np.radians([0.2, -0.3, 0.1])) * 1.006
    assert np.abs((rates[moving] - expected).mean(axis=0) @ axis_s) < np.radians(0.1)


def test_a_constant_offset_alone_is_given_as_three_numbers(imu):
    attitude, _, _ = estimate(replace(imu, mag_s_ut=None), chosen("gyro"), rest_min_s=3.0)
    rests = estimate(replace(imu, mag_s_ut=None), chosen("gyro"), rest_min_s=3.0)[1].rests
    assert attitude.bias_radps.shape == ((3,) if len(rests) == 1 else (len(imu.time_s), 3))


def test_without_a_rest_the_offset_comes_from_the_motion_and_is_a_warning():
    imu, truth, _ = rolling(120.0)
    moving = imu.time_s > 12.0
    cut = ImuSamples(imu.time_s[moving], imu.acc_s_mps2[moving], imu.gyr_s_radps[moving], imu.valid[moving])
    attitude, calibration, findings = estimate(cut, Survey())
    assert calibration.basis == "motion"
    assert "no_rest_motion_bias" in [f.code for f in findings]
    off = calibration.bias_radps[0] - np.radians([0.2, -0.3, 0.1])
    assert np.all(np.abs(off) < 3.0 * calibration.bias_sigma_radps[0])
    heading, inclination = attitude_error_deg(attitude.quat_ws, truth[moving])
    assert np.sqrt(np.mean(inclination**2)) < 1.0
    assert abs(heading[-1] - heading[0]) < 10.0


def test_the_progress_rises_to_one(imu):
    seen = []
    estimate_attitude(imu, CARRIED, OrientationSettings(), Progress(lambda f, p: seen.append((f, p))))
    fractions = [f for f, _ in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert {p for _, p in seen} <= set(messages.table("progress"))


@pytest.mark.parametrize("method", [e.name for e in ESTIMATORS])
def test_a_clock_that_jumps_by_years_costs_no_memory(imu, method):
    late = replace(imu, time_s=np.where(imu.time_s < 8.0, imu.time_s, imu.time_s + 1e10))
    attitude, calibration, _ = estimate(late, chosen(method), magnetometer="use")
    assert np.all(np.isfinite(attitude.quat_ws))
    assert all(r.duration_s < 10.0 for r in calibration.rests)
