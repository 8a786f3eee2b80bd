"""The recursion of the zero-velocity aided filter, compiled where a compiler built it; the smoother is beside it.

Cython in pure-Python mode. The nominal state is 16 numbers: p (3) and v (3) in the world, q (4) sensor to world, the
accelerometer's offset (3) and the gyro's (3). The error state is 15: δp, δv, δθ (rotation vector in the world,
``q_true = exp(δθ) ⊗ q``), δb_a, δb_g. Nodes are samples; between them the strapdown runs at the sensor's rate and the
transition is gathered in its blocks, so covariances are only touched at nodes.

Source: Groves 2013, chapter 14 (error model); Skog, Nilsson, Händel 2010 (zero-velocity aiding).
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import atan2, cos, sin, sqrt

COMPILED: bool = cython.compiled
SCRATCH_SIZE: int = 64


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
def _matrix(q: cython.double[::1], m: cython.double[:, ::1]) -> cython.void:
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    m[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    m[0, 1] = 2.0 * (x * y - w * z)
    m[0, 2] = 2.0 * (x * z + w * y)
    m[1, 0] = 2.0 * (x * y + w * z)
    m[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    m[1, 2] = 2.0 * (y * z - w * x)
    m[2, 0] = 2.0 * (x * z - w * y)
    m[2, 1] = 2.0 * (y * z + w * x)
    m[2, 2] = 1.0 - 2.0 * (x * x + y * y)


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
@cython.nogil
@cython.exceptval(check=False)
def _force(
    acc: cython.double[:, ::1], i: cython.Py_ssize_t, x: cython.double[::1], m: cython.double[:, ::1],
    s: cython.double[::1], place: cython.Py_ssize_t,
) -> cython.void:  # fmt: skip
    """Put the specific force of row ``i`` in the world at ``s[place:]``."""
    r: cython.Py_ssize_t
    for r in range(3):
        s[place + r] = m[r, 0] * (acc[i, 0] - x[10]) + m[r, 1] * (acc[i, 1] - x[11]) + m[r, 2] * (acc[i, 2] - x[12])


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _gather(
    phi: cython.double[:, ::1], m: cython.double[:, ::1], dt: cython.double, s: cython.double[::1]
) -> cython.void:
    """Carry the blocks of the transition over one interval; at s[6:] the mean force, s[9:] half of −R dt before it."""
    r: cython.Py_ssize_t
    c: cython.Py_ssize_t
    gained: cython.double
    fx: cython.double = s[6]
    fy: cython.double = s[7]
    fz: cython.double = s[8]
    for c in range(3):
        # δθ at mid-interval in terms of δb_g: what was gathered, and half of this interval's; then −f × of it
        tx: cython.double = s[9 + c] + phi[6, 12 + c]
        ty: cython.double = s[12 + c] + phi[7, 12 + c]
        tz: cython.double = s[15 + c] + phi[8, 12 + c]
        s[18 + c] = fz * ty - fy * tz
        s[21 + c] = fx * tz - fz * tx
        s[24 + c] = fy * tx - fx * ty
    # −f × on δθ itself
    s[27] = 0.0
    s[28] = fz
    s[29] = -fy
    s[30] = -fz
    s[31] = 0.0
    s[32] = fx
    s[33] = fy
    s[34] = -fx
    s[35] = 0.0
    for r in range(3):
        phi[r, 3 + r] += dt
        for c in range(3):
            gained = s[27 + 3 * r + c] * dt
            phi[r, 6 + c] += dt * (phi[3 + r, 6 + c] + 0.5 * gained)
            phi[3 + r, 6 + c] += gained
            gained = -dt * m[r, c]
            phi[r, 9 + c] += dt * (phi[3 + r, 9 + c] + 0.5 * gained)
            phi[3 + r, 9 + c] += gained
            gained = s[18 + 3 * r + c] * dt
            phi[r, 12 + c] += dt * (phi[3 + r, 12 + c] + 0.5 * gained)
            phi[3 + r, 12 + c] += gained
    for r in range(3):
        for c in range(3):
            phi[6 + r, 12 + c] -= dt * m[r, c]


@cython.ccall
def strapdown(
    acc: cython.double[:, ::1], turn: cython.double[:, ::1], step_s: cython.double[::1],
    first: cython.Py_ssize_t, last: cython.Py_ssize_t, gravity: cython.double, x: cython.double[::1],
    phi: cython.double[:, ::1], m: cython.double[:, ::1], s: cython.double[::1],
) -> cython.double:  # fmt: skip
    """Carry ``x`` from sample ``first`` to ``last``; leave the transition (15 × 15) in ``phi``, return the time taken.

    ``turn`` and ``step_s`` of row i belong to the interval that ends there; the world acceleration is linear in it.
    ``m`` (3 × 3) and ``s`` (SCRATCH_SIZE) are scratch.
    """
    i: cython.Py_ssize_t
    r: cython.Py_ssize_t
    c: cython.Py_ssize_t
    for r in range(15):
        for c in range(15):
            phi[r, c] = 1.0 if r == c else 0.0
    total: cython.double = 0.0
    _matrix(x[6:10], m)
    _force(acc, first, x, m, s, 0)
    for i in range(first + 1, last + 1):
        dt: cython.double = step_s[i]
        for r in range(3):
            for c in range(3):
                s[9 + 3 * r + c] = -0.5 * dt * m[r, c]
        _turn_right(x[6:10], turn[i, 0] - dt * x[13], turn[i, 1] - dt * x[14], turn[i, 2] - dt * x[15])
        _matrix(x[6:10], m)
        _force(acc, i, x, m, s, 3)
        for r in range(3):
            down: cython.double = gravity if r == 2 else 0.0
            s[6 + r] = 0.5 * (s[r] + s[3 + r])
            x[r] += dt * x[3 + r] + dt * dt * ((2.0 * s[r] + s[3 + r]) / 6.0 - 0.5 * down)
            x[3 + r] += dt * (s[6 + r] - down)
        _gather(phi, m, dt, s)
        for r in range(3):
            s[r] = s[3 + r]
        total += dt
    return total


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _add_noise(
    out: cython.double[:, ::1],
    phi: cython.double[:, ::1],
    dt: cython.double,
    noise: cython.double[::1],
    looser: cython.double[::1],
) -> cython.void:
    r: cython.Py_ssize_t
    c: cython.Py_ssize_t
    k: cython.Py_ssize_t
    qa: cython.double = noise[0] * noise[0] * looser[0] * looser[0]
    qg: cython.double = noise[1] * noise[1] * looser[1] * looser[1]
    for r in range(3):
        out[r, r] += qa * dt * dt * dt / 3.0
        out[r, 3 + r] += qa * dt * dt / 2.0
        out[3 + r, r] += qa * dt * dt / 2.0
        out[3 + r, 3 + r] += qa * dt
        out[6 + r, 6 + r] += qg * dt
        out[9 + r, 9 + r] += noise[2] * noise[2] * dt
        out[12 + r, 12 + r] += noise[3] * noise[3] * dt
        for c in range(3):
            # a rate error arises evenly over the interval: velocity feels half of it on the mean, a third squared
            tilt: cython.double = 0.5 * qg * dt * phi[3 + r, 6 + c]
            out[3 + r, 6 + c] += tilt
            out[6 + c, 3 + r] += tilt
            both: cython.double = 0.0
            for k in range(3):
                both += phi[3 + r, 6 + k] * phi[3 + c, 6 + k]
            out[3 + r, 3 + c] += qg * dt * both / 3.0


@cython.ccall
def predict(
    p: cython.double[:, ::1], phi: cython.double[:, ::1], dt: cython.double, noise: cython.double[::1],
    looser: cython.double[::1], out: cython.double[:, ::1], work: cython.double[:, ::1],
) -> cython.void:  # fmt: skip
    """Put ``Φ P Φᵀ + Q`` in ``out``; ``noise`` holds the densities of acceleration (m/s/√s), rate (rad/√s) and the
    walks of both offsets; the first two are ``looser`` (2) times as much.
    """
    r: cython.Py_ssize_t
    c: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double
    for r in range(15):
        for c in range(15):
            total = p[r, c]  # the diagonal of Φ is one, and nothing else stands below it
            for k in range(r + 1 if r < 9 else 15, 15):
                if phi[r, k] != 0.0:
                    total += phi[r, k] * p[k, c]
            work[r, c] = total
    for r in range(15):
        for c in range(r + 1):
            total = work[r, c]
            for k in range(c + 1 if c < 9 else 15, 15):
                if phi[c, k] != 0.0:
                    total += work[r, k] * phi[c, k]
            out[r, c] = total
            out[c, r] = total
    _add_noise(out, phi, dt, noise, looser)


@cython.cfunc
@cython.exceptval(check=False)
def _update(
    x: cython.double[::1], p: cython.double[:, ::1], place: cython.Py_ssize_t, missed: cython.double[:],
    sigma: cython.double, gate: cython.double, d: cython.double[::1], work: cython.double[:, ::1],
    s: cython.double[::1],
) -> cython.double:  # fmt: skip
    """Correct with three readings of the error at ``place``; return the normalised innovation squared.

    Beyond ``gate`` the innovation's covariance is widened until it just passes: a doubtful reading pulls less, but
    a filter that went astray still comes back.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    a: cython.double = p[place, place] + sigma * sigma
    b: cython.double = p[place, place + 1]
    c: cython.double = p[place, place + 2]
    e: cython.double = p[place + 1, place + 1] + sigma * sigma
    f: cython.double = p[place + 1, place + 2]
    h: cython.double = p[place + 2, place + 2] + sigma * sigma
    det: cython.double = a * (e * h - f * f) - b * (b * h - c * f) + c * (b * f - c * e)
    s[0] = (e * h - f * f) / det
    s[1] = (c * f - b * h) / det
    s[2] = (b * f - c * e) / det
    s[3] = s[1]
    s[4] = (a * h - c * c) / det
    s[5] = (b * c - a * f) / det
    s[6] = s[2]
    s[7] = s[5]
    s[8] = (a * e - b * b) / det
    nis: cython.double = 0.0
    for i in range(3):
        for j in range(3):
            nis += missed[i] * s[3 * i + j] * missed[j]
    wide: cython.double = gate / nis if nis > gate else 1.0
    for i in range(15):
        for j in range(3):
            work[i, j] = wide * (p[i, place] * s[j] + p[i, place + 1] * s[3 + j] + p[i, place + 2] * s[6 + j])
        d[i] = work[i, 0] * missed[0] + work[i, 1] * missed[1] + work[i, 2] * missed[2]
    for i in range(15):
        for j in range(3):
            work[j, 3 + i] = p[place + j, i]
    for i in range(15):
        for j in range(i + 1):
            p[i, j] -= work[i, 0] * work[0, 3 + j] + work[i, 1] * work[1, 3 + j] + work[i, 2] * work[2, 3 + j]
            p[j, i] = p[i, j]
    _inject(x, d)
    return nis


@cython.cfunc
@cython.exceptval(check=False)
def _update_yaw(
    x: cython.double[::1],
    p: cython.double[:, ::1],
    yaw: cython.double,
    sigma: cython.double,
    d: cython.double[::1],
    k: cython.double[::1],
) -> cython.void:
    now: cython.double = atan2(2.0 * (x[6] * x[9] + x[7] * x[8]), 1.0 - 2.0 * (x[8] * x[8] + x[9] * x[9]))
    missed: cython.double = atan2(sin(yaw - now), cos(yaw - now))
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    s: cython.double = p[8, 8] + sigma * sigma
    for i in range(15):
        k[i] = p[i, 8]
        d[i] = k[i] / s * missed
    for i in range(15):
        for j in range(15):
            p[i, j] -= k[i] * k[j] / s
    _inject(x, d)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _copy(a: cython.double[::1], b: cython.double[::1]) -> cython.void:
    i: cython.Py_ssize_t
    for i in range(a.shape[0]):
        b[i] = a[i]


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _copy_square(a: cython.double[:, ::1], b: cython.double[:, ::1]) -> cython.void:
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    for i in range(15):
        for j in range(15):
            b[i, j] = a[i, j]


@cython.ccall
def forward(
    acc: cython.double[:, ::1], gyr: cython.double[:, ::1], turn: cython.double[:, ::1],
    step_s: cython.double[::1], nodes: cython.longlong[::1], still_sigma: cython.double[::1],
    rate_sigma: cython.double[::1], yaw: cython.double[::1], yaw_sigma: cython.double[::1],
    looser: cython.double[:, ::1], gravity: cython.double, noise: cython.double[::1], gate: cython.double,
    x: cython.double[::1], p: cython.double[:, ::1], predicted: cython.double[:, ::1],
    filtered: cython.double[:, ::1], p_predicted: cython.double[:, :, ::1],
    p_filtered: cython.double[:, :, ::1], phis: cython.double[:, :, ::1], nis: cython.double[::1],
    missed: cython.double[:, ::1], work: cython.double[:, ::1], m: cython.double[:, ::1], d: cython.double[::1],
    s: cython.double[::1],
) -> cython.void:  # fmt: skip
    """Run the filter over ``nodes`` (m,) rising rows; ``x`` (16) and ``p`` (15 × 15) hold the start and then the end.

    At a node with ``still_sigma`` > 0 velocity is zero within it, ``rate_sigma`` > 0: the gyro's reading ``gyr`` is its
    offset, ``yaw_sigma`` > 0: the heading is ``yaw``. ``nis`` and ``missed`` take what the zero velocity found.
    """
    n: cython.Py_ssize_t
    i: cython.Py_ssize_t
    dt: cython.double
    for n in range(nodes.shape[0]):
        if n > 0:
            dt = strapdown(acc, turn, step_s, nodes[n - 1], nodes[n], gravity, x, phis[n], m, s)
            predict(p, phis[n], dt, noise, looser[n], p_predicted[n], work)
        else:
            _copy_square(p, p_predicted[0])
        _copy(x, predicted[n])
        _copy_square(p_predicted[n], p)
        nis[n] = -1.0
        if still_sigma[n] > 0.0:
            for i in range(3):
                missed[n, i] = -x[3 + i]
            nis[n] = _update(x, p, 3, missed[n], still_sigma[n], gate, d, work, s)
        if rate_sigma[n] > 0.0:
            for i in range(3):
                m[0, i] = gyr[nodes[n], i] - x[13 + i]
            _update(x, p, 12, m[0], rate_sigma[n], 1e300, d, work, s)
        if yaw_sigma[n] > 0.0:
            _update_yaw(x, p, yaw[n], yaw_sigma[n], d, s)
        _copy(x, filtered[n])
        _copy_square(p, p_filtered[n])
