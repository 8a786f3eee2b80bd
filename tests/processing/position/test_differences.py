"""The interval of a length between two places is never smaller than the truth, whatever lies between them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.position.differences import difference_between
from processing.survey import Track


def track_of(time_s, chainage_m, sigma_m):
    count = len(time_s)
    place = np.column_stack([chainage_m, np.zeros(count), np.zeros(count)])
    quat = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    return Track(time_s, chainage_m, place, sigma_m, sigma_m, sigma_m, quat, np.ones(count), "test")


TIME_S = np.arange(0.0, 100.5, 0.5)
TRACK = track_of(TIME_S, 0.8 * TIME_S, 0.1 + 0.004 * TIME_S)


def test_length_time_and_speed_are_those_of_the_track():
    found = difference_between(TRACK, 10.0, 60.0)
    assert (found.metres, found.seconds) == (pytest.approx(40.0), 50.0)
    assert found.speed_mps == pytest.approx(0.8)
    assert found.half95_m == pytest.approx(1.959964 * np.sqrt(0.14**2 + 0.34**2))


@given(st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_the_order_of_the_ends_does_not_matter_and_nothing_is_negative(first_s, second_s):
    found = difference_between(TRACK, first_s, second_s)
    assert found == difference_between(TRACK, second_s, first_s) or np.isnan(found.speed_mps)
    assert min(found.metres, found.half95_m, found.seconds) >= 0.0


def test_a_place_is_no_distance_from_itself():
    found = difference_between(TRACK, 30.0, 30.0)
    assert (found.metres, found.half95_m) == (0.0, 0.0)
    assert np.isnan(found.speed_mps)


@pytest.mark.parametrize("known", [(0, 200), (0, 60, 130, 200), (100,)])
def test_independent_ends_are_an_upper_bound_for_a_path_that_wanders_between_known_places(known):
    """The exact covariance of a random walk that was read at some places, against the bound of the marginals."""
    count, step_m, read_m = len(TIME_S), 0.05, 0.3
    steps = np.tri(count) * step_m
    precision = np.linalg.inv(steps @ steps.T + 1e-9 * np.eye(count))
    for place in known:
        precision[place, place] += 1.0 / read_m**2
    exact = np.linalg.inv(precision)
    track = track_of(TIME_S, 0.8 * TIME_S, np.sqrt(np.diag(exact)))
    for first in range(0, count, 20):
        for second in range(first + 1, count, 13):
            true_m = 1.959964 * np.sqrt(exact[first, first] + exact[second, second] - 2.0 * exact[first, second])
            told_m = difference_between(track, TIME_S[first], TIME_S[second]).half95_m
            assert told_m >= true_m - 1e-9
