"""The recursions: compiled as uncompiled, gradients and Jacobians against finite differences and known attitudes."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.orientation import kernels, kernels_ekf7
from processing.orientation import quaternions as qt
from processing.orientation.ekf7 import start_state

SEEDS = st.integers(0, 10_000)
UP = np.array([0.0, 0.0, 1.0])


def source_of(module):
    """Load a kernel's Python source beside its compiled form."""
    path = Path(qt.__file__).with_name(f"{module.__name__.rsplit('.', 1)[1]}.py")
    spec = importlib.util.spec_from_file_location("uncompiled", path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    assert not loaded.COMPILED
    return loaded


def readings(rows=200, seed=0):
    rng = np.random.default_rng(seed)
    return {
        "turn": 0.1 * rng.standard_normal((rows, 3)),
        "dt": np.full(rows, 0.01),
        "acc": UP + 0.3 * rng.standard_normal((rows, 3)),
        "acc_weight": rng.uniform(0.0, 1.0, rows).round(1),
        "mag": np.array([0.0, 0.5, -0.8]) + 0.1 * rng.standard_normal((rows, 3)),
        "mag_weight": rng.integers(0, 2, rows).astype(float),
    }


def run_integrate(module, r):
    state, out = np.array(qt.IDENTITY), np.empty((200, 4))
    module.integrate(r["turn"], state, out)
    return out


def run_madgwick(module, r):
    state, out = np.array(qt.IDENTITY), np.empty((200, 4))
    args = (r["turn"], r["dt"], r["acc"], r["acc_weight"], r["mag"], r["mag_weight"])
    module.madgwick(*args, 0.1, state, np.empty(8), out)
    return out


def run_mahony(module, r):
    state, out, bias = np.array([*qt.IDENTITY, 0.0, 0.0, 0.0]), np.empty((200, 4)), np.empty((200, 3))
    args = (r["turn"], r["dt"], r["acc"], r["acc_weight"], r["mag"], r["mag_weight"])
    module.mahony(*args, 0.5, 0.01, 0.2, 0.03, state, out, bias)
    return np.hstack([out, bias])


def run_ekf7(module, r):
    state = start_state(np.array(qt.IDENTITY), np.zeros(3), 1e-6 * np.eye(3))
    out, bias, scratch = np.empty((200, 4)), np.empty((200, 3)), np.empty(module.SCRATCH_SIZE)
    args = (r["turn"], r["dt"], r["acc"], r["acc_weight"], r["mag"], r["mag_weight"])
    module.ekf7(*args, 0.01, 1e-4, 0.1, 0.3, state, scratch, out, bias)
    return np.hstack([out, bias, np.broadcast_to(state, (200, 56))])


@pytest.mark.parametrize(
    ("run", "module"),
    [(run_integrate, kernels), (run_madgwick, kernels), (run_mahony, kernels), (run_ekf7, kernels_ekf7)],
    ids=["integrate", "madgwick", "mahony", "ekf7"],
)
def test_the_uncompiled_source_gives_the_same(run, module):
    if not module.COMPILED:
        pytest.skip("the kernels are not compiled here")
    np.testing.assert_allclose(run(source_of(module), readings()), run(module, readings()), rtol=1e-10, atol=1e-13)


@pytest.mark.parametrize("run", [run_madgwick, run_mahony])
def test_without_a_field_the_readings_of_the_field_do_not_matter(run):
    r = readings()
    without = {**r, "mag": np.zeros((0, 3)), "mag_weight": np.zeros(0)}
    zero = {**r, "mag_weight": np.zeros(200)}
    np.testing.assert_array_equal(run(kernels, without), run(kernels, zero))


def random_attitude(seed):
    rng = np.random.default_rng(seed)
    return qt.normalise(rng.standard_normal(4)), rng


def gradient_by_differences(f, q, step=1e-6):
    return np.array([(f(q + step * e) - f(q - step * e)) / (2.0 * step) for e in np.eye(4)]).T


def d_of(q):
    """Up as the sensor sees it, by the formula of the methods, whose value off the unit sphere counts too."""
    w, x, y, z = q
    return np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])


def north_of(q):
    w, x, y, z = q
    return np.array([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)])


@given(SEEDS)
def test_up_and_north_seen_by_the_sensor_are_rotations_of_the_worlds_axes(seed):
    q, _ = random_attitude(seed)
    np.testing.assert_allclose(d_of(q), qt.rotate_inverse(q, UP), atol=1e-12)
    np.testing.assert_allclose(north_of(q), qt.rotate_inverse(q, np.array([0.0, 1.0, 0.0])), atol=1e-12)


@given(SEEDS)
def test_madgwicks_gravity_gradient_is_that_of_its_objective(seed):
    q, rng = random_attitude(seed)
    a = qt.normalise(rng.standard_normal(4))[:3]
    out = np.empty(4)
    kernels.gravity_gradient(q, *a, out)
    expected = gradient_by_differences(lambda p: 0.5 * np.sum((d_of(p) - a) ** 2), q)
    np.testing.assert_allclose(out, expected, atol=1e-7)


@given(SEEDS)
def test_madgwicks_field_gradient_is_that_of_its_objective(seed):
    q, rng = random_attitude(seed)
    m, (north, up) = rng.standard_normal(3), rng.standard_normal(2)
    out = np.empty(4)
    kernels.field_gradient(q, *m, north, up, out)
    expected = gradient_by_differences(lambda p: 0.5 * np.sum((north * north_of(p) + up * d_of(p) - m) ** 2), q)
    np.testing.assert_allclose(out, expected, atol=1e-6)


@given(SEEDS)
def test_the_ekfs_accelerometer_jacobian_is_the_derivative(seed):
    q, _ = random_attitude(seed)
    jacobian = np.empty((3, 4))
    value = [kernels_ekf7.predicted_up(q, axis, jacobian[axis]) for axis in range(3)]
    np.testing.assert_allclose(value, d_of(q), atol=1e-14)
    np.testing.assert_allclose(jacobian, gradient_by_differences(d_of, q), atol=1e-8)


@given(SEEDS)
def test_the_ekfs_transition_is_the_exponential_map_and_its_jacobians_are_the_derivatives(seed):
    q, rng = random_attitude(seed)
    rate, bias, dt = 15.0 * rng.standard_normal(3), 0.01 * rng.standard_normal(3), 0.005

    def turned(q, b):
        return qt.multiply(q, qt.exp_map((rate - b) * dt))

    state, scratch = np.zeros(56), np.empty(kernels_ekf7.SCRATCH_SIZE)
    state[:4] = q
    kernels_ekf7.transition(state, *((rate - bias) * dt), dt, scratch)
    np.testing.assert_allclose(state[:4], turned(q, bias), atol=1e-12)
    by_q = gradient_by_differences(lambda p: turned(p, bias), q)
    by_b = np.array([(turned(q, bias + e) - turned(q, bias - e)) / 2e-5 for e in 1e-5 * np.eye(3)]).T
    np.testing.assert_allclose(scratch[56:72].reshape(4, 4), by_q, atol=1e-8)
    np.testing.assert_allclose(scratch[72:84].reshape(4, 3), by_b, atol=2e-3 * dt)


@given(SEEDS, st.floats(-3.0, 3.0))
def test_the_heading_innovation_undoes_a_turn_about_up_and_its_jacobian_counts_it(seed, yaw):
    q, _ = random_attitude(seed)
    field_s = qt.rotate_inverse(q, np.array([0.0, 25.0, -40.0]))
    turned = qt.multiply(qt.turn_about_up(yaw), q)
    jacobian = np.empty(4)
    assert kernels_ekf7.heading_innovation(turned, *field_s, jacobian) == pytest.approx(-yaw, abs=1e-9)
    assert kernels.heading_error(turned, *field_s) == pytest.approx(yaw, abs=1e-9)
    small = 1e-6
    step = qt.multiply(qt.turn_about_up(small), turned) - turned
    assert jacobian @ step == pytest.approx(small, rel=1e-5)
    for across in np.eye(3)[:2]:
        tilt = qt.multiply(qt.exp_map(small * across), turned) - turned
        assert jacobian @ tilt == pytest.approx(0.0, abs=1e-11)


def test_the_ekfs_covariance_stays_symmetric_positive_and_without_a_part_along_q():
    r = readings(seed=5)
    state = start_state(np.array(qt.IDENTITY), np.zeros(3), 1e-6 * np.eye(3))
    out, bias, scratch = np.empty((200, 4)), np.empty((200, 3)), np.empty(kernels_ekf7.SCRATCH_SIZE)
    for _ in range(50):
        args = (r["turn"], r["dt"], r["acc"], r["acc_weight"], r["mag"], r["mag_weight"])
        kernels_ekf7.ekf7(*args, 0.01, 1e-4, 0.1, 0.3, state, scratch, out, bias)
    covariance = state[7:].reshape(7, 7)
    np.testing.assert_array_equal(covariance, covariance.T)
    scale = np.trace(covariance)
    assert np.linalg.eigvalsh(covariance).min() > -1e-12 * scale
    np.testing.assert_allclose(covariance[:, :4] @ state[:4], 0.0, atol=1e-9 * scale)


def test_the_ekfs_sigma_is_that_of_its_errors():
    """Monte Carlo: with noises as told, squared errors over their predicted variances average to one."""
    rng = np.random.default_rng(7)
    rows, dt, gyr_noise, acc_noise, heading_noise = 400, 0.01, 0.005, 0.02, 0.05
    ratios = []
    for _ in range(60):
        q0 = np.array(qt.IDENTITY)
        turns = np.full((rows, 3), [0.02, -0.03, 0.05])
        truth = np.empty((rows, 4))
        kernels.integrate(turns, q0.copy(), truth)
        noisy = turns + gyr_noise * np.sqrt(dt) * rng.standard_normal((rows, 3))
        acc = qt.rotate_inverse(truth, UP) + acc_noise / np.sqrt(dt) * rng.standard_normal((rows, 3))
        yaw = heading_noise / np.sqrt(dt) * rng.standard_normal(rows)
        mag = qt.rotate_inverse(truth, qt.rotate(qt.turn_about_up(yaw), np.array([0.0, 0.5, -0.8])))
        off = qt.exp_map(np.radians(3.0) * rng.standard_normal(3))
        state = start_state(qt.multiply(q0, off), np.zeros(3), 1e-12 * np.eye(3))
        out, bias, scratch = np.empty((rows, 4)), np.empty((rows, 3)), np.empty(kernels_ekf7.SCRATCH_SIZE)
        ones = np.ones(rows)
        args = (noisy, np.full(rows, dt), acc, ones, np.ascontiguousarray(mag), ones)
        kernels_ekf7.ekf7(*args, gyr_noise, 1e-9, acc_noise, heading_noise, state, scratch, out, bias)
        error = out[-1] * np.sign(out[-1] @ truth[-1]) - truth[-1]
        variance = np.linalg.pinv(state[7:].reshape(7, 7)[:4, :4], rcond=1e-6)
        ratios.append(error @ variance @ error / 3.0)
    assert 0.7 < np.mean(ratios) < 1.4
