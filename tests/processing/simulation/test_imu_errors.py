"""The sensors' errors have the statistics that the scenario states."""

from dataclasses import replace

import numpy as np
import pytest

from processing.orientation import quaternions as qt
from processing.simulation.imu_errors import earth_field_w_ut
from processing.simulation.run import simulate
from processing.simulation.scenario import Ball, Drive, Imu, Joints, Knocks, Magnetics, PipeRoute, Scenario, Sound

SILENT = Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False))
RESTING = Scenario("rest", route=PipeRoute(((0.0, 0, 0), (4.0, 0, 0))), drive=Drive(rest_start_s=120.0), sound=SILENT)


def with_imu(scenario=RESTING, **changes):
    return replace(scenario, imu=replace(Imu.perfect(200.0), **changes))


def resting(run):
    return run.imu.time_s < 119.0


def test_white_noise_of_a_sample_is_the_density_times_the_root_of_the_rate():
    run = simulate(with_imu(gyro_noise=2e-4, acc_noise=3e-3), 4)
    rows = resting(run)
    np.testing.assert_allclose(run.imu.gyr_s_radps[rows].std(axis=0), 2e-4 * np.sqrt(200), rtol=0.03)
    np.testing.assert_allclose(run.imu.acc_s_mps2[rows].std(axis=0), 3e-3 * np.sqrt(200), rtol=0.03)


def test_turn_on_bias_differs_from_run_to_run_with_the_stated_spread():
    short = replace(RESTING, drive=Drive(rest_start_s=1.0, rest_end_s=1.0), imu=Imu.perfect(20.0))
    short = replace(short, imu=replace(short.imu, gyro_bias_sigma_radps=5e-3))
    biases = np.array([simulate(short, seed, quick=True).imu.gyr_s_radps[5] for seed in range(120)])
    assert biases.std() == pytest.approx(5e-3, rel=0.12)


def test_the_bias_walks_as_the_root_of_time():
    ends = []
    for seed in range(40):
        gyr = simulate(with_imu(gyro_walk=1e-3), seed, quick=True).imu.gyr_s_radps
        ends += list(gyr[100 * 200] - gyr[0])
    assert np.std(ends) == pytest.approx(1e-3 * np.sqrt(100), rel=0.2)


def test_the_range_saturates_and_the_step_quantises():
    scenario = replace(with_imu(gyro_range_radps=5.0, acc_step_mps2=0.01), drive=Drive(rest_start_s=2.0))
    run = simulate(scenario, 1)
    assert np.max(np.abs(run.imu.gyr_s_radps)) == 5.0
    steps = run.imu.acc_s_mps2 / 0.01
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_scale_and_misalignment_are_one_matrix_on_the_true_rates():
    scenario = with_imu(gyro_scale_sigma=0.01, gyro_misalignment_sigma_rad=0.005)
    scenario = replace(
        scenario,
        route=PipeRoute(((0.0, 0, 0), (20.0, 0, 0), (20.0, 20.0, 0))),
        ball=Ball(spin_sigma_radps=3.0, spin_tau_s=1.0),
        drive=Drive(rest_start_s=1.0, rest_end_s=1.0),
    )
    run = simulate(scenario, 8)
    matrix, _, rank, _ = np.linalg.lstsq(run.motion.gyr_s_radps, run.imu.gyr_s_radps, rcond=None)
    assert rank == 3
    np.testing.assert_allclose(run.motion.gyr_s_radps @ matrix, run.imu.gyr_s_radps, atol=1e-9)
    departure = matrix - np.eye(3)
    assert 1e-4 < np.abs(departure).max() < 0.05


def test_time_stamps_jitter_but_stay_in_order():
    stamps = simulate(with_imu(stamp_jitter_s=1e-3), 1).imu.time_s
    errors = stamps - np.arange(len(stamps)) / 200
    assert errors.std() == pytest.approx(1e-3, rel=0.1)
    assert np.all(np.diff(stamps) > 0)


def test_the_magnetometer_reads_the_earths_field_turned_into_the_sensor():
    magnetics = Magnetics(enabled=True, noise_ut=0.0, declination_deg=6.0)
    run = simulate(replace(with_imu(magnetics=magnetics), drive=Drive(rest_start_s=1.0)), 2)
    field_w = qt.rotate(run.motion.quat_ws, run.imu.mag_s_ut)
    np.testing.assert_allclose(field_w, np.tile(earth_field_w_ut(magnetics), (len(field_w), 1)), atol=1e-9)
    east, north, up = field_w[0]
    assert np.degrees(np.arctan2(east, north)) == pytest.approx(6.0)
    assert up < 0  # Türkiye lies north of the magnetic equator: the field points down


def test_iron_in_the_pipe_disturbs_by_place_not_by_time():
    magnetics = Magnetics(enabled=True, noise_ut=0.0, pipe_sigma_ut=15.0)
    run = simulate(replace(with_imu(magnetics=magnetics), route=PipeRoute(((0.0, 0, 0), (150.0, 0, 0)))), 2)
    field_w = qt.rotate(run.motion.quat_ws, run.imu.mag_s_ut) - earth_field_w_ut(magnetics)
    moving = run.motion.speed_mps > 0.3
    assert np.ptp(field_w[resting(run)], axis=0).max() < 1e-9
    assert field_w[moving].std() == pytest.approx(15.0, rel=0.3)


def test_pressure_rises_by_9_81_kilopascals_for_each_metre_down():
    route = PipeRoute(((0.0, 0, 0), (60.0, 0, -5.0)))
    run = simulate(replace(with_imu(), route=route, drive=Drive(rest_start_s=1.0)), 1)
    head = run.imu.pressure_kpa + 0.002 * run.motion.chainage_m - run.imu.pressure_kpa[0]
    np.testing.assert_allclose(head, -9.81 * run.motion.position_w_m[:, 2], atol=1e-9)


def test_the_devices_own_quaternion_is_right_in_tilt_and_drifts_in_heading():
    run = simulate(with_imu(device_quaternion=True, device_quaternion_drift_radps=0.02), 2)
    up_s = qt.rotate_inverse(run.imu.quat_ws, np.array([0, 0, 1.0]))
    true_up_s = qt.rotate_inverse(run.motion.quat_ws, np.array([0, 0, 1.0]))
    tilt = np.degrees(np.arccos(np.clip(np.sum(up_s * true_up_s, axis=1), -1, 1)))
    assert 0.05 < tilt.mean() < 1.0
    assert np.degrees(qt.angle_between(run.imu.quat_ws[-1], run.motion.quat_ws[-1])) > 1.0
