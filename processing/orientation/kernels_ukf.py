"""The recursion of the unscented filter USQUE, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`. J. L. Crassidis, F. L. Markley,
"Unscented filtering for spacecraft attitude estimation", JGCD 26 (2003) 536–542: the attitude's error is a generalised
Rodrigues vector (a = 1, f = 4: for small errors the rotation vector), laid in the sensor's frame. ``state`` holds
q (4), the bias in rad/s (3) and the covariance of (error, bias) (6 × 6, row by row).
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import atan2, cos, sin, sqrt

COMPILED: bool = cython.compiled
STATE_SIZE: int = 43
SCRATCH_SIZE: int = 304

_LAMBDA = cython.declare(cython.double, 1.0)
_SPAN = cython.declare(cython.double, 7.0)  # n + λ
_MOST_HEADING = cython.declare(cython.double, 0.2)  # rad
# places in state and scratch
_B = cython.declare(cython.int, 4)
_P = cython.declare(cython.int, 7)
_L = cython.declare(cython.int, 0)  # Cholesky factor (6 × 6)
_POINTS = cython.declare(cython.int, 36)  # 13 points of (error 3, bias 3, up 3, yaw 1)
_C = cython.declare(cython.int, 166)  # joint covariance of state and readings (10 × 10)
_MEAN = cython.declare(cython.int, 266)  # joint mean (10)
_Q = cython.declare(cython.int, 276)  # predicted attitude of the middle point (4)
_E0 = cython.declare(cython.int, 280)  # turn of the middle point (4)
_D = cython.declare(cython.int, 284)  # (4)
_E = cython.declare(cython.int, 288)  # (6)
_GAIN = cython.declare(cython.int, 294)  # (10)


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _exp(
    rx: cython.double, ry: cython.double, rz: cython.double, t: cython.double[::1], at: cython.Py_ssize_t
) -> cython.void:
    """Put the quaternion ``exp(r)`` into scratch (slices would cost: they count references)."""
    square: cython.double = rx * rx + ry * ry + rz * rz
    f: cython.double
    if square < 0.06:  # the series to rounding: a sample's turn is small, and sine and cosine would cost most of all
        t[at] = 1.0 - square * 0.125 * (
            1.0 - square * (1.0 / 48.0) * (1.0 - square * (1.0 / 120.0) * (1.0 - square * (1.0 / 224.0)))
        )
        f = 0.5 - square * (1.0 / 48.0) * (
            1.0 - square * (1.0 / 80.0) * (1.0 - square * (1.0 / 168.0) * (1.0 - square * (1.0 / 288.0)))
        )
    else:
        angle: cython.double = sqrt(square)
        t[at] = cos(0.5 * angle)
        f = sin(0.5 * angle) / angle
    t[at + 1] = f * rx
    t[at + 2] = f * ry
    t[at + 3] = f * rz


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _multiply(
    p: cython.double[::1], i: cython.Py_ssize_t, q: cython.double[::1], j: cython.Py_ssize_t, sign: cython.double,
    out: cython.double[::1], at: cython.Py_ssize_t,
) -> cython.void:  # fmt: skip
    """``out ← p ⊗ q`` for ``sign`` 1, ``p* ⊗ q`` for −1, each at its place; ``out`` may be either."""
    w: cython.double = p[i]
    x: cython.double = sign * p[i + 1]
    y: cython.double = sign * p[i + 2]
    z: cython.double = sign * p[i + 3]
    a: cython.double = q[j]
    b: cython.double = q[j + 1]
    c: cython.double = q[j + 2]
    d: cython.double = q[j + 3]
    out[at] = w * a - x * b - y * c - z * d
    out[at + 1] = w * b + x * a + y * d - z * c
    out[at + 2] = w * c - x * d + y * a + z * b
    out[at + 3] = w * d + x * c - y * b + z * a


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def error_quaternion(
    px: cython.double, py: cython.double, pz: cython.double, out: cython.double[::1], at: cython.Py_ssize_t
) -> cython.void:
    """Put the quaternion of the error vector ``p`` into ``out`` at ``at`` (Crassidis, Markley eq. 21; a = 1, f = 4)."""
    square: cython.double = px * px + py * py + pz * pz
    out[at] = (16.0 - square) / (16.0 + square)
    out[at + 1] = 0.25 * (1.0 + out[at]) * px
    out[at + 2] = 0.25 * (1.0 + out[at]) * py
    out[at + 3] = 0.25 * (1.0 + out[at]) * pz


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _factor(
    s: cython.double[::1], t: cython.double[::1], gyr_variance: cython.double, bias_variance: cython.double
) -> cython.void:
    """Put the Cholesky factor of ``(n + λ)(P + Q)`` into scratch; a direction of no uncertainty gets none."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    for i in range(6):
        for j in range(i + 1):
            total = s[_P + 6 * i + j]
            if i == j:
                total += gyr_variance if i < 3 else bias_variance
            total *= _SPAN
            for k in range(j):
                total -= t[_L + 6 * i + k] * t[_L + 6 * j + k]
            if i == j:
                t[_L + 7 * i] = sqrt(total) if total > 0.0 else 0.0
                t[_D + i] = 1.0 / t[_L + 7 * i] if total > 0.0 else 0.0
            else:
                t[_L + 6 * i + j] = total * t[_D + j] if t[_L + 7 * j] > 0.0 else 0.0
        for j in range(i + 1, 6):
            t[_L + 6 * i + j] = 0.0


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _twice_atan(y: cython.double, x: cython.double) -> cython.double:
    """Return ``2 atan2(y, x)``, by the series to rounding where the angle is small."""
    t: cython.double = y / x if x > 0.0 else 1.0
    if -0.1 < t < 0.1:
        x = t * t
        return (
            2.0
            * t
            * (
                1.0
                - x * (1.0 / 3.0 - x * (0.2 - x * (1.0 / 7.0 - x * (1.0 / 9.0 - x * (1.0 / 11.0 - x * (1.0 / 13.0))))))
            )
        )
    return 2.0 * atan2(y, x)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _points(
    s: cython.double[::1], t: cython.double[::1], rx: cython.double, ry: cython.double, rz: cython.double,
    dt_s: cython.double,
) -> cython.void:  # fmt: skip
    """Spread the sigma points, turn each by its own rate, and lay beside each what the readings would be.

    A point's error after the turn is ``exp(r₀)* ⊗ δq ⊗ exp(r)``. Its readings: up in the sensor's frame, and its yaw
    about up against that of the middle point.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    at: cython.Py_ssize_t
    sign: cython.double
    ux: cython.double
    uy: cython.double
    uz: cython.double
    dx: cython.double
    dy: cython.double
    dz: cython.double
    w: cython.double
    x: cython.double
    y: cython.double
    z: cython.double
    _exp(rx - s[_B] * dt_s, ry - s[_B + 1] * dt_s, rz - s[_B + 2] * dt_s, t, _E0)
    _multiply(s, 0, t, _E0, 1.0, t, _Q)
    w = t[_Q]
    x = t[_Q + 1]
    y = t[_Q + 2]
    z = t[_Q + 3]
    ux = 2.0 * (x * z - w * y)
    uy = 2.0 * (y * z + w * x)
    uz = 1.0 - 2.0 * (x * x + y * y)
    for i in range(13):
        at = _POINTS + 10 * i
        j = (i - 1) % 6
        sign = 0.0 if i == 0 else 1.0 if i < 7 else -1.0
        t[at + 3] = s[_B] + sign * t[_L + 18 + j]
        t[at + 4] = s[_B + 1] + sign * t[_L + 24 + j]
        t[at + 5] = s[_B + 2] + sign * t[_L + 30 + j]
        if i == 0:
            w = 1.0
            x = y = z = 0.0
        else:
            _exp(rx - t[at + 3] * dt_s, ry - t[at + 4] * dt_s, rz - t[at + 5] * dt_s, t, _E)
            if j < 3:  # the factor is triangular: the last three points have no error of attitude yet
                error_quaternion(sign * t[_L + j], sign * t[_L + 6 + j], sign * t[_L + 12 + j], t, _D)
                _multiply(t, _D, t, _E, 1.0, t, _E)
            _multiply(t, _E0, t, _E, -1.0, t, _D)
            w = t[_D]
            x = t[_D + 1]
            y = t[_D + 2]
            z = t[_D + 3]
        sign = 4.0 / (1.0 + w)
        t[at] = sign * x
        t[at + 1] = sign * y
        t[at + 2] = sign * z
        # R(δq)ᵀ u = u − 2 w (v × u) + 2 v × (v × u)
        dx = y * uz - z * uy
        dy = z * ux - x * uz
        dz = x * uy - y * ux
        t[at + 6] = ux - 2.0 * (w * dx - y * dz + z * dy)
        t[at + 7] = uy - 2.0 * (w * dy - z * dx + x * dz)
        t[at + 8] = uz - 2.0 * (w * dz - x * dy + y * dx)
        t[at + 9] = _twice_atan(x * ux + y * uy + z * uz, w)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _moments(t: cython.double[::1], gyr_variance: cython.double, bias_variance: cython.double) -> cython.void:
    """Put mean and covariance of state and readings, as the points have them, into scratch; Q is added to the state."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t
    total: cython.double
    second: cython.double
    third: cython.double
    for j in range(10):
        total = 0.0
        for k in range(1, 13):
            total += t[_POINTS + 10 * k + j]
        t[_MEAN + j] = (_LAMBDA * t[_POINTS + j] + 0.5 * total) / _SPAN
    for k in range(13):
        at = _POINTS + 10 * k
        for j in range(10):
            t[at + j] -= t[_MEAN + j]
    for i in range(10):
        for j in range(i, 10):
            total = 2.0 * _LAMBDA * t[_POINTS + i] * t[_POINTS + j]
            second = third = 0.0
            for k in range(1, 13, 3):  # three sums, so that no addition waits for the one before
                at = _POINTS + 10 * k
                total += t[at + i] * t[at + j]
                second += t[at + 10 + i] * t[at + 10 + j]
                third += t[at + 20 + i] * t[at + 20 + j]
            total = (total + second + third) * 0.5 / _SPAN
            if i == j and i < 6:
                total += gyr_variance if i < 3 else bias_variance
            t[_C + 10 * i + j] = total
            t[_C + 10 * j + i] = total


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _read(
    t: cython.double[::1], which: cython.Py_ssize_t, value: cython.double, variance: cython.double, bounded: cython.bint
) -> cython.void:
    """Condition state and further readings on the reading of component ``which``.

    With independent errors, one after the other is the same as all at once. Where ``bounded``, an innovation beyond 3
    sigma has its variance raised until it is 3 sigma.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    gain: cython.double
    innovation: cython.double = value - t[_MEAN + which]
    total: cython.double = t[_C + 11 * which] + variance
    if bounded and innovation * innovation > 9.0 * total:
        total = innovation * innovation / 9.0
    for i in range(10):
        t[_GAIN + i] = t[_C + 10 * which + i]
    total = 1.0 / total
    for i in range(10):
        gain = t[_GAIN + i] * total
        t[_MEAN + i] += gain * innovation
        for j in range(i, 10):
            t[_C + 10 * i + j] -= gain * t[_GAIN + j]
            t[_C + 10 * j + i] = t[_C + 10 * i + j]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _bound_heading(s: cython.double[::1], t: cython.double[::1]) -> cython.void:
    """``P ← T P Tᵀ`` with ``T = I − (1 − limit/σ) u uᵀ`` where the sigma σ of the turn about up ``u`` is beyond it.

    Without a field nothing tells the heading and its variance would grow for ever, until the points lay all round the
    compass; what it is called does not matter then, and no reading depends on it.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    variance: cython.double = 0.0
    share: cython.double
    t[_E] = 2.0 * (s[1] * s[3] - s[0] * s[2])
    t[_E + 1] = 2.0 * (s[2] * s[3] + s[0] * s[1])
    t[_E + 2] = 1.0 - 2.0 * (s[1] * s[1] + s[2] * s[2])
    for i in range(6):
        t[_GAIN + i] = 0.0
        for j in range(3):
            t[_GAIN + i] += s[_P + 6 * i + j] * t[_E + j]
    for i in range(3):
        variance += t[_E + i] * t[_GAIN + i]
    if variance > _MOST_HEADING * _MOST_HEADING:
        share = 1.0 - _MOST_HEADING / sqrt(variance)
        for i in range(3, 6):
            t[_E + i] = 0.0
        for i in range(6):
            for j in range(i, 6):
                s[_P + 6 * i + j] += (
                    share * share * variance * t[_E + i] * t[_E + j]
                    - share * t[_GAIN + i] * t[_E + j]
                    - share * t[_E + i] * t[_GAIN + j]
                )
                s[_P + 6 * j + i] = s[_P + 6 * i + j]


def ukf(
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
    """Unscented filter over attitude and gyro bias: accelerometer vector and tilt-compensated heading.

    Noises are the densities of :func:`processing.orientation.kernels_ekf7.ekf7`, and so are the readings.
    ``state`` (43,), ``scratch`` (304,), ``out`` (n, 4), ``out_bias`` (n, 3) rad/s.
    """
    n: cython.Py_ssize_t = turn.shape[0]
    has_mag: cython.bint = mag.shape[0] == n
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    dt: cython.double
    w: cython.double
    x: cython.double
    y: cython.double
    z: cython.double
    qg: cython.double
    qb: cython.double
    east: cython.double
    north: cython.double
    with cython.nogil:
        for k in range(n):
            dt = dt_s[k]
            # the trapezoidal rule of eq. 41: half of Q before the step, half after
            qg = 0.5 * dt * (gyr_noise * gyr_noise - bias_walk * bias_walk * dt * dt / 6.0)
            qb = 0.5 * dt * bias_walk * bias_walk
            _factor(state, scratch, qg, qb)
            _points(state, scratch, turn[k, 0], turn[k, 1], turn[k, 2], dt)
            _moments(scratch, qg, qb)
            if acc_weight[k] > 0.0 and dt > 0.0:
                for j in range(3):
                    _read(scratch, 6 + j, acc_g[k, j], acc_noise * acc_noise / (dt * acc_weight[k]), False)
            if has_mag and mag_weight[k] > 0.0 and dt > 0.0:
                w = scratch[_Q]
                x = scratch[_Q + 1]
                y = scratch[_Q + 2]
                z = scratch[_Q + 3]
                east = (
                    (1.0 - 2.0 * (y * y + z * z)) * mag[k, 0]
                    + 2.0 * (x * y - w * z) * mag[k, 1]
                    + 2.0 * (x * z + w * y) * mag[k, 2]
                )
                north = (
                    2.0 * (x * y + w * z) * mag[k, 0]
                    + (1.0 - 2.0 * (x * x + z * z)) * mag[k, 1]
                    + 2.0 * (y * z - w * x) * mag[k, 2]
                )
                _read(scratch, 9, atan2(east, north), heading_noise * heading_noise / (dt * mag_weight[k]), True)
            error_quaternion(scratch[_MEAN], scratch[_MEAN + 1], scratch[_MEAN + 2], scratch, _D)
            _multiply(scratch, _Q, scratch, _D, 1.0, state, 0)
            w = 1.0 / sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2] + state[3] * state[3])
            for j in range(4):
                state[j] *= w
                out[k, j] = state[j]
            for j in range(3):
                state[_B + j] = scratch[_MEAN + 3 + j]
                out_bias[k, j] = state[_B + j]
            for i in range(6):
                for j in range(6):
                    state[_P + 6 * i + j] = scratch[_C + 10 * i + j]
            _bound_heading(state, scratch)
