"""Two searches of the same run are asked, and their judged probabilities combined: what both hear counts most.

The search metre by metre and the search in layers err at different places: on forty simulated mains (seeds 0–39) the
combination found more at the same false alarms than either (recall at one a kilometre 0.60 and 0.68 alone, 0.70
together). Weights and offset were chosen there. What sounds narrower than any leak is heard is held against it.
"""

from dataclasses import replace

import numpy as np

from processing.settings import DetectorSettings
from processing.sound.spots import Spot
from processing.survey import LeakClass

Judged = tuple[Spot, LeakClass]

HEARD_AT_LEAST = 0.004  # the probability that one search gives to what only the other one hears
_LAYERS_SHARE = 0.7
_OFFSET = 0.7
_NEAR_M, _NEAR_WIDTHS, _WIDEST_M = 4.0, 1.5, 4.0
_APART_M = 5.0
_NARROW, _RATHER_NARROW = (1.0, -4.0), (1.4, -1.2)  # below so many least half-widths: natural log of the odds
_INFLATION = 1.75  # of the fit's sigma, so that 95 % of the places found lie within (seeds 0–39, −2 dB and more)
_LIKELY = 0.5


def agreed(by_metres: list[Judged], by_layers: list[Judged], settings: DetectorSettings) -> list[Judged]:
    """Return the spots of both searches, best first; one that both found lies where the search in metres puts it."""
    rest = list(by_layers)
    both: list[Judged] = []
    for spot, leak_class in sorted(by_metres, key=lambda judged: -judged[0].score):
        near = [other for other in rest if _is_same(spot, other[0])]
        partner = max(near, key=lambda judged: judged[0].score, default=None)
        if partner is not None:
            rest.remove(partner)
        both.append(_combined((spot, leak_class), partner, settings, in_metres=True))
    both += [_combined(judged, None, settings, in_metres=False) for judged in rest]
    both.sort(key=lambda judged: -judged[0].score)
    kept: list[Judged] = []
    for judged in both:
        if all(abs(judged[0].place - other.place) >= _APART_M for other, _ in kept):
            kept.append(judged)
    return kept[: int(settings.max_candidates)]


def combined_probability(by_metres: float, by_layers: float, half_width_m: float, least_m: float) -> float:
    """Return the probability (0..1) that two searches' probabilities and the half-width give together."""
    odds = (1.0 - _LAYERS_SHARE) * _log_odds(by_metres) + _LAYERS_SHARE * _log_odds(by_layers) + _OFFSET
    for widths, penalty in (_NARROW, _RATHER_NARROW):
        if half_width_m < widths * least_m:
            odds += penalty
            break
    return float(1.0 / (1.0 + np.exp(-odds)))


def _combined(judged: Judged, partner: Judged | None, settings: DetectorSettings, *, in_metres: bool) -> Judged:
    spot, leak_class = judged
    other = partner[0].score if partner is not None else HEARD_AT_LEAST
    metres, layers = (spot.score, other) if in_metres else (other, spot.score)
    score = combined_probability(metres, layers, spot.width, settings.narrowest_m)
    if leak_class in (LeakClass.LEAK, LeakClass.UNKNOWN):
        leak_class = LeakClass.LEAK if score >= _LIKELY else LeakClass.UNKNOWN
    elif score >= _LIKELY:
        leak_class = LeakClass.LEAK
    evidence = {**spot.evidence, "method": "agreed", "metres_score": metres, "layers_score": layers}
    return replace(spot, score=score, sigma=_INFLATION * spot.sigma, evidence=evidence), leak_class


def _is_same(a: Spot, b: Spot) -> bool:
    reach = max(_NEAR_M, _NEAR_WIDTHS * min(a.width, b.width, _WIDEST_M))
    return abs(a.place - b.place) < reach


def _log_odds(probability: float) -> float:
    p = min(max(probability, HEARD_AT_LEAST), 1.0 - 1e-4)
    return float(np.log(p / (1.0 - p)))
