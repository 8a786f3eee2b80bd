"""Which new candidate is an old one found again: by time and place, each used once, the nearest first.

A wrong partner is worse than none: a rejection carried to another leak would hide it, a decision without a partner
is merely shown again. So the time must agree closely, and the place as well unless it is plainly the same sound.
"""

from bisect import bisect_left
from collections.abc import Sequence

from processing.survey import Candidate

SAME_SOUND_S = 1.0  # this close in time it is the same sound, however far new tie points have moved the track
NEAR_S = 5.0  # a peak moves by a few metres with the settings, at 0.5–1 m/s
NEAR_M = 3.0  # less than the shortest spacing of pipe joints (5 m), above the peak's own width


def partners(old: Sequence[Candidate], new: Sequence[Candidate]) -> dict[int, int]:
    """Return old id → new id for all old candidates that were found again; linear in their number but for crowds."""
    by_time = sorted(new, key=lambda candidate: candidate.time_s)
    times = [candidate.time_s for candidate in by_time]
    pairs: list[tuple[float, int, int]] = []
    for before in old:
        for i in range(bisect_left(times, before.time_s - NEAR_S), len(times)):
            if times[i] > before.time_s + NEAR_S:
                break
            if _may_be_same(before, by_time[i]):
                pairs.append((_distance(before, by_time[i]), before.id, by_time[i].id))
    found: dict[int, int] = {}
    taken: set[int] = set()
    for _, old_id, new_id in sorted(pairs):
        if old_id not in found and new_id not in taken:
            found[old_id] = new_id
            taken.add(new_id)
    return found


def _may_be_same(a: Candidate, b: Candidate) -> bool:
    if abs(a.time_s - b.time_s) <= SAME_SOUND_S:
        return True
    half_interval = max((c.chainage_high95_m - c.chainage_low95_m) / 2.0 for c in (a, b))
    # written so that an unknown place (NaN) is not near
    return abs(a.time_s - b.time_s) <= NEAR_S and abs(a.chainage_m - b.chainage_m) <= max(NEAR_M, half_interval)


def _distance(a: Candidate, b: Candidate) -> float:
    place = abs(a.chainage_m - b.chainage_m) / NEAR_M
    return abs(a.time_s - b.time_s) / SAME_SOUND_S + (place if place == place else 0.0)  # NaN: unknown
