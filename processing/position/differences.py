"""How far apart two moments of a track lie along the pipe, with the 95 % interval of that difference."""

import math
from dataclasses import dataclass

import numpy as np

from processing.position.distance import NORMAL_95
from processing.survey import Track


@dataclass(frozen=True)
class Difference:
    """From the earlier to the later of two moments; none of it is negative.

    ``half95_m`` is at most what the truth may be off by in 95 of 100 cases: see :func:`difference_between`.
    """

    seconds: float
    metres: float
    half95_m: float
    speed_mps: float  # mean; NaN where no time passed


def difference_between(track: Track, first_s: float, second_s: float) -> Difference:
    """Return how far apart the device was at two moments (survey seconds, in either order).

    A track keeps the interval of each place, not how the errors of two places go together. They are taken as
    independent: σ² = σ₁² + σ₂². The errors of a path that is pinned at known places and wanders between them never go
    against each other (the inverse of its covariance has no positive value off the diagonal, so its covariance has no
    negative one), hence this is an upper bound: near each other, both places are off by nearly the same.
    """
    start_s, end_s = min(first_s, second_s), max(first_s, second_s)
    at = np.array([start_s, end_s])
    metres = np.interp(at, track.time_s, track.chainage_m)
    sigma = np.interp(at, track.time_s, track.sigma_along_m)
    apart = float(metres[1] - metres[0])
    seconds = end_s - start_s
    half = 0.0 if seconds == 0.0 else NORMAL_95 * math.hypot(float(sigma[0]), float(sigma[1]))
    return Difference(seconds, apart, half, apart / seconds if seconds > 0.0 else math.nan)
