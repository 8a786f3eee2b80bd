"""A level that swings: the swing is found, taken out, and nothing is made up where nothing swings."""

import numpy as np
import pytest
from channel_runs import random_walk

from processing.conditioning.channel import readings
from processing.conditioning.noise import Noise
from processing.conditioning.oscillation import MAX_ROWS, swing_of
from processing.conditioning.registry import condition
from processing.conditioning.settings import ConditioningSettings
from processing.errors import ErrorCode, LeaklineError

RATE = 10.0


def swinging(seed, rows=500, size=4.0, hz=0.9, drift=0.03):
    """A level that wanders, with a swing on it whose speed wanders too, and noise of 0.5."""
    rng = np.random.default_rng(seed)
    level = 400.0 + np.cumsum(rng.normal(0.0, 0.05, rows))
    speed = hz * (1.0 + drift * np.sin(2 * np.pi * np.arange(rows) / rows))
    phase = 2 * np.pi * np.cumsum(speed) / RATE
    return level, level + size * np.cos(phase) + rng.normal(0.0, 0.5, rows)


@pytest.mark.parametrize("name", ["ekf", "ukf"])
def test_a_swing_of_wandering_speed_is_taken_out_better_than_by_smoothing(name):
    settings = ConditioningSettings()
    ours, plain = [], []
    for seed in range(2):
        level, values = swinging(seed)
        ours.append(np.sqrt(np.mean((condition(name, values, RATE, settings).values - level) ** 2)))
        plain.append(np.sqrt(np.mean((condition("kalman", values, RATE, settings).values - level) ** 2)))
    assert np.mean(ours) < 0.25
    assert np.mean(ours) < 0.2 * np.mean(plain)


@pytest.mark.parametrize("name", ["ekf", "ukf"])
def test_its_sigma_is_the_error_that_is_made_and_smoothing_backwards_is_not_worse(name):
    runs = [swinging(seed) for seed in range(2)]
    rms = {}
    for phase in ("zero", "causal"):
        outs = [(level, condition(name, values, RATE, ConditioningSettings(phase=phase))) for level, values in runs]
        error = np.concatenate([(out.values - level)[100:] for level, out in outs])
        sigma = np.concatenate([out.sigma[100:] for _, out in outs])
        assert 0.6 < np.sqrt(np.mean(error**2) / np.mean(sigma**2)) < 1.5
        rms[phase] = np.sqrt(np.mean(error**2))
    assert rms["zero"] <= rms["causal"]


def test_speed_and_size_of_the_swing_are_found_and_noise_has_none():
    _, values = swinging(5, drift=0.0)
    hz, size, rest = swing_of(readings(values, RATE), Noise(0.01, 1.0))
    assert hz == pytest.approx(0.9, abs=0.01)
    assert size == pytest.approx(4.0, rel=0.1)
    assert rest[100:-100].std() < 0.5 * values.std()
    for seed in range(20):
        assert swing_of(readings(random_walk(900, 0.1, 1.0, seed)[1], RATE), Noise(0.1, 1.0))[:2] == (0.0, 0.0)


@pytest.mark.parametrize("name", ["ekf", "ukf"])
def test_where_nothing_swings_it_is_the_plain_filter(name):
    _, values = random_walk(600, 0.05, 1.0, seed=6)
    values[200:230] = np.nan
    settings = ConditioningSettings(noise_sigma=1.0, wander_sigma=float(np.sqrt(0.5)))
    ours, plain = (condition(each, values, RATE, settings) for each in (name, "kalman"))
    assert ours.figures["swing_hz"] == 0.0
    np.testing.assert_allclose(ours.values[10:], plain.values[10:], atol=1e-3)
    np.testing.assert_allclose(ours.sigma[10:], plain.sigma[10:], rtol=1e-3)


@pytest.mark.parametrize("name", ["ekf", "ukf"])
def test_holes_stay_finite_and_grow_in_doubt(name):
    _, values = swinging(7, rows=500)
    values[:3] = np.nan
    values[250:300] = np.nan
    out = condition(name, values, RATE)
    assert np.isfinite(out.values).all()
    assert out.sigma[275] > 1.5 * out.sigma[150]
    assert out.sigma[0] > out.sigma[3]


def test_a_channel_too_long_for_a_model_in_python_is_refused():
    with pytest.raises(LeaklineError) as caught:
        condition("ekf", np.zeros(MAX_ROWS + 1), 100.0)
    assert caught.value.code is ErrorCode.FILE_TOO_LARGE
