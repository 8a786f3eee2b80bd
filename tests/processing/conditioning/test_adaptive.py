"""The filters that find out about the noise themselves: from innovations, and by a bank of models."""

import numpy as np
import pytest
from channel_runs import random_walk
from scipy.stats import norm

from processing.conditioning.adaptive import adaptive, noise_over_time
from processing.conditioning.channel import readings
from processing.conditioning.kalman import kalman
from processing.conditioning.multiple_model import mix, multiple_model, run_bank, weigh_models
from processing.conditioning.noise import Noise
from processing.conditioning.settings import ConditioningSettings
from processing.conditioning.state_space import Model, ekf


@pytest.mark.parametrize("told", [Noise(0.1, 1.0), Noise(1.0, 1.0), Noise(0.1, 9.0)])
def test_both_variances_are_found_whatever_the_pilot_was_told(told):
    """True q 0.1, r 2; covariance matching alone (q = K² C0) would keep the told ratio."""
    _, values = random_walk(40_000, 0.1, 2.0, seed=1)
    q, r = noise_over_time(readings(values, 10.0), told, 40_000)
    assert np.median(r) == pytest.approx(2.0, rel=0.05)
    assert np.median(q) == pytest.approx(0.1, rel=0.25)


def test_noise_that_grows_fourfold_is_followed_to_near_the_optimum():
    true, values = random_walk(20_000, 0.02, 1.0, seed=2)
    values[10_000:] += np.random.default_rng(3).normal(0.0, np.sqrt(15.0), 10_000)
    data = readings(values, 50.0)
    _, r = noise_over_time(data, Noise(0.02, 1.0), 1000)
    assert np.median(r[:9000]) == pytest.approx(1.0, rel=0.1)
    assert np.median(r[11_000:]) == pytest.approx(16.0, rel=0.1)
    settings = ConditioningSettings(noise_sigma=1.0, wander_sigma=1.0)
    followed, held = (
        float(np.sqrt(np.mean((filtered(values, 50.0, settings).values - true)[11_000:] ** 2)))
        for filtered in (adaptive, kalman)
    )
    best = float(np.sqrt(Noise(0.02, 16.0).smoothed))
    assert followed < 1.25 * best
    assert held > 1.4 * best


def test_rows_in_a_hole_are_not_counted():
    _, values = random_walk(20_000, 0.1, 1.0, seed=4)
    valid = np.random.default_rng(5).random(20_000) > 0.1
    valid[8000:12_000] = False
    q, r = noise_over_time(readings(values, 50.0, valid), Noise(0.1, 1.0), 4000)
    assert np.isfinite(q).all()
    assert np.median(r) == pytest.approx(1.0, rel=0.1)


def test_the_bank_picks_the_model_that_made_the_data():
    models = [Noise(0.001, 1.0), Noise(0.1, 1.0), Noise(10.0, 1.0)]
    for right, model in enumerate(models):
        _, values = random_walk(2000, model.q, model.r, seed=right)
        *_, probabilities = run_bank(readings(values, 10.0), models, 0.0)
        np.testing.assert_allclose(probabilities.sum(axis=1), 1.0, atol=1e-6)
        assert probabilities[-1].argmax() == right
        assert probabilities[-1, right] > 0.99


def test_the_probabilities_are_bayes_rule_on_the_joint_density_of_all_readings():
    models, values = [Noise(0.2, 1.0), Noise(2.0, 0.5)], random_walk(12, 0.2, 1.0, seed=6)[1]
    *_, probabilities = run_bank(readings(values, 10.0), models, 0.0)
    differences, logs = np.diff(values), []
    for model in models:  # given the first reading, which starts the filter, the rest depend on differences alone
        covariance = model.q * np.eye(11) + model.r * (2.0 * np.eye(11) - np.eye(11, k=1) - np.eye(11, k=-1))
        sign, determinant = np.linalg.slogdet(covariance)
        assert sign > 0
        logs.append(-0.5 * (determinant + differences @ np.linalg.solve(covariance, differences)))
    expected = np.exp(logs - np.max(logs)) / np.exp(logs - np.max(logs)).sum()
    np.testing.assert_allclose(probabilities[-1], expected, rtol=1e-5)


def test_the_bank_follows_when_a_calm_channel_becomes_restless():
    _, calm = random_walk(3000, 1e-4, 1.0, seed=7)
    _, restless = random_walk(3000, 1.0, 1.0, seed=8)
    models = [Noise(1e-4, 1.0), Noise(1.0, 1.0)]
    values = np.concatenate([calm, calm[-1] + restless])
    *_, probabilities = run_bank(readings(values, 50.0), models, 1e-3)
    assert np.median(probabilities[500:3000, 0]) > 0.95
    assert np.median(probabilities[3100:, 1]) > 0.99


def test_a_channel_with_bursts_is_filtered_better_by_the_bank_than_by_one_model():
    rng = np.random.default_rng(9)
    steps = rng.normal(0.0, np.where(np.arange(8000) % 2000 < 1500, 0.01, 1.0))
    true = np.cumsum(steps)
    values = true + rng.standard_normal(8000)
    settings = ConditioningSettings(dwell_s=20.0, bank_span=1000.0)
    bank, one = (f(values, 50.0, settings).values - true for f in (multiple_model, kalman))
    assert np.mean(bank**2) < 0.9 * np.mean(one**2)


def test_models_given_as_functions_are_weighed_and_mixed():
    def decay(rate):
        one = np.eye(1)
        return Model(lambda x: rate * x, lambda x: x, 0.01 * one, 0.25 * one, lambda _: rate * one, lambda _: one)

    rng, x, values = np.random.default_rng(10), 10.0, []
    for _ in range(60):
        x = 0.9 * x + 0.1 * rng.standard_normal()
        values.append(x + 0.5 * rng.standard_normal())
    runs = [ekf(decay(rate), np.array(values), np.array([10.0]), np.eye(1)) for rate in (0.5, 0.9, 1.0)]
    probability = weigh_models(runs)
    assert probability[-1].argmax() == 1
    assert probability[-1, 1] > 0.99
    mean, covariance = mix(runs, probability)
    np.testing.assert_allclose(mean[-1], runs[1].mean[-1], atol=1e-2)
    assert covariance[0, 0, 0] > runs[1].covariance[0, 0, 0]  # where the models are in doubt, so is the mixture


def test_the_log_likelihood_is_the_normal_density_of_the_innovation():
    one = np.eye(1)
    model = Model(lambda x: x, lambda x: x, one, one, lambda _: one, lambda _: one)
    run = ekf(model, np.array([1.5]), np.zeros(1), one)
    assert run.log_likelihood[0] == pytest.approx(norm.logpdf(1.5, 0.0, np.sqrt(3.0)))
