"""The recursion of the 7-state Kalman filter of P0: quaternion and gyro bias, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`. ``state`` holds q (4), the bias in
rad/s (3) and the covariance (7 × 7, row by row). The covariance has no part along q itself: a quaternion cannot err in
length, so it is projected out after each correction, together with the renormalisation.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import atan2, cos, sin, sqrt

COMPILED: bool = cython.compiled
STATE_SIZE: int = 56
SCRATCH_SIZE: int = 92

# places in state and scratch
_P = cython.declare(cython.int, 7)
_PH = cython.declare(cython.int, 0)
_FP = cython.declare(cython.int, 7)
_A = cython.declare(cython.int, 56)
_B = cython.declare(cython.int, 72)
_H = cython.declare(cython.int, 84)
_U = cython.declare(cython.int, 0)  # shares its place with P Hᵀ, which is no longer needed then


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def transition(
    state: cython.double[::1],
    rx: cython.double,
    ry: cython.double,
    rz: cython.double,
    dt_s: cython.double,
    scratch: cython.double[::1],
) -> cython.void:
    """Turn q by the rotation vector ``r = (ω − b) dt`` and leave the Jacobians in ``scratch``.

    ``A = ∂q'/∂q`` (4 × 4 at 56) is the matrix of the product with ``exp(r)`` from the right; ``B = ∂q'/∂b`` (4 × 3 at
    72) is ``−½ dt Ξ(q') Jr(r)`` with the right Jacobian ``Jr`` of the exponential map to second order.
    """
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
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    for i in range(4):
        scratch[_A + 5 * i] = c
    scratch[_A + 1] = -x
    scratch[_A + 2] = -y
    scratch[_A + 3] = -z
    scratch[_A + 4] = x
    scratch[_A + 6] = z
    scratch[_A + 7] = -y
    scratch[_A + 8] = y
    scratch[_A + 9] = -z
    scratch[_A + 11] = x
    scratch[_A + 12] = z
    scratch[_A + 13] = y
    scratch[_A + 14] = -x
    for i in range(4):
        scratch[_H + i] = 0.0
        for j in range(4):
            scratch[_H + i] += scratch[_A + 4 * i + j] * state[j]
    for i in range(4):
        state[i] = scratch[_H + i]
    _bias_jacobian(state, rx, ry, rz, dt_s, scratch)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _bias_jacobian(
    q: cython.double[::1],
    rx: cython.double,
    ry: cython.double,
    rz: cython.double,
    dt_s: cython.double,
    scratch: cython.double[::1],
) -> cython.void:
    square: cython.double = rx * rx + ry * ry + rz * rz
    h: cython.double = -0.5 * dt_s
    # Jr = I − [r]×/2 + [r]×²/6, by columns
    j00: cython.double = 1.0 + (rx * rx - square) / 6.0
    j11: cython.double = 1.0 + (ry * ry - square) / 6.0
    j22: cython.double = 1.0 + (rz * rz - square) / 6.0
    j01: cython.double = rx * ry / 6.0 + 0.5 * rz
    j10: cython.double = rx * ry / 6.0 - 0.5 * rz
    j02: cython.double = rx * rz / 6.0 - 0.5 * ry
    j20: cython.double = rx * rz / 6.0 + 0.5 * ry
    j12: cython.double = ry * rz / 6.0 + 0.5 * rx
    j21: cython.double = ry * rz / 6.0 - 0.5 * rx
    scratch[_B] = h * (-q[1] * j00 - q[2] * j10 - q[3] * j20)
    scratch[_B + 1] = h * (-q[1] * j01 - q[2] * j11 - q[3] * j21)
    scratch[_B + 2] = h * (-q[1] * j02 - q[2] * j12 - q[3] * j22)
    scratch[_B + 3] = h * (q[0] * j00 - q[3] * j10 + q[2] * j20)
    scratch[_B + 4] = h * (q[0] * j01 - q[3] * j11 + q[2] * j21)
    scratch[_B + 5] = h * (q[0] * j02 - q[3] * j12 + q[2] * j22)
    scratch[_B + 6] = h * (q[3] * j00 + q[0] * j10 - q[1] * j20)
    scratch[_B + 7] = h * (q[3] * j01 + q[0] * j11 - q[1] * j21)
    scratch[_B + 8] = h * (q[3] * j02 + q[0] * j12 - q[1] * j22)
    scratch[_B + 9] = h * (-q[2] * j00 + q[1] * j10 + q[0] * j20)
    scratch[_B + 10] = h * (-q[2] * j01 + q[1] * j11 + q[0] * j21)
    scratch[_B + 11] = h * (-q[2] * j02 + q[1] * j12 + q[0] * j22)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _spread(
    s: cython.double[::1], t: cython.double[::1], gyr_variance: cython.double, bias_variance: cython.double
) -> cython.void:
    """``P ← F P Fᵀ + Q``; the gyro's noise acts across q, the bias walks."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    for i in range(4):
        for j in range(7):
            total = 0.0
            for k in range(4):
                total += t[_A + 4 * i + k] * s[_P + 7 * k + j]
            for k in range(3):
                total += t[_B + 3 * i + k] * s[_P + 7 * (4 + k) + j]
            t[_FP + 7 * i + j] = total
    for i in range(4):
        for j in range(i, 4):
            total = -0.25 * gyr_variance * s[i] * s[j]
            if i == j:
                total += 0.25 * gyr_variance
            for k in range(4):
                total += t[_FP + 7 * i + k] * t[_A + 4 * j + k]
            for k in range(3):
                total += t[_FP + 7 * i + 4 + k] * t[_B + 3 * j + k]
            s[_P + 7 * i + j] = total
            s[_P + 7 * j + i] = total
        for j in range(4, 7):
            s[_P + 7 * i + j] = t[_FP + 7 * i + j]
            s[_P + 7 * j + i] = t[_FP + 7 * i + j]
    for i in range(4, 7):
        s[_P + 8 * i] += bias_variance


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _correct(
    s: cython.double[::1],
    t: cython.double[::1],
    innovation: cython.double,
    variance: cython.double,
    bounded: cython.bint,
) -> cython.void:
    """Kalman correction by one number whose Jacobian with respect to q stands in ``scratch`` at 84.

    Where ``bounded``, an innovation beyond 3 sigma has its variance raised until it is 3 sigma: right for a heading in
    a disturbed field, wrong for acceleration, which averages out over bounded motion only if nothing is cut off.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    total: cython.double = 0.0
    for i in range(7):
        t[_PH + i] = 0.0
        for j in range(4):
            t[_PH + i] += s[_P + 7 * i + j] * t[_H + j]
    for i in range(4):
        total += t[_H + i] * t[_PH + i]
    total += variance
    if bounded and innovation * innovation > 9.0 * total:
        total = innovation * innovation / 9.0
    for i in range(7):
        s[i] += t[_PH + i] / total * innovation
        for j in range(i, 7):
            s[_P + 7 * i + j] -= t[_PH + i] * t[_PH + j] / total
            s[_P + 7 * j + i] = s[_P + 7 * i + j]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _renormalise(s: cython.double[::1], t: cython.double[::1]) -> cython.void:
    """``q ← q/‖q‖`` and ``P ← N P Nᵀ`` with ``N = I − q qᵀ``, the Jacobian of that division for q of unit length."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    along: cython.double = 0.0
    norm: cython.double = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3])
    for i in range(4):
        s[i] /= norm
    for i in range(7):
        t[_U + i] = 0.0
        for j in range(4):
            t[_U + i] += s[_P + 7 * i + j] * s[j]
    for i in range(4):
        along += s[i] * t[_U + i]
    for i in range(4):
        for j in range(i, 4):
            s[_P + 7 * i + j] += s[i] * s[j] * along - s[i] * t[_U + j] - t[_U + i] * s[j]
            s[_P + 7 * j + i] = s[_P + 7 * i + j]
        for j in range(4, 7):
            s[_P + 7 * i + j] -= s[i] * t[_U + j]
            s[_P + 7 * j + i] = s[_P + 7 * i + j]


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def predicted_up(q: cython.double[::1], axis: cython.int, jacobian: cython.double[::1]) -> cython.double:
    """Return component ``axis`` of ``d(q) = R(q)ᵀ ẑ`` and put its derivative by q (4,) into ``jacobian``."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    if axis == 0:
        jacobian[0] = -2.0 * y
        jacobian[1] = 2.0 * z
        jacobian[2] = -2.0 * w
        jacobian[3] = 2.0 * x
        return 2.0 * (x * z - w * y)
    if axis == 1:
        jacobian[0] = 2.0 * x
        jacobian[1] = 2.0 * w
        jacobian[2] = 2.0 * z
        jacobian[3] = 2.0 * y
        return 2.0 * (y * z + w * x)
    jacobian[0] = 0.0
    jacobian[1] = -4.0 * x
    jacobian[2] = -4.0 * y
    jacobian[3] = 0.0
    return 1.0 - 2.0 * (x * x + y * y)


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def heading_innovation(
    q: cython.double[::1], mx: cython.double, my: cython.double, mz: cython.double, jacobian: cython.double[::1]
) -> cython.double:
    """Return by how much the yaw must grow to lay the tilt-compensated field on north, and the derivative of the yaw.

    ``jacobian`` (4,) is that of a turn about world up alone, so that a wrong field cannot tilt the attitude.
    """
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    east: cython.double = (1.0 - 2.0 * (y * y + z * z)) * mx + 2.0 * (x * y - w * z) * my + 2.0 * (x * z + w * y) * mz
    north: cython.double = 2.0 * (x * y + w * z) * mx + (1.0 - 2.0 * (x * x + z * z)) * my + 2.0 * (y * z - w * x) * mz
    jacobian[0] = -2.0 * z
    jacobian[1] = -2.0 * y
    jacobian[2] = 2.0 * x
    jacobian[3] = 2.0 * w
    return atan2(east, north)


def ekf7(
    turn: cython.double[:, ::1],
    dt_s: cython.double[::1],
    acc_g: cython.double[:, ::1],
    acc_weight: cython.double[::1],
    mag: cython.double[:, ::1],
    mag_weight: cython.double[::1],
    gyr_noise: cython.double,
    bias_walk: cython.double,
    acc_noise: cython.double,
    heading_noise: cython.double,
    state: cython.double[::1],
    scratch: cython.double[::1],
    out: cython.double[:, ::1],
    out_bias: cython.double[:, ::1],
) -> None:
    """Extended Kalman filter over quaternion and gyro bias (P0): accelerometer vector and tilt-compensated heading.

    Noises are densities, so that the sample rate does not change their meaning: ``gyr_noise`` rad/s/√Hz,
    ``bias_walk`` rad/s/√s, ``acc_noise`` g/√Hz, ``heading_noise`` rad/√Hz; a reading's variance is noise²/(dt·weight).
    ``state`` (56,), ``scratch`` (92,), ``out`` (n, 4), ``out_bias`` (n, 3) rad/s.
    """
    n: cython.Py_ssize_t = turn.shape[0]
    has_mag: cython.bint = mag.shape[0] == n
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    axis: cython.int
    dt: cython.double
    value: cython.double
    with cython.nogil:
        for k in range(n):
            dt = dt_s[k]
            transition(
                state, turn[k, 0] - state[4] * dt, turn[k, 1] - state[5] * dt, turn[k, 2] - state[6] * dt, dt, scratch
            )
            _spread(state, scratch, gyr_noise * gyr_noise * dt, bias_walk * bias_walk * dt)
            if acc_weight[k] > 0.0 and dt > 0.0:
                for axis in range(3):
                    value = predicted_up(state, axis, scratch[_H:])
                    _correct(
                        state, scratch, acc_g[k, axis] - value, acc_noise * acc_noise / (dt * acc_weight[k]), False
                    )
            if has_mag and mag_weight[k] > 0.0 and dt > 0.0:
                value = heading_innovation(state, mag[k, 0], mag[k, 1], mag[k, 2], scratch[_H:])
                _correct(state, scratch, value, heading_noise * heading_noise / (dt * mag_weight[k]), True)
            _renormalise(state, scratch)
            for j in range(4):
                out[k, j] = state[j]
            for j in range(3):
                out_bias[k, j] = state[4 + j]
