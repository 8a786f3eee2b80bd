"""Sums of a run's turns and specific forces between neighbouring nodes, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`. C. Forster, L. Carlone,
F. Dellaert, D. Scaramuzza, "On-manifold preintegration for real-time visual-inertial odometry", IEEE TRO 33 (2017),
with scale and misalignment of both sensors beside their offsets; perturbations stand on the left, in the node's frame,
so that sums of them are sums of vectors.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import cos, sin, sqrt

COMPILED: bool = cython.compiled
ROW_SIZE: int = 122
SCRATCH_SIZE: int = 28

# places in a row: q (4), duration, Δv (3), ∂turn/∂(b, M) (3 × 12), ∂Δv/∂(b, M) (3 × 12), ∂Δv/∂(a, S) (3 × 12),
# field (3) in the frame of the node, sum of turns in the sensor's own (3)
_V = cython.declare(cython.int, 5)
_G = cython.declare(cython.int, 8)
_GV = cython.declare(cython.int, 44)
_AV = cython.declare(cython.int, 80)
_MAG = cython.declare(cython.int, 116)
_RATE = cython.declare(cython.int, 119)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _matrix(q: cython.double[::1], m: cython.double[::1], at: cython.int) -> cython.void:
    w: cython.double = q[0]
    x: cython.double = q[1]
    y: cython.double = q[2]
    z: cython.double = q[3]
    m[at] = 1.0 - 2.0 * (y * y + z * z)
    m[at + 1] = 2.0 * (x * y - w * z)
    m[at + 2] = 2.0 * (x * z + w * y)
    m[at + 3] = 2.0 * (x * y + w * z)
    m[at + 4] = 1.0 - 2.0 * (x * x + z * z)
    m[at + 5] = 2.0 * (y * z - w * x)
    m[at + 6] = 2.0 * (x * z - w * y)
    m[at + 7] = 2.0 * (y * z + w * x)
    m[at + 8] = 1.0 - 2.0 * (x * x + y * y)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _turned(q: cython.double[::1], rx: cython.double, ry: cython.double, rz: cython.double) -> cython.void:
    """Turn q by a rotation vector from the right."""
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
    a: cython.double = q[0]
    b: cython.double = q[1]
    d: cython.double = q[2]
    e: cython.double = q[3]
    q[0] = a * c - b * x - d * y - e * z
    q[1] = a * x + b * c + d * z - e * y
    q[2] = a * y - b * z + d * c + e * x
    q[3] = a * z + b * y - d * x + e * c


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def _cross_rows(force: cython.double[::1], at: cython.int, half: cython.double, row: cython.double[::1]) -> cython.void:
    """Add ``half · (J × f)``, column by column, where J = ∂turn/∂(b, M) of the row so far."""
    j: cython.int
    fx: cython.double = half * force[at]
    fy: cython.double = half * force[at + 1]
    fz: cython.double = half * force[at + 2]
    for j in range(12):
        row[_GV + j] += row[_G + 12 + j] * fz - row[_G + 24 + j] * fy
        row[_GV + 12 + j] += row[_G + 24 + j] * fx - row[_G + j] * fz
        row[_GV + 24 + j] += row[_G + j] * fy - row[_G + 12 + j] * fx


@cython.ccall
@cython.nogil
@cython.exceptval(check=False)
def preintegrate(
    turn: cython.double[:, ::1],
    acc: cython.double[:, ::1],
    mag: cython.double[:, ::1],
    dt_s: cython.double[::1],
    nodes: cython.Py_ssize_t[::1],
    scratch: cython.double[::1],
    rows: cython.double[:, ::1],
) -> cython.void:
    """Fill ``rows`` (k, ROW_SIZE) with the sums from node to node, rows ``nodes`` (k + 1,) of the samples.

    ``turn`` (n, 3) leads from the row before to the row; ``acc`` (n, 3), ``mag`` (n, 3) or (0, 3), ``dt_s`` (n,).
    ``scratch`` (SCRATCH_SIZE,).
    """
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    a: cython.int
    b: cython.int
    c: cython.int
    h: cython.double
    with_field: cython.bint = mag.shape[0] > 0
    q: cython.double[::1] = scratch[0:4]
    for k in range(rows.shape[0]):
        row: cython.double[::1] = rows[k]
        for a in range(122):
            row[a] = 0.0
        q[0] = 1.0
        q[1] = q[2] = q[3] = 0.0
        _matrix(q, scratch, 4)
        for a in range(3):
            scratch[22 + a] = acc[nodes[k], a]
        for i in range(nodes[k] + 1, nodes[k + 1] + 1):
            h = 0.5 * dt_s[i]
            _cross_rows(scratch, 22, h, row)
            _turned(q, turn[i, 0], turn[i, 1], turn[i, 2])
            _matrix(q, scratch, 13)
            for a in range(3):
                scratch[25 + a] = (
                    scratch[13 + 3 * a] * acc[i, 0] + scratch[14 + 3 * a] * acc[i, 1] + scratch[15 + 3 * a] * acc[i, 2]
                )
                for b in range(3):
                    # the mean of both matrices carries what is in the sensor's frame
                    m: cython.double = 0.5 * (scratch[4 + 3 * a + b] + scratch[13 + 3 * a + b])
                    row[_G + 12 * a + b] -= m * dt_s[i]
                    row[_AV + 12 * a + b] -= m * dt_s[i]
                    for c in range(3):
                        row[_G + 12 * a + 3 + 3 * b + c] += m * turn[i, c]
                        row[_AV + 12 * a + 3 + 3 * b + c] += h * (
                            scratch[4 + 3 * a + b] * acc[i - 1, c] + scratch[13 + 3 * a + b] * acc[i, c]
                        )
            _cross_rows(scratch, 25, h, row)
            for a in range(3):
                row[_V + a] += h * (scratch[22 + a] + scratch[25 + a])
                scratch[22 + a] = scratch[25 + a]
                row[_RATE + a] += turn[i, a]
                if with_field:
                    row[_MAG + a] += dt_s[i] * (
                        scratch[13 + 3 * a] * mag[i, 0]
                        + scratch[14 + 3 * a] * mag[i, 1]
                        + scratch[15 + 3 * a] * mag[i, 2]
                    )
            for a in range(9):
                scratch[4 + a] = scratch[13 + a]
            row[4] += dt_s[i]
        for a in range(4):
            row[a] = q[a]
