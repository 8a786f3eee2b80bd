"""The recursions of the smoother: a Kalman filter over a chain of nodes, and its way back, compiled or plain.

Cython in pure-Python mode: one source for both. The chain has k nodes of d unknowns each,
``x[i+1] = F[i] x[i] + u[i] + w``, ``w ~ N(0, Q[i])``, ``x[0] ~ N(m, P)``; scalar measurements ``y = h·x + v``,
``v ~ N(0, r)``, stand in the order of their nodes, those of node i at ``first[i] … first[i+1] − 1``. The way back is
that of Bryson and Frazier in Bierman's form ("Fixed interval smoothing with discrete measurements", Int. J. Control
18, 1973): it inverts no covariance, so constants (no noise at all) and copies of an earlier node may be unknowns.
"""
# mypy: ignore-errors

import cython
from cython.cimports.libc.math import log

COMPILED: bool = cython.compiled


@cython.nogil
@cython.cfunc
@cython.exceptval(check=False)
def _turned(  # noqa: C901
    f: cython.double[:, ::1], p: cython.double[:, ::1], half: cython.double[:, ::1], out: cython.double[:, ::1]
) -> cython.void:
    """``out ← F P Fᵀ``; most of F is zero, which is skipped."""
    d: cython.Py_ssize_t = f.shape[0]
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    m: cython.Py_ssize_t
    value: cython.double
    for i in range(d):
        for j in range(d):
            half[i, j] = 0.0
        for m in range(d):
            value = f[i, m]
            if value != 0.0:
                for j in range(d):
                    half[i, j] += value * p[m, j]
    for i in range(d):
        for j in range(d):
            out[i, j] = 0.0
    for j in range(d):
        for m in range(d):
            value = f[j, m]
            if value != 0.0:
                for i in range(j + 1):
                    out[i, j] += value * half[i, m]
    for i in range(d):
        for j in range(i):
            out[i, j] = out[j, i]


@cython.nogil
@cython.cfunc
@cython.exceptval(check=False)
def _turned_back(
    f: cython.double[:, ::1], p: cython.double[:, ::1], half: cython.double[:, ::1], out: cython.double[:, ::1]
) -> cython.void:
    """``out ← Fᵀ P F``."""
    d: cython.Py_ssize_t = f.shape[0]
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    m: cython.Py_ssize_t
    value: cython.double
    for i in range(d):
        for j in range(d):
            half[i, j] = 0.0
            out[i, j] = 0.0
    for m in range(d):
        for i in range(d):
            value = f[m, i]
            if value != 0.0:
                for j in range(d):
                    half[i, j] += value * p[m, j]
    for m in range(d):
        for j in range(d):
            value = f[m, j]
            if value != 0.0:
                for i in range(d):
                    out[i, j] += half[i, m] * value


def forward(  # noqa: C901
    f: cython.double[:, :, ::1],
    u: cython.double[:, ::1],
    q: cython.double[:, :, ::1],
    first: cython.Py_ssize_t[::1],
    h: cython.double[:, ::1],
    y: cython.double[::1],
    r: cython.double[::1],
    mean: cython.double[:, ::1],
    cov: cython.double[:, :, ::1],
    gain: cython.double[:, ::1],
    innovation: cython.double[::1],
    spread: cython.double[::1],
    work: cython.double[:, :, ::1],
) -> cython.double:
    """Fill ``mean`` (k, d) and ``cov`` (k, d, d) with the predictions of all nodes; row 0 is given.

    ``gain`` (n, d), ``innovation`` (n,) and its variance ``spread`` (n,) are those of each measurement; ``work``
    (4, d, d) is room to work in. Returns the log-likelihood of the measurements, without its constant.
    """
    k: cython.Py_ssize_t = mean.shape[0]
    d: cython.Py_ssize_t = mean.shape[1]
    node: cython.Py_ssize_t
    n: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    total: cython.double = 0.0
    s: cython.double
    e: cython.double
    value: cython.double
    x: cython.double[:, ::1] = work[2]
    p: cython.double[:, ::1] = work[3]
    with cython.nogil:
        for node in range(k):
            for i in range(d):
                x[0, i] = mean[node, i]
                for j in range(d):
                    p[i, j] = cov[node, i, j]
            for n in range(first[node], first[node + 1]):
                s = r[n]
                e = y[n]
                for i in range(d):
                    gain[n, i] = 0.0
                for j in range(d):
                    value = h[n, j]
                    if value != 0.0:
                        e -= value * x[0, j]
                        for i in range(d):
                            gain[n, i] += p[i, j] * value
                for i in range(d):
                    s += h[n, i] * gain[n, i]
                for i in range(d):
                    gain[n, i] /= s
                for i in range(d):
                    x[0, i] += gain[n, i] * e
                    for j in range(d):
                        p[i, j] -= gain[n, i] * gain[n, j] * s
                innovation[n] = e
                spread[n] = s
                total -= 0.5 * (log(s) + e * e / s)
            if node + 1 < k:
                _turned(f[node], p, work[0], work[1])
                for i in range(d):
                    value = u[node, i]
                    for j in range(d):
                        cov[node + 1, i, j] = work[1, i, j] + q[node, i, j]
                        value += f[node, i, j] * x[0, j]
                    mean[node + 1, i] = value
    return total


def backward(  # noqa: C901
    f: cython.double[:, :, ::1],
    first: cython.Py_ssize_t[::1],
    h: cython.double[:, ::1],
    mean: cython.double[:, ::1],
    cov: cython.double[:, :, ::1],
    gain: cython.double[:, ::1],
    innovation: cython.double[::1],
    spread: cython.double[::1],
    wanted: cython.uchar[::1],
    smooth_mean: cython.double[:, ::1],
    smooth_cov: cython.double[:, :, ::1],
    pull: cython.double[::1],
    weight: cython.double[::1],
    link: cython.double[:, ::1],
    work: cython.double[:, :, ::1],
) -> None:
    """Fill ``smooth_mean`` (k, d), and ``smooth_cov`` (k, d, d) where ``wanted`` (k,), from what :func:`forward` left.

    With S the covariance of all measurements and z what they miss the prior by, ``pull`` (n,) is ``S⁻¹ z`` and
    ``weight`` (n,) the diagonal of ``S⁻¹`` (de Jong, "A cross-validation filter for time series models", Biometrika
    75, 1988): ``pull / weight`` is how far a measurement is missed that is left out, ``1 / weight`` the variance of
    that. ``gain[a] · link[b]`` is the element of ``S⁻¹`` for neighbours a = b − 1 at one node. ``work`` (5, d, d) is
    room to work in.
    """
    k: cython.Py_ssize_t = mean.shape[0]
    d: cython.Py_ssize_t = mean.shape[1]
    node: cython.Py_ssize_t
    n: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    m: cython.Py_ssize_t
    value: cython.double
    along: cython.double
    both: cython.double
    big: cython.double[:, ::1] = work[2]
    half: cython.double[:, ::1] = work[3]
    small: cython.double[:, ::1] = work[4]
    with cython.nogil:
        for i in range(d):
            small[0, i] = 0.0
            for j in range(d):
                big[i, j] = 0.0
        for node in range(k - 1, -1, -1):
            if node + 1 < k:
                _turned_back(f[node], big, work[0], work[1])
                for i in range(d):
                    value = 0.0
                    for j in range(d):
                        big[i, j] = 0.5 * (work[1, i, j] + work[1, j, i])
                        value += f[node, j, i] * small[0, j]
                    half[0, i] = value
                for i in range(d):
                    small[0, i] = half[0, i]
            for n in range(first[node + 1] - 1, first[node] - 1, -1):
                along = 0.0
                both = 0.0
                for i in range(d):
                    along += gain[n, i] * small[0, i]
                    value = 0.0
                    for j in range(d):
                        value += big[i, j] * gain[n, j]
                    half[0, i] = value
                for i in range(d):
                    both += gain[n, i] * half[0, i]
                pull[n] = along + innovation[n] / spread[n]
                weight[n] = both + 1.0 / spread[n]
                for i in range(d):
                    link[n, i] = half[0, i] - h[n, i] * weight[n]
                for i in range(d):
                    small[0, i] -= h[n, i] * pull[n]
                    for j in range(d):
                        big[i, j] += h[n, i] * h[n, j] * weight[n]
                        big[i, j] -= h[n, i] * half[0, j] + half[0, i] * h[n, j]
            for i in range(d):
                value = mean[node, i]
                for j in range(d):
                    value -= cov[node, i, j] * small[0, j]
                smooth_mean[node, i] = value
            if wanted[node]:
                for i in range(d):
                    for j in range(d):
                        half[i, j] = 0.0
                    for m in range(d):
                        value = cov[node, i, m]
                        if value != 0.0:
                            for j in range(d):
                                half[i, j] += value * big[m, j]
                for i in range(d):
                    for j in range(i + 1):
                        value = cov[node, i, j]
                        for m in range(d):
                            value -= half[i, m] * cov[node, m, j]
                        smooth_cov[node, i, j] = value
                        smooth_cov[node, j, i] = value
