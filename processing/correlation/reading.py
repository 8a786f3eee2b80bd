"""Reads both recordings once, in half overlapping segments, and sums their spectra: the one slow step.

Welch's method (IEEE Trans. Audio Electroacoust. 15 (1967) 70) with a Hann window, the same numbers as
:func:`scipy.signal.csd`.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft

from processing.correlation.recordings import Grid, Pair, is_clipped, is_silent, lay_grid
from processing.correlation.spectra import ComplexArray, Counts, CrossSpectra
from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress
from processing.sound.pcm import Samples
from processing.sound.source import AudioReader
from processing.survey import BoolArray, FloatArray

MOST_PARTS = 48
HIGHEST_HZ = 12_000.0  # the sound of a leak does not travel along a pipe above that
_MOST_BYTES = 96 * 2**20
_BYTES_PER_BIN = 32


@dataclass(frozen=True)
class Segment:
    """One piece of both recordings; B's was taken ``late_s`` later than wanted (a part of a sample)."""

    index: int
    start_s: float
    a: Samples
    b: Samples
    late_s: float


def segments(pair: Pair, grid: Grid) -> Iterator[Segment]:
    """Yield the segments in order; at any time only one is held, so memory does not grow with the recording."""
    with AudioReader(pair.a) as reader_a, AudioReader(pair.b) as reader_b:
        first_a = round(grid.first_s * grid.rate_a_hz)
        hop_a = grid.count_a // 2
        for index in range(grid.segments):
            at_a = first_a + index * hop_a
            start_s = at_a / grid.rate_a_hz
            wanted_s = pair.sync.in_b(start_s)
            at_b = max(0, round(wanted_s * grid.rate_b_hz))
            a, b = reader_a.read(at_a, grid.count_a), reader_b.read(at_b, grid.count_b)
            if len(a) < grid.count_a or len(b) < grid.count_b:
                return  # rounding may cost the last segment
            yield Segment(index, start_s, a, b, at_b / grid.rate_b_hz - wanted_s)


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
