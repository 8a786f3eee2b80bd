"""A device's samples and when they arrive: a clock that runs off, a bus that bundles, delays, stalls."""

from dataclasses import dataclass

import numpy as np

from processing.importing.frames import Frames
from processing.live.frame_rows import joined, rows_of


@dataclass(frozen=True)
class Sent:
    """``n`` samples: true moments, what the device's clock says of them, when they arrive; all in seconds."""

    true_s: np.ndarray
    device_s: np.ndarray
    host_s: np.ndarray  # never falling: what is bundled has one time


def sent(seconds, rate, ppm=0.0, jitter_s=0.0, bundle_s=0.0, stall=None, seed=0, host_origin_s=1000.0):
    """``stall`` (begin, length): nothing is handed on meanwhile, all of it at its end."""
    rng = np.random.default_rng(seed)
    true_s = np.arange(round(seconds * rate)) / rate
    handed_s = true_s
    if bundle_s:
        phase = rng.uniform(0, bundle_s)
        handed_s = np.ceil((true_s + phase) / bundle_s) * bundle_s - phase
    chunks_s, chunk = np.unique(handed_s, return_inverse=True)
    late_s = chunks_s + rng.exponential(jitter_s, len(chunks_s)) if jitter_s else chunks_s
    if stall is not None:
        begin, length = stall
        late_s = np.where((late_s > begin) & (late_s < begin + length), begin + length, late_s)
    host_s = np.maximum.accumulate(late_s)[chunk]
    return Sent(true_s + host_origin_s, true_s * (1 + 1e-6 * ppm), host_s + host_origin_s)


def frames_at(time_us, counter=None, seed=0):
    """Samples of noise at device times; the counter goes on by one from 0 where none is given."""
    count = len(time_us)
    rng = np.random.default_rng(seed)
    counter = np.arange(count) if counter is None else np.asarray(counter)
    nothing = np.full(count, np.nan, np.float32)
    return Frames(
        (counter % 2**32).astype(np.uint32),
        np.asarray(time_us).astype(np.uint64),
        rng.normal(0, 1, (count, 3)).astype(np.float32),
        rng.normal(0, 1, (count, 3)).astype(np.float32),
        np.full((count, 3), np.nan, np.float32),
        nothing,
        nothing,
        np.full((count, 4), np.nan, np.float32),
        np.full(count, np.nan),
    )


@dataclass
class Told:
    """What a timeline made of a stream."""

    frames: Frames
    placed: list

    def total(self, name):
        return sum(getattr(one, name) for one in self.placed)

    @property
    def axis_s(self):
        return 1e-6 * self.frames.time_us.astype(np.int64)

    @property
    def holes(self):
        return [hole for one in self.placed for hole in one.holes]


def told_by(timeline, frames, host_s, has_time=True):
    """Hand the frames to a timeline, those that arrive at one moment together; the axis must never fall back."""
    edges = np.flatnonzero(np.diff(host_s, prepend=host_s[0] - 1.0)).tolist()
    placed = [
        timeline.place(rows_of(frames, slice(a, b)), float(host_s[a]), has_time)
        for a, b in zip(edges, [*edges[1:], len(host_s)], strict=True)
    ]
    out = joined([one.frames for one in placed])
    assert (np.diff(out.time_us.astype(np.int64)) > 0).all()
    return Told(out, placed)
