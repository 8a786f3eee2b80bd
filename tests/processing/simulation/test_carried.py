"""A carried probe: its acceleration integrates back to its path, it faces the way it goes, it stands still at stops."""

import numpy as np
import pytest

from processing.orientation import quaternions as qt
from processing.simulation.run import simulate
from processing.simulation.scenario import Carried, Drive, Imu, Joints, Knocks, PipeRoute, Scenario, Sound, Stop
from processing.survey import Motion

SILENT = Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False))
WALK = Scenario(
    "walk",
    motion=Motion.CARRIED,
    route=PipeRoute(((0.0, 0, 0), (30.0, 0, 0), (30.0, 30.0, 1.0), (70.0, 40.0, 0.0))),
    drive=Drive(0.8, 0.1, 4.0, 1.5, 3.0, 3.0, (Stop(20.0, 3.0), Stop(55.0, 3.0))),
    carried=Carried(),
    imu=Imu.perfect(100.0),
    sound=SILENT,
)


def test_noise_free_carrying_integrates_back_to_less_than_a_centimetre_in_a_hundred_metres():
    run = simulate(WALK, 1)
    acc_w = qt.rotate(run.motion.quat_ws, run.imu.acc_s_mps2) - [0, 0, 9.81]
    velocity, place = np.zeros(3), run.motion.position_w_m[0].copy()
    worst = 0.0
    for k in range(1, len(acc_w)):
        faster = velocity + 0.01 * (acc_w[k - 1] + acc_w[k]) / 2
        place += 0.01 * (velocity + faster) / 2
        velocity = faster
        worst = max(worst, float(np.linalg.norm(place - run.motion.position_w_m[k])))
    assert worst < 0.01 * run.route.length_m / 100


def test_the_gyro_increments_integrate_to_the_attitude():
    run = simulate(WALK, 1)
    turns = qt.exp_map(run.imu.gyr_s_radps / 100.0)
    q = run.motion.quat_ws[0]
    for turn in turns[1:]:
        q = qt.multiply(q, turn)
    assert qt.angle_between(q, run.motion.quat_ws[-1]) < 1e-9


def test_a_probe_faces_the_way_it_goes_and_is_level_but_for_its_wobble():
    run = simulate(WALK, 1)
    moving = run.motion.speed_mps > 0.5
    tangent = run.route.points(run.motion.chainage_m).tangent_w[moving]
    forward = qt.rotate(run.motion.quat_ws[moving], np.array([1.0, 0, 0]))
    assert np.degrees(np.arccos(np.min(np.sum(tangent * forward, axis=1)))) < 2 * WALK.carried.wobble_deg


def test_at_a_stop_the_probe_is_still():
    run = simulate(WALK, 1)
    still = (run.motion.speed_mps == 0) & (np.abs(run.motion.chainage_m - 20.0) < 1e-9)
    assert still.sum() == pytest.approx(300, abs=3)
    np.testing.assert_allclose(np.linalg.norm(run.imu.acc_s_mps2[still], axis=1), 9.81, atol=1e-9)
    np.testing.assert_allclose(run.imu.gyr_s_radps[still][1:], 0.0, atol=1e-9)
