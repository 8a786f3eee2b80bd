"""The random-walk model: its steady state, the error of linear filters under it, and variances learnt from data."""

import numpy as np
import pytest
from channel_runs import random_walk
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.conditioning.channel import on_grid, readings
from processing.conditioning.noise import Noise, Weights, channel_noise, model_variance, steady_weights
from processing.conditioning.settings import ConditioningSettings
from processing.errors import ErrorCode, LeaklineError

VARIANCES = st.builds(Noise, st.floats(1e-4, 1e3), st.floats(1e-2, 1e3))


@settings(deadline=None)
@given(VARIANCES)
def test_the_steady_state_solves_the_riccati_equation(noise):
    p = noise.predicted
    assert p == pytest.approx(p - p * p / (p + noise.r) + noise.q, rel=1e-9)


def test_equal_variances_have_the_golden_gain():
    assert Noise(1.0, 1.0).gain == pytest.approx((np.sqrt(5.0) - 1.0) / 2.0, rel=1e-15)


@settings(deadline=None)
@given(VARIANCES)
def test_the_error_of_the_kalman_weights_is_the_riccati_solution(noise):
    alone = np.ones(1)
    assert model_variance(steady_weights(noise, alone, zero_phase=False), noise) == pytest.approx(noise.filtered)
    assert model_variance(steady_weights(noise, alone, zero_phase=True), noise) == pytest.approx(noise.smoothed)


@settings(deadline=None)
@given(st.integers(0, 1000))
def test_no_other_weights_beat_the_smoother(seed):
    noise = Noise(0.1, 1.0)
    other = (1.0 - noise.gain) ** np.abs(np.arange(-200, 201))
    other *= np.random.default_rng(seed).uniform(0.5, 1.5, 401)
    assert model_variance(Weights(other / other.sum(), 200), noise) > noise.smoothed


@pytest.mark.parametrize("zero_phase", [True, False])
def test_the_weights_in_a_row_with_taps_are_those_of_the_two_filters(zero_phase):
    noise, taps = Noise(0.05, 1.0), np.array([0.1, 0.2, 0.4, 0.2, 0.1])
    found = steady_weights(noise, taps, zero_phase=zero_phase)
    row = np.arange(-300, 301)  # negative: older than now
    alone = (1.0 - noise.gain) ** np.abs(row)
    alone = alone if zero_phase else np.where(row <= 0, alone, 0.0)
    whole = np.convolve(alone / alone.sum(), taps)
    place = 302 - found.now
    np.testing.assert_allclose(found.near, whole[place : place + 5], atol=1e-12)
    assert found.decay_old * found.near[0] == pytest.approx(whole[place - 1])
    assert found.decay_new * found.near[-1] == pytest.approx(whole[place + 5], abs=1e-12)


@pytest.mark.parametrize(("q", "r"), [(1e-3, 1.0), (0.1, 1.0), (4.0, 0.5)])
def test_the_variances_are_learnt_from_the_readings(q, r):
    _, values = random_walk(40_000, q, r, seed=1)
    found = channel_noise(readings(values + 1e5, 50.0), ConditioningSettings())
    assert found.r == pytest.approx(r, rel=0.1)
    assert found.q == pytest.approx(q, rel=0.2)


def test_a_given_variance_is_kept_and_the_other_is_learnt():
    _, values = random_walk(20_000, 0.02, 1.0, seed=2)
    data = readings(values, 50.0)
    by_reading = channel_noise(data, ConditioningSettings(noise_sigma=1.0))
    assert by_reading.r == pytest.approx(1.0)
    assert by_reading.q == pytest.approx(0.02, rel=0.2)
    by_wander = channel_noise(data, ConditioningSettings(wander_sigma=1.0))
    assert by_wander.q == pytest.approx(0.02, rel=1e-6)
    assert by_wander.r == pytest.approx(1.0, rel=0.05)


def test_a_long_channel_with_holes_is_learnt_from_pieces():
    _, values = random_walk(300_000, 0.01, 1.0, seed=3)
    valid = np.random.default_rng(0).random(300_000) > 0.3
    found = channel_noise(readings(values, 50.0, valid), ConditioningSettings())
    assert found.r == pytest.approx(1.0, rel=0.05)
    assert found.q == pytest.approx(0.01, rel=0.2)


def test_a_channel_without_two_readings_is_refused():
    with pytest.raises(LeaklineError) as caught:
        readings(np.array([np.nan, 1.0, np.inf]), 10.0)
    assert caught.value.code is ErrorCode.TOO_FEW_SAMPLES


def test_missing_rows_become_invalid_rows_of_an_even_grid():
    time_s = np.array([0.0, 0.1, 0.2001, 0.5, 0.6])
    data = on_grid(time_s, np.arange(5.0), np.array([True, True, True, True, False]))
    assert data.valid.tolist() == [True, True, True, False, False, True, False]
    assert data.values.tolist() == [0.0, 1.0, 2.0, 0.0, 0.0, 3.0, 0.0]
    assert data.sample_rate_hz == pytest.approx(10.0, rel=0.01)


def test_a_clock_that_jumps_by_years_costs_no_memory():
    with pytest.raises(LeaklineError) as caught:
        on_grid(np.array([0.0, 0.01, 0.02, 1e9]), np.zeros(4), np.ones(4, dtype=bool))
    assert caught.value.code is ErrorCode.FILE_TOO_LARGE
