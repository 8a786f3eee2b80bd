"""Makes blocks on one unbroken axis of frames from what callbacks brought, and says how many frames are missing.

Three things can be missing. What found no room because the worker was too far behind: counted to the frame. What the
system dropped before we got it, flagged or not: told by the times of the blocks (:class:`SoundTimeline`). What was
never digitised while the device was gone: told by the host's clock.
"""

import math
from typing import NamedTuple

import numpy as np

from app.devices.audio_stream import Chunk
from processing.live.sound_timeline import SoundTimeline
from processing.live.stream import SoundBlock

_SETTLE_S = 0.5  # of sound; the first times that a device tells after it was opened are off by 12 ms
_CONFIRMED_S = (
    20.0  # a loss that nobody flagged is rare, a busy computer is not: better late than silence put in for it
)
_MOST_AGE_S = 600.0  # servers keep this much for a program that stood still; more is no age
_AT_ONCE_S = 0.001

LOST, BEHIND, OVERFLOW, UNTOLD = "sound_input_lost", "sound_behind", "sound_overflow", "sound_untold"


class _Time(NamedTuple):
    """When a chunk's first frame was digitised."""

    host_s: float
    is_told: bool  # by the system, not by when it came
    counts: bool  # for the clock


class Placing:
    """Takes the chunks of all openings in turn. Only for the worker's thread, but for the counts."""

    def __init__(self, rate_hz: float, channels: int) -> None:
        self.timeline = SoundTimeline(rate_hz, confirmed_s=_CONFIRMED_S)
        self._rate_hz, self._channels = rate_hz, channels
        self.came = self.lost = self.gaps = 0
        self._opening = 0
        self._next = 0  # of the opening
        self._held: list[tuple[Chunk, _Time]] = []  # of an opening that has just begun, with their times
        self._last: tuple[Chunk, _Time] | None = None

    def blocks(self, chunk: Chunk) -> list[SoundBlock]:
        """Return the blocks that can be placed now; the first half second after a gap waits for its times."""
        ready = []
        if chunk.opening != self._opening:
            ready += self.rest()
            is_again, self._opening, self._next = self._opening > 0, chunk.opening, 0
            self._last = None
            time = self._digitised(chunk)
            if is_again:
                self._held = [(chunk, time)]
                return ready
        else:
            time = self._digitised(chunk)
        if not self._held:
            return [*ready, self._placed(chunk, time)]
        self._held.append((chunk, time))
        if sum(held.frames for held, _ in self._held) >= _SETTLE_S * self._rate_hz:
            ready += self.rest()
        return ready

    def rest(self) -> list[SoundBlock]:
        """Return the blocks that wait for more, which does not come."""
        held, self._held = self._held, []
        if not held:
            return []
        begun_s = float(np.median([time.host_s - chunk.first / self._rate_hz for chunk, time in held if time.counts]))
        (first, time), *others = held
        first_time = time._replace(host_s=begun_s + first.first / self._rate_hz)
        blocks = [self._placed(first, first_time, is_reopened=True)]
        return blocks + [self._placed(chunk, time) for chunk, time in others]

    @property
    def waiting_frames(self) -> int:
        """How many frames wait for more."""
        return sum(chunk.frames for chunk, _ in self._held)

    def _placed(self, chunk: Chunk, time: _Time, is_reopened: bool = False) -> SoundBlock:
        behind = chunk.first - self._next if self._next or not is_reopened else 0
        self._next = chunk.first + chunk.frames
        if behind:
            self._skip(behind)
        adc_s = time.host_s if time.counts else math.nan
        lost = self.timeline.place(
            chunk.frames, adc_s, overflowed=chunk.is_after_overflow and not is_reopened, reopened=is_reopened
        )
        reason = LOST if is_reopened else OVERFLOW if chunk.is_after_overflow else UNTOLD
        if behind > lost:
            reason = BEHIND
        self.came += chunk.frames
        self.lost += lost + behind
        self.gaps += lost + behind > 0
        frames = np.frombuffer(chunk.data, np.int32).reshape(chunk.frames, self._channels)
        first_frame = self.timeline.frames - chunk.frames
        return SoundBlock(frames, first_frame, time.host_s, lost + behind, reason if lost + behind else "")

    def _skip(self, frames: int) -> None:
        self.timeline.frames += frames
        self.timeline.lost_frames += frames

    def _digitised(self, chunk: Chunk) -> _Time:
        """Return when the first frame was digitised.

        What came at once with the chunk before is timed by that: PortAudio cuts what it finds into blocks, and the age
        that it tells of the second is wrong behind a sound server, where that of the first is right to 0.1 ms. Where no
        age is told, a chunk is taken to be as old as it is long; one of several that had waited tells nothing then.
        """
        is_told = 0.0 < chunk.age_s < _MOST_AGE_S
        time = _Time(chunk.host_s - (chunk.age_s if is_told else chunk.frames / self._rate_hz), is_told, True)
        if self._last is not None:
            before, of_before = self._last
            is_next = before.first + before.frames == chunk.first and not chunk.is_after_overflow
            if is_next and chunk.host_s - before.host_s < max(_AT_ONCE_S, 0.25 * before.frames / self._rate_hz):
                if of_before.is_told:
                    time = _Time(of_before.host_s + before.frames / self._rate_hz, True, True)
                else:
                    time = _Time(time.host_s, False, False)
        self._last = chunk, time
        return time
