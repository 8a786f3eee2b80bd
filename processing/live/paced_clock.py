"""Gives samples without times an even clock that follows their arrivals slowly, so that a bus's jitter is not in them.

The rate is found from the first arrivals and followed by a line through the earliest ones; the axis is steered onto
that line over many seconds (a phase-locked loop of low bandwidth), never set. After a silence the samples that come are
held for a moment: either those that waited come all at once and nothing is lost, or so many are missing as the silence
lasted.
"""

import numpy as np
import numpy.typing as npt

from processing.importing.frames import Frames
from processing.live.arrival_fit import ArrivalFit
from processing.live.device_clock import Events, Hole, Latest
from processing.live.frame_rows import arrived, joined, no_frames, placed_at
from processing.survey import FloatArray

_FIND_S = 1.5  # of arrivals, before the rate is believed
_FIND_ROWS = 12
_FIND_AT_MOST_S = 5.0
_SILENCE_S = 0.15  # in it so many samples may be lost that it matters
_SILENT_STEPS = 4.0  # usual steps between chunks
_HOLD_S = 0.4  # after a silence: what waited has come by then
_HOLD_JITTERS = 6.0  # where a link is late all the time
_LATE_JITTERS = 4.0
_LATE_SHARE = 0.01
_MOST_LATE_S = 1.0
_LEAST_HOLE_S = 0.05
_BEHIND_S = 0.3  # the axis against the arrivals of several seconds: another rate
_BEHIND_FOR_S = 3.0
_AHEAD_S = 0.25
_MEMORY_S = 120.0
_MOST_COUNTED = 100_000
_FASTEST = 0.01  # by which the period may be changed to steer
_STEER_S = (2.0, 30.0)  # time constants at first and later


class PacedClock:
    """The axis of a device that sends no time: the host's clock, smoothed.

    Args:
        fit: relates the axis (in seconds) to the host's clock; it is fed here.
        latest: the sample after which the axis goes on, placed by another clock; None begins it at 0.
    """

    def __init__(self, fit: ArrivalFit, latest: Latest | None = None) -> None:
        self._fit = fit
        self.latest = latest
        self.period_us = 0.0
        self._held: list[Frames] = []
        self._held_host_s: list[float] = []
        self._hold_until_s: float | None = None  # after a silence
        self._nominal_s = 0.0  # period on which the index line stands
        self._line = ArrivalFit(memory_s=_MEMORY_S, window_s=0.5, most_windows=512, prior_ppm=5000.0)
        self._index = 0  # of the last placed sample on that line
        self._begun_s = 0.0  # host time
        self._sent_counter: int | None = None
        self._chunk_s = 0.0  # usual step between arrivals
        self._last_host_s: float | None = None
        self._held_until_s = 0.0  # host time of the newest placed chunk
        self._latest_s = 0.0  # the axis, unrounded
        self._zero_s: float | None = None  # host time of the axis' 0
        self._behind_since_s = 0.0  # host time
        self._usually_late_s = 0.0  # root mean square of the last hundred chunks

    def place(self, frames: Frames, host_s: float) -> tuple[Frames, Events]:
        """Return the samples on the axis, and what was odd; the first second's wait until the rate is known."""
        events = Events()
        if not len(frames):
            return frames, events
        step_s = host_s - self._last_host_s if self._last_host_s is not None else 0.0
        self._last_host_s = host_s
        self._held.append(arrived(frames, host_s))
        self._held_host_s.append(host_s)
        if not self.period_us:
            return (self._found(events) if self._may_find(host_s) else no_frames()), events
        if self._hold_until_s is None and step_s > max(
            _SILENCE_S, 6e-6 * self.period_us, _SILENT_STEPS * self._chunk_s
        ):
            self._hold_until_s = host_s + max(_HOLD_S, _HOLD_JITTERS * self._usually_late_s)
        elif step_s > 0:
            self._chunk_s += 0.05 * (step_s - self._chunk_s)
        if self._hold_until_s is not None and host_s < self._hold_until_s:
            return no_frames(), events
        if self._hold_until_s is not None:
            self._hold_until_s = None
            self._bridge(events)
        placed = self._released(events)
        self._check()
        return placed, events

    # --- the rate

    def _may_find(self, host_s: float) -> bool:
        span_s = host_s - self._held_host_s[0]
        rows = sum(len(part) for part in self._held[1:])
        return len(self._held) > 2 and (
            (span_s >= _FIND_S and rows >= _FIND_ROWS) or (span_s >= _FIND_AT_MOST_S and rows >= 3)
        )

    def _found(self, events: Events) -> Frames:
        """Find the period from the chunks that were held, and place them."""
        sizes = np.array([len(part) for part in self._held], np.float64)
        host_s = np.array(self._held_host_s)
        ends = np.cumsum(sizes)
        slope = float(np.polyfit(ends - ends[0], host_s - host_s[0], 1)[0])
        self._nominal_s = max(slope, 1e-5)
        self.period_us = 1e6 * self._nominal_s
        self._chunk_s = float(np.mean(np.diff(host_s)))
        # the earliest arrival tells where the last sample lies
        behind = host_s - self._nominal_s * ends
        end_host_s = float(np.min(behind)) + self._nominal_s * float(ends[-1])
        first_host_s = end_host_s - self._nominal_s * (float(ends[-1]) - 1.0)
        self._line = ArrivalFit(memory_s=_MEMORY_S, window_s=0.5, most_windows=512, prior_ppm=5000.0)
        self._index, self._begun_s, self._behind_since_s = -1, first_host_s, 0.0
        if self.latest is None:
            self._latest_s, self._zero_s = -self._nominal_s, first_host_s
        else:
            self._go_on_at(first_host_s, events)
        return self._released(events)

    def _go_on_at(self, host_s: float, events: Events) -> None:
        """Let the axis go on so that the next sample lies at a moment of the host's clock."""
        assert self.latest is not None
        if self._zero_s is None:
            self._zero_s = host_s - float(self._fit.device_of(host_s))
        last_s = 1e-6 * self.latest.axis_us
        next_s = max(host_s - self._zero_s, last_s + self._nominal_s)
        missing = round((next_s - last_s) / self._nominal_s) - 1
        if missing * self._nominal_s > _LEAST_HOLE_S:
            events.lost += missing
            events.holes.append(Hole(self.latest.axis_us, round(1e6 * next_s), "live_lost"))
            self.latest = Latest(self.latest.axis_us, self.latest.counter + missing, self.latest.host_s)
        self._latest_s = next_s - self._nominal_s

    # --- what is lost

    def _bridge(self, events: Events) -> None:
        """After a silence: leave out as many samples as even the earliest chunk since then is late by."""
        assert self.latest is not None
        ends = self._index + np.cumsum([len(part) for part in self._held])
        late_s = float(np.min(np.array(self._held_host_s) - self._line_host_s(ends)))
        if late_s <= max(3e-6 * self.period_us, _LEAST_HOLE_S, _LATE_JITTERS * self._usually_late_s):
            return
        missing = max(round(1e6 * late_s / self.period_us), 1)
        start_us = self.latest.axis_us
        self._latest_s += 1e-6 * self.period_us * missing
        self._index += missing
        self.latest = Latest(start_us, self.latest.counter + missing, self.latest.host_s)
        events.lost += missing
        events.holes.append(Hole(start_us, round(1e6 * self._latest_s + self.period_us), "live_lost"))

    def _line_host_s(self, index: npt.NDArray[np.int64] | int) -> FloatArray:
        """Return when samples were made, host time."""
        at = self._nominal_s * np.asarray(index, np.float64)
        return np.asarray(self._begun_s + at) if self._line.is_empty else self._line.host_of(at)

    def _check(self) -> None:
        """Find the rate anew where the arrivals of some seconds are all late, or one is of the future."""
        host_s = self._held_until_s
        late_s = host_s - float(self._line_host_s(self._index))
        share = _LATE_SHARE * (min(late_s, _MOST_LATE_S) ** 2 - self._usually_late_s**2)
        self._usually_late_s = float(np.sqrt(max(self._usually_late_s**2 + share, 0.0)))
        if late_s <= _BEHIND_S:
            self._behind_since_s = host_s
        if late_s < -_AHEAD_S or host_s - self._behind_since_s > _BEHIND_FOR_S:
            self.period_us = 0.0

    # --- placing

    def _released(self, events: Events) -> Frames:
        out = [self._paced(part, host_s, events) for part, host_s in zip(self._held, self._held_host_s, strict=True)]
        self._held_until_s = self._held_host_s[-1]
        self._behind_since_s = self._behind_since_s or self._held_until_s
        self._held, self._held_host_s = [], []
        return joined(out)

    def _paced(self, frames: Frames, host_s: float, events: Events) -> Frames:
        sent = np.append(self._counter_before(frames), frames.counter.astype(np.int64))
        counted = np.remainder(np.diff(sent), 1 << 32)
        counted = np.where((counted < 1) | (counted > _MOST_COUNTED), 1, counted)  # a counter set anew tells nothing
        self._sent_counter = int(frames.counter[-1])
        events.lost += int((counted - 1).sum())
        steps = np.cumsum(counted)
        axis_s = self._latest_s + self._steered_s() * steps
        axis_us = np.rint(1e6 * axis_s).astype(np.int64)
        before = self.latest.counter if self.latest is not None else -1
        if self.latest is not None:
            axis_us = np.maximum(axis_us, self.latest.axis_us + 1 + np.arange(len(axis_us)))
        self._index, self._latest_s = self._index + int(steps[-1]), float(axis_s[-1])
        self.latest = Latest(int(axis_us[-1]), before + int(steps[-1]), host_s)
        self._line.add(np.array([self._nominal_s * self._index]), np.array([host_s]))
        self._fit.add(1e-6 * axis_us[-1:].astype(np.float64), np.array([host_s]))
        return placed_at(frames, axis_us, before + steps)

    def _counter_before(self, frames: Frames) -> int:
        return self._sent_counter if self._sent_counter is not None else int(frames.counter[0]) - 1

    def _steered_s(self) -> float:
        """Return the period with which the axis comes nearer to where the arrivals say that it should be."""
        if not self._line.is_settled:
            return self._nominal_s
        host_s = self._line_host_s(self._index + np.array([0, 1]))
        period_s = float(host_s[1] - host_s[0])
        self.period_us = 1e6 * period_s
        constant_s = float(np.clip(self._nominal_s * self._index / 3.0, *_STEER_S))
        off = (float(host_s[0]) - (self._zero_s or 0.0) - self._latest_s) / constant_s
        return period_s * (1.0 + float(np.clip(off, -_FASTEST, _FASTEST)))
