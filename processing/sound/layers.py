"""The detector in layers (``layers``): takes strong sources off the sound one after another, and looks beneath them.

A strong leak bends everything that a weak one is judged by: the background, the covariance of the bands, its
neighbours' shape. So what is loud is found first by its loudness alone, fitted and divided out; the covariance is
learnt from what is left and usual; weaker sources are found in it, divided out, and so on. Every candidate is scored
with the others taken out, by the likelihood ratio of "leak and rumble" against "rumble alone".
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from processing.sound.apex import Apex, fit_apex
from processing.sound.background import robust_sigma
from processing.sound.cells import CELL_M, DB_PER_LN, Cells
from processing.sound.matching import peaks_apart
from processing.sound.passed_source import Source, around, fit_source
from processing.sound.sound_field import WIDTHS_M, SoundField, amplitudes, flattened, sound_field
from processing.sound.source_spectra import bell, leak_spectra, middles, rumble_spectra
from processing.sound.spots import UNCONVINCING, Listening, Spot
from processing.sound.whitening import ScoreMap, likelihood_ratio, score_map, whiten
from processing.survey import BoolArray, FloatArray

_LOUD_HZ, _LOUD_OCTAVES = (500.0, 800.0, 1300.0, 2100.0, 3400.0), 4.71
_LOUD_SIGMAS, _AUDIBLE_SIGMAS = 7.0, 4.0  # taken off; only kept from teaching
_LOUD_ROUNDS, _ROUNDS = 3, 3
_STRONG, _STANDS_OUT = 8.0, 5.0  # likewise, of the likelihood ratio and of the quick score
_LEAST_QUICK, _LEAST = 2.0, 2.5
_MODEL_ERROR = 0.08  # of a fitted source's log rise: what its shape leaves over
_AROUND_WIDTHS = 2.0
_MOST_MASKED = 0.6
_APART_M, _APART_WIDTHS = 5.0, 1.5
_CLEAR_WIDTHS, _CLEAR_M = 6.0, 4.0  # within it only the strongest is fitted in a round: others may be its flanks
_BURST_CELLS, _BURST_SHARE, _BURST_SIGMAS, _BURST_EDGE = 8, 0.7, 3.0, 3
_SEEN_SIGMA, _SEEN_FLOOR = 1.5, 0.1  # in half-widths, measured on simulated mains
_RUNAWAY = 2.5  # a fit so much wider than what was seen has followed the drift
_PEAKS = 0.2  # a metre: as many as stand 5 m apart
_LOGISTIC = (7.8, 4.0)  # half at 7: on simulated mains as many leaks as others stand there


@dataclass(frozen=True)
class _Found:
    """A source that was taken off, and by how much it raised the log power (n, b)."""

    source: Source
    rise: FloatArray
    width_m: float


@dataclass(frozen=True)
class _Sought:
    """What stays the same throughout the search."""

    field: SoundField
    leaks: FloatArray
    rivals: FloatArray
    bands_hz: FloatArray
    background_m: float


@dataclass(frozen=True)
class _Peak:
    cell: int
    width_m: float
    score: float
    spectrum: int


def find_in_layers(listening: Listening) -> list[Spot]:
    """Return the spots, best first."""
    cells = listening.cells
    if cells is None:
        raise ValueError("the detector in layers needs a path")
    bands_hz = listening.scan.bands_hz[:-1]
    sought = _Sought(
        sound_field(cells), leak_spectra(bands_hz), rumble_spectra(bands_hz), bands_hz, listening.settings.background_m
    )
    sought = replace(sought, field=_without_bursts(sought))
    found, audible = _loud(sought)
    found, scores, peaks, excess = _quiet(sought, found, audible)
    spots = [_spot_of_found(sought, cells, excess, scores, found, one) for one in found]
    beside = [(one.source.place_m, _apart(one.source.width_m)) for one in found]
    for peak in peaks:
        place = float(sought.field.chainage_m[peak.cell])
        if peak.score >= _LEAST and all(abs(place - other) >= apart for other, apart in beside):
            spots.append(_spot(sought, cells, excess, peak))
    spots = [s for s in _distinct(spots) if s.score >= listening.settings.min_score]
    return spots[: int(listening.settings.max_candidates)]


def confidence(score: float) -> float:
    """Return the probability (0..1) that a likelihood ratio is a leak's."""
    offset, slope = _LOGISTIC
    return float(1.0 / (1.0 + np.exp(offset - slope * np.log(max(score, 1e-6)))))


def _without_bursts(sought: _Sought) -> SoundField:
    """Return the field in which what is narrower than any leak has no weight: scraping, a longer knock.

    The median over ±2 m holds at least 0.39 of the narrowest leak's rise; of a burst it holds next to nothing.
    """
    field = sought.field
    excess = flattened(field, field.log_power, sought.background_m)
    broad = _broad(sought.bands_hz)
    level = excess @ broad
    sigma = np.sqrt(field.variance @ broad**2 / np.maximum(field.weight, 1e-3)[:, None])
    around_it = ndimage.median_filter(level, (2 * _BURST_CELLS + 1, 1), mode="nearest")
    burst: BoolArray = np.any(level - around_it > _BURST_SHARE * np.maximum(level, 0.0) + _BURST_SIGMAS * sigma, axis=1)
    burst = np.convolve(burst, np.ones(2 * _BURST_EDGE + 1), mode="same") > 0.5
    return replace(field, weight=np.where(burst, 0.0, field.weight))


def _broad(bands_hz: FloatArray) -> FloatArray:
    """Return (b, 5) broad bands as weights that sum to one."""
    hz = middles(bands_hz)
    broad = np.column_stack([bell(hz, middle, _LOUD_OCTAVES) for middle in _LOUD_HZ])
    return np.asarray(broad / broad.sum(axis=0), np.float64)


def _loud(sought: _Sought) -> tuple[list[_Found], BoolArray]:
    """Return what stands out by loudness in any broad band, fitted, and the cells of what is audible beside it."""
    field = sought.field
    broad = _broad(sought.bands_hz)
    found: list[_Found] = []
    audible = np.zeros(len(field.heard), np.bool_)
    for _ in range(_LOUD_ROUNDS):
        excess = _left_over(sought, found)
        weight = _trusted(field, found)
        score, width = _loudness(field, excess, weight, broad, field.heard & ~_taught_by(field, found))
        apart = np.maximum(6.0, 4 * width)
        peaks = peaks_apart(score, field.chainage_m, apart, _limit(field))
        new = [_found(field, excess, weight, int(c), float(width[c])) for c in peaks if score[c] > _LOUD_SIGMAS]
        found += [one for one in new if one is not None]
        audible = np.zeros(len(field.heard), np.bool_)
        for c in peaks[score[peaks] > _AUDIBLE_SIGMAS]:
            audible |= np.abs(field.chainage_m - field.chainage_m[c]) < _AROUND_WIDTHS * width[c]
        if not new:
            break
    return found, audible


def _loudness(
    field: SoundField, excess: FloatArray, weight: FloatArray, broad: FloatArray, usual: BoolArray
) -> tuple[FloatArray, FloatArray]:
    best = np.full(len(excess), -np.inf)
    width = np.zeros(len(excess))
    usual = usual if usual.any() else field.heard
    for width_m in WIDTHS_M:
        height = amplitudes(excess, weight, width_m)[0] @ broad
        sigma = np.maximum(np.array([robust_sigma(column) for column in height[usual].T]), 1e-9)
        score = ((height - np.median(height[usual], axis=0)) / sigma).max(axis=1)
        score[~field.heard] = -np.inf
        better = score > best
        best[better], width[better] = score[better], width_m
    return best, width


def _quiet(
    sought: _Sought, found: list[_Found], audible: BoolArray
) -> tuple[list[_Found], ScoreMap, list[_Peak], FloatArray]:
    """Return all sources taken off, the last scores, the peaks in them, and the excess they were seen in."""
    field, found = sought.field, list(found)
    for last in range(1, _ROUNDS + 1):
        excess = _left_over(sought, found)
        weight = _trusted(field, found)
        scores = score_map(field, excess, weight, _usual(field, found, audible), sought.leaks, sought.rivals)
        peaks, audible = _peaks(field, scores)
        if last == _ROUNDS:
            break
        new = [_found(field, excess, weight, peak.cell, peak.width_m) for peak in _clear(field, peaks)]
        found += [one for one in new if one is not None]
    return found, scores, peaks, excess


def _peaks(field: SoundField, scores: ScoreMap) -> tuple[list[_Peak], BoolArray]:
    widths = np.array(WIDTHS_M)[scores.width]
    cells = peaks_apart(scores.score, field.chainage_m, np.maximum(_APART_M, _APART_WIDTHS * widths), _limit(field))
    audible = np.zeros(len(field.heard), np.bool_)
    peaks = []
    for cell in cells[scores.score[cells] > _LEAST_QUICK]:
        layer = scores.whitened[scores.width[cell]]
        score, spectrum = likelihood_ratio(layer, layer.values[cell])
        peaks.append(_Peak(int(cell), layer.width_m, score, spectrum))
        if scores.score[cell] > _STANDS_OUT:
            audible |= np.abs(field.chainage_m - field.chainage_m[cell]) < _AROUND_WIDTHS * layer.width_m
    return sorted(peaks, key=lambda peak: -peak.score), audible


def _clear(field: SoundField, peaks: list[_Peak]) -> list[_Peak]:
    """Return the strong peaks without those that may be flanks of a stronger one."""
    taken: list[_Peak] = []
    for peak in peaks:
        if peak.score < _STRONG:
            break
        place = field.chainage_m[peak.cell]
        if all(
            abs(place - field.chainage_m[other.cell]) >= _CLEAR_WIDTHS * max(peak.width_m, other.width_m) + _CLEAR_M
            for other in taken
        ):
            taken.append(peak)
    return taken


def _found(field: SoundField, excess: FloatArray, weight: FloatArray, cell: int, width_m: float) -> _Found | None:
    source = fit_source(field, excess, weight, cell, width_m)
    return None if source is None else _Found(source, source.log_rise(field.chainage_m), width_m)


def _left_over(sought: _Sought, found: list[_Found]) -> FloatArray:
    log_power = sought.field.log_power
    for one in found:
        log_power = log_power - one.rise
    return flattened(sought.field, log_power, sought.background_m)


def _trusted(field: SoundField, found: list[_Found]) -> FloatArray:
    """Return the cells' weights (n,) where sources were taken off: their shapes are not quite right."""
    weight = field.weight
    sigma = np.sqrt(field.variance)
    for one in found:
        weight = weight / (1.0 + np.square(_MODEL_ERROR * (one.rise / sigma).max(axis=1)))
    return weight


def _taught_by(field: SoundField, found: list[_Found]) -> BoolArray:
    near = np.zeros(len(field.heard), np.bool_)
    for one in found:
        near |= around(field.chainage_m, one.source, _AROUND_WIDTHS)
    return near


def _usual(field: SoundField, found: list[_Found], audible: BoolArray) -> BoolArray:
    """Return the cells that teach what is usual: without what was found, and what is audible unless little is left."""
    near = _taught_by(field, found)
    for unusual in (near | audible, near):
        usual: BoolArray = field.heard & ~unusual
        if np.count_nonzero(usual) >= (1 - _MOST_MASKED) * len(usual):
            return usual
    return field.heard


def _spot_of_found(
    sought: _Sought, cells: Cells, excess: FloatArray, scores: ScoreMap, found: list[_Found], one: _Found
) -> Spot:
    """Return the spot of a source that was taken off: put back, the others kept off."""
    field = sought.field
    back = excess + one.rise
    weight = _trusted(field, [other for other in found if other is not one])
    cell = int(np.argmin(np.abs(field.chainage_m - one.source.place_m)))
    best = _Peak(cell, one.width_m, 0.0, -1)
    for layer in scores.whitened:
        half = int(np.ceil(7 * layer.width_m / CELL_M))
        rows = slice(max(0, cell - half), cell + half + 1)
        height, information = amplitudes(back[rows], weight[rows], layer.width_m)
        here = cell - rows.start
        score, spectrum = likelihood_ratio(layer, whiten(layer, height[here], float(information[here]), field))
        if score > best.score:
            best = _Peak(cell, layer.width_m, score, spectrum)
    width_m = min(WIDTHS_M, key=lambda w: abs(np.log(w / one.source.width_m)))
    return _spot(sought, cells, back, replace(best, width_m=width_m))


def _spot(sought: _Sought, cells: Cells, excess: FloatArray, peak: _Peak) -> Spot:
    field = sought.field
    spectrum = sought.leaks[:, peak.spectrum] if peak.spectrum >= 0 else np.ones(excess.shape[1])
    wins = spectrum >= 0.5 * spectrum.max()
    weights = np.where(wins, spectrum, 0.0) / spectrum[wins].sum()
    linear = np.expm1(np.minimum(excess, 20.0)) @ weights
    heard = field.heard
    apex = fit_apex(field.chainage_m[heard], linear[heard], float(field.chainage_m[peak.cell]), peak.width_m)
    if apex.width_m > _RUNAWAY * peak.width_m:
        apex = _as_seen(sought, excess, spectrum, peak)
    near = np.abs(field.chainage_m - apex.chainage_m) <= max(apex.width_m, 0.5)
    probability = confidence(peak.score)
    return Spot(
        place=apex.chainage_m,
        sigma=apex.sigma_m,
        width=apex.width_m,
        score=probability if apex.is_convincing else UNCONVINCING * probability,
        level_db=float(np.log1p(apex.height) * DB_PER_LN),
        band_hz=(float(sought.bands_hz[wins, 0].min()), float(sought.bands_hz[wins, 1].max())),
        evidence={
            "method": "layers",
            "match": peak.score,
            "impulsive_share": float((cells.removed_share[near][:, :-1] @ weights).mean()) if near.any() else 0.0,
        },
    )


def _as_seen(sought: _Sought, excess: FloatArray, spectrum: FloatArray, peak: _Peak) -> Apex:
    """Return the apex of the peak's own shape and spectrum: where a fit of its width would follow the drift."""
    field = sought.field
    half = int(np.ceil(7 * peak.width_m / CELL_M))
    rows = slice(max(0, peak.cell - half), peak.cell + half + 1)
    weights = spectrum / field.variance
    height = amplitudes(excess[rows], field.weight[rows], peak.width_m)[0] @ weights / (weights @ spectrum)
    middle = peak.cell - rows.start
    room = max(1, round(0.75 * peak.width_m / CELL_M))
    first = max(0, middle - room)
    top = first + int(np.argmax(height[first : middle + room + 1]))
    rise = max(float(height[top]), 1e-6) * float(spectrum.max())
    sigma = _SEEN_SIGMA * peak.width_m * (1.0 / max(peak.score, 1.0) + _SEEN_FLOOR)
    return Apex(float(field.chainage_m[rows][top]), sigma, peak.width_m, float(np.expm1(rise)))


def _distinct(spots: list[Spot]) -> list[Spot]:
    """Return the spots, best first, without those that lie on a better one."""
    kept: list[Spot] = []
    for spot in sorted(spots, key=lambda s: -float(s.evidence["match"])):
        if all(abs(spot.place - other.place) >= 0.5 * _apart(other.width) for other in kept):
            kept.append(spot)
    return sorted(kept, key=lambda s: -s.score)


def _apart(width_m: float) -> float:
    return max(_APART_M, _APART_WIDTHS * width_m)


def _limit(field: SoundField) -> int:
    return 20 + int(_PEAKS * len(field.heard) * CELL_M)
