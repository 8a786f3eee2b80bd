"""Finds the device's time in what stands before the values of a printed line: a clock, a rising number, or nothing."""

from dataclasses import dataclass

import numpy as np

from processing.importing.printed_log import CLOCK, PLAIN
from processing.importing.time_stamps import DAY_S, factor_of, seconds_of_clock, unit_of_steps, unwrap
from processing.survey import FloatArray

_RISING = 0.75  # of the steps: a stamp that stands still for many lines places nothing


def may_hold_time(before: bytes) -> bool:
    """Whether something that could be a time stands there."""
    return bool(CLOCK.search(before) or PLAIN.match(before))


@dataclass(frozen=True)
class StampForm:
    """How the times of a stream are written; ``factor`` makes seconds of plain numbers, 0 where there is no time."""

    is_clock: bool = False
    factor: float = 0.0

    @property
    def has_time(self) -> bool:
        """Whether lines of this form hold a time."""
        return self.is_clock or self.factor > 0.0

    def seconds(self, before: list[bytes]) -> FloatArray:
        """Return the times (k,) in s, NaN where there is none; those of a clock without a date begin anew at midnight.

        Where the form has no time, all are 0.
        """
        if self.is_clock:
            return seconds_of_clock(np.array([m[1] if (m := CLOCK.search(b)) else b"" for b in before], dtype="S40"))
        if self.factor > 0.0:
            return self.factor * _plain(before)
        return np.zeros(len(before))


def form_of(before: list[bytes]) -> StampForm:
    """Return the form of what stands before the values in several lines of one stream."""
    clock = StampForm(is_clock=True)
    if all(CLOCK.search(text) for text in before):
        return clock if _is_rising(clock.seconds(before)) else StampForm()
    numbers = _plain(before)
    if not _is_rising(numbers):
        return StampForm()
    unit = next((m[2].decode().lower() for text in before if (m := PLAIN.match(text)) and m[2]), None)
    unit = unit or unit_of_steps(numbers)
    return StampForm(factor=factor_of(unit)) if unit else StampForm()


def without_midnights(time_s: FloatArray, last_s: float | None) -> FloatArray:
    """Return times (k,) of day that go on from ``last_s`` instead of beginning anew at midnight."""
    if last_s is None or not len(time_s) or np.nanmax(time_s, initial=0.0) > DAY_S:
        return time_s
    return unwrap(np.concatenate([[last_s], time_s]), DAY_S)[0][1:]


def _plain(before: list[bytes]) -> FloatArray:
    return np.array([float(m[1]) if (m := PLAIN.match(text)) else np.nan for text in before])


def _is_rising(times: FloatArray) -> bool:
    if len(times) < 2 or not np.isfinite(times).all():
        return False
    steps = np.diff(times)
    return bool((steps >= 0).all() and np.mean(steps > 0) >= _RISING)
