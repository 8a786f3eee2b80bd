"""The import doctor's look at units: g or m/s², °/s or rad/s, by size and by whether gyroscope and gravity agree.

While the device turns, gravity seen from the sensor turns the other way: ``du/dt = −ω × u`` for the unit vector ``u``
of the specific force. The slope ``k`` of the measured turn over the predicted one is 1 where all units are right,
1/57.3 where °/s were taken for rad/s, 10 where the times are ten times too short.
"""

from dataclasses import dataclass

import numpy as np

from processing.importing.raw import RawImu
from processing.importing.rows import BLOCK_ROWS, thinned
from processing.importing.units import AUTO, factor
from processing.survey import Finding, FloatArray, Severity

_DEG = float(np.pi / 180.0)
_NAMES = {"mps2": "m/s²", "g": "g", "mg": "mg", "cmps2": "cm/s²", "radps": "rad/s", "dps": "°/s", "mdps": "m°/s"}
_ACC_SIZES = (("mps2", 6.0, 16.0), ("g", 0.6, 1.6), ("mg", 600.0, 1600.0))
_SURE = 15.0
_WINDOWS = 400
_WINDOW_ROWS = 500


def settle_acc(raw: RawImu) -> list[Finding]:
    """Bring ``raw.acc`` (and its unit) to m/s² by the size of gravity in it."""
    norms = np.linalg.norm(thinned(raw.acc), axis=1)
    norms = norms[np.isfinite(norms) & (norms > 0)]
    if not len(norms):
        return []
    size = float(np.median(norms))
    written = size / factor("acc", raw.acc_unit)
    declared = raw.acc_unit
    if declared != AUTO and 5.0 <= size <= 20.0:
        return []
    found = next((unit for unit, low, high in _ACC_SIZES if low <= written <= high), None)
    if found is None:
        raw.acc_unit = "mps2" if declared == AUTO else declared
        code = "acc_without_gravity" if size < 3.0 else "acc_magnitude_odd"
        return [Finding(code, Severity.WARNING, {"median_mps2": size})]
    _scale(raw.acc, factor("acc", found) / factor("acc", declared))
    raw.acc_unit = found
    params: dict[str, str | float] = {"found": _NAMES[found], "median": written}
    if declared == AUTO:
        return [Finding("acc_unit_found", Severity.INFO, params)]
    return [Finding("acc_unit_mended", Severity.REPAIRED, {**params, "declared": _NAMES[declared]})]


def _scale(array: FloatArray, by: float) -> None:
    if by != 1.0:
        for start in range(0, len(array), BLOCK_ROWS):
            array[start : start + BLOCK_ROWS] *= by


@dataclass(frozen=True)
class Agreement:
    """How gyroscope and gravity agree: ``slope`` of measured over predicted turn, ``sureness`` in sigmas, ``share``
    of the turn of gravity that the gyroscope explains (R²)."""

    slope: float
    sureness: float
    share: float


def agreement(time: FloatArray, acc: FloatArray, gyr: FloatArray) -> Agreement:
    """Return how the turn of gravity in ``acc`` (n, 3) follows from ``gyr`` (n, 3) in rad/s over ``time`` (n,) in s."""
    products = squares = turns = 0.0
    count = 0
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    span = max(len(time) - _WINDOW_ROWS, 1)
    starts = range(0, len(time), _WINDOW_ROWS) if span < _WINDOWS * _WINDOW_ROWS else range(0, span, span // _WINDOWS)
    for start in starts:
        part = slice(start, start + _WINDOW_ROWS)
        measured, predicted = _turns(time[part], acc[part], gyr[part], step)
        products += float(np.sum(measured * predicted))
        squares += float(np.sum(predicted * predicted))
        turns += float(np.sum(measured * measured))
        count += measured.size
    if count < 60 or squares <= 0.0 or turns <= 0.0:
        return Agreement(float("nan"), 0.0, 0.0)
    slope = products / squares
    rest = max(turns - slope * products, 1e-12 * turns)
    return Agreement(slope, slope / float(np.sqrt(rest / count / squares)), slope * products / turns)


def _turns(time: FloatArray, acc: FloatArray, gyr: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    norm = np.linalg.norm(acc, axis=1)
    typical = float(np.nanmedian(norm)) if np.isfinite(norm).any() else 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = acc / norm[:, None]
        steps = np.diff(time)
        good = np.isfinite(unit).all(axis=1) & np.isfinite(gyr).all(axis=1) & (np.abs(norm - typical) < 0.4 * typical)
        pairs = good[1:] & good[:-1] & (steps > 0) & (steps < 2.5 * step)
    middle = 0.5 * (unit[1:] + unit[:-1])
    rate = 0.5 * (gyr[1:] + gyr[:-1])
    predicted = -np.cross(rate, middle) * steps[:, None]
    return (unit[1:] - unit[:-1])[pairs], predicted[pairs]


def settle_gyr(raw: RawImu) -> list[Finding]:
    """Bring ``raw.gyr`` to rad/s, and times that are ten times wrong to seconds, by agreement with gravity."""
    found = agreement(raw.time, raw.acc, raw.gyr)
    sure = abs(found.sureness) > _SURE
    if raw.gyr_unit == AUTO:
        return _find_unit(raw, found, sure)
    if not sure or 0.5 < found.slope < 2.0:
        return []
    declared = raw.gyr_unit
    other = {"radps": "dps", "dps": "radps", "mdps": "dps", "mradps": "radps"}[declared]
    ratio = factor("gyr", other) / factor("gyr", declared)
    params: dict[str, str | float] = {"found": _NAMES[other], "declared": _NAMES.get(declared, declared)}
    if 0.5 < found.slope / ratio < 2.0:
        _scale(raw.gyr, ratio)
        raw.gyr_unit = other
        return [Finding("gyr_unit_mended", Severity.REPAIRED, params)]
    for scale in (10.0, 0.1):
        if 0.75 < found.slope / scale < 1.3 and found.share > 0.3:
            raw.time *= scale
            rate = 1.0 / float(np.median(np.diff(raw.time)))
            return [Finding("time_ten_times", Severity.REPAIRED, {"factor": scale, "rate_hz": rate})]
    return [Finding("gyr_disagrees", Severity.WARNING, {"slope": found.slope})]


def _find_unit(raw: RawImu, found: Agreement, sure: bool) -> list[Finding]:
    """Nobody wrote the unit down: by the turn of gravity where there is enough, else by size and noise."""
    if sure:
        for unit in ("radps", "dps", "mdps"):
            if 0.4 < found.slope / factor("gyr", unit) < 2.5:
                return _as(raw, unit, "gyr_unit_found")
    size = np.abs(thinned(raw.gyr))
    size = size[np.isfinite(size)]
    noise = float(np.nanmedian(np.abs(np.diff(raw.gyr[:200_000], axis=0)))) if len(raw) > 1 else 0.0
    # 35 rad/s are the 2000 °/s at which most gyroscopes end; at rest they tremble by 0.001 rad/s or 0.06 °/s
    in_degrees = len(size) > 0 and (float(np.percentile(size, 99.9)) > 40.0 or noise > 0.015)
    return _as(raw, "dps" if in_degrees else "radps", "gyr_unit_assumed")


def _as(raw: RawImu, unit: str, code: str) -> list[Finding]:
    _scale(raw.gyr, factor("gyr", unit))
    raw.gyr_unit = unit
    severity = Severity.INFO if code == "gyr_unit_found" else Severity.WARNING
    return [Finding(code, severity, {"found": _NAMES[unit]})]
