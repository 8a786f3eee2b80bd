"""The whole way from spectra to a place on the pipe; quick enough to follow a hand that drags a band.

:func:`processing.correlation.spectra.measure` reads the recordings once; everything here works on its result.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from processing.correlation.correlogram import (
    NO_DISPERSION,
    Correlogram,
    Dispersion,
    Peak,
    Suppressed,
    correlate,
    judged,
    peaks,
    without,
)
from processing.correlation.parts import Drift, PartDelays, delays_of_parts, drift_of, search_drift, undrifted
from processing.correlation.phase_fit import DispersionChoice, PhaseLine, fit_phase
from processing.correlation.pipe import Pipe, Position, Where, locate
from processing.correlation.reading import measure
from processing.correlation.recordings import Pair, Sync, SyncKind
from processing.correlation.resonance import Resonance, divided, find_resonances
from processing.correlation.spectra import CrossSpectra, segment_length_s
from processing.correlation.weighting import Band, Weighting, auto_band, band_gain, hum_lines, weights
from processing.progress import Progress
from processing.survey import BoolArray, Finding, FloatArray, Severity

BEYOND = 1.35  # delays are looked for somewhat beyond what the pipe allows: there chance shows itself
_SIGNIFICANT = 0.01
_MOST_DISPERSION = 0.03
_UNKNOWN_REACH_S = 0.5
_SYNC_FLOOR_S = 2e-5  # sensors, cables and converters are not alike to better than that
_CRYSTAL_PPM = 15.0  # 1 sigma of a recorder's clock that nobody compared
_CARRIES = 0.3  # e-folds of frequency over which a slope that was found still holds
_AMBIGUOUS = 2.5
_DEFAULT_BAND = Band(20.0, 2000.0)


@dataclass(frozen=True)
class Choice:
    """What the operator chose; a None band is found by the coherence, ``peak`` is a delay near the wished peak.

    ``dispersion`` with sigma > 0 lets the fit find the speed's growth with frequency.
    """

    weighting: Weighting = Weighting.MAXIMUM_LIKELIHOOD
    band: Band | None = None
    dispersion: DispersionChoice = field(default_factory=lambda: DispersionChoice(sigma=_MOST_DISPERSION))
    suppressed: tuple[Suppressed, ...] = ()
    divide_resonances: bool = False
    peak_s: float | None = None


@dataclass(frozen=True)
class Correlation:
    """All that the page and the report show; ``position`` is None where the clocks or the sound do not allow one.

    ``delay_s`` ± ``delay_sigma_s`` comes from the phase fit where there is one, else from the peak itself.
    """

    spectra: CrossSpectra
    band: Band
    band_found: bool
    gain: FloatArray  # (k,) of the band
    hum: BoolArray  # (k,)
    weight: FloatArray  # (k,)
    correlogram: Correlogram
    peaks: tuple[Peak, ...]
    chosen: Peak | None
    phase: PhaseLine | None
    parts: PartDelays | None
    drift: Drift | None
    resonances: tuple[Resonance, ...]
    delay_s: float
    delay_sigma_s: float
    position: Position | None
    findings: tuple[Finding, ...]

    @property
    def significant(self) -> bool:
        """Whether the chosen peak is more than chance."""
        return self.chosen is not None and self.chosen.probability < _SIGNIFICANT


def longest_delay_s(pipe: Pipe, sync: Sync) -> float:
    """Return up to which delay is looked: somewhat beyond the pipe's own, and what the clocks may be off."""
    reach = BEYOND * pipe.travel_s + 4.0 * sync.sigma_s
    return reach if sync.known else max(reach, _UNKNOWN_REACH_S)


@dataclass(frozen=True)
class Reading:
    """What was read: the spectra, freed of the clocks' drift where one was found (None: not looked for, or no sign)."""

    spectra: CrossSpectra
    drift: Drift | None = None


def read(pair: Pair, pipe: Pipe, progress: Progress) -> Reading:
    """Read the recordings, twice where their clocks turn out to drift too fast for one reading.

    A steady source gives a steady delay: what moves steadily is the clock. Channels of one file have one clock.

    Raises:
        LeaklineError: what :func:`measure` and :meth:`Pipe.checked` raise.
    """
    pipe.checked()
    longest_s = longest_delay_s(pipe, pair.sync)
    first, last = pair.common_span_s()
    segment_s = segment_length_s(longest_s, last - first)
    if pair.same_file or pair.sync.kind is SyncKind.ONE_CLOCK:
        return Reading(measure(pair, segment_s, progress))
    spectra = measure(pair, segment_s, progress.part(0.0, 0.5))
    band = auto_band(spectra) or _usual_band(spectra)
    weight = weights(spectra, Weighting.MAXIMUM_LIKELIHOOD, band)
    read_with_ppm, ppm = 0.0, search_drift(spectra, weight, longest_s)
    part_s = spectra.used_s / len(spectra.part_s)
    if abs(ppm) * 1e-6 * part_s * band.high_hz > 0.1:  # the delay smears within a part already
        moving = replace(pair.sync, drift_ppm=pair.sync.drift_ppm + ppm)
        spectra = measure(replace(pair, sync=moving), segment_s, progress.part(0.5, 1.0))
        read_with_ppm, ppm = ppm, 0.0
    progress.update(1.0)
    return _without_drift(spectra, weight, longest_s, (read_with_ppm, ppm), pair.sync.at_s)


def _without_drift(
    spectra: CrossSpectra, weight: FloatArray, longest_s: float, ppms: tuple[float, float], at_s: float
) -> Reading:
    """Return spectra read with the first of ``ppms``, freed of the second, and of what the parts still show."""
    read_with_ppm, ppm = ppms
    middle_s = float(np.average(spectra.part_s, weights=spectra.used))
    moved = undrifted(spectra, ppm, middle_s)
    tops = peaks(correlate(moved, moved.s_ab, weight, longest_s), 1)
    if not tops or tops[0].probability > _SIGNIFICANT:
        return Reading(spectra)
    rest = drift_of(delays_of_parts(moved, weight, tops[0], longest_s, NO_DISPERSION))
    if rest is None:
        return Reading(spectra)
    drift = Drift(read_with_ppm + ppm + rest.ppm, rest.sigma_ppm, rest.span_s)
    return Reading(undrifted(spectra, ppm + rest.ppm, at_s) if drift.significant else spectra, drift)


def analyse(reading: Reading, pipe: Pipe, sync: Sync, choice: Choice) -> Correlation:
    """Return delay and place for what was chosen.

    Raises:
        LeaklineError: CORRELATION_PIPE_… where the pipe cannot be as it was entered.
    """
    pipe.checked()
    spectra = reading.spectra
    longest_s = longest_delay_s(pipe, sync)
    longest_s = min(longest_s, 0.45 * spectra.grid.segment_s)
    found = auto_band(spectra) if choice.band is None else choice.band
    band = found or _usual_band(spectra)
    resonances = find_resonances(spectra, band) if choice.divide_resonances else ()
    cross = divided(without(spectra, choice.suppressed), spectra.frequency_hz, resonances)
    weight = weights(spectra, choice.weighting, band)
    dispersion = NO_DISPERSION
    if choice.dispersion.slope != 0.0:
        dispersion = Dispersion(choice.dispersion.slope, choice.dispersion.reference_hz or _middle_hz(band))
    classical = choice.weighting is Weighting.NONE
    gram = correlate(spectra, cross, weight, longest_s, dispersion, classical=classical)
    tops = peaks(gram)
    chosen = _chosen(tops, choice.peak_s)
    gain = band_gain(spectra.frequency_hz, band)
    hum = hum_lines(spectra)
    phase = None
    parts = None
    if chosen is not None:
        clear = gain * ~hum if band.without_hum else gain
        phase = fit_phase(spectra, cross, clear, chosen, _with_reference(choice.dispersion, dispersion))
        if phase is not None and dispersion is NO_DISPERSION and _is_bent(phase):
            # bring the smeared peak together at the delay that belongs to the speed's own frequency
            dispersion = phase.dispersion
            gram = correlate(spectra, cross, weight, longest_s, dispersion, classical=classical)
            tops = peaks(gram)
            chosen = _chosen(tops, phase.delay_s) or chosen
        parts = delays_of_parts(spectra, weight, chosen, longest_s, dispersion)
    if chosen is not None and choice.weighting is Weighting.MAXIMUM_LIKELIHOOD:
        honest = correlate(spectra, cross, weights(spectra, Weighting.SCOT, band), longest_s, dispersion)
        judged_peak = judged(chosen, honest)
        tops, chosen = tuple(judged_peak if peak is chosen else peak for peak in tops), judged_peak
    delay_s, sigma_s = _delay(chosen, phase, parts)
    significant = chosen is not None and chosen.probability < _SIGNIFICANT
    speeds_part = _speeds_part(phase, choice.dispersion) if phase is not None else 0.0
    clock_s = _clock_sigma_s(reading, sync)
    position = locate(pipe, delay_s, sigma_s, clock_s, speeds_part) if significant and sync.known else None
    result = Correlation(
        spectra, band, found is not None, gain, hum, weight, gram, tops, chosen, phase, parts, reading.drift,
        resonances, delay_s, sigma_s, position, (),
    )  # fmt: skip
    return replace(result, findings=tuple(_findings(result, pipe, sync)))


def _clock_sigma_s(reading: Reading, sync: Sync) -> float:
    """Return how far the clocks may be apart in the middle of the recording: offset, drift since, and converters."""
    if sync.kind is SyncKind.ONE_CLOCK:
        return _SYNC_FLOOR_S
    spectra, drift = reading.spectra, reading.drift
    since_s = abs(float(np.average(spectra.part_s, weights=spectra.used)) - sync.at_s)
    ppm = _CRYSTAL_PPM if sync.drift_ppm == 0.0 else 0.0  # nobody measured it, neither the operator nor the sound
    if drift is not None:
        ppm = drift.sigma_ppm if drift.significant else min(math.hypot(drift.ppm, drift.sigma_ppm), _CRYSTAL_PPM)
    return math.sqrt(sync.sigma_s**2 + _SYNC_FLOOR_S**2 + (1e-6 * ppm * since_s) ** 2)


def _speeds_part(phase: PhaseLine, bend: DispersionChoice) -> float:
    """Return how uncertain all speeds are, as a part of them, since they hold at another frequency than what was heard.

    Where nobody said at which frequency they hold, that may be an e-fold away, whether or not the slope shows. Where it
    is known but lies far outside of what was heard, the slope found there does not carry so far: whole turns of the
    phase may be missing.
    """
    if bend.reference_hz is None:
        bent = bend.sigma > 0.0 or bend.slope != 0.0
        return math.hypot(phase.dispersion.slope, min(phase.slope_sigma, bend.sigma)) if bent else 0.0
    low_hz, high_hz = float(phase.frequency_hz[0]), float(phase.frequency_hz[-1])
    away = max(math.log(low_hz / bend.reference_hz), math.log(bend.reference_hz / high_hz))
    return bend.sigma * max(0.0, away - _CARRIES)


def _usual_band(spectra: CrossSpectra) -> Band:
    top = float(spectra.frequency_hz[-1])
    return Band(min(_DEFAULT_BAND.low_hz, 0.1 * top), min(_DEFAULT_BAND.high_hz, 0.9 * top))


def _middle_hz(band: Band) -> float:
    return math.sqrt(band.low_hz * band.high_hz)


def _with_reference(choice: DispersionChoice, dispersion: Dispersion) -> DispersionChoice:
    fixed = dispersion is not NO_DISPERSION
    return replace(choice, reference_hz=dispersion.reference_hz) if fixed else choice


def _chosen(tops: Sequence[Peak], wished_s: float | None) -> Peak | None:
    if not tops:
        return None
    return tops[0] if wished_s is None else min(tops, key=lambda peak: abs(peak.delay_s - wished_s))


def _delay(chosen: Peak | None, phase: PhaseLine | None, parts: PartDelays | None) -> tuple[float, float]:
    if chosen is None:
        return math.nan, math.inf
    if phase is not None:
        low, high = phase.interval_s
        return phase.delay_s, 0.5 * (high - low) / 1.959964  # as sigma of a normal law with the same interval
    spread = parts.spread_s if parts is not None else math.nan
    count = int(parts.present.sum()) if parts is not None else 0
    by_parts = spread / math.sqrt(count) if count > 2 else math.inf
    return chosen.delay_s, by_parts if math.isfinite(by_parts) else chosen.half_width_s


# --- what the operator is told ---------------------------------------------------------------------------------------


def _findings(result: Correlation, pipe: Pipe, sync: Sync) -> list[Finding]:
    counts = result.spectra.counts
    found = []
    if counts.equal > 0.5 * counts.segments:
        found.append(Finding("correlation_same_sound", Severity.WARNING))
    for code, count in (("correlation_silent_part", counts.silent), ("correlation_clipped", counts.clipped)):
        if count:
            share = 100.0 * count / counts.segments
            found.append(Finding(code, Severity.MASKED, {"share_pct": share}))
    if not result.band_found:
        found.append(Finding("correlation_no_band", Severity.WARNING))
    if not result.significant:
        found.append(Finding("correlation_nothing", Severity.WARNING))
        return found
    found += _findings_of_clock(result, sync)
    found += _findings_of_peak(result, pipe)
    if result.position is not None:
        found += _findings_of_place(result.position)
    return found


def _findings_of_clock(result: Correlation, sync: Sync) -> list[Finding]:
    found = []
    if not sync.known:
        found.append(Finding("correlation_sync_unknown", Severity.WARNING, {"delay_ms": 1e3 * result.delay_s}))
    drift = result.drift
    if drift is not None and drift.significant:
        moved_ms = abs(drift.ppm) * 1e-3 * drift.span_s
        params: dict[str, str | float] = {"ppm": drift.ppm, "sigma_ppm": drift.sigma_ppm, "moved_ms": moved_ms}
        found.append(Finding("correlation_drift", Severity.REPAIRED, params))
    return found


def _findings_of_peak(result: Correlation, pipe: Pipe) -> list[Finding]:
    peak = result.chosen
    assert peak is not None
    found = []
    if abs(peak.delay_s) < 0.01 * pipe.travel_s and peak.sigmas > 0.0 and result.spectra.counts.equal == 0:
        found.append(Finding("correlation_delay_zero", Severity.INFO))
    if peak.polarity < 0:
        found.append(Finding("correlation_polarity", Severity.INFO))
    rivals = [p for p in result.peaks if p is not peak and abs(abs(peak.height) - abs(p.height)) < _rival(result)]
    if rivals:
        params: dict[str, str | float] = {"delay_ms": 1e3 * rivals[0].delay_s}
        found.append(Finding("correlation_rival", Severity.WARNING, params))
    phase = result.phase
    if phase is None:
        found.append(Finding("correlation_no_phase", Severity.INFO))
    elif _is_bent(phase):
        params = {"percent": 100.0 * phase.dispersion.slope * math.log(2.0), "hz": phase.dispersion.reference_hz}
        found.append(Finding("correlation_dispersion", Severity.INFO, params))
    if result.parts is not None and len(result.parts.present) >= 4 and result.parts.share < 0.7:
        count = int(result.parts.present.sum())
        params = {"count": count, "parts": len(result.parts.present)}
        found.append(Finding("correlation_intermittent", Severity.WARNING, params))
    return found


def _is_bent(phase: PhaseLine) -> bool:
    return abs(phase.dispersion.slope) > 3.0 * phase.slope_sigma > 0.0


def _rival(result: Correlation) -> float:
    return _AMBIGUOUS * math.sqrt(2.0) * result.correlogram.chance


def _findings_of_place(position: Position) -> list[Finding]:
    code = {
        Where.AT_A: "correlation_at_a",
        Where.AT_B: "correlation_at_b",
        Where.IMPOSSIBLE: "correlation_impossible",
    }.get(position.where)
    return [Finding(code, Severity.WARNING)] if code is not None else []
