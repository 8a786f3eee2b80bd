"""The spectra of two recordings, in parts of the time, with their coherence and the bound that chance gives it.

The sums of each part of the recording are kept apart, so that what comes and goes, and a clock that drifts, can be
seen afterwards without reading the files again.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import ndimage, stats

from processing.correlation.recordings import Grid
from processing.survey import FloatArray

ComplexArray = npt.NDArray[np.complex128]

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
