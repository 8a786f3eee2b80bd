"""Puts samples with a device's own times on one axis that never falls back, whatever the device's clock does.

A device that is plugged in again counts from nought; a 32-bit counter of microseconds turns over every 71.6 minutes; a
line may be damaged in its time; a radio may bring a message twice, or late. What goes on is left as it is; what cannot
be of this clock has to be confirmed by the next two samples, and then the host's clock bridges the pause.
"""

from collections import deque
from dataclasses import dataclass, field
from enum import Enum, auto
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from processing.importing.frames import Frames
from processing.live.arrival_fit import ArrivalFit
from processing.live.frame_rows import arrived, joined, no_frames, placed_at, rows_of

Whole = npt.NDArray[np.int64]
_TURN = 1 << 32
_CONFIRMED_BY = 3  # samples in a row that agree with each other
_AGREE_US = 2_000_000  # two that follow each other are no further apart
_LATE_US = 500_000  # a sample that much behind came late; further back the clock began anew
_AHEAD_S = 0.25  # a sample cannot be from the future: beyond this, and what the line is in doubt by, it is not
_AHEAD_AT_FIRST_S = 5.0  # while there is no line yet
_MEMORY = 4096  # samples in which a repeated one is looked for
_STEPS = 512  # of which the period is the median
_LOOK_EVERY = 64  # steps
_LARGEST_US = 1 << 62
RESTARTED = "live_restart"


@dataclass(frozen=True)
class Hole:
    """A pause between two samples, in microseconds of the axis, and why: key of [reasons]."""

    start_us: int
    end_us: int
    reason: str


@dataclass
class Events:
    """What was odd in one chunk."""

    lost: int = 0
    repeated: int = 0
    absurd: int = 0  # samples whose time could not be, left out
    restarts: int = 0
    holes: list[Hole] = field(default_factory=list)


@dataclass(frozen=True)
class Latest:
    """The sample that was placed last: on the axis, by the counter that goes on, and when it arrived."""

    axis_us: int
    counter: int
    host_s: float


class _Verdict(Enum):
    """What becomes of a sample."""

    GOES_ON = auto()
    REPEATED = auto()
    ABSURD = auto()
    ANEW = auto()
    WAITS = auto()


@dataclass
class _Taken:
    """Rows of a chunk that are placed."""

    rows: list[int] = field(default_factory=list)
    axis_us: list[int] = field(default_factory=list)
    counter: list[int] = field(default_factory=list)
    steps_us: list[int] = field(default_factory=list)
    fitted: int = 0  # of them, how many the fit has


class DeviceClock:
    """The axis of a device that sends its time.

    Args:
        fit: relates the axis (in seconds) to the host's clock; it is fed here.
        latest: the sample after which the axis goes on, placed by another clock; None begins it at 0.
    """

    def __init__(self, fit: ArrivalFit, latest: Latest | None = None) -> None:
        self._fit = fit
        self.latest = latest
        self._device_us: int | None = None  # of the last sample, its turns counted
        self._sent_counter = 0
        self._turned_us = 0  # added to what the device says, for each time its 32 bits ran over
        self._shift_us = 0  # axis − device
        self._waiting: Frames = no_frames()
        self._seen: deque[tuple[Whole, Frames]] = deque()  # device times, as they came, and their samples
        self._seen_rows = 0
        self._steps: Whole = np.zeros(0, np.int64)
        self._new_steps: list[Whole] = []
        self._new_rows = 0
        self.period_us = 0.0
        self._usual_us = 0.0  # above it a step is a hole

    def place(self, frames: Frames, host_s: float) -> tuple[Frames, Events]:
        """Return the samples on the axis, and what was odd; up to two that are in doubt wait for the next chunk."""
        frames = arrived(frames, host_s)
        if len(self._waiting):
            frames = joined([self._waiting, frames])
            self._waiting = no_frames()
        events = Events()
        if not len(frames):
            return frames, events
        raw_us = np.minimum(frames.time_us, np.uint64(_LARGEST_US)).astype(np.int64)
        placed = self._plainly(raw_us, frames, host_s)
        if placed is None:
            placed = self._carefully(raw_us, frames, host_s, events)
        return placed, events

    # --- the usual: everything goes on

    def _plainly(self, raw_us: Whole, frames: Frames, host_s: float) -> Frames | None:
        """Return the chunk placed where each sample is the next one, and none is from the future; else None."""
        if self._device_us is None or self.latest is None:
            return None
        device_us = raw_us + self._turned_us
        steps = np.diff(device_us, prepend=self._device_us)
        counted = np.diff(frames.counter.astype(np.int64), prepend=self._sent_counter)
        if steps.min() <= 0 or steps.max() > self._usual_us or not np.all((counted == 1) | (counted == 1 - _TURN)):
            return None
        axis_us = device_us + self._shift_us
        if axis_us[0] <= self.latest.axis_us or not self._can_be(int(axis_us[-1]), host_s):
            return None
        counter = self.latest.counter + 1 + np.arange(len(frames))
        self._device_us, self._sent_counter = int(device_us[-1]), int(frames.counter[-1])
        self.latest = Latest(int(axis_us[-1]), int(counter[-1]), host_s)
        self._note(raw_us, frames, steps)
        self._fit.add(1e-6 * axis_us.astype(np.float64), np.full(len(axis_us), host_s))
        return placed_at(frames, axis_us, counter)

    def _can_be(self, axis_us: int, host_s: float) -> bool:
        """Whether a sample of that time can be there already."""
        if self._fit.is_settled:
            now_s = float(self._fit.device_of(host_s))
            return 1e-6 * axis_us <= now_s + _AHEAD_S + 5.0 * float(self._fit.sigma_s_at(now_s))
        if self.latest is None:
            return True
        return 1e-6 * (axis_us - self.latest.axis_us) <= max(host_s - self.latest.host_s, 0.0) + _AHEAD_AT_FIRST_S

    # --- sample by sample, where anything is odd

    def _carefully(self, raw_us: Whole, frames: Frames, host_s: float, events: Events) -> Frames:
        seen_before = self._seen_before(raw_us, frames)
        raw, sent = raw_us.tolist(), frames.counter.tolist()
        taken = _Taken()
        for row in range(len(raw)):
            verdict = _Verdict.REPEATED if seen_before[row] else self._verdict(raw, sent, row, host_s)
            if verdict is _Verdict.WAITS:
                self._waiting = rows_of(frames, slice(row, None))
                break
            if verdict is _Verdict.REPEATED:
                events.repeated += 1
            elif verdict is _Verdict.ABSURD:
                events.absurd += 1
            elif verdict is _Verdict.ANEW:
                self._tell_fit(taken, host_s)
                self._begin_anew(raw, row, sent[row], host_s, events, taken)
            else:
                self._go_on(raw[row] + self._turned_us, sent[row], host_s, events, taken)
            if verdict in (_Verdict.ANEW, _Verdict.GOES_ON):
                taken.rows.append(row)
        self._tell_fit(taken, host_s)
        rows = np.array(taken.rows, np.int64)
        kept = rows_of(frames, rows)
        self._note(raw_us[rows], kept, np.array(taken.steps_us, np.int64))
        return placed_at(kept, np.array(taken.axis_us, np.int64), np.array(taken.counter, np.int64))

    def _verdict(self, raw: list[int], sent: list[int], row: int, host_s: float) -> _Verdict:
        if self._device_us is None or self.latest is None:
            return _confirmed(raw, row)
        time_us = raw[row] + self._turned_us
        step = time_us - self._device_us
        if step < -_LATE_US and step + _TURN > 0 and self._can_be(time_us + _TURN + self._shift_us, host_s):
            self._turned_us += _TURN
            return _Verdict.GOES_ON
        counted = (sent[row] - self._sent_counter) % _TURN
        if step == 0:  # a clock too coarse for its rate gives two samples one time
            return _Verdict.GOES_ON if counted == 1 else _Verdict.REPEATED
        if -_LATE_US <= step < 0:
            return _Verdict.REPEATED
        if step > 0 and self._can_be(time_us + self._shift_us, host_s):
            return _Verdict.GOES_ON
        return _confirmed(raw, row)

    def _go_on(self, device_us: int, sent: int, host_s: float, events: Events, taken: _Taken) -> None:
        """Place a sample of the clock as it runs."""
        assert self.latest is not None
        assert self._device_us is not None
        step = device_us - self._device_us
        axis_us = max(device_us + self._shift_us, self.latest.axis_us + 1)
        lost = self._lost(step, (sent - self._sent_counter) % _TURN)
        if lost:
            events.lost += lost
            events.holes.append(Hole(self.latest.axis_us, axis_us, "live_lost"))
        self._put(device_us, axis_us, sent, self.latest.counter + 1 + lost, host_s, taken)
        taken.steps_us.append(step)

    def _lost(self, step_us: int, counted: int) -> int:
        """Return how many samples are missing before one: by its counter, or its time where the counter tells nothing.

        A counter that leaps where time does not was set anew; one that goes on by one may be counted by us.
        """
        by_time = 0
        if self.period_us and step_us > self._usual_us:
            by_time = max(round(step_us / self.period_us) - 1, 0)
        if counted > 1 and (not self.period_us or counted - 1 <= 2.0 * step_us / self.period_us + 16.0):
            return counted - 1
        return by_time

    def _begin_anew(self, raw: list[int], row: int, sent: int, host_s: float, events: Events, taken: _Taken) -> None:
        """Let the axis go on with a clock that began anew: the host's clock bridges the pause.

        The newest sample of the new clock is now, the first one as much earlier as the device says.
        """
        newest = row
        while newest + 1 < len(raw) and 0 < raw[newest + 1] - raw[newest] <= _AGREE_US:
            newest += 1
        self._turned_us = 0
        if self.latest is None:
            self._shift_us = -raw[row]
            self._put(raw[row], 0, sent, 0, host_s, taken)
            return
        now_us = self.latest.axis_us + round(1e6 * max(host_s - self.latest.host_s, 0.0))
        if not self._fit.is_empty:
            now_us = round(1e6 * float(self._fit.device_of(host_s)))
        period_us = max(round(self.period_us), 1)
        axis_us = max(now_us - (raw[newest] - raw[row]), self.latest.axis_us + period_us)
        self._shift_us = axis_us - raw[row]
        if self._device_us is not None:
            events.restarts += 1
        events.holes.append(Hole(self.latest.axis_us, axis_us, RESTARTED))
        self._fit.begin_block()
        missing = round((axis_us - self.latest.axis_us) / period_us) if self.period_us else 1
        self._put(raw[row], axis_us, sent, self.latest.counter + max(missing, 1), host_s, taken)

    def _put(self, device_us: int, axis_us: int, sent: int, counter: int, host_s: float, taken: _Taken) -> None:
        self._device_us, self._sent_counter = device_us, sent
        self.latest = Latest(axis_us, counter, host_s)
        taken.axis_us.append(axis_us)
        taken.counter.append(counter)

    def _tell_fit(self, taken: _Taken, host_s: float) -> None:
        axis_s = 1e-6 * np.array(taken.axis_us[taken.fitted :], np.float64)
        self._fit.add(axis_s, np.full(len(axis_s), host_s))
        taken.fitted = len(taken.axis_us)

    # --- what is remembered

    def _seen_before(self, raw_us: Whole, frames: Frames) -> list[bool]:
        """Return which samples are, to the last bit, one of the last four thousand, or an earlier one of their own."""
        times = np.concatenate([*(times for times, _ in self._seen), raw_us])
        parts = [*(part for _, part in self._seen), frames]
        acc = np.concatenate([part.acc_s_mps2 for part in parts])
        gyr = np.concatenate([part.gyr_s_radps for part in parts])
        values = np.stack([acc, gyr])
        order = np.argsort(times, kind="stable")
        same = (np.diff(times[order]) == 0) & np.all(values[:, order[1:]] == values[:, order[:-1]], axis=(0, 2))
        seen = np.zeros(len(times), np.bool_)
        seen[order[1:][same]] = True
        found: list[bool] = seen[len(times) - len(raw_us) :].tolist()
        return found

    def _note(self, raw_us: Whole, frames: Frames, steps_us: Whole) -> None:
        self._seen.append((raw_us, frames))
        self._seen_rows += len(raw_us)
        while self._seen_rows - len(self._seen[0][0]) >= _MEMORY:
            self._seen_rows -= len(self._seen.popleft()[0])
        self._new_steps.append(steps_us)
        self._new_rows += len(steps_us)
        if self._new_rows < _LOOK_EVERY and (len(self._steps) >= _LOOK_EVERY or not self._new_rows):
            return
        self._steps = np.concatenate([self._steps, *self._new_steps])[-_STEPS:]
        self._new_steps, self._new_rows = [], 0
        self.period_us = float(self._steps.mean() if self._steps.min() <= 0 else np.median(self._steps))
        self._usual_us = 1.5 * float(np.percentile(self._steps, 95.0))


def _confirmed(raw: list[int], row: int) -> _Verdict:
    """Return whether the samples from this one on are of a clock that began anew, or this one's time is damaged."""
    ahead = raw[row : row + _CONFIRMED_BY]
    for before, after in pairwise(ahead):
        if not 0 <= after - before <= _AGREE_US:
            return _Verdict.ABSURD
    return _Verdict.ANEW if len(ahead) == _CONFIRMED_BY else _Verdict.WAITS
