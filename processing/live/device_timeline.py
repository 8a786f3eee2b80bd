"""One axis of time for a recording's motion, from samples as they come: it never falls back, and pauses are pauses."""

from dataclasses import dataclass

import numpy as np

from processing.importing.frames import Frames
from processing.live.arrival_fit import ArrivalFit
from processing.live.device_clock import RESTARTED, DeviceClock, Events, Latest
from processing.live.paced_clock import PacedClock
from processing.survey import Channel, FloatArray, ImuSamples, Stretch


@dataclass(frozen=True)
class Placed:
    """Samples on the axis, and what was odd about them.

    ``holes`` are pauses in survey time; their reasons are keys of [reasons].
    """

    frames: Frames  # time_us strictly increasing, counter going on, host_s when they arrived
    lost: int = 0
    repeated: int = 0  # dropped: they were there already, or came too late to be put in order
    absurd: int = 0  # dropped: their time could not be
    restarted: bool = False
    gap_s: float = 0.0  # the longest pause before one of them
    holes: tuple[Stretch, ...] = ()


class DeviceTimeline:
    """Places a device's samples; survey time 0 is the first sample after :meth:`begin` (or at all).

    Not for several threads at once.
    """

    def __init__(self, delay_sigma_s: float = 0.002) -> None:
        self._fit = ArrivalFit(delay_sigma_s=delay_sigma_s)
        self._clock: DeviceClock | PacedClock | None = None
        self._origin_us: int | None = None

    @property
    def fit(self) -> ArrivalFit:
        """How the axis (in seconds, not yet survey time) relates to the host's clock."""
        return self._fit

    @property
    def clock_ppm(self) -> float | None:
        """By how much the device's clock is fast against the host's; None where it sends no time."""
        return self._fit.drift_ppm if isinstance(self._clock, DeviceClock) and self._fit.is_settled else None

    @property
    def clock_sigma_ppm(self) -> float | None:
        """One sigma of it."""
        return self._fit.drift_sigma_ppm if self.clock_ppm is not None else None

    @property
    def jitter_s(self) -> float | None:
        """By how much arrivals are late, root mean square; None before the first."""
        return None if self._fit.is_empty else self._fit.jitter_s

    @property
    def rate_hz(self) -> float | None:
        """Samples a second on the device's clock; None before that is known."""
        period_us = self._clock.period_us if self._clock is not None else 0.0
        return 1e6 / period_us if period_us > 0 else None

    def begin(self) -> None:
        """Let survey time begin with the next sample that is placed: a recording starts."""
        self._origin_us = None

    def place(self, frames: Frames, host_s: float, has_time: bool) -> Placed:
        """Return the samples on the axis; some may wait for the next chunk.

        Args:
            frames: as the device's decoder gave them; their times mean nothing where ``has_time`` is False.
            host_s: when they were there, host time.
            has_time: whether the device sends its time.
        """
        kind = DeviceClock if has_time else PacedClock
        latest = self._clock.latest if self._clock is not None else None
        if not isinstance(self._clock, kind):
            self._clock = kind(self._fit, latest)
        placed, events = self._clock.place(frames, host_s)
        if self._origin_us is None and len(placed):
            self._origin_us = int(placed.time_us[0])
            if latest is not None:
                _forget_before(placed, latest, events)
        return self._told(placed, events)

    def survey_s(self, host_s: float) -> tuple[float, float] | None:
        """Return survey time and its one sigma at a moment of the host's clock; None before the first sample.

        A bus that bundles in step with the samples hands the newest on at an age that never changes and nobody knows:
        anything up to one period, which is in the sigma.
        """
        if self._origin_us is None or self._fit.is_empty:
            return None
        axis_s = float(self._fit.device_of(host_s))
        of_age_s = 1e-6 * (self._clock.period_us if self._clock is not None else 0.0) / np.sqrt(12.0)
        return axis_s - 1e-6 * self._origin_us, float(np.hypot(self._fit.sigma_s_at(axis_s), of_age_s))

    def to_samples(self, frames: Frames) -> ImuSamples:
        """Return placed frames as samples on survey time; rows with a value that is no number are not valid."""
        acc, gyr = frames.acc_s_mps2.astype(np.float64), frames.gyr_s_radps.astype(np.float64)
        valid = np.isfinite(np.concatenate([acc, gyr], axis=1)).all(axis=1)
        acc[~valid], gyr[~valid] = 0.0, 0.0
        return ImuSamples(
            1e-6 * (frames.time_us.astype(np.int64) - (self._origin_us or 0)).astype(np.float64),
            acc,
            gyr,
            valid,
            mag_s_ut=_held(frames.mag_s_ut),
            quat_ws=_held(frames.quat_ws),
            pressure_kpa=_held(frames.pressure_kpa),
            temperature_c=_held(frames.temperature_c),
        )

    def _told(self, frames: Frames, events: Events) -> Placed:
        origin_us = self._origin_us or 0
        holes = tuple(
            Stretch(1e-6 * (h.start_us - origin_us), 1e-6 * (h.end_us - origin_us), Channel.PATH, h.reason)
            for h in events.holes
        )
        gap_s = max((h.end_s - h.start_s for h in holes), default=0.0)
        return Placed(frames, events.lost, events.repeated, events.absurd, events.restarts > 0, gap_s, holes)


def _forget_before(placed: Frames, latest: Latest, events: Events) -> None:
    """Take back what was odd before the first of ``placed``: a pause before a recording is none of its own."""
    earlier = [hole for hole in events.holes if hole.start_us < int(placed.time_us[0])]
    events.holes = [hole for hole in events.holes if hole not in earlier]
    restarts = sum(hole.reason == RESTARTED for hole in earlier)
    events.restarts -= restarts
    if not restarts:  # those say nothing of how many are missing
        events.lost -= min(events.lost, max(int(placed.counter[0]) - 1 - latest.counter, 0))


def _held(values: np.ndarray) -> FloatArray | None:
    """Return a channel with the last value where one is missing, as slower sensors send; None where there is none."""
    finite = np.isfinite(values) if values.ndim == 1 else np.isfinite(values).all(axis=1)
    if not finite.any():
        return None
    last = np.maximum.accumulate(np.where(finite, np.arange(len(values)), -1))
    last[last < 0] = int(np.argmax(finite))
    return np.asarray(values[last], np.float64)
