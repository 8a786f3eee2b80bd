"""Scale of the gyro along a rolling ball's spin axis, from the gravity that turns with it (navigation §4.4).

In the frame that the gyro alone carries along, gravity should stand still. A scale error ``s`` lets it creep about the
spin axis by ``−s`` times the angle turned: hundreds of revolutions make a tenth of a per cent plain, and spin times
scale error times the tilt of the axis would be a false yaw rate of hundreds of degrees an hour.

One-second bins average gravity, and with it noise and the lever arm's centripetal part; the creep is summed over pieces
of at most half a minute in which the ball turns steadily. Three scales and three left-over offsets are fitted to the
pieces by least squares with priors (1 %, and the rest calibration's sigma); a spin axis that stays fixed in the ball
shows one combination of the scales only, and the prior settles the others.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.orientation.calibration import Calibration
from processing.orientation.samples import Block, TrustedSamples
from processing.progress import Progress
from processing.survey import BoolArray, FloatArray

_BIN_S = 1.0
_PIECE_BINS = 30
_LEAST_BINS = 6
_LEAST_SPIN_RADPS = np.radians(60.0)
_STEADY = 0.9  # |mean rate vector| over mean rate: the axis holds its direction within the bin
_LEAST_TURNS = 20.0
_SCALE_PRIOR = 0.01
_PHASE_SIGMA_RAD = np.radians(2.0)  # of gravity averaged over one second, twice: the ball's own acceleration
_USEFUL_SIGMA = 0.002
_LARGEST = 0.05  # a larger "scale" is a saturated gyro or a wrong unit, not an error of scale


@dataclass(frozen=True)
class _Bins:
    """Sums per second (m, …): specific force and turn in the gyro's own frame, the spin's shares of the axes."""

    samples: FloatArray
    gravity: FloatArray  # (m, 3)
    turn: FloatArray  # (m, 3)
    angle: FloatArray  # (m,)
    scale_share: FloatArray  # (m, 3) turn_i²/|turn|: how much of the spin a scale error of axis i adds
    offset_share: FloatArray  # (m, 3) dt·turn_i/|turn|: how much spin an offset of axis i adds


def calibrate_scale(samples: TrustedSamples, progress: Progress) -> Calibration:
    """Return the calibration with ``gyr_scale`` set, unchanged where the run does not tell it to ± 0.2 %."""
    equations = [_pieces(_bin(samples, segment, progress)) for segment in samples.segments]
    creep = np.concatenate([e[0] for e in equations])
    shares = np.concatenate([e[1] for e in equations])
    spun = shares[:, :3].sum(axis=0)
    if spun.sum() < _LEAST_TURNS * 2.0 * np.pi:
        return samples.calibration
    middle = samples.times(samples.count // 2, samples.count // 2 + 1)
    offset_sigma = np.maximum(samples.calibration.sigma_at(middle)[0], np.radians(0.01))
    solution, covariance = _fit(creep, shares, np.concatenate([np.full(3, _SCALE_PRIOR), offset_sigma]))
    along = spun / spun.sum()  # the combination of scales that the spin shows
    sigma = float(np.sqrt(along @ covariance[:3, :3] @ along))
    scale = solution[:3]
    if sigma > _USEFUL_SIGMA or np.max(np.abs(scale)) > _LARGEST or abs(float(along @ scale)) < 3.0 * sigma:
        return samples.calibration
    return replace(samples.calibration, gyr_scale=1.0 + scale, gyr_scale_sigma=np.sqrt(np.diag(covariance)[:3]))


def _bin(samples: TrustedSamples, segment: tuple[int, int], progress: Progress) -> _Bins:
    start = float(samples.times(segment[0], segment[0] + 1)[0])
    end = float(samples.times(segment[1] - 1, segment[1])[0])
    sums = np.zeros((int((end - start) / _BIN_S) + 1, 14))
    q = np.array(qt.IDENTITY)
    for block in samples.blocks(segment):
        index = ((block.time_s - start) / _BIN_S).astype(np.intp)
        edges = np.flatnonzero(np.diff(index, prepend=-1))
        sums[index[edges]] += np.add.reduceat(_row_terms(block, q), edges)
        progress.update(block.stop / samples.count, "orientation_calibration")
    return _Bins(sums[:, 0], sums[:, 1:4], sums[:, 4:7], sums[:, 7], sums[:, 8:11], sums[:, 11:14])


def _row_terms(block: Block, q: FloatArray) -> FloatArray:
    """Return what each row adds to its bin (m, 14); ``q`` (4,) is moved on to the block's last row."""
    quat = np.empty((len(block.turn), 4))
    kernels.integrate(block.turn, q, quat)
    angle = np.linalg.norm(block.turn, axis=1)
    share = block.turn / np.where(angle > 0.0, angle, 1.0)[:, None]
    return np.hstack(
        [
            np.ones((len(quat), 1)),
            qt.rotate(quat, block.acc_g),
            qt.rotate(quat, block.turn),
            angle[:, None],
            share * block.turn,
            share * block.dt_s[:, None],
        ]
    )


def _pieces(bins: _Bins) -> tuple[FloatArray, FloatArray]:
    """Return each piece's creep of gravity about the spin axis (p,) and the shares (p, 6) that explain it."""
    good = _spins_steadily(bins)
    axis = bins.turn / np.where(bins.angle > 0.0, bins.angle, 1.0)[:, None]
    axis = axis[:-1] + axis[1:]
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-12)
    before, after = bins.gravity[:-1], bins.gravity[1:]
    along_before, along_after = (np.sum(axis * g, axis=1)[:, None] * axis for g in (before, after))
    before, after = before - along_before, after - along_after
    step = np.arctan2(np.sum(axis * np.cross(before, after), axis=1), np.sum(before * after, axis=1))
    share = np.hstack([bins.scale_share, bins.offset_share])
    share = 0.5 * (share[:-1] + share[1:])  # a bin's gravity stands for its middle
    steps = good[:-1] & good[1:]
    edges = np.flatnonzero(np.diff(steps.astype(np.int8), prepend=0, append=0))
    creep, shares = [], []
    for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        cuts = np.linspace(a, b, -(-(b - a) // _PIECE_BINS) + 1).astype(int).tolist()
        for low, high in pairwise(cuts):
            if high - low >= _LEAST_BINS:
                creep.append(step[low:high].sum())
                shares.append(share[low:high].sum(axis=0))
    return np.array(creep), np.array(shares).reshape(-1, 6)


def _spins_steadily(bins: _Bins) -> BoolArray:
    full = bins.samples >= 0.9 * np.median(bins.samples)
    spinning = bins.angle >= _LEAST_SPIN_RADPS * _BIN_S * 0.9
    steady = np.linalg.norm(bins.turn, axis=1) >= _STEADY * bins.angle
    upright = np.linalg.norm(bins.gravity, axis=1) >= 0.5 * bins.samples
    across = np.abs(np.sum(bins.turn * bins.gravity, axis=1)) <= 0.5 * bins.angle * bins.samples
    return np.asarray(full & spinning & steady & upright & across, dtype=np.bool_)


def _fit(creep: FloatArray, shares: FloatArray, prior: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return scales and offsets (6,) and their covariance: ``creep = −shares · x``, Huber-weighted, prior sigmas."""
    x = np.zeros(6)
    weight = np.ones(len(creep))
    covariance = np.diag(prior**2)
    for _ in range(10):
        design = -shares * (weight / _PHASE_SIGMA_RAD)[:, None]
        covariance = np.linalg.inv(design.T @ design + np.diag(1.0 / prior**2))
        x = covariance @ (design.T @ (creep * weight / _PHASE_SIGMA_RAD))
        residual = np.abs(creep + shares @ x) / _PHASE_SIGMA_RAD
        weight = np.sqrt(np.minimum(1.0, 1.5 / np.maximum(residual, 1.5)))
    spread = max(1.0, float(np.median(residual)) / 0.6745)  # pieces that scatter more than assumed say so
    return x, np.asarray(covariance * spread**2, dtype=np.float64)
