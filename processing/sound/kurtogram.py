"""Spectral kurtosis and the fast kurtogram: in which band a stretch of sound comes in bursts rather than steadily.

J. Antoni, "The spectral kurtosis", MSSP 20 (2006) 282: ``K(f) = <|X|⁴>/<|X|²>² − 2`` is 0 for steady Gaussian noise,
−1 for a tone, and large for bursts. J. Antoni, "Fast computation of the kurtogram", MSSP 21 (2007) 108: the same over
a tree of bands that are halved and cut in three. A leak that hisses steadily has a kurtosis of 0: the kurtogram names
the band of bumps, air and stick-slip, and of a leak only while it is being passed.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft

from processing.sound.band_choice import BandChoice, best_of
from processing.survey import FloatArray

_BLOCK = 1 << 20  # samples a block: sums of moments need no more of a long stretch at once
_FEWEST = 16  # values of a band's envelope; fewer tell no kurtosis
_EDGE = 0.1  # of a band's width: its filter's flanks
_STANDS_OUT_SIGMAS = 4.0


@dataclass(frozen=True)
class SpectralKurtosis:
    """Kurtosis (k,) at ``frequency_hz`` (k,); ``sigma`` is that of steady Gaussian noise of this length."""

    frequency_hz: FloatArray
    value: FloatArray
    sigma: float


@dataclass(frozen=True)
class Kurtogram:
    """The kurtosis of every band of the tree: rows (n,) with edges ``bands_hz`` (n, 2), ``level`` and 1 ``sigma``.

    ``level`` is log2 of how often the bandwidth goes into half the sample rate: 0, 1, 1.585, 2, 2.585 …
    """

    bands_hz: FloatArray
    level: FloatArray
    value: FloatArray
    sigma: FloatArray


def spectral_kurtosis(samples: npt.NDArray[np.floating], sample_rate_hz: float, window: int = 1024) -> SpectralKurtosis:
    """Return the kurtosis over the short spectra of ``samples`` (n,), Hann windows of which each overlaps half.

    Raises:
        ValueError: fewer than sixteen windows fit in.
    """
    hop = window // 2
    count = (len(samples) - window) // hop + 1
    if count < _FEWEST:
        raise ValueError("too short for a kurtosis")
    shape = (0.5 - 0.5 * np.cos(2 * np.pi * np.arange(window) / window)).astype(np.float32)
    second, fourth = np.zeros(window // 2 + 1), np.zeros(window // 2 + 1)
    view = np.lib.stride_tricks.sliding_window_view(np.asarray(samples, np.float32), window)[::hop]
    for first in range(0, count, 256):
        power = np.square(np.abs(fft.rfft(view[first : first + 256] * shape, axis=1))).astype(np.float64)
        second += power.sum(axis=0)
        fourth += np.square(power).sum(axis=0)
    value = _kurtosis(second / count, fourth / count)
    inside = slice(1, -1)  # 0 Hz and half the rate are real: another distribution
    frequency = np.arange(window // 2 + 1) * sample_rate_hz / window
    # half-overlapping Hann windows' powers correlate by 1/36: hardly less than independent
    return SpectralKurtosis(frequency[inside], value[inside], 2.0 / float(np.sqrt(count / (1.0 + 2.0 / 36.0))))


def fast_kurtogram(samples: npt.NDArray[np.floating], sample_rate_hz: float, levels: int = 7) -> Kurtogram:
    """Return the kurtosis of the complex envelope in each band of the 1/3-binary tree of ``samples`` (n,).

    The filters act on the block's transform: a band is cut out with soft flanks and transformed back at its own low
    rate, so a level costs one pass. Bands too narrow for their number of values are left out.

    Raises:
        ValueError: the stretch is too short for even the widest band.
    """
    data = np.asarray(samples, np.float64)
    splits = _splits(levels)
    while len(splits) > 1 and len(data) // (2 * splits[-1]) < 2 * _FEWEST:
        splits = splits[:-1]
    if len(data) < 4 * _FEWEST:
        raise ValueError("too short for a kurtosis")
    second = {s: np.zeros(s) for s in splits}
    fourth = {s: np.zeros(s) for s in splits}
    count = dict.fromkeys(splits, 0)
    for block in _blocks(data, splits):
        spectrum = fft.rfft(block)[:-1]
        for s in splits:
            envelope = _cut(spectrum, s)
            power = np.square(np.abs(envelope))
            second[s] += power.sum(axis=1)
            fourth[s] += np.square(power).sum(axis=1)
            count[s] += power.shape[1]
    half = 0.5 * sample_rate_hz
    edges = [half / s * np.arange(s + 1) for s in splits]
    return Kurtogram(
        bands_hz=np.vstack([np.column_stack([e[:-1], e[1:]]) for e in edges]),
        level=np.concatenate([np.full(s, np.log2(s)) for s in splits]),
        value=np.concatenate([_kurtosis(second[s] / count[s], fourth[s] / count[s]) for s in splits]),
        sigma=np.concatenate([np.full(s, 2.0 / np.sqrt(count[s])) for s in splits]),
    )


def kurtosis_band(stretch: Kurtogram, background: Kurtogram | None = None) -> BandChoice | None:
    """Return the band in which the stretch's kurtosis stands out most of the background's, or of steady noise.

    None where no band stands out by four sigma: steady sound has no such band, however loud it is.
    """
    other, other_sigma = np.zeros(len(stretch.value)), np.zeros(len(stretch.value))
    if background is not None:
        known = {tuple(band): k for k, band in enumerate(background.bands_hz)}
        rows = np.array([known.get(tuple(band), -1) for band in stretch.bands_hz])
        other = np.where(rows >= 0, np.maximum(background.value[rows], 0.0), 0.0)
        # a kurtosis that is there is itself known to some part only
        other_sigma = np.where(rows >= 0, background.sigma[rows] * (1.0 + other), 0.0)
    sigma = np.hypot(stretch.sigma, other_sigma)
    return best_of(stretch.bands_hz, stretch.value - other, sigma, _STANDS_OUT_SIGMAS)


def kurtosis_of_levels(power: FloatArray, values_a_row: FloatArray) -> FloatArray:
    """Return the kurtosis (b,) of bands' complex envelopes from mean powers (n, b) alone; NaN rows are passed over.

    A row is the mean of ``values_a_row`` (n, b) or (b,) independent values (bandwidth times duration). For noise of
    power ``a²``, steady within a row, ``<E²>/<E>² = <a⁴>/<a²>²·(1 + 1/N)``, and the envelope's kurtosis is
    ``2<a⁴>/<a²>² − 2`` (Antoni 2006, eq. 31).
    """
    mean = np.nanmean(power, axis=0)
    square = np.nanmean(np.square(power) / (1.0 + 1.0 / np.maximum(values_a_row, 1.0)), axis=0)
    ratio = np.divide(square, np.square(mean), out=np.ones(power.shape[1]), where=mean > 0)
    return np.asarray(2.0 * ratio - 2.0, np.float64)


def _kurtosis(second: FloatArray, fourth: FloatArray) -> FloatArray:
    ratio = np.divide(fourth, np.square(second), out=np.full(len(second), 2.0), where=second > 0)
    return np.asarray(ratio - 2.0, np.float64)


def _splits(levels: int) -> list[int]:
    """Return into how many bands each level cuts: 1, 2, 3, 4, 6, 8, 12 …"""
    halves = [1 << k for k in range(levels + 1)]
    thirds = [3 << k for k in range(levels - 1)]
    return sorted([*halves, *thirds])


def _blocks(data: FloatArray, splits: list[int]) -> Iterator[FloatArray]:
    """Yield blocks whose spectra every split divides; what is left over at the end is too short to matter."""
    step = 2 * int(np.lcm.reduce(splits))
    size = max(step, _BLOCK // step * step)
    whole = len(data) // step * step
    for start in range(0, whole, size):
        yield data[start : min(start + size, whole)]


def _cut(spectrum: npt.NDArray[np.complexfloating], bands: int) -> npt.NDArray[np.complexfloating]:
    """Return the complex envelopes (bands, m) of even bands of a one-sided spectrum (bands · m,)."""
    parts = spectrum.reshape(bands, -1)
    width = parts.shape[1]
    flank = int(_EDGE * width)
    if flank:
        rise = 0.5 - 0.5 * np.cos(np.pi * (np.arange(flank) + 0.5) / flank)
        parts = parts.copy()
        parts[:, :flank] *= rise
        parts[:, -flank:] *= rise[::-1]
    return np.asarray(fft.ifft(parts, axis=1))
