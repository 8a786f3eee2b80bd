"""The recursion of the error-state Kalman filter: attitude, gyro bias and velocity, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`. The error is laid in the world:
``q_true = exp(θ) ⊗ q``, so that the heading is the third component alone and a magnetic reading can be kept from
tilting anything. ``state`` holds q (4), bias b in rad/s (3), velocity v in m/s (3), the covariance of (θ, b, v)
(9 × 9, row by row), and what tells a rest: smoothed rates (3) and specific force (3), seconds of quiet, 1 once begun.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import atan2, cos, fabs, sin, sqrt

COMPILED: bool = cython.compiled
STATE_SIZE: int = 99
SCRATCH_SIZE: int = 144
GRAVITY_MPS2: float = 9.80665

# places in state and scratch
_B = cython.declare(cython.int, 4)
_V = cython.declare(cython.int, 7)
_P = cython.declare(cython.int, 10)
_SLOW = cython.declare(cython.int, 91)
_QUIET = cython.declare(cython.int, 97)
_BEGUN = cython.declare(cython.int, 98)
_M = cython.declare(cython.int, 0)  # F P (9 × 9)
_R = cython.declare(cython.int, 81)  # R(q) (3 × 3), row by row
_MEAN = cython.declare(cython.int, 90)  # mean of R before and after the turn
_A = cython.declare(cython.int, 99)  # specific force in the world, m/s²
_X = cython.declare(cython.int, 102)  # error state (9)
_K = cython.declare(cython.int, 111)  # gain (9)
_H = cython.declare(cython.int, 120)  # P Hᵀ (9)
_G = cython.declare(cython.double, 9.80665)
_QUIET_TAU_S = cython.declare(cython.double, 0.5)
_REST_AFTER_S = cython.declare(cython.double, 1.5)


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _unit(s: cython.double[::1]) -> cython.void:
    norm: cython.double = 1.0 / sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3])
    s[0] *= norm
    s[1] *= norm
    s[2] *= norm
    s[3] *= norm


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _half_turn(rx: cython.double, ry: cython.double, rz: cython.double, t: cython.double[::1]) -> cython.void:
    """Put the quaternion ``exp(r)`` into scratch where the gain stands later."""
    square: cython.double = rx * rx + ry * ry + rz * rz
    f: cython.double
    if square < 0.06:  # the series to rounding: a sample's turn is small, and sine and cosine would cost most of all
        u: cython.double = square * (1.0 / 24.0)
        t[_K] = 1.0 - 3.0 * u * (1.0 - 0.5 * u * (1.0 - 0.2 * u * (1.0 - u * (3.0 / 28.0))))
        f = 0.5 - 0.5 * u * (1.0 - 0.3 * u * (1.0 - u * (1.0 / 7.0) * (1.0 - u * (1.0 / 12.0))))
    else:
        angle: cython.double = sqrt(square)
        t[_K] = cos(0.5 * angle)
        f = sin(0.5 * angle) / angle
    t[_K + 1] = f * rx
    t[_K + 2] = f * ry
    t[_K + 3] = f * rz


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _multiply(s: cython.double[::1], t: cython.double[::1], before: cython.bint) -> cython.void:
    """``q ← e ⊗ q`` (``before``) or ``q ⊗ e`` with the e that :func:`_half_turn` left, of unit length."""
    w: cython.double = s[0]
    x: cython.double = s[1]
    y: cython.double = s[2]
    z: cython.double = s[3]
    a: cython.double = t[_K]
    b: cython.double = t[_K + 1]
    c: cython.double = t[_K + 2]
    d: cython.double = t[_K + 3]
    sign: cython.double = -1.0 if before else 1.0
    s[0] = w * a - x * b - y * c - z * d
    s[1] = w * b + x * a + sign * (y * d - z * c)
    s[2] = w * c + y * a + sign * (z * b - x * d)
    s[3] = w * d + z * a + sign * (x * c - y * b)
    _unit(s)


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _matrix(q: cython.double[::1], t: cython.double[::1]) -> cython.void:
    """Put ``R(q)`` (3 × 3, row by row) into scratch: it turns the sensor's vectors into the world."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    t[_R] = 1.0 - 2.0 * (y * y + z * z)
    t[_R + 1] = 2.0 * (x * y - w * z)
    t[_R + 2] = 2.0 * (x * z + w * y)
    t[_R + 3] = 2.0 * (x * y + w * z)
    t[_R + 4] = 1.0 - 2.0 * (x * x + z * z)
    t[_R + 5] = 2.0 * (y * z - w * x)
    t[_R + 6] = 2.0 * (x * z - w * y)
    t[_R + 7] = 2.0 * (y * z + w * x)
    t[_R + 8] = 1.0 - 2.0 * (x * x + y * y)


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def propagate(
    s: cython.double[::1], t: cython.double[::1], rx: cython.double, ry: cython.double, rz: cython.double,
    dt_s: cython.double, ax: cython.double, ay: cython.double, az: cython.double, moves: cython.bint,
) -> cython.void:  # fmt: skip
    """Move attitude and velocity over one sample: rotation vector ``r`` with the bias in it, specific force in g.

    ``scratch`` must hold ``R(q)`` at 81 and holds that of the new q afterwards; the mean of both, with which the
    covariance moves, is left at 90 and the specific force in the world, m/s², at 99: it is turned by the attitude of
    its own moment, the new one. Without ``moves`` (the accelerometer is not to be believed) the velocity is left alone.
    """
    i: cython.Py_ssize_t
    _half_turn(rx - s[_B] * dt_s, ry - s[_B + 1] * dt_s, rz - s[_B + 2] * dt_s, t)
    _multiply(s, t, False)
    for i in range(9):
        t[_MEAN + i] = 0.5 * t[_R + i]
    _matrix(s, t)
    for i in range(9):
        t[_MEAN + i] += 0.5 * t[_R + i]
    for i in range(3):
        t[_A + i] = 0.0
        if moves:
            t[_A + i] = _G * (t[_R + 3 * i] * ax + t[_R + 3 * i + 1] * ay + t[_R + 3 * i + 2] * az)
            s[_V + i] += t[_A + i] * dt_s
    if moves:
        s[_V + 2] -= _G * dt_s


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def spread(
    s: cython.double[::1], t: cython.double[::1], dt_s: cython.double, gyr_variance: cython.double,
    bias_variance: cython.double, acc_variance: cython.double,
) -> cython.void:  # fmt: skip
    """``P ← F P Fᵀ + Q`` with ``θ' = θ − R̄ b dt`` and ``v' = v − [a]× θ dt``, ``R̄`` and ``a`` as left in scratch.

    Of θ only the tilt acts on v: the velocity is told in the axes of the estimate, and turns with its heading, so that
    a heading of which nothing is known does no harm.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    bx: cython.double
    by: cython.double
    bz: cython.double
    ax: cython.double = t[_A] * dt_s
    ay: cython.double = t[_A + 1] * dt_s
    az: cython.double = t[_A + 2] * dt_s
    for j in range(9):
        bx = s[_P + 27 + j] * dt_s
        by = s[_P + 36 + j] * dt_s
        bz = s[_P + 45 + j] * dt_s
        for i in range(3):
            t[_M + 9 * i + j] = s[_P + 9 * i + j] - (
                t[_MEAN + 3 * i] * bx + t[_MEAN + 3 * i + 1] * by + t[_MEAN + 3 * i + 2] * bz
            )
            t[_M + 27 + 9 * i + j] = s[_P + 27 + 9 * i + j]
        t[_M + 54 + j] = s[_P + 54 + j] + az * s[_P + 9 + j]
        t[_M + 63 + j] = s[_P + 63 + j] - az * s[_P + j]
        t[_M + 72 + j] = s[_P + 72 + j] - (ax * s[_P + 9 + j] - ay * s[_P + j])
    for i in range(9):
        bx = t[_M + 9 * i + 3] * dt_s
        by = t[_M + 9 * i + 4] * dt_s
        bz = t[_M + 9 * i + 5] * dt_s
        for j in range(3):
            s[_P + 9 * i + j] = t[_M + 9 * i + j] - (
                t[_MEAN + 3 * j] * bx + t[_MEAN + 3 * j + 1] * by + t[_MEAN + 3 * j + 2] * bz
            )
            s[_P + 9 * i + 3 + j] = t[_M + 9 * i + 3 + j]
        s[_P + 9 * i + 6] = t[_M + 9 * i + 6] + az * t[_M + 9 * i + 1]
        s[_P + 9 * i + 7] = t[_M + 9 * i + 7] - az * t[_M + 9 * i]
        s[_P + 9 * i + 8] = t[_M + 9 * i + 8] - (ax * t[_M + 9 * i + 1] - ay * t[_M + 9 * i])
    for i in range(3):
        s[_P + 10 * i] += gyr_variance
        s[_P + 30 + 10 * i] += bias_variance
        s[_P + 60 + 10 * i] += acc_variance
    for i in range(9):
        for j in range(i):
            s[_P + 9 * i + j] = s[_P + 9 * j + i]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _correct(
    s: cython.double[::1], t: cython.double[::1], which: cython.Py_ssize_t, innovation: cython.double,
    variance: cython.double,
) -> cython.void:  # fmt: skip
    """Correct by a reading of component ``which`` of the error, whose estimate so far stands in scratch."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    total: cython.double = s[_P + 10 * which] + variance
    innovation -= t[_X + which]
    for i in range(9):
        t[_H + i] = s[_P + 9 * which + i]
    total = 1.0 / total
    for i in range(9):
        t[_K + i] = t[_H + i] * total
        t[_X + i] += t[_K + i] * innovation
        for j in range(i + 1):
            s[_P + 9 * i + j] -= t[_K + i] * t[_H + j]
            s[_P + 9 * j + i] = s[_P + 9 * i + j]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _correct_heading(
    s: cython.double[::1], t: cython.double[::1], innovation: cython.double, variance: cython.double
) -> cython.void:
    """Correct the heading, and of the bias its part about up; tilt and velocity are left alone (a consider filter)."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    about_up: cython.double = 0.0
    total: cython.double = s[_P + 20] + variance
    innovation -= t[_X + 2]
    for i in range(9):
        t[_H + i] = s[_P + 18 + i]
        t[_K + i] = 0.0
    t[_K + 2] = t[_H + 2] / total
    for i in range(3):
        about_up += t[_R + 6 + i] * t[_H + 3 + i] / total
    for i in range(3):
        t[_K + 3 + i] = t[_R + 6 + i] * about_up
    for i in range(6):
        t[_X + i] += t[_K + i] * innovation
    for i in range(9):
        for j in range(i + 1):
            s[_P + 9 * i + j] += t[_K + i] * t[_K + j] * total - t[_K + i] * t[_H + j] - t[_H + i] * t[_K + j]
            s[_P + 9 * j + i] = s[_P + 9 * i + j]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _inject(s: cython.double[::1], t: cython.double[::1]) -> cython.void:
    """Put the error state into the state and forget it; the velocity turns with the heading."""
    i: cython.Py_ssize_t
    c: cython.double
    d: cython.double
    x: cython.double
    _half_turn(t[_X], t[_X + 1], t[_X + 2], t)
    _multiply(s, t, True)
    _matrix(s, t)
    for i in range(3):
        s[_B + i] += t[_X + 3 + i]
        s[_V + i] += t[_X + 6 + i]
    c = cos(t[_X + 2])
    d = sin(t[_X + 2])
    x = s[_V]
    s[_V] = c * x - d * s[_V + 1]
    s[_V + 1] = d * x + c * s[_V + 1]
    for i in range(9):
        t[_X + i] = 0.0


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _rests(
    s: cython.double[::1], turn: cython.double[:, ::1], acc_g: cython.double[:, ::1], k: cython.Py_ssize_t,
    dt_s: cython.double, rest_radps: cython.double, rest_g: cython.double,
) -> cython.bint:  # fmt: skip
    """Return whether rates and specific force have kept close to their own smoothed values for long enough."""
    i: cython.Py_ssize_t
    off: cython.double
    rate_off: cython.double = 0.0
    acc_off: cython.double = 0.0
    gain: cython.double = dt_s / (_QUIET_TAU_S + dt_s)
    quiet: cython.bint = True
    if s[_BEGUN] == 0.0:
        gain = 1.0
        s[_BEGUN] = 1.0
    for i in range(3):
        off = turn[k, i] / dt_s - s[_SLOW + i]
        s[_SLOW + i] += gain * off
        rate_off += (1.0 - gain) * off * (1.0 - gain) * off
        off = acc_g[k, i] - s[_SLOW + 3 + i]
        s[_SLOW + 3 + i] += gain * off
        acc_off += (1.0 - gain) * off * (1.0 - gain) * off
        if fabs(s[_SLOW + i] - s[_B + i]) > rest_radps:
            quiet = False
    if rate_off >= rest_radps * rest_radps or acc_off >= rest_g * rest_g:
        quiet = False
    s[_QUIET] = s[_QUIET] + dt_s if quiet else 0.0
    return s[_QUIET] > _REST_AFTER_S


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def heading_sigma(
    east: cython.double, north: cython.double, up: cython.double, sigma: cython.double, dip: cython.double,
    norm_tolerance: cython.double, dip_tolerance: cython.double,
) -> cython.double:  # fmt: skip
    """Return how far a field (in units of the undisturbed one, in the world) may mislead the heading; −1: reject it.

    ``σ √(1 + 4 (Δnorm)² + 16 (Δdip)²)`` with the departures in their tolerances (navigation §6.2).
    """
    level: cython.double = sqrt(east * east + north * north)
    norm_off: cython.double = fabs(sqrt(level * level + up * up) - 1.0) / norm_tolerance
    dip_off: cython.double = fabs(atan2(-up, level) - dip) / dip_tolerance
    if norm_off >= 1.0 or dip_off >= 1.0 or level <= 0.0:
        return -1.0
    return sigma * sqrt(1.0 + 4.0 * norm_off * norm_off + 16.0 * dip_off * dip_off)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _take_heading(
    s: cython.double[::1], t: cython.double[::1], mag: cython.double[:, ::1], k: cython.Py_ssize_t,
    dt_s: cython.double, noise: cython.double[::1],
) -> cython.void:  # fmt: skip
    """Correct the heading by row ``k`` of the field, unless its strength or dip is another's.

    Beyond 3 sigma of what a reading may be off, the reading is doubted by as much as it is off.
    """
    east: cython.double = t[_R] * mag[k, 0] + t[_R + 1] * mag[k, 1] + t[_R + 2] * mag[k, 2]
    north: cython.double = t[_R + 3] * mag[k, 0] + t[_R + 4] * mag[k, 1] + t[_R + 5] * mag[k, 2]
    up: cython.double = t[_R + 6] * mag[k, 0] + t[_R + 7] * mag[k, 1] + t[_R + 8] * mag[k, 2]
    sigma: cython.double = heading_sigma(east, north, up, noise[6], noise[8], noise[9], noise[10])
    if sigma > 0.0:
        value: cython.double = atan2(east, north)
        sigma = max(sigma * sigma, value * value / 9.0 - s[_P + 20])
        _correct_heading(s, t, value, sigma * noise[7] * noise[7] / dt_s)


def eskf(
    turn: cython.double[:, ::1],
    dt_s: cython.double[::1],
    acc_g: cython.double[:, ::1],
    acc_weight: cython.double[::1],
    mag: cython.double[:, ::1],
    mag_weight: cython.double[::1],
    noise: cython.double[::1],
    state: cython.double[::1],
    scratch: cython.double[::1],
    out: cython.double[:, ::1],
    out_bias: cython.double[:, ::1],
) -> None:
    """Error-state Kalman filter over attitude, gyro bias and velocity (navigation §3, note a; Solà 2017).

    The specific force is integrated to a velocity that is known to be bounded: over bounded motion acceleration
    averages out and gravity stays. At rest the velocity and the rate are zero. The field turns the heading alone.
    ``noise`` (13,) holds: gyro rad/s/√Hz, bias walk rad/s/√s, specific force m/s/√s, velocity m/s/√Hz in motion and
    at rest, rate at rest rad/s/√Hz; sigma of the magnetic heading rad and its noise density over that sigma 1/√Hz, the
    field's dip rad, tolerances of norm (1) and dip (rad); largest departure of rate (rad/s) and specific force (g) from
    their means at rest, which begins after 1.5 s of it.
    ``state`` (99,), ``scratch`` (144,), ``out`` (n, 4), ``out_bias`` (n, 3) rad/s.
    """
    n: cython.Py_ssize_t = turn.shape[0]
    has_mag: cython.bint = mag.shape[0] == n
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    dt: cython.double
    value: cython.double
    moves: cython.bint
    still: cython.bint
    with cython.nogil:
        _matrix(state, scratch)
        for j in range(9):
            scratch[_X + j] = 0.0
        for k in range(n):
            dt = dt_s[k]
            moves = acc_weight[k] > 0.0
            propagate(
                state, scratch, turn[k, 0], turn[k, 1], turn[k, 2], dt, acc_g[k, 0], acc_g[k, 1], acc_g[k, 2], moves
            )
            if dt > 0.0:
                value = noise[2] * noise[2] * dt / (acc_weight[k] if moves else 1.0)
                spread(state, scratch, dt, noise[0] * noise[0] * dt, noise[1] * noise[1] * dt, value)
                still = _rests(state, turn, acc_g, k, dt, noise[11], noise[12])
                value = noise[4] if still else noise[3]
                for j in range(3):
                    _correct(state, scratch, 6 + j, -state[_V + j], value * value / dt)
                if still:
                    for j in range(3):
                        _correct(state, scratch, 3 + j, turn[k, j] / dt - state[_B + j], noise[5] * noise[5] / dt)
                if has_mag and mag_weight[k] > 0.0:
                    _take_heading(state, scratch, mag, k, dt, noise)
                _inject(state, scratch)
            for j in range(4):
                out[k, j] = state[j]
                if j < 3:
                    out_bias[k, j] = state[_B + j]
