"""The zero-velocity filter against closed forms, a Riccati solution, numerical derivatives and batch estimation."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from processing.orientation import quaternions as qt
from processing.position import kernels_zupt, kernels_zupt_smoother, zupt_filter
from processing.position.zupt_filter import Inertial, Noise, Start, Updates, run_filter
from processing.progress import silent

G = 9.81
RATE = 200.0


def resting(count):
    acc = np.tile([0.0, 0.0, G], (count, 1))
    zero = np.zeros((count, 3))
    step = np.full(count, 1.0 / RATE)
    return lambda rows: Inertial(acc[rows], zero[rows], zero[rows].copy(), step[rows], G)


def updates(count, every, sigma, held=lambda k: True):
    rows = np.arange(0, count, every)
    none = np.zeros(len(rows))
    still = np.array([sigma if held(k) else 0.0 for k in range(len(rows))])
    return Updates(rows, still, none, none, none, np.ones((len(rows), 2)))


def start(velocity=(0.0, 0.0, 0.0), p=1e-6, v=0.1, tilt=1e-8, acc=1e-8, gyr=1e-8):
    state = np.concatenate([np.zeros(3), velocity, [1.0, 0.0, 0.0, 0.0], np.zeros(6)])
    return Start(state, np.array([p] * 3 + [v] * 3 + [tilt] * 3 + [acc] * 3 + [gyr] * 3))


def tossed(count=61, seed=0):
    rng = np.random.default_rng(seed)
    time_s = np.arange(count) / RATE
    acc = np.array([1.0, -2.0, G]) + 5.0 * np.sin(np.outer(time_s, [20.0, 33.0, 27.0]) + rng.uniform(0, 6, 3))
    gyr = 3.0 * np.sin(np.outer(time_s, [15.0, 22.0, 9.0]) + rng.uniform(0, 6, 3))
    return np.ascontiguousarray(acc), np.ascontiguousarray(gyr / RATE), np.full(count, 1.0 / RATE)


def carried(state, acc, turn, step):
    x, phi = state.copy(), np.empty((15, 15))
    kernels_zupt.strapdown(
        acc, turn, step, 0, len(acc) - 1, G, x, phi, np.zeros((3, 3)), np.zeros(kernels_zupt.SCRATCH_SIZE)
    )
    return x, phi


def with_error(state, d):
    out = state.copy()
    out[:6] += d[:6]
    out[6:10] = qt.multiply(qt.exp_map(d[6:9]), state[6:10])
    out[10:] += d[9:]
    return out


def error_of(state, against):
    turn = qt.log_map(qt.multiply(state[6:10], qt.conjugate(against[6:10])))
    return np.concatenate([state[:6] - against[:6], turn, state[10:] - against[10:]])


def test_an_unseen_velocity_error_grows_as_the_closed_form_says():
    noise = Noise(0.3, 0.0, 0.0, 0.0)
    out = run_filter(resting(401), updates(401, 20, 0.0), start((1.0, 0.0, 0.0), v=0.5), noise, np.inf, silent())
    t = np.arange(21) * 0.1
    assert np.allclose(out.state[:, 0], t)  # nothing says that it stands
    filtered = run_filter(resting(401), updates(401, 20, 0.0), start(v=0.5), noise, np.inf, silent(), smooth=False)
    assert np.allclose(filtered.covariance[:, 0, 0], 1e-12 + 0.25 * t**2 + 0.09 * t**3 / 3.0, rtol=1e-9)
    assert np.allclose(filtered.covariance[:, 3, 3], 0.25 + 0.09 * t)
    assert np.allclose(filtered.covariance[:, 0, 3], 0.25 * t + 0.09 * t**2 / 2.0)
    assert np.all(filtered.nis == -1.0)


def test_a_zero_velocity_resets_speed_and_takes_the_way_back():
    begin = start((0.3, -0.2, 0.1), v=0.5)
    out = run_filter(
        resting(201), updates(201, 20, 1e-4, lambda k: k >= 5), begin, Noise(1e-4, 0, 0, 0), np.inf, silent()
    )
    assert np.max(np.abs(out.state[:, 3:6])) < 1e-3  # a constant error: known afterwards from the beginning on
    assert np.max(np.abs(out.state[:, :3])) < 1e-3
    assert np.allclose(out.missed_mps[5], [-0.3, 0.2, -0.1], atol=1e-3)
    forwards = run_filter(
        resting(201),
        updates(201, 20, 1e-4, lambda k: k >= 5),
        begin,
        Noise(1e-4, 0, 0, 0),
        np.inf,
        silent(),
        smooth=False,
    )
    assert forwards.state[4, 0] == pytest.approx(0.3 * 0.4, abs=1e-6)


def test_steady_aiding_reaches_the_riccati_variance():
    q, r = 0.05**2 * 0.1, 0.02**2
    noise = Noise(0.05, 0.0, 0.0, 0.0)
    out = run_filter(resting(8001), updates(8001, 20, 0.02), start(), noise, np.inf, silent(), smooth=False)
    predicted = solve_discrete_are(np.eye(1), np.eye(1), np.array([[q]]), np.array([[r]]))[0, 0]
    assert out.covariance[-1, 4, 4] == pytest.approx(predicted * r / (predicted + r), rel=1e-3)


def test_the_transition_is_the_derivative_of_the_strapdown():
    acc, turn, step = tossed()
    state = np.concatenate([[1.0, 2.0, 3.0, 0.5, -1.0, 0.2], qt.exp_map(np.array([0.4, -0.8, 1.1])), [0.1, -0.2, 0.05],
                            [0.01, 0.02, -0.03]])  # fmt: skip
    end, phi = carried(state, acc, turn, step)
    for k in range(15):
        d = np.zeros(15)
        d[k] = 1e-5
        plus, minus = (carried(with_error(state, sign * d), acc, turn, step)[0] for sign in (1.0, -1.0))
        column = (error_of(plus, end) - error_of(minus, end)) / 2e-5
        assert np.allclose(column, phi[:, k], atol=2e-3), k


def test_a_coasting_and_spinning_body_moves_by_newton():
    # a force that is constant in the world, felt in a sensor that turns about up at 1 rad/s
    count = 401
    time_s = np.arange(count) / RATE
    push = np.array([0.7, -0.3, G + 0.2])
    q = qt.turn_about_up(time_s)
    acc = np.ascontiguousarray(qt.rotate_inverse(q, np.tile(push, (count, 1))))
    turn = np.tile([0.0, 0.0, 1.0 / RATE], (count, 1))
    end, _ = carried(start().state, acc, turn, np.full(count, 1.0 / RATE))
    assert np.allclose(end[3:6], np.array([0.7, -0.3, 0.2]) * 2.0, atol=1e-9)
    assert np.allclose(end[:3], np.array([0.7, -0.3, 0.2]) * 2.0, atol=1e-9)
    assert np.allclose(end[6:10], q[-1], atol=1e-12)


def test_the_smoother_is_the_batch_estimate_of_all_states_at_once():
    # a resting sensor: the error model is linear, F constant, its transition an exponential
    force = np.array([[0.0, G, 0.0], [-G, 0.0, 0.0], [0.0, 0.0, 0.0]])  # −f ×
    model = np.zeros((15, 15))
    model[0:3, 3:6] = np.eye(3)
    model[3:6, 6:9], model[3:6, 9:12], model[6:9, 12:15] = force, -np.eye(3), -np.eye(3)
    dt, nodes, sigma = 0.1, 25, 0.02
    step = expm(model * dt)
    noise = np.zeros((15, 15))
    for axis in range(3):
        noise[np.ix_([axis, 3 + axis], [axis, 3 + axis])] = 0.05**2 * np.array(
            [[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]]
        )
    begin = start(v=0.1, tilt=0.01, acc=0.02, gyr=1e-3)
    held = [k for k in range(nodes) if k in (0, 1, 2) or 10 <= k <= 13 or k > 20]

    rng = np.random.default_rng(4)
    count = (nodes - 1) * 20 + 1
    acc = np.tile([0.0, 0.0, G], (count, 1)) + np.array([0.02, -0.01, 0.015]) + 0.02 * rng.standard_normal((count, 3))
    zero = np.zeros((count, 3))

    def read(rows):
        return Inertial(acc[rows], zero[rows], zero[rows].copy(), np.full(len(zero[rows]), 1.0 / RATE), G)

    free = run_filter(read, updates(count, 20, 0.0), begin, Noise(0.05, 0, 0, 0), np.inf, silent(), smooth=False)
    got = run_filter(
        read, updates(count, 20, sigma, lambda k: k in held), begin, Noise(0.05, 0, 0, 0), np.inf, silent()
    )

    # joint covariance of the errors of all nodes, then conditioned on what the free path's velocity was off zero
    own = [np.diag(begin.sigma**2)]
    for _ in range(nodes - 1):
        own.append(step @ own[-1] @ step.T + noise)
    joint = np.zeros((15 * nodes, 15 * nodes))
    for a in range(nodes):
        across = own[a]
        for b in range(a, nodes):
            joint[15 * b : 15 * b + 15, 15 * a : 15 * a + 15] = across
            joint[15 * a : 15 * a + 15, 15 * b : 15 * b + 15] = across.T
            across = step @ across
    seen = np.concatenate([15 * k + 3 + np.arange(3) for k in held])
    gain = joint[:, seen] @ np.linalg.inv(joint[np.ix_(seen, seen)] + sigma**2 * np.eye(len(seen)))
    errors = gain @ -np.concatenate([free.state[k, 3:6] for k in held])
    spread = joint - gain @ joint[seen]
    for k in range(nodes):
        want = free.state[k, :6] + errors[15 * k : 15 * k + 6]
        assert np.allclose(got.state[k, :6], want, atol=3e-5), k
        block = spread[15 * k : 15 * k + 6, 15 * k : 15 * k + 6]
        scale = np.sqrt(np.outer(np.diag(block), np.diag(block)))  # errors are linear only for small ones
        assert np.max(np.abs(got.covariance[k] - block) / scale) < 0.02, k


def test_pieces_join_without_a_seam(monkeypatch):
    count = 8001
    held = updates(count, 20, 0.02, lambda k: k % 10 < 4)
    begin = start((0.1, 0.0, 0.0), tilt=0.01, acc=0.02, gyr=1e-3)
    noise = Noise(0.05, 1e-3, 1e-4, 1e-5)
    whole = run_filter(resting(count), held, begin, noise, 16.3, silent())
    monkeypatch.setattr(zupt_filter, "_PIECE", 90)
    monkeypatch.setattr(zupt_filter, "_LAG", 200)
    pieces = run_filter(resting(count), held, begin, noise, 16.3, silent())
    assert np.allclose(pieces.state, whole.state, atol=2e-4)
    assert np.allclose(pieces.nis, whole.nis)


def test_an_implausible_standstill_pulls_less_but_still_pulls():
    def run(gate):
        held = updates(401, 20, 0.01, lambda k: k == 10)
        return run_filter(
            resting(401), held, start((5.0, 0, 0), v=0.1), Noise(0.01, 0, 0, 0), gate, silent(), smooth=False
        )

    trusting, doubting = run(np.inf), run(16.3)
    assert abs(trusting.state[10, 3]) < 0.1
    assert 0.3 < doubting.state[10, 3] < 4.99
    assert doubting.nis[10] > 1000.0


def test_the_kernels_say_the_same_compiled_and_not():
    acc, turn, step = tossed(81)
    rows = np.arange(0, 81, 4)
    still = np.where(np.arange(len(rows)) % 5 == 0, 0.05, 0.0)
    yaw = np.where(np.arange(len(rows)) % 7 == 3, 0.1, 0.0)

    def both(forward, smoother):
        n = len(rows)
        x, p = start().state.copy(), np.diag(start(tilt=0.01, acc=0.01, gyr=0.01).sigma ** 2)
        states = [np.zeros((n, 16)) for _ in range(3)]
        squares = [np.zeros((n, 15, 15)) for _ in range(3)]
        out, work, m, d = np.zeros((n, 6, 6)), np.zeros((15, 18)), np.zeros((3, 3)), np.zeros(15)
        forward.forward(acc, turn * RATE, turn, step, rows.astype(np.int64), still, still, yaw, yaw, np.ones((n, 2)), G,
                        np.array([0.1, 0.01, 1e-3, 1e-4]), 16.3, x, p, states[0], states[1], *squares,
                        np.zeros(n), np.zeros((n, 3)), work, m, d, np.zeros(64))  # fmt: skip
        smoother.backward(states[0], states[1], *squares, states[2], out, squares[1][-1].copy(), work,
                          np.zeros((15, 15)), np.zeros(15), np.zeros(15), np.zeros(15))  # fmt: skip
        return states[2], out

    compiled = both(kernels_zupt, kernels_zupt_smoother)
    plain = both(*(plain_module(m) for m in (kernels_zupt, kernels_zupt_smoother)))
    assert np.allclose(plain[0], compiled[0], rtol=1e-9, atol=1e-9)
    assert np.allclose(plain[1], compiled[1], rtol=1e-9, atol=1e-12)


def plain_module(compiled):
    """The same kernel as Python reads it."""
    source = Path(compiled.__file__).parent / (compiled.__name__.rpartition(".")[2] + ".py")
    spec = importlib.util.spec_from_file_location("plain_" + source.stem, source)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module
