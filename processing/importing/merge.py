"""Brings streams that were sampled on times of their own onto one time, by straight lines, never across a gap."""

from pathlib import Path

import numpy as np

from processing.importing.raw import GrowingArray, RawImu
from processing.importing.rows import BLOCK_ROWS, keep_rows
from processing.importing.time_stamps import typical_step
from processing.survey import Finding, FloatArray, Severity

SHORT_HOLE_S = 0.05
_GAP_STEPS = 3.0


def onto(time: FloatArray, source_time: FloatArray, values: FloatArray, scratch: Path | None = None) -> FloatArray:
    """Return ``values`` (m, k) at ``source_time`` (m,) interpolated to ``time`` (n,): (n, k).

    NaN before the first and behind the last sample, and inside holes longer than three steps (and 50 ms). Rows of the
    source that are out of order or not finite are left out.
    """
    good = np.isfinite(source_time) & np.isfinite(values).all(axis=1)
    source_time, values = source_time[good], values[good]
    if len(source_time) and np.any(np.diff(source_time) <= 0):
        source_time, first = np.unique(source_time, return_index=True)
        values = values[first]
    out = GrowingArray(values.shape[1], scratch)
    if len(source_time) < 2:
        out.append(np.full((len(time), values.shape[1]), np.nan))
        return out.finish()
    longest = max(_GAP_STEPS * typical_step(source_time), SHORT_HOLE_S)
    for start in range(0, len(time), BLOCK_ROWS):
        part = np.asarray(time[start : start + BLOCK_ROWS])
        block = np.column_stack([np.interp(part, source_time, column) for column in values.T])
        at = np.clip(np.searchsorted(source_time, part, side="right"), 1, len(source_time) - 1)
        in_gap = (source_time[at] - source_time[at - 1] > longest) & (part != source_time[at - 1])
        block[in_gap | ~(part >= source_time[0]) | ~(part <= source_time[-1])] = np.nan
        out.append(block)
    return out.finish()


def quaternions_onto(
    time: FloatArray, source_time: FloatArray, quat: FloatArray, scratch: Path | None = None
) -> FloatArray:
    """Return ``quat`` (m, 4) at ``time`` (n,), on the side of the one before; not quite unit between."""
    signs = np.ones(len(quat))
    with np.errstate(invalid="ignore"):
        signs[1:] = np.where(np.sum(quat[1:] * quat[:-1], axis=1) < 0, -1.0, 1.0)
    return onto(time, source_time, quat * np.cumprod(signs)[:, None], scratch)


def merge_acc(raw: RawImu, acc_time: FloatArray, acc: FloatArray, scratch: Path | None = None) -> None:
    """Give ``raw`` (with the gyroscope's times and turns) the accelerometer ``acc`` (m, 3) recorded at ``acc_time``.

    Rows that lie outside the accelerometer's time are left out; what was done is added to ``raw.findings``.
    """
    finite = raw.time[np.isfinite(raw.time)]
    acc_finite = acc_time[np.isfinite(acc_time)]
    same = len(raw.time) == len(acc_time) and np.array_equal(raw.time, acc_time, equal_nan=True)
    if same:
        raw.acc = acc
        return
    raw.acc = onto(raw.time, acc_time, acc, scratch)
    if not len(finite) or not len(acc_finite):
        return
    start, end = max(finite.min(), acc_finite.min()), min(finite.max(), acc_finite.max())
    total = max(finite.max(), acc_finite.max()) - min(finite.min(), acc_finite.min())
    rates = {"acc_hz": 1.0 / typical_step(acc_time), "gyr_hz": 1.0 / typical_step(raw.time)}
    raw.findings.append(Finding("streams_merged", Severity.INFO, rates))
    if end - start < 0.9 * total and total - (end - start) > 1.0:
        params: dict[str, str | float] = {"overlap_s": max(float(end - start), 0.0), "total_s": float(total)}
        raw.findings.append(Finding("streams_apart", Severity.WARNING, params))
    keep_rows(raw, (raw.time >= start) & (raw.time <= end))
