"""The scalar Kalman filter against the textbook recursion, its limit, and dense least squares."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from channel_runs import random_walk

from processing.conditioning import kalman as module
from processing.conditioning import kernels_conditioning as kernels
from processing.conditioning.channel import readings
from processing.conditioning.kalman import kalman, run
from processing.conditioning.noise import Noise
from processing.conditioning.settings import ConditioningSettings

CAUSAL = ConditioningSettings(noise_sigma=1.0, wander_sigma=1.0, phase="causal")
ZERO = ConditioningSettings(noise_sigma=1.0, wander_sigma=1.0)


def dense_posterior(values, valid, q, r):
    """Means and variances of the walk given all readings, by solving the normal equations of the whole record."""
    rows = len(values)
    steps = np.diff(np.eye(rows), axis=0)
    information = steps.T @ steps / q + np.diag(valid / r)
    covariance = np.linalg.inv(information)
    return covariance @ (np.where(valid, values, 0.0) / r), np.diag(covariance)


def test_the_smoother_is_the_least_squares_solution_of_the_whole_record_with_holes():
    _, values = random_walk(60, 0.3, 1.0, seed=1)
    valid = np.ones(60, dtype=bool)
    valid[[0, 1, 2, 20, 21, 22, 23, 58, 59]] = False
    mean, variance = run(readings(values, 10.0, valid), Noise(0.3, 1.0), zero_phase=True)
    expected_mean, expected_variance = dense_posterior(values, valid, 0.3, 1.0)
    np.testing.assert_allclose(mean, expected_mean, atol=1e-10)
    np.testing.assert_allclose(variance, expected_variance, rtol=1e-10)


def test_the_filter_is_the_least_squares_solution_of_the_record_so_far():
    _, values = random_walk(40, 0.3, 1.0, seed=2)
    mean, variance = run(readings(values, 10.0), Noise(0.3, 1.0), zero_phase=False)
    for k in (1, 5, 39):
        expected, expected_variance = dense_posterior(values[: k + 1], np.ones(k + 1, dtype=bool), 0.3, 1.0)
        assert mean[k] == pytest.approx(expected[-1])
        assert variance[k] == pytest.approx(expected_variance[-1])


def test_the_published_example_of_five_weighings_is_reproduced():
    """P2 table 3: five readings of an unmoving weight, with the gains 1, 1/2 … 1/5."""
    values = np.array([157.0, 145.0, 154.0, 160.0, 156.0])
    mean, _ = run(readings(values, 1.0), Noise(0.0, 1.0), zero_phase=False)
    np.testing.assert_allclose(mean, [157.0, 151.0, 152.0, 154.0, 154.4])


def test_the_constant_gain_pass_equals_the_recursion_to_the_last_digits():
    _, values = random_walk(5000, 0.01, 1.0, seed=3)
    data, q, r = readings(values + 1e5, 10.0), np.array([0.01]), np.array([1.0])
    mean, variance = np.empty(5000), np.empty(5000)
    kernels.kalman(data.values, np.ones(5000, dtype=np.uint8), q, r, mean, variance)
    fast_mean, fast_variance = run(data, Noise(0.01, 1.0), zero_phase=False)
    np.testing.assert_allclose(fast_mean, mean, rtol=1e-14)
    np.testing.assert_allclose(fast_variance, variance, rtol=1e-12)


def test_sigma_grows_by_the_wander_through_a_hole_and_the_value_stays():
    _, values = random_walk(2000, 0.1, 1.0, seed=4)
    values[1000:1400] = np.nan
    out = kalman(values, 10.0, CAUSAL)
    assert np.isfinite(out.values).all()
    np.testing.assert_array_equal(out.values[1000:1400], out.values[999])
    np.testing.assert_allclose(out.sigma[1000:1400] ** 2 - out.sigma[999] ** 2, 0.1 * np.arange(1, 401), rtol=1e-9)


def test_a_hole_at_the_start_is_held_backwards_with_growing_sigma():
    out = kalman(np.array([np.nan, np.nan, 5.0, 5.0]), 1.0, CAUSAL)
    np.testing.assert_array_equal(out.values, 5.0)
    np.testing.assert_allclose(out.sigma**2, [3.0, 2.0, 1.0, 2.0 / 3.0])


def test_the_smoother_leaves_a_peak_in_place_and_the_live_filter_moves_it():
    time_s = np.arange(2001) / 10.0
    bump = np.exp(-0.5 * ((time_s - 100.0) / 2.0) ** 2)
    assert np.argmax(kalman(bump, 10.0, ZERO).values) == 1000
    assert np.argmax(kalman(bump, 10.0, CAUSAL).values) >= 1003


def test_a_channel_that_never_changes_stays_what_it_is():
    np.testing.assert_allclose(kalman(np.full(100, 421.3), 10.0, ConditioningSettings()).values, 421.3)


def test_the_recursions_compute_the_same_compiled_and_from_source():
    spec = importlib.util.spec_from_file_location(
        "uncompiled", Path(module.__file__).with_name("kernels_conditioning.py")
    )
    source = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(source)
    assert not source.COMPILED
    _, values = random_walk(300, 0.1, 1.0, seed=5)
    valid = (np.random.default_rng(1).random(300) > 0.2).astype(np.uint8)
    valid[0] = 1
    q, r = np.full(300, 0.1), np.array([1.0])
    results = []
    for each in (kernels, source):
        mean, variance, sums, innovation = np.empty(300), np.empty(300), np.zeros(3), np.empty(300)
        each.kalman(values, valid, q, r, mean, variance)
        each.smooth(q, mean, variance)
        each.likelihood(values, valid, 0.1, sums)
        each.innovations(values, valid, 0.3, innovation)
        state, mixed, mixed_variance = np.zeros((4, 2)), np.empty(300), np.empty(300)
        state[2] = 0.5
        share, weight = np.empty((300, 2), dtype=np.float32), np.empty((300, 2))
        each.bank(values, valid, np.array([0.1, 1.0]), np.ones(2), 0.01, state, mixed, mixed_variance, share)
        each.weigh(np.ascontiguousarray(values.reshape(150, 2)), 0.01, weight[:150])
        results.append(
            np.concatenate(
                [mean, variance, sums, innovation, mixed, mixed_variance, share.ravel(), weight[:150].ravel()]
            )
        )
    np.testing.assert_allclose(results[0], results[1], rtol=1e-6, atol=1e-12)
