"""Scale and misalignment of a rolling ball's gyro, from the gravity that turns with it (navigation §4.4).

In the frame that the gyro alone carries along, gravity should stand still. An error ``ω_true = (I + S) ω`` lets it
creep; hundreds of revolutions make a tenth of a per cent plain, where spin times scale error times the tilt of the axis
would be a false yaw rate of hundreds of degrees an hour.

One-second bins average gravity ``g``, less the ball's own acceleration: it rolls, so that is ``r d(ω × up)/dt``, and
``r`` is found on the way. The small turns ``φ`` of ``g`` from bin to bin are summed over pieces of some minutes and
compared with what ``S`` (3 × 3) and left-over offsets ``o`` (3) would make of them, ``φ = −P(J S + K o)``, where
``J = ∫ R ⊗ ω dt``, ``K = ∫ R dt`` and ``P`` takes off the part along ``g``, which nobody sees. Summed, the noise of
``g`` does not grow while the creep does. Least squares with priors; a second pass with the first one's result works
where the creep is small and the sums are exact.

What is observable: of ``S`` the part ``uᵀ S u`` along every axis ``u`` about which the ball has turned. On a straight
way that is one axis of the sensor and one number; each bend lets the axis wander through the sensor, and more come to
light. What stays unseen is left to the prior, by which the scales of one chip are mostly alike; it is also what moves
the path least, for an error across the spin axis turns with the ball and averages out. ``gyr_matrix_sigma`` tells them
apart. A sensitivity of the gyro to gravity itself cannot be seen here: its steady part turns the ball about ``g``.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from processing.orientation import kernels_calibration
from processing.orientation import quaternions as qt
from processing.orientation.binning import BinSums
from processing.orientation.calibration import STANDARD_GRAVITY_MPS2, Calibration
from processing.orientation.samples import TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_FINE_S = 0.25
_FINE_BINS = 4  # to a bin of one second
_PIECE_BINS = 180
_LEAST_BINS = 10
_LEAST_TURNS = 20.0
_COMMON_SCALE, _OWN_SCALE, _MISALIGNMENT = 0.007, 0.004, 0.004  # 0.4 % median, 1 % largest: navigation §4.4; 0.25°
_OFFSET_SIGMA_RADPS = np.radians(0.02)  # an offset wanders by that within a run, however long the rest
_GRAVITY_SIGMA_RAD = np.radians(0.3)  # of specific force averaged over a second, at best
_CORRELATION_BINS = 10.0  # the ball's own acceleration lasts for seconds, so bins are no independent witnesses
_USEFUL_SIGMA = 0.002
_LARGEST = 0.05  # a larger "scale" is a saturated gyro or a wrong unit, not an error of scale
_COUNT, _FORCE, _JACOBIAN, _SPUN, _RATE = 0, slice(1, 4), slice(4, 40), slice(40, 49), slice(49, 52)
_TERMS = kernels_calibration.ROW_SIZE
_LARGEST_RADIUS_M = 0.5


@dataclass(frozen=True)
class _Equations:
    """Summed turns of gravity (r,) and what errors make of them (r, 12), each piece about its own mean."""

    creep: FloatArray
    design: FloatArray
    spun: FloatArray  # (9,) ∫ ω ωᵀ/|ω| dt, row by row: its trace is the angle turned


def calibrate_scale(samples: TrustedSamples, progress: Progress) -> Calibration:
    """Return the calibration with ``gyr_matrix`` set, unchanged where the run does not tell it to ± 0.2 %.

    The matrix replaces one that the calibration already has.
    """
    calibration = replace(samples.calibration, gyr_matrix=np.eye(3), gyr_matrix_sigma=np.full((3, 3), np.nan))
    matrix, offset = samples.calibration.gyr_matrix, np.zeros(3)
    prior = _prior(samples)
    covariance = prior
    for step in range(2):
        trial = replace(calibration, gyr_matrix=matrix, bias_radps=calibration.bias_radps + offset)
        found = _equations(replace(samples, calibration=trial), progress.part(0.5 * step, 0.5 * step + 0.5))
        turned = float(np.trace(found.spun.reshape(3, 3)))
        if turned < _LEAST_TURNS * 2.0 * np.pi or len(found.creep) == 0:  # so many holes that no bin is whole
            return calibration
        known = np.concatenate([(matrix - np.eye(3)).ravel(), -offset])
        solution, covariance = _fit(found, known, prior)
        matrix, offset = np.eye(3) + solution[:9].reshape(3, 3), -solution[9:]
    along = found.spun / turned  # the mean of uᵀ S u over the axes u of the spin
    sigma = float(np.sqrt(along @ covariance[:9, :9] @ along))
    off = float(along @ (matrix - np.eye(3)).ravel())
    if sigma > _USEFUL_SIGMA or np.max(np.abs(matrix - np.eye(3))) > _LARGEST or abs(off) < 3.0 * sigma:
        return calibration
    return replace(calibration, gyr_matrix=matrix, gyr_matrix_sigma=np.sqrt(np.diag(covariance)[:9]).reshape(3, 3))


def _prior(samples: TrustedSamples) -> FloatArray:
    """Return the covariance (12, 12) of errors and offsets before the run is looked at."""
    middle = samples.times(samples.count // 2, samples.count // 2 + 1)
    offset = np.hypot(samples.calibration.sigma_at(middle)[0], _OFFSET_SIGMA_RADPS)
    scale = np.eye(3).ravel()
    variance = np.where(scale > 0.0, _OWN_SCALE**2, _MISALIGNMENT**2)
    prior = np.diag(np.concatenate([variance, offset**2]))
    prior[:9, :9] += _COMMON_SCALE**2 * np.outer(scale, scale)
    return prior


def _equations(samples: TrustedSamples, progress: Progress) -> _Equations:
    binned = [_bin(samples, segment, progress) for segment in samples.segments]
    radius = _rolling_radius(binned)
    creep, design, spun = [np.zeros(0)], [np.zeros((0, 12))], np.zeros(9)
    for bins in binned:
        spun += bins[:, _SPUN].sum(axis=0)
        force = bins[:, _FORCE] - radius * _gained(bins)
        full = bins[:, _COUNT] >= 0.9 * np.median(bins[:, _COUNT])
        upright = np.linalg.norm(force, axis=1) >= 0.5 * bins[:, _COUNT]
        edges = np.flatnonzero(np.diff((full & upright).astype(np.int8), prepend=0, append=0))
        for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            for low, high in pairwise(np.linspace(a, b, -(-(b - a) // _PIECE_BINS) + 1).astype(int).tolist()):
                if high - low >= _LEAST_BINS:
                    piece_creep, piece_design = _piece(force[low:high], bins[low:high, _JACOBIAN])
                    creep.append(piece_creep)
                    design.append(piece_design)
    return _Equations(np.concatenate(creep), np.vstack(design), spun)


def _piece(force: FloatArray, integrals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a piece's summed turns of gravity (3m,) and the design (3m, 12), without their means."""
    g = force / np.linalg.norm(force, axis=1, keepdims=True)
    cross = np.cross(g[:-1], g[1:])
    sine = np.linalg.norm(cross, axis=1, keepdims=True)
    angle = np.arctan2(sine, np.sum(g[:-1] * g[1:], axis=1)[:, None])
    turn = cross * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 1.0)
    jacobian = integrals.reshape(-1, 3, 12)
    jacobian = 0.5 * (jacobian[:-1] + jacobian[1:])  # a bin's gravity stands for its middle
    middle = g[:-1] + g[1:]
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    across = jacobian - middle[:, :, None] * np.einsum("ki,kij->kj", middle, jacobian)[:, None, :]
    creep = np.vstack([np.zeros((1, 3)), np.cumsum(turn, axis=0)])
    design = np.concatenate([np.zeros((1, 3, 12)), np.cumsum(across, axis=0)])
    return (creep - creep.mean(axis=0)).ravel(), -(design - design.mean(axis=0)).reshape(-1, 12)


def _gained(bins: FloatArray) -> FloatArray:
    """Return the rows' sum (m, 3) of ``d(ω × up)/dt`` in g: times the radius, the ball's own acceleration in each bin.

    ``up`` is the mean specific force of some seconds, which own acceleration and creep hardly turn.
    """
    width = 15
    total = np.cumsum(np.vstack([np.zeros((1, 3)), bins[:, _FORCE]]), axis=0)
    first = np.maximum(np.arange(len(bins)) - width, 0)
    last = np.minimum(np.arange(len(bins)) + width + 1, len(bins))
    up = total[last] - total[first]
    up /= np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-9)
    change = bins[:, _RATE]  # rate at the end of the bin less that at its beginning
    return np.asarray(np.cross(change, up) * bins[:, :1] / STANDARD_GRAVITY_MPS2, dtype=np.float64)


def _rolling_radius(binned: list[FloatArray]) -> float:
    """Return the radius at which the ball's rolling explains the specific force best; 0 where that tells nothing."""
    product, square = 0.0, 0.0
    for bins in binned:
        gained = _gained(bins)
        change = np.diff(bins[:, _FORCE] / np.maximum(bins[:, :1], 1.0), axis=0)
        model = np.diff(gained / np.maximum(bins[:, :1], 1.0), axis=0)
        calm = np.linalg.norm(change, axis=1) < 0.3  # bumps and empty bins are no rolling
        product += float(np.sum(change[calm] * model[calm]))
        square += float(np.sum(model[calm] ** 2))
    radius = product / square if square > 0.0 else 0.0
    return radius if 0.0 < radius < _LARGEST_RADIUS_M else 0.0


def _bin(samples: TrustedSamples, segment: tuple[int, int], progress: Progress) -> FloatArray:
    """Return per second (m, 52): rows, specific force (3), J and K side by side (3 × 12), the spin's shares (9), and
    by how much the rate changed (3)."""
    start = float(samples.times(segment[0], segment[0] + 1)[0])
    sums = BinSums(start, _FINE_S, _TERMS, most_empty=_FINE_BINS)
    q = np.array(qt.IDENTITY)
    for block in samples.blocks(segment):
        place, found = sums.places(block.time_s)
        kernels_calibration.add_rolling(block.turn, block.dt_s, block.acc_g, place, q, found)
        progress.update(block.stop / samples.count, "orientation_calibration")
    fine = sums.result().sums
    fine = np.vstack([fine, np.zeros((-len(fine) % _FINE_BINS, _TERMS))])
    bins = fine.reshape(-1, _FINE_BINS, _TERMS).sum(axis=1)
    rate = fine[:, _RATE] / np.maximum(fine[:, :1], 1.0)
    edge = 0.5 * (rate[_FINE_BINS - 1 : -1 : _FINE_BINS] + rate[_FINE_BINS::_FINE_BINS])
    edge = np.vstack([rate[:1], edge, rate[-1:]])
    bins[:, _RATE] = np.diff(edge, axis=0) / (_FINE_S * _FINE_BINS)
    return np.asarray(bins, dtype=np.float64)


def _fit(found: _Equations, known: FloatArray, prior: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return errors and offsets (12,), counted from those of the calibration, and their covariance.

    ``known`` (12,) is what the turns are already corrected by. Huber-weighted; the sigma follows the residuals.
    """
    target = found.creep + found.design @ known
    weight, sigma = np.ones(len(target)), _GRAVITY_SIGMA_RAD * np.sqrt(_CORRELATION_BINS)
    for _ in range(8):
        design = found.design * (weight / sigma)[:, None]
        covariance = np.linalg.inv(design.T @ design + np.linalg.inv(prior))
        x = covariance @ (design.T @ (target * weight / sigma))
        residual = np.abs(target - found.design @ x)
        spread = max(_GRAVITY_SIGMA_RAD, float(np.median(residual)) / 0.6745)
        sigma = spread * np.sqrt(_CORRELATION_BINS)
        weight = np.sqrt(np.minimum(1.0, 1.5 * spread / np.maximum(residual, 1e-12)))
    return x, np.asarray(covariance, dtype=np.float64)
