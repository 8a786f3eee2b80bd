"""Why a candidate is taken for what it is: its figures beside the same figures at places where nothing was found.

The places lie evenly along the run, away from all candidates, and are measured in the candidate's own band and width:
what the panel draws is thus what a listener would compare, *this place* with *the rest of this pipe*.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from processing.sound.apex import rise_and_fall
from processing.sound.cells import DB_PER_LN, frames_of
from processing.sound.classes import ClassModel, judge
from processing.sound.ground import Ground, ground_of
from processing.sound.place_features import FEATURES, excess_spectrum_db, features_at, patch_at
from processing.survey import Candidate, FloatArray, LeakClass

if TYPE_CHECKING:
    from processing.results import Results

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
PLACES = 60
_LEAST_PLACES = 8
_OWN = ("width_m",)  # the width is the candidate's everywhere: there is nothing to compare
_APART_M, _APART_S, _APART_WIDTHS = 5.0, 10.0, 3.0
_RISE_REACH_WIDTHS, _RISE_REACH = 6.0, 8.0


@dataclass(frozen=True)
class ShownFeature:
    """One figure: ``value`` here, ``quantiles`` (5,) elsewhere (NaN where too few places tell), and what it says.

    ``below`` is the share of the other places with a smaller value; ``for_leak`` the weight of the evidence in nats,
    positive for a leak.
    """

    name: str
    value: float
    quantiles: tuple[float, float, float, float, float]
    below: float
    for_leak: float


@dataclass(frozen=True)
class CandidateEvidence:
    """All that the panel shows of one candidate; levels in dB over the local background."""

    probability: Mapping[LeakClass, float]
    features: tuple[ShownFeature, ...]  # what says most first
    places: int  # how many other places it was compared with
    band_hz: FloatArray  # (b,) middles of the bands
    excess_db: FloatArray  # (b,) of the candidate
    usual_db: FloatArray  # (2, b) between which 95 % of the surroundings lie
    away: FloatArray  # (c,) metres (or seconds) from the apex
    rise_db: FloatArray  # (c,) level in the candidate's band
    fit_away: FloatArray  # (k,)
    fit_db: FloatArray  # (k,)
    in_metres: bool


def ground_of_results(results: "Results") -> Ground | None:
    """Return the surroundings of a processed run; None where there is no sound. Takes seconds for a run of hours."""
    if results.scan is None:
        return None
    in_metres = results.track is not None and results.level_along is not None
    track = results.track if in_metres else None
    frames = frames_of(results.scan, results.clock, track, results.not_assessed, results.settings.detector)
    return ground_of(results.scan, frames, track, results.recording.imu, results.survey, in_metres=in_metres)


def evidence_of(
    candidate: Candidate, ground: Ground, others: Sequence[Candidate], model: ClassModel
) -> CandidateEvidence | None:
    """Return why ``candidate`` is taken for what it is; ``others`` are all candidates of the run.

    None where too little was heard around it. A place marked by hand is measured like any other, with even odds.
    """
    place, width = _place(candidate, ground)
    patch = patch_at(ground, place, width)
    if patch is None:
        return None
    figures = features_at(ground, place, width, candidate.band_hz)
    heard = candidate.evidence.get("heard_score", 0.5)
    stood = candidate.evidence.get("faded_share")
    given = figures | ({"faded_share": stood} if isinstance(stood, float) else {})
    judged = judge(float(heard), given, model)
    elsewhere = _elsewhere(ground, candidate, others, place, width)
    measured = [features_at(ground, at, width, candidate.band_hz) for at in elsewhere]
    shown = [
        _shown(name, value, [m[name] for m in measured] if name not in _OWN else [], judged.for_leak.get(name, 0.0))
        for name in FEATURES
        if np.isfinite(value := figures[name])
    ]
    hz = np.sqrt(ground.scan.bands_hz[:-1, 0] * ground.scan.bands_hz[:-1, 1])
    outside = np.abs(patch.cell_away) > 2 * width
    around = (patch.cell_log_power[outside] - patch.background)[:, :-1] * DB_PER_LN
    usual = np.quantile(around, (0.025, 0.975), axis=0) if len(around) else np.zeros((2, len(hz)))
    inside = (hz >= candidate.band_hz[0]) & (hz <= candidate.band_hz[1])
    inside = inside if inside.any() else np.ones(len(hz), np.bool_)
    power = np.exp(patch.cell_log_power[:, :-1][:, inside]).sum(axis=1)
    level = 10 * np.log10(power / np.exp(patch.background[:-1][inside]).sum())
    reach = max(_RISE_REACH_WIDTHS * width, _RISE_REACH)
    seen = np.abs(patch.cell_away) <= reach
    fit_away = np.linspace(-reach, reach, 161)
    height = float(np.expm1(max(candidate.level_db, 0.0) / DB_PER_LN)) if np.isfinite(candidate.level_db) else 0.0
    fitted = 1.0 + rise_and_fall(fit_away, height, 0.0, width, 0.0)
    return CandidateEvidence(
        probability=judged.probability,
        features=tuple(sorted(shown, key=lambda f: -abs(f.for_leak))),
        places=len(elsewhere),
        band_hz=np.asarray(hz, np.float64),
        excess_db=excess_spectrum_db(patch, width)[:-1],
        usual_db=np.asarray(usual, np.float64),
        away=patch.cell_away[seen],
        rise_db=np.asarray(level[seen], np.float64),
        fit_away=np.asarray(fit_away, np.float64),
        fit_db=np.asarray(10 * np.log10(fitted), np.float64),
        in_metres=ground.in_metres,
    )


def _place(candidate: Candidate, ground: Ground) -> tuple[float, float]:
    if ground.in_metres:
        return candidate.chainage_m, candidate.width_m if candidate.width_m > 0 else 1.0
    return candidate.time_s, 2.0


def _elsewhere(
    ground: Ground, candidate: Candidate, others: Sequence[Candidate], place: float, width: float
) -> list[float]:
    """Return places evenly along the run that are away from every candidate."""
    heard = np.flatnonzero(ground.moving)
    taken = np.array([_place(c, ground)[0] for c in others if c.id != candidate.id] + [place])
    apart = max(_APART_M if ground.in_metres else _APART_S, _APART_WIDTHS * width)
    free: list[float] = []
    wanted = 2 * PLACES
    for share in (np.arange(wanted) + 0.5) / wanted:
        at = float(ground.x[heard[int(share * len(heard))]])
        if np.min(np.abs(taken - at)) >= apart:
            free.append(at)
    return free[:: max(1, -(-len(free) // PLACES))]


def _shown(name: str, value: float, elsewhere: list[float], for_leak: float) -> ShownFeature:
    known = np.array([v for v in elsewhere if np.isfinite(v)])
    nan = float("nan")
    if len(known) < _LEAST_PLACES:
        return ShownFeature(name, value, (nan, nan, nan, nan, nan), nan, for_leak)
    five, quarter, half, three, last = (float(q) for q in np.quantile(known, QUANTILES))
    below = float(np.mean(known < value) + 0.5 * np.mean(known == value))
    return ShownFeature(name, value, (five, quarter, half, three, last), below, for_leak)
