"""Scale of the gyro along a rolling ball's spin axis, from the gravity that turns with it (navigation §4.4).

In the frame that the gyro alone carries along, gravity should stand still. A scale error ``s`` lets it creep about the
spin axis by ``−s`` times the angle turned: hundreds of revolutions make a tenth of a per cent plain, and spin times
scale error times the tilt of the axis would be a false yaw rate of hundreds of degrees an hour.

One-second bins average gravity ``g``; its small turns ``φ`` from bin to bin are summed over pieces of some minutes and
compared with what scales ``s`` (3) and left-over offsets ``o`` (3) would make of them, ``φ = −P(J s + K o)``, where
``J = ∫ R diag(ω) dt``, ``K = ∫ R dt`` and ``P`` takes off the part along ``g``, which nobody sees. Summed, the noise of
``g`` does not grow while the creep does. Least squares with priors; a second pass with the first one's result works
where the creep is small and the sums are exact. A spin axis that stays fixed in the ball shows one combination of the
scales only, and the prior, by which the three scales are mostly alike, settles the others.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.orientation.binning import BinSums
from processing.orientation.calibration import Calibration
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_BIN_S = 1.0
_PIECE_BINS = 180
_LEAST_BINS = 10
_LEAST_TURNS = 20.0
_SCALE_PRIOR = 0.007 * 0.007 * np.ones((3, 3)) + 0.004 * 0.004 * np.eye(3)  # 0.4 % median, 1 % largest: navigation §4.4
_OFFSET_SIGMA_RADPS = np.radians(0.02)  # an offset wanders by that within a run, however long the rest
_GRAVITY_SIGMA_RAD = np.radians(1.0)  # of specific force averaged over a second: the ball's own acceleration
_CORRELATION_BINS = 10.0  # that acceleration lasts for seconds, so bins are no independent witnesses
_USEFUL_SIGMA = 0.002
_LARGEST = 0.05  # a larger "scale" is a saturated gyro or a wrong unit, not an error of scale


@dataclass(frozen=True)
class _Equations:
    """Summed turns of gravity (r,) and what scales and offsets make of them (r, 6), each piece about its own mean."""

    creep: FloatArray
    design: FloatArray
    spun: FloatArray  # (3,) ∫ ω_i²/|ω| dt: the spin's shares of the axes


def calibrate_scale(samples: TrustedSamples, progress: Progress) -> Calibration:
    """Return the calibration with ``gyr_scale`` set, unchanged where the run does not tell it to ± 0.2 %."""
    calibration = samples.calibration
    scale, offset = np.ones(3), np.zeros(3)
    prior = _prior(samples)
    covariance = prior
    for step in range(2):
        trial = replace(calibration, gyr_scale=scale, bias_radps=calibration.bias_radps + offset)
        found = _equations(replace(samples, calibration=trial), progress.part(0.5 * step, 0.5 * step + 0.5))
        if found.spun.sum() < _LEAST_TURNS * 2.0 * np.pi:
            return calibration
        known = np.concatenate([scale - 1.0, -offset])
        solution, covariance = _fit(found, known, prior)
        scale, offset = 1.0 + solution[:3], -solution[3:]
    along = found.spun / found.spun.sum()  # the combination of scales that the spin shows
    sigma = float(np.sqrt(along @ covariance[:3, :3] @ along))
    off = float(along @ (scale - 1.0))
    if sigma > _USEFUL_SIGMA or np.max(np.abs(scale - 1.0)) > _LARGEST or abs(off) < 3.0 * sigma:
        return calibration
    return replace(calibration, gyr_scale=scale, gyr_scale_sigma=np.sqrt(np.diag(covariance)[:3]))


def _prior(samples: TrustedSamples) -> FloatArray:
    """Return the covariance (6, 6) of scales and offsets before the run is looked at."""
    middle = samples.times(samples.count // 2, samples.count // 2 + 1)
    offset = np.hypot(samples.calibration.sigma_at(middle)[0], _OFFSET_SIGMA_RADPS)
    prior = np.diag(np.concatenate([np.zeros(3), offset**2]))
    prior[:3, :3] = _SCALE_PRIOR
    return prior


def _equations(samples: TrustedSamples, progress: Progress) -> _Equations:
    creep, design, spun = [np.zeros(0)], [np.zeros((0, 6))], np.zeros(3)
    for segment in samples.segments:
        bins = _bin(samples, segment, progress)
        spun += bins[:, 22:25].sum(axis=0)
        full = bins[:, 0] >= 0.9 * np.median(bins[:, 0])
        upright = np.linalg.norm(bins[:, 1:4], axis=1) >= 0.5 * bins[:, 0]
        edges = np.flatnonzero(np.diff((full & upright).astype(np.int8), prepend=0, append=0))
        for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            for low, high in pairwise(np.linspace(a, b, -(-(b - a) // _PIECE_BINS) + 1).astype(int).tolist()):
                if high - low >= _LEAST_BINS:
                    piece_creep, piece_design = _piece(bins[low:high])
                    creep.append(piece_creep)
                    design.append(piece_design)
    return _Equations(np.concatenate(creep), np.vstack(design), spun)


def _piece(bins: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a piece's summed turns of gravity (3m,) and the design (3m, 6), without their means."""
    g = bins[:, 1:4] / np.linalg.norm(bins[:, 1:4], axis=1, keepdims=True)
    cross = np.cross(g[:-1], g[1:])
    sine = np.linalg.norm(cross, axis=1, keepdims=True)
    angle = np.arctan2(sine, np.sum(g[:-1] * g[1:], axis=1)[:, None])
    turn = cross * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 1.0)
    jacobian = bins[:, 4:22].reshape(-1, 3, 6)
    jacobian = 0.5 * (jacobian[:-1] + jacobian[1:])  # a bin's gravity stands for its middle
    middle = g[:-1] + g[1:]
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    across = jacobian - middle[:, :, None] * np.einsum("ki,kij->kj", middle, jacobian)[:, None, :]
    creep = np.vstack([np.zeros((1, 3)), np.cumsum(turn, axis=0)])
    design = np.concatenate([np.zeros((1, 3, 6)), np.cumsum(across, axis=0)])
    return (creep - creep.mean(axis=0)).ravel(), -(design - design.mean(axis=0)).reshape(-1, 6)


def _bin(samples: TrustedSamples, segment: tuple[int, int], progress: Progress) -> FloatArray:
    """Return per second (m, 25): rows, specific force (3), J and K side by side (3 × 6), the spin's shares (3)."""
    start = float(samples.times(segment[0], segment[0] + 1)[0])
    sums = BinSums(start, _BIN_S, 25, most_empty=1)
    q = np.array(qt.IDENTITY)
    for block in samples.blocks(segment):
        sums.add(block.time_s, _row_terms(block, q))
        progress.update(block.stop / samples.count, "orientation_calibration")
    return sums.result().sums


def _row_terms(block: Block, q: FloatArray) -> FloatArray:
    """Return what each row adds to its bin (m, 25); ``q`` (4,) is moved on to the block's last row."""
    quat = np.empty((len(block.turn), 4))
    kernels.integrate(block.turn, q, quat)
    terms = np.empty((len(quat), 25))
    terms[:, 0] = 1.0
    terms[:, 1:4] = qt.rotate(quat, block.acc_g)
    matrix = qt.to_matrix(quat)
    jacobian = terms[:, 4:22].reshape(-1, 3, 6)
    jacobian[:, :, :3] = matrix * block.turn[:, None, :]
    jacobian[:, :, 3:] = matrix * block.dt_s[:, None, None]
    angle = np.linalg.norm(block.turn, axis=1, keepdims=True)
    terms[:, 4:22] = jacobian.reshape(-1, 18)
    terms[:, 22:25] = block.turn**2 / np.where(angle > 0.0, angle, 1.0)
    return terms


def _fit(found: _Equations, known: FloatArray, prior: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return scales and offsets (6,), counted from those of the calibration, and their covariance.

    ``known`` (6,) is what the turns are already corrected by. Huber-weighted; the sigma follows the residuals.
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
