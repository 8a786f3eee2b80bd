"""Two searches that speak together: what they say of one place, and of places that only one of them hears."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.settings import DetectorSettings
from processing.sound.agreeing import HEARD_AT_LEAST, agreed, combined_probability
from processing.sound.spots import Spot
from processing.survey import LeakClass

SETTINGS = DetectorSettings()
shares = st.floats(0.0, 1.0)


def judged(place, score, width=2.0, leak_class=LeakClass.UNKNOWN, sigma=0.1):
    return Spot(place, sigma, width, score, 6.0, (500.0, 2000.0), {}), leak_class


@given(shares, shares, shares)
def test_more_probability_from_either_search_is_never_less_together(low, high, other):
    low, high = sorted((low, high))
    assert combined_probability(low, other, 2.0, 0.5) <= combined_probability(high, other, 2.0, 0.5)
    assert combined_probability(other, low, 2.0, 0.5) <= combined_probability(other, high, 2.0, 0.5)


def test_the_log_odds_are_weighed_and_what_is_too_narrow_for_a_leak_is_held_against_it():
    odds = 0.3 * math.log(0.6 / 0.4) + 0.7 * math.log(0.2 / 0.8) + 0.7
    assert combined_probability(0.6, 0.2, 2.0, 0.5) == pytest.approx(1 / (1 + math.exp(-odds)))
    assert combined_probability(0.6, 0.2, 0.4, 0.5) == pytest.approx(1 / (1 + math.exp(4.0 - odds)))
    assert combined_probability(0.6, 0.2, 0.6, 0.5) == pytest.approx(1 / (1 + math.exp(1.2 - odds)))


def test_a_place_that_both_hear_is_one_spot_where_the_search_in_metres_puts_it():
    (found, kind), *others = agreed([judged(50.0, 0.7)], [judged(52.5, 0.9)], SETTINGS)
    assert not others
    assert found.place == 50.0
    assert found.score == pytest.approx(combined_probability(0.7, 0.9, 2.0, 0.5))
    assert found.sigma > 0.1
    assert kind is LeakClass.LEAK


def test_a_place_that_one_search_hears_counts_less_and_none_is_listed_twice():
    found = agreed([judged(50.0, 0.9), judged(90.0, 0.3)], [judged(120.0, 0.9), judged(93.9, 0.2, 0.9)], SETTINGS)
    places = [spot.place for spot, _ in found]
    assert sorted(places) == [50.0, 90.0, 120.0]
    by_place = {spot.place: spot for spot, _ in found}
    assert by_place[50.0].score == pytest.approx(combined_probability(0.9, HEARD_AT_LEAST, 2.0, 0.5))
    assert by_place[120.0].score < 0.9
    assert all(a.score >= b.score for (a, _), (b, _) in pairwise(found))


def test_what_is_known_for_something_else_stays_so_unless_both_are_sure():
    valve = judged(50.0, 0.05, leak_class=LeakClass.VALVE)
    assert agreed([valve], [], SETTINGS)[0][1] is LeakClass.VALVE
    assert agreed([valve], [judged(50.0, 0.99)], SETTINGS)[0][1] is LeakClass.LEAK
