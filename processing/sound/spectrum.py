"""The power spectrum of stretches of sound with its interval, streamed, and what one stretch has that another lacks.

Decibels are dBFS as everywhere: 0 dB is the power of a full-scale sine, so a density integrates to the level of a band.
Welch 1967; degrees of freedom of overlapped windows after Percival and Walden 1993, eq. 292b; median average after
Allen et al. 2012 (FINDCHIRP), appendix B. The intervals hold for sound that is steady in itself: what swells within a
stretch varies by more.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import fft, stats

from processing.errors import ErrorCode, LeaklineError
from processing.progress import Progress, silent
from processing.sound.source import AudioReader
from processing.survey import AudioSource, FloatArray

AVERAGES = ("median", "mean")
RESOLUTION_HZ = 6.0
LONGEST_S = 4 * 3600.0
_FEWEST_WINDOWS = 8
_SHORTEST_WINDOW = 128
_MOST_ROWS = 2048  # whose median is taken exactly; more windows are averaged in groups of neighbours first
_BLOCK = 64
_TINY = 1e-30
_CONFIDENCE = 0.95
_THIRD = 2.0 ** (1.0 / 3.0)
_LOWEST_BAND_HZ = 31.25
_USABLE = 0.95  # of the Nyquist frequency
LEAST_EXCESS_DB = 1.0  # hours make any difference significant; a smaller one is of no use
_SPEEDS_DIFFER = 1.15
_ROLLING_POWER = 3.0  # rolling noise grows about with the cube of the speed (acoustics §5.2)

Spans = Sequence[tuple[float, float]]
Rows = npt.NDArray[np.float32]


@dataclass(frozen=True)
class PowerSpectrum:
    """Power density of some stretches, (n,) each: ``power`` and its 95 % interval in full-scale sines a hertz."""

    frequency_hz: FloatArray
    power: FloatArray
    low95: FloatArray
    high95: FloatArray
    degrees: float  # of freedom, of the chi-square that a bin follows
    windows: int
    duration_s: float
    average: str

    @property
    def bin_hz(self) -> float:
        """From bin to bin; a Hann window resolves one and a half of them."""
        return float(self.frequency_hz[1] - self.frequency_hz[0])

    @cached_property
    def level_db(self) -> FloatArray:
        """Levels (n,) in dBFS a hertz."""
        return _decibels(self.power)

    @cached_property
    def interval_db(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper end (n,) of the 95 % intervals, in dBFS a hertz."""
        return _decibels(self.low95), _decibels(self.high95)

    def band_db(self, low_hz: float, high_hz: float) -> float:
        """Return the level of a band in dBFS; −300 where it holds no bin."""
        rows = (self.frequency_hz >= low_hz) & (self.frequency_hz < high_hz)
        return float(_decibels(np.asarray(self.power[rows].sum() * self.bin_hz)))


@dataclass(frozen=True)
class BandDifference:
    """A third of an octave in which two spectra are compared: A over B in dB, with a 95 % interval."""

    low_hz: float
    high_hz: float
    difference_db: float
    low95_db: float
    high95_db: float
    stands_out: bool  # A over B by more than chance, with all bands looked at together, and by a decibel at least


@dataclass(frozen=True)
class Comparison:
    """Spectrum A over spectrum B: (n,) decibels with their 95 % interval, and the same in thirds of an octave."""

    frequency_hz: FloatArray
    difference_db: FloatArray
    low95_db: FloatArray
    high95_db: FloatArray
    bands: tuple[BandDifference, ...]
    louder_db: float  # by how much A is louder than B over the whole: the median over the bands
    is_level: bool  # that has been taken off everywhere, so that only the shapes are compared


@dataclass(frozen=True)
class SpeedNote:
    """The device passed A and B at speeds so different that its rolling alone may explain ``explained_db``."""

    a_mps: float
    b_mps: float
    explained_db: float


def power_spectrum(
    audio: AudioSource,
    spans_s: Spans,
    *,
    average: str = "median",
    resolution_hz: float = RESOLUTION_HZ,
    progress: Progress | None = None,
) -> PowerSpectrum:
    """Return the spectrum of stretches of audio time, taken together, by half-overlapping Hann windows.

    A short stretch gets shorter windows, so that there are eight at least; ``median`` passes over short events, which
    ``mean`` contains.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES, or AUDIO_UNREADABLE.
    """
    if average not in AVERAGES:
        raise ValueError(f"no average {average!r}")
    rate = audio.sample_rate_hz
    stretches = [(max(0, round(a * rate)), min(audio.frames, round(b * rate))) for a, b in spans_s]
    stretches = [(a, b) for a, b in stretches if b > a]
    window = _window_length([b - a for a, b in stretches], rate, resolution_hz)
    counts = [(b - a - window) // (window // 2) + 1 if b - a >= window else 0 for a, b in stretches]
    total = sum(counts)
    if total < 1:
        longest = max((b - a for a, b in stretches), default=0)
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=longest, needed=_SHORTEST_WINDOW)
    if sum(b - a for a, b in stretches) > LONGEST_S * rate:
        raise ValueError("too long a stretch: hours are for the pyramid")
    group = -(-total // _MOST_ROWS) if average == "median" else total
    rows = _Rows(window // 2 + 1, group)
    taper = np.hanning(window + 1)[:-1]
    scale = 4.0 / (rate * float(np.square(taper).sum()))  # one-sided, and a full-scale sine's power is a half
    done, watch = 0, progress or silent()
    with AudioReader(audio) as reader:
        for (start, _), count in zip(stretches, counts, strict=True):
            for first in range(0, count, _BLOCK):
                some = min(_BLOCK, count - first)
                rows.add(_periodograms(reader, start + first * (window // 2), some, window, taper))
                done += some
                watch.update(done / total, "spectrum_measuring")
    power, kinds = rows.averaged(average)
    power = np.asarray(np.maximum(power * scale, _TINY), np.float64)
    power[[0, -1]] *= 0.5  # these two have no negative twin
    degrees = _degrees(total, taper, group if average == "median" else None, kinds)
    low, high = (degrees / stats.chi2.ppf(q, degrees) for q in (0.5 + 0.5 * _CONFIDENCE, 0.5 - 0.5 * _CONFIDENCE))
    seconds = sum(b - a for a, b in stretches) / rate
    frequency: FloatArray = np.asarray(np.arange(window // 2 + 1) * (rate / window), np.float64)
    return PowerSpectrum(frequency, power, power * low, power * high, degrees, total, seconds, average)


def compare(a: PowerSpectrum, b: PowerSpectrum, *, same_loudness: bool = False) -> Comparison:
    """Return A over B where both have bins; with ``same_loudness`` only the shapes are compared.

    The ratio of two such spectra follows an F distribution. Of a band, the degrees of freedom are those of its bins
    taken together (Satterthwaite 1946), each Hann bin counting two thirds.
    """
    if len(a.frequency_hz) != len(b.frequency_hz) or a.bin_hz != b.bin_hz:
        a, b = _alike(a, b)
    difference = a.level_db - b.level_db
    low_factor, high_factor = _ratio_interval(a.degrees, b.degrees, 1.0 - _CONFIDENCE)
    edges = [e for e in third_octaves(float(a.frequency_hz[-1])) if _rows_in(a, e).sum() >= 2]
    bands = [_band(a, b, edge, (1.0 - _CONFIDENCE) / max(len(edges), 1)) for edge in edges]
    louder = float(np.median([band.difference_db for band in bands])) if bands else float(np.median(difference))
    off = louder if same_loudness else 0.0
    shifted = tuple(
        BandDifference(
            band.low_hz,
            band.high_hz,
            band.difference_db - off,
            band.low95_db - off,
            band.high95_db - off,
            band.stands_out if not off else min(band.low95_db, band.difference_db - LEAST_EXCESS_DB) > off,
        )
        for band in bands
    )
    return Comparison(
        a.frequency_hz,
        difference - off,
        difference - off + low_factor,
        difference - off + high_factor,
        shifted,
        louder,
        same_loudness,
    )


def around(start: float, end: float, extent: tuple[float, float], *, away: float = 0.0) -> Spans:
    """Return what lies before and after a stretch: each as long as it, ``away`` from it, within the extent.

    In any unit; three times as long in all where the stretch is at an end. Empty spans are left out.
    """
    length = end - start
    before = (max(start - away - 1.5 * length, extent[0]), max(start - away, extent[0]))
    after = (min(end + away, extent[1]), min(end + away + 1.5 * length, extent[1]))
    return tuple(span for span in (before, after) if span[1] > span[0])


def speed_note(a_mps: float, b_mps: float) -> SpeedNote | None:
    """Return what is to be said of two speeds; None where they are alike or one of them is not known."""
    if not (a_mps > 0.0 and b_mps > 0.0 and math.isfinite(a_mps * b_mps)):
        return None
    if max(a_mps / b_mps, b_mps / a_mps) < _SPEEDS_DIFFER:
        return None
    return SpeedNote(a_mps, b_mps, 10.0 * _ROLLING_POWER * math.log10(a_mps / b_mps))


def third_octaves(nyquist_hz: float) -> list[tuple[float, float]]:
    """Return the edges of the thirds of an octave about 1 kHz (IEC 61260, base two) that a recording can hold."""
    first, last = math.ceil(3 * math.log2(_LOWEST_BAND_HZ / 1000.0)), 3 * 7
    centres = (1000.0 * 2.0 ** (k / 3.0) for k in range(first, last))
    return [(c / _THIRD**0.5, c * _THIRD**0.5) for c in centres if c * _THIRD**0.5 <= _USABLE * nyquist_hz]


# --- inside ----------------------------------------------------------------------------------------------------------


def _window_length(lengths: list[int], rate: float, resolution_hz: float) -> int:
    """Return a power of two near the wished resolution, shorter where eight windows would not fit."""
    wished = 1 << max(7, round(math.log2(rate / max(resolution_hz, 1e-3))))
    while wished > _SHORTEST_WINDOW and sum(max(0, 2 * n // wished - 1) for n in lengths) < _FEWEST_WINDOWS:
        wished //= 2
    return wished


def _periodograms(reader: AudioReader, start: int, count: int, window: int, taper: FloatArray) -> Rows:
    """Return |rfft|² (count, bins) of windows half a window apart, each without its mean."""
    hop = window // 2
    samples = reader.read(start, (count + 1) * hop)
    pieces = np.lib.stride_tricks.sliding_window_view(samples, window)[::hop][:count]
    pieces = (pieces - pieces.mean(axis=1, keepdims=True)) * taper.astype(np.float32)
    parts = fft.rfft(pieces, axis=1)
    power: Rows = (parts.real**2 + parts.imag**2).astype(np.float32)
    return power


class _Rows:
    """Sums periodograms in groups of ``group`` that follow each other."""

    def __init__(self, bins: int, group: int) -> None:
        self._group = group
        self._sum, self._in_sum = np.zeros(bins), 0
        self._rows: list[Rows] = []

    def add(self, periodograms: Rows) -> None:
        """Take rows of a block."""
        if self._group == 1:
            self._rows.extend(periodograms)
            return
        for periodogram in periodograms:
            self._sum += periodogram
            self._in_sum += 1
            if self._in_sum == self._group:
                self._close()

    def averaged(self, average: str) -> tuple[FloatArray, int]:
        """Return the average (bins,) without the median's bias, and over how many rows it was taken."""
        if self._in_sum and (not self._rows or self._in_sum >= 0.5 * self._group):
            self._close()  # a rest of less than half a group would spread more than the others
        if average == "mean":
            return np.asarray(self._rows[0], np.float64), 1
        stack = np.stack(self._rows)
        middle = np.asarray(np.median(stack, axis=0), np.float64)
        if self._group == 1:
            return middle / _median_bias(len(stack)), len(stack)
        degrees = 2.0 * self._group * 0.95
        return middle * (degrees / float(stats.chi2.ppf(0.5, degrees))), len(stack)

    def _close(self) -> None:
        self._rows.append((self._sum / self._in_sum).astype(np.float32))
        self._sum[:], self._in_sum = 0.0, 0


def _median_bias(count: int) -> float:
    """Return the expected median of ``count`` exponential numbers of mean 1."""
    return float(_order_sums(count)[0])


def _order_sums(count: int) -> tuple[float, float]:
    """Return mean and variance of that median (of an odd number; an even one is close to the odd one below it)."""
    odd = count if count % 2 else max(1, count - 1)
    terms = 1.0 / np.arange((odd + 1) // 2, odd + 1)
    return float(terms.sum()), float(np.square(terms).sum())


def _degrees(windows: int, taper: FloatArray, group: int | None, rows: int) -> float:
    """Return the degrees of freedom of the average; ``group`` windows make a row of a median, None is a mean."""
    hop = len(taper) // 2
    overlap = float(np.dot(taper[hop:], taper[:-hop]) / np.square(taper).sum()) ** 2
    of_mean = 2.0 * windows / (1.0 + 2.0 * (1.0 - 1.0 / windows) * overlap)
    if group is None or rows < 3:
        return of_mean
    if group == 1:
        mean, variance = _order_sums(rows)
        return 2.0 * mean**2 / variance * of_mean / (2.0 * windows)
    return of_mean * 2.0 / math.pi  # the median of nearly normal numbers


def _ratio_interval(degrees_a: float, degrees_b: float, alpha: float) -> tuple[float, float]:
    """Return by how many dB the true ratio of two spectra may lie below and above the one that was found."""
    low = -10.0 * math.log10(float(stats.f.ppf(1.0 - 0.5 * alpha, degrees_a, degrees_b)))
    high = -10.0 * math.log10(float(stats.f.ppf(0.5 * alpha, degrees_a, degrees_b)))
    return low, high


def _rows_in(spectrum: PowerSpectrum, edge: tuple[float, float]) -> npt.NDArray[np.bool_]:
    return (spectrum.frequency_hz >= edge[0]) & (spectrum.frequency_hz < edge[1])


def _band(a: PowerSpectrum, b: PowerSpectrum, edge: tuple[float, float], alpha: float) -> BandDifference:
    rows = _rows_in(a, edge)
    degrees = []
    for spectrum in (a, b):
        power = spectrum.power[rows]
        independent = max(1.0, float(power.sum() ** 2 / np.square(power).sum()) / 1.5)
        degrees.append(spectrum.degrees * independent)
    difference = a.band_db(*edge) - b.band_db(*edge)
    low, high = _ratio_interval(degrees[0], degrees[1], 1.0 - _CONFIDENCE)
    strict = _ratio_interval(degrees[0], degrees[1], alpha)[0]  # all bands together (Bonferroni)
    stands = difference + strict > 0.0 and difference > LEAST_EXCESS_DB
    return BandDifference(*edge, difference, difference + low, difference + high, stands)


def _alike(a: PowerSpectrum, b: PowerSpectrum) -> tuple[PowerSpectrum, PowerSpectrum]:
    """Return both with the wider bins of the two, where those are a multiple of the finer ones."""
    wide, fine = (a, b) if a.bin_hz >= b.bin_hz else (b, a)
    times = round(wide.bin_hz / fine.bin_hz)
    if abs(times * fine.bin_hz - wide.bin_hz) > 1e-6 * wide.bin_hz:
        raise ValueError("spectra of recordings with other sample rates")
    half = times // 2
    padded = np.pad(fine.power, (half, half), mode="reflect")
    kernel = np.full(2 * half + 1, 1.0 / times)
    if times % 2 == 0:
        kernel[[0, -1]] *= 0.5
    power = np.convolve(padded, kernel, mode="valid")[::times] if times > 1 else fine.power
    degrees = fine.degrees * max(1.0, times / 1.5)
    low, high = (degrees / stats.chi2.ppf(q, degrees) for q in (0.975, 0.025))
    coarse = PowerSpectrum(
        wide.frequency_hz, power, power * low, power * high, degrees, fine.windows, fine.duration_s, fine.average
    )
    return (wide, coarse) if wide is a else (coarse, wide)


def _decibels(power: FloatArray) -> FloatArray:
    return np.asarray(10.0 * np.log10(np.maximum(power, _TINY)), np.float64)
