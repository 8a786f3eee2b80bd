"""From what loggers write as time to seconds: clocks, dates, counters that wrap, and units that nobody wrote down."""

import re
import warnings

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray

DAY_S = 86400.0
PLAUSIBLE_HZ = (4.0, 6000.0)
EPOCH_S = 1e8
_SAMPLED_ROWS = 1_200_000
_CLOCK = re.compile(
    rb"(?:(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})[T _])?(\d{1,2}):(\d{2})(?::(\d{2}(?:\.\d+)?))?"
    rb"(?:Z|T?([+-])(\d{2}):?(\d{2}))?$"
)
_UNITS = (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9))


def seconds_of_clock(texts: npt.NDArray[np.bytes_]) -> FloatArray:
    """Return seconds since midnight, or since 1970 where a date is written, of (n,) texts; NaN where unreadable."""
    clean = np.char.replace(np.char.replace(np.char.strip(texts), b" ", b"T"), b",", b".")
    fast = _fast_clock(clean)
    return fast if fast is not None else np.array([_one_clock(text) for text in clean.tolist()], dtype=np.float64)


def _fast_clock(texts: npt.NDArray[np.bytes_]) -> FloatArray | None:
    """numpy's own ISO reader, in C; None where it refuses a row."""
    if not len(texts):
        return np.empty(0)
    first = bytes(texts[0])
    prefix = b"" if b"T" in first else b"1970-01-01T"
    if re.search(rb"[Zz+]|T.*-", first) or b"/" in first or b"." in first.split(b"T")[0].split(b":")[0]:
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # of time zones, which the slow way reads
            stamps = np.char.add(prefix, texts).astype("U60").astype("datetime64[ns]")
    except (ValueError, UserWarning):
        return None
    if np.isnat(stamps).any():
        return None
    return np.asarray(stamps.astype(np.int64) / 1e9, dtype=np.float64)


def _one_clock(text: bytes) -> float:
    found = _CLOCK.match(text.replace(b" ", b"T"))
    if not found:
        return float("nan")
    year, month, day, hour, minute, second, sign, off_hour, off_minute = found.groups()
    seconds = int(hour) * 3600.0 + int(minute) * 60.0 + float(second or 0)
    if sign:
        seconds -= (1 if sign == b"+" else -1) * (int(off_hour) * 3600.0 + int(off_minute) * 60.0)
    if year:
        try:
            stamp = np.datetime64(f"{int(year):04d}-{int(month):02d}-{int(day):02d}", "s")
        except ValueError:
            return float("nan")
        seconds += float(stamp.astype(np.int64))
    return seconds


def unwrap(values: FloatArray, period: float) -> tuple[FloatArray, int]:
    """Return (n,) values with jumps of more than half a ``period`` taken as roll-overs, and how many there were."""
    good = np.isfinite(values)
    if good.sum() < 2:
        return values, 0
    steps = np.diff(values[good])
    turns = np.where(np.abs(steps) > period / 2, -np.round(steps / period), 0.0)
    if not turns.any():
        return values, 0
    out = np.array(values, dtype=np.float64)
    out[good] += period * np.concatenate([[0.0], np.cumsum(turns)])
    return out, int(np.abs(turns).sum())


def unwrap_counter(values: FloatArray) -> tuple[FloatArray, int]:
    """Return a counter without the roll-overs of 8, 16 or 32 bits: only where it falls from near the top to near 0."""
    good = values[np.isfinite(values)]
    if len(good) < 2 or good.min() < 0:
        return values, 0
    falls = np.nonzero(np.diff(good) < 0)[0]
    for bits in (8, 16, 32):
        period = float(2**bits)
        if good.max() >= period or not len(falls):
            continue
        edges = (good[falls] > 0.98 * period) & (good[falls + 1] < 0.02 * period)
        if edges.all():
            return unwrap(values, period)
    return values, 0


def sampled_steps(time: FloatArray, lag: int = 1) -> FloatArray:
    """Return the steps over ``lag`` rows of (n,) times, for statistics: of a long log those in 24 spread pieces."""
    pieces = [time]
    if len(time) > _SAMPLED_ROWS:
        size = _SAMPLED_ROWS // 24
        pieces = [time[s : s + size] for s in np.linspace(0, len(time) - size, 24).astype(int)]
    finite = [piece[np.isfinite(piece)] for piece in pieces]
    return np.concatenate([piece[lag:] - piece[:-lag] for piece in finite])


def typical_step(time: FloatArray) -> float:
    """The median of the positive steps of (n,) times; NaN where there is none."""
    steps = sampled_steps(time)
    steps = steps[steps > 0]
    return float(np.median(steps)) if len(steps) else float("nan")


def mean_step(time: FloatArray) -> float:
    """The mean of the steps, without those far above it: what bursts of equal stamps leave untouched."""
    steps = np.abs(sampled_steps(time))
    if not len(steps):
        return float("nan")
    for _ in range(3):
        limit = 50.0 * max(float(steps.mean()), np.finfo(float).tiny)
        steps = steps[steps <= limit]
    return float(steps.mean())


def unit_of_steps(time: FloatArray) -> str | None:
    """Return ``s``, ``ms``, ``us`` or ``ns``: the largest unit under which the rate is one that an IMU can have.

    The mean step decides, so that bursts of host stamps do not mislead; None where no unit fits.
    """
    step = mean_step(time)
    for unit, factor in _UNITS:
        if step > 0 and PLAUSIBLE_HZ[0] <= 1.0 / (step * factor) <= PLAUSIBLE_HZ[1]:
            return unit
    return None


def factor_of(unit: str) -> float:
    """Seconds in one ``unit`` of :func:`unit_of_steps`."""
    return dict(_UNITS)[unit]
