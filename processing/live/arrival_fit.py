"""Fits the line between a device's clock and the host's from when its data arrived, though every arrival may be late.

A message can be late by any amount, never early: of many arrivals the earliest tell the clock, the others the way. So
each window of device time keeps its earliest arrival (Paxson 1998, *On calibrating measurements of packet transit
times*, §4: "de-noising" by the minima of segments; NTP's clock filter, RFC 5905 §10, does the same with eight) and a
straight line is laid through these by least squares, without those that lie far off: a stall as long as a window. What
is left above the line's foot is that of a minimum, whose mean lies one standard deviation above its least value.

What no one-way measurement can tell is the delay that every message has: ``delay_sigma_s`` stands for it.
"""

from dataclasses import dataclass

import numpy as np

from processing.clock_fit import wander_s
from processing.live.robust_line import Whole, robust_line
from processing.survey import FloatArray

PRIOR_PPM = 300.0  # 1 sigma of a drift that nobody has measured yet
_LAID_ANEW = 100  # the line is laid anew for each hundredth more windows
_YOUNG = 10  # windows of a block, below which each counts
_MOST_GATHERED = 512  # chunks of one window; of more than that the late ones are of no use
_WANDER_BLOCKS_SPAN = 16  # windows at least, before a course in the residuals is looked for


@dataclass(frozen=True)
class _Line:
    """``host − device − reference = offsets_s[block] + slope · (device − reference)``."""

    offsets_s: dict[int, float]  # by block
    slope: float
    slope_sigma: float
    offset_sigma_s: float  # at middle_s
    middle_s: float
    scatter_s: float


class ArrivalFit:
    """The line ``host = device + offset + drift · device``, from chunks of arrivals as they come.

    Memory is bounded (``most_windows``: when they are full, neighbours are joined and windows are twice as long), and a
    chunk costs the same after twelve hours as at the beginning. The line is laid anew at most once a window.

    Args:
        one_sided: arrivals are late, never early. False: times that err either way, such as a sound card's: the
            middle of each window is taken, not the earliest.
        delay_sigma_s: 1 sigma of what every message is late by.
        window_s: device seconds in a window, at first.
        most_windows: that are kept.
        memory_s: what is older is forgotten; None keeps all.
        prior_ppm: 1 sigma of the drift before anything arrived.
    """

    def __init__(
        self,
        *,
        one_sided: bool = True,
        delay_sigma_s: float = 0.002,
        window_s: float = 1.0,
        most_windows: int = 1024,
        memory_s: float | None = None,
        prior_ppm: float = PRIOR_PPM,
    ) -> None:
        self._one_sided, self._delay_sigma_s = one_sided, delay_sigma_s
        self._window_s, self._most, self._memory_s = window_s, most_windows, memory_s
        self._prior = prior_ppm * 1e-6
        self._device_s: FloatArray = np.empty(most_windows)
        self._delay_s: FloatArray = np.empty(most_windows)
        self._late2_s2: FloatArray = np.empty(most_windows)  # mean square above the window's earliest
        self._block: Whole = np.empty(most_windows, np.int64)
        self._count = 0
        self._open: list[FloatArray] = []  # pairs (device, delay) of the window under way
        self._open_index = -1
        self._now = 0  # block
        self._begins: dict[int, tuple[float, float]] = {}  # block: device and host time at its beginning
        self._reference: tuple[float, float] | None = None
        self._slope = 0.0  # of the last line: what arrivals within a window are compared along
        self._line: _Line | None = None
        self._closed = self._laid_at = 0  # windows so far, and when the line was laid
        self._in_block = 0  # of the block now

    # --- what comes in

    def add(self, device_s: FloatArray, host_s: FloatArray) -> None:
        """Take arrivals (n,): device time, never falling, and the host time at which each was there."""
        device_s, host_s = np.asarray(device_s, np.float64), np.asarray(host_s, np.float64)
        if not len(device_s):
            return
        if self._reference is None:
            self._reference = float(device_s[0]), float(host_s[0])
        device_s, host_s = device_s - self._reference[0], host_s - self._reference[1]
        if self._now not in self._begins:
            self._begins[self._now] = float(device_s[0]), float(host_s.min())
            self._line = None
        pairs = np.array([device_s, host_s - device_s]).T
        at = 0
        while at < len(pairs):
            if int(device_s[at] // self._window_s) != self._open_index:
                self._close()  # which may make the windows longer
                self._open_index = int(device_s[at] // self._window_s)
            end = int(np.searchsorted(device_s, (self._open_index + 1) * self._window_s))
            end = max(end, at + 1)
            self._gather(pairs[at:end])
            at = end

    def _gather(self, pairs: FloatArray) -> None:
        self._open.append(pairs)
        if len(self._open) > _MOST_GATHERED:
            self._open = [self._condensed(np.concatenate(self._open))]

    def begin_block(self) -> None:
        """Let what follows lie beside what was before: the device's clock was set anew, and only about rightly."""
        self._close()
        self._open_index = -1
        if self._now in self._begins:
            self._now += 1
            self._in_block = 0

    # --- what is known

    @property
    def is_settled(self) -> bool:
        """Whether enough has arrived since the clock was last set to tell what is impossible."""
        return self._in_block >= 3

    @property
    def is_empty(self) -> bool:
        """Whether nothing has arrived yet."""
        return self._reference is None

    @property
    def drift_ppm(self) -> float:
        """By how much the device's clock is fast, in parts per million of the host's."""
        return -1e6 * self._fitted().slope / (1.0 + self._fitted().slope)

    @property
    def drift_sigma_ppm(self) -> float:
        """One sigma of it."""
        return 1e6 * self._fitted().slope_sigma

    @property
    def scatter_s(self) -> float:
        """The standard deviation of the windows about the line."""
        return self._fitted().scatter_s

    @property
    def jitter_s(self) -> float:
        """By how much arrivals are late (one-sided) or off: the root mean square of a usual window."""
        mean_squares = self._late2_s2[: self._count]
        if not self._count:
            mean_squares = np.array([self._point()[2]]) if self._open else np.zeros(1)
        return float(np.sqrt(np.median(mean_squares)))

    def host_of(self, device_s: FloatArray | float) -> FloatArray:
        """Return the host times of device times; raises ValueError before the first arrival."""
        reference, line = self._known(), self._fitted()
        at = np.asarray(device_s, np.float64) - reference[0]
        return np.asarray(reference[1] + at * (1.0 + line.slope) + self._offset(line, at, 0), np.float64)

    def device_of(self, host_s: FloatArray | float) -> FloatArray:
        """Return the device times of host times; raises ValueError before the first arrival."""
        reference, line = self._known(), self._fitted()
        at = np.asarray(host_s, np.float64) - reference[1]
        return np.asarray(reference[0] + (at - self._offset(line, at, 1)) / (1.0 + line.slope), np.float64)

    def sigma_s_at(self, device_s: FloatArray | float) -> FloatArray:
        """Return one sigma in seconds of the line at device times; raises ValueError before the first arrival."""
        reference, line = self._known(), self._fitted()
        away = np.asarray(device_s, np.float64) - reference[0] - line.middle_s
        return np.asarray(np.hypot(line.offset_sigma_s, line.slope_sigma * away), np.float64)

    # --- inside

    def _known(self) -> tuple[float, float]:
        if self._reference is None:
            raise ValueError("nothing has arrived yet")
        return self._reference

    def _offset(self, line: _Line, at: FloatArray, clock: int) -> FloatArray:
        """Return the offset of the block in which moments lie, on the device's (0) or the host's clock (1)."""
        blocks = sorted(line.offsets_s)
        if len(blocks) == 1:
            return np.asarray(line.offsets_s[blocks[0]])
        begins = np.array([self._begins[block][clock] for block in blocks])
        which = np.clip(np.searchsorted(begins, at, side="right") - 1, 0, len(blocks) - 1)
        return np.array([line.offsets_s[block] for block in blocks])[which]

    def _condensed(self, pairs: FloatArray) -> FloatArray:
        if not self._one_sided:
            return pairs[-256:]
        return pairs[[int(np.argmin(pairs[:, 1] - self._slope * pairs[:, 0]))]]

    def _point(self) -> tuple[float, float, float]:
        """Return what stands for the window under way: device time, delay, mean square of the others about it."""
        pairs = np.concatenate(self._open)
        along = pairs[:, 1] - self._slope * pairs[:, 0]
        if self._one_sided:
            at = int(np.argmin(along))
            device_s, own = float(pairs[at, 0]), float(along[at])
        else:
            device_s, own = float(pairs[:, 0].mean()), float(np.median(along))
        return device_s, own + self._slope * device_s, float(np.mean((along - own) ** 2))

    def _close(self) -> None:
        if not self._open:
            return
        if self._count == self._most:
            self._make_room()
        at = self._count
        self._device_s[at], self._delay_s[at], self._late2_s2[at] = self._point()
        self._block[at] = self._now
        self._count += 1
        self._closed += 1
        self._in_block += 1
        self._open = []
        if self._memory_s is not None:
            oldest = self._device_s[at] - self._memory_s
            self._keep(slice(int(np.searchsorted(self._device_s[: self._count], oldest)), self._count))

    def _make_room(self) -> None:
        """Join neighbouring windows of one block; where blocks are too short for that, forget the oldest half."""
        self._slope = self._fitted().slope
        self._window_s *= 2.0
        index = np.floor(self._device_s[: self._count] / self._window_s).astype(np.int64)
        along = self._delay_s[: self._count] - self._slope * self._device_s[: self._count]
        block = self._block[: self._count]
        order = np.lexsort((along, index, block))
        is_first = np.ones(self._count, np.bool_)
        is_first[1:] = (np.diff(index[order]) != 0) | (np.diff(block[order]) != 0)
        starts = np.flatnonzero(is_first)
        if len(starts) > 0.75 * self._count:
            self._window_s /= 2.0
            self._keep(slice(self._count // 2, self._count))
            return
        sizes = np.diff(starts, append=self._count)
        mean_device_s = np.add.reduceat(self._device_s[order], starts) / sizes
        mean_along = np.add.reduceat(along[order], starts) / sizes
        late2 = np.add.reduceat(self._late2_s2[order], starts) / sizes
        kept = order[starts]
        device_s = self._device_s[kept] if self._one_sided else mean_device_s
        own = along[kept] if self._one_sided else mean_along
        self._block[: len(kept)] = block[kept]
        self._count = len(kept)
        self._device_s[: self._count], self._late2_s2[: self._count] = device_s, late2
        self._delay_s[: self._count] = own + self._slope * device_s

    def _keep(self, part: slice) -> None:
        if part.start == 0:
            return
        kept = part.stop - part.start
        for array in (self._device_s, self._delay_s, self._late2_s2, self._block):
            array[:kept] = array[part].copy()
        self._count = kept
        present = {*self._block[:kept].tolist(), self._now}
        if present != set(self._begins):
            self._begins = {block: at for block, at in self._begins.items() if block in present}
            self._line = None

    def _fitted(self) -> _Line:
        fresh = self._closed - self._laid_at
        is_young = self._in_block < _YOUNG and (fresh or self._count < 3)
        if self._line is None or is_young or fresh > self._count // _LAID_ANEW:
            self._line = self._laid()
            self._laid_at = self._closed
            self._slope = self._line.slope
        return self._line

    def _laid(self) -> _Line:
        """Lay the line: one slope, and an offset for each block."""
        x, y = self._device_s[: self._count], self._delay_s[: self._count]
        block = self._block[: self._count]
        if self._open and (len(x) < 3 or block[-1] != self._now):
            point = self._point()
            x, y, block = np.append(x, point[0]), np.append(y, point[1]), np.append(block, self._now)
        if not len(x):
            return _Line({self._now: 0.0}, 0.0, self._prior, self._delay_sigma_s, 0.0, 0.0)
        names, which = np.unique(block, return_inverse=True)
        slope, offsets, near, scatter = robust_line(x, y, which, self._prior)
        residual = y - offsets[which] - slope * x
        middle, span = float(x[near].mean()), float(np.ptp(x[near]))
        centred = x - (np.bincount(which, x * near) / np.maximum(np.bincount(which, near), 1))[which]
        spread = float(np.sum(centred[near] ** 2))
        wander = 0.0
        if np.count_nonzero(near) >= _WANDER_BLOCKS_SPAN:
            wander = wander_s(x[near], residual[near], scatter)
        slope_sigma = float(scatter / np.sqrt(spread + (scatter / self._prior) ** 2))
        slope_sigma = float(np.hypot(slope_sigma, wander * np.sqrt(3.0) / max(span, self._window_s)))
        fine = float(np.sqrt(max(scatter**2 - wander**2, 0.0)))
        foot = fine if self._one_sided and len(x) >= 3 else 0.0
        doubts = (scatter / np.sqrt(np.count_nonzero(near)), 0.5 * fine, wander, self._delay_sigma_s)
        offset_sigma = float(np.sqrt(np.sum(np.square(doubts))))
        by_block = {int(name): float(offset) - foot for name, offset in zip(names, offsets, strict=True)}
        return _Line(by_block, slope, slope_sigma, offset_sigma, middle, scatter)
