"""Says what a spot is taken for: a leak, or a thing that sounds like one, by the evidence gathered on it."""

from collections.abc import Mapping

import numpy as np

from processing.sound.cells import band_log_power
from processing.sound.spots import Listening, Spot
from processing.survey import LeakClass

__all__ = ["class_of", "score_of", "standing"]

_BUMP_SHARE = 0.5
_BUMP_WIDTH_M = 0.2  # narrower than any leak is heard, even with the nose on it
_NO_LEAK_FACTOR = 0.3  # on the score of what is labelled as something else
_LIKELY = 0.5
_STAND_S = 2.0
_FADE_DB = 3.0


def standing(spot: Spot, listening: Listening) -> dict[str, str | float]:
    """Return how long the device stood at the spot and how much the sound changed meanwhile.

    A leak goes on while the device stands; what comes and goes then belongs to a moment, not to a place.
    """
    frames, scan = listening.frames, listening.scan
    still = (frames.speed_mps < listening.settings.min_speed_mps) & (np.asarray(scan.state) == 0)
    still &= np.abs(frames.chainage_m - spot.place) <= max(spot.width, 0.5)
    seconds = float(np.count_nonzero(still)) * scan.frame_s
    if seconds < _STAND_S:
        return {"stood_s": seconds}
    inside = np.sqrt(scan.bands_hz[:-1, 0] * scan.bands_hz[:-1, 1])
    wins = np.flatnonzero((inside >= spot.band_hz[0]) & (inside <= spot.band_hz[1]))
    power = np.exp([band_log_power(scan, int(b))[still] for b in wins]).sum(axis=0) if len(wins) else np.zeros(0)
    size = max(1, round(1.0 / scan.frame_s))
    seconds_db = 10 * np.log10([chunk.mean() for chunk in np.array_split(power, max(1, len(power) // size))])
    return {"stood_s": seconds, "faded_db": float(np.ptp(seconds_db))}


def class_of(spot: Spot, evidence: Mapping[str, str | float]) -> LeakClass:
    """Return what a spot is taken for, by the evidence gathered on it."""
    if float(evidence.get("impulsive_share", 0.0)) > _BUMP_SHARE or spot.width <= _BUMP_WIDTH_M:
        return LeakClass.BUMP
    if float(evidence.get("faded_db", 0.0)) > max(_FADE_DB, 0.5 * spot.level_db):
        return LeakClass.TRAFFIC
    return LeakClass.LEAK if spot.score >= _LIKELY else LeakClass.UNKNOWN


def score_of(spot: Spot, leak_class: LeakClass) -> float:
    """Return the probability that the spot is a leak: the detector's, less where it is labelled as something else."""
    return spot.score if leak_class in (LeakClass.LEAK, LeakClass.UNKNOWN) else _NO_LEAK_FACTOR * spot.score
