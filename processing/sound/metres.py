"""The detector in metres: what rises and falls like a passed leak along the pipe, in any of many bands (``metres``)."""

import numpy as np

from processing.sound.apex import fit_apex
from processing.sound.cells import DB_PER_LN, Cells, excess_of
from processing.sound.matching import Matched, confidence, matched, peaks_apart
from processing.sound.spots import UNCONVINCING, Listening, Spot
from processing.survey import FloatArray

_APART_M, _APART_WIDTHS = 5.0, 1.5


def find_in_metres(listening: Listening) -> list[Spot]:
    """Return the spots, best first; acoustics §5.1, steps 3 to 11."""
    cells, settings = listening.cells, listening.settings
    if cells is None:
        raise ValueError("the detector in metres needs a path")
    bands_hz = listening.scan.bands_hz[:-1]
    excess = excess_of(cells, settings.background_m)[:, :-1]
    result = matched(excess, bands_hz, cells.heard)
    probability = confidence(result.score)
    apart = np.maximum(_APART_M, _APART_WIDTHS * result.width_m)
    taken = peaks_apart(result.score, cells.chainage_m, apart, int(settings.max_candidates))
    return [
        _spot(int(cell), cells, excess, result, float(probability[cell]), bands_hz)
        for cell in taken
        if probability[cell] >= settings.min_score
    ]


def _spot(
    cell: int, cells: Cells, excess: FloatArray, result: Matched, probability: float, bands_hz: FloatArray
) -> Spot:
    spectrum = result.spectra[:, result.spectrum[cell]]
    wins = spectrum >= 0.5 * spectrum.max()
    weights = np.where(wins, spectrum, 0.0) / spectrum[wins].sum()
    linear = np.expm1(np.minimum(excess, 20.0)) @ weights
    apex = fit_apex(
        cells.chainage_m[cells.heard],
        linear[cells.heard],
        float(cells.chainage_m[cell]),
        float(result.width_m[cell]),
    )
    near = np.abs(cells.chainage_m - apex.chainage_m) <= max(apex.width_m, 0.5)
    return Spot(
        place=apex.chainage_m,
        sigma=apex.sigma_m,
        width=apex.width_m,
        score=probability if apex.is_convincing else UNCONVINCING * probability,
        level_db=float(np.log1p(apex.height) * DB_PER_LN),
        band_hz=(float(bands_hz[wins, 0].min()), float(bands_hz[wins, 1].max())),
        evidence={
            "method": "metres",
            "match": float(result.score[cell]),
            "rumble": float(result.rival[cell]),
            "impulsive_share": float((cells.removed_share[near][:, :-1] @ weights).mean()) if near.any() else 0.0,
        },
    )
