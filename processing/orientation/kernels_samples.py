"""The readings of a block as the estimators want them, row by row, compiled where a compiler built it.

Cython in pure-Python mode, conventions as in :mod:`processing.orientation.kernels`. Readings are only read, so that
they may be pages of a file.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import sqrt

COMPILED: bool = cython.compiled


def correct_rates(
    time_s: cython.const[cython.double][::1],
    gyr: cython.const[cython.double][:, ::1],
    bias_time_s: cython.const[cython.double][::1],
    bias: cython.const[cython.double][:, ::1],
    matrix: cython.const[cython.double][:, ::1],
    out: cython.double[:, ::1],
) -> None:
    """Put ``matrix (gyr − bias(t))`` into ``out`` (n, 3): ``bias`` (k, 3) linear between its times (k,), held outside.

    ``time_s`` (n,) in any order; rows in order of time are quick.
    """
    n: cython.Py_ssize_t = gyr.shape[0]
    last: cython.Py_ssize_t = bias_time_s.shape[0] - 1
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = 0
    with cython.nogil:
        for k in range(n):
            t: cython.double = time_s[k]
            while at > 0 and t < bias_time_s[at]:
                at -= 1
            while at < last and t >= bias_time_s[at + 1]:
                at += 1
            x: cython.double = bias[at, 0]
            y: cython.double = bias[at, 1]
            z: cython.double = bias[at, 2]
            if at < last and t > bias_time_s[at]:
                share: cython.double = (t - bias_time_s[at]) / (bias_time_s[at + 1] - bias_time_s[at])
                x += share * (bias[at + 1, 0] - x)
                y += share * (bias[at + 1, 1] - y)
                z += share * (bias[at + 1, 2] - z)
            x = gyr[k, 0] - x
            y = gyr[k, 1] - y
            z = gyr[k, 2] - z
            out[k, 0] = matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z
            out[k, 1] = matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z
            out[k, 2] = matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z


def turns(
    rate: cython.const[cython.double][:, ::1],
    time_s: cython.const[cython.double][::1],
    of_interval: cython.bint,
    period_s: cython.double,
    bridge_s: cython.double,
    out: cython.double[:, ::1],
) -> None:
    """Put the turns since the row before into ``out`` (n, 3), but for the first; 0 over holes beyond ``bridge_s``.

    With ``of_interval`` a rate tells of its own period, and of the hole before it the rates on both sides; else rates
    are linear between rows, to second order: ``(ω₀+ω₁)Δt/2 + (ω₀×ω₁)Δt²/12``.
    """
    n: cython.Py_ssize_t = rate.shape[0]
    k: cython.Py_ssize_t
    with cython.nogil:
        for k in range(1, n):
            gap: cython.double = time_s[k] - time_s[k - 1]
            ax: cython.double = rate[k - 1, 0]
            ay: cython.double = rate[k - 1, 1]
            az: cython.double = rate[k - 1, 2]
            bx: cython.double = rate[k, 0]
            by: cython.double = rate[k, 1]
            bz: cython.double = rate[k, 2]
            if gap > bridge_s:
                out[k, 0] = out[k, 1] = out[k, 2] = 0.0
            elif of_interval:
                own: cython.double = gap
                if gap > 1.5 * period_s:
                    own = period_s
                half: cython.double = 0.5 * (gap - own)
                out[k, 0] = bx * own + (ax + bx) * half
                out[k, 1] = by * own + (ay + by) * half
                out[k, 2] = bz * own + (az + bz) * half
            else:
                middle: cython.double = 0.5 * gap
                square: cython.double = gap * gap / 12.0
                out[k, 0] = (ax + bx) * middle + (ay * bz - az * by) * square
                out[k, 1] = (ay + by) * middle + (az * bx - ax * bz) * square
                out[k, 2] = (az + bz) * middle + (ax * by - ay * bx) * square


@cython.cfunc
@cython.inline
@cython.nogil
@cython.exceptval(check=False)
def _slope(
    smooth: cython.const[cython.double][:, ::1],
    time_s: cython.const[cython.double][::1],
    k: cython.Py_ssize_t,
    axis: cython.Py_ssize_t,
) -> cython.double:
    """Return the derivative at row k: second order between unequal steps, first order at both ends."""
    last: cython.Py_ssize_t = smooth.shape[0] - 1
    if last < 1:
        return 0.0
    if k == 0:
        return (smooth[1, axis] - smooth[0, axis]) / (time_s[1] - time_s[0])
    if k == last:
        return (smooth[last, axis] - smooth[last - 1, axis]) / (time_s[last] - time_s[last - 1])
    before: cython.double = time_s[k] - time_s[k - 1]
    after: cython.double = time_s[k + 1] - time_s[k]
    rise: cython.double = (smooth[k + 1, axis] - smooth[k, axis]) / after
    return (rise * before + (smooth[k, axis] - smooth[k - 1, axis]) / before * after) / (before + after)


def slopes(
    smooth: cython.const[cython.double][:, ::1], time_s: cython.const[cython.double][::1], out: cython.double[:, ::1]
) -> None:
    """Put the derivatives (n, 3) of ``smooth`` (n, 3) over strictly increasing ``time_s`` (n,) into ``out``."""
    k: cython.Py_ssize_t
    with cython.nogil:
        for k in range(smooth.shape[0]):
            out[k, 0] = _slope(smooth, time_s, k, 0)
            out[k, 1] = _slope(smooth, time_s, k, 1)
            out[k, 2] = _slope(smooth, time_s, k, 2)


def correct_force(
    acc: cython.const[cython.double][:, ::1],
    rate: cython.const[cython.double][:, ::1],
    slope: cython.const[cython.double][:, ::1],
    bias: cython.const[cython.double][::1],
    arm: cython.const[cython.double][::1],
    matrix: cython.const[cython.double][:, ::1],
    out: cython.double[:, ::1],
) -> None:
    """Put ``matrix (acc − bias − ω̇ × l − ω × (ω × l))`` into ``out`` (n, 3): the force at the centre of the device.

    ``rate`` ω and ``slope`` ω̇ are (n, 3), or (0, 3) where the arm ``l`` (3,) is none.
    """
    n: cython.Py_ssize_t = acc.shape[0]
    k: cython.Py_ssize_t
    turning: cython.bint = slope.shape[0] > 0
    lx: cython.double = arm[0]
    ly: cython.double = arm[1]
    lz: cython.double = arm[2]
    with cython.nogil:
        for k in range(n):
            x: cython.double = acc[k, 0] - bias[0]
            y: cython.double = acc[k, 1] - bias[1]
            z: cython.double = acc[k, 2] - bias[2]
            if turning:
                wx: cython.double = rate[k, 0]
                wy: cython.double = rate[k, 1]
                wz: cython.double = rate[k, 2]
                vx: cython.double = wy * lz - wz * ly
                vy: cython.double = wz * lx - wx * lz
                vz: cython.double = wx * ly - wy * lx
                x -= slope[k, 1] * lz - slope[k, 2] * ly + wy * vz - wz * vy
                y -= slope[k, 2] * lx - slope[k, 0] * lz + wz * vx - wx * vz
                z -= slope[k, 0] * ly - slope[k, 1] * lx + wx * vy - wy * vx
            out[k, 0] = matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z
            out[k, 1] = matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z
            out[k, 2] = matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z


def gravity_weights(acc_g: cython.double[:, ::1], deviation_g: cython.double, out: cython.double[::1]) -> None:
    """Put ``1 / (1 + ((|a| − 1) / deviation)²)`` into ``out`` (n,)."""
    k: cython.Py_ssize_t
    with cython.nogil:
        for k in range(acc_g.shape[0]):
            square: cython.double = acc_g[k, 0] * acc_g[k, 0] + acc_g[k, 1] * acc_g[k, 1] + acc_g[k, 2] * acc_g[k, 2]
            off: cython.double = (sqrt(square) - 1.0) / deviation_g
            out[k] = 1.0 / (1.0 + off * off)
