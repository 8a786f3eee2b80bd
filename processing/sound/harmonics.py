"""The spectrum of a stretch against its background, and the families of harmonics in it: pumps and motors, not leaks.

P0 and P3 name the method: the FFT of the sound is searched for what disturbs the usual flow. A leak raises the floor of
the spectrum over octaves; a machine adds lines at the multiples of its speed and leaves the floor as it is.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy import ndimage, signal, stats

from processing.survey import FloatArray

_RESOLUTION_HZ = 1.5
_FLOOR_HZ = 60.0  # the floor is the running median over so many
_FALSE_LINES = 0.05  # lines that noise alone may show in one spectrum
_LEAST_PROMINENCE_DB = 3.0
_LINES_TRIED, _PARTS_TRIED = 30, 12  # the strongest lines, each as the first to the twelfth harmonic
_LOWEST_HZ = 8.0
_MISSING_DB = 8.0  # what a missing harmonic costs a family
_CAPPED_DB = 25.0
_FEWEST = 3
_TOLERANCE_BINS = 1.2
_USED_BINS = 2.0
_BY_CHANCE = 1e-4  # some hundred fundamentals are tried


@dataclass(frozen=True)
class Spectrum:
    """Power in dBFS (0: a full-scale sine) a bin, (k,) at ``frequency_hz`` (k,), its floor, and its averages."""

    frequency_hz: FloatArray
    level_db: FloatArray
    floor_db: FloatArray
    averages: float

    @property
    def bin_hz(self) -> float:
        """From bin to bin."""
        return float(self.frequency_hz[1] - self.frequency_hz[0])


@dataclass(frozen=True)
class Harmonic:
    """One line: the ``number``-th of its family, dBFS, over the floor around it, and over the background's level."""

    number: int
    frequency_hz: float
    level_db: float
    prominence_db: float
    over_background_db: float


@dataclass(frozen=True)
class Family:
    """Lines at the multiples of ``fundamental_hz`` (± ``sigma_hz``, 1 sigma), ascending."""

    fundamental_hz: float
    sigma_hz: float
    harmonics: tuple[Harmonic, ...]

    @property
    def over_background_db(self) -> float:
        """Median of the lines' rise over the background: near 0 for what is always there."""
        return float(np.median([h.over_background_db for h in self.harmonics]))


@dataclass(frozen=True)
class Harmonics:
    """What the stretch's spectrum holds beside the background's: families, strongest first, and the floor's rise."""

    stretch: Spectrum
    background: Spectrum | None
    families: tuple[Family, ...]
    floor_rise_db: float  # mean over octaves from 100 Hz up; a leak raises the floor, a machine does not


def spectrum(samples: npt.NDArray[np.floating], sample_rate_hz: float, bin_hz: float = _RESOLUTION_HZ) -> Spectrum:
    """Return the averaged spectrum (P. D. Welch 1967) of ``samples`` (n,), bins no wider than ``bin_hz`` where it can.

    Raises:
        ValueError: fewer than 256 samples.
    """
    if len(samples) < 256:
        raise ValueError("too short for a spectrum")
    wanted = 1 << int(np.ceil(np.log2(sample_rate_hz / bin_hz)))
    size = min(wanted, 1 << int(np.log2(len(samples) / 2)))  # three averages at least
    frequency, power = signal.welch(
        np.asarray(samples, np.float64), sample_rate_hz, "hann", size, detrend="constant", scaling="spectrum"
    )
    level = 10.0 * np.log10(np.maximum(2.0 * power[1:], 1e-30))
    half = max(3, round(0.5 * _FLOOR_HZ / (frequency[1] - frequency[0])))
    floor = ndimage.median_filter(level, 2 * half + 1, mode="nearest")
    segments = 2 * len(samples) // size - 1
    # half-overlapping Hann windows' powers correlate by 1/36; chi-squared's median lies below its mean
    averages = max(1.0, segments / (1.0 + 2.0 / 36.0))
    floor = floor - 10.0 * np.log10(stats.chi2.median(2 * averages) / (2 * averages))
    return Spectrum(np.asarray(frequency[1:], np.float64), level, floor, averages)


def find_harmonics(
    samples: npt.NDArray[np.floating],
    sample_rate_hz: float,
    background: npt.NDArray[np.floating] | None = None,
    most_harmonics: int = 40,
    most_families: int = 4,
) -> Harmonics:
    """Return the families of lines in ``samples`` (n,), up to ``most_harmonics``, and the rise over ``background``.

    Raises:
        ValueError: either has fewer than 256 samples.
    """
    found = spectrum(samples, sample_rate_hz)
    other = spectrum(background, sample_rate_hz, found.bin_hz) if background is not None else None
    families: list[Family] = []
    lines = _lines(found)
    while len(lines) >= _FEWEST and len(families) < most_families:
        best = _best_family(lines, found, most_harmonics)
        if best is None:
            break
        fundamental, members = best
        families.append(_family(fundamental, members, lines, found, other))
        numbers = np.round(lines[:, 0] / fundamental)
        off = np.abs(lines[:, 0] - numbers * fundamental)
        taken = (numbers >= 1) & (off <= _USED_BINS * found.bin_hz)
        lines = lines[~taken]
    families.sort(key=lambda family: -sum(h.prominence_db for h in family.harmonics))
    return Harmonics(found, other, tuple(families), _floor_rise(found, other))


def _lines(found: Spectrum) -> FloatArray:
    """Return the lines (n, 3): frequency between the bins, level, prominence; none of them is likely to be noise."""
    prominence = found.level_db - found.floor_db
    freedom = 2.0 * found.averages
    limit = 10.0 * np.log10(stats.chi2.isf(_FALSE_LINES / len(prominence), freedom) / freedom)
    peak = np.flatnonzero(
        (prominence[1:-1] > max(limit, _LEAST_PROMINENCE_DB))
        & (prominence[1:-1] >= prominence[:-2])
        & (prominence[1:-1] > prominence[2:])
    )
    before, at, after = (found.level_db[peak + k] for k in (0, 1, 2))
    shift = 0.5 * (before - after) / np.minimum(before - 2.0 * at + after, -1e-9)
    frequency = found.frequency_hz[peak + 1] + np.clip(shift, -0.5, 0.5) * found.bin_hz
    return np.column_stack([frequency, at - 0.25 * (before - after) * shift, prominence[peak + 1]])


def _best_family(lines: FloatArray, found: Spectrum, most: int) -> tuple[float, dict[int, int]] | None:
    """Return the fundamental whose multiples hold most lines and miss fewest, and which line is which harmonic."""
    strongest = lines[np.argsort(-lines[:, 2])[:_LINES_TRIED], 0]
    tried = (strongest[:, None] / np.arange(1, _PARTS_TRIED + 1)).ravel()
    chance = min(1.0, 2.0 * _TOLERANCE_BINS * len(lines) / len(found.frequency_hz))
    best, chosen = 0.0, None
    for fundamental in np.unique(tried[tried >= max(_LOWEST_HZ, 4.0 * found.bin_hz)]):
        refined, members = _members(float(fundamental), lines, found, most)
        if len(members) < _FEWEST or 2 * len(members) < max(members):
            continue
        # among many lines some fall on the multiples of anything; one of them made the fundamental
        missing = max(members) - len(members)
        if stats.binom.sf(len(members) - 2, len(members) + missing - 1, chance) > _BY_CHANCE:
            continue
        gained = sum(min(float(lines[row, 2]), _CAPPED_DB) for row in members.values())
        score = gained - _MISSING_DB * missing
        if score > best:
            best, chosen = score, (refined, members)
    return chosen


def _members(fundamental: float, lines: FloatArray, found: Spectrum, most: int) -> tuple[float, dict[int, int]]:
    """Return the fundamental, made better by each line, and the lines (by harmonic) that are its multiples."""
    members: dict[int, int] = {}
    over, under, missed = 0.0, 0.0, 0
    for number in range(1, most + 1):
        at = number * fundamental
        if at > found.frequency_hz[-1] or missed > 3:
            break
        row = int(np.argmin(np.abs(lines[:, 0] - at)))
        if abs(lines[row, 0] - at) > _TOLERANCE_BINS * found.bin_hz:
            missed += 1
            continue
        members[number], missed = row, 0
        over += number * float(lines[row, 0])
        under += number * number
        fundamental = over / under
    return fundamental, members


def _family(
    fundamental: float, members: dict[int, int], lines: FloatArray, found: Spectrum, other: Spectrum | None
) -> Family:
    harmonics = []
    for number, row in members.items():
        frequency, level, prominence = (float(x) for x in lines[row])
        rise = float("nan")
        if other is not None:
            near = np.abs(other.frequency_hz - frequency) <= 1.5 * max(other.bin_hz, found.bin_hz)
            rise = level - float(other.level_db[near].max()) if near.any() else rise
        harmonics.append(Harmonic(number, frequency, level, prominence, rise))
    numbers = np.array(list(members))
    off = np.array([h.frequency_hz for h in harmonics]) - numbers * fundamental
    # a line between the bins is found to some hundredths of a bin
    each = max(float(np.sqrt(np.mean(off**2))), 0.03 * found.bin_hz)
    return Family(fundamental, each / float(np.sqrt(np.sum(numbers**2.0))), tuple(harmonics))


def _floor_rise(found: Spectrum, other: Spectrum | None) -> float:
    """Return the mean over octaves of the floors' difference, each bin's width taken into account."""
    if other is None:
        return float("nan")
    edges = 100.0 * 2.0 ** np.arange(0, 9)
    rises = []
    for low, high in pairwise(edges):
        rows = [(s.frequency_hz >= low) & (s.frequency_hz < high) for s in (found, other)]
        if rows[0].any() and rows[1].any() and high <= found.frequency_hz[-1]:
            a, b = (
                float(np.median(s.floor_db[r])) - 10.0 * float(np.log10(s.bin_hz))
                for s, r in zip((found, other), rows, strict=True)
            )
            rises.append(a - b)
    return float(np.mean(rises)) if rises else float("nan")
