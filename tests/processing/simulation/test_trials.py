"""The scenarios of the acceptance benchmarks are what they say."""

import numpy as np
import pytest

from processing.simulation.papers import P1_LOOPS
from processing.simulation.route import centre_line
from processing.simulation.run import simulate
from processing.simulation.trials import mems_loop, random_main


@pytest.mark.parametrize("number", P1_LOOPS)
def test_a_loop_that_is_two_metres_short_is_the_same_way_but_ends_two_metres_from_its_start(number):
    whole, short = centre_line(mems_loop(number).route), centre_line(mems_loop(number, 2.0).route)
    gap = np.diff(short.points(np.array([0.0, short.length_m])).position_w_m, axis=0)[0]
    assert np.linalg.norm(gap) == pytest.approx(2.0, abs=1e-6)
    assert 1.5 < whole.length_m - short.length_m < 5.5
    until = np.linspace(0.0, short.length_m - 2.0, 200)
    apart = whole.points(until).position_w_m - short.points(until).position_w_m
    assert np.linalg.norm(apart, axis=1).max() < 0.3  # corners next to a shortened side are a little tighter


def test_mains_have_their_length_bends_and_a_radius_told_wrong_by_one_per_cent():
    for seed in range(5):
        scenario = random_main(seed)
        line = centre_line(scenario.route)
        assert line.length_m == pytest.approx(1000.0, abs=1e-6)
        assert len(line.bends_m) >= 5
        assert abs(scenario.ball.told_radius_m / scenario.ball.radius_m - 1.0) == pytest.approx(0.01)


def test_a_resting_mems_gyro_shows_its_turn_on_bias_and_noise():
    scenario = random_main(0, length_m=20.0)
    runs = [simulate(scenario, seed, quick=True) for seed in range(30)]
    rest = [run.imu.gyr_s_radps[:1300] for run in runs]
    assert np.degrees(np.std([r.mean(axis=0) for r in rest])) == pytest.approx(0.2, rel=0.25)
    noise = np.mean([np.diff(r, axis=0).std() / np.sqrt(2) for r in rest])
    assert np.degrees(noise) == pytest.approx(0.01 * np.sqrt(100.0), rel=0.03)
