"""Streamed Welch spectra of two recordings, in parts of the time, with coherence and the bound that chance gives it.

Welch's method (IEEE Trans. Audio Electroacoust. 15 (1967) 70) with a Hann window and half overlap, the same numbers as
:func:`scipy.signal.csd`; the sums of each part of the recording are kept apart, so that what comes and goes, and a
clock that drifts, can be seen afterwards without reading the files again.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import fft, ndimage, stats

from processing.correlation.recordings import Grid, Pair, is_clipped, is_silent, lay_grid, segments
from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress
from processing.survey import BoolArray, FloatArray

ComplexArray = npt.NDArray[np.complex128]

MOST_PARTS = 48
HIGHEST_HZ = 12_000.0  # the sound of a leak does not travel along a pipe above that
_MOST_BYTES = 96 * 2**20
_BYTES_PER_BIN = 32
OVERLAP_COST = 2.0  # half overlapping Hann segments: two lines in time and frequency for one independent number
_SMOOTH_HZ = 8.0
_LEAST_SMOOTH_BINS = 9


@dataclass(frozen=True)
class Counts:
    """What was left out: segments in all, silent, and clipped ones; ``equal`` are those with the same samples twice."""

    segments: int
    silent: int = 0
    clipped: int = 0
    equal: int = 0


@dataclass(frozen=True)
class CrossSpectra:
    """One-sided densities: ``frequency_hz`` (k,), sums over segments by part ``aa``, ``bb`` and ``ab`` (parts, k).

    ``used`` (parts,) tells the segments in each sum, ``part_s`` (parts,) the middle of each part in seconds of A.
    """

    frequency_hz: FloatArray
    part_s: FloatArray
    used: FloatArray
    aa: FloatArray
    bb: FloatArray
    ab: ComplexArray
    grid: Grid
    counts: Counts

    @cached_property
    def s_aa(self) -> FloatArray:
        """Mean power density of A (k,)."""
        return np.asarray(self.aa.sum(axis=0) / self.total)

    @cached_property
    def s_bb(self) -> FloatArray:
        """Mean power density of B (k,)."""
        return np.asarray(self.bb.sum(axis=0) / self.total)

    @cached_property
    def s_ab(self) -> ComplexArray:
        """Mean cross density (k,), conj(A)·B."""
        return np.asarray(self.ab.sum(axis=0) / self.total)

    @property
    def total(self) -> float:
        """Segments used."""
        return float(self.used.sum())

    @property
    def independent(self) -> float:
        """How many independent segments the overlapping ones are worth at one frequency (Welch 1967)."""
        return max(1.0, self.total / (1.0 + 2.0 / 36.0))

    @property
    def used_s(self) -> float:
        """Seconds of sound used."""
        return (self.total + 1.0) * self.grid.hop_s

    @property
    def step_hz(self) -> float:
        """From line to line."""
        return 1.0 / self.grid.segment_s

    @property
    def smoothing_bins(self) -> int:
        """Over how many lines densities are smoothed (odd)."""
        return max(_LEAST_SMOOTH_BINS, 2 * round(0.5 * _SMOOTH_HZ / self.step_hz) + 1)

    @cached_property
    def coherence(self) -> FloatArray:
        """Magnitude-squared coherence (k,), 0..1, as scipy has it: biased upwards by 1/segments."""
        power = self.s_aa * self.s_bb
        return np.asarray(np.abs(self.s_ab) ** 2 / np.maximum(power, 1e-300), np.float64)

    @cached_property
    def true_coherence(self) -> FloatArray:
        """Coherence (k,) without bias, smoothed over neighbours; may be slightly negative where there is none.

        It needs no idea of the delay, since each line's own bias, 1/n, is taken off before smoothing.
        """
        n = self.independent
        raw = (n * self.coherence - 1.0) / max(n - 1.0, 1.0)
        return smoothed(raw, self.smoothing_bins)

    @cached_property
    def bound(self) -> float:
        """Below this, :attr:`true_coherence` may be chance (99 %): the mean of that many chance coherences."""
        n = self.independent
        lines = max(1.0, 0.5 * self.smoothing_bins)  # Hann: neighbouring lines share half of what they say
        return float((stats.gamma.ppf(0.99, lines) / lines - 1.0) / max(n - 1.0, 1.0))

    @cached_property
    def smooth_aa(self) -> FloatArray:
        """Mean power density of A (k,), smoothed."""
        return smoothed(self.s_aa, self.smoothing_bins)

    @cached_property
    def smooth_bb(self) -> FloatArray:
        """Mean power density of B (k,), smoothed."""
        return smoothed(self.s_bb, self.smoothing_bins)


def smoothed(values: FloatArray, bins: int) -> FloatArray:
    """Return a running mean over an odd number of lines, mirrored at the ends."""
    return np.asarray(ndimage.uniform_filter1d(values, min(bins, len(values)), mode="nearest"), dtype=np.float64)


def coherence_bound(independent: float, false_alarm: float = 0.05) -> float:
    """Return the coherence that chance passes with this probability on n independent segments: 1 − α^(1/(n−1)).

    Source: Carter, Proc. IEEE 75 (1987) 236.
    """
    return float(1.0 - false_alarm ** (1.0 / max(independent - 1.0, 1e-9)))


def segment_length_s(longest_delay_s: float, available_s: float) -> float:
    """Return segments long enough that a delayed sound is still in both, short enough that there are some to average.

    Eight times the longest delay leaves seven eighths of a segment in common.
    """
    wanted = max(1.0, 8.0 * longest_delay_s)
    return max(min(wanted, available_s / 12.0), 4.0 * longest_delay_s, 0.1)


def measure(pair: Pair, segment_s: float, progress: Progress, parts: int = MOST_PARTS) -> CrossSpectra:
    """Read both recordings once and return their spectra; memory does not depend on their length.

    Raises:
        LeaklineError: CORRELATION_TOO_SHORT, CORRELATION_SILENT (nothing but silence in one of them),
            CORRELATION_ALL_CLIPPED, AUDIO_UNREADABLE.
    """
    grid = lay_grid(pair, segment_s)
    sums = _Sums(grid, parts)
    for segment in segments(pair, grid):
        progress.update(segment.index / grid.segments, "correlating")
        silent = [is_silent(segment.a), is_silent(segment.b)]
        if any(silent):
            sums.note_silent(silent)
        elif is_clipped(segment.a) or is_clipped(segment.b):
            sums.clipped += 1
        else:
            if len(segment.a) == len(segment.b) and np.array_equal(segment.a, segment.b):
                sums.equal += 1
            sums.add(segment.index, segment.start_s, segment.a, segment.b, segment.late_s)
    if sums.used.sum() < 2:
        _refuse(pair, sums)
    progress.update(1.0)
    return sums.result()


def _refuse(pair: Pair, sums: "_Sums") -> None:
    if sums.clipped > sum(sums.silent):
        raise LeaklineError(ErrorCode.CORRELATION_ALL_CLIPPED, Place(pair.a.parts[0].path))
    source = pair.b if sums.silent[1] > sums.silent[0] else pair.a
    raise LeaklineError(ErrorCode.CORRELATION_SILENT, Place(source.parts[0].path))


class _Sums:
    """The sums that grow while the recordings are read."""

    def __init__(self, grid: Grid, parts: int) -> None:
        self._grid = grid
        highest_hz = min(0.5 * min(grid.rate_a_hz, grid.rate_b_hz), HIGHEST_HZ)
        self._bins = int(highest_hz * grid.segment_s) + 1
        fit = max(1, _MOST_BYTES // (_BYTES_PER_BIN * self._bins))
        self._parts = max(1, min(parts, fit, grid.segments // 2))
        self._aa = np.zeros((self._parts, self._bins))
        self._bb = np.zeros((self._parts, self._bins))
        self._ab = np.zeros((self._parts, self._bins), np.complex128)
        self._moment = np.zeros(self._parts)
        self.used = np.zeros(self._parts)
        self.silent, self.clipped, self.equal = [0, 0], 0, 0
        self._frequency_hz = np.arange(self._bins) / grid.segment_s
        self._windows = tuple(_hann(count) for count in (grid.count_a, grid.count_b))

    def note_silent(self, silent: list[bool]) -> None:
        """Count a segment in which one or both say nothing."""
        self.silent = [n + s for n, s in zip(self.silent, silent, strict=True)]

    def add(self, index: int, start_s: float, a: npt.ArrayLike, b: npt.ArrayLike, late_s: float) -> None:
        """Add one segment to its part."""
        part = min(index * self._parts // self._grid.segments, self._parts - 1)
        lines_a = self._lines(np.asarray(a, np.float64), self._windows[0], self._grid.rate_a_hz)
        lines_b = self._lines(np.asarray(b, np.float64), self._windows[1], self._grid.rate_b_hz)
        if late_s != 0.0:  # B was read a part of a sample too late: turn its lines back
            lines_b *= np.exp(-2j * np.pi * late_s * self._frequency_hz)
        self._aa[part] += lines_a.real**2 + lines_a.imag**2
        self._bb[part] += lines_b.real**2 + lines_b.imag**2
        self._ab[part] += lines_a.conj() * lines_b
        self._moment[part] += start_s + 0.5 * self._grid.segment_s
        self.used[part] += 1

    def _lines(self, samples: FloatArray, window: FloatArray, rate_hz: int) -> ComplexArray:
        # one-sided density: |lines|² integrates to the power whatever the rate
        scale = np.sqrt(2.0 / (rate_hz * np.sum(window**2)))
        return np.asarray(fft.rfft((samples - samples.mean()) * window)[: self._bins] * scale)

    def result(self) -> CrossSpectra:
        """Return the spectra; parts without a usable segment are left out."""
        kept: BoolArray = self.used > 0
        half = min(self._grid.count_a, self._grid.count_b) // 2
        ends = [0] if self._bins <= half else [0, -1]  # these lines have no mirror image
        for sums in (self._aa, self._bb, self._ab):
            sums[:, ends] *= 0.5
        counts = Counts(self._grid.segments, max(self.silent), self.clipped, self.equal)
        return CrossSpectra(
            frequency_hz=self._frequency_hz,
            part_s=self._moment[kept] / self.used[kept],
            used=self.used[kept],
            aa=self._aa[kept],
            bb=self._bb[kept],
            ab=self._ab[kept],
            grid=self._grid,
            counts=counts,
        )


def _hann(count: int) -> FloatArray:
    return np.asarray(0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count))
