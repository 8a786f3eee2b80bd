"""A map that fits itself but not the launch or the ties is found out, and an honest one is not."""

import dataclasses

import numpy as np
import pytest

from processing.position.bend_checks import Doubt, Known, denied_by, start_off

DOUBT = Doubt(scale=0.02, start_m=1.0, walk=0.13)
AT = np.array([60.0, 150.0, 260.0, 390.0, 500.0])


def bends(place_m, sigma_m=0.3):
    return Known(AT, place_m, np.full(len(AT), sigma_m), np.zeros(len(AT)))


def drawn(rng):
    """Offsets of the map from the odometer, drawn step by step: the start, the scale, a walk, each fix's own error."""
    steps = np.diff(np.concatenate([[0.0], AT]))
    walk = np.cumsum(DOUBT.walk * np.sqrt(steps) * rng.standard_normal(len(AT)))
    start = DOUBT.start_m * rng.standard_normal()
    return start, AT * (1.0 + DOUBT.scale * rng.standard_normal()) + start + walk + 0.3 * rng.standard_normal(len(AT))


def test_an_honest_map_is_doubted_as_rarely_as_its_sigmas_say():
    rng = np.random.default_rng(0)
    wrong, score = 0, []
    for _ in range(2000):
        _, place = drawn(rng)
        off, refused = start_off(bends(place), DOUBT)
        wrong += refused
        score.append(off)
    assert wrong <= 6  # 3.5 sigma: 0.05 % of 2000 is 1
    assert np.mean(score) == pytest.approx(0.0, abs=0.2)


def test_a_shift_is_measured_and_refused():
    off, refused = start_off(bends(AT - 15.0), DOUBT)
    assert off == pytest.approx(-15.0, abs=0.5)
    assert refused


def test_ties_deny_a_stretched_map_and_not_an_honest_one():
    tie = Known(np.array([560.0]), np.array([560.0]), np.array([0.5]), np.zeros(1))
    assert denied_by(bends(1.03 * AT), tie, DOUBT) == [True]
    assert denied_by(bends(AT), tie, DOUBT) == [False]


def test_what_was_lost_after_the_last_bend_excuses_a_tie():
    lost = Known(np.array([560.0]), np.array([575.0]), np.array([0.5]), np.array([64.0]))
    assert denied_by(bends(AT), dataclasses.replace(lost, lost_m2=np.zeros(1)), DOUBT) == [True]
    assert denied_by(bends(AT), lost, DOUBT) == [False]
