"""Whether recognised bends agree with launch, odometer and ties: a map that is shifted or stretched fits itself too.

The offset of map from odometer is a Gaussian process: a start of the map that is off, a scale, the slip's random walk,
what gaps and slides lost, and each fix's own error. So the start that the bends imply, and the chainage that they imply
at a tie point, have a mean and a sigma in closed form (Rasmussen & Williams 2006, eq. 2.23–2.24).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from processing.survey import FloatArray

_MOST_SIGMAS = 3.5


@dataclass(frozen=True)
class Known:
    """Chainage ``place_m`` ± ``sigma_m`` (1 sigma) where the odometer told ``odometer_m``, each (n,).

    ``lost_m2`` (n,) is the cumulated variance of what the odometer lost till there.
    """

    odometer_m: FloatArray
    place_m: FloatArray
    sigma_m: FloatArray
    lost_m2: FloatArray


@dataclass(frozen=True)
class Doubt:
    """1-sigma of the odometer's scale, of the map's start, and of the slip's walk (m/√m)."""

    scale: float
    start_m: float
    walk: float


def start_off(bends: Known, doubt: Doubt) -> tuple[float, bool]:
    """Return where the bends put the launch on the map (0 where all is well), and whether that is surely wrong."""
    inverse = np.linalg.inv(_covariance(bends, bends, doubt, start_m=0.0) + np.diag(bends.sigma_m**2))
    information = float(inverse.sum())
    off = float(inverse.sum(axis=0) @ (bends.place_m - bends.odometer_m)) / information
    sigma = float(np.sqrt(1.0 / information + doubt.start_m**2))
    return off, abs(off) > _MOST_SIGMAS * sigma


def denied_by(bends: Known, ties: Known, doubt: Doubt) -> Sequence[bool]:
    """Return for each tie whether it contradicts what the bends, without any tie, make of its place."""
    own = _covariance(bends, bends, doubt, doubt.start_m) + np.diag(bends.sigma_m**2)
    cross = _covariance(ties, bends, doubt, doubt.start_m)
    gain = np.linalg.solve(own, cross.T).T
    miss = ties.place_m - ties.odometer_m - gain @ (bends.place_m - bends.odometer_m)
    variance = np.diag(_covariance(ties, ties, doubt, doubt.start_m) - gain @ cross.T) + ties.sigma_m**2
    return [bool(m**2 > _MOST_SIGMAS**2 * v) for m, v in zip(miss, variance, strict=True)]


def _covariance(a: Known, b: Known, doubt: Doubt, start_m: float) -> FloatArray:
    walk = np.minimum(a.odometer_m[:, None], b.odometer_m) * doubt.walk**2
    lost = np.minimum(a.lost_m2[:, None], b.lost_m2)
    return np.asarray(start_m**2 + doubt.scale**2 * np.outer(a.odometer_m, b.odometer_m) + walk + lost)
