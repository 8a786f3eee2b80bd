"""The import doctor's look at units: g or m/s² by size, °/s or rad/s by whether gravity turns as the gyroscope says."""

import numpy as np

from processing.importing.coherence import coherence
from processing.importing.raw import RawImu
from processing.importing.rows import BLOCK_ROWS, thinned
from processing.importing.units import AUTO, factor
from processing.survey import Finding, FloatArray, Severity

_DEG = float(np.pi / 180.0)
_NAMES = {"mps2": "m/s²", "g": "g", "mg": "mg", "cmps2": "cm/s²", "radps": "rad/s", "dps": "°/s", "mdps": "m°/s"}
_ACC_SIZES = (("mps2", 6.0, 16.0), ("g", 0.6, 1.6), ("mg", 600.0, 1600.0))
_LEAD, _SIGMAS = 0.01, 5.0
_CLEAR_LEAD, _CLEAR_SIGMAS = 0.15, 8.0  # to overrule what a header says
_GOOD_SCORE = 0.6


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


def settle_gyr(raw: RawImu) -> list[Finding]:
    """Bring ``raw.gyr`` to rad/s, and times that are ten times wrong to seconds, by agreement with gravity."""
    if raw.gyr_unit == AUTO:
        return _find_unit(raw)
    declared = raw.gyr_unit
    other = {"radps": "dps", "dps": "radps", "mdps": "dps", "mradps": "radps"}[declared]
    ratio = factor("gyr", other) / factor("gyr", declared)
    found = coherence(raw.time, raw.acc, raw.gyr, (1.0, ratio, 10.0, 0.1, -1.0, 0.0))
    best = found.best(found.factors)
    lead, sigmas = found.margin(best, 1.0)
    score = float(found.mean[found.factors.index(best)])
    if best == 1.0 or lead < _CLEAR_LEAD or sigmas < _CLEAR_SIGMAS or score < _GOOD_SCORE:
        return []
    params: dict[str, str | float] = {"found": _NAMES[other], "declared": _NAMES.get(declared, declared)}
    if best == ratio:
        _scale(raw.gyr, ratio)
        raw.gyr_unit = other
        return [Finding("gyr_unit_mended", Severity.REPAIRED, params)]
    if best in (10.0, 0.1):
        raw.time *= best
        rate = 1.0 / float(np.median(np.diff(raw.time)))
        return [Finding("time_ten_times", Severity.REPAIRED, {"factor": best, "rate_hz": rate})]
    return [Finding("gyr_disagrees", Severity.WARNING)]


def _find_unit(raw: RawImu) -> list[Finding]:
    """Nobody wrote the unit down: by the turn of gravity where there is enough, else by size and noise."""
    units = {factor("gyr", unit): unit for unit in ("radps", "dps", "mdps")}
    found = coherence(raw.time, raw.acc, raw.gyr, tuple(units))
    best = found.best(found.factors)
    margins = [found.margin(best, f) for f in found.factors if f != best]
    if min(lead for lead, _ in margins) > _LEAD and min(sigmas for _, sigmas in margins) > _SIGMAS:
        return _as(raw, units[best], "gyr_unit_found")
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
