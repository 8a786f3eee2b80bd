"""The import doctor's look at time: unit, order, duplicates, restarts, gaps. Mends what is certain, tells the rest."""

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.bursts import is_bursty, rebuild
from processing.importing.raw import RawImu
from processing.importing.rows import keep_rows, reorder_rows, thinned
from processing.importing.time_stamps import (
    EPOCH_S,
    PLAUSIBLE_HZ,
    factor_of,
    mean_step,
    typical_step,
    unit_of_steps,
)
from processing.settings import ImportSettings
from processing.survey import BoolArray, Channel, Finding, FloatArray, Severity, Stretch

_RESTART_PAUSE_S = 1.0
_WILD_S = 86_400.0  # a day from the middle of the log: another run, or a clock that was set meanwhile
_LOOK_BACK_ROWS = 2_000_000
MIN_ROWS = 16


def settle_unit(raw: RawImu, place: Place | None) -> list[Finding]:
    """Bring ``raw.time`` to seconds, whatever it was written in.

    Raises:
        LeaklineError: SAMPLE_RATE_MISSING where there are only sample numbers and nobody told the rate.
    """
    if raw.time_unit == "auto":
        steps = np.diff(raw.time[np.isfinite(raw.time)])
        unit = None if len(steps) and np.all(steps == 1.0) else unit_of_steps(raw.time)
        if unit is not None:
            raw.time *= factor_of(unit)
            raw.time_unit = "s"
            return [Finding("time_unit_found", Severity.INFO, {"unit": unit, "rate_hz": 1.0 / mean_step(raw.time)})]
        raw.time_unit = "count"
    if raw.time_unit == "count":
        if raw.sample_rate_hz is None:
            raise LeaklineError(ErrorCode.SAMPLE_RATE_MISSING, place)
        raw.time = (raw.time - _first_finite(raw.time)) / raw.sample_rate_hz
        return [Finding("time_from_counter", Severity.INFO, {"rate_hz": raw.sample_rate_hz})]
    return _mend_scale(raw)


def _first_finite(values: FloatArray) -> float:
    finite = np.isfinite(values)
    return float(values[np.argmax(finite)]) if finite.any() else 0.0


def _mend_scale(raw: RawImu) -> list[Finding]:
    """Seconds that are milliseconds (or the other way round) give a rate that no IMU has."""
    step = mean_step(raw.time)
    if not step > 0 or PLAUSIBLE_HZ[0] <= 1.0 / step <= PLAUSIBLE_HZ[1]:
        return []
    for scale in (1e-3, 1e-6, 1e-9, 1e3, 1e6):
        if PLAUSIBLE_HZ[0] <= 1.0 / (step * scale) <= PLAUSIBLE_HZ[1]:
            raw.time *= scale
            rate = 1.0 / (step * scale)
            return [Finding("time_rescaled", Severity.REPAIRED, {"factor": scale, "rate_hz": rate})]
    return [Finding("rate_odd", Severity.WARNING, {"rate_hz": 1.0 / step})]


def settle_order(raw: RawImu, settings: ImportSettings) -> tuple[list[Finding], list[Stretch]]:
    """Make ``raw.time`` strictly increasing, from seconds in the order of the file."""
    findings: list[Finding] = []
    _drop_leading_zeros(raw, findings)
    _drop_timeless(raw, findings)
    _drop_wild(raw, findings)
    stretches = _join_restarts(raw, findings)
    _sort(raw, findings)
    if not raw.keep_origin and len(raw) and abs(raw.time[0]) > EPOCH_S:
        findings.append(Finding("time_from_first", Severity.INFO, {"origin_s": float(raw.time[0])}))
        raw.time -= raw.time[0]
    _drop_duplicates(raw, findings)
    if is_bursty(raw.time):
        rate, step = rebuild(raw, settings)
        params: dict[str, str | float] = {"rate_hz": rate, "median_step_ms": step * 1e3}
        findings.append(Finding("time_bursty", Severity.REPAIRED, params))
    _strictly_increasing(raw)
    return findings, stretches


def _drop_leading_zeros(raw: RawImu, findings: list[Finding]) -> None:
    head = slice(0, min(10, max(len(raw) - 1, 0)))
    zero = ~(raw.acc[head].any(axis=1) | raw.gyr[head].any(axis=1))
    count = int(np.argmin(np.append(zero, False)))
    # noise-free simulations of a free fall aside, an accelerometer never reads exactly zero on three axes
    if count and count < len(raw):
        keep = np.ones(len(raw), dtype=np.bool_)
        keep[:count] = False
        keep_rows(raw, keep)
        findings.append(Finding("first_rows_zero", Severity.REPAIRED, {"count": count}))


def _drop_timeless(raw: RawImu, findings: list[Finding]) -> None:
    good = np.isfinite(raw.time)
    if good.any():
        sample = thinned(raw.time)[thinned(good)]
        middle = float(np.median(sample if len(sample) else raw.time[good]))
        good &= (raw.time > middle - _WILD_S) & (raw.time < middle + _WILD_S)
    lost = int(len(good) - good.sum())
    if lost:
        first = int(np.argmin(good)) + 1
        findings.append(Finding("rows_without_time", Severity.REPAIRED, {"count": lost, "first_row": first}))
        keep_rows(raw, good)


def _drop_wild(raw: RawImu, findings: list[Finding]) -> None:
    """A single stamp far from both neighbours, which themselves agree, is a damaged number."""
    count, first = 0, 0.0
    for _ in range(3):
        time = raw.time
        step = typical_step(time)
        if len(time) < 3 or not step > 0:
            break
        far = max(1.0, 20.0 * step)
        steps = np.diff(time)
        leaps = np.nonzero((steps > far) | (steps < -far))[0]
        peaks = leaps[1:][np.diff(leaps) == 1]  # a leap there, and one back
        across = time[peaks + 1] - time[peaks - 1]
        wild = peaks[(across > 0) & (across < 5.0 * step)]
        if not len(wild):
            break
        first = float(time[wild[0] - 1]) if not count else first
        count += len(wild)
        keep = np.ones(len(time), dtype=np.bool_)
        keep[wild] = False
        keep_rows(raw, keep)
    if count:
        findings.append(Finding("time_wild", Severity.REPAIRED, {"count": count, "first_s": first}))


def _join_restarts(raw: RawImu, findings: list[Finding]) -> list[Stretch]:
    """Where time begins anew, count on after a pause of one second; the true pause is unknown, so it is masked."""
    time = raw.time
    step = typical_step(time)
    if not step > 0:
        return []
    falls = np.nonzero(np.diff(time) < -max(1.0, 100.0 * step))[0]
    stretches: list[Stretch] = []
    first_back = 0.0
    for number, fall in enumerate(falls):
        end = int(falls[number + 1]) + 1 if number + 1 < len(falls) else len(time)
        if _fills_a_hole(raw, int(fall), end, step):
            continue
        back = float(time[: fall + 1].max() - time[fall + 1])
        first_back = first_back or back
        time[fall + 1 :] += back + _RESTART_PAUSE_S
        at = float(time[fall + 1])
        stretches.append(Stretch(at - _RESTART_PAUSE_S, at, Channel.PATH, "imu_restart"))
    if stretches:
        params: dict[str, str | float] = {
            "count": len(stretches),
            "first_s": stretches[0].start_s,
            "back_s": first_back,
            "pause_s": _RESTART_PAUSE_S,
        }
        findings.append(Finding("time_restart", Severity.WARNING, params))
    return stretches


def _fills_a_hole(raw: RawImu, fall: int, end: int, step: float) -> bool:
    """True where the rows behind a fall are late packets or rows written twice, not those of a new start."""
    begin = max(fall + 1 - _LOOK_BACK_ROWS, 0)
    before, behind = raw.time[begin : fall + 1], raw.time[fall + 1 : end]
    behind = behind[behind <= before.max()]
    if not len(behind) or behind[0] < before[0]:
        return False
    order = np.argsort(before, kind="stable")
    at = np.clip(np.searchsorted(before[order], behind), 1, len(order) - 1)
    left, right = before[order[at - 1]], before[order[at]]
    nearest = np.where(behind - left < right - behind, order[at - 1], order[at])
    taken = np.abs(before[nearest] - behind) < 0.3 * step
    if np.mean(taken) < 0.5:
        return True
    twice = np.all(raw.acc[begin + nearest] == raw.acc[fall + 1 : fall + 1 + len(behind)], axis=1)
    return bool(np.mean(twice) > 0.9)


def _sort(raw: RawImu, findings: list[Finding]) -> None:
    late = np.diff(raw.time) < 0
    if not late.any():
        return
    tops = np.maximum.accumulate(raw.time)
    displaced = raw.time < tops
    first, last = int(np.argmax(displaced)), len(raw) - int(np.argmax(displaced[::-1]))
    start = int(np.searchsorted(tops, raw.time[first:last].min(), side="right"))
    start = min(start, first)
    order = np.argsort(raw.time[start:last], kind="stable")
    params: dict[str, str | float] = {"count": int(displaced.sum()), "first_s": float(raw.time[first])}
    reorder_rows(raw, start, order)
    findings.append(Finding("rows_out_of_order", Severity.REPAIRED, params))


def _drop_duplicates(raw: RawImu, findings: list[Finding]) -> None:
    """Rows that stand twice go; rows that differ but share a stamp go too, unless that is how this logger stamps."""
    same_time = np.concatenate([[False], np.diff(raw.time) == 0])
    if not same_time.any():
        return
    at = np.nonzero(same_time)[0]
    same = np.all(raw.acc[at] == raw.acc[at - 1], axis=1) & np.all(raw.gyr[at] == raw.gyr[at - 1], axis=1)
    same |= np.isnan(raw.acc[at]).any(axis=1) & np.isnan(raw.acc[at - 1]).any(axis=1)
    drop = np.zeros(len(raw), dtype=np.bool_)
    _note_drop(raw, drop, at[same], "duplicate_rows", findings)
    if not (~same).sum() > 0.2 * len(raw):
        _note_drop(raw, drop, at[~same], "duplicate_times", findings)
    keep_rows(raw, ~drop)


def _note_drop(raw: RawImu, drop: BoolArray, at: np.ndarray, code: str, findings: list[Finding]) -> None:
    if len(at):
        drop[at] = True
        findings.append(Finding(code, Severity.REPAIRED, {"count": len(at), "first_s": float(raw.time[at[0]])}))


def _strictly_increasing(raw: RawImu) -> None:
    """Equal stamps that are left (within the resolution of the number) would divide by zero downstream."""
    keep = np.concatenate([[True], np.diff(raw.time) > 0]) if len(raw) else np.empty(0, dtype=np.bool_)
    keep_rows(raw, keep)


def find_gaps(time: FloatArray, settings: ImportSettings) -> tuple[list[Finding], list[Stretch]]:
    """Return what is missing between the rows of (n,) increasing times; short holes only as a count."""
    steps = np.diff(time)
    step = typical_step(time)
    gaps = np.nonzero(steps > settings.gap_factor * step)[0]
    if not len(gaps):
        return [], []
    long = gaps[steps[gaps] > settings.short_hole_s]
    params: dict[str, str | float] = {
        "count": len(gaps),
        "first_s": float(time[gaps[0]]),
        "longest_s": float(steps[gaps].max()),
        "longest_at_s": float(time[gaps[np.argmax(steps[gaps])]]),
        "total_s": float(steps[gaps].sum()),
    }
    stretches = [Stretch(float(time[i]), float(time[i + 1]), Channel.PATH, "imu_gap") for i in long]
    if not stretches:
        return [Finding("gaps_short", Severity.REPAIRED, params)], []
    return [Finding("gaps", Severity.MASKED, params)], stretches


def find_two_rates(time: FloatArray) -> list[Finding]:
    """Return a warning where the first and a later part of the log were recorded at different rates."""
    parts = [p for p in np.array_split(np.diff(time), 24) if len(p) >= 20]
    steps = np.array([float(np.median(p)) for p in parts])
    if len(steps) < 4 or steps.min() <= 0:
        return []
    low, high = np.percentile(steps, [10, 90])
    if high < 1.2 * low:
        return []
    middle = np.sqrt(low * high)
    fast = steps < middle
    change = int(np.argmax(fast != fast[0]))
    start = sum(len(p) + 1 for p in parts[:change])
    params: dict[str, str | float] = {
        "first_hz": float(1.0 / np.median(steps[fast == fast[0]])),
        "other_hz": float(1.0 / np.median(steps[fast != fast[0]])),
        "at_s": float(time[min(start, len(time) - 1)]),
    }
    return [Finding("two_rates", Severity.WARNING, params)]
