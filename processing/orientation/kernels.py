"""The per-sample recursions of the attitude estimators, compiled where a compiler built them, plain Python elsewhere.

Cython in pure-Python mode: one source for both. Every kernel advances a flat ``state`` over a block of n samples and
leaves it ready for the next block, so that runs of any length need the memory of one block. Rows are contiguous
float64 arrays: ``turn`` (n, 3) the rotation vector since the sample before (radians, sensor frame), ``dt_s`` (n,),
``acc_g`` (n, 3) specific force in units of local gravity, ``mag`` (n, 3) in any unit; ``acc_weight`` and
``mag_weight`` (n,) lie in 0..1 and 0 skips a reading. World: east, north, up; ``d = R(q)ᵀ ẑ`` is up seen by the sensor.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import atan2, cos, sin, sqrt

COMPILED: bool = cython.compiled


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
def _turn(s: cython.double[::1], rx: cython.double, ry: cython.double, rz: cython.double) -> cython.void:
    """``q ← q ⊗ exp(r)``: the exponential map over the sample."""
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
    q0: cython.double = s[0]
    q1: cython.double = s[1]
    q2: cython.double = s[2]
    q3: cython.double = s[3]
    s[0] = q0 * c - q1 * x - q2 * y - q3 * z
    s[1] = q0 * x + q1 * c + q2 * z - q3 * y
    s[2] = q0 * y - q1 * z + q2 * c + q3 * x
    s[3] = q0 * z + q1 * y - q2 * x + q3 * c
    _unit(s)


def integrate(turn: cython.double[:, ::1], state: cython.double[::1], out: cython.double[:, ::1]) -> None:
    """Integrate the gyro alone; ``state`` is q (4,), ``out`` (n, 4)."""
    n: cython.Py_ssize_t = turn.shape[0]
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    with cython.nogil:
        for k in range(n):
            _turn(state, turn[k, 0], turn[k, 1], turn[k, 2])
            for j in range(4):
                out[k, j] = state[j]


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def gravity_gradient(
    q: cython.double[::1], ax: cython.double, ay: cython.double, az: cython.double, out: cython.double[::1]
) -> cython.void:
    """Put ``Jᵀf`` (4,) of ``f = d(q) − â`` into ``out``: half the gradient of ``‖f‖²`` (Madgwick 2011, eq. 25)."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    f1: cython.double = 2.0 * (x * z - w * y) - ax
    f2: cython.double = 2.0 * (y * z + w * x) - ay
    f3: cython.double = 1.0 - 2.0 * (x * x + y * y) - az
    out[0] = 2.0 * (x * f2 - y * f1)
    out[1] = 2.0 * (z * f1 + w * f2) - 4.0 * x * f3
    out[2] = 2.0 * (z * f2 - w * f1) - 4.0 * y * f3
    out[3] = 2.0 * (x * f1 + y * f2)


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def field_gradient(
    q: cython.double[::1],
    mx: cython.double,
    my: cython.double,
    mz: cython.double,
    north: cython.double,
    up: cython.double,
    out: cython.double[::1],
) -> cython.void:
    """Put ``Jᵀf`` (4,) of ``f = R(q)ᵀ b − m̂`` with ``b = (0, north, up)`` into ``out`` (Madgwick 2011, eq. 31)."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    f1: cython.double = 2.0 * north * (x * y + w * z) + 2.0 * up * (x * z - w * y) - mx
    f2: cython.double = north * (1.0 - 2.0 * (x * x + z * z)) + 2.0 * up * (y * z + w * x) - my
    f3: cython.double = 2.0 * north * (y * z - w * x) + up * (1.0 - 2.0 * (x * x + y * y)) - mz
    out[0] = 2.0 * ((north * z - up * y) * f1 + up * x * f2 - north * x * f3)
    out[1] = 2.0 * ((north * y + up * z) * f1 + (up * w - 2.0 * north * x) * f2 - (north * w + 2.0 * up * x) * f3)
    out[2] = 2.0 * ((north * x - up * w) * f1 + up * z * f2 + (north * z - 2.0 * up * y) * f3)
    out[3] = 2.0 * ((north * w + up * x) * f1 + (up * y - 2.0 * north * z) * f2 + north * y * f3)


def madgwick(
    turn: cython.double[:, ::1],
    dt_s: cython.double[::1],
    acc_g: cython.double[:, ::1],
    acc_weight: cython.double[::1],
    mag: cython.double[:, ::1],
    mag_weight: cython.double[::1],
    beta_radps: cython.double,
    state: cython.double[::1],
    scratch: cython.double[::1],
    out: cython.double[:, ::1],
) -> None:
    """Gradient-descent filter: ``q̇ = ½ q ⊗ ω − β Jᵀf/‖Jᵀf‖`` (Madgwick, Harrison, Vaidyanathan 2011; P1, P3).

    The step never goes beyond the minimum (‖Jᵀf‖/4, Newton's step), so that a perfect reading is kept without chatter.
    The readings' weights scale their gradients and the step. ``state`` is q (4,), ``scratch`` (8,), ``out`` (n, 4).
    """
    n: cython.Py_ssize_t = turn.shape[0]
    has_mag: cython.bint = mag.shape[0] == n
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    with cython.nogil:
        for k in range(n):
            _turn(state, turn[k, 0], turn[k, 1], turn[k, 2])
            _descend(k, dt_s[k], acc_g, acc_weight, mag, mag_weight, has_mag, beta_radps, state, scratch)
            for j in range(4):
                out[k, j] = state[j]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _descend(
    k: cython.Py_ssize_t,
    dt_s: cython.double,
    acc_g: cython.double[:, ::1],
    acc_weight: cython.double[::1],
    mag: cython.double[:, ::1],
    mag_weight: cython.double[::1],
    has_mag: cython.bint,
    beta_radps: cython.double,
    q: cython.double[::1],
    scratch: cython.double[::1],
) -> cython.void:
    """One gradient step of the objectives that the readings of row ``k`` give.

    The part of the gradient along q, by which it would only grow, is taken off before the norm: with it the step would
    depend on how the sensor is mounted.
    """
    wa: cython.double = acc_weight[k]
    wm: cython.double = 0.0
    norm: cython.double
    j: cython.Py_ssize_t
    for j in range(8):
        scratch[j] = 0.0
    norm = sqrt(acc_g[k, 0] * acc_g[k, 0] + acc_g[k, 1] * acc_g[k, 1] + acc_g[k, 2] * acc_g[k, 2])
    if wa > 0.0 and norm > 0.0:
        gravity_gradient(q, acc_g[k, 0] / norm, acc_g[k, 1] / norm, acc_g[k, 2] / norm, scratch)
    else:
        wa = 0.0
    if has_mag:
        norm = sqrt(mag[k, 0] * mag[k, 0] + mag[k, 1] * mag[k, 1] + mag[k, 2] * mag[k, 2])
        if norm > 0.0 and mag_weight[k] > 0.0:
            wm = mag_weight[k]
            _field_reference(q, mag[k, 0] / norm, mag[k, 1] / norm, mag[k, 2] / norm, scratch)
            field_gradient(q, mag[k, 0] / norm, mag[k, 1] / norm, mag[k, 2] / norm, scratch[4], scratch[5], scratch[4:])
    size: cython.double = 0.0
    along: cython.double = 0.0
    for j in range(4):
        scratch[j] = wa * scratch[j] + wm * scratch[4 + j]
        along += scratch[j] * q[j]
    for j in range(4):
        scratch[j] -= along * q[j]
        size += scratch[j] * scratch[j]
    size = sqrt(size)
    if size > 0.0:
        step: cython.double = beta_radps * dt_s * max(wa, wm)
        if step > 0.25 * size:
            step = 0.25 * size
        for j in range(4):
            q[j] -= step * scratch[j] / size
        _unit(q)


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _field_reference(
    q: cython.double[::1], mx: cython.double, my: cython.double, mz: cython.double, scratch: cython.double[::1]
) -> cython.void:
    """The field's horizontal size, laid on north, and its vertical part: magnetic error is limited to heading."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    east: cython.double = (1.0 - 2.0 * (y * y + z * z)) * mx + 2.0 * (x * y - w * z) * my + 2.0 * (x * z + w * y) * mz
    north: cython.double = 2.0 * (x * y + w * z) * mx + (1.0 - 2.0 * (x * x + z * z)) * my + 2.0 * (y * z - w * x) * mz
    scratch[4] = sqrt(east * east + north * north)
    scratch[5] = 2.0 * (x * z - w * y) * mx + 2.0 * (y * z + w * x) * my + (1.0 - 2.0 * (x * x + y * y)) * mz


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def heading_error(q: cython.double[::1], mx: cython.double, my: cython.double, mz: cython.double) -> cython.double:
    """Return the yaw error: how far counter-clockwise (radians) of north ``q`` lays the magnetic field."""
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    east: cython.double = (1.0 - 2.0 * (y * y + z * z)) * mx + 2.0 * (x * y - w * z) * my + 2.0 * (x * z + w * y) * mz
    north: cython.double = 2.0 * (x * y + w * z) * mx + (1.0 - 2.0 * (x * x + z * z)) * my + 2.0 * (y * z - w * x) * mz
    return atan2(-east, north)


def mahony(
    turn: cython.double[:, ::1],
    dt_s: cython.double[::1],
    acc_g: cython.double[:, ::1],
    acc_weight: cython.double[::1],
    mag: cython.double[:, ::1],
    mag_weight: cython.double[::1],
    kp_radps: cython.double,
    ki_radps2: cython.double,
    kp_mag_radps: cython.double,
    bias_limit_radps: cython.double,
    state: cython.double[::1],
    out: cython.double[:, ::1],
    out_bias: cython.double[:, ::1],
) -> None:
    """Complementary filter: ``ω' = ω + Kp e + ∫Ki e``, ``e = â × d`` (Mahony, Hamel, Pflimlin 2008; P1).

    The magnetic error is the angle between the tilt-compensated field and north, laid on up: it turns heading alone.
    The integral is limited, since hard acceleration winds it up. ``state`` is q and the integral (7,); ``out`` (n, 4),
    ``out_bias`` (n, 3) rad/s.
    """
    n: cython.Py_ssize_t = turn.shape[0]
    has_mag: cython.bint = mag.shape[0] == n
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    ex: cython.double
    ey: cython.double
    ez: cython.double
    dx: cython.double
    dy: cython.double
    dz: cython.double
    a: cython.double
    m: cython.double
    dt: cython.double
    with cython.nogil:
        for k in range(n):
            dt = dt_s[k]
            # compare the reading with the attitude of its own moment: turn first, correct then
            _turn(state, turn[k, 0], turn[k, 1], turn[k, 2])
            dx = 2.0 * (state[1] * state[3] - state[0] * state[2])
            dy = 2.0 * (state[2] * state[3] + state[0] * state[1])
            dz = 1.0 - 2.0 * (state[1] * state[1] + state[2] * state[2])
            ex = ey = ez = 0.0
            if acc_weight[k] > 0.0:
                # not normalised: over bounded motion the specific force averages to gravity, its direction does not
                a = acc_weight[k]
                ex = a * (acc_g[k, 1] * dz - acc_g[k, 2] * dy)
                ey = a * (acc_g[k, 2] * dx - acc_g[k, 0] * dz)
                ez = a * (acc_g[k, 0] * dy - acc_g[k, 1] * dx)
            state[4] = _limited(state[4] + ki_radps2 * ex * dt, bias_limit_radps)
            state[5] = _limited(state[5] + ki_radps2 * ey * dt, bias_limit_radps)
            state[6] = _limited(state[6] + ki_radps2 * ez * dt, bias_limit_radps)
            ex *= kp_radps
            ey *= kp_radps
            ez *= kp_radps
            if has_mag and mag_weight[k] > 0.0:
                m = heading_error(state, mag[k, 0], mag[k, 1], mag[k, 2])
                m = -kp_mag_radps * mag_weight[k] * sin(m)
                ex += m * dx
                ey += m * dy
                ez += m * dz
            _turn(state, (ex + state[4]) * dt, (ey + state[5]) * dt, (ez + state[6]) * dt)
            for j in range(4):
                out[k, j] = state[j]
            for j in range(3):
                out_bias[k, j] = -state[4 + j]


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _limited(value: cython.double, limit: cython.double) -> cython.double:
    if value > limit:
        return limit
    if value < -limit:
        return -limit
    return value
