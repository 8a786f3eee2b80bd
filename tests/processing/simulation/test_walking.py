"""A walking foot: its sensors integrate back to its path, it is still while it stands, its strides are as stated."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from processing.simulation.run import simulate
from processing.simulation.scenario import Drive, Foot, Gait, Imu, PipeRoute, Scenario, Stop
from processing.simulation.scenario_file import from_mapping, to_mapping
from processing.simulation.scenarios import load_scenario
from processing.simulation.walks import (
    GAITS,
    circle_route,
    foot_circle,
    foot_square,
    foot_stairs,
    random_walk,
    square_route,
    stairs_route,
)
from processing.survey import Motion

G = np.array([0.0, 0.0, 9.81])


def perfect(scenario, rate_hz=200.0):
    """The same walk with a perfect sensor and soft feet."""
    gaits = tuple(replace(g, shock_mps2=0.0, drag_mps2=0.0) for g in scenario.foot.gaits)
    return replace(scenario, imu=Imu.perfect(rate_hz), foot=replace(scenario.foot, gaits=gaits))


def integrated(run):
    """A strapdown of its own: matrices and trapezoids, from the true start and without any standstill."""
    rate = run.scenario.imu.rate_hz
    start = Rotation.from_quat(run.motion.quat_ws[0], scalar_first=True).as_matrix()
    steps = Rotation.from_rotvec(run.imu.gyr_s_radps / rate).as_matrix()
    steps[0] = start
    matrices = np.empty_like(steps)
    matrix = np.eye(3)
    for k, turn in enumerate(steps):
        matrix = matrix @ turn
        matrices[k] = matrix
    acc_w = np.einsum("kij,kj->ki", matrices, run.imu.acc_s_mps2) - G
    velocity = np.vstack([np.zeros(3), np.cumsum(0.5 * (acc_w[1:] + acc_w[:-1]) / rate, axis=0)])
    way = np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) / rate, axis=0)
    return matrices, velocity, np.vstack([np.zeros(3), way]) + run.motion.position_w_m[0]


@pytest.mark.parametrize(
    "scenario",
    [
        replace(foot_square(), route=square_route(4.0, 1)),
        replace(foot_circle(), route=circle_route(2.5, 1)),
        replace(foot_stairs(), route=stairs_route(3, 1)),
        replace(random_walk(3), route=square_route(3.0, 2)),
    ],
    ids=lambda s: s.name,
)
def test_noise_free_sensors_integrate_back_to_the_true_path(scenario):
    run = simulate(perfect(scenario, 1000.0), 4)
    matrices, velocity, place = integrated(run)
    end = Rotation.from_quat(run.motion.quat_ws[-1], scalar_first=True).as_matrix()
    np.testing.assert_allclose(matrices[-1], end, atol=1e-9)
    assert np.ptp(run.motion.position_w_m, axis=0).max() > 2.0
    assert np.max(np.abs(velocity - run.motion.velocity_w_mps)) < 2e-3
    assert np.max(np.abs(place - run.motion.position_w_m)) < 5e-3  # trapezoids


def test_the_force_is_the_second_difference_of_the_path_and_the_rate_that_of_the_attitude():
    run = simulate(replace(perfect(foot_square(), 4000.0), drive=Drive(rest_start_s=1, rest_end_s=1),
                           route=PipeRoute(((0.0, 0, 0), (4.0, 0, 0), (4.0, 3.0, 0.4)), 0.4)), 1)  # fmt: skip
    acc_w = np.diff(run.motion.position_w_m, 2, axis=0) * 4000.0**2
    turn = Rotation.from_quat(run.motion.quat_ws, scalar_first=True)
    felt_w = turn[1:-1].apply(run.imu.acc_s_mps2[1:-1]) - G
    assert np.max(np.linalg.norm(acc_w, axis=1)) > 30.0
    np.testing.assert_allclose(felt_w, acc_w, atol=0.02)
    np.testing.assert_allclose(run.imu.gyr_s_radps[1:], (turn[:-1].inv() * turn[1:]).as_rotvec() * 4000.0, atol=1e-9)


def test_a_foot_that_stands_without_sway_does_not_move_and_one_that_rolls_turns_about_its_contact():
    scenario = perfect(foot_square())
    still = replace(scenario.foot, sway_deg=0.0, gaits=tuple(replace(g, creep_deg=0.0) for g in scenario.foot.gaits))
    run = simulate(replace(scenario, foot=still), 2)
    speed = np.linalg.norm(run.motion.velocity_w_mps, axis=1)
    flat = run.motion.flat & np.roll(run.motion.flat, 1) & np.roll(run.motion.flat, -1)
    assert speed[flat].max() < 1e-9
    assert speed.max() > 3.0
    # rolling off: the toe's contact rests while the sensor turns about it
    turn = Rotation.from_quat(run.motion.quat_ws, scalar_first=True)
    mounting = turn[0].inv() * Rotation.from_euler("z", -np.radians(still.toe_out_deg))  # it starts level, eastwards
    toe = run.motion.position_w_m - (turn * mounting).apply(still.from_toe_m)
    contact = np.linalg.norm(np.gradient(toe, axis=0) * 200.0, axis=1) < 1e-6
    rolling_off = contact & ~run.motion.flat & (speed > 0.1)
    strides = np.count_nonzero(np.diff(flat.astype(int)) == -1)
    assert rolling_off.sum() / 200.0 / strides == pytest.approx(
        GAITS["walk"].toe_share * GAITS["walk"].stride_s, rel=0.35
    )


def test_sway_moves_a_standing_foot_by_centimetres_a_second_and_a_resting_one_not_at_all():
    run = simulate(perfect(foot_square()), 2)
    speed = np.linalg.norm(run.motion.velocity_w_mps, axis=1)
    resting = (run.motion.time_s > 1.0) & (run.motion.time_s < 7.0)
    assert speed[resting].max() < 1e-9
    walking = run.motion.flat & (run.motion.time_s > 9.0) & (run.motion.time_s < run.motion.time_s[-1] - 8.0)
    assert 0.001 < np.median(speed[walking]) < 0.03


def test_walks_end_where_they_began_after_the_stated_way_in_strides_of_the_stated_length_and_time():
    run = simulate(perfect(foot_circle(), 100.0), 5)
    assert np.linalg.norm(run.motion.position_w_m[-1] - run.motion.position_w_m[0]) < 1e-6
    assert run.motion.chainage_m[-1] == pytest.approx(3 * 2 * np.pi * 5.0, rel=0.01)
    starts = run.motion.time_s[1:][np.diff(run.motion.flat.astype(int)) == -1]
    assert np.median(np.diff(starts)) == pytest.approx(1.08, rel=0.03)
    assert run.motion.chainage_m[-1] / len(starts) == pytest.approx(1.3, rel=0.03)
    radius = np.linalg.norm(run.motion.position_w_m[:, :2] - [0.0, 5.0], axis=1)
    assert np.abs(radius - 5.0 + 0.09).max() < 0.2


def test_stairs_go_up_and_down_by_their_height():
    run = simulate(perfect(foot_stairs()), 1)
    assert np.ptp(run.motion.position_w_m[:, 2]) == pytest.approx(8 * 0.34, abs=0.25)


def test_strikes_are_felt_at_the_end_of_each_swing_and_leave_the_path_as_it_was():
    scenario = replace(perfect(foot_square(), 400.0), route=square_route(5.0, 1))
    hard = replace(scenario, foot=replace(scenario.foot, gaits=(Gait(shock_mps2=100.0),)))
    soft, loud = simulate(scenario, 3), simulate(hard, 3)
    np.testing.assert_array_equal(soft.motion.position_w_m, loud.motion.position_w_m)
    blow = np.linalg.norm(loud.imu.acc_s_mps2 - soft.imu.acc_s_mps2, axis=1)
    strikes = np.array([b.time_s for b in loud.blows if b.kind == "step"])
    felt = np.array([blow[np.abs(loud.imu.time_s - t) < 0.02].max() for t in strikes[::3]])
    assert np.median(felt) == pytest.approx(100.0, rel=0.2)
    _, _, place = integrated(loud)
    assert np.max(np.abs(place - loud.motion.position_w_m)) < 0.3


def test_a_crawling_foot_scrapes_without_gaining_speed():
    crawl = Foot(gaits=(GAITS["crawl"],))
    rests = Drive(rest_start_s=2, rest_end_s=2)
    scenario = Scenario("crawl", Motion.FOOT, PipeRoute(((0.0, 0, 0), (12.0, 0, 0))), rests, foot=crawl,
                        imu=Imu.perfect(200.0), sound=foot_square().sound)  # fmt: skip
    run = simulate(scenario, 1)
    quiet = simulate(perfect(scenario, 200.0), 1)
    scraping = run.imu.acc_s_mps2 - quiet.imu.acc_s_mps2
    turn = Rotation.from_quat(run.motion.quat_ws, scalar_first=True)
    aloft = (run.motion.speed_mps > 0.3) & (np.linalg.norm(scraping, axis=1) > 0)
    assert scraping[aloft].std() > 1.0
    assert np.abs(np.cumsum(turn.apply(scraping), axis=0) / 200.0).max() < 0.3
    level = (
        turn[0].inv() * Rotation.from_euler("z", -np.radians(crawl.toe_out_deg)) * Rotation.from_euler("y", 55.0, True)
    )
    forward = (turn * level).apply([1.0, 0, 0])
    assert np.all(forward[:, 2] < -0.7)  # toes down all the way


def test_a_stop_on_the_way_is_a_long_rest():
    run = simulate(
        replace(perfect(foot_square()), drive=Drive(rest_start_s=2, rest_end_s=2, stops=(Stop(40.0, 5.0),))), 2
    )
    still = np.linalg.norm(run.motion.velocity_w_mps, axis=1) < 1e-9
    still &= (run.motion.chainage_m > 39.0) & (run.motion.chainage_m < 43.0)
    assert still.sum() / 200.0 == pytest.approx(5.0, abs=0.6)


@pytest.mark.parametrize("seed", range(30))
def test_random_walks_are_valid_repeatable_and_survive_a_file(seed):
    scenario = random_walk(seed)
    assert scenario == load_scenario(f"walk-{seed}")
    assert from_mapping(to_mapping(scenario)) == scenario


def test_random_walks_differ_in_gait_shape_and_sensor():
    walks = [random_walk(seed) for seed in range(60)]
    assert {g.base_pitch_deg for w in walks for g in w.foot.gaits} == {0.0, 55.0}
    assert len({round(g.stride_m, 6) for w in walks for g in w.foot.gaits}) > 60
    assert {w.imu.rate_hz for w in walks} == {100.0, 200.0, 400.0}


def test_a_gait_without_time_to_swing_is_refused():
    with pytest.raises(ValueError, match="swing"):
        from_mapping({"name": "x", "motion": "foot", "foot": {"gaits": [{"flat_share": 0.6, "toe_share": 0.35}]}})
