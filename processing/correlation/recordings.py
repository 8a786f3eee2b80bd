"""The two recordings that are correlated: which channels, which stretch, and how their clocks relate."""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.sound.pcm import Samples
from processing.survey import AudioSource

MOST_DRIFT_PPM = 1000.0


class SyncKind(StrEnum):
    """How it is known that the two recordings are simultaneous."""

    ONE_CLOCK = "one_clock"  # two channels of one recorder, or recorders with a common clock (radio, GPS)
    TYPED = "typed"  # the operator knows the offset
    EVENT = "event"  # both recorders were knocked together
    TAPS = "taps"  # taps outside both ends told offset and speed
    UNKNOWN = "unknown"  # nothing is known: a delay can be measured, a place cannot


@dataclass(frozen=True)
class Sync:
    """Recording B began ``offset_s`` after A (± ``sigma_s``), and its clock runs ``drift_ppm`` fast.

    The offset holds at ``at_s`` (seconds of A): the moment of the knocks or taps that told it.
    """

    kind: SyncKind = SyncKind.ONE_CLOCK
    offset_s: float = 0.0
    sigma_s: float = 0.0
    drift_ppm: float = 0.0
    at_s: float = 0.0

    def in_b(self, moment_s: float) -> float:
        """Return where in B's recording (its own seconds) a moment of A lies."""
        return moment_s - self.offset_s + 1e-6 * self.drift_ppm * (moment_s - self.at_s)

    @property
    def known(self) -> bool:
        """Whether a place may be derived from a delay."""
        return self.kind is not SyncKind.UNKNOWN


@dataclass(frozen=True)
class Pair:
    """What is correlated: two channels from ``start_s`` to ``end_s`` (seconds of A; None is as long as both last)."""

    a: AudioSource
    b: AudioSource
    sync: Sync = Sync()
    start_s: float = 0.0
    end_s: float | None = None

    @property
    def same_file(self) -> bool:
        """Whether both channels come from the same files."""
        return [p.path for p in self.a.parts] == [p.path for p in self.b.parts]

    def common_span_s(self) -> tuple[float, float]:
        """Return from when to when (seconds of A) both recordings have sound within the chosen stretch."""
        first = max(0.0, self.start_s, self.sync.offset_s)
        late_s = self.sync.in_b(self.a.duration_s) - self.b.duration_s  # how much of A has no sound in B any more
        last = self.a.duration_s - max(0.0, late_s)
        return first, last if self.end_s is None else min(last, self.end_s)

    def stretch(self, start_s: float, end_s: float | None) -> "Pair":
        """Return the same recordings over another stretch."""
        return replace(self, start_s=start_s, end_s=end_s)


@dataclass(frozen=True)
class Grid:
    """How both recordings are cut: segments of ``segment_s``, half overlapping, whole and even numbers of samples."""

    rate_a_hz: int
    rate_b_hz: int
    count_a: int
    count_b: int
    first_s: float
    segments: int

    @property
    def segment_s(self) -> float:
        """Length of a segment."""
        return self.count_a / self.rate_a_hz

    @property
    def hop_s(self) -> float:
        """From segment to segment."""
        return 0.5 * self.segment_s

    @property
    def used_s(self) -> float:
        """From the first segment's begin to the last one's end."""
        return (self.segments + 1) * self.hop_s


def lay_grid(pair: Pair, segment_s: float) -> Grid:
    """Return segments of about ``segment_s`` that hold whole numbers of samples at both rates.

    Two rates need no resampling: the same stretch of time at either rate has its Fourier lines at the same
    frequencies. The lengths are multiples of the rates' common period.

    Raises:
        LeaklineError: CORRELATION_TOO_SHORT where less than two segments fit.
    """
    rate_a, rate_b = round(pair.a.sample_rate_hz), round(pair.b.sample_rate_hz)
    common = math.gcd(rate_a, rate_b)
    step = 2 if (rate_a // common) % 2 or (rate_b // common) % 2 else 1
    periods = step * max(1, round(segment_s * common / step))
    first, last = pair.common_span_s()
    length_s = periods / common
    segments = int((last - first) / (0.5 * length_s) + 1e-9) - 1 if last > first else 0
    if segments < 2:
        raise LeaklineError(
            ErrorCode.CORRELATION_TOO_SHORT,
            Place(pair.a.parts[0].path),
            have_s=max(0.0, last - first),
            need_s=1.5 * length_s,
        )
    return Grid(rate_a, rate_b, periods * rate_a // common, periods * rate_b // common, first, segments)


def is_silent(samples: Samples) -> bool:
    """Return whether a piece holds nothing but one value: an unplugged or sleeping recorder."""
    return bool(samples.size == 0 or np.ptp(samples) <= 0.0)


def is_clipped(samples: Samples) -> bool:
    """Return whether the peaks of a piece are cut off: at least four times three equal extreme values in a row."""
    highest, lowest = samples.max(), samples.min()
    count = 0
    for extreme in (highest, lowest):
        hits = samples == extreme
        count += int(np.count_nonzero(hits[2:] & hits[1:-1] & hits[:-2]))
    return count >= 4
