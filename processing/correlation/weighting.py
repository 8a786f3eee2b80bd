"""How much each frequency says about the delay: the classical weightings, the band and its soft edges, and hum.

Generalised cross-correlation after Knapp and Carter, IEEE Trans. ASSP 24 (1976) 320.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy import ndimage

from processing.correlation.spectra import CrossSpectra, smoothed
from processing.survey import BoolArray, FloatArray


class Weighting(StrEnum):
    """What the cross-spectrum is divided by before it becomes a correlation."""

    NONE = "none"
    ROTH = "roth"
    SCOT = "scot"
    PHAT = "phat"
    MAXIMUM_LIKELIHOOD = "maximum_likelihood"


@dataclass(frozen=True)
class Band:
    """The frequencies that are used; ``without_hum`` leaves out narrow lines: mains hum, pumps."""

    low_hz: float
    high_hz: float
    without_hum: bool = True


_EDGE_OCTAVES = 1.0 / 6.0
_LINE_FACTOR = 6.0
_FLOOR_OF_BOUND = 0.1  # a weak broadband leak shows in no single line: no line gets nothing
_TINY = 1e-300
_LEAST_HZ = 1.0


def band_gain(frequency_hz: FloatArray, band: Band) -> FloatArray:
    """Return 1 inside the band, 0 outside (k,), with raised-cosine edges of a sixth of an octave and no phase."""
    octave = np.log2(np.maximum(frequency_hz, 1e-6))
    low, high = np.log2(max(band.low_hz, 1e-6)), np.log2(max(band.high_hz, 1e-6))
    inside = np.clip(np.minimum(octave - low, high - octave) / _EDGE_OCTAVES + 0.5, 0.0, 1.0)
    gain = 0.5 - 0.5 * np.cos(np.pi * inside)
    gain[frequency_hz < _LEAST_HZ] = 0.0
    return np.asarray(gain)


def hum_lines(spectra: CrossSpectra) -> BoolArray:
    """Return which lines (k,) belong to tones: far above the running median of either recording, and narrow."""
    window = 2 * round(0.5 * 20.0 / spectra.step_hz) + 1
    found = np.zeros(len(spectra.frequency_hz), bool)
    for power in (spectra.s_aa, spectra.s_bb):
        ground = ndimage.median_filter(power, size=min(window, len(power)), mode="nearest")
        found |= power > _LINE_FACTOR * np.maximum(ground, _TINY)
    # a tone fills the window's main lobe, two lines either side; what is wider is no tone but a resonance or a source
    labels, count = ndimage.label(found)
    if count:
        widths = ndimage.sum_labels(found, labels, np.arange(1, count + 1))
        wide = np.flatnonzero(np.asarray(widths) * spectra.step_hz > max(8.0, 7.0 * spectra.step_hz)) + 1
        found &= ~np.isin(labels, wide)
    return np.asarray(ndimage.binary_dilation(found, iterations=1))


def weights(spectra: CrossSpectra, weighting: Weighting, band: Band) -> FloatArray:
    """Return the factor of each line of the cross-spectrum (k,), >= 0: band, hum and weighting together."""
    gain = band_gain(spectra.frequency_hz, band)
    if band.without_hum:
        gain = np.where(hum_lines(spectra), 0.0, gain)
    aa, bb = np.maximum(spectra.smooth_aa, _TINY), np.maximum(spectra.smooth_bb, _TINY)
    if weighting is Weighting.NONE:
        return gain
    if weighting is Weighting.ROTH:
        return np.asarray(gain / aa)
    if weighting is Weighting.SCOT:
        return np.asarray(gain / np.sqrt(aa * bb))
    if weighting is Weighting.PHAT:
        return np.asarray(gain / np.maximum(np.abs(spectra.s_ab), _TINY))
    # Hannan and Thomson: γ²/(1−γ²)/|S_ab| with the smoothed coherence, and |S_ab| = γ √(S_aa S_bb) of the smoothed
    # densities, so that each line's own magnitude, which says how much it is to be trusted, is not divided out
    coherence = np.clip(spectra.true_coherence, _FLOOR_OF_BOUND * spectra.bound, 0.98)
    return np.asarray(gain * np.sqrt(coherence / (aa * bb)) / (1.0 - coherence))


def auto_band(spectra: CrossSpectra, within: Band | None = None) -> Band | None:
    """Return the band in which the coherence stands out from chance; None where it nowhere does.

    Of all stretches of frequency the one is taken whose summed γ²/(1−γ²), less what chance gives, is largest: small
    holes are bridged, far-off single lines are not.
    """
    frequency = spectra.frequency_hz
    usable = (frequency >= 5.0) & (frequency <= frequency[-1] * 0.95)
    if within is not None:
        usable &= (frequency >= within.low_hz) & (frequency <= within.high_hz)
    coherence = np.clip(spectra.true_coherence, 0.0, 0.98)
    hum = hum_lines(spectra)
    usable &= ~hum
    excess = np.where(usable, coherence / (1.0 - coherence) - spectra.bound, -spectra.bound)
    excess = np.minimum(excess, 20.0 * max(spectra.bound, float(np.percentile(coherence, 90))))
    low, high = _best_run(smoothed(excess, spectra.smoothing_bins))
    if high <= low or not np.any(coherence[low:high] > spectra.bound):
        return None
    low_hz, high_hz = float(frequency[low]), float(frequency[high - 1])
    if high_hz - low_hz < 2.0 * spectra.smoothing_bins * spectra.step_hz and high_hz < 1.15 * low_hz:
        return None
    reached = frequency[usable]
    return Band(max(low_hz, float(reached[0])), min(high_hz, float(reached[-1])))


def _best_run(values: FloatArray) -> tuple[int, int]:
    """Return begin and end of the stretch with the largest sum (Kadane)."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    lowest = np.minimum.accumulate(sums)
    end = int(np.argmax(sums - lowest))
    begin = int(np.argmin(sums[: end + 1]))
    return begin, end
