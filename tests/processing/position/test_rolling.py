"""The rolling odometer against closed forms and noise-free runs."""

import numpy as np
import pytest
from position_runs import rolling_run

from processing.position.distance import places_at
from processing.position.registry import find_track
from processing.position.rolling import travel
from processing.settings import PositionSettings
from processing.survey import Attitude, Channel, DeviceInfo, ImuSamples, Launch, Motion, PipeInfo, Route, Survey

SETTINGS = PositionSettings()


def survey(heading_deg=90.0, radius_m=0.05, **more):
    return Survey(launch=Launch(heading_deg=heading_deg), device=DeviceInfo(radius_m=radius_m), **more)


def codes(track):
    return {finding.code for finding in track.findings}


def error_m(track, run):
    """Largest distance between track and truth, over the run."""
    truth = np.column_stack([np.interp(track.time_s, run.imu.time_s, c) for c in run.position_w_m.T])
    return np.linalg.norm(track.position_w_m - truth, axis=1).max()


def test_a_straight_run_ends_where_it_must():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0)
    track = find_track(run.imu, run.attitude, survey(), SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(100.0, abs=0.01)
    assert error_m(track, run) < 0.01
    assert track.method == "rolling"


def test_bends_stops_and_spin_keep_a_noise_free_path_within_a_centimetre_per_100_m():
    def curvature(s):  # two pipe bends of 90°, radius 0.5 m, the other way each, and a long sweep
        out = np.where((s > 20) & (s < 20 + 0.25 * np.pi), 2.0, 0.0)
        out = np.where((s > 45) & (s < 45 + 0.25 * np.pi), -2.0, out)
        return np.where((s > 60) & (s < 80), 0.02, out)

    run = rolling_run([(3.0, 40.0, 0.8), (50.0, 90.0, 1.2), (95.0, 130.0, 0.8)], 135.0, curvature, spin_radps=0.4)
    track = find_track(run.imu, run.attitude, survey(), SETTINGS)
    length = run.chainage_m[-1]
    assert abs(track.chainage_m[-1] - length) < 0.01 * length / 100.0
    assert error_m(track, run) < 0.01 * length / 100.0


def test_a_circle_closes():
    radius = 15.0
    around = 2 * np.pi * radius
    run = rolling_run([(2.0, 3.0 + around, 1.0)], around + 6.0, lambda s: np.full_like(s, 1.0 / radius))
    track = find_track(run.imu, run.attitude, survey(), SETTINGS)
    assert np.hypot(*track.position_w_m[-1, :2]) < 0.01
    assert track.position_w_m[:, 1].max() == pytest.approx(2 * radius, abs=0.02)


def test_spin_about_the_normal_moves_nothing():
    run = rolling_run([], 60.0, spin_radps=3.0)
    track = find_track(run.imu, run.attitude, survey(), SETTINGS)
    assert track.chainage_m[-1] < 1e-6
    assert np.abs(track.position_w_m).max() < 1e-6


def test_on_a_slope_the_chainage_is_the_length_of_the_pipe():
    run = rolling_run([(5.0, 56.0, 1.0)], 60.0, slope=0.1)
    track = find_track(run.imu, run.attitude, survey(), SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(50.0, abs=0.005)


def test_a_route_gives_a_slope_its_height():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0, slope=-0.05)
    tilt = np.arctan(-0.05)
    end = (120.0 * np.cos(tilt), 0.0, 120.0 * np.sin(tilt))
    track = find_track(run.imu, run.attitude, survey(route=Route(((0.0, 0.0, 0.0), end))), SETTINGS)
    assert error_m(track, run) < 0.01
    assert np.all(track.sigma_up_m == 0.5)


def test_an_unknown_radius_is_found_from_the_length():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0, radius_m=0.11)
    track = find_track(run.imu, run.attitude, survey(radius_m=None, pipe=PipeInfo(length_m=100.0)), SETTINGS)
    assert track.quality["radius_fitted_m"] == pytest.approx(0.11, rel=1e-3)
    assert track.chainage_m[-1] == pytest.approx(100.0, abs=0.1)
    assert "radius_fitted" in codes(track)


def test_an_unknown_radius_without_length_is_said_and_gives_a_wide_interval():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0, radius_m=0.06)
    track = find_track(run.imu, run.attitude, survey(radius_m=None), SETTINGS)
    assert "radius_unknown" in codes(track)
    assert places_at(track, [110.0]).high95_m[0] > 100.0


def test_without_any_direction_north_is_declared_unknown():
    run = rolling_run([(5.0, 26.0, 1.0)], 30.0)
    track = find_track(run.imu, run.attitude, survey(heading_deg=None), SETTINGS)
    assert "heading_unknown" in codes(track)
    assert track.sigma_cross_m[-1] > 20.0
    assert track.sigma_along_m[-1] < 2.0


def test_a_stated_heading_turns_the_path_and_the_attitude():
    run = rolling_run([(5.0, 26.0, 1.0)], 30.0, yaw0=2.0)
    track = find_track(run.imu, run.attitude, survey(heading_deg=180.0), SETTINGS)
    assert np.allclose(track.position_w_m[-1], [0.0, -20.0, 0.0], atol=0.01)
    turn = 2.0 * np.arctan2(track.quat_ws[:, 3], track.quat_ws[:, 0])
    before = 2.0 * np.arctan2(run.attitude.quat_ws[0, 3], run.attitude.quat_ws[0, 0])
    assert np.cos(turn[0] - before - (-0.5 * np.pi - 2.0)) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 400.0])
def test_any_sample_rate_gives_the_same_length(rate_hz):
    run = rolling_run([(2.0, 23.0, 0.5)], 25.0, rate_hz=rate_hz)
    assert find_track(run.imu, run.attitude, survey(), SETTINGS).chainage_m[-1] == pytest.approx(10.0, abs=0.001)


def test_the_rest_of_a_turning_world_adds_nothing():
    # half an hour of rest with the noise and the bias of a cheap gyro
    rng = np.random.default_rng(1)
    time_s = np.arange(1800 * 50) / 50.0
    gyr = np.radians(0.05) + np.radians(0.1) * rng.standard_normal((len(time_s), 3))
    imu = ImuSamples(time_s, np.tile([0.0, 0.0, 9.81], (len(time_s), 1)), gyr, np.ones(len(time_s), bool))
    still = Attitude(np.tile([1.0, 0, 0, 0], (len(time_s), 1)), np.zeros(3), "truth")
    assert find_track(imu, still, survey(), SETTINGS).chainage_m[-1] == 0.0


def test_rocking_at_a_joint_does_not_add_to_the_chainage():
    dt = 0.05
    time_s = np.arange(0, 200, dt)
    x = np.where(
        time_s < 50, time_s, np.where(time_s < 150, 50 + 0.1 * np.sin(2 * np.pi * (time_s - 50)), time_s - 100)
    )
    step = np.column_stack([np.diff(x), 0 * np.diff(x)])
    result = travel(step, np.abs(step[:, 0]), np.full(len(step), dt), 2.0)
    assert result.chainage_m[-1] == pytest.approx(time_s[-1] - 100.0, abs=0.25)
    assert result.back_m > 10.0


def test_rolling_back_holds_the_chainage_until_the_place_is_passed_again():
    dt = 0.05
    step_x = np.concatenate([np.full(200, 0.05), np.full(20, -0.05), np.full(100, 0.05)])
    step = np.column_stack([step_x, 0 * step_x])
    result = travel(step, np.abs(step_x), np.full(len(step), dt), 2.0)
    assert result.chainage_m[-1] == pytest.approx(14.0)
    assert np.all(np.diff(result.chainage_m) >= 0.0)
    assert np.ptp(result.chainage_m[200:241]) == pytest.approx(0.0)
    assert result.back_m == pytest.approx(1.0)


def test_an_out_and_back_way_counts_both_ways():
    # a cart that walks the stem of a T to its end and returns: 10 m back are no rolling back
    step_x = np.concatenate([np.full(200, 0.05), np.full(200, -0.05)])
    step = np.column_stack([step_x, 0 * step_x])
    assert travel(step, np.abs(step_x), np.full(400, 0.05), 2.0).chainage_m[-1] == pytest.approx(20.0)


def test_a_gap_is_bridged_reported_and_widens_the_interval():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0)
    keep = (run.imu.time_s < 40.0) | (run.imu.time_s > 45.0)
    imu = ImuSamples(run.imu.time_s[keep], run.imu.acc_s_mps2[keep], run.imu.gyr_s_radps[keep], run.imu.valid[keep])
    attitude = Attitude(run.attitude.quat_ws[keep], np.zeros(3), "truth")
    track = find_track(imu, attitude, survey(), SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(100.0, abs=0.05)
    (stretch,) = track.not_assessed
    assert (stretch.channel, stretch.reason) == (Channel.PATH, "imu_gap")
    assert (stretch.start_s, stretch.end_s) == pytest.approx((40.0, 45.0), abs=0.02)
    before, after = np.interp([39.9, 45.1], track.time_s, track.sigma_along_m)
    assert after > before + 3.0


def test_a_gap_of_hours_leads_not_far_and_says_that_nothing_is_known_after_it():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0)
    keep = (run.imu.time_s < 40.0) | (run.imu.time_s > 42.0)
    late = np.where(run.imu.time_s > 41.0, run.imu.time_s + 3 * 3600.0, run.imu.time_s)[keep]
    imu = ImuSamples(late, run.imu.acc_s_mps2[keep], run.imu.gyr_s_radps[keep], run.imu.valid[keep])
    attitude = Attitude(run.attitude.quat_ws[keep], np.zeros(3), "truth")
    track = find_track(imu, attitude, survey(), SETTINGS)
    assert 98.0 < track.chainage_m[-1] < 98.0 + 61.0
    assert track.sigma_along_m[-1] > 3 * 3600.0 * 0.9
    tied = find_track(imu, attitude, survey(pipe=PipeInfo(length_m=100.0)), SETTINGS)
    assert tied.chainage_m[-1] == pytest.approx(100.0, abs=0.5)
    assert tied.sigma_along_m[-1] < 1.0
    assert np.interp(39.0, tied.time_s, tied.sigma_along_m) < 1.0


def test_masked_rows_do_not_count():
    run = rolling_run([(5.0, 106.0, 1.0)], 110.0)
    broken = (run.imu.time_s > 60.0) & (run.imu.time_s < 61.0)
    gyr = run.imu.gyr_s_radps.copy()
    gyr[broken] = 1e4
    imu = ImuSamples(run.imu.time_s, run.imu.acc_s_mps2, gyr, ~broken)
    track = find_track(imu, run.attitude, survey(), SETTINGS)
    assert track.chainage_m[-1] == pytest.approx(100.0, abs=0.05)
    assert [s.reason for s in track.not_assessed] == ["imu_masked"]


def test_a_simulated_noise_free_ball_comes_back_within_a_centimetre_per_100_m():
    from processing.simulation.run import simulate
    from processing.simulation.surveys import noise_free

    made = simulate(noise_free(Motion.ROLLING), 0)
    length = made.motion.chainage_m[-1]
    attitude = Attitude(made.motion.quat_ws, np.zeros(3), "truth")
    track = find_track(made.imu, attitude, made.survey, SETTINGS)
    truth = np.column_stack([np.interp(track.time_s, made.motion.time_s, c) for c in made.motion.position_w_m.T])
    missed = np.abs(track.position_w_m - (truth - truth[0]))
    assert np.linalg.norm(missed[:, :2], axis=1).max() < 0.01 * length / 100.0
    assert missed[:, 2].max() < 0.1  # by pressure, which friction falsifies
    assert track.chainage_m[-1] == pytest.approx(length, abs=0.01)


@pytest.mark.parametrize(("stated_deg", "expected_deg", "disagrees"), [(96.0, 95.26, False), (130.0, 125.07, True)])
def test_a_stated_and_a_magnetic_heading_are_weighed_and_a_clash_is_told(stated_deg, expected_deg, disagrees):
    run = rolling_run([(5.0, 26.0, 1.0)], 30.0)  # to the east by its attitude; 8° and 3° are the default sigmas
    magnetic = Attitude(run.attitude.quat_ws, np.zeros(3), "truth", heading_from="magnetometer")
    track = find_track(run.imu, magnetic, survey(heading_deg=stated_deg), SETTINGS)
    east, north, _ = track.position_w_m[-1]
    assert np.degrees(np.arctan2(east, north)) == pytest.approx(expected_deg, abs=0.05)
    assert ("heading_disagrees" in codes(track)) == disagrees
