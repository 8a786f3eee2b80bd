"""The import doctor's look at values: what is impossible, saturated, frozen, dead or missing, row by row."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.importing.raw import RawImu
from processing.importing.rows import BLOCK_ROWS, runs, thinned
from processing.importing.units import STANDARD_GRAVITY_MPS2
from processing.settings import ImportSettings
from processing.survey import BoolArray, Channel, Finding, FloatArray, Severity, Stretch

_AXES = "xyz"
_LEAST_RANGE = {"gyr": float(np.radians(120.0)), "acc": 15.0}  # ±125 °/s and ±2 g are the smallest in use


@dataclass(frozen=True)
class Mask:
    """Rows (n,) that cannot be trusted, and why: a code of [findings], a reason of [reasons], the worst value."""

    rows: BoolArray
    code: str
    reason: str
    params: dict[str, str | float]


def find_unreadable(raw: RawImu) -> Mask:
    """Rows in which an axis of accelerometer or gyroscope is no finite number, or all six are exactly zero."""
    rows = np.zeros(len(raw), dtype=np.bool_)
    for start in range(0, len(raw), BLOCK_ROWS):
        part = slice(start, start + BLOCK_ROWS)
        acc, gyr = raw.acc[part], raw.gyr[part]
        rows[part] = ~(np.isfinite(acc).all(axis=1) & np.isfinite(gyr).all(axis=1))
        rows[part] |= ~(acc.any(axis=1) | gyr.any(axis=1))
    return Mask(rows, "rows_unreadable", "imu_unreadable", {})


def find_impossible(raw: RawImu, settings: ImportSettings) -> Mask:
    """Rows with values that no such sensor can give; they become NaN."""
    rows = np.zeros(len(raw), dtype=np.bool_)
    worst = {"gyr": 0.0, "acc": 0.0}
    for start in range(0, len(raw), BLOCK_ROWS):
        part = slice(start, start + BLOCK_ROWS)
        for name, limit in (("gyr", settings.gyr_limit_radps), ("acc", settings.acc_limit_mps2)):
            values = getattr(raw, name)[part]
            size = np.nan_to_num(np.abs(values), nan=0.0, posinf=0.0).max(axis=1, initial=0.0)
            bad = size > limit
            if bad.any():
                worst[name] = max(worst[name], float(size[bad].max()))
                values[bad] = np.nan
                rows[part] |= bad
    params: dict[str, str | float] = {"worst_dps": float(np.degrees(worst["gyr"])), "worst_mps2": worst["acc"]}
    return Mask(rows, "values_impossible", "imu_impossible", params)


def find_saturated(raw: RawImu) -> list[Mask]:
    """Per sensor, rows that stand flat at the extreme value of an axis: the sensor could not follow."""
    masks = []
    for name, reason in (("gyr", "imu_gyr_saturated"), ("acc", "imu_acc_saturated")):
        array = getattr(raw, name)
        rows = np.zeros(len(raw), dtype=np.bool_)
        axes, limit = "", 0.0
        for axis in range(3):
            for value in _flat_tops(array[:, axis], _LEAST_RANGE[name]):
                rows |= array[:, axis] == value
                axes += _AXES[axis] if _AXES[axis] not in axes else ""
                limit = max(limit, abs(value))
        shown = float(np.degrees(limit)) if name == "gyr" else limit
        masks.append(Mask(rows, f"{name}_saturated", reason, {"axes": axes, "limit": shown}))
    return masks


def _flat_tops(values: FloatArray, least_range: float) -> list[float]:
    """The extreme values at which (n,) values pile up in runs: exactly equal, and far out.

    Far from the middle of all values, or, where a device turns too fast for most of a run, beyond ``least_range``, the
    smallest range that such sensors have.
    """
    finite = values[np.isfinite(values)]
    if len(finite) < 50:
        return []
    low, high = float(finite.min()), float(finite.max())
    sample = thinned(finite)
    typical = float(np.sqrt(np.mean(np.square(sample - np.median(sample)))))
    found = []
    for value, near in ((high, high - 0.01 * (high - low)), (low, low + 0.01 * (high - low))):
        central = abs(value - float(np.median(sample))) < 1.5 * typical
        if high <= low or (central and abs(value) < least_range):
            continue
        at = finite == value
        piled = int(at.sum())
        close = int((finite >= near).sum() if value == high else (finite <= near).sum())
        tops = runs(at)
        longest = int(np.diff(tops, axis=1).max(initial=0))
        # a peak that is merely quantised holds its top for a sample or two, and its neighbours are as frequent
        if piled >= 5 and longest >= 3 and piled >= 0.6 * close and _is_alive(finite) and _is_steep(finite, tops):
            found.append(value)
    return found


def _is_steep(values: FloatArray, tops: npt.NDArray[np.intp]) -> bool:
    """True where the values run into their flat tops at speed, as clipped ones do; what comes to rest slows down."""
    before = tops[tops[:, 0] > 0, 0]
    if not len(before):
        return False
    entry = np.abs(values[before] - values[before - 1])
    usual = float(np.sqrt(np.mean(np.square(np.diff(thinned(values, 10**6))))))
    return float(np.median(entry)) > 0.1 * usual


def _is_alive(values: FloatArray) -> bool:
    """True where the values move about, so that a flat top is a clipped one and not a switch between two states."""
    return len(np.unique(values[:: max(len(values) // 5000, 1)])) > 20


def find_dead(raw: RawImu) -> tuple[list[Finding], bool]:
    """Return a finding per sensor with axes that never move though the others tremble; and whether one is dead."""
    findings: list[Finding] = []
    for name in ("acc", "gyr"):
        array = getattr(raw, name)
        still = [_constant(array[:, axis]) for axis in range(3)]
        if not any(still):
            continue
        other = raw.acc if name == "gyr" else raw.gyr
        live = [array[:, a] for a in range(3) if not still[a]] or [other[:, a] for a in range(3)]
        if any(_trembles(values) for values in live):
            axes = "".join(_AXES[a] for a in range(3) if still[a])
            findings.append(Finding(f"{name}_dead", Severity.MASKED, {"axes": axes}))
    return findings, bool(findings)


def _constant(values: FloatArray) -> bool:
    finite = values[np.isfinite(values)]
    return len(finite) > 1 and bool(finite.min() == finite.max())


def _trembles(values: FloatArray) -> bool:
    """True for a channel with the noise of a real sensor: fourth differences, which smooth motion does not have."""
    finite = values[np.isfinite(values)][:200_000]
    if len(finite) < 50:
        return False
    span = float(np.percentile(finite, 99) - np.percentile(finite, 1))
    return span > 0 and float(np.median(np.abs(np.diff(finite, 4)))) > 3e-4 * span


def find_frozen(raw: RawImu) -> Mask:
    """Rows in which all six values stay the same for half a second although the gyroscope says that it turns."""
    rows = np.zeros(len(raw), dtype=np.bool_)
    for start in range(0, max(len(raw) - 1, 0), BLOCK_ROWS):
        part = slice(start, min(start + BLOCK_ROWS, len(raw) - 1) + 1)
        acc, gyr = np.asarray(raw.acc[part]), np.asarray(raw.gyr[part])
        same = np.all(np.diff(acc, axis=0) == 0, axis=1) & np.all(np.diff(gyr, axis=0) == 0, axis=1)
        if same.any():
            rows[part][1:] |= same & (np.linalg.norm(gyr[1:], axis=1) > 0.05)
    frozen = np.zeros(len(raw), dtype=np.bool_)
    for first, end in runs(rows):
        if raw.time[end - 1] - raw.time[max(first - 1, 0)] >= 0.5:
            frozen[first:end] = True
    return Mask(frozen, "imu_frozen", "imu_frozen", {})


def find_rest_gravity(time: FloatArray, acc: FloatArray, gyr: FloatArray, settings: ImportSettings) -> list[Finding]:
    """Return a warning where the specific force at rest is not gravity's: a wrong scale or offset."""
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    rows = max(round(0.5 / step), 8) if step > 0 else 0
    if not rows or len(time) < 4 * rows:
        return []
    count = min(len(time) // rows, 4000)
    picked = np.linspace(0, len(time) - rows, count).astype(np.intp)
    turning = np.array([float(np.abs(gyr[i : i + rows]).max()) for i in picked])
    shaking = np.array([float(np.std(acc[i : i + rows], axis=0).max()) for i in picked])
    still = (turning < np.radians(8.0)) & (shaking < 0.15)
    if still.sum() < 4:
        return []
    norms = np.array([float(np.linalg.norm(acc[i : i + rows].mean(axis=0))) for i in picked[still]])
    rest = float(np.median(norms))
    off_pct = 100.0 * (rest / STANDARD_GRAVITY_MPS2 - 1.0)
    if abs(off_pct) <= settings.rest_gravity_pct:
        return []
    return [Finding("rest_gravity_off", Severity.WARNING, {"rest_mps2": rest, "off_pct": off_pct})]


def stretches_of(mask: Mask, time: FloatArray, settings: ImportSettings) -> tuple[list[Finding], list[Stretch]]:
    """Return what a mask says: how many rows, where first, and the spans that are too long to be bridged."""
    spans = runs(mask.rows)
    if not len(spans):
        return [], []
    starts = time[np.maximum(spans[:, 0] - 1, 0)]
    ends = time[np.minimum(spans[:, 1], len(time) - 1)]
    long = ends - starts > settings.short_hole_s
    stretches = [Stretch(float(a), float(b), Channel.PATH, mask.reason) for a, b in zip(starts[long], ends[long])]
    params = {
        **mask.params,
        "count": int(mask.rows.sum()),
        "first_s": float(time[spans[0][0]]),
        "masked_s": sum(s.end_s - s.start_s for s in stretches),
    }
    severity = Severity.MASKED if stretches else Severity.REPAIRED
    return [Finding(mask.code, severity, params)], stretches


def fill(array: FloatArray, time: FloatArray, bad: BoolArray) -> None:
    """Give the ``bad`` rows of (n, k) or (n,) finite values: straight lines over holes, held at the ends."""
    spans = runs(bad)
    if len(spans) > 10_000:
        columns = [array] if array.ndim == 1 else [array[:, k] for k in range(array.shape[1])]
        for column in columns:
            column[bad] = np.interp(time[bad], time[~bad], column[~bad])
        return
    for first, end in spans:
        if first == 0 and end == len(array):
            array[:] = 0.0
        elif first == 0:
            array[:end] = array[end]
        elif end == len(array):
            array[first:] = array[first - 1]
        else:
            weight = (time[first:end] - time[first - 1]) / (time[end] - time[first - 1])
            weight = weight if array.ndim == 1 else weight[:, None]
            array[first:end] = array[first - 1] + weight * (array[end] - array[first - 1])
