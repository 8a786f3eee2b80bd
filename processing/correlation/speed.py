"""The speed of sound measured on site: taps at known places, on one side or beyond both ends."""

import math
from dataclasses import dataclass

from processing.correlation.pipe import Pipe, delay_of_place
from processing.errors import ErrorCode, LeaklineError

_LEAST_PART = 0.1  # of the whole travel time: nearer to the middle a tap says nothing of the speed


@dataclass(frozen=True)
class Tap:
    """A tap whose delay was measured: ``from_a_m`` ≤ 0 is at or beyond A, ≥ the pipe's length at or beyond B."""

    from_a_m: float
    delay_s: float
    sigma_s: float
    place_sigma_m: float = 0.0


@dataclass(frozen=True)
class MeasuredSpeed:
    """All speeds are to be multiplied by ``factor``, ± ``part_sigma`` of itself; ``mean_mps`` is over the whole pipe.

    ``offset_s`` is to be added to :attr:`Sync.offset_s <processing.correlation.recordings.Sync>`; None where one tap
    cannot tell.
    """

    factor: float
    part_sigma: float
    mean_mps: float
    mean_sigma_mps: float
    offset_s: float | None = None
    offset_sigma_s: float | None = None


def speed_of_tap(pipe: Pipe, tap: Tap, clock_sigma_s: float = 0.0) -> MeasuredSpeed:
    """Return the speed that one tap tells: ``c = (d − 2p)/t``, for a tap beyond a sensor ``c = d/|t|``.

    Raises:
        LeaklineError: CORRELATION_TAP_MIDDLE near mid-span, CORRELATION_TAP_SIGN where the delay has the other sign.
    """
    expected_s, per_metre = _expected(pipe, tap)
    if abs(expected_s) < _LEAST_PART * pipe.travel_s:
        raise LeaklineError(ErrorCode.CORRELATION_TAP_MIDDLE, place_m=tap.from_a_m)
    if tap.delay_s * expected_s <= 0.0:
        raise LeaklineError(ErrorCode.CORRELATION_TAP_SIGN, delay_ms=1e3 * tap.delay_s, expected_ms=1e3 * expected_s)
    factor = expected_s / tap.delay_s
    lengths_s = _length_sigma_s(pipe)
    variance = (tap.sigma_s**2 + clock_sigma_s**2) / tap.delay_s**2
    variance += ((per_metre * tap.place_sigma_m) ** 2 + lengths_s**2) / expected_s**2
    return _measured(pipe, factor, math.sqrt(variance))


def speed_of_both_ends(pipe: Pipe, beyond_a: Tap, beyond_b: Tap) -> MeasuredSpeed:
    """Return speed and clock offset of taps beyond both ends: delays d/c + o and −d/c + o tell both.

    Raises:
        LeaklineError: CORRELATION_TAP_SIGN where the delays do not differ the right way round.
    """
    twice_s = beyond_a.delay_s - beyond_b.delay_s
    travel_s = pipe.travel_s
    if twice_s <= 0.0:
        raise LeaklineError(ErrorCode.CORRELATION_TAP_SIGN, delay_ms=500.0 * twice_s, expected_ms=1e3 * travel_s)
    sigma_s = math.hypot(beyond_a.sigma_s, beyond_b.sigma_s)
    part = math.hypot(sigma_s / twice_s, _length_sigma_s(pipe) / travel_s)
    # what both have too much is the clocks': B hears late by as much as its recording is taken to have begun too late
    offset_s = -0.5 * (beyond_a.delay_s + beyond_b.delay_s)
    measured = _measured(pipe, 2.0 * travel_s / twice_s, part)
    return MeasuredSpeed(
        measured.factor, measured.part_sigma, measured.mean_mps, measured.mean_sigma_mps, offset_s, 0.5 * sigma_s
    )


def _expected(pipe: Pipe, tap: Tap) -> tuple[float, float]:
    """Return the delay with the speeds as they stand, and how it changes with the tap's place, s/m."""
    place = min(max(tap.from_a_m, 0.0), pipe.length_m)
    if not 0.0 < tap.from_a_m < pipe.length_m:
        return delay_of_place(pipe, place), 0.0  # how far beyond does not matter
    step = 0.01 * pipe.length_m
    slope = (delay_of_place(pipe, place + step) - delay_of_place(pipe, place - step)) / (2.0 * step)
    return delay_of_place(pipe, place), slope


def _length_sigma_s(pipe: Pipe) -> float:
    return math.sqrt(sum((section.length_sigma_m / section.speed()[0]) ** 2 for section in pipe.sections))


def _measured(pipe: Pipe, factor: float, part: float) -> MeasuredSpeed:
    mean = factor * pipe.length_m / pipe.travel_s
    return MeasuredSpeed(factor, part, mean, part * mean)
