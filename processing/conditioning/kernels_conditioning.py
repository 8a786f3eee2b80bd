"""The per-sample recursions of the channel filters, compiled where a compiler built them, plain Python elsewhere.

The model is a random walk read with white noise: ``x_k = x_{k−1} + w_k``, ``z_k = x_k + v_k``, with variances q and r.
All rows are contiguous float64 (n,), ``valid`` uint8 (n,) with row 0 valid; ``q`` and ``r`` hold one value, or n.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import exp, log

COMPILED: bool = cython.compiled


def kalman(
    values: cython.double[::1],
    valid: cython.uchar[::1],
    q: cython.double[::1],
    r: cython.double[::1],
    mean: cython.double[::1],
    variance: cython.double[::1],
) -> None:
    """Filter from a start that knows nothing but the first reading; an invalid row is predicted."""
    n: cython.Py_ssize_t = values.shape[0]
    q_step: cython.Py_ssize_t = 1 if q.shape[0] > 1 else 0
    r_step: cython.Py_ssize_t = 1 if r.shape[0] > 1 else 0
    k: cython.Py_ssize_t
    x: cython.double = values[0]
    p: cython.double = r[0]
    gain: cython.double
    mean[0] = x
    variance[0] = p
    with cython.nogil:
        for k in range(1, n):
            p += q[k * q_step]
            if valid[k]:
                gain = p / (p + r[k * r_step])
                x += gain * (values[k] - x)
                p = gain * r[k * r_step]
            mean[k] = x
            variance[k] = p


def smooth(q: cython.double[::1], mean: cython.double[::1], variance: cython.double[::1]) -> None:
    """Rauch–Tung–Striebel backwards over what :func:`kalman` left, in place."""
    n: cython.Py_ssize_t = mean.shape[0]
    q_step: cython.Py_ssize_t = 1 if q.shape[0] > 1 else 0
    k: cython.Py_ssize_t
    predicted: cython.double
    back: cython.double
    with cython.nogil:
        for k in range(n - 2, -1, -1):
            predicted = variance[k] + q[(k + 1) * q_step]
            back = variance[k] / predicted
            mean[k] += back * (mean[k + 1] - mean[k])
            variance[k] += back * back * (variance[k + 1] - predicted)


def likelihood(
    values: cython.double[::1], valid: cython.uchar[::1], ratio: cython.double, out: cython.double[::1]
) -> None:
    """Add to ``out``: Σ log S, Σ ν²/S and the count of innovations, for r = 1 and q = ``ratio``."""
    n: cython.Py_ssize_t = values.shape[0]
    k: cython.Py_ssize_t
    x: cython.double = values[0]
    p: cython.double = 1.0
    innovation: cython.double
    spread: cython.double
    with cython.nogil:
        for k in range(1, n):
            p += ratio
            if valid[k]:
                spread = p + 1.0
                innovation = values[k] - x
                out[0] += log(spread)
                out[1] += innovation * innovation / spread
                out[2] += 1.0
                x += p / spread * innovation
                p = p / spread


def innovations(
    values: cython.double[::1], valid: cython.uchar[::1], gain: cython.double, out: cython.double[::1]
) -> None:
    """Put the innovations of a filter of constant gain into ``out``; 0 where a row is invalid."""
    n: cython.Py_ssize_t = values.shape[0]
    k: cython.Py_ssize_t
    x: cython.double = values[0]
    out[0] = 0.0
    with cython.nogil:
        for k in range(1, n):
            if valid[k]:
                out[k] = values[k] - x
                x += gain * out[k]
            else:
                out[k] = 0.0


def bank(
    values: cython.double[::1],
    valid: cython.uchar[::1],
    q: cython.double[::1],
    r: cython.double[::1],
    switch: cython.double,
    state: cython.double[:, ::1],
    mean: cython.double[::1],
    variance: cython.double[::1],
    probability: cython.float[:, ::1],
) -> None:
    """Run m filters side by side and mix them by the probability of each.

    ``state`` (4, m): means, variances, probabilities (given at the start), room for log weights. Between rows a model
    gives way with the probability ``switch``, to any alike.
    """
    n: cython.Py_ssize_t = values.shape[0]
    m: cython.Py_ssize_t = q.shape[0]
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    best: cython.double
    total: cython.double
    spread: cython.double
    innovation: cython.double
    x: cython.double
    p: cython.double
    with cython.nogil:
        for k in range(n):
            best = -1e300
            for i in range(m):
                state[2, i] = (1.0 - switch) * state[2, i] + switch / m
                state[3, i] = log(state[2, i] + 1e-300)
                if k == 0:
                    state[0, i] = values[0]
                    state[1, i] = r[i]
                else:
                    state[1, i] += q[i]
                    if valid[k]:
                        spread = state[1, i] + r[i]
                        innovation = values[k] - state[0, i]
                        state[3, i] -= 0.5 * (log(spread) + innovation * innovation / spread)
                        state[0, i] += state[1, i] / spread * innovation
                        state[1, i] *= r[i] / spread
                best = max(best, state[3, i])
            total = 0.0
            for i in range(m):
                state[2, i] = exp(state[3, i] - best)
                total += state[2, i]
            x = 0.0
            for i in range(m):
                state[2, i] /= total
                x += state[2, i] * state[0, i]
                probability[k, i] = state[2, i]
            p = 0.0
            for i in range(m):
                p += state[2, i] * (state[1, i] + (state[0, i] - x) * (state[0, i] - x))
            mean[k] = x
            variance[k] = p


def weigh(log_likelihood: cython.double[:, ::1], switch: cython.double, probability: cython.double[:, ::1]) -> None:
    """Put each model's probability after each row (n, m) into ``probability``; all are alike before the first."""
    n: cython.Py_ssize_t = log_likelihood.shape[0]
    m: cython.Py_ssize_t = log_likelihood.shape[1]
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    best: cython.double
    total: cython.double
    before: cython.double
    with cython.nogil:
        for k in range(n):
            best = -1e300
            for i in range(m):
                before = 1.0 / m if k == 0 else (1.0 - switch) * probability[k - 1, i] + switch / m
                probability[k, i] = log(before + 1e-300) + log_likelihood[k, i]
                best = max(best, probability[k, i])
            total = 0.0
            for i in range(m):
                probability[k, i] = exp(probability[k, i] - best)
                total += probability[k, i]
            for i in range(m):
                probability[k, i] /= total
