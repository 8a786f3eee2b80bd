"""The import doctor's look at what a log may hold besides: magnetometer, the device's own quaternion, slow channels."""

import numpy as np

from processing.importing.doctor_values import fill
from processing.importing.raw import RawImu
from processing.importing.rows import BLOCK_ROWS, thinned
from processing.importing.units import AUTO
from processing.survey import BoolArray, Finding, FloatArray, Severity

_FIELD_UT = (10.0, 600.0)  # earth's field is 22–67 µT; iron nearby adds to it
_ABSURD_UT = 1e8
_SIZES = (("ut", 1.0), ("gauss", 100.0), ("nt", 1e-3), ("mgauss", 0.1))


def settle_mag(raw: RawImu) -> tuple[FloatArray | None, list[Finding]]:
    """Return ``raw.mag`` in µT without holes, or None where there is no living magnetometer, and what was found."""
    if raw.mag is None:
        return None, [Finding("mag_absent", Severity.INFO)]
    bad = _absurd_rows(raw.mag)
    if bad.all():
        return None, [Finding("mag_absent", Severity.INFO)]
    findings = []
    fill(raw.mag, raw.time, bad)
    sample = thinned(raw.mag)
    if bool(np.all(sample.max(axis=0) == sample.min(axis=0))):
        return None, [Finding("mag_dead", Severity.WARNING)]
    size = float(np.median(np.linalg.norm(sample, axis=1)))
    if raw.mag_unit == "au":
        findings.append(Finding("mag_arbitrary", Severity.INFO))
    elif not _FIELD_UT[0] <= size <= _FIELD_UT[1]:
        fitting = [name for name, by in _SIZES if 15.0 <= size * by <= 120.0] if raw.mag_unit == AUTO else []
        if fitting:
            raw.mag *= dict(_SIZES)[fitting[0]]
        findings.append(Finding("mag_scaled" if fitting else "mag_odd", Severity.WARNING, {"median_ut": size}))
    dead = [axis for axis, low, high in zip("xyz", sample.min(axis=0), sample.max(axis=0)) if low == high]
    if dead:
        findings.append(Finding("mag_axis_dead", Severity.WARNING, {"axes": "".join(dead)}))
        return None, findings
    return raw.mag, findings


def _absurd_rows(values: FloatArray) -> BoolArray:
    """Rows (n,) of (n, 3) with a number that is none, or no field on earth."""
    bad = np.zeros(len(values), dtype=np.bool_)
    for start in range(0, len(values), BLOCK_ROWS):
        part = slice(start, start + BLOCK_ROWS)
        bad[part] = ~(np.abs(values[part]) < _ABSURD_UT).all(axis=1)
    return bad


def settle_quat(raw: RawImu) -> tuple[FloatArray | None, list[Finding]]:
    """Return unit quaternions (n, 4), rows that are none held from before, or None where most are none."""
    if raw.quat is None:
        return None, []
    norm = np.linalg.norm(raw.quat, axis=1)
    bad = ~(np.abs(norm - 1.0) < 0.1)
    count = int(bad.sum())
    constant = bool(np.all(raw.quat[~bad] == raw.quat[int(np.argmin(bad))])) if count < len(bad) else True
    if count > 0.5 * len(bad) or (constant and len(bad) > 1):
        return None, [Finding("quat_unusable", Severity.WARNING, {"count": count, "total": len(bad)})]
    findings = []
    if count:
        first_s = float(raw.time[int(np.argmax(bad))])
        findings.append(Finding("quat_invalid", Severity.REPAIRED, {"count": count, "first_s": first_s}))
        source = np.maximum.accumulate(np.where(bad, 0, np.arange(len(bad))))
        source[: int(np.argmin(bad))] = int(np.argmin(bad))
        raw.quat[bad] = raw.quat[source[bad]]
    raw.quat /= np.linalg.norm(raw.quat, axis=1)[:, None]
    return raw.quat, findings


def settle_slow(values: FloatArray | None, time: FloatArray) -> FloatArray | None:
    """Return a slow channel (n,) without holes, None where it holds nothing."""
    if values is None:
        return None
    bad = ~np.isfinite(values)
    if bad.all():
        return None
    fill(values, time, bad)
    return values
