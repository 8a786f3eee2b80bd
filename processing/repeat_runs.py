"""Two runs of the same pipe side by side in metres: levels over their backgrounds, and what is new, gone or grown.

Both are told in *our* chainage, that of the survey which is open. Levels are ratios to each run's own background in
metres, so that the recorder's gain drops out. What the speed does to the background is common to all places: it is
taken off by the median over the places heard in both runs; where fewer than three are, it is not known, and the ± has
it. A place is gone only if the newer run could have heard it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from enum import StrEnum

import numpy as np
from scipy.optimize import linear_sum_assignment

from processing.errors import ErrorCode, LeaklineError
from processing.position.distance import NORMAL_95
from processing.repeat_alignment import CHAINAGES, LAUNCH, Alignment, align
from processing.results import Results
from processing.sound.background import robust_sigma, running_median
from processing.sound.cells import CELL_M, DB_PER_LN, Cells, cells_of, excess_of, frames_of
from processing.survey import BoolArray, Candidate, Decision, FloatArray, LeakClass, Verdict

LEAST_COMMON_M = 10.0
_SPEED_EXPONENT = 3.0  # the power of rolling noise rises about so with the speed
_LEAST_SCATTER_DB = 0.3
_NEAR_M = 1.0  # a peak is looked for at least so far around its place
_PLAIN = 0.3  # a correlation
_MOVED = 2.0  # joint intervals apart: more is another place


class Change(StrEnum):
    """What became of a place."""

    SAME = "same"
    NEW = "new"
    GONE = "gone"
    MOVED = "moved"  # perhaps: near a place of the other run, but beyond the joint interval
    NOT_HEARD = "not_heard"  # the other run could not assess it


@dataclass(frozen=True)
class ComparedRun:
    """A run with the operator's words on it; ``date`` is the day in its form, ISO 8601, or empty."""

    name: str
    date: str
    results: Results
    decisions: Mapping[int, Decision] = field(default_factory=dict)
    imported_utc: str = ""  # when its recording came into the survey: of two runs of one day it tells which was first


@dataclass(frozen=True)
class Strip:
    """A run's sound on the common grid: dB over its background, NaN where not assessed."""

    excess_db: FloatArray  # (n,) of the common band
    picture_db: FloatArray  # (n, b) of all bands
    speed_mps: FloatArray  # (n,)

    @property
    def assessed(self) -> BoolArray:
        """Where the run heard the pipe, (n,)."""
        return np.asarray(np.isfinite(self.excess_db), np.bool_)


@dataclass(frozen=True)
class Place:
    """A place of either run or of both, in our chainage; the interval is the joint one of all that is known.

    ``growth_db`` is newer minus older of the sound's power over the background, ± ``growth_half95_db``; ``at_least``
    says that the older (or for a falling one the newer) sound lay hidden in the background.
    """

    change: Change
    chainage_m: float
    half95_m: float
    ours: Candidate | None
    theirs: Candidate | None
    apart_m: float = float("nan")  # theirs minus ours, where both are there
    growth_db: float = float("nan")
    growth_half95_db: float = float("nan")
    at_least: bool = False

    @property
    def has_changed(self) -> bool:
        """Whether it sounds plainly louder or fainter."""
        return bool(abs(self.growth_db) > self.growth_half95_db)

    @property
    def heard_in_both(self) -> bool:
        """Whether both runs' sound stands over the background here, and plainly alike, whoever found a leak in it."""
        return bool(np.isfinite(self.growth_db)) and not self.at_least and not self.has_changed


@dataclass(frozen=True)
class Comparison:
    """All of two runs side by side; ``ours_newer`` says which way time goes."""

    ours: ComparedRun
    theirs: ComparedRun
    ours_newer: bool
    alignment: Alignment
    chainage_m: FloatArray  # (n,) the common grid, ours
    bands_hz: FloatArray  # (b, 2) of the pictures
    strips: tuple[Strip, Strip]  # ours, theirs
    places: tuple[Place, ...]  # along the pipe
    common_db: float  # growth common to all places, taken off: speed and recorder
    common_known: bool
    may_be_reversed: bool = False  # nothing tells the direction, and the sounds agree better the other way round
    order_known: bool = True  # the days in the forms tell which run is the newer one

    @property
    def older(self) -> ComparedRun:
        """The run that was before."""
        return self.theirs if self.ours_newer else self.ours

    @property
    def common_m(self) -> float:
        """Metres that both runs assessed."""
        return CELL_M * float(np.count_nonzero(self.strips[0].assessed & self.strips[1].assessed))


def compare(ours: ComparedRun, theirs: ComparedRun, *, is_reversed: bool | None = None) -> Comparison:
    """Put two runs side by side.

    Raises:
        LeaklineError: REPEAT_NO_PATH; REPEAT_NOTHING_COMMON with ``least_m``.
    """
    cells = [_cells(run.results) for run in (ours, theirs)]
    alignment = align(ours.results, theirs.results, is_reversed=is_reversed)
    grid, bands = _grid(cells, alignment), _common_bands(ours.results, theirs.results)
    strips = (
        _strip(ours.results, cells[0], grid, bands[0]),
        _strip(theirs.results, cells[1], alignment.to_theirs(grid), bands[1]),
    )
    if CELL_M * np.count_nonzero(strips[0].assessed & strips[1].assessed) < LEAST_COMMON_M:
        raise LeaklineError(ErrorCode.REPEAT_NOTHING_COMMON, least_m=LEAST_COMMON_M)
    newer, order_known = _is_newer(ours, theirs)
    # one place alone, or figures that two launches may share by chance, do not tell the direction
    unsure = alignment.basis in (LAUNCH, CHAINAGES) or len(alignment.anchors) == 1
    turned = is_reversed is None and unsure and _better_turned(ours, theirs, cells, grid, bands)
    draft = Comparison(
        ours, theirs, newer, alignment, grid, bands[2], strips, (), 0.0, common_known=False, may_be_reversed=turned,
        order_known=order_known,
    )  # fmt: skip
    return _with_growth(draft, _matched(draft))


def redecided(comparison: Comparison, candidates: Sequence[Candidate], decisions: Mapping[int, Decision]) -> Comparison:
    """Return a comparison with our run's candidates and the operator's words as they are now; no sound is read."""
    results = replace(comparison.ours.results, candidates=tuple(candidates))
    draft = replace(comparison, ours=replace(comparison.ours, results=results, decisions=decisions), places=())
    return _with_growth(draft, _matched(draft))


def _is_newer(ours: ComparedRun, theirs: ComparedRun) -> tuple[bool, bool]:
    """Return whether ours is the newer run, and whether the days in the forms say so; else it is the later import."""
    here, there = _day(ours), _day(theirs)
    if here is not None and there is not None and here != there:
        return here > there, True
    return ours.imported_utc >= theirs.imported_utc, False


def _day(run: ComparedRun) -> date | None:
    """Return the day in a run's form; None for none, for no day, and for one that was to come when it was imported."""
    try:
        day = date.fromisoformat(run.date)
        imported = date.fromisoformat(run.imported_utc[:10]) if run.imported_utc else date.max
    except ValueError:
        return None
    return day if (day - imported).days <= 1 else None  # a day of leeway for zones of time


def _better_turned(
    ours: ComparedRun,
    theirs: ComparedRun,
    cells: list[Cells],
    grid: FloatArray,
    bands: tuple[list[int], list[int], FloatArray],
) -> bool:
    """Tell whether the two sounds along the pipe agree plainly better with one run turned round."""
    here = _strip(ours.results, cells[0], grid, bands[0]).excess_db
    fits = []
    for turned in (False, True):
        other = align(ours.results, theirs.results, is_reversed=turned)
        there = _strip(theirs.results, cells[1], other.to_theirs(grid), bands[1]).excess_db
        both = np.isfinite(here) & np.isfinite(there)
        fits.append(float(np.corrcoef(here[both], there[both])[0, 1]) if np.count_nonzero(both) > 40 else 0.0)
    return fits[1] > _PLAIN and fits[1] > fits[0] + _PLAIN


def _cells(results: Results) -> Cells:
    if results.track is None or results.scan is None:
        raise LeaklineError(ErrorCode.REPEAT_NO_PATH)
    frames = frames_of(results.scan, results.clock, results.track, results.not_assessed, results.settings.detector)
    cells = cells_of(results.scan, frames)
    if cells is None:
        raise LeaklineError(ErrorCode.REPEAT_NO_PATH)
    return cells


def _grid(cells: list[Cells], alignment: Alignment) -> FloatArray:
    """Return the middles of our cells where theirs are too."""
    ours, theirs = cells
    ends = alignment.to_ours(np.array([theirs.chainage_m[0], theirs.chainage_m[-1]]))
    inside = (ours.chainage_m >= ends.min() - CELL_M) & (ours.chainage_m <= ends.max() + CELL_M)
    if np.count_nonzero(inside) * CELL_M < LEAST_COMMON_M:
        raise LeaklineError(ErrorCode.REPEAT_NOTHING_COMMON, least_m=LEAST_COMMON_M)
    grid: FloatArray = ours.chainage_m[inside]
    return grid


def _common_bands(ours: Results, theirs: Results) -> tuple[list[int], list[int], FloatArray]:
    """Return which bands both runs have, and their edges: recorders differ in rate, the table of bands does not."""
    assert ours.scan is not None
    assert theirs.scan is not None
    here, there = ours.scan.bands_hz[:-1], theirs.scan.bands_hz[:-1]
    pairs = [(i, j) for i, a in enumerate(here) for j, b in enumerate(there) if np.allclose(a, b, rtol=0.02, atol=1.0)]
    if not pairs:
        raise LeaklineError(ErrorCode.REPEAT_NOTHING_COMMON, least_m=LEAST_COMMON_M)
    return [i for i, _ in pairs], [j for _, j in pairs], here[[i for i, _ in pairs]]


def _strip(results: Results, cells: Cells, at_m: FloatArray, bands: list[int]) -> Strip:
    """Return a run's sound at places of its own chainage."""
    background_m = results.settings.detector.background_m
    pictures = DB_PER_LN * excess_of(cells, background_m, bands)
    assert results.scan is not None
    edges, settings = results.scan.bands_hz, results.settings.sound
    middle = np.sqrt(edges[:-1, 0] * edges[:-1, 1])
    inside = [b for b in bands if settings.band_low_hz <= middle[b] <= settings.band_high_hz] or bands
    power = np.exp(cells.log_power[:, inside]).sum(axis=1)
    level = DB_PER_LN * np.log(np.maximum(power, 1e-300))
    level[~cells.heard] = np.nan
    half = max(1, round(background_m / CELL_M))
    excess = level - running_median(level, half)
    place = np.round((at_m - cells.chainage_m[0]) / CELL_M).astype(np.intp)
    there = (place >= 0) & (place < len(cells.chainage_m))
    place = np.clip(place, 0, len(cells.chainage_m) - 1)
    there &= cells.heard[place] & np.isfinite(excess[place])
    return Strip(
        np.where(there, excess[place], np.nan),
        np.where(there[:, None], pictures[place], np.nan),
        np.where(there, cells.speed_mps[place], np.nan),
    )


# --- places ---


def _matched(draft: Comparison) -> list[Place]:
    """Return all places: pairs within their joint intervals first, then what is near, then what is alone."""
    ours = [c for c in draft.ours.results.candidates if _counts(c, draft.ours)]
    theirs = [c for c in draft.theirs.results.candidates if _counts(c, draft.theirs)]
    where = draft.alignment.to_ours(np.array([c.chainage_m for c in theirs])) if theirs else np.empty(0)
    here = np.array([c.chainage_m for c in ours])
    joint = np.array([[_joint(draft.alignment, a, b) for b in theirs] for a in ours], dtype=np.float64).reshape(
        len(ours), len(theirs)
    )
    apart = np.abs(here[:, None] - where[None, :]) / np.maximum(joint, 1e-6)
    places, taken_a, taken_b = [], set(), set()
    for row, column in zip(*linear_sum_assignment(np.minimum(apart, 10.0 * _MOVED)), strict=True):
        if apart[row, column] > _MOVED:
            continue
        taken_a.add(int(row))
        taken_b.add(int(column))
        change = Change.SAME if apart[row, column] <= 1.0 else Change.MOVED
        off = float(where[column] - here[row])
        places.append(
            Place(change, float(here[row]), float(joint[row, column]), ours[row], theirs[column], apart_m=off)
        )
    for i, candidate in enumerate(ours):
        if i not in taken_a:
            change = _alone(draft, candidate.chainage_m, newer=draft.ours_newer, other=1)
            places.append(Place(change, candidate.chainage_m, _half(candidate), candidate, None))
    for j, candidate in enumerate(theirs):
        if j not in taken_b:
            at = float(where[j])
            half = float(np.hypot(_half(candidate), NORMAL_95 * draft.alignment.sigma_at(at)[0]))
            change = _alone(draft, at, newer=not draft.ours_newer, other=0)
            places.append(Place(change, at, half, None, candidate))
    return sorted(places, key=lambda place: place.chainage_m)


def _counts(candidate: Candidate, run: ComparedRun) -> bool:
    """Tell whether a candidate is compared: a leak for the machine or the operator, with a place."""
    decision = run.decisions.get(candidate.id, Decision())
    if decision.verdict is Verdict.REJECTED or not np.isfinite(candidate.chainage_m):
        return False
    taken_for = decision.leak_class or candidate.leak_class
    return decision.verdict is Verdict.CONFIRMED or taken_for in (LeakClass.LEAK, LeakClass.UNKNOWN)


def _half(candidate: Candidate) -> float:
    return (candidate.chainage_high95_m - candidate.chainage_low95_m) / 2.0


def _joint(alignment: Alignment, ours: Candidate, theirs: Candidate) -> float:
    """Return the half-width within which two sights of one place lie apart in 95 of 100 cases."""
    sigma = float(alignment.sigma_at(ours.chainage_m)[0])
    return float(np.sqrt(_half(ours) ** 2 + _half(theirs) ** 2 + (NORMAL_95 * sigma) ** 2))


def _alone(draft: Comparison, at_m: float, *, newer: bool, other: int) -> Change:
    """Return what a place without a partner is: new or gone if the other run could have heard it."""
    near = np.abs(draft.chainage_m - at_m) <= _NEAR_M
    heard = draft.strips[other].assessed[near]
    if not len(heard) or np.mean(heard) < 0.5:
        return Change.NOT_HEARD
    return Change.NEW if newer else Change.GONE


# --- growth ---


def _with_growth(draft: Comparison, places: list[Place]) -> Comparison:
    """Return the comparison with how much louder each place is, what is common to all taken off."""
    scatter = _scatter(draft, places)
    raw = [_growth(draft, place, scatter) for place in places]
    paired = [
        value
        for place, (value, _, hidden) in zip(places, raw, strict=True)
        if place.change in (Change.SAME, Change.MOVED) and np.isfinite(value) and not hidden
    ]
    known = len(paired) >= 3
    common = float(np.median(paired)) if known else 0.0
    doubt = _speed_db(draft)
    if known:  # the error of a median of so many
        spread = max(float(robust_sigma(np.array(paired))), scatter)
        doubt = min(doubt + scatter, 1.2533 * spread / float(np.sqrt(len(paired))))
    told = []
    for place, (value, sigma, hidden) in zip(places, raw, strict=True):
        half = NORMAL_95 * float(np.hypot(sigma, doubt))
        told.append(replace(place, growth_db=value - common, growth_half95_db=half, at_least=hidden))
    return replace(draft, places=tuple(told), common_db=common, common_known=known)


def _speed_db(draft: Comparison) -> float:
    """Return what two speeds may do to the level over the background, 1 sigma: the cube law's all counts as 95 %."""
    speeds = [float(np.nanmedian(strip.speed_mps)) for strip in draft.strips]
    if min(speeds) <= 0.0:
        return 0.0
    return abs(10.0 * _SPEED_EXPONENT * math.log10(speeds[0] / speeds[1])) / NORMAL_95


def _scatter(draft: Comparison, places: list[Place]) -> float:
    """Return the robust scatter of one run's level over its background away from all places, decibels."""
    away = np.ones(len(draft.chainage_m), np.bool_)
    for place in places:
        away &= np.abs(draft.chainage_m - place.chainage_m) > max(3.0, 2.0 * place.half95_m)
    difference = (draft.strips[0].excess_db - draft.strips[1].excess_db)[away]
    difference = difference[np.isfinite(difference)]
    if len(difference) < 8:
        return 1.0
    return max(_LEAST_SCATTER_DB, float(robust_sigma(difference)) / math.sqrt(2.0))


def _growth(draft: Comparison, place: Place, scatter_db: float) -> tuple[float, float, bool]:
    """Return newer minus older of a place's power over the background, its sigma, and whether one was hidden."""
    if place.change is Change.NOT_HEARD:
        return float("nan"), float("nan"), False
    reach = max(_NEAR_M, place.half95_m)
    peaks = [_peak(strip, draft.chainage_m, place.chainage_m, reach) for strip in draft.strips]
    if not all(np.isfinite(peak) for peak in peaks):
        return float("nan"), float("nan"), False
    floor = 10.0 ** (2.0 * scatter_db / 10.0) - 1.0
    ratios = [10.0 ** (peak / 10.0) - 1.0 for peak in peaks]
    hidden = bool(min(ratios) < floor)
    ratios = [max(ratio, floor) for ratio in ratios]
    newer, older = (ratios[0], ratios[1]) if draft.ours_newer else (ratios[1], ratios[0])
    # of 10·log10(10^(x/10) − 1) with respect to x
    sigma = scatter_db * float(np.hypot((1.0 + newer) / newer, (1.0 + older) / older))
    return float(10.0 * np.log10(newer / older)), sigma, hidden


def _peak(strip: Strip, chainage_m: FloatArray, at_m: float, reach_m: float) -> float:
    """Return the highest metre near a place, decibels over the background."""
    near = np.abs(chainage_m - at_m) <= reach_m
    values = strip.excess_db[near]
    values = values[np.isfinite(values)]
    if len(values) < 4:
        return float("nan")
    metre = round(1.0 / CELL_M)
    smooth = np.convolve(values, np.full(metre, 1.0 / metre), mode="valid")
    return max(float(value) for value in smooth)
