"""The backward recursion of the zero-velocity aided filter: Rauch–Tung–Striebel, compiled where a compiler built it.

Cython in pure-Python mode; states and errors as in :mod:`processing.position.kernels_zupt`. The smoother works on
errors about the nominal states: what the node after learned against its prediction is carried back by the gain
``C = P_filt Φᵀ P_pred⁻¹``. Source: Rauch, Tung, Striebel 1965.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import atan2, cos, sin, sqrt

COMPILED: bool = cython.compiled


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _turn_right(q: cython.double[::1], rx: cython.double, ry: cython.double, rz: cython.double) -> cython.void:
    """Put q ⊗ exp(r): a turn in the sensor frame."""
    square: cython.double = rx * rx + ry * ry + rz * rz
    c: cython.double
    f: cython.double
    if square < 1e-8:
        c = 1.0 - square / 8.0
        f = 0.5 - square / 48.0
    else:
        angle: cython.double = sqrt(square)
        c = cos(0.5 * angle)
        f = sin(0.5 * angle) / angle
    x: cython.double = f * rx
    y: cython.double = f * ry
    z: cython.double = f * rz
    w0: cython.double = q[0]
    x0: cython.double = q[1]
    y0: cython.double = q[2]
    z0: cython.double = q[3]
    w1: cython.double = w0 * c - x0 * x - y0 * y - z0 * z
    x1: cython.double = w0 * x + x0 * c + y0 * z - z0 * y
    y1: cython.double = w0 * y - x0 * z + y0 * c + z0 * x
    z1: cython.double = w0 * z + x0 * y - y0 * x + z0 * c
    size: cython.double = sqrt(w1 * w1 + x1 * x1 + y1 * y1 + z1 * z1)
    q[0] = w1 / size
    q[1] = x1 / size
    q[2] = y1 / size
    q[3] = z1 / size


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _inject(x: cython.double[::1], d: cython.double[::1]) -> cython.void:
    """Put the error ``d`` (15) into the nominal state ``x`` (16)."""
    i: cython.Py_ssize_t
    for i in range(6):
        x[i] += d[i]
    for i in range(6):
        x[10 + i] += d[9 + i]
    # exp(δθ) ⊗ q is conj(conj(q) ⊗ exp(−δθ))
    x[7] = -x[7]
    x[8] = -x[8]
    x[9] = -x[9]
    _turn_right(x[6:10], -d[6], -d[7], -d[8])
    x[7] = -x[7]
    x[8] = -x[8]
    x[9] = -x[9]


@cython.cfunc
@cython.exceptval(check=False)
def _difference(a: cython.double[:], b: cython.double[:], d: cython.double[::1]) -> cython.void:
    """Put the error of nominal ``a`` against ``b`` in ``d`` (15); their attitudes are close to each other."""
    i: cython.Py_ssize_t
    for i in range(6):
        d[i] = a[i] - b[i]
        d[9 + i] = a[10 + i] - b[10 + i]
    # a ⊗ b*
    w: cython.double = a[6] * b[6] + a[7] * b[7] + a[8] * b[8] + a[9] * b[9]
    x: cython.double = -a[6] * b[7] + a[7] * b[6] - a[8] * b[9] + a[9] * b[8]
    y: cython.double = -a[6] * b[8] + a[7] * b[9] + a[8] * b[6] - a[9] * b[7]
    z: cython.double = -a[6] * b[9] - a[7] * b[8] + a[8] * b[7] + a[9] * b[6]
    size: cython.double = sqrt(x * x + y * y + z * z)
    f: cython.double = 2.0 / w if size < 1e-9 else 2.0 * atan2(size, w) / size
    d[6] = f * x
    d[7] = f * y
    d[8] = f * z


@cython.cfunc
@cython.exceptval(check=False)
def _solved(a: cython.double[:, ::1], b: cython.double[:, ::1], scale: cython.double[::1]) -> cython.void:
    """Overwrite ``b`` (15 × 15) by a⁻¹ b; ``a`` is symmetric and positive, its lower half becomes its factor."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    for i in range(15):
        scale[i] = 1.0 / sqrt(a[i, i]) if a[i, i] > 0.0 else 1.0
    for i in range(15):
        for j in range(i + 1):
            total = a[i, j] * scale[i] * scale[j]
            for k in range(j):
                total -= a[i, k] * a[j, k]
            if i == j:
                a[i, i] = sqrt(total) if total > 1e-14 else 1e-7
            else:
                a[i, j] = total / a[j, j]
    for j in range(15):
        for i in range(15):
            total = b[i, j] * scale[i]
            for k in range(i):
                total -= a[i, k] * b[k, j]
            b[i, j] = total / a[i, i]
        for i in range(14, -1, -1):
            total = b[i, j]
            for k in range(i + 1, 15):
                total -= a[k, i] * b[k, j]
            b[i, j] = total / a[i, i]
        for i in range(15):
            b[i, j] *= scale[i]


@cython.cfunc
@cython.exceptval(check=False)
def _gain(
    p_filtered: cython.double[:, ::1],
    phi: cython.double[:, ::1],
    p_predicted: cython.double[:, ::1],
    work: cython.double[:, ::1],
    gain: cython.double[:, ::1],
    scale: cython.double[::1],
) -> cython.void:
    """Leave the smoother's gain, transposed, in ``gain``: P_pred⁻¹ Φ P_filt."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(15):
        for j in range(15):
            total: cython.double = p_filtered[i, j]  # the diagonal of Φ is one, and nothing else stands below it
            for k in range(i + 1, 15):
                total += phi[i, k] * p_filtered[k, j]
            gain[i, j] = total
            work[i, j] = p_predicted[i, j]
    _solved(work, gain, scale)


@cython.cfunc
@cython.exceptval(check=False)
def _spread(
    p: cython.double[:, ::1],
    p_filtered: cython.double[:, ::1],
    p_predicted: cython.double[:, ::1],
    work: cython.double[:, ::1],
    gain: cython.double[:, ::1],
) -> cython.void:
    """Put ``P_filt + C (P − P_pred) Cᵀ`` in ``p``, which holds the smoothed covariance of the node after."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    for i in range(15):
        for j in range(15):
            total = 0.0
            for k in range(15):
                total += (p[i, k] - p_predicted[i, k]) * gain[k, j]
            work[i, j] = total
    for i in range(15):
        for j in range(i + 1):
            total = p_filtered[i, j]
            for k in range(15):
                total += gain[k, i] * work[k, j]
            p[i, j] = total
            p[j, i] = total


@cython.ccall
def backward(
    predicted: cython.double[:, ::1],
    filtered: cython.double[:, ::1],
    p_predicted: cython.double[:, :, ::1],
    p_filtered: cython.double[:, :, ::1],
    phis: cython.double[:, :, ::1],
    smoothed: cython.double[:, ::1],
    p_smoothed: cython.double[:, :, ::1],
    p: cython.double[:, ::1],
    work: cython.double[:, ::1],
    gain: cython.double[:, ::1],
    scale: cython.double[::1],
    d: cython.double[::1],
    e: cython.double[::1],
) -> cython.void:
    """Smooth what ``kernels_zupt.forward`` left: ``smoothed`` (m, 16), of its covariance the part of p and v
    ``p_smoothed`` (m, 6, 6). ``p`` begins as the last filtered covariance (15 × 15); the rest is scratch.
    """
    count: cython.Py_ssize_t = filtered.shape[0]
    n: cython.Py_ssize_t
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for n in range(count - 1, -1, -1):
        for i in range(16):
            smoothed[n, i] = filtered[n, i]
        if n < count - 1:
            _gain(p_filtered[n], phis[n + 1], p_predicted[n + 1], work, gain, scale)
            _difference(smoothed[n + 1], predicted[n + 1], d)
            for i in range(15):
                e[i] = 0.0
                for k in range(15):
                    e[i] += gain[k, i] * d[k]
            _inject(smoothed[n], e)
            _spread(p, p_filtered[n], p_predicted[n + 1], work, gain)
        for i in range(6):
            for k in range(6):
                p_smoothed[n, i, k] = p[i, k]
