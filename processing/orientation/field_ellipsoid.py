"""Hard and soft iron of the device: the sphere of Earth's field, as the device's own iron has displaced and bent it.

Turned to all sides in a field that stays the same, a magnetometer should draw a sphere. Iron that turns with the device
shifts it (hard iron, ``c``) and bends it to an ellipsoid (soft iron): ``‖A (m − c)‖ = 1`` with a symmetric ``A``, nine
unknowns. The quadric's linear solution begins, Levenberg–Marquardt with Huber's loss ends it (navigation §6.2).

What a run shows depends on the attitudes that it covers. A ball that rolls straight draws a ring about its spin axis:
the ring's centre across the axis is then all that can be told, for the share of the field along the axis and that of
the iron are one number. ``extent`` says ``sphere``, ``ring`` or ``none``; what is not seen is not corrected.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from processing.survey import FloatArray

_MOST_POINTS = 1000
_LEAST_POINTS = 100
_COVERAGE = 0.05  # the smallest eigenvalue of the directions' covariance; an even cover has 1/3
_RESIDUAL = 0.05
_CONDITION = 2.5
_LOSS = 0.02
_BETTER = 0.5
_REPEATS = 0.05  # of the field: the centres that the two halves of a run give must agree to that
_RING_RESIDUAL = 0.1


@dataclass(frozen=True)
class FieldEllipsoid:
    """True field = ``matrix`` (m − ``centre_ut``); ``matrix`` (3, 3) of determinant 1, so µT stay µT.

    ``coverage`` is the smallest eigenvalue of the covariance of the directions seen, ``residual`` the rms of
    ``|true| / norm − 1``, ``condition`` that of the matrix. For a ``ring`` the centre is right across ``axis`` only.
    """

    extent: str  # sphere | ring | none
    centre_ut: FloatArray
    matrix: FloatArray
    norm_ut: float
    coverage: float
    residual: float
    condition: float
    axis: FloatArray

    def corrected(self, mag_s_ut: FloatArray) -> FloatArray:
        """Return the field (m, 3) without the device's own."""
        return np.asarray((mag_s_ut - self.centre_ut) @ self.matrix.T, dtype=np.float64)


def fit_ellipsoid(mag_s_ut: FloatArray) -> FieldEllipsoid:
    """Return what readings (n, 3) in µT, in order of time, tell of the device's own field, if they do.

    ``sphere`` needs even cover, a residual under 5 %, a condition under 2.5, a field whose strength comes out twice as
    steady as it was, and two halves of the run that say the same: iron of the device stays, iron beside the way does
    not. ``ring`` needs a closed ring about another centre than zero, and the same agreement.
    """
    whole = _fit(mag_s_ut)
    if whole.extent == "none":
        return whole
    halves = [_fit(part) for part in np.array_split(mag_s_ut, 2)]
    across = np.eye(3) - np.outer(whole.axis, whole.axis)
    agree = all(
        half.extent == whole.extent
        and np.linalg.norm(across @ (half.centre_ut - whole.centre_ut)) < _REPEATS * whole.norm_ut
        for half in halves
    )
    return whole if agree else _nothing(whole.norm_ut, whole.coverage, whole.residual, whole.condition)


def _fit(mag_s_ut: FloatArray) -> FieldEllipsoid:
    mag = mag_s_ut[:: max(1, len(mag_s_ut) // _MOST_POINTS)]
    norm = float(np.median(np.linalg.norm(mag, axis=1))) if len(mag) else 0.0
    if len(mag) < _LEAST_POINTS or not norm > 0.0:
        return _nothing(norm)
    raw_scatter = _scatter(np.linalg.norm(mag, axis=1))
    found = _sphere(mag / norm, norm)
    if found is None or found.coverage <= _COVERAGE:
        return _ring(mag, norm, found.coverage if found is not None else 0.0)
    usable = found.residual < _RESIDUAL and found.condition < _CONDITION
    better = _scatter(np.linalg.norm(found.corrected(mag), axis=1)) < _BETTER * raw_scatter
    return found if usable and better else _nothing(norm, found.coverage, found.residual, found.condition)


def _nothing(norm: float, coverage: float = 0.0, residual: float = np.nan, condition: float = np.nan) -> FieldEllipsoid:
    return FieldEllipsoid("none", np.zeros(3), np.eye(3), norm, coverage, residual, condition, np.zeros(3))


def _scatter(values: FloatArray) -> float:
    """Return the robust relative scatter of positive values (n,)."""
    middle = float(np.median(values))
    return float(np.median(np.abs(values - middle))) / (0.6745 * middle) if middle > 0.0 else np.inf


def _sphere(unit: FloatArray, norm: float) -> FieldEllipsoid | None:
    """Return the ellipsoid through points (n, 3) of size about 1; None where no ellipsoid passes through them."""
    start = _quadric(unit)
    if start is None:
        return None
    upper = np.triu_indices(3)

    def matrix_of(x: FloatArray) -> FloatArray:
        matrix = np.zeros((3, 3))
        matrix[upper] = x[3:]
        return matrix + np.triu(matrix, 1).T

    def residuals(x: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.norm((unit - x[:3]) @ matrix_of(x), axis=1) - 1.0)

    solved = least_squares(residuals, start, loss="huber", f_scale=_LOSS, method="trf", max_nfev=100)
    centre, matrix = solved.x[:3], matrix_of(solved.x)
    sizes = np.abs(np.linalg.eigvalsh(matrix))
    if not np.all(np.isfinite(solved.x)) or sizes.min() <= 0.0:
        return None
    true = (unit - centre) @ matrix
    directions = true / np.linalg.norm(true, axis=1, keepdims=True)
    coverage = float(np.linalg.eigvalsh(np.cov(directions.T))[0])
    scale = float(np.prod(sizes) ** (1.0 / 3.0))
    return FieldEllipsoid(
        "sphere",
        centre * norm,
        matrix / scale,
        norm / scale,
        coverage,
        float(np.sqrt(np.mean(np.minimum(np.abs(solved.fun), 5.0 * _LOSS) ** 2))),
        float(sizes.max() / sizes.min()),
        np.zeros(3),
    )


def _quadric(unit: FloatArray) -> FloatArray | None:
    """Return centre and upper triangle of A (9,) by linear least squares of ``xᵀQx + 2pᵀx = 1``; None if no ellipsoid.

    Points that cover too little give a quadric of another kind; a sphere about their middle is the start then.
    """
    x, y, z = unit.T
    design = np.column_stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z, 2 * x, 2 * y, 2 * z])
    solution, _, rank, _ = np.linalg.lstsq(design, np.ones(len(unit)), rcond=None)
    a, b, c, d, e, f, *linear = solution
    quadric = np.array([[a, d, e], [d, b, f], [e, f, c]])
    if rank == 9 and np.linalg.eigvalsh(quadric)[0] > 0.0:
        centre = -np.linalg.solve(quadric, np.array(linear))
        values, vectors = np.linalg.eigh(quadric / (1.0 + centre @ quadric @ centre))
        if values[0] > 0.0:
            root = vectors @ np.diag(np.sqrt(values)) @ vectors.T
            return np.concatenate([centre, root[np.triu_indices(3)]])
    sphere, _, rank, _ = np.linalg.lstsq(np.column_stack([2.0 * unit, np.ones(len(unit))]), np.sum(unit**2, axis=1))
    radius = np.sqrt(max(float(sphere[3] + sphere[:3] @ sphere[:3]), 0.0))
    if rank < 4 or not 0.1 < radius < 10.0:
        return None
    return np.concatenate([sphere[:3], (np.eye(3) / radius)[np.triu_indices(3)]])


def _ring(mag: FloatArray, norm: float, coverage: float) -> FieldEllipsoid:
    """Return the centre of the ring that readings (n, 3) draw about the axis of least spread, if they draw one."""
    values, vectors = np.linalg.eigh(np.cov(mag.T))
    if values[1] < 0.15 * values[2] or values[0] > 0.2 * values[1]:
        return _nothing(norm, coverage)
    across = mag @ vectors[:, 1:]
    design = np.column_stack([2.0 * across, np.ones(len(across))])
    weight = np.ones(len(across))
    for _ in range(5):
        solution = np.linalg.lstsq(design * weight[:, None], np.sum(across**2, axis=1) * weight)[0]
        centre = solution[:2]
        radius = float(np.sqrt(max(solution[2] + centre @ centre, 0.0)))
        off = np.abs(np.linalg.norm(across - centre, axis=1) / max(radius, 1e-9) - 1.0)
        weight = np.sqrt(np.minimum(1.0, _LOSS / np.maximum(off, 1e-9)))
    residual = float(np.sqrt(np.mean(off**2)))
    angles = np.arctan2(*(across - centre).T)
    closed = float(np.max(np.diff(np.sort(angles), append=np.min(angles) + 2.0 * np.pi))) < np.radians(60.0)
    if not closed or residual > _RING_RESIDUAL or float(np.linalg.norm(centre)) < 0.02 * radius:
        return _nothing(norm, coverage, residual)
    middle = vectors[:, 1:] @ centre
    return FieldEllipsoid("ring", middle, np.eye(3), norm, coverage, residual, 1.0, vectors[:, 0])
