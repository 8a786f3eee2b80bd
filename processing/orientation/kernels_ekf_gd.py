"""The recursion of P3's Kalman filter with a gradient-descent observation, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`. ``state`` holds q (4) and its
covariance (4 × 4, row by row).
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import cos, sin, sqrt

COMPILED: bool = cython.compiled
STATE_SIZE: int = 20
SCRATCH_SIZE: int = 52

# places in state and scratch
_P = cython.declare(cython.int, 4)
_F = cython.declare(cython.int, 0)  # transition (4 × 4)
_FP = cython.declare(cython.int, 16)  # F P (4 × 4)
_BASE = cython.declare(cython.int, 32)  # the attitude from which the descent begins (4)
_GRADIENT = cython.declare(cython.int, 36)  # (4)
_Z = cython.declare(cython.int, 40)  # observation (4)
_K = cython.declare(cython.int, 44)  # gain (4)
_XI = cython.declare(cython.int, 16)  # 4 × 3, shares its place with F P, which is no longer needed then


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _predict(
    s: cython.double[::1],
    t: cython.double[::1],
    rx: cython.double,
    ry: cython.double,
    rz: cython.double,
    dt_s: cython.double,
    gyr_noise: cython.double[::1],
) -> cython.void:
    """``q ← F q``, ``P ← F P Fᵀ + ¼ Ξ diag(σ²) Ξᵀ dt`` with F the exponential map of the turn (P3 eq. 5.25, exact)."""
    square: cython.double = rx * rx + ry * ry + rz * rz
    c: cython.double
    f: cython.double
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    if square < 0.06:  # the series to rounding: a sample's turn is small, and sine and cosine would cost most of all
        c = 1.0 - square * 0.125 * (
            1.0 - square * (1.0 / 48.0) * (1.0 - square * (1.0 / 120.0) * (1.0 - square * (1.0 / 224.0)))
        )
        f = 0.5 - square * (1.0 / 48.0) * (
            1.0 - square * (1.0 / 80.0) * (1.0 - square * (1.0 / 168.0) * (1.0 - square * (1.0 / 288.0)))
        )
    else:
        angle: cython.double = sqrt(square)
        c = cos(0.5 * angle)
        f = sin(0.5 * angle) / angle
    rx *= f
    ry *= f
    rz *= f
    for i in range(4):
        t[_F + 5 * i] = c
    t[_F + 1] = -rx
    t[_F + 2] = -ry
    t[_F + 3] = -rz
    t[_F + 4] = rx
    t[_F + 6] = rz
    t[_F + 7] = -ry
    t[_F + 8] = ry
    t[_F + 9] = -rz
    t[_F + 11] = rx
    t[_F + 12] = rz
    t[_F + 13] = ry
    t[_F + 14] = -rx
    for i in range(4):
        t[_Z + i] = 0.0
        for j in range(4):
            t[_Z + i] += t[_F + 4 * i + j] * s[j]
            total = 0.0
            for k in range(4):
                total += t[_F + 4 * i + k] * s[_P + 4 * k + j]
            t[_FP + 4 * i + j] = total
    for i in range(4):
        s[i] = t[_Z + i]
    _spread(s, t, dt_s, gyr_noise)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _spread(
    s: cython.double[::1], t: cython.double[::1], dt_s: cython.double, gyr_noise: cython.double[::1]
) -> cython.void:
    """``P ← (F P) Fᵀ + ¼ Ξ diag(σ²) Ξᵀ dt`` with ``F P`` from scratch."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    for i in range(4):
        for j in range(i, 4):
            total = 0.0
            for k in range(4):
                total += t[_FP + 4 * i + k] * t[_F + 4 * j + k]
            s[_P + 4 * i + j] = total
    t[_XI] = -s[1]
    t[_XI + 1] = -s[2]
    t[_XI + 2] = -s[3]
    t[_XI + 3] = s[0]
    t[_XI + 4] = -s[3]
    t[_XI + 5] = s[2]
    t[_XI + 6] = s[3]
    t[_XI + 7] = s[0]
    t[_XI + 8] = -s[1]
    t[_XI + 9] = -s[2]
    t[_XI + 10] = s[1]
    t[_XI + 11] = s[0]
    for i in range(4):
        for j in range(i, 4):
            for k in range(3):
                s[_P + 4 * i + j] += 0.25 * dt_s * gyr_noise[k] * gyr_noise[k] * t[_XI + 3 * i + k] * t[_XI + 3 * j + k]
            s[_P + 4 * j + i] = s[_P + 4 * i + j]


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def add_gravity_gradient(
    q: cython.double[::1], ax: cython.double, ay: cython.double, az: cython.double, out: cython.double[::1]
) -> cython.void:
    """Add ``Jᵀf`` (4,) of ``f = d(q) − a`` to ``out`` (P3 eq. 5.33, 5.34; up is the third axis of the world)."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    f1: cython.double = 2.0 * (x * z - w * y) - ax
    f2: cython.double = 2.0 * (y * z + w * x) - ay
    f3: cython.double = 1.0 - 2.0 * (x * x + y * y) - az
    out[0] += 2.0 * (x * f2 - y * f1)
    out[1] += 2.0 * (z * f1 + w * f2) - 4.0 * x * f3
    out[2] += 2.0 * (z * f2 - w * f1) - 4.0 * y * f3
    out[3] += 2.0 * (x * f1 + y * f2)


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def add_field_gradient(
    q: cython.double[::1], mx: cython.double, my: cython.double, mz: cython.double, out: cython.double[::1]
) -> cython.void:
    """Add ``Jᵀf`` (4,) of ``f = R(q)ᵀ b − m`` to ``out`` (P3 eq. 5.37 to 5.40, north along the second axis).

    ``b`` keeps the horizontal size of ``R(q) m``, laid on north, and its vertical part: heading alone is asked for.
    """
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    east: cython.double = (1.0 - 2.0 * (y * y + z * z)) * mx + 2.0 * (x * y - w * z) * my + 2.0 * (x * z + w * y) * mz
    north: cython.double = 2.0 * (x * y + w * z) * mx + (1.0 - 2.0 * (x * x + z * z)) * my + 2.0 * (y * z - w * x) * mz
    up: cython.double = 2.0 * (x * z - w * y) * mx + 2.0 * (y * z + w * x) * my + (1.0 - 2.0 * (x * x + y * y)) * mz
    north = sqrt(east * east + north * north)
    f1: cython.double = 2.0 * north * (x * y + w * z) + 2.0 * up * (x * z - w * y) - mx
    f2: cython.double = north * (1.0 - 2.0 * (x * x + z * z)) + 2.0 * up * (y * z + w * x) - my
    f3: cython.double = 2.0 * north * (y * z - w * x) + up * (1.0 - 2.0 * (x * x + y * y)) - mz
    out[0] += 2.0 * ((north * z - up * y) * f1 + up * x * f2 - north * x * f3)
    out[1] += 2.0 * ((north * y + up * z) * f1 + (up * w - 2.0 * north * x) * f2 - (north * w + 2.0 * up * x) * f3)
    out[2] += 2.0 * ((north * x - up * w) * f1 + up * z * f2 + (north * z - 2.0 * up * y) * f3)
    out[3] += 2.0 * ((north * w + up * x) * f1 + (up * y - 2.0 * north * z) * f2 + north * y * f3)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _observe(t: cython.double[::1], step: cython.double, bounded: cython.bint) -> cython.void:
    """``z = normalise(base − μ ∇f/‖∇f‖)`` (P3 eq. 5.44, 5.46); where the gradient vanishes, z is the base.

    Where ``bounded`` the part of the gradient along q, by which it would only grow, is taken off, and the step never
    goes beyond the minimum (‖∇f‖/4, Newton's step).
    """
    i: cython.Py_ssize_t
    along: cython.double = 0.0
    size: cython.double = 0.0
    if bounded:
        for i in range(4):
            along += t[_GRADIENT + i] * t[_BASE + i]
        for i in range(4):
            t[_GRADIENT + i] -= along * t[_BASE + i]
    for i in range(4):
        size += t[_GRADIENT + i] * t[_GRADIENT + i]
    size = sqrt(size)
    if bounded and step > 0.25 * size:
        step = 0.25 * size
    if size > 0.0:
        step /= size
    along = 0.0
    for i in range(4):
        t[_Z + i] = t[_BASE + i] - step * t[_GRADIENT + i]
        along += t[_Z + i] * t[_Z + i]
    along = sqrt(along)
    for i in range(4):
        t[_Z + i] /= along


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _correct(s: cython.double[::1], t: cython.double[::1], variance: cython.double) -> cython.void:
    """Kalman's correction with ``H = I₄`` and ``R = variance I₄`` (P3 eq. 5.47 to 5.49), component by component."""
    which: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    innovation: cython.double
    total: cython.double
    for which in range(4):
        innovation = t[_Z + which] - s[which]
        total = 1.0 / (s[_P + 5 * which] + variance)
        for i in range(4):
            t[_K + i] = s[_P + 4 * i + which]
        for i in range(4):
            s[i] += t[_K + i] * total * innovation
            for j in range(i, 4):
                s[_P + 4 * i + j] -= t[_K + i] * total * t[_K + j]
        for i in range(4):
            for j in range(i):
                s[_P + 4 * i + j] = s[_P + 4 * j + i]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _renormalise(s: cython.double[::1], t: cython.double[::1], covariance_too: cython.bint) -> cython.void:
    """``q ← q/‖q‖`` and ``P ← N P Nᵀ`` with ``N = I − q qᵀ``: a quaternion cannot err in length."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    along: cython.double = 0.0
    norm: cython.double = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3])
    for i in range(4):
        s[i] /= norm
    if not covariance_too:
        return
    for i in range(4):
        t[_K + i] = 0.0
        for j in range(4):
            t[_K + i] += s[_P + 4 * i + j] * s[j]
        along += s[i] * t[_K + i]
    for i in range(4):
        for j in range(i, 4):
            s[_P + 4 * i + j] += s[i] * s[j] * along - s[i] * t[_K + j] - t[_K + i] * s[j]
            s[_P + 4 * j + i] = s[_P + 4 * i + j]


def ekf_gd(
    turn: cython.double[:, ::1],
    dt_s: cython.double[::1],
    acc_g: cython.double[:, ::1],
    acc_weight: cython.double[::1],
    mag: cython.double[:, ::1],
    mag_weight: cython.double[::1],
    gyr_noise: cython.double[::1],
    observation_noise: cython.double,
    alpha: cython.double,
    as_published: cython.bint,
    state: cython.double[::1],
    scratch: cython.double[::1],
    out: cython.double[:, ::1],
) -> None:
    """Quaternion Kalman filter whose observation is a step of gradient descent, ``μ = α ‖q̇‖ dt`` (P3, §5.2).

    ``as_published`` the descent begins at the attitude before the turn, its step is not bounded and the covariance is
    not held to the unit norm; else it begins at the predicted attitude. ``gyr_noise`` (3,)
    rad/s/√Hz, ``observation_noise`` 1/√Hz; ``state`` (20,), ``scratch`` (52,), ``out`` (n, 4).
    """
    n: cython.Py_ssize_t = turn.shape[0]
    has_mag: cython.bint = mag.shape[0] == n
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    norm: cython.double
    dt: cython.double
    told: cython.double
    w: cython.double
    with cython.nogil:
        for k in range(n):
            dt = dt_s[k]
            for j in range(4):
                scratch[_BASE + j] = state[j]
                scratch[_GRADIENT + j] = 0.0
            _predict(state, scratch, turn[k, 0], turn[k, 1], turn[k, 2], dt, gyr_noise)
            if not as_published:
                for j in range(4):
                    scratch[_BASE + j] = state[j]
            told = 0.0
            norm = sqrt(acc_g[k, 0] * acc_g[k, 0] + acc_g[k, 1] * acc_g[k, 1] + acc_g[k, 2] * acc_g[k, 2])
            if acc_weight[k] > 0.0 and norm > 0.0:
                add_gravity_gradient(
                    scratch[_BASE:], acc_g[k, 0] / norm, acc_g[k, 1] / norm, acc_g[k, 2] / norm, scratch[_GRADIENT:]
                )
                told = acc_weight[k]
            if has_mag and mag_weight[k] > 0.0:
                norm = sqrt(mag[k, 0] * mag[k, 0] + mag[k, 1] * mag[k, 1] + mag[k, 2] * mag[k, 2])
                if norm > 0.0:
                    w = mag_weight[k]
                    add_field_gradient(
                        scratch[_BASE:], mag[k, 0] / norm, mag[k, 1] / norm, mag[k, 2] / norm, scratch[_GRADIENT:]
                    )
                    told = max(told, w)
            if told > 0.0 and dt > 0.0:
                norm = turn[k, 0] * turn[k, 0] + turn[k, 1] * turn[k, 1] + turn[k, 2] * turn[k, 2]
                _observe(scratch, 0.5 * alpha * sqrt(norm), not as_published)
                _correct(state, scratch, observation_noise * observation_noise / (dt * told))
            _renormalise(state, scratch, not as_published)
            for j in range(4):
                out[k, j] = state[j]
