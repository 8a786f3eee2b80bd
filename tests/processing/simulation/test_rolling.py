"""A rolling ball against closed forms, against derivatives of the sensor's own path, and integrated back."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from processing.orientation import quaternions as qt
from processing.simulation.drive import DrivePlan
from processing.simulation.rolling import Rolling, roll
from processing.simulation.route import RoutePoints, SmoothRoute
from processing.simulation.run import simulate
from processing.simulation.scenario import Ball, Drive, Imu, Joints, Knocks, PipeRoute, Scenario, Sound, Stop
from processing.simulation.wander import constant

SILENT = Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False))
STEADY = Drive(speed_mps=0.8, variation=0.0, ramp_s=2.0, rest_start_s=2.0, rest_end_s=2.0)


class Circle:
    """A level circle of radius ``size``, run counter-clockwise: a route whose closed form is known."""

    def __init__(self, size):
        self.size, self.length_m = size, 1e9

    def points(self, s):
        a = s / self.size
        out = np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
        return RoutePoints(self.size * out, np.stack([-np.sin(a), np.cos(a), 0 * a], axis=1), -out / self.size)


def cruise(route, ball, spin=0.0, slip=0.0, sampling="instant", rate=200.0, start=(1.0, 0, 0, 0)):
    """Return the samples of a steady cruise at 0.8 m/s, and the plan."""
    plan = DrivePlan(STEADY, 20.0, np.random.default_rng(0))
    rolling = Rolling(ball, route, plan, constant(slip), constant(spin))
    motion = roll(rolling, rate, sampling, np.array(start, dtype=float))
    return motion, (motion.time_s > 5) & (motion.time_s < 20)


def test_rolling_east_without_slip_turns_about_north_at_v_over_r():
    motion, steady = cruise(SmoothRoute(np.array([[0.0, 0, 0], [50.0, 0, 0]]), 1.0), Ball(radius_m=0.05))
    turning_w = qt.rotate(motion.quat_ws, motion.gyr_s_radps)[steady]
    np.testing.assert_allclose(turning_w, np.tile([0.0, 0.8 / 0.05, 0.0], (len(turning_w), 1)), atol=1e-9)


def test_slip_slows_the_turning_and_spin_adds_a_turn_about_the_normal():
    route = SmoothRoute(np.array([[0.0, 0, 0], [50.0, 0, 0]]), 1.0)
    motion, steady = cruise(route, Ball(radius_m=0.05), spin=0.7, slip=0.1)
    turning_w = qt.rotate(motion.quat_ws, motion.gyr_s_radps)[steady]
    np.testing.assert_allclose(turning_w, np.tile([0.0, 0.9 * 0.8 / 0.05, 0.7], (len(turning_w), 1)), atol=1e-9)


def test_in_uniform_rolling_the_lever_arm_feels_only_its_centripetal_acceleration():
    arm = np.array([0.006, 0.003, -0.004])
    ball = Ball(radius_m=0.05, lever_arm_s_m=tuple(arm))
    motion, steady = cruise(SmoothRoute(np.array([[0.0, 0, 0], [50.0, 0, 0]]), 1.0), ball)
    gravity_s = qt.rotate_inverse(motion.quat_ws, np.array([0, 0, 9.81]))
    felt = np.linalg.norm(motion.force_s_mps2 - gravity_s, axis=1)[steady]
    axis = motion.gyr_s_radps[steady] / 16.0
    across = np.linalg.norm(arm - (axis @ arm)[:, None] * axis, axis=1)
    np.testing.assert_allclose(felt, 16.0**2 * across, rtol=1e-9)


def test_on_a_level_circle_the_ball_feels_v_squared_over_the_radius_towards_the_middle():
    motion, steady = cruise(Circle(3.0), Ball(radius_m=0.05, lever_arm_s_m=(0, 0, 0), bank=False))
    felt_w = qt.rotate(motion.quat_ws, motion.force_s_mps2)[steady]
    inward = -motion.position_w_m[steady] / 3.0
    np.testing.assert_allclose(felt_w, 0.8**2 / 3.0 * inward + [0, 0, 9.81], atol=1e-9)


def test_a_banking_ball_leans_so_that_the_contact_carries_the_whole_force():
    motion, steady = cruise(Circle(3.0), Ball(radius_m=0.05, lever_arm_s_m=(0, 0, 0), bank=True))
    felt_w = qt.rotate(motion.quat_ws, motion.force_s_mps2)[steady]
    turning_w = qt.rotate(motion.quat_ws, motion.gyr_s_radps)[steady]
    # no spin about the contact normal, which is the direction of the felt force
    np.testing.assert_allclose(np.sum(felt_w * turning_w, axis=1), 0.0, atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(turning_w, axis=1), 16.0, rtol=1e-9)


def test_on_a_slope_the_ball_turns_at_v_over_r_about_a_level_axis():
    route = SmoothRoute(np.array([[0.0, 0, 0], [40.0, 0, 8.0]]), 1.0)
    motion, steady = cruise(route, Ball(radius_m=0.04))
    turning_w = qt.rotate(motion.quat_ws, motion.gyr_s_radps)[steady]
    np.testing.assert_allclose(turning_w, np.tile([0.0, 20.0, 0.0], (len(turning_w), 1)), atol=1e-9)


def test_the_force_is_the_second_derivative_of_the_sensors_own_path():
    """Everything at once (bend, slope, spin, lever arm, Coriolis terms) against plain differences at 2 kHz."""
    scenario = Scenario(
        "differences",
        route=PipeRoute(((0.0, 0, 0), (3.0, 0, 0.1), (3.2, 4.0, -0.3))),
        drive=Drive(0.6, 0.1, 2.0, 1.0, 0.5, 0.5),
        ball=Ball(0.05, (0.006, -0.004, 0.003), slip=0.02, slip_sigma=0.02, slip_tau_s=2.0, spin_sigma_radps=0.8),
        imu=replace(Imu.perfect(2000.0), gyro_sampling="instant"),
        sound=SILENT,
    )
    run = simulate(scenario, 3)
    motion = run.motion
    sensor_w = motion.position_w_m + qt.rotate(motion.quat_ws, np.array(scenario.ball.lever_arm_s_m))
    acc_w = np.diff(sensor_w, 2, axis=0) * 2000.0**2
    felt_w = qt.rotate(motion.quat_ws, run.imu.acc_s_mps2)[1:-1] - [0, 0, 9.81]
    assert np.max(np.abs(acc_w)) > 1.0
    np.testing.assert_allclose(felt_w, acc_w, atol=2e-3)
    turn = Rotation.from_quat(motion.quat_ws, scalar_first=True)
    central = (turn[:-2].inv() * turn[2:]).as_rotvec() * 1000.0
    np.testing.assert_allclose(run.imu.gyr_s_radps[1:-1], central, atol=2e-3)


@pytest.mark.parametrize("rate_hz", [100.0, 200.0, 400.0])
def test_noise_free_rolling_integrates_back_to_less_than_a_centimetre_in_a_hundred_metres(rate_hz):
    scenario = Scenario(
        "back",
        route=PipeRoute(((0.0, 0, 0), (25.0, 0, 0), (25.0, 20.0, 0), (50.0, 30.0, 0), (10.0, 30.0, 0))),
        drive=Drive(0.9, stops=(Stop(40.0, 4.0),), rest_start_s=2.0, rest_end_s=2.0),
        ball=Ball(0.05, spin_sigma_radps=0.5, bank=False),  # banking is not in the simple model below
        imu=Imu.perfect(rate_hz),
        sound=SILENT,
    )
    run = simulate(scenario, 5)
    # an integration of its own: matrices, one sample after the other
    matrix = Rotation.from_quat(run.motion.quat_ws[0], scalar_first=True).as_matrix()
    steps = Rotation.from_rotvec(run.imu.gyr_s_radps / rate_hz).as_matrix()
    place, worst = np.zeros(3), 0.0
    for k in range(1, len(steps)):
        matrix = matrix @ steps[k]
        turned_w = matrix @ run.imu.gyr_s_radps[k] / rate_hz
        place += 0.05 * np.array([turned_w[1], -turned_w[0], 0.0])  # r ω × ẑ
        worst = max(worst, float(np.linalg.norm(place - run.motion.position_w_m[k])))
    assert worst < 0.01 * run.route.length_m / 100
    # and the attitude is the true one
    end = Rotation.from_quat(run.motion.quat_ws[-1], scalar_first=True).as_matrix()
    np.testing.assert_allclose(matrix, end, atol=1e-9)


def test_what_was_rolled_is_the_chainage_less_the_slip():
    scenario = Scenario(
        "slip",
        drive=Drive(rest_start_s=2.0, rest_end_s=2.0),
        ball=Ball(0.05, slip=0.03),
        imu=Imu.perfect(),
        sound=SILENT,
    )
    motion = simulate(scenario, 1).motion
    np.testing.assert_allclose(motion.rotation_rad * 0.05, 0.97 * motion.chainage_m, atol=1e-9)


def test_at_rest_the_sensor_feels_gravity_alone_and_does_not_turn():
    run = simulate(Scenario("rest", imu=Imu.perfect(), sound=SILENT), 2)
    rest = run.imu.time_s < 13.9
    gravity_s = qt.rotate_inverse(run.motion.quat_ws[rest], np.array([0, 0, 9.81]))
    np.testing.assert_allclose(run.imu.acc_s_mps2[rest], gravity_s, atol=1e-12)
    np.testing.assert_allclose(run.imu.gyr_s_radps[rest], 0.0, atol=1e-12)
