"""The axis that all views share: the monotone map between time and metres, and the ticks of either."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from PySide6.QtCore import QLocale

from processing.quantities import Places, Quantities
from processing.survey import FloatArray, Track
from widgets.plot_scale import linear_ticks, multiples, number_text, tick_digits

TIME_STEPS_S = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400)
METRIC = Quantities()


class AxisMode(StrEnum):
    """What the common axis counts."""

    TIME = "time"
    DISTANCE = "distance"


@dataclass(frozen=True)
class DistanceMap:
    """The monotone map between survey time and chainage: both arrays (m,), m ≥ 2, time rising, chainage never falling.

    While the device stands still one chainage belongs to a whole stretch of time; hence two inverses. Outside the
    track the device is taken to rest at its ends.
    """

    time_s: FloatArray
    chainage_m: FloatArray

    @classmethod
    def from_track(cls, track: Track | None) -> "DistanceMap | None":
        """Return the map of a track; None where there is no way to speak of: no track, one sample, no movement."""
        if track is None:
            return None
        good = np.isfinite(track.time_s) & np.isfinite(track.chainage_m)
        if np.count_nonzero(good) < 2:
            return None
        chainage = np.maximum.accumulate(track.chainage_m[good])
        if not chainage[-1] > chainage[0]:
            return None
        return cls(np.ascontiguousarray(track.time_s[good]), chainage)

    def chainage_at(self, time_s: FloatArray | float) -> FloatArray:
        """Return metres at survey seconds."""
        return np.asarray(np.interp(time_s, self.time_s, self.chainage_m), dtype=np.float64)

    def first_time_at(self, chainage_m: FloatArray | float) -> FloatArray:
        """Return when the device arrived at these metres."""
        return self._time_at(chainage_m, np.searchsorted(self.chainage_m, chainage_m, side="left"), last=False)

    def last_time_at(self, chainage_m: FloatArray | float) -> FloatArray:
        """Return when the device left these metres."""
        return self._time_at(chainage_m, np.searchsorted(self.chainage_m, chainage_m, side="right"), last=True)

    def _time_at(self, chainage_m: FloatArray | float, right: object, *, last: bool) -> FloatArray:
        metres = np.asarray(chainage_m, dtype=np.float64)
        after = np.clip(np.asarray(right), 1, len(self.chainage_m) - 1)
        before = after - 1
        c0, c1 = self.chainage_m[before], self.chainage_m[after]
        t0, t1 = self.time_s[before], self.time_s[after]
        rise = np.where(c1 > c0, c1 - c0, 1.0)
        # on a plateau at either end of the track there is nothing to interpolate: the end asked for is the answer
        part = np.where(c1 > c0, np.clip((metres - c0) / rise, 0.0, 1.0), 1.0 if last else 0.0)
        return np.asarray(t0 + part * (t1 - t0), dtype=np.float64)


def x_ticks(
    low: float, high: float, mode: AxisMode, most: int, write: Quantities = METRIC
) -> tuple[list[float], float]:
    """Return the ticks of the common axis and the step between them, in its own unit, seconds or metres.

    They stand at round minutes and hours, or at round metres or feet, as lengths are written.
    """
    span = high - low
    if mode is AxisMode.DISTANCE:
        shown, factor = linear_ticks(low * write.length_factor, high * write.length_factor, most), write.length_factor
        ticks = [tick / factor for tick in shown]
        return ticks, ticks[1] - ticks[0] if len(ticks) > 1 else span
    if span / max(most, 1) < TIME_STEPS_S[0]:
        ticks = linear_ticks(low, high, most)
        return ticks, ticks[1] - ticks[0] if len(ticks) > 1 else span
    step = next((s for s in TIME_STEPS_S if span / s <= most), TIME_STEPS_S[-1])
    return multiples(low, high, float(step)), float(step)


def time_text(time_s: float, step_s: float = 1.0, locale: QLocale | None = None) -> str:
    """Return survey time as people write it, ``m:ss`` or ``h:mm:ss``, with the decimals that ``step_s`` needs."""
    digits = tick_digits(step_s) if step_s < 1.0 else 0
    sign = "−" if time_s < -0.5 * 10.0**-digits else ""
    total = round(abs(time_s), digits)
    hours, rest = divmod(total, 3600.0)
    minutes, seconds = divmod(rest, 60.0)
    text = number_text(seconds, digits, locale).rjust(2 if digits == 0 else 3 + digits, "0")
    if hours >= 1.0:
        return f"{sign}{int(hours)}:{int(minutes):02d}:{text}"
    return f"{sign}{int(minutes)}:{text}"


def x_text(value: float, step: float, mode: AxisMode, locale: QLocale | None = None, write: Quantities = METRIC) -> str:
    """Return the label of a tick on the common axis; places along the pipe as they are written, without the unit."""
    if mode is AxisMode.DISTANCE:
        digits = tick_digits(step * write.length_factor * (1.0 + 1e-9))
        if write.places is Places.STATIONING:
            return write.place(value, digits)
        return number_text(value * write.length_factor, digits, locale)
    return time_text(value, step, locale)
