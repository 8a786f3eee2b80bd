"""The Kalman filters' recursions against their textbook forms in numpy, finite differences and closed forms.

Longer than 400 lines because the textbook forms of all three filters stand here in full, side by side.
"""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from processing.orientation import ekf7, ekf_gd, eskf, kernels_ekf7, kernels_ekf_gd, kernels_eskf, kernels_ukf, ukf
from processing.orientation import quaternions as qt
from processing.settings import OrientationSettings

SEEDS = st.integers(0, 10_000)
UP = np.array([0.0, 0.0, 1.0])
DIP = float(np.arctan2(0.8, 0.5))
NOISES = np.array([0.01, 1e-4, 0.05, 0.2, 0.003, 0.002, 0.14, 0.7, DIP, 0.2, 0.3, 0.03, 0.05])
EKF_NOISES = (0.01, 1e-4, 0.1, 0.3)


def readings(rows=150, seed=0, turn=0.1, shake=0.3):
    rng = np.random.default_rng(seed)
    return {
        "turn": turn * rng.standard_normal((rows, 3)),
        "dt": np.concatenate([[0.0], rng.uniform(0.008, 0.012, rows - 1)]),
        "acc": UP + shake * rng.standard_normal((rows, 3)),
        "acc_weight": np.append(rng.uniform(0.1, 1.0, rows - 1).round(1), 0.0)[rng.permutation(rows)],
        "mag": np.array([0.0, 0.5, -0.8]) + 0.05 * rng.standard_normal((rows, 3)),
        "mag_weight": rng.integers(0, 2, rows).astype(float),
    }


def args(r):
    return (r["turn"], r["dt"], r["acc"], r["acc_weight"], r["mag"], r["mag_weight"])


def start_q(seed=0):
    return qt.normalise(np.array([1.0, 0.05, -0.1, 0.2]) + 0.02 * np.random.default_rng(seed).standard_normal(4))


def run_eskf(module, r):
    n = len(r["dt"])
    state = eskf.start_state(start_q(), np.zeros(3), 1e-6 * np.eye(3))
    out, bias = np.empty((n, 4)), np.empty((n, 3))
    module.eskf(*args(r), NOISES, state, np.empty(module.SCRATCH_SIZE), out, bias)
    return out, bias, state


def run_ukf(module, r, noises=EKF_NOISES, q=None, sigma=None):
    n = len(r["dt"])
    state = ukf.start_state(start_q() if q is None else q, np.zeros(3), 1e-6 * np.eye(3))
    if sigma is not None:
        state[7:] = (np.eye(6) * sigma**2).ravel()
    out, bias = np.empty((n, 4)), np.empty((n, 3))
    module.ukf(*args(r), *noises, state, np.empty(module.SCRATCH_SIZE), out, bias)
    return out, bias, state


def run_ekf_gd(module, r, as_published=False, noise=0.02):
    n = len(r["dt"])
    state, out = ekf_gd.start_state(start_q()), np.empty((n, 4))
    gyr_noise = np.array([0.01, 0.02, 0.015])
    module.ekf_gd(*args(r), gyr_noise, noise, 2.0, as_published, state, np.empty(module.SCRATCH_SIZE), out)
    return out, np.zeros((n, 3)), state


@pytest.mark.parametrize(
    ("run", "module"), [(run_eskf, kernels_eskf), (run_ukf, kernels_ukf), (run_ekf_gd, kernels_ekf_gd)]
)
def test_the_uncompiled_source_gives_the_same(run, module):
    if not module.COMPILED:
        pytest.skip("the kernels are not compiled here")
    path = Path(qt.__file__).with_name(f"{module.__name__.rsplit('.', 1)[1]}.py")
    spec = importlib.util.spec_from_file_location("uncompiled", path)
    source = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(source)
    assert not source.COMPILED
    for r in (readings(), quiet()):
        for compiled, plain in zip(run(module, r), run(source, r), strict=True):
            np.testing.assert_allclose(plain, compiled, rtol=1e-9, atol=1e-13)


def quiet(rows=400):
    """Return readings that come to rest after the first second, slightly tilted."""
    r = readings(rows, seed=3)
    r["turn"][100:] *= 1e-4
    r["acc"][100:] = UP + 1e-3 * (r["acc"][100:] - UP)
    return r


# --- textbook forms ----------------------------------------------------------------------------------------------


def textbook_ekf_gd(r, gyr_noise, noise, alpha, *, as_published):
    """P3 §5.2, equation by equation, the transition exact and north along the second axis."""

    def objective(q, a, m):
        f = qt.rotate_inverse(q, UP) - a
        if m is None:
            return f
        h = qt.rotate(q_ref, m)
        b = np.array([0.0, np.hypot(h[0], h[1]), h[2]])
        return np.concatenate([f, qt.rotate_inverse(q, b) - m])

    def jacobian(q, b):
        """Derivatives of R(q)ᵀ b by q as the polynomials of eq. 5.33 and 5.39 have them."""
        w, x, y, z = q
        rows = {
            0: [[2 * 0, 0, -4 * y, -4 * z], [-2 * z, 2 * y, 2 * x, -2 * w], [2 * y, 2 * z, 2 * w, 2 * x]],
            1: [[2 * z, 2 * y, 2 * x, 2 * w], [0, -4 * x, 0, -4 * z], [-2 * x, -2 * w, 2 * z, 2 * y]],
            2: [[-2 * y, 2 * z, -2 * w, 2 * x], [2 * x, 2 * w, 2 * z, 2 * y], [0, -4 * x, -4 * y, 0]],
        }
        return sum(b[k] * np.array(rows[k], dtype=float) for k in rows)

    q = start_q()
    p = 0.25 * np.radians(3.0) ** 2 * (np.eye(4) - np.outer(q, q))
    out = []
    for k in range(len(r["dt"])):
        dt, (x, y, z) = r["dt"][k], r["turn"][k]
        f = expm(0.5 * np.array([[0, -x, -y, -z], [x, 0, z, -y], [y, -z, 0, x], [z, y, -x, 0]]))
        predicted = f @ q
        w0, x0, y0, z0 = predicted
        xi = np.array([[-x0, -y0, -z0], [w0, -z0, y0], [z0, w0, -x0], [-y0, x0, w0]])
        p = f @ p @ f.T + 0.25 * dt * xi @ np.diag(np.square(gyr_noise)) @ xi.T
        base = q_ref = q if as_published else predicted
        weight = max(r["acc_weight"][k], r["mag_weight"][k])
        if weight > 0.0 and dt > 0.0:
            gradient = np.zeros(4)
            if r["acc_weight"][k] > 0.0:
                a = r["acc"][k] / np.linalg.norm(r["acc"][k])
                gradient += jacobian(base, UP).T @ objective(base, a, None)
            if r["mag_weight"][k] > 0.0:
                m = r["mag"][k] / np.linalg.norm(r["mag"][k])
                h = qt.rotate(base, m)
                b = np.array([0.0, np.hypot(h[0], h[1]), h[2]])
                gradient += jacobian(base, b).T @ objective(base, np.zeros(3), m)[3:]
            step = alpha * 0.5 * np.linalg.norm(r["turn"][k])
            if not as_published:
                gradient -= gradient @ base * base
                step = min(step, np.linalg.norm(gradient) / 4.0)
            seen = qt.normalise(base - step * gradient / np.linalg.norm(gradient))
            gain = p @ np.linalg.inv(p + noise**2 / (dt * weight) * np.eye(4))
            predicted = predicted + gain @ (seen - predicted)
            p = p - gain @ p
        q = qt.normalise(predicted)
        if not as_published:
            n = np.eye(4) - np.outer(q, q)
            p = n @ p @ n
        out.append(q)
    return np.array(out), p


@pytest.mark.parametrize("as_published", [True, False])
def test_p3s_filter_is_its_equations(as_published):
    r = readings(80, seed=1)
    out, _, state = run_ekf_gd(kernels_ekf_gd, r, as_published)
    expected, covariance = textbook_ekf_gd(r, [0.01, 0.02, 0.015], 0.02, 2.0, as_published=as_published)
    np.testing.assert_allclose(out, expected, atol=1e-11)
    np.testing.assert_allclose(state[4:].reshape(4, 4), covariance, atol=1e-14)


def textbook_ukf(r, noises):
    """USQUE as Crassidis and Markley write it, a = 1, f = 4, λ = 1; all readings of a row in one correction."""
    gyr, walk, acc, heading = noises
    a, f, lam = 1.0, 4.0, 1.0

    def to_quaternion(p):
        square = p @ p
        w = (-a * square + f * np.sqrt(f * f + (1 - a * a) * square)) / (f * f + square)
        return np.array([w, *((a + w) * p / f)])

    q, x = start_q(), np.zeros(6)
    cov = np.diag([np.radians(3.0) ** 2] * 3 + [1e-6] * 3)
    out, biases = [], []
    for k in range(len(r["dt"])):
        dt = r["dt"][k]
        noise = 0.5 * dt * np.diag([gyr**2 - walk**2 * dt**2 / 6.0] * 3 + [walk**2] * 3)
        root = np.linalg.cholesky((6 + lam) * (cov + noise))
        points = np.array([x, *(x + root.T), *(x - root.T)])
        turned = [
            qt.multiply(qt.multiply(q, to_quaternion(p[:3])), qt.exp_map(r["turn"][k] - p[3:] * dt)) for p in points
        ]
        for p, t in zip(points, turned, strict=True):
            e = qt.multiply(qt.conjugate(turned[0]), t)
            p[:3] = f * e[1:] / (a + e[0])
        weights = np.full(13, 0.5 / (6 + lam))
        weights[0] = lam / (6 + lam)
        x = weights @ points
        cov = (points - x).T @ np.diag(weights) @ (points - x) + noise
        ups = qt.rotate_inverse(np.array(turned), UP)
        about_up = [qt.multiply(t, qt.conjugate(turned[0])) for t in turned]
        yaws = np.array([2.0 * np.arctan2(e[3], e[0]) for e in about_up])
        told, seen, variance = [], [], []
        if r["acc_weight"][k] > 0.0 and dt > 0.0:
            told += list(ups.T)
            seen += list(r["acc"][k])
            variance += [acc**2 / (dt * r["acc_weight"][k])] * 3
        if r["mag_weight"][k] > 0.0 and dt > 0.0:
            east, north, _ = qt.rotate(turned[0], r["mag"][k])
            told.append(yaws)
            seen.append(np.arctan2(east, north))
            variance.append(heading**2 / dt)
        if told:
            z = np.array(told)
            mean = z @ weights
            innovation = (z - mean[:, None]) @ np.diag(weights) @ (z - mean[:, None]).T + np.diag(variance)
            cross = (points - x).T @ np.diag(weights) @ (z - mean[:, None]).T
            gain = cross @ np.linalg.inv(innovation)
            x = x + gain @ (np.array(seen) - mean)
            cov = cov - gain @ innovation @ gain.T
        q = qt.normalise(qt.multiply(turned[0], to_quaternion(x[:3])))
        x[:3] = 0.0
        out.append(q)
        biases.append(x[3:].copy())
    return np.array(out), np.array(biases), cov


def test_the_unscented_filter_is_usque():
    r = readings(seed=2)
    out, bias, state = run_ukf(kernels_ukf, r)
    expected, biases, covariance = textbook_ukf(r, EKF_NOISES)
    np.testing.assert_allclose(out, expected, atol=1e-11)
    np.testing.assert_allclose(bias, biases, atol=1e-12)
    np.testing.assert_allclose(state[7:].reshape(6, 6), covariance, atol=1e-13)


def cross_matrix(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def textbook_eskf(r, n):
    """The error-state filter with full matrices; its state: q, bias, velocity, P, smoothed readings, quiet time."""
    q, bias, velocity = start_q(), np.zeros(3), np.zeros(3)
    cov = eskf.start_state(q, bias, 1e-6 * np.eye(3))[10:91].reshape(9, 9).copy()
    slow, since = None, 0.0
    out, biases = [], []
    for k in range(len(r["dt"])):
        dt = r["dt"][k]
        before = qt.to_matrix(q)
        q = qt.normalise(qt.multiply(q, qt.exp_map(r["turn"][k] - bias * dt)))
        rotation = qt.to_matrix(q)
        believed = r["acc_weight"][k] > 0.0
        force = kernels_eskf.GRAVITY_MPS2 * rotation @ r["acc"][k] if believed else np.zeros(3)
        if believed:
            velocity = velocity + (force - kernels_eskf.GRAVITY_MPS2 * UP) * dt
        if dt > 0.0:
            f = np.eye(9)
            f[:3, 3:6] = -0.5 * (before + rotation) * dt
            f[6:, :3] = -cross_matrix(force) * dt
            f[6:, 2] = 0.0  # the velocity turns with the heading
            acc = n[2] ** 2 / (r["acc_weight"][k] if believed else 1.0)
            cov = f @ cov @ f.T + dt * np.diag([n[0] ** 2] * 3 + [n[1] ** 2] * 3 + [acc] * 3)
            now = np.concatenate([r["turn"][k] / dt, r["acc"][k]])
            slow = now if slow is None else slow + dt / (0.5 + dt) * (now - slow)
            off = now - slow
            still = np.linalg.norm(off[:3]) < n[11] and np.linalg.norm(off[3:]) < n[12]
            still = still and np.all(np.abs(slow[:3] - bias) <= n[11])
            since = since + dt if still else 0.0
            error = np.zeros(9)
            rested = since > 1.5
            h = np.eye(9)[6:]
            error, cov = joint_update(error, cov, h, -velocity, (n[4] if rested else n[3]) ** 2 / dt)
            if rested:
                error, cov = joint_update(error, cov, np.eye(9)[3:6], r["turn"][k] / dt - bias, n[5] ** 2 / dt)
            if r["mag_weight"][k] > 0.0:
                field = rotation @ r["mag"][k]
                norm_off = abs(np.linalg.norm(field) - 1.0) / n[9]
                dip_off = abs(np.arctan2(-field[2], np.hypot(*field[:2])) - n[8]) / n[10]
                if norm_off < 1.0 and dip_off < 1.0:
                    yaw = np.arctan2(field[0], field[1])
                    variance = n[6] ** 2 * (1.0 + 4.0 * norm_off**2 + 16.0 * dip_off**2)
                    variance = max(variance, yaw**2 / 9.0 - cov[2, 2])  # at most 3 sigma off
                    variance *= n[7] ** 2 / dt
                    total = cov[2, 2] + variance
                    gain = np.zeros(9)
                    gain[2] = cov[2, 2] / total
                    gain[3:6] = np.outer(rotation[2], rotation[2]) @ cov[3:6, 2] / total
                    error = error + gain * (yaw - error[2])
                    keep = np.eye(9) - np.outer(gain, np.eye(9)[2])
                    cov = keep @ cov @ keep.T + variance * np.outer(gain, gain)
            q = qt.normalise(qt.multiply(qt.exp_map(error[:3]), q))
            bias = bias + error[3:6]
            velocity = qt.rotate(qt.turn_about_up(error[2]), velocity + error[6:])
        out.append(q)
        biases.append(bias)
    return np.array(out), np.array(biases), velocity, cov


def joint_update(error, cov, h, reading, variance):
    gain = cov @ h.T @ np.linalg.inv(h @ cov @ h.T + variance * np.eye(len(h)))
    keep = np.eye(len(cov)) - gain @ h
    return error + gain @ (reading - h @ error), keep @ cov @ keep.T + variance * gain @ gain.T


@pytest.mark.parametrize("r", [readings(seed=4), quiet()], ids=["shaken", "coming to rest"])
def test_the_error_state_filter_is_its_matrices(r):
    out, bias, state = run_eskf(kernels_eskf, r)
    expected, biases, velocity, covariance = textbook_eskf(r, NOISES)
    np.testing.assert_allclose(out, expected, atol=1e-10)
    np.testing.assert_allclose(bias, biases, atol=1e-11)
    np.testing.assert_allclose(state[7:10], velocity, atol=1e-10)
    np.testing.assert_allclose(state[10:91].reshape(9, 9), covariance, atol=1e-11)


# --- derivatives and closed forms -------------------------------------------------------------------------------


@given(SEEDS)
def test_the_error_state_transition_is_the_derivative_of_the_motion(seed):
    rng = np.random.default_rng(seed)
    q, turn, acc = qt.normalise(rng.standard_normal(4)), 0.05 * rng.standard_normal(3), rng.standard_normal(3)
    bias, velocity, dt = 0.1 * rng.standard_normal(3), rng.standard_normal(3), 0.01

    def moved(error):
        state, scratch = np.zeros(99), np.zeros(kernels_eskf.SCRATCH_SIZE)
        state[:4] = qt.multiply(qt.exp_map(error[:3]), q)
        state[4:7], state[7:10] = bias + error[3:6], velocity + error[6:]
        scratch[81:90] = qt.to_matrix(state[:4]).ravel()
        kernels_eskf.propagate(state, scratch, *turn, dt, *acc, True)
        return state, scratch

    middle, scratch = moved(np.zeros(9))
    transition = []
    for e in 1e-5 * np.eye(9):
        plus, minus = moved(e)[0], moved(-e)[0]
        theta = qt.log_map(qt.multiply(plus[:4], qt.conjugate(minus[:4])))
        transition.append(np.concatenate([theta, plus[4:10] - minus[4:10]]) / 2e-5)
    transition = np.array(transition).T
    covariance = np.cov(rng.standard_normal((9, 40)))
    middle[10:91] = covariance.ravel()
    kernels_eskf.spread(middle, scratch, dt, 0.0, 0.0, 0.0)
    transition[6:, 2] = 0.0  # by choice: the velocity turns with the heading
    transition[6:, 3:6] = 0.0  # of second order in dt
    np.testing.assert_allclose(middle[10:91].reshape(9, 9), transition @ covariance @ transition.T, atol=3e-4)


@given(SEEDS)
def test_p3s_gradients_are_those_of_their_objectives(seed):
    rng = np.random.default_rng(seed)
    q, a, m = qt.normalise(rng.standard_normal(4)), rng.standard_normal(3), rng.standard_normal(3)
    east, north, up = qt.rotate(q, m)
    b = np.array([0.0, np.hypot(east, north), up])

    def half_square(p, target, seen):
        w, x, y, z = p  # R(p)ᵀ as polynomials: off the unit sphere the objective is theirs
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        return 0.5 * np.sum((rotation @ target - seen) ** 2)

    for add, reading, target in (
        (kernels_ekf_gd.add_gravity_gradient, a, UP),
        (kernels_ekf_gd.add_field_gradient, m, b),
    ):
        out = np.ones(4)  # it adds
        add(q, *reading, out)
        steps = 1e-6 * np.eye(4)
        expected = [(half_square(q + e, target, reading) - half_square(q - e, target, reading)) / 2e-6 for e in steps]
        np.testing.assert_allclose(out - 1.0, expected, atol=1e-6)


@given(SEEDS)
def test_the_error_quaternion_is_a_rotation_by_its_vector_for_small_ones_and_unit_for_all(seed):
    rng = np.random.default_rng(seed)
    p, out = rng.standard_normal(3), np.empty(4)
    kernels_ukf.error_quaternion(*(10.0 * p), out, 0)
    assert np.linalg.norm(out) == pytest.approx(1.0, abs=1e-12)
    small = 1e-3 * p / np.linalg.norm(p)
    kernels_ukf.error_quaternion(*small, out, 0)
    np.testing.assert_allclose(qt.log_map(out), small, atol=1e-10)


def still_readings(rows, dt=0.01):
    ones = np.ones(rows)
    field = np.tile([0.0, 0.5, -0.8], (rows, 1)) / np.hypot(0.5, 0.8)
    return {
        "turn": np.zeros((rows, 3)),
        "dt": np.full(rows, dt),
        "acc": np.tile(UP, (rows, 1)),
        "acc_weight": ones,
        "mag": field,
        "mag_weight": ones,
    }


def test_the_headings_variance_settles_where_riccatis_equation_says():
    """With a known bias the heading is a random walk (q dt a step) read with variance r/dt: P = Q/2 + √(Q²/4 + QR)."""
    dt, gyr, density = 0.01, 0.01, 0.3
    walk, reading = gyr**2 * dt, density**2 / dt
    before = walk / 2 + np.sqrt(walk**2 / 4 + walk * reading)
    expected = before * reading / (before + reading)
    r = still_readings(40_000, dt)
    noises = NOISES.copy()
    noises[[0, 1, 6, 7]] = gyr, 0.0, density, 1.0
    q = np.array(qt.IDENTITY)
    state = eskf.start_state(q, np.zeros(3), np.zeros((3, 3)))
    out, bias = np.empty((40_000, 4)), np.empty((40_000, 3))
    kernels_eskf.eskf(*args(r), noises, state, np.empty(kernels_eskf.SCRATCH_SIZE), out, bias)
    assert state[10 + 20] == pytest.approx(expected, rel=1e-6)
    state = ukf.start_state(q, np.zeros(3), np.zeros((3, 3)))
    state[7:] = (np.diag([1e-3] * 3 + [1e-20] * 3)).ravel()
    kernels_ukf.ukf(*args(r), gyr, 0.0, 0.05, density, state, np.empty(kernels_ukf.SCRATCH_SIZE), out, bias)
    # the middle of the trapezoid: half of the step's noise comes after the points are spread
    assert state[7 + 14] == pytest.approx(expected, rel=1e-3)


def test_near_the_truth_the_unscented_filter_is_the_extended_one():
    """Both linearise the same model: their difference falls with the square of the noise."""
    differences = []
    for size in (1.0, 0.25):
        r = readings(300, seed=6, turn=0.02, shake=0.05 * size)
        r["mag"] = np.tile([0.0, 0.5, -0.8], (300, 1)) + 0.02 * size * (r["mag"] - [0.0, 0.5, -0.8])
        truth = np.empty((300, 4))
        q = np.array(qt.IDENTITY)
        for k, turn in enumerate(r["turn"]):
            q = truth[k] = qt.multiply(q, qt.exp_map(turn))
        r["acc"] = qt.rotate_inverse(truth, UP) + (r["acc"] - UP)
        r["mag"] = qt.rotate_inverse(truth, r["mag"])
        noises = (0.01 * size, 1e-5 * size, 0.1 * size, 0.3 * size)
        points, _, _ = run_ukf(kernels_ukf, r, noises, q=np.array(qt.IDENTITY), sigma=0.01 * size)
        state = ekf7.start_state(np.array(qt.IDENTITY), np.zeros(3), (0.01 * size) ** 2 * np.eye(3))
        state[7:].reshape(7, 7)[:4, :4] = 0.25 * (0.01 * size) ** 2 * np.diag([0.0, 1.0, 1.0, 1.0])
        out, bias = np.empty((300, 4)), np.empty((300, 3))
        kernels_ekf7.ekf7(*args(r), *noises, state, np.empty(kernels_ekf7.SCRATCH_SIZE), out, bias)
        differences.append(qt.angle_between(points, out).max())
        assert qt.angle_between(points, truth).max() > 10.0 * differences[-1]
    assert differences[1] < differences[0] / 8.0


def test_the_unscented_filter_finds_its_tilt_from_any_start():
    r = still_readings(3000)
    for angle in (1.0, 2.0, 3.0):
        q = qt.exp_map(angle * np.array([0.8, 0.6, 0.0]))
        out, _, _ = run_ukf(kernels_ukf, r, EKF_NOISES, q=q, sigma=1.0)
        up = qt.rotate_inverse(out[-1], UP)
        assert np.degrees(np.arccos(up[2])) < 0.5


@settings(max_examples=20)
@given(SEEDS)
def test_covariances_stay_symmetric_and_positive(seed):
    r = readings(400, seed=seed, shake=1.0)
    for run, module, start, size in (
        (run_eskf, kernels_eskf, 10, 9),
        (run_ukf, kernels_ukf, 7, 6),
        (run_ekf_gd, kernels_ekf_gd, 4, 4),
    ):
        covariance = run(module, r)[2][start : start + size * size].reshape(size, size)
        np.testing.assert_array_equal(covariance, covariance.T)
        assert np.linalg.eigvalsh(covariance).min() > -1e-12 * np.trace(covariance)


def test_what_shakes_to_and_fro_does_not_tilt_the_error_state_filter_as_it_tilts_one_that_takes_force_for_up():
    """A push of 3 m/s² for a second and back again: gravity alone is left of the mean."""
    rows, dt = 6000, 0.01
    r = still_readings(rows, dt)
    wave = np.where(np.arange(rows) * dt > 10.0, np.sin(2 * np.pi * 0.5 * np.arange(rows) * dt), 0.0)
    r["acc"] = r["acc"] + np.outer(3.0 / 9.81 * wave, [1.0, 0.0, 0.0])
    q = np.array(qt.IDENTITY)
    settings_ = OrientationSettings()
    out, bias = np.empty((rows, 4)), np.empty((rows, 3))
    state = eskf.start_state(q, np.zeros(3), 1e-10 * np.eye(3))
    noises = eskf.noises(settings_, DIP)
    kernels_eskf.eskf(*args(r), noises, state, np.empty(kernels_eskf.SCRATCH_SIZE), out, bias)
    tilt = np.degrees(np.arccos(np.clip(qt.rotate_inverse(out, UP)[:, 2], -1, 1)))
    state = ekf7.start_state(q, np.zeros(3), 1e-10 * np.eye(3))
    noise7 = (np.radians(settings_.ekf_gyr_noise_dps_rthz), 0.0, settings_.ekf_acc_noise_g_rthz, 0.3)
    kernels_ekf7.ekf7(*args(r), *noise7, state, np.empty(kernels_ekf7.SCRATCH_SIZE), out, bias)
    plain = np.degrees(np.arccos(np.clip(qt.rotate_inverse(out, UP)[:, 2], -1, 1)))
    swing = np.degrees(np.arctan(3.0 / 9.81))  # of the specific force's direction
    assert tilt[3000:].max() < swing / 30.0
    assert np.sqrt(np.mean(tilt[3000:] ** 2)) < 0.7 * np.sqrt(np.mean(plain[3000:] ** 2))


def test_as_published_p3s_filter_holds_turns_about_up_back_and_from_the_prediction_it_does_not():
    r = still_readings(2000)
    r["turn"] = np.tile([0.0, 0.0, 0.01], (2000, 1))
    r["mag_weight"] = np.zeros(2000)
    r["acc"] = np.tile([0.02, 0.0, 1.0], (2000, 1))
    yaw = {}
    for as_published in (True, False):
        out, _, _ = run_ekf_gd(kernels_ekf_gd, r, as_published, noise=3e-4)
        yaw[as_published] = np.unwrap(qt.to_roll_pitch_yaw(out)[:, 2])
    assert yaw[False][-1] - yaw[False][0] == pytest.approx(20.0, abs=0.3)
    assert yaw[True][-1] - yaw[True][0] < 17.0


def test_a_field_of_other_strength_or_dip_says_nothing_of_the_heading():
    def sigma(norm, dip):
        level, up = norm * np.cos(dip), -norm * np.sin(dip)
        return kernels_eskf.heading_sigma(0.0, level, up, 0.14, DIP, 0.1, 0.2)

    assert sigma(1.0, DIP) == pytest.approx(0.14)
    assert sigma(1.05, DIP) == pytest.approx(0.14 * np.sqrt(2.0))
    assert sigma(1.0, DIP + 0.1) == pytest.approx(0.14 * np.sqrt(5.0))
    assert sigma(1.11, DIP) == sigma(0.89, DIP) == sigma(1.0, DIP - 0.21) == -1.0
