"""From weighted cross-spectrum to correlation over delay, its peaks with their significance, and taking peaks out.

Dispersion: where the speed grows with frequency, ``1/c(f) = (1/c₀)·(1 − β·ln(f/f₀))``, a delay t turns the phase by
``−2πg·t`` with the effective frequency ``g = f·(1 − β·ln(f/f₀))``; correlating over g instead of f brings the smeared
peak back together, at the delay that belongs to c₀.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft, signal

from processing.correlation.spectra import OVERLAP_COST, ComplexArray, CrossSpectra
from processing.survey import FloatArray

_FINE = 16.0  # grid points of the correlation per period of its highest frequency
_MOST_POINTS = 2_000_000
_PADDING = 4
_GONE = 0.06  # of its height: what is left of a peak then no longer leads the list
_WIDEST = 12.0


@dataclass(frozen=True)
class Dispersion:
    """Speed against frequency: ``slope`` is β, the part by which the speed grows per e-fold of frequency."""

    slope: float = 0.0
    reference_hz: float = 100.0

    def effective_hz(self, frequency_hz: FloatArray) -> FloatArray:
        """Return g (k,), the frequency that would turn the phase as much without dispersion."""
        if self.slope == 0.0:
            return frequency_hz
        ratio = np.maximum(frequency_hz, 1e-6) / self.reference_hz
        return np.asarray(frequency_hz * (1.0 - self.slope * np.log(ratio)))


NO_DISPERSION = Dispersion()


@dataclass(frozen=True)
class Suppressed:
    """A peak that is taken out: all within ``half_width_s`` of a delay; ``name`` says what the operator knows of it."""

    delay_s: float
    half_width_s: float
    name: str = ""


@dataclass(frozen=True)
class Correlogram:
    """Correlation against delay: ``value`` (n,) in −1..1, its ``envelope`` (n,), and what chance gives (1 sigma)."""

    delay_s: FloatArray
    value: FloatArray
    envelope: FloatArray
    chance: float

    @property
    def step_s(self) -> float:
        """From point to point."""
        return float(self.delay_s[1] - self.delay_s[0])

    def at(self, delay_s: float) -> float:
        """Return the correlation at a delay, between the points too."""
        return float(np.interp(delay_s, self.delay_s, self.value))


@dataclass(frozen=True)
class Peak:
    """A place where the recordings agree; ``polarity`` −1 where one is upside down.

    ``probability`` is that of chance giving as high a peak anywhere within the delays that were looked at.
    """

    delay_s: float
    height: float
    polarity: int
    sigmas: float
    probability: float
    half_width_s: float  # of the envelope, to half its height


def correlate(
    spectra: CrossSpectra,
    cross: ComplexArray,
    weight: FloatArray,
    longest_s: float,
    dispersion: Dispersion = NO_DISPERSION,
    *,
    classical: bool = False,
) -> Correlogram:
    """Return the correlation of ``cross`` (k,) times ``weight`` (k,) for delays up to ±``longest_s``.

    1 is what one undisturbed sound in both recordings gives. ``classical`` divides by the whole powers instead, as the
    normalised correlation of two band-passed signals has it.
    """
    product = cross * weight
    effective = dispersion.effective_hz(spectra.frequency_hz)
    if dispersion.slope != 0.0:
        top = min(len(product), 2 * (int(np.max(np.flatnonzero(weight), initial=0)) + 2))  # beyond it there is nothing
        product = _on_even_frequencies(product[:top], effective[:top], spectra.frequency_hz[:top])
    delay_s, value = _fine_transform(product, spectra, weight, longest_s)
    amplitude = np.sqrt(spectra.s_aa * spectra.s_bb)
    whole = (
        math.sqrt(float(np.sum(weight * spectra.s_aa)) * float(np.sum(weight * spectra.s_bb)))
        if classical
        else float(np.sum(weight * amplitude))
    )
    scale = 1.0 / whole if whole > 0.0 else 0.0
    analytic = value * scale
    spread = float(np.sqrt(np.sum((weight * amplitude) ** 2))) * scale
    # each line's real part has variance S_aa·S_bb/(2n); overlapping windows make neighbours alike
    chance = spread * math.sqrt(0.5 * OVERLAP_COST / max(spectra.total, 1.0))
    return Correlogram(delay_s, analytic.real, np.abs(analytic), chance)


def judged(peak: Peak, correlogram: Correlogram) -> Peak:
    """Return a peak with the significance that another correlogram gives it at its place, if that is less.

    Weights made of the coherence of these very recordings favour lines in which chance was high: of 40 unrelated pairs
    six had a peak of p < 0.01 by maximum likelihood, none by SCOT, whose weights know nothing of the common sound.
    """
    near = np.abs(correlogram.delay_s - peak.delay_s) <= max(peak.half_width_s, correlogram.step_s)
    height = float(np.abs(correlogram.value[near]).max(initial=0.0))
    sigmas = height / correlogram.chance if correlogram.chance > 0.0 else 0.0
    probability = -math.expm1(-_zero_crossings(correlogram) * math.exp(-0.5 * sigmas**2))
    if probability <= peak.probability:
        return peak
    return replace(peak, sigmas=sigmas, probability=probability)


def _fine_transform(
    product: ComplexArray, spectra: CrossSpectra, weight: FloatArray, longest_s: float
) -> tuple[FloatArray, ComplexArray]:
    """Return delays and the analytic correlation, finely enough that a parabola meets the peaks."""
    used = np.flatnonzero(weight > 1e-6 * max(float(weight.max()), 1e-300))
    top = int(used[-1]) + 1 if used.size else len(product)
    count = max(2 * len(product), math.ceil(_FINE * top))
    length = fft.next_fast_len(min(count, _MOST_POINTS))
    spectrum = np.zeros(length, np.complex128)
    spectrum[: min(len(product), length)] = product[:length]
    circular = fft.ifft(spectrum) * length
    step_s = spectra.grid.segment_s / length
    reach = min(int(longest_s / step_s) + 2, length // 2 - 1)
    lags = np.arange(-reach, reach + 1)
    return np.asarray(lags * step_s, np.float64), circular[lags % length]


def _on_even_frequencies(product: ComplexArray, effective_hz: FloatArray, frequency_hz: FloatArray) -> ComplexArray:
    """Return a spectrum, known at ``effective_hz``, at even frequencies; made finer first so that lines join."""
    count = len(product)
    lags = fft.ifft(product, 2 * count)
    padded = np.zeros(2 * count * _PADDING, np.complex128)
    padded[:count], padded[-count:] = lags[:count], lags[count:]
    fine = fft.fft(padded)[: count * _PADDING]
    places = np.interp(frequency_hz, effective_hz, frequency_hz, left=0.0, right=0.0)  # f that belongs to even g
    step_hz = float(frequency_hz[1] - frequency_hz[0])
    at = places / (step_hz / _PADDING)
    grid = np.arange(count * _PADDING)
    return np.asarray(np.interp(at, grid, fine.real) + 1j * np.interp(at, grid, fine.imag))


def peaks(correlogram: Correlogram, most: int = 6) -> tuple[Peak, ...]:
    """Return the highest peaks of the envelope, highest first, each where the correlation itself is extreme.

    Peaks nearer than their own width count once.
    """
    envelope = correlogram.envelope
    if envelope.size < 5 or not envelope.max() > 0.0:
        return ()
    tops, _ = signal.find_peaks(envelope)
    tops = tops[np.argsort(envelope[tops])[::-1]]
    found: list[Peak] = []
    crossings = _zero_crossings(correlogram)
    for top in tops[:200].tolist():
        half = _half_width(envelope, top)
        peak = _sharpened(correlogram, top, half, crossings)
        if all(abs(peak.delay_s - other.delay_s) > max(peak.half_width_s, other.half_width_s) for other in found):
            found.append(peak)
        if len(found) == most:
            break
    return tuple(found)


def _half_width(envelope: FloatArray, top: int) -> int:
    """Return how many points a peak needs to fall to half its height, on its narrower side."""
    level = 0.5 * envelope[top]
    right = int(np.argmax(envelope[top:] < level)) or envelope.size - top
    left = int(np.argmax(envelope[: top + 1][::-1] < level)) or top + 1
    return max(1, min(left, right))


def _sharpened(correlogram: Correlogram, top: int, half: int, crossings: float) -> Peak:
    first, last = max(0, top - half), min(len(correlogram.value), top + half + 1)
    window = np.abs(correlogram.value[first:last])
    at = first + int(np.argmax(window))
    at = min(max(at, 1), len(correlogram.value) - 2)
    polarity = 1 if correlogram.value[at] >= 0.0 else -1
    left, middle, right = (polarity * correlogram.value[at - 1 : at + 2]).tolist()
    curve = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / curve if curve < 0.0 else 0.0
    shift = min(max(shift, -1.0), 1.0)
    height = middle - 0.25 * (left - right) * shift
    sigmas = height / correlogram.chance if correlogram.chance > 0.0 else 0.0
    # Rice: so often does a Gaussian process with so many zero crossings go beyond a level, on either side
    probability = -math.expm1(-crossings * math.exp(-0.5 * sigmas**2))
    delay_s = float(correlogram.delay_s[at]) + shift * correlogram.step_s
    return Peak(delay_s, polarity * height, polarity, sigmas, probability, half * correlogram.step_s)


def _zero_crossings(correlogram: Correlogram) -> float:
    """Return how often the correlation changes its sign."""
    signs = np.signbit(correlogram.value)
    return max(1.0, float(np.count_nonzero(signs[1:] != signs[:-1])))


def suppression(correlogram: Correlogram, peak: Peak, name: str = "") -> Suppressed:
    """Return how wide a peak must be taken out: to where its flanks fall into chance, or another peak begins."""
    envelope = correlogram.envelope
    at = int(np.argmin(np.abs(correlogram.delay_s - peak.delay_s)))
    low = max(3.0 * correlogram.chance, _GONE * abs(peak.height))
    most = max(1, round(_WIDEST * peak.half_width_s / correlogram.step_s))
    reach = max(_flank(envelope[at : at + most], low), _flank(envelope[: at + 1][::-1][:most], low))
    half_s = max(reach * correlogram.step_s, 1.5 * peak.half_width_s)
    return Suppressed(peak.delay_s, half_s, name)


def _flank(envelope: FloatArray, low: float) -> int:
    """Return after how many points a flank is below ``low``, or rises again clearly above its own lowest."""
    lowest = np.minimum.accumulate(envelope)
    ended = (envelope < low) | (envelope > 2.0 * lowest)
    first = int(np.argmax(ended)) if ended.any() else len(envelope)
    return int(np.argmin(envelope[: first + 1]))


def without(spectra: CrossSpectra, suppressed: Sequence[Suppressed]) -> ComplexArray:
    """Return the cross-spectrum (k,) without what lies within the given delays.

    The recordings are whitened first, so that a source lies close about its delay, whatever its spectrum; then that
    stretch of delays is taken out with soft edges.
    """
    if not suppressed:
        return spectra.s_ab
    amplitude = np.sqrt(np.maximum(spectra.smooth_aa * spectra.smooth_bb, 1e-300))
    count = len(amplitude)
    length = 2 * count
    lags = fft.ifft(spectra.s_ab / amplitude, length)
    step_s = spectra.grid.segment_s / length
    index = np.arange(length)
    delay_s = np.where(index < count, index, index - length) * step_s
    keep = np.ones(length)
    for peak in suppressed:
        half_s = max(peak.half_width_s, 2.0 * step_s)
        away = np.clip((np.abs(delay_s - peak.delay_s) / half_s - 1.0) / 0.5, 0.0, 1.0)
        keep *= 0.5 - 0.5 * np.cos(np.pi * away)
    return np.asarray(fft.fft(lags * keep)[:count] * amplitude)
