"""Double integration between standstills, on noise-free runs, closed forms and real walks."""

import numpy as np
import pytest
from position_runs import GRAVITY, bend, carried_run

from processing.position.inertial import arc_length
from processing.position.registry import find_track
from processing.position.stillness import find_stillness, resting_level, spans_of
from processing.settings import PositionSettings
from processing.survey import Attitude, DeviceInfo, ImuSamples, Launch, Motion, Survey

SETTINGS = PositionSettings()
CARRIED = Survey(launch=Launch(heading_deg=90.0), device=DeviceInfo(motion=Motion.CARRIED))


def path_error(track, run):
    truth = np.column_stack([np.interp(track.time_s, run.imu.time_s, c) for c in run.position_w_m.T])
    return np.linalg.norm(track.position_w_m - truth, axis=1).max()


def codes(track):
    return {finding.code for finding in track.findings}


def test_a_noise_free_carried_run_stays_within_a_centimetre_per_100_m():
    def curvature(s):
        return bend(s, 30.0, 0.5 * np.pi, 1.0) + bend(s, 70.0, -0.5 * np.pi, 2.0)

    run = carried_run([(3.0, 24.0, 1.0), (30.0, 51.0, 1.0), (60.0, 121.0, 1.0)], 125.0, curvature)
    track = find_track(run.imu, run.attitude, CARRIED, SETTINGS)
    length = run.chainage_m[-1]
    assert length == pytest.approx(100.0, abs=0.01)
    assert path_error(track, run) < 0.01 * length / 100.0
    assert track.chainage_m[-1] == pytest.approx(length, abs=0.05)


def test_a_slope_is_felt_by_a_carried_device():
    run = carried_run([(3.0, 24.0, 1.0)], 28.0, slope=0.3)
    track = find_track(run.imu, run.attitude, CARRIED, SETTINGS)
    assert path_error(track, run) < 0.005
    assert track.chainage_m[-1] == pytest.approx(run.chainage_m[-1], abs=0.03)


def test_smooth_travel_is_not_taken_for_a_standstill():
    # at constant speed the accelerometer feels just gravity: only the velocity gained before tells
    run = carried_run([(5.0, 65.0, 1.5)], 70.0)
    track = find_track(run.imu, run.attitude, CARRIED, SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(run.chainage_m[-1], abs=0.02)


def test_a_constant_accelerometer_error_is_taken_off_at_the_stops():
    run = carried_run([(3.0, 13.0, 1.0), (16.0, 26.0, 1.0)], 30.0, tremor=3.0)
    imu = ImuSamples(
        run.imu.time_s, run.imu.acc_s_mps2 + np.array([0.02, -0.03, 0.01]), run.imu.gyr_s_radps, run.imu.valid
    )
    track = find_track(imu, run.attitude, CARRIED, SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(run.chainage_m[-1], rel=0.005)
    ends = np.interp([29.9], track.time_s, track.speed_mps)
    assert ends[0] == pytest.approx(0.0, abs=1e-6)


def test_a_recording_that_ends_in_motion_says_so_and_widens():
    run = carried_run([(3.0, 40.0, 1.0)], 30.0, tremor=3.0)
    track = find_track(run.imu, run.attitude, CARRIED, SETTINGS)
    assert "moving_at_end" in codes(track)
    assert track.sigma_along_m[-1] > 1.0


def test_a_device_that_never_moved_has_no_path():
    run = carried_run([], 20.0)
    track = find_track(run.imu, run.attitude, CARRIED, SETTINGS)
    assert "never_moved" in codes(track)
    assert track.chainage_m[-1] == 0.0


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 400.0, 1000.0])
def test_standstills_are_found_at_any_sample_rate(rate_hz):
    rng = np.random.default_rng(3)
    time_s = np.arange(int(20 * rate_hz)) / rate_hz
    moving = (time_s > 5.0) & (time_s < 15.0)
    acc = GRAVITY + 0.02 * rng.standard_normal(len(time_s)) + moving * 3.0 * np.sin(2 * np.pi * 3.0 * time_s)
    gyr = np.radians(0.3 + moving * 60.0) * np.ones(len(time_s))
    found = find_stillness(time_s, acc, gyr, SETTINGS)
    wrong = np.mean(found.still == moving)
    assert wrong < 0.03
    assert found.gravity_mps2 == pytest.approx(GRAVITY, abs=0.01)
    assert len(spans_of(found.still)) == 2


def test_a_turning_device_is_not_still_although_its_acceleration_is():
    time_s = np.arange(1000) / 100.0
    found = find_stillness(time_s, np.full(1000, GRAVITY), np.full(1000, np.radians(90.0)), SETTINGS)
    assert not found.still.any()


def test_gravity_is_what_this_accelerometer_reads_at_rest():
    rng = np.random.default_rng(0)
    acc = 9.92 + 0.01 * rng.standard_normal(2000)
    acc[500:1800] += 4.0 * np.sin(np.arange(1300))
    assert resting_level(acc, np.zeros(2000), 100.0) == pytest.approx(9.92, abs=0.005)
    assert resting_level(acc + 3.0, np.zeros(2000), 100.0) == pytest.approx(9.80665)  # no sane level: standard gravity


def test_sway_and_steps_do_not_lengthen_the_way():
    time_s = np.arange(0.0, 60.0, 0.05)
    sway = 0.025 * 2 * np.pi * np.cos(2 * np.pi * time_s)
    bounce = 0.025 * 4 * np.pi * np.cos(4 * np.pi * time_s)
    velocity = np.column_stack([np.ones_like(time_s), sway, bounce])
    plain = np.sum(np.linalg.norm(velocity, axis=1)) * 0.05
    length = arc_length(time_s, velocity, np.ones(len(time_s), bool))[-1]
    assert plain > 61.0
    assert length == pytest.approx(59.95, rel=0.002)


def test_a_sharp_corner_is_not_cut():
    time_s = np.arange(0.0, 40.0, 0.05)
    east = (time_s < 20.0).astype(float)
    velocity = np.column_stack([east, 1.0 - east, 0.0 * east])
    assert arc_length(time_s, velocity, np.ones(len(time_s), bool))[-1] == pytest.approx(39.95, abs=0.02)


def walk(folder, name):
    table = np.loadtxt(folder / "gait_tracking" / f"{name}.csv", delimiter=",", skiprows=1)
    return ImuSamples(table[:, 0], table[:, 4:7] * GRAVITY, np.radians(table[:, 1:4]), np.ones(len(table), bool))


@pytest.mark.data
@pytest.mark.parametrize(("name", "published_m", "length_m"), [("short_walk", 0.082, 24.2), ("long_walk", 0.421, 59.9)])
def test_a_real_walk_in_a_loop_closes_within_one_and_a_half_percent(shared_data, name, published_m, length_m):
    from processing.orientation.registry import estimate_attitude
    from processing.progress import silent
    from processing.settings import OrientationSettings

    imu = walk(shared_data, name)
    survey = Survey(device=DeviceInfo(motion=Motion.FOOT))
    attitude, _, _ = estimate_attitude(imu, survey, OrientationSettings(), silent())
    track = find_track(imu, attitude, survey, SETTINGS)
    closure = float(np.linalg.norm(track.position_w_m[-1] - track.position_w_m[0]))
    print(f"{name}: closure {closure:.3f} m of {track.chainage_m[-1]:.1f} m, published {published_m} m")
    assert track.chainage_m[-1] == pytest.approx(length_m, rel=0.06)
    assert closure < 0.015 * length_m  # the published closures are tuned to these two walks: 0.34 and 0.70 %


def test_an_attitude_that_leans_into_each_push_does_not_shorten_the_way():
    # the filters do: here a lean of a degree towards the acceleration, gone at rest
    from processing.orientation import quaternions as qt

    run = carried_run([(3.0, 13.0, 1.0), (16.0, 26.0, 1.0)], 30.0, tremor=3.0)
    speed = np.gradient(run.chainage_m, run.imu.time_s)
    lean = qt.exp_map(np.column_stack([0 * speed, np.radians(1.0) * speed, 0 * speed]))
    leaning = Attitude(qt.multiply(lean, run.attitude.quat_ws), np.zeros(3), "made")
    track = find_track(run.imu, leaning, CARRIED, SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(run.chainage_m[-1], rel=0.003)
    assert path_error(track, run) < 0.05


def test_knocks_on_the_shell_move_nothing():
    run = carried_run([(8.0, 18.0, 1.0)], 22.0, tremor=3.0)
    acc = run.imu.acc_s_mps2.copy()
    for knock_s in (2.0, 3.0, 4.0, 5.0):
        acc[int(knock_s * 100) + np.arange(2), 2] += 12.0  # a clipped blow leaves a quarter of a metre per second
    imu = ImuSamples(run.imu.time_s, acc, run.imu.gyr_s_radps, run.imu.valid)
    track = find_track(imu, run.attitude, CARRIED, SETTINGS)
    assert np.interp(7.5, track.time_s, track.chainage_m) == pytest.approx(0.0, abs=1e-6)
    assert track.chainage_m[-1] == pytest.approx(run.chainage_m[-1], rel=0.003)


def test_a_bump_during_smooth_travel_is_no_standstill():
    run = carried_run([(5.0, 45.0, 1.0)], 50.0)
    acc = run.imu.acc_s_mps2.copy()
    for bump_s in (15.0, 25.0, 35.0):
        acc[int(bump_s * 100) + np.arange(4), 2] += np.array([8.0, -8.0, 8.0, -8.0])
    imu = ImuSamples(run.imu.time_s, acc, run.imu.gyr_s_radps, run.imu.valid)
    track = find_track(imu, run.attitude, CARRIED, SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(run.chainage_m[-1], abs=0.1)


def test_a_simulated_noise_free_carried_run_comes_back_within_a_centimetre_per_100_m():
    from processing.simulation.run import simulate
    from processing.simulation.surveys import noise_free

    made = simulate(noise_free(Motion.CARRIED), 0)
    length = made.motion.chainage_m[-1]
    attitude = Attitude(made.motion.quat_ws, np.zeros(3), "truth")
    track = find_track(made.imu, attitude, made.survey, SETTINGS)
    truth = np.column_stack([np.interp(track.time_s, made.motion.time_s, c) for c in made.motion.position_w_m.T])
    missed = np.abs(track.position_w_m - (truth - truth[0]))
    assert np.linalg.norm(missed[:, :2], axis=1).max() < 0.01 * length / 100.0
    assert missed[:, 2].max() < 0.1  # by pressure, which friction falsifies
    assert track.chainage_m[-1] == pytest.approx(length, abs=0.05)
