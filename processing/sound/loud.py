"""On a short run, a peak that is loud in the chosen band counts by itself, whatever the bands' statistics say of it.

A strong leak is a good part of a short run: it teaches the covariance of the bands that its own spectrum is common, and
so hides itself from the search in metres. The envelope against its background knows no bands and is not fooled.
"""

from dataclasses import replace

from processing.sound.envelope import find_by_envelope
from processing.sound.metres import find_in_metres
from processing.sound.spots import Listening, Spot

LOUD_DB = 6.0  # humps of flow and speed stay below it; the weakest leak that a technician calls loud does not
SURE = 0.5
APART_M = 5.0  # as both finders keep their own peaks apart


def find_in_metres_or_loud(listening: Listening) -> list[Spot]:
    """Return the spots of the search in metres, with the loud peaks of the envelope added or raised to its score."""
    spots = find_in_metres(listening)
    for peak in find_by_envelope(listening):
        if peak.level_db < LOUD_DB or peak.score < SURE:
            continue
        near = [i for i, spot in enumerate(spots) if abs(spot.place - peak.place) < APART_M]
        if not near:
            spots.append(peak)
            continue
        closest = min(near, key=lambda i: abs(spots[i].place - peak.place))
        known = spots[closest]
        if known.score < peak.score:
            evidence = {**known.evidence, "envelope_match": peak.evidence["match"]}
            spots[closest] = replace(known, score=peak.score, evidence=evidence)
    return sorted(spots, key=lambda spot: -spot.score)
