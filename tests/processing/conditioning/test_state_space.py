"""EKF and UKF: equal to the linear filter on linear models, consistent with the truth on a nonlinear one."""

import numpy as np
import pytest
from channel_runs import random_walk
from scipy.stats import chi2

from processing.conditioning.channel import readings
from processing.conditioning.kalman import run
from processing.conditioning.noise import Noise
from processing.conditioning.state_space import Model, ekf, smoothed, ukf

F, H = np.array([[1.0, 0.1], [-0.2, 0.95]]), np.array([[1.0, 0.0], [0.5, 1.0], [0.0, 2.0]])
LINEAR = Model(
    lambda x: F @ x, lambda x: H @ x, np.diag([0.01, 0.04]), np.diag([1.0, 2.0, 0.5]), lambda _: F, lambda _: H
)

STEP_S, G, LENGTH_M = 0.02, 9.81, 0.5


def pendulum():
    """Angle and rate of a pendulum, its bob's horizontal offset measured."""

    def f(x):
        return np.array([x[0] + STEP_S * x[1], x[1] - STEP_S * G / LENGTH_M * np.sin(x[0])])

    def f_jacobian(x):
        return np.array([[1.0, STEP_S], [-STEP_S * G / LENGTH_M * np.cos(x[0]), 1.0]])

    def h(x):
        return np.array([LENGTH_M * np.sin(x[0])])

    def h_jacobian(x):
        return np.array([[LENGTH_M * np.cos(x[0]), 0.0]])

    return Model(f, h, np.diag([1e-8, 1e-4]), np.array([[4e-4]]), f_jacobian, h_jacobian)


def textbook(z, mean, covariance):
    """The linear Kalman filter in information form, another algebra than the code's."""
    x, P, means = mean, covariance, []
    weight = H.T @ np.linalg.inv(LINEAR.R)
    for row in z:
        x, P = F @ x, F @ P @ F.T + LINEAR.Q
        information = np.linalg.inv(P) + weight @ H
        x = np.linalg.solve(information, np.linalg.solve(P, x) + weight @ row)
        P = np.linalg.inv(information)
        means.append(x)
    return np.array(means), P


@pytest.mark.parametrize("kappa", [0.0, 1.0])
def test_on_a_linear_model_both_are_the_kalman_filter(kappa):
    z = np.random.default_rng(1).standard_normal((50, 3))
    expected, last = textbook(z, np.ones(2), np.eye(2))
    for out in (ekf(LINEAR, z, np.ones(2), np.eye(2)), ukf(LINEAR, z, np.ones(2), np.eye(2), kappa=kappa)):
        np.testing.assert_allclose(out.mean, expected, atol=1e-10)
        np.testing.assert_allclose(out.covariance[-1], last, atol=1e-10)


def test_on_a_random_walk_both_are_the_channels_own_filter_holes_included():
    _, values = random_walk(200, 0.1, 1.0, seed=2)
    values[50:80] = np.nan
    mean, variance = run(readings(values, 10.0), Noise(0.1, 1.0), zero_phase=False)
    one = np.eye(1)
    model = Model(lambda x: x, lambda x: x, 0.1 * one, one, lambda _: one, lambda _: one)
    for function in (ekf, ukf):
        out = function(model, values[1:], mean[:1], variance[:1, None])
        np.testing.assert_allclose(out.mean[:, 0], mean[1:], atol=1e-12)
        np.testing.assert_allclose(out.covariance[:, 0, 0], variance[1:], rtol=1e-10)


@pytest.mark.parametrize("function", [ekf, ukf])
def test_on_a_pendulum_the_errors_are_as_large_as_the_covariance_says(function):
    model, start = pendulum(), np.diag([0.01, 0.04])
    runs, rows, nees, nis = 30, 150, [], []
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        x, truth, z = np.array([1.0, 0.0]), [], []
        for _ in range(rows):
            x = model.f(x) + np.sqrt(np.diag(model.Q)) * rng.standard_normal(2)
            truth.append(x)
            z.append(model.h(x) + 0.02 * rng.standard_normal(1))
        out = function(
            model, np.array(z), np.array([1.0, 0.0]) + np.sqrt(np.diag(start)) * rng.standard_normal(2), start
        )
        error = out.mean - np.array(truth)
        nees.append(np.einsum("ki,kij,kj->k", error, np.linalg.inv(out.covariance), error))
        nis.append(out.innovation[:, 0] ** 2 / out.innovation_covariance[:, 0, 0])
        assert np.abs(error[50:, 0]).max() < 0.1
    low, high = chi2.ppf([0.0005, 0.9995], 2 * runs) / runs
    assert low < np.array(nees).mean(axis=0)[-1] < high
    assert 1.6 < np.mean(nees) < 2.4
    low, high = chi2.ppf([0.0005, 0.9995], runs * rows) / (runs * rows)
    assert low < np.mean(nis) < high


def test_the_unscented_mean_of_a_square_is_exact_where_linearising_is_not():
    """z = x² with x ~ N(0, 1): mean 1, variance 2, which the UKF with kappa 2 finds; the EKF expects 0."""
    one = np.eye(1)
    model = Model(lambda x: x, lambda x: x**2, 0.0 * one, 0.1 * one, lambda _: one, lambda x: np.diag(2.0 * x))
    unscented = ukf(model, np.array([1.0]), np.zeros(1), one, kappa=2.0)
    assert unscented.innovation[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert unscented.innovation_covariance[0, 0, 0] == pytest.approx(2.1)
    assert ekf(model, np.array([1.0]), np.zeros(1), one).innovation[0, 0] == pytest.approx(1.0)


def test_an_ekf_without_jacobians_is_refused():
    one = np.eye(1)
    with pytest.raises(ValueError, match="Jacobians"):
        ekf(Model(lambda x: x, lambda x: x, one, one), np.zeros(3), np.zeros(1), one)


@pytest.mark.parametrize("function", [ekf, ukf])
def test_the_smoother_of_a_random_walk_is_the_channels_own(function):
    _, values = random_walk(150, 0.1, 1.0, seed=3)
    values[60:80] = np.nan
    expected, expected_variance = run(readings(values, 10.0), Noise(0.1, 1.0), zero_phase=True)
    one = np.eye(1)
    model = Model(lambda x: x, lambda x: x, 0.1 * one, one, lambda _: one, lambda _: one, takes_rows=True)
    mean, covariance = smoothed(function(model, values[1:], values[:1], one))
    np.testing.assert_allclose(mean[:, 0], expected[1:], atol=1e-9)
    np.testing.assert_allclose(covariance[:, 0, 0], expected_variance[1:], rtol=1e-9)


@pytest.mark.parametrize("function", [ekf, ukf])
def test_the_smoother_of_two_states_solves_the_whole_record_at_once(function):
    rng, rows = np.random.default_rng(4), 12
    z = rng.standard_normal((rows, 3))
    mean, covariance = smoothed(function(LINEAR, z, np.ones(2), np.eye(2)))
    # all states as one vector: start, steps and readings are its normal equations
    size = 2 * rows
    information, right = np.zeros((size, size)), np.zeros(size)
    first = np.linalg.inv(F @ F.T + LINEAR.Q)
    information[:2, :2] += first
    right[:2] += first @ F @ np.ones(2)
    weight, step = np.linalg.inv(LINEAR.R), np.linalg.inv(LINEAR.Q)
    for k in range(rows):
        at = slice(2 * k, 2 * k + 2)
        information[at, at] += H.T @ weight @ H
        right[at] += H.T @ weight @ z[k]
        if k:
            back = slice(2 * k - 2, 2 * k)
            information[at, at] += step
            information[back, back] += F.T @ step @ F
            information[at, back] -= step @ F
            information[back, at] -= F.T @ step
    np.testing.assert_allclose(mean.ravel(), np.linalg.solve(information, right), atol=1e-9)
    np.testing.assert_allclose(covariance[5], np.linalg.inv(information)[10:12, 10:12], atol=1e-9)
