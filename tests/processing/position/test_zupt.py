"""The path of a sensor on a foot: simulated walks with their truth, gaps, and real walks that close."""

from dataclasses import replace

import numpy as np
import pytest

from processing.orientation.registry import estimate_attitude
from processing.position.registry import METHODS, choose_method, find_track
from processing.position.zupt import choose_detector, reckon
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.run import simulate
from processing.simulation.walks import foot_square, foot_stairs, square_route
from processing.survey import Attitude, DeviceInfo, ImuSamples, Motion, ProcessingChoice, Survey

GRAVITY = 9.80665
FOOT = Survey(device=DeviceInfo(motion=Motion.FOOT))
SETTINGS = PositionSettings()


@pytest.fixture(scope="module")
def square():
    """One round of an 8 m square, with sensor errors."""
    return simulate(replace(foot_square(), route=square_route(8.0, 1)), 3)


def attitude_of(imu):
    return estimate_attitude(imu, FOOT, OrientationSettings(), silent())[0]


def error(odometry, made):
    """Level and upward error (m,) after the best turn about up."""
    truth = np.column_stack([np.interp(odometry.time_s, made.motion.time_s, c) for c in made.motion.position_w_m.T])
    a, b = odometry.position_w_m[:, :2], (truth - truth[0])[:, :2]
    turn = np.vdot(a[:, 0] + 1j * a[:, 1], b[:, 0] + 1j * b[:, 1])
    found = (a[:, 0] + 1j * a[:, 1]) * turn / abs(turn)
    return np.abs(found - (b[:, 0] + 1j * b[:, 1])), odometry.position_w_m[:, 2] - (truth - truth[0])[:, 2]


@pytest.mark.parametrize("detector", ["auto", "shoe", "rate_energy", "lstm"])
def test_a_simulated_round_is_walked_within_one_percent(square, detector):
    chosen = replace(SETTINGS, zero_velocity_detector=detector)
    odometry = reckon(square.imu, attitude_of(square.imu), FOOT, chosen, silent())
    level, up = error(odometry, square)
    length = square.motion.chainage_m[-1]
    assert odometry.chainage_m[-1] == pytest.approx(length, rel=0.04)
    assert level.max() < 0.01 * length
    assert np.abs(up).max() < 0.02 * length
    assert odometry.quality["zero_velocity_detector"] == ("tcn" if detector == "auto" else detector)


def test_stairs_come_out_at_their_height():
    made = simulate(foot_stairs(), 1)
    odometry = reckon(made.imu, attitude_of(made.imu), FOOT, SETTINGS, silent())
    truth = np.interp(odometry.time_s, made.motion.time_s, made.motion.position_w_m[:, 2])
    assert np.ptp(truth) > 2.5
    assert np.abs(odometry.position_w_m[:, 2] - (truth - truth[0])).max() < 0.3


def test_the_odometry_keeps_its_contract(square):
    odometry = reckon(square.imu, attitude_of(square.imu), FOOT, SETTINGS, silent())
    assert np.all(np.diff(odometry.time_s) > 0.0)
    assert np.all(np.diff(odometry.chainage_m) >= 0.0)
    assert np.all(odometry.position_w_m[0] == 0.0)
    for variance in (odometry.along_var_m2, odometry.cross_var_m2, odometry.up_var_m2, odometry.heading_var_rad2):
        assert variance[0] == 0.0
        assert np.all(np.diff(variance) >= 0.0)
    assert np.allclose(np.linalg.norm(odometry.quat_ws, axis=1), 1.0)
    still = odometry.time_s < 7.0  # it stands for eight seconds first
    assert odometry.chainage_m[still].max() < 0.02


def test_a_hole_in_the_samples_is_not_assessed_and_widens(square):
    imu = square.imu
    valid = imu.valid.copy()
    middle = len(valid) // 2
    valid[middle : middle + int(1.0 / np.median(np.diff(imu.time_s)))] = False
    holed = ImuSamples(imu.time_s, imu.acc_s_mps2, imu.gyr_s_radps, valid)
    attitude = attitude_of(imu)
    whole, torn = (reckon(x, attitude, FOOT, SETTINGS, silent()) for x in (imu, holed))
    assert [s.reason for s in torn.not_assessed] == ["imu_masked"]
    assert np.all(np.isfinite(torn.position_w_m))
    assert whole.lost_var_m2 is None
    assert torn.lost_var_m2 is not None
    assert torn.lost_var_m2[-1] > 0.5


def test_whoever_never_moved_or_never_stood_is_told_so():
    count = 2000
    time_s = np.arange(count) / 200.0
    rng = np.random.default_rng(0)
    acc = np.array([0.0, 0.0, GRAVITY]) + 0.01 * rng.standard_normal((count, 3))
    gyr = 0.002 * rng.standard_normal((count, 3))
    attitude = Attitude(np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)), np.zeros(3), "made")
    still = reckon(ImuSamples(time_s, acc, gyr, np.ones(count, bool)), attitude, FOOT, SETTINGS, silent())
    assert {f.code for f in still.findings} == {"never_moved"}
    assert np.abs(still.position_w_m).max() < 0.02
    wild = ImuSamples(time_s, acc + 20.0 * rng.standard_normal((count, 3)), gyr + 5.0, np.ones(count, bool))
    lost = reckon(wild, attitude, FOOT, SETTINGS, silent())
    assert "no_stops" in {f.code for f in lost.findings}
    assert lost.along_var_m2[-1] > 1.0


def test_a_foot_is_reckoned_by_zero_velocities_and_p3s_method_stays_selectable():
    assert choose_method(FOOT) == ("zupt", "position_zupt")
    assert choose_method(replace(FOOT, processing=ProcessingChoice(position="inertial")))[0] == "inertial"
    assert choose_method(Survey(device=DeviceInfo(motion=Motion.CARRIED)))[0] == "inertial"
    assert METHODS["zupt"].reckon is reckon
    assert choose_detector(FOOT, SETTINGS) == "tcn"
    assert choose_detector(FOOT, replace(SETTINGS, zero_velocity_detector="shoe")) == "shoe"


def test_whoever_takes_it_for_a_carried_device_is_warned(square):
    carried = Survey(device=DeviceInfo(motion=Motion.CARRIED))
    odometry = reckon(square.imu, attitude_of(square.imu), carried, SETTINGS, silent())
    assert "zupt_not_on_foot" in {f.code for f in odometry.findings}
    assert odometry.quality["zero_velocity_detector"] == "butterworth"
    on_foot = reckon(square.imu, attitude_of(square.imu), FOOT, SETTINGS, silent())
    assert "zupt_not_on_foot" not in {f.code for f in on_foot.findings}


def loop(folder, name):
    table = np.loadtxt(folder / "gait_tracking" / f"{name}.csv", delimiter=",", skiprows=1)
    table = table[np.concatenate([[True], np.diff(table[:, 0]) > 0])]
    acc, gyr = table[:, 4:7] * GRAVITY, np.radians(table[:, 1:4])
    return ImuSamples(table[:, 0], acc, gyr, np.ones(len(table), bool))


@pytest.mark.data
@pytest.mark.parametrize(("name", "length_m"), [("short_walk", 24.2), ("long_walk", 59.9)])
def test_a_real_loop_closes_within_one_percent(shared_data, name, length_m):
    imu = loop(shared_data, name)
    odometry = reckon(imu, attitude_of(imu), FOOT, SETTINGS, silent())
    end = odometry.position_w_m[-1]
    assert odometry.chainage_m[-1] == pytest.approx(length_m, rel=0.06)
    assert np.hypot(*end[:2]) < 0.007 * length_m
    assert np.linalg.norm(end) < 0.01 * length_m


@pytest.mark.data
def test_the_interval_holds_a_real_walk_before_cameras(shared_data):
    folder = shared_data / "constrained_zupt_fgo"
    table = np.loadtxt(folder / "imuMeasRight.csv", delimiter=",", skiprows=1)
    truth = np.loadtxt(folder / "positionGt.csv", delimiter=",", skiprows=1)[:, 4:7] * [1.0, -1.0, -1.0]
    imu = ImuSamples(table[:, 0] / 60.0, table[:, 1:4], table[:, 4:7], np.ones(len(table), bool))
    track = find_track(imu, attitude_of(imu), FOOT, SETTINGS)
    path = np.column_stack([np.interp(imu.time_s, track.time_s, c) for c in track.position_w_m.T])
    a, b = path[:, :2] - path[:, :2].mean(0), truth[:, :2] - truth[:, :2].mean(0)
    turn = np.vdot(a[:, 0] + 1j * a[:, 1], b[:, 0] + 1j * b[:, 1])
    miss = np.abs((a[:, 0] + 1j * a[:, 1]) * turn / abs(turn) - (b[:, 0] + 1j * b[:, 1]))
    sigma = np.interp(imu.time_s, track.time_s, np.minimum(track.sigma_along_m, track.sigma_cross_m))
    assert np.mean(miss) < 0.2  # 66 m walked; published on it: 1.31 m filtered, 0.45 m as a factor graph
    assert np.mean(miss < 2.45 * np.maximum(sigma, 0.02)) > 0.9


def test_impacts_loosen_the_filter_by_the_same_factor_in_blocks_as_at_once(monkeypatch, square):
    from processing.position import zupt

    imu, index = square.imu, np.arange(len(square.imu.time_s))
    rows = np.arange(0, len(index), 7)
    whole = zupt._jolted(imu, index, rows, SETTINGS)
    monkeypatch.setattr(zupt, "BLOCK_ROWS", 501)
    assert np.allclose(zupt._jolted(imu, index, rows, SETTINGS), whole)
    k = int(np.argmax(whole[:, 0]))
    step = np.median(np.diff(imu.time_s))
    usual = (SETTINGS.foot_acc_noise, np.radians(SETTINGS.foot_gyr_noise_dps))
    for got, values, noise in zip(whole[k], (imu.acc_s_mps2, imu.gyr_s_radps), usual):
        change = np.diff(values[rows[k - 1] : rows[k] + 1], axis=0)
        lost = SETTINGS.foot_jolt_share**2 * np.sum(change**2) * step / 7.0  # a share of each, for a sample's time
        assert got == pytest.approx(np.sqrt(1.0 + lost / noise**2), rel=5e-3)


def test_an_absolute_heading_keeps_the_path_from_turning():
    count = 24_000  # two minutes of standing with a gyro that nobody has calibrated, read at 200 Hz
    time_s = np.arange(count) / 200.0
    acc = np.tile([0.0, 0.0, GRAVITY], (count, 1)) + 0.3 * np.sin(7.0 * time_s)[:, None]
    gyr = np.tile([0.0, 0.0, np.radians(0.2)], (count, 1)) + np.radians(60.0) * np.sin(7.0 * time_s)[:, None]
    imu = ImuSamples(time_s, acc, gyr, np.ones(count, bool))
    level = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    turned = [
        np.degrees(2.0 * np.abs(reckon(imu, a, FOOT, SETTINGS, silent()).quat_ws[-1, 3]))
        for a in (
            Attitude(level, np.zeros(3), "made"),
            Attitude(level, np.zeros(3), "made", heading_from="magnetometer"),
        )
    ]
    assert turned[0] > 15.0
    assert turned[1] < 0.6 * turned[0]  # a magnetic heading is weak, but does not drift


@pytest.mark.parametrize("gone_s", [1.1, 30.0])
def test_a_gap_amid_a_stride_does_not_throw_the_foot_away(square, gone_s):
    imu = square.imu
    late = imu.time_s + np.where(np.arange(len(imu.time_s)) > 0.45 * len(imu.time_s), gone_s, 0.0)
    imu = replace(imu, time_s=late)
    odometry = reckon(imu, attitude_of(imu), FOOT, SETTINGS, silent())
    assert odometry.chainage_m[-1] == pytest.approx(32.0, abs=4.0)


def test_what_lies_after_a_long_gap_is_known_no_better_than_a_walker_may_have_gone(square):
    imu = square.imu
    late = np.arange(len(imu.time_s)) > 0.45 * len(imu.time_s)
    imu = replace(imu, time_s=imu.time_s + np.where(late, 600.0, 0.0))
    odometry = reckon(imu, attitude_of(imu), FOOT, SETTINGS, silent())
    assert odometry.lost_var_m2 is not None
    assert np.sqrt(odometry.lost_var_m2[-1]) > 300.0  # half a metre a second
