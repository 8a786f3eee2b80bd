"""Phone loggers: phyphox and Sensor Logger, which write one CSV a sensor, and phyphox exports with all in one file.

phyphox: ``"Time (s)","X (m/s^2)",…`` or ``"Acceleration x (m/s^2)"``; its Accelerometer holds gravity. Sensor Logger:
``time,seconds_elapsed,z,y,x`` with ns since 1970; its Accelerometer is without gravity, TotalAcceleration with it, and
Gravity holds the rest. The gyroscope's times are kept, the others are brought to them.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import merge
from processing.importing.column_mapping import ACC, GYR, MAG, ColumnMapping, MappedColumn, Quantity
from processing.importing.delimited import read_delimited, read_group_columns
from processing.importing.guess import guess_by_names
from processing.importing.raw import RawImu, ReadContext
from processing.importing.text_layout import TextLayout, find_layout
from processing.importing.time_stamps import factor_of, unit_of_steps
from processing.importing.units import unit_named
from processing.survey import Finding, FloatArray, Severity

_GYROSCOPES = ("gyroscope", "gyro", "gyr", "rotationrate")
_WITH_GRAVITY = ("totalacceleration", "accelerometeruncalibrated", "accelerometer", "accelerationwithg", "acceleration")
_QUANTITIES = {"acc": ACC, "gyr": GYR, "mag": MAG}
_DEFAULT_UNIT = {"acc": "auto", "gyr": "radps", "mag": "ut"}


def _plain(path: Path) -> str:
    return re.sub(r"[^a-z]", "", path.stem.casefold())


def _beside(path: Path) -> dict[str, Path]:
    """The CSV files of the folder by their plain names."""
    found = (f for f in sorted(path.parent.iterdir()) if f.suffix.casefold() in (".csv", ".txt") and f.is_file())
    return {_plain(f): f for f in found}


def axes_mapping(layout: TextLayout, kind: str) -> ColumnMapping:
    """Return time and the axes x, y, z of a file that holds one sensor ``kind`` (acc, gyr, mag)."""
    names = [re.sub(r"\s*[(\[][^)\]]*[)\]]\s*$", "", n).strip().casefold() for n in layout.columns[: layout.width]]
    columns = []
    for name in ("seconds_elapsed", "time", "timestamp", "t"):
        if name in names:
            at = names.index(name)
            unit = "s" if name == "seconds_elapsed" else unit_named("time", layout.units[at])
            columns.append(MappedColumn(at, Quantity.TIME, unit, layout.columns[at]))
            break
    for quantity in _QUANTITIES[kind]:
        letter = quantity.value[-1]
        at = next((i for i, n in enumerate(names) if n == letter or re.search(rf"[\s_]{letter}$", n)), -1)
        if at >= 0:
            unit = unit_named(kind, layout.units[at])
            unit = _DEFAULT_UNIT[kind] if unit == "auto" else unit
            columns.append(MappedColumn(at, quantity, unit, layout.columns[at]))
    return ColumnMapping(tuple(columns))


def _is_single_sensor(layout: TextLayout | None, kind: str) -> bool:
    return layout is not None and layout.has_header and len(axes_mapping(layout, kind).columns) == 4


def _accelerometer_of(path: Path, layout: TextLayout) -> Path | None:
    beside = _beside(path)
    names: tuple[str, ...] = _WITH_GRAVITY
    if "seconds_elapsed" in layout.columns and "gravity" in beside:
        names = ("totalacceleration", "accelerometer", "accelerometeruncalibrated")
    return next((beside[n] for n in names if n in beside), None)


def sniff(path: Path, layout: TextLayout | None) -> float:
    """Return how sure it is (0..1): the gyroscope's file stands for the folder, a file with both for itself."""
    if layout is None:
        return 0.0
    if _plain(path) in _GYROSCOPES and _is_single_sensor(layout, "gyr") and _accelerometer_of(path, layout):
        return 0.95
    names = " ".join(layout.columns).casefold()
    both = "acceleration x (m/s^2)" in names and "gyroscope x (rad/s)" in names
    return 0.9 if both and not guess_by_names(layout).missing else 0.0


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows on the gyroscope's times.

    Raises:
        LeaklineError: COLUMN_MISSING where the accelerometer's file is missing; the errors of reading.
    """
    layout = find_layout(path)
    if not (_plain(path) in _GYROSCOPES and _is_single_sensor(layout, "gyr")):
        return read_delimited(path, guess_by_names(layout), context, layout)
    acc_path = _accelerometer_of(path, layout)
    if acc_path is None:
        raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path.parent), column_name="Accelerometer.csv")
    raw = _sensor(path, "gyr", replace(context, progress=context.progress.part(0.0, 0.4)))
    acc = _sensor(acc_path, "acc", replace(context, progress=context.progress.part(0.4, 0.8)))
    values = _with_gravity(raw, acc, acc_path, layout, context)
    raw.acc_unit = acc.acc_unit
    merge.merge_acc(raw, acc.time, values, context.scratch)
    raw.files.append(acc_path)
    magnetometer = _beside(path).get("magnetometer")
    if magnetometer is not None and _is_single_sensor(_layout_or_none(magnetometer), "mag"):
        mag = _sensor(magnetometer, "mag", replace(context, progress=context.progress.part(0.8, 1.0)))
        if mag.mag is not None:
            raw.mag, raw.mag_unit = merge.onto(raw.time, mag.time, mag.mag, context.scratch), mag.mag_unit
            raw.files.append(magnetometer)
    return raw


def _layout_or_none(path: Path) -> TextLayout | None:
    try:
        return find_layout(path)
    except LeaklineError:
        return None  # an empty file of a sensor that the phone lacks


def _sensor(path: Path, kind: str, context: ReadContext) -> RawImu:
    layout = find_layout(path)
    mapping = axes_mapping(layout, kind)
    missing = next((q for q in (Quantity.TIME, *_QUANTITIES[kind]) if mapping.column_of(q) is None), None)
    if missing is not None:
        raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path), column_name=str(missing))
    raw = read_group_columns(path, mapping, context, layout)
    unit = unit_of_steps(raw.time) if raw.time_unit == "auto" else None
    if unit is not None:  # before streams are merged they have to be on one scale
        raw.time *= factor_of(unit)
        raw.time_unit = "s"
    return raw


def _with_gravity(raw: RawImu, acc: RawImu, path: Path, layout: TextLayout, context: ReadContext) -> FloatArray:
    """The accelerometer with gravity: Sensor Logger's plain one has had it taken off."""
    gravity = _beside(path).get("gravity")
    if _plain(path) != "accelerometer" or "seconds_elapsed" not in layout.columns or gravity is None:
        return acc.acc
    pull = _sensor(gravity, "acc", context)
    raw.files.append(gravity)
    raw.findings.append(Finding("gravity_added", Severity.INFO))
    return np.asarray(acc.acc + merge.onto(acc.time, pull.time, pull.acc, context.scratch), dtype=np.float64)
