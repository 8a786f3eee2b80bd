"""What the parts of a recording say one by one: whether the sound was there all the time, and whether a clock drifts.

A leak sounds all the time from one place; a draw-off comes and goes. A delay that moves steadily is a drifting clock.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from processing.correlation.correlogram import Dispersion, Peak, correlate, peaks
from processing.correlation.spectra import OVERLAP_COST, CrossSpectra
from processing.survey import BoolArray, FloatArray

_SIGNIFICANT = 3.0
_LEAST_PARTS = 4
MOST_GROUPS = 12


@dataclass(frozen=True)
class PartDelays:
    """The delay found near a peak in each part of the recording (p,): seconds of A, delay, its sigma, and ``present``.

    Where ``present`` is False the part's correlation does not stand out there.
    """

    time_s: FloatArray
    delay_s: FloatArray
    sigma_s: FloatArray
    height: FloatArray
    present: BoolArray

    @property
    def share(self) -> float:
        """In which part of the time the sound was there, 0..1."""
        return float(np.mean(self.present)) if len(self.present) else 0.0

    @property
    def spread_s(self) -> float:
        """Standard deviation of the delays of those parts in which the sound was there; NaN for fewer than two."""
        known = self.delay_s[self.present]
        return float(np.std(known, ddof=1)) if len(known) > 1 else math.nan


@dataclass(frozen=True)
class Drift:
    """How the delay moves: ``ppm`` ± ``sigma_ppm`` of B's clock against A's, over ``span_s``."""

    ppm: float
    sigma_ppm: float
    span_s: float

    @property
    def significant(self) -> bool:
        """Whether it is more than chance, and moves the delay at all."""
        return abs(self.ppm) > _SIGNIFICANT * self.sigma_ppm and abs(self.ppm) > 0.2


def grouped(spectra: CrossSpectra, groups: int = MOST_GROUPS) -> list[CrossSpectra]:
    """Return spectra of up to so many stretches of the recording, in order."""
    count = min(groups, len(spectra.part_s))
    edges = np.linspace(0, len(spectra.part_s), count + 1).round().astype(int)
    found = []
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        rows = slice(first, last)
        found.append(
            replace(
                spectra,
                part_s=spectra.part_s[rows],
                used=spectra.used[rows],
                aa=spectra.aa[rows],
                bb=spectra.bb[rows],
                ab=spectra.ab[rows],
            )
        )
    return found


def delays_of_parts(
    spectra: CrossSpectra, weight: FloatArray, peak: Peak, longest_s: float, dispersion: Dispersion
) -> PartDelays:
    """Return what each of up to twelve parts says of a peak of the whole."""
    rows: list[tuple[float, float, float, float, bool]] = []
    reach_s = max(2.0 * peak.half_width_s, 3.0 * _sigma_of_peak(spectra, weight))
    for part in grouped(spectra):
        gram = correlate(part, part.s_ab, weight, longest_s, dispersion)
        near = np.abs(gram.delay_s - peak.delay_s) <= reach_s
        turned = np.where(near, peak.polarity * gram.value, -np.inf)
        at = int(np.argmax(turned))
        at = min(max(at, 1), len(turned) - 2)
        height = float(turned[at])
        left, middle, right = (peak.polarity * gram.value[at - 1 : at + 2]).tolist()
        curve = left - 2.0 * middle + right
        shift = min(max(0.5 * (left - right) / curve, -1.0), 1.0) if curve < 0.0 else 0.0
        present = height > _SIGNIFICANT * gram.chance
        moment = float(np.average(part.part_s, weights=part.used))
        sigma = _sigma_of_peak(part, weight)
        rows.append((moment, float(gram.delay_s[at]) + shift * gram.step_s, sigma, height, present))
    time_s, delay_s, sigma_s, height_of, present_in = (np.array(column) for column in zip(*rows, strict=True))
    return PartDelays(time_s, delay_s, sigma_s, height_of, present_in.astype(bool))


def _sigma_of_peak(spectra: CrossSpectra, weight: FloatArray) -> float:
    """Return the sigma of the delay of a weighted correlation's peak (first order): noise slope over curvature."""
    omega = 2.0 * np.pi * spectra.frequency_hz
    power = spectra.smooth_aa * spectra.smooth_bb
    coherent = np.sqrt(np.clip(spectra.true_coherence, 0.0, 0.98) * power)
    curvature = float(np.sum(weight * coherent * omega**2))
    noise = 0.5 * OVERLAP_COST / max(spectra.total, 1.0) * float(np.sum((weight * omega) ** 2 * power))
    return math.sqrt(noise) / curvature if curvature > 0.0 else math.inf


def drift_of(parts: PartDelays) -> Drift | None:
    """Return the steady movement of the delay by weighted least squares; None where too few parts tell."""
    known = parts.present & np.isfinite(parts.sigma_s)
    if np.count_nonzero(known) < _LEAST_PARTS:
        return None
    time_s, delay_s = parts.time_s[known], parts.delay_s[known]
    weight = 1.0 / np.maximum(parts.sigma_s[known], 1e-7) ** 2
    middle = np.average(time_s, weights=weight)
    away = time_s - middle
    information = float(np.sum(weight * away**2))
    slope = float(np.sum(weight * away * delay_s)) / information
    rest = delay_s - np.average(delay_s, weights=weight) - slope * away
    scatter = math.sqrt(max(1.0, float(np.sum(weight * rest**2)) / max(len(rest) - 2, 1)))
    span_s = float(np.ptp(time_s))
    return Drift(1e6 * slope, 1e6 * scatter / math.sqrt(information), span_s)


def undrifted(spectra: CrossSpectra, drift_ppm: float, at_s: float) -> CrossSpectra:
    """Return spectra with each part's delay moved back to what it was at ``at_s``, when the clocks were compared."""
    moved_s = 1e-6 * drift_ppm * (spectra.part_s - at_s)
    turn = np.exp(2j * np.pi * np.outer(moved_s, spectra.frequency_hz))
    return replace(spectra, ab=spectra.ab * turn)


def search_drift(spectra: CrossSpectra, weight: FloatArray, longest_s: float, most_ppm: float = 120.0) -> float:
    """Return the drift (ppm) at which the parts agree best: the highest peak relative to chance over a grid.

    The grid is as fine as the recording's length and the highest frequency used ask for; 0 wins a draw.
    """
    used = weight > 0.1 * weight.max()
    highest_hz = float(spectra.frequency_hz[used][-1]) if used.any() else 0.0
    span_s = float(np.ptp(spectra.part_s))
    if highest_hz <= 0.0 or span_s <= 0.0 or len(spectra.part_s) < _LEAST_PARTS:
        return 0.0
    step_ppm = max(0.25e6 / (highest_hz * span_s), most_ppm / 60.0)
    count = int(most_ppm / step_ppm)
    best, best_ppm = 0.0, 0.0
    middle_s = float(np.mean(spectra.part_s))
    for number in sorted(range(-count, count + 1), key=abs):
        ppm = number * step_ppm
        gram = correlate(spectra, undrifted(spectra, ppm, middle_s).s_ab, weight, longest_s)
        top = peaks(gram, 1)
        height = abs(top[0].height) if top else 0.0
        if height > best * (1.02 if number else 1.0):
            best, best_ppm = height, ppm
    return best_ppm
