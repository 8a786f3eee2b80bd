"""The live path against truth and against the offline path on the same samples."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from position_runs import bend, carried_run, rolling_run

from processing.live.live_path import LivePath
from processing.live.path_history import WIDTH, PathHistory, RowStore
from processing.live.rolling_steps import Travel
from processing.orientation.registry import estimate_attitude
from processing.position.odometry import Odometry
from processing.position.registry import find_track
from processing.position.rolling import travel
from processing.progress import silent
from processing.settings import Settings
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.survey import DeviceInfo, ImuSamples, Launch, Motion, Survey, TiePoint

ROLLING = Survey(launch=Launch(heading_deg=90.0), device=DeviceInfo(Motion.ROLLING, 0.05))
OFFSET = np.radians([0.4, -0.6, 0.3])


def rows_of(imu, rows):
    return ImuSamples(imu.time_s[rows], imu.acc_s_mps2[rows], imu.gyr_s_radps[rows], imu.valid[rows])


def follow(imu, survey=ROLLING, block_s=0.1, until_s=np.inf, path=None, start_s=-np.inf):
    """Feed the rows of start_s ≤ t < until_s in blocks."""
    path = path or LivePath(survey)
    first, last = np.searchsorted(imu.time_s, [start_s, until_s]).tolist()
    width = max(1, round(block_s / float(np.median(np.diff(imu.time_s)))))
    for a, b in pairwise([*range(first, last, width), last]):
        path.add(rows_of(imu, slice(a, b)))
    return path


def with_offset(imu, seed=0):
    rng = np.random.default_rng(seed)
    gyr = imu.gyr_s_radps + OFFSET + rng.normal(0.0, 0.002, imu.gyr_s_radps.shape)
    acc = imu.acc_s_mps2 + rng.normal(0.0, 0.02, imu.acc_s_mps2.shape)
    return ImuSamples(imu.time_s, acc, gyr, imu.valid)


def bent(s):
    return bend(s, 12.0, 0.5 * np.pi, 0.5) + bend(s, 25.0, -0.5 * np.pi, 0.5)


@pytest.fixture(scope="module")
def bent_run():
    run = rolling_run([(5.0, 30.0, 0.8), (38.0, 60.0, 1.0)], 64.0, bent, rate_hz=100.0)
    return replace(run, imu=with_offset(run.imu))


def test_a_rolling_ball_is_where_it_is_at_every_moment(bent_run):
    path, run = LivePath(ROLLING), bent_run
    for until in np.arange(6.0, 64.0, 2.0):
        follow(run.imu, until_s=until, path=path, start_s=until - 2.0 if until > 6.0 else 0.0)
        pose = path.pose()
        assert pose.survey_s == pytest.approx(until, abs=0.11)
        true = np.interp(pose.survey_s, run.imu.time_s, run.chainage_m)
        assert pose.chainage_m == pytest.approx(true, abs=0.06 + 0.002 * true)
        assert abs(pose.chainage_m - true) < 1.96 * pose.sigma_along_m + 0.06  # a block's way
    assert pose.is_still
    assert pose.is_calibrated
    assert np.hypot(*(np.array(pose.position_w_m) - run.position_w_m[-1])[:2]) < 0.3
    assert pose.heading_deg == pytest.approx(90.0, abs=3.0)


def test_at_rest_an_offset_of_the_gyro_is_no_way():
    n = 3000
    imu = ImuSamples(np.arange(n) / 100.0, np.tile([0.0, 0.0, 9.81], (n, 1)), np.zeros((n, 3)), np.ones(n, bool))
    pose = follow(with_offset(imu)).pose()
    assert pose.chainage_m < 0.01
    assert pose.is_still
    assert pose.is_calibrated
    assert pose.speed_mps == 0.0


def test_without_a_first_rest_there_is_a_pose_that_says_so(bent_run):
    path = follow(rows_of(bent_run.imu, slice(800, 2500)))
    assert path.pose() is not None
    assert not path.pose().is_calibrated
    way = bent_run.chainage_m[2499] - bent_run.chainage_m[800]
    assert path.pose().chainage_m == pytest.approx(way, rel=0.02)


def test_a_marker_moves_the_path_and_what_follows():
    run = rolling_run([(5.0, 60.0, 0.8)], 65.0, rate_hz=100.0, radius_m=0.0515)  # told 0.05: 3 % short
    path = follow(run.imu, until_s=30.0)
    before = path.pose()
    at = float(np.interp(30.0, run.imu.time_s, run.chainage_m))
    assert before.chainage_m == pytest.approx(at / 1.03, abs=0.1)
    path.mark(TiePoint("valve", 29.9, chainage_m=float(np.interp(29.9, run.imu.time_s, run.chainage_m)), sigma_m=0.05))
    follow(run.imu, until_s=32.2, path=path, start_s=30.0)
    marked = path.pose()
    true = np.interp(marked.survey_s, run.imu.time_s, run.chainage_m)
    assert abs(marked.chainage_m - true) < 0.3 < abs(before.chainage_m - at)
    assert marked.sigma_along_m < before.sigma_along_m
    end = follow(run.imu, path=path, start_s=32.2).pose()
    left = run.chainage_m[-1] - at
    assert abs(end.chainage_m - run.chainage_m[-1]) < 0.02 * left  # of 3 %: the scale was learnt too


def test_a_gap_is_marked_and_its_way_is_in_the_interval(bent_run):
    imu = bent_run.imu
    keep = (imu.time_s < 15.0) | (imu.time_s > 19.0)  # 3 m, at 0.8 m/s
    whole, holed = follow(imu, until_s=35.0), follow(rows_of(imu, keep), until_s=35.0)
    assert whole.polyline().gaps_s == ()
    ((start, end),) = holed.polyline().gaps_s
    assert (start, end) == pytest.approx((15.0, 19.0), abs=0.03)
    assert holed.pose().sigma_along_m > whole.pose().sigma_along_m + 1.0
    true = np.interp(35.0, imu.time_s, bent_run.chainage_m)
    assert abs(holed.pose().chainage_m - true) < 1.96 * holed.pose().sigma_along_m
    assert holed.pose().chainage_m == pytest.approx(true, abs=0.5)  # it went on as before


def test_however_the_samples_come_the_path_is_the_same(bent_run):
    usual = follow(bent_run.imu, until_s=20.0, block_s=0.1).pose()
    for block_s in (0.01, 0.31):
        other = follow(bent_run.imu, until_s=20.0, block_s=block_s).pose()
        true = [np.interp(p.survey_s, bent_run.imu.time_s, bent_run.chainage_m) for p in (usual, other)]
        assert other.chainage_m - true[1] == pytest.approx(usual.chainage_m - true[0], abs=0.06)


def test_a_run_longer_than_any_look_back_has_no_seam():
    run = rolling_run([(5.0, 520.0, 0.5)], 525.0, lambda s: bend(s, 60.0, 1.0, 2.0) + bend(s, 200.0, -2.0, 2.0),
                      rate_hz=50.0)  # fmt: skip
    path = follow(with_offset(run.imu), block_s=4.0)
    pose, line = path.pose(), path.polyline()
    assert pose.chainage_m == pytest.approx(run.chainage_m[-1], abs=0.5)
    assert np.hypot(*(np.array(pose.position_w_m) - run.position_w_m[-1])[:2]) < 3.0
    assert np.all(np.diff(line.chainage_m) >= 0.0)
    true = np.column_stack([np.interp(line.time_s, run.imu.time_s, axis) for axis in run.position_w_m.T])
    off = np.hypot(*(line.position_w_m - true)[:, :2].T)
    assert np.max(np.abs(np.diff(off))) < 0.1  # a seam would be a step


def test_rows_that_cannot_be_trusted_move_nothing(bent_run):
    imu = rows_of(bent_run.imu, slice(None))
    bad = np.random.default_rng(1).random(len(imu.time_s)) < 0.05
    spoilt = replace(imu, gyr_s_radps=np.where(bad[:, None], 1e6, imu.gyr_s_radps), valid=~bad)
    pose = follow(spoilt).pose()
    assert pose.chainage_m == pytest.approx(bent_run.chainage_m[-1], abs=0.15)


def test_a_launch_in_an_unknown_system_costs_the_map_and_not_the_path(bent_run):
    survey = replace(ROLLING, launch=Launch(east_m=1.0, north_m=2.0, crs="EPSG:999999", heading_deg=90.0))
    path = follow(bent_run.imu, survey, until_s=30.0)
    assert path.problem is not None
    assert path.pose().chainage_m == pytest.approx(np.interp(30.0, bent_run.imu.time_s, bent_run.chainage_m), abs=0.15)


def test_what_a_rest_before_the_recording_told_is_known_from_its_first_moment(bent_run):
    monitored = follow(rows_of(bent_run.imu, slice(0, 480)))
    assert LivePath(ROLLING).calibration() is None
    path = LivePath(ROLLING, known=monitored.calibration())
    first, later = 700, 1400  # at full speed already
    follow(rows_of(bent_run.imu, slice(first, later)), path=path)
    pose = path.pose()
    assert pose.is_calibrated
    true = np.interp(pose.survey_s, bent_run.imu.time_s, bent_run.chainage_m) - bent_run.chainage_m[first]
    assert pose.chainage_m == pytest.approx(true, abs=0.06)


def test_a_path_sets_out_in_one_direction_however_short_it_still_is():
    """Two metres straight on, then bends: the first metres tell the direction, at whatever length one looks."""
    run = rolling_run([(5.0, 22.0, 0.8)], 25.0, lambda s: bend(s, 2.0, 0.5 * np.pi, 0.4) + bend(s, 4.0, -1.2, 0.4),
                      rate_hz=100.0, yaw0=0.0)  # fmt: skip
    path, errors = LivePath(ROLLING), []
    for until in np.arange(8.0, 25.0, 1.0):
        pose = follow(run.imu, path=path, until_s=until, start_s=until - 1.0 if until > 8.0 else -np.inf).pose()
        true = [np.interp(pose.survey_s, run.imu.time_s, axis) for axis in run.position_w_m.T]
        errors.append(float(np.hypot(pose.position_w_m[0] - true[0], pose.position_w_m[1] - true[1])))
    assert max(errors) < 0.25


def offline(imu, survey):
    settings = Settings()
    attitude, _, _ = estimate_attitude(imu, survey, settings.orientation, silent())
    return find_track(imu, attitude, survey, settings.position)


def test_live_and_offline_agree_on_a_simulated_main():
    made = simulate(load_scenario("rolling"), 3, quick=True)
    survey = replace(made.survey, tie_points=(), pipe=replace(made.survey.pipe, length_m=None))
    pose, track = follow(made.imu, survey, block_s=0.25).pose(), offline(made.imu, survey)
    assert pose.chainage_m == pytest.approx(track.chainage_m[-1], abs=0.15)
    assert np.hypot(*(np.array(pose.position_w_m) - track.position_w_m[-1])[:2]) < 0.6
    assert pose.sigma_along_m == pytest.approx(track.sigma_along_m[-1], rel=0.3)


def test_live_and_offline_agree_on_a_simulated_walk():
    made = simulate(load_scenario("walk-1"), 0, quick=True)
    survey = replace(made.survey, tie_points=(), pipe=replace(made.survey.pipe, length_m=None))
    pose, track = follow(made.imu, survey, block_s=0.25).pose(), offline(made.imu, survey)
    assert pose.chainage_m == pytest.approx(track.chainage_m[-1], abs=0.3)
    assert np.hypot(*(np.array(pose.position_w_m) - track.position_w_m[-1])[:2]) < 0.3


def test_a_carried_device_is_found_again_at_its_stops():
    run = carried_run([(5.0, 15.0, 0.8), (20.0, 32.0, 0.8)], 38.0, tremor=1.0)
    survey = Survey(launch=Launch(heading_deg=90.0), device=DeviceInfo(Motion.CARRIED))
    rng = np.random.default_rng(0)
    imu = replace(run.imu, acc_s_mps2=run.imu.acc_s_mps2 + rng.normal(0.0, 0.01, run.imu.acc_s_mps2.shape))
    path = LivePath(survey)
    for until in (19.0, 38.0):
        pose = follow(imu, survey, until_s=until, path=path, start_s=until - 19.0).pose()
        true = np.interp(until, imu.time_s, run.chainage_m)
        assert pose.chainage_m == pytest.approx(true, rel=0.03)


def test_the_polyline_leads_to_the_pose_and_says_when_it_is_new(bent_run):
    path = follow(bent_run.imu, until_s=25.0)
    first = path.polyline()
    assert np.all(np.diff(first.time_s) > 0.0)
    assert np.all(np.diff(first.chainage_m) >= 0.0)
    assert np.linalg.norm(first.position_w_m[-1] - path.pose().position_w_m) < 2.0 * 0.8 + 0.1  # two seconds' way
    assert path.polyline().version == first.version
    follow(bent_run.imu, until_s=28.0, path=path, start_s=25.0)
    assert path.polyline().version > first.version


def test_twelve_hours_of_way_stay_a_few_thousand_rows_spread_over_all_of_it():
    store = RowStore()
    for hour in range(12):
        rows = np.zeros((5000, WIDTH))
        rows[:, 0] = 3600.0 * hour + np.linspace(0.0, 3599.0, 5000)
        rows[:, 4] = 0.5 * rows[:, 0]
        rows[:, 1] = rows[:, 4]
        store.append(rows)
    assert len(store.rows) <= 3000
    assert store.rows[0, 0] == 0.0
    assert store.rows[-1, 0] == pytest.approx(12 * 3600.0 - 1.0)
    assert np.all(np.diff(store.rows[:, 0]) > 0.0)
    assert np.max(np.diff(store.rows[:, 0])) < 150.0


def test_a_rest_is_kept_as_its_two_ends():
    history = PathHistory()
    rows = np.zeros((100, WIDTH))
    rows[:, 0] = np.arange(100.0)
    history.extend_tail(rows)
    assert len(history) == 2
    assert history.last[0] == 99.0
    none = np.zeros(0)
    base = Odometry(none, np.zeros((0, 3)), none, none, np.zeros((0, 4)), none, none, none, none, 0.0, 0.0)
    np.testing.assert_array_equal(history.odometry(base).time_s, [0.0, 99.0])


@hypothesis_settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from([-1.0, 1.0]), st.integers(1, 60)), min_size=1, max_size=6))
def test_rolling_back_counts_as_after_the_run(pieces):
    """Pieces of steps of 5 cm forth or back; those back of more than two metres are turns of the pipe."""
    step = np.concatenate([np.full(count, 0.05 * sign) for sign, count in pieces])
    steps = np.column_stack([step, np.zeros(len(step))])
    causal = Travel(2.0)
    for row in steps:
        causal.add(row, 0.05, 0.05)
    expected = travel(steps, np.full(len(step), 0.05), np.full(len(step), 0.05), 2.0)
    assert causal.chainage_m == pytest.approx(expected.chainage_m[-1], abs=1e-9)
