"""Makes a candidate of a place that the operator marks by hand."""

from typing import TYPE_CHECKING

import numpy as np

from processing.position.distance import places_at
from processing.survey import Candidate, LeakClass

if TYPE_CHECKING:
    from processing.results import Results

# From the loudest moment of a passing sound to the key: hearing that it is one (0.2 s and more for the simplest
# reaction to a sound, twice that where one has to tell sounds apart; R. J. Kosinski, "A literature review on reaction
# time") and the press of a glove.
REACTION_S = 0.5
REACTION_SIGMA_S = 0.5  # 1 sigma of that: people differ, and so do sounds


def candidate_at(results: "Results", time_s: float) -> Candidate:
    """Return a candidate at ``time_s`` with the interval of the path there, widened by a human's reaction.

    ``time_s`` is the moment heard: who marks while listening takes :data:`REACTION_S` off before (``Player.heard_s``).
    The interval is as wide for a mark that was set in silence: where on a rise and fall of the sound it belongs, the
    eye knows no better.

    Its score is NaN: nobody computed a probability. Without a path its place is NaN too.
    """
    band = (results.settings.sound.band_low_hz, results.settings.sound.band_high_hz)
    nan = float("nan")
    if results.track is None:
        return Candidate(0, time_s, nan, nan, nan, (nan, nan, nan), nan, nan, LeakClass.LEAK, band, nan)
    place = places_at(results.track, time_s)
    speed_mps = float(np.interp(time_s, results.track.time_s, results.track.speed_mps))
    reaction_m = REACTION_SIGMA_S * speed_mps
    half_m = 1.959964 * float(np.hypot(place.sigma_along_m[0], reaction_m))
    east, north, up = (float(x) for x in place.position_w_m[0])
    chainage_m = float(place.chainage_m[0])
    return Candidate(
        id=0,
        time_s=time_s,
        chainage_m=chainage_m,
        chainage_low95_m=max(chainage_m - half_m, 0.0),
        chainage_high95_m=chainage_m + half_m,
        position_w_m=(east, north, up),
        score=float("nan"),
        level_db=_level_above_background(results, chainage_m),
        leak_class=LeakClass.LEAK,
        band_hz=band,
        width_m=2.0 * max(reaction_m, 0.5),
        evidence={"manual": 1.0},
    )


def _level_above_background(results: "Results", chainage_m: float) -> float:
    along = results.level_along
    if along is None or len(along.chainage_m) == 0:
        return float("nan")
    above_db = np.asarray(along.level_db, dtype=np.float64) - np.asarray(along.background_db, dtype=np.float64)
    return float(np.interp(chainage_m, along.chainage_m, above_db))
