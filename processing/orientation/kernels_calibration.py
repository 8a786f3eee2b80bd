"""Sums over bins of time of what a rolling ball tells of its gyro, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import cos, sin, sqrt

COMPILED: bool = cython.compiled
# places in a row of sums: number of rows, specific force (3), ∫ R ⊗ ω and ∫ R side by side (3 × 12), ω ωᵀ/|ω| (9), R ω
ROW_SIZE: int = 52


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _turn(s: cython.double[::1], rx: cython.double, ry: cython.double, rz: cython.double) -> cython.void:
    """``q ← q ⊗ exp(r)``, kept of unit length."""
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
    w: cython.double = q0 * c - q1 * x - q2 * y - q3 * z
    i: cython.double = q0 * x + q1 * c + q2 * z - q3 * y
    j: cython.double = q0 * y - q1 * z + q2 * c + q3 * x
    k: cython.double = q0 * z + q1 * y - q2 * x + q3 * c
    norm: cython.double = 1.0 / sqrt(w * w + i * i + j * j + k * k)
    s[0] = w * norm
    s[1] = i * norm
    s[2] = j * norm
    s[3] = k * norm


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _add_axis(
    sums: cython.double[:, ::1],
    p: cython.Py_ssize_t,
    axis: cython.Py_ssize_t,
    rx: cython.double,
    ry: cython.double,
    rz: cython.double,
    tx: cython.double,
    ty: cython.double,
    tz: cython.double,
    dt: cython.double,
) -> cython.void:
    """Add one row of ``R ⊗ ω dt`` and ``R dt``: R's row (rx, ry, rz), turn (tx, ty, tz)."""
    at: cython.Py_ssize_t = 4 + 12 * axis
    sums[p, at] += rx * tx
    sums[p, at + 1] += rx * ty
    sums[p, at + 2] += rx * tz
    sums[p, at + 3] += ry * tx
    sums[p, at + 4] += ry * ty
    sums[p, at + 5] += ry * tz
    sums[p, at + 6] += rz * tx
    sums[p, at + 7] += rz * ty
    sums[p, at + 8] += rz * tz
    sums[p, at + 9] += rx * dt
    sums[p, at + 10] += ry * dt
    sums[p, at + 11] += rz * dt
    if dt > 0.0:
        sums[p, 49 + axis] += (rx * tx + ry * ty + rz * tz) / dt


def add_rolling(
    turn: cython.double[:, ::1],
    dt_s: cython.double[::1],
    acc: cython.double[:, ::1],
    place: cython.Py_ssize_t[::1],
    state: cython.double[::1],
    sums: cython.double[:, ::1],
) -> None:
    """Add rows to ``sums`` (k, ROW_SIZE), row i to the bin ``place[i]``.

    ``turn`` (n, 3), ``dt_s`` (n,) and ``acc`` (n, 3) are those of :class:`processing.orientation.samples.Block`;
    ``state`` is q (4,), which the turns carry on before each row is added. A row without duration has no rate.
    """
    n: cython.Py_ssize_t = turn.shape[0]
    k: cython.Py_ssize_t
    p: cython.Py_ssize_t
    with cython.nogil:
        for k in range(n):
            p = place[k]
            tx: cython.double = turn[k, 0]
            ty: cython.double = turn[k, 1]
            tz: cython.double = turn[k, 2]
            _turn(state, tx, ty, tz)
            w: cython.double = state[0]
            x: cython.double = state[1]
            y: cython.double = state[2]
            z: cython.double = state[3]
            xx: cython.double = 1.0 - 2.0 * (y * y + z * z)
            xy: cython.double = 2.0 * (x * y - w * z)
            xz: cython.double = 2.0 * (x * z + w * y)
            yx: cython.double = 2.0 * (x * y + w * z)
            yy: cython.double = 1.0 - 2.0 * (x * x + z * z)
            yz: cython.double = 2.0 * (y * z - w * x)
            zx: cython.double = 2.0 * (x * z - w * y)
            zy: cython.double = 2.0 * (y * z + w * x)
            zz: cython.double = 1.0 - 2.0 * (x * x + y * y)
            sums[p, 0] += 1.0
            sums[p, 1] += xx * acc[k, 0] + xy * acc[k, 1] + xz * acc[k, 2]
            sums[p, 2] += yx * acc[k, 0] + yy * acc[k, 1] + yz * acc[k, 2]
            sums[p, 3] += zx * acc[k, 0] + zy * acc[k, 1] + zz * acc[k, 2]
            _add_axis(sums, p, 0, xx, xy, xz, tx, ty, tz, dt_s[k])
            _add_axis(sums, p, 1, yx, yy, yz, tx, ty, tz, dt_s[k])
            _add_axis(sums, p, 2, zx, zy, zz, tx, ty, tz, dt_s[k])
            angle: cython.double = sqrt(tx * tx + ty * ty + tz * tz)
            if angle > 0.0:
                sums[p, 40] += tx * tx / angle
                sums[p, 41] += tx * ty / angle
                sums[p, 42] += tx * tz / angle
                sums[p, 43] += tx * ty / angle
                sums[p, 44] += ty * ty / angle
                sums[p, 45] += ty * tz / angle
                sums[p, 46] += tx * tz / angle
                sums[p, 47] += ty * tz / angle
                sums[p, 48] += tz * tz / angle


def accelerometer_design(
    acc: cython.const[cython.double][:, ::1],
    rate: cython.const[cython.double][:, ::1],
    slope: cython.const[cython.double][:, ::1],
    quat: cython.const[cython.double][:, ::1],
    up: cython.const[cython.double][::1],
    gravity: cython.double,
    out: cython.double[:, :, ::1],
) -> None:
    """Put what the accelerometer's errors make of each row, and the row itself, into ``out`` (n, 3, 17).

    All in the frame that ``quat`` (n, 4) leads to, where ``up`` (3,) is constant. Columns: scale and misalignment (9,
    row by row), offset (3), arm (3), rolling radius, and last the force ``acc`` (n, 3) less ``gravity`` along up.
    ``rate`` ω and ``slope`` ω̇ (n, 3) are those of the sensor's frame.
    """
    n: cython.Py_ssize_t = acc.shape[0]
    k: cython.Py_ssize_t
    a: cython.Py_ssize_t
    with cython.nogil:
        for k in range(n):
            w: cython.double = quat[k, 0]
            x: cython.double = quat[k, 1]
            y: cython.double = quat[k, 2]
            z: cython.double = quat[k, 3]
            out[k, 0, 9] = 1.0 - 2.0 * (y * y + z * z)
            out[k, 0, 10] = 2.0 * (x * y - w * z)
            out[k, 0, 11] = 2.0 * (x * z + w * y)
            out[k, 1, 9] = 2.0 * (x * y + w * z)
            out[k, 1, 10] = 1.0 - 2.0 * (x * x + z * z)
            out[k, 1, 11] = 2.0 * (y * z - w * x)
            out[k, 2, 9] = 2.0 * (x * z - w * y)
            out[k, 2, 10] = 2.0 * (y * z + w * x)
            out[k, 2, 11] = 1.0 - 2.0 * (x * x + y * y)
            ux: cython.double = out[k, 0, 9] * up[0] + out[k, 1, 9] * up[1] + out[k, 2, 9] * up[2]
            uy: cython.double = out[k, 0, 10] * up[0] + out[k, 1, 10] * up[1] + out[k, 2, 10] * up[2]
            uz: cython.double = out[k, 0, 11] * up[0] + out[k, 1, 11] * up[1] + out[k, 2, 11] * up[2]
            px: cython.double = rate[k, 0]
            py: cython.double = rate[k, 1]
            pz: cython.double = rate[k, 2]
            sx: cython.double = slope[k, 0]
            sy: cython.double = slope[k, 1]
            sz: cython.double = slope[k, 2]
            # ω̇ × u
            tx: cython.double = sy * uz - sz * uy
            ty: cython.double = sz * ux - sx * uz
            tz: cython.double = sx * uy - sy * ux
            for a in range(3):
                rx: cython.double = out[k, a, 9]
                ry: cython.double = out[k, a, 10]
                rz: cython.double = out[k, a, 11]
                out[k, a, 0] = gravity * rx * ux
                out[k, a, 1] = gravity * rx * uy
                out[k, a, 2] = gravity * rx * uz
                out[k, a, 3] = gravity * ry * ux
                out[k, a, 4] = gravity * ry * uy
                out[k, a, 5] = gravity * ry * uz
                out[k, a, 6] = gravity * rz * ux
                out[k, a, 7] = gravity * rz * uy
                out[k, a, 8] = gravity * rz * uz
                # R ([ω̇]× + [ω]×²), column by column
                out[k, a, 12] = rx * (-py * py - pz * pz) + ry * (sz + px * py) + rz * (px * pz - sy)
                out[k, a, 13] = rx * (px * py - sz) + ry * (-px * px - pz * pz) + rz * (sx + py * pz)
                out[k, a, 14] = rx * (sy + px * pz) + ry * (py * pz - sx) + rz * (-px * px - py * py)
                out[k, a, 15] = rx * tx + ry * ty + rz * tz
                out[k, a, 16] = rx * acc[k, 0] + ry * acc[k, 1] + rz * acc[k, 2] - gravity * up[a]


def add_moments(
    acc: cython.const[cython.double][:, ::1],
    gyr: cython.const[cython.double][:, ::1],
    place: cython.const[cython.Py_ssize_t][::1],
    sums: cython.double[:, ::1],
) -> None:
    """Add rows (n, 3), (n, 3) to ``sums`` (k, 13), row i to the bin ``place[i]``.

    Columns: number of rows, acceleration (3) and rate (3), and the squares of these six.
    """
    k: cython.Py_ssize_t
    p: cython.Py_ssize_t
    a: cython.Py_ssize_t
    with cython.nogil:
        for k in range(acc.shape[0]):
            p = place[k]
            sums[p, 0] += 1.0
            for a in range(3):
                sums[p, 1 + a] += acc[k, a]
                sums[p, 4 + a] += gyr[k, a]
                sums[p, 7 + a] += acc[k, a] * acc[k, a]
                sums[p, 10 + a] += gyr[k, a] * gyr[k, a]
