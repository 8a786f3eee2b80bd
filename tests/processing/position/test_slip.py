"""Where a ball does not roll: slides and turning on the spot are found by what is not felt; clean runs stay clean."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from processing.orientation.quaternions import exp_map, multiply
from processing.orientation.registry import estimate_attitude
from processing.position.registry import reckon
from processing.position.slip import find_slips
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.run import simulate
from processing.simulation.scenario import Ball, Drive, Imu, Joints, Knocks, PipeRoute, Scenario, Slide, Sound, Stop
from processing.survey import Attitude


@cache
def rolled(slides=(), stops=(), seed=1, gyro_range_radps=34.9, joints_m=0.0):
    """Simulate 60 m with a bend and a bump or two, and work out attitude and free path as the program does."""
    scenario = Scenario(
        name="slips",
        route=PipeRoute(((0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (30.0, 30.0, 0.3)), 1.2),
        drive=Drive(0.6, stops=stops),
        ball=Ball(0.0475, slip_sigma=0.01, spin_sigma_radps=0.3, slides=slides),
        imu=Imu(rate_hz=100.0, gyro_range_radps=gyro_range_radps),
        sound=Sound(enabled=False, joints=Joints(joints_m), knocks=Knocks(at_start=False, at_end=False)),
    )
    made = simulate(scenario, seed)
    attitude, _, _ = estimate_attitude(made.imu, made.survey, OrientationSettings(), silent())
    reckoned = reckon(made.imu, attitude, made.survey, PositionSettings(), silent())
    return made, attitude, reckoned


def slips_of(made, attitude, reckoned):
    return find_slips(made.imu, attitude, reckoned, silent())


def when(made, chainage_m):
    return float(np.interp(chainage_m, made.motion.chainage_m, made.motion.time_s))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_clean_run_with_stops_bends_and_joints_raises_no_alarm(seed):
    assert slips_of(*rolled((), (Stop(15.0, 5.0),), seed, joints_m=6.0)) == ()


@pytest.mark.parametrize(("from_m", "to_m"), [(12.0, 20.0), (22.0, 38.0)])  # the second goes round the bend
def test_a_slide_is_found_from_where_the_ball_lets_go_to_where_it_rolls_again(from_m, to_m):
    made, attitude, reckoned = rolled((Slide(from_m, to_m),))
    (span,) = slips_of(made, attitude, reckoned)
    assert span.reason == "slip_slid"
    assert span.start_s == pytest.approx(when(made, from_m), abs=2.0)
    assert span.end_s == pytest.approx(when(made, to_m), abs=2.0)
    missing = made.motion.chainage_m[-1] - reckoned.chainage_m[-1]
    assert missing > 0.8 * (to_m - from_m)
    assert missing < 2.0 * span.sigma_m


def test_a_ball_that_is_caught_and_turns_on_the_spot_is_found():
    made, attitude, reckoned = rolled((), (Stop(20.0, 12.0, spin_radps=10.0),))
    (span,) = slips_of(made, attitude, reckoned)
    assert span.reason == "slip_on_the_spot"
    inside = (made.motion.time_s > span.start_s) & (made.motion.time_s < span.end_s)
    assert np.median(made.motion.chainage_m[inside]) == pytest.approx(20.0, abs=0.3)
    too_much = reckoned.chainage_m[-1] - made.motion.chainage_m[-1]
    assert 3.0 < too_much < 2.0 * span.sigma_m


def test_an_honest_stop_is_no_slip_however_sudden():
    made, attitude, reckoned = rolled((), (Stop(20.0, 30.0), Stop(40.0, 0.5)))
    assert slips_of(made, attitude, reckoned) == ()


def test_knocks_on_a_resting_ball_are_no_slip():
    made, attitude, reckoned = rolled((), (Stop(20.0, 30.0),))
    acc = made.imu.acc_s_mps2.copy()
    rest = np.searchsorted(made.imu.time_s, when(made, 20.0) + 8.0)
    for k in range(6):  # 25 m/s² for two samples: half a metre a second that never was
        acc[rest + 130 * k : rest + 130 * k + 2] += [25.0, 0.0, 0.0]
    imu = dataclasses.replace(made.imu, acc_s_mps2=acc)
    assert find_slips(imu, attitude, reckoned, silent()) == ()


def test_rows_masked_at_the_gyros_limit_are_named_as_such():
    made, attitude, reckoned = rolled()
    rate = np.abs(made.imu.gyr_s_radps).max(axis=1)
    quick = (made.imu.time_s > 40.0) & (made.imu.time_s < 60.0)
    limit = np.radians(500.0)
    gain = np.where(quick, limit / np.percentile(rate[quick], 60.0), 0.8 * limit / rate.max())
    valid = ~(quick & (gain * rate > limit))
    gyr = np.clip(gain[:, None] * made.imu.gyr_s_radps, -limit, limit)
    imu = dataclasses.replace(made.imu, gyr_s_radps=gyr, valid=valid)
    assert 0.1 < np.mean(~valid[quick]) < 0.9
    spans = [s for s in find_slips(imu, attitude, reckoned, silent()) if s.reason == "slip_gyro_limit"]
    held = np.any([(imu.time_s >= s.start_s) & (imu.time_s <= s.end_s) for s in spans], axis=0)
    assert np.mean(held[~valid]) > 0.95
    assert np.mean(held & ((imu.time_s < 38.5) | (imu.time_s > 61.5))) == 0.0


def test_an_attitude_that_lost_gravity_is_found():
    made, attitude, reckoned = rolled()
    late = made.imu.time_s > 60.0
    tilt = np.where(late[:, None], [np.radians(60.0), 0.0, 0.0], np.zeros(3))
    lost = Attitude(multiply(exp_map(tilt), attitude.quat_ws), attitude.bias_radps, "made")
    spans = [s for s in find_slips(made.imu, lost, reckoned, silent()) if s.reason == "slip_attitude_lost"]
    assert len(spans) == 1
    assert spans[0].start_s == pytest.approx(60.0, abs=3.5)
    assert spans[0].end_s == pytest.approx(made.imu.time_s[-1], abs=3.5)
    assert spans[0].heading_sigma_rad > 0.1


def test_a_ball_that_spins_about_the_vertical_floats():
    made, attitude, reckoned = rolled()
    caught = (made.imu.time_s > 50.0) & (made.imu.time_s < 58.0)
    omega = np.where(caught[:, None], [0.0, 0.0, 8.0], made.imu.gyr_s_radps)
    acc = np.where(caught[:, None], [0.0, 0.0, 9.81], made.imu.acc_s_mps2)
    level = np.zeros((len(omega), 4))
    level[:, 0] = 1.0
    quat = np.where(caught[:, None], level, attitude.quat_ws)
    bias = np.where(caught[:, None], 0.0, np.broadcast_to(attitude.bias_radps, omega.shape))
    imu = dataclasses.replace(made.imu, gyr_s_radps=omega, acc_s_mps2=acc)
    spans = find_slips(imu, Attitude(quat, bias, "made"), reckoned, silent())
    spinning = [s for s in spans if s.reason == "slip_spinning"]
    assert len(spinning) == 1
    assert spinning[0].start_s == pytest.approx(50.0, abs=1.0)
    assert spinning[0].end_s == pytest.approx(58.0, abs=1.0)
