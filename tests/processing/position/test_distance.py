"""Time to chainage and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.position.distance import chainage_at, places_at, times_at
from processing.survey import Track


def make_track(time_s, chainage_m, sigma_m=1.0):
    time_s, chainage_m = np.asarray(time_s, float), np.asarray(chainage_m, float)
    n = len(time_s)
    sigma = np.full(n, sigma_m)
    position = np.column_stack([chainage_m, 0 * chainage_m, 0 * chainage_m])
    quat = np.tile([1.0, 0, 0, 0], (n, 1))
    return Track(time_s, chainage_m, position, sigma, sigma, sigma, quat, np.zeros(n), "made")


RESTED = make_track([0.0, 10.0, 20.0, 30.0], [0.0, 10.0, 10.0, 20.0])


def test_a_place_of_rest_is_reached_before_it_is_left():
    reached, left = times_at(RESTED, [5.0, 10.0, 15.0])
    assert np.allclose(reached, [5.0, 10.0, 25.0])
    assert np.allclose(left, [5.0, 20.0, 25.0])


def test_outside_the_track_its_ends_hold():
    reached, left = times_at(RESTED, [-3.0, 99.0])
    assert np.allclose(reached, [0.0, 30.0])
    assert np.allclose(left, [0.0, 30.0])
    assert np.allclose(chainage_at(RESTED, [-1.0, 31.0]), [0.0, 20.0])


def test_the_interval_is_1_96_sigma_and_never_below_the_launch():
    places = places_at(RESTED, [0.5, 25.0])
    assert places.low95_m[0] == 0.0
    assert places.high95_m[1] - places.low95_m[1] == pytest.approx(2 * 1.96, abs=0.001)
    assert np.allclose(places.position_w_m[1], [15.0, 0.0, 0.0])


@given(st.lists(st.floats(0.0, 5.0), min_size=2, max_size=20), st.floats(0.0, 1.0))
def test_the_way_from_chainage_to_time_and_back_ends_where_it_began(steps, part):
    track = make_track(np.arange(len(steps) + 1.0), np.concatenate([[0.0], np.cumsum(steps)]))
    wanted = part * track.chainage_m[-1]
    for time_s in times_at(track, [wanted]):
        assert chainage_at(track, time_s)[0] == pytest.approx(wanted, abs=1e-9)
