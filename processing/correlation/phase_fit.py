"""The delay as the slope of the cross-spectrum's phase, with its confidence interval, dispersion and all.

Piersol, IEEE Trans. ASSP 29 (1981) 471: the phase of a cross-spectrum has variance ``(1 − γ²)/(2nγ²)``, and a weighted
straight line through it is as good an estimate of the delay as any. Uchendu, Muggleton and White, Applied Acoustics 235
(2025) 110695, leave out the stretches in which the phase is distorted; here narrow bands whose phase lies off the line
lose their weight step by step, and what scatters more than chance allows widens the interval.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from processing.correlation.correlogram import Dispersion, Peak
from processing.correlation.spectra import OVERLAP_COST, ComplexArray, CrossSpectra, coherence_bound
from processing.survey import BoolArray, FloatArray

_BANDS = 48
_LEAST_LINES = 6
_LEAST_BANDS = 4
_ROUNDS = 12
_OUTLIER = 4.685  # Tukey's biweight: 95 % efficient where there are no outliers
_SLOPES = 41
_SHIFTS = 161
_TELLING = 5.0
_LEAST_DELAY_S = 2e-4


@dataclass(frozen=True)
class PhaseLine:
    """The fit: delay ± ``sigma_s``, and the bands (j,) it was made of, for the picture.

    ``phase_rad`` is what is left beside the line; ``weight`` 0 where a band was left out. ``scatter`` is the spread of
    the phases over what chance gives: about 1 where the model holds. ``dispersion`` tells β with ``slope_sigma``.
    """

    delay_s: float
    sigma_s: float
    polarity: int
    dispersion: Dispersion
    slope_sigma: float
    frequency_hz: FloatArray
    phase_rad: FloatArray
    phase_sigma_rad: FloatArray
    weight: FloatArray
    coherence: FloatArray
    scatter: float

    @property
    def interval_s(self) -> tuple[float, float]:
        """The 95 % confidence interval of the delay (Student's t)."""
        freedom = max(float(np.count_nonzero(self.weight > 0.05)) - 2.0, 1.0)
        reach = float(stats.t.ppf(0.975, freedom)) * self.sigma_s
        return self.delay_s - reach, self.delay_s + reach


@dataclass(frozen=True)
class DispersionChoice:
    """What is assumed of the speed's growth with frequency: β = ``slope`` ± ``sigma``; sigma 0 fixes it."""

    slope: float = 0.0
    sigma: float = 0.0
    reference_hz: float | None = None  # where the sections' speeds hold; None: the middle of the band


@dataclass(frozen=True)
class _Bands:
    """Sums over narrow bands (j,) of the whitened cross-spectrum, turned back by the peak's delay."""

    frequency_hz: FloatArray
    value: ComplexArray
    coherence: FloatArray
    sigma_rad: FloatArray


def fit_phase(
    spectra: CrossSpectra, cross: ComplexArray, gain: FloatArray, peak: Peak, choice: DispersionChoice
) -> PhaseLine | None:
    """Fit the phase of ``cross`` (k,) where ``gain`` (k,) > 0.5, about a peak; None where too few bands say much."""
    bands = _narrow_bands(spectra, cross, gain, peak.delay_s)
    if bands is None:
        return None
    information = 1.0 / bands.sigma_rad**2
    middle_hz = float(np.exp(np.sum(information * np.log(bands.frequency_hz)) / np.sum(information)))
    reference_hz = choice.reference_hz or middle_hz
    start = _search(bands, peak, choice, reference_hz)
    return _refined(bands, peak, choice, reference_hz, start)


def _narrow_bands(spectra: CrossSpectra, cross: ComplexArray, gain: FloatArray, delay_s: float) -> _Bands | None:
    inside: BoolArray = gain > 0.5
    chosen = np.flatnonzero(inside)
    if chosen.size < _LEAST_LINES * _LEAST_BANDS:
        return None
    width = max(_LEAST_LINES, math.ceil((chosen[-1] - chosen[0] + 1) / _BANDS))
    number = (chosen - chosen[0]) // width
    size = np.bincount(number)
    amplitude = np.sqrt(np.maximum(spectra.smooth_aa * spectra.smooth_bb, 1e-300))[chosen]
    frequency = spectra.frequency_hz[chosen]
    white = cross[chosen] / amplitude * np.exp(2j * np.pi * frequency * delay_s)
    full = size >= max(2, width // 2)
    count = np.maximum(size, 1)
    value = (np.bincount(number, white.real) + 1j * np.bincount(number, white.imag)) / count
    middle = np.bincount(number, frequency) / count
    independent = np.maximum(spectra.total * count / OVERLAP_COST, 1.0)
    raw = np.minimum(np.abs(value) ** 2, 0.9999)
    coherence = (independent * raw - 1.0) / np.maximum(independent - 1.0, 1.0)
    bound = np.array([coherence_bound(float(n)) for n in independent])
    good = full & (raw > bound) & (coherence > 0.0)
    if np.count_nonzero(good) < _LEAST_BANDS:
        return None
    coherence = np.clip(coherence[good], 1e-6, 0.9999)
    sigma = np.sqrt((1.0 - coherence) / (2.0 * independent[good] * coherence))
    return _Bands(middle[good], value[good], coherence, sigma)


def _basis(frequency_hz: FloatArray, reference_hz: float) -> FloatArray:
    """Return (j, 2): how the phase turns with the delay, and with delay times β."""
    turn = -2.0 * np.pi * frequency_hz
    return np.column_stack([turn, -turn * np.log(frequency_hz / reference_hz)])


def _search(bands: _Bands, peak: Peak, choice: DispersionChoice, reference_hz: float) -> tuple[float, float, int]:
    """Return delay beyond the peak's, β·delay, and polarity, at which the bands agree best on a coarse grid."""
    basis = _basis(bands.frequency_hz, reference_hz)
    strength = np.sqrt(bands.coherence) / bands.sigma_rad
    unit = np.exp(1j * np.angle(bands.value)) * strength
    span_hz = max(float(np.ptp(bands.frequency_hz)), 1.0)
    reach_s = max(peak.half_width_s, 1.0 / span_hz)
    away = np.linspace(-3.0, 3.0, _SLOPES) if choice.sigma > 0.0 else np.zeros(1)
    best = (-math.inf, 0.0, choice.slope * peak.delay_s, peak.polarity)
    for slope in (choice.slope + choice.sigma * away).tolist():
        bent = slope * peak.delay_s
        # an uncompensated peak lies at the group delay, from which the delay at the reference frequency is β·t away
        shift = np.linspace(min(0.0, bent) - reach_s, max(0.0, bent) + reach_s, _SHIFTS)
        model = np.exp(-1j * (np.outer(shift, basis[:, 0]) + bent * basis[:, 1]))
        together = np.real(model @ unit)
        penalty = 0.5 * ((slope - choice.slope) / choice.sigma) ** 2 if choice.sigma > 0.0 else 0.0
        for polarity in (1, -1):
            score = polarity * together - penalty
            at = int(np.argmax(score))
            # an upside-down sensor must be clearly the better explanation than a shifted peak
            value = float(score[at]) * (1.0 if polarity == peak.polarity else 0.97)
            if value > best[0]:
                best = (value, float(shift[at]), bent, polarity)
    return best[1], best[2], best[3]


def _refined(
    bands: _Bands, peak: Peak, choice: DispersionChoice, reference_hz: float, start: tuple[float, float, int]
) -> PhaseLine | None:
    basis = _basis(bands.frequency_hz, reference_hz)
    shift, bent, polarity = start
    information = 1.0 / bands.sigma_rad**2
    trust = np.ones(len(information))
    covariance: FloatArray = np.zeros((2, 2))
    scatter = 1.0
    for _ in range(_ROUNDS):
        residual = np.angle(bands.value * polarity * np.exp(-1j * (basis @ np.array([shift, bent]))))
        scatter = _spread(residual / bands.sigma_rad)
        trust = _tukey(residual / (bands.sigma_rad * scatter))
        if np.count_nonzero(trust > 0.05) < _LEAST_BANDS:
            return None
        weight = trust * information / scatter**2
        prior_sigma = max(choice.sigma * max(abs(peak.delay_s + shift), 1e-4), 1e-9)
        prior = np.diag([0.0, 1.0 / prior_sigma**2])
        wanted = choice.slope * (peak.delay_s + shift)
        normal = basis.T @ (weight[:, None] * basis) + prior
        covariance = np.asarray(np.linalg.inv(normal), np.float64)
        step = covariance @ (basis.T @ (weight * residual) + np.array([0.0, (wanted - bent) / prior_sigma**2]))
        shift, bent = shift + float(step[0]), bent + float(step[1])
        if abs(step[0]) < 1e-9:
            break
    delay_s = peak.delay_s + shift
    sigma_s = math.sqrt(covariance[0, 0])
    slope, slope_sigma = choice.slope, max(choice.sigma, 1e-9)
    if abs(delay_s) > max(_TELLING * sigma_s, _LEAST_DELAY_S):  # sound that came equally far both ways tells nothing
        slope, slope_sigma = bent / delay_s, math.sqrt(covariance[1, 1]) / abs(delay_s)
    residual = np.angle(bands.value * polarity * np.exp(-1j * (basis @ np.array([shift, bent]))))
    return PhaseLine(
        delay_s=delay_s,
        sigma_s=sigma_s,
        polarity=polarity,
        dispersion=Dispersion(slope, reference_hz),
        slope_sigma=slope_sigma,
        frequency_hz=bands.frequency_hz,
        phase_rad=residual,
        phase_sigma_rad=bands.sigma_rad,
        weight=trust,
        coherence=bands.coherence,
        scatter=scatter,
    )


def _spread(standardised: FloatArray) -> float:
    """Return the robust spread of residuals in sigmas, never below what chance gives."""
    return max(1.0, 1.4826 * float(np.median(np.abs(standardised))))


def _tukey(standardised: FloatArray) -> FloatArray:
    part = np.clip(1.0 - (standardised / _OUTLIER) ** 2, 0.0, 1.0)
    return np.asarray(part**2)
