"""Fits the rise and fall of a passed leak, E(s) = A/(1+((s−s0)/w)²)+c, for its place, half-width and level."""

from dataclasses import dataclass

import numpy as np
from scipy import optimize

from processing.survey import FloatArray

INFLATION = 7.0  # the least-squares sigma is that much too small in truth (acoustics §5.1 step 11: 5 to 10)
_MIN_SIGMA_M = 0.05
_REACH_WIDTHS, _REACH_M = 3.0, 3.0
_MIN_WIDTH_M, _MAX_WIDTH_M = 0.15, 12.0
_ROOM_M, _ROOM_WIDTHS = 1.0, 0.75  # how far the apex may lie from where the peak was seen
_MIN_LEVEL = 0.175  # of the height: 0.7 dB


@dataclass(frozen=True)
class Apex:
    """The place ± ``sigma_m`` (1 sigma), half-width and height above the background (as a ratio of powers)."""

    chainage_m: float
    sigma_m: float
    width_m: float
    height: float

    @property
    def is_convincing(self) -> bool:
        """Whether the fit shows a rise and fall at all, neither flat nor without an end."""
        return self.height >= _MIN_LEVEL and self.width_m <= 0.95 * _MAX_WIDTH_M


def fit_apex(chainage_m: FloatArray, excess: FloatArray, near_m: float, width_m: float) -> Apex:
    """Return the apex near ``near_m`` of the linear ``excess`` (power over background, less 1) at ``chainage_m``.

    Where the fit fails or runs away, the place stays ``near_m`` with half a width as its sigma.
    """
    reach = max(_REACH_WIDTHS * width_m, _REACH_M)
    inside = np.abs(chainage_m - near_m) <= reach
    s, e = chainage_m[inside], excess[inside]
    height = float(np.max(e, initial=0.0))
    unfitted = Apex(near_m, max(width_m / 2, _MIN_SIGMA_M), width_m, max(height, 1e-6))
    # a peak may have been seen beyond the last place that was heard: there is nothing to fit around it
    if len(s) < 6 or height <= 0 or not s[0] <= near_m <= s[-1]:
        return unfitted
    floor = min(0.0, float(e.min()))
    width_m = min(max(width_m, _MIN_WIDTH_M), _MAX_WIDTH_M)
    start = (min(max(float(np.percentile(e, 95)), 1e-6), 2 * height), near_m, width_m, max(0.0, floor))
    room = min(max(_ROOM_M, _ROOM_WIDTHS * width_m), reach / 2)
    low = (0.0, max(near_m - room, float(s[0]) - 1e-6), _MIN_WIDTH_M, floor - 1.0)
    high = (10 * height + 1e-3, min(near_m + room, float(s[-1]) + 1e-6), _MAX_WIDTH_M, height + 1e-3)
    try:
        # noise of a power grows with the power: weigh the flanks as much as the top
        found, covariance = optimize.curve_fit(
            rise_and_fall, s, e, start, sigma=1.0 + np.maximum(e, 0.0), bounds=(low, high), max_nfev=200
        )
    except RuntimeError:  # no convergence is an answer too: the peak itself
        return unfitted
    variance = float(covariance[1, 1])
    sigma = INFLATION * np.sqrt(variance) if np.isfinite(variance) else width_m / 2
    sigma = float(np.clip(sigma, _MIN_SIGMA_M, reach / 2))
    return Apex(float(found[1]), sigma, float(found[2]), float(found[0]))


def rise_and_fall(s: FloatArray, height: float, place_m: float, width_m: float, floor: float) -> FloatArray:
    """Return A/(1+((s−s0)/w)²)+c."""
    return np.asarray(height / (1.0 + ((s - place_m) / width_m) ** 2) + floor, np.float64)
