"""xio: x-IMU3 folders (Inertial.csv, Magnetometer.csv and Quaternion.csv beside), NGIMU, Gait-Tracking, Fusion.

Gyroscope in °/s, accelerometer in g, times in µs (x-IMU3) or s (the others): all written in the header.
"""

import re
from dataclasses import replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import merge
from processing.importing.column_mapping import MAG, QUAT, ColumnMapping, MappedColumn, Quantity
from processing.importing.delimited import read_delimited, read_group_columns
from processing.importing.guess import guess_by_names
from processing.importing.raw import RawImu, ReadContext
from processing.importing.text_layout import TextLayout, find_layout
from processing.importing.units import unit_named

_TIME = re.compile(r"time(stamp)?\s*\((us|µs|s)\)$", re.IGNORECASE)
_GYR = re.compile(r"gyroscope x\s*\((deg/s|°/s)\)$", re.IGNORECASE)
_ACC = re.compile(r"accelerometer x\s*\(g\)$", re.IGNORECASE)


def sniff(_path: Path, layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that xio's software wrote this."""
    if layout is None:
        return 0.0
    names = [n.strip() for n in layout.columns]
    good = bool(names) and bool(_TIME.match(names[0])) and any(map(_GYR.match, names)) and any(map(_ACC.match, names))
    return 0.97 if good else 0.0


def mapping_of(layout: TextLayout) -> ColumnMapping:
    """Return what the columns hold, by the names in the header."""
    return guess_by_names(layout)


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows of Inertial.csv (or the one file), with magnetometer and quaternion from the files beside it.

    Raises:
        LeaklineError: COLUMN_MISSING, and the errors of reading.
    """
    layout = find_layout(path)
    raw = read_delimited(path, mapping_of(layout), context, layout)
    if path.stem.casefold() == "inertial":
        quiet = replace(context, progress=context.progress.part(0.9, 1.0))
        _merge_beside(raw, path.with_name("Magnetometer.csv"), quiet)
        _merge_beside(raw, path.with_name("Quaternion.csv"), quiet)
    return raw


def _merge_beside(raw: RawImu, path: Path, context: ReadContext) -> None:
    """Add what a file beside the log holds; one that is missing or damaged costs nothing but itself."""
    if not path.is_file():
        return
    try:
        layout = find_layout(path)
        beside = read_group_columns(path, _mapping_beside(layout), context, layout)
    except LeaklineError as error:
        if error.code in (ErrorCode.FILE_EMPTY, ErrorCode.TEXT_NOT_A_TABLE, ErrorCode.COLUMN_MISSING):
            return
        raise LeaklineError(error.code, error.place or Place(path), **error.params) from None
    if beside.mag is not None:
        raw.mag, raw.mag_unit = merge.onto(raw.time, beside.time, beside.mag, context.scratch), beside.mag_unit
        raw.files.append(path)
    elif beside.quat is not None:
        raw.quat = merge.quaternions_onto(raw.time, beside.time, beside.quat, context.scratch)
        raw.files.append(path)


def _mapping_beside(layout: TextLayout) -> ColumnMapping:
    """Time first, then three axes of the magnetometer or four parts of the quaternion, by their letters."""
    names = [re.sub(r"\s*\([^)]*\)$", "", n).strip().casefold() for n in layout.columns[: layout.width]]
    letters = {n[-1]: i for i, n in enumerate(names) if i and n and n[-1] in "wxyz"}
    quantities = QUAT if "w" in letters else MAG
    columns = [MappedColumn(0, Quantity.TIME, unit_named("time", layout.units[0]), layout.columns[0])]
    for quantity in quantities:
        at = letters.get(quantity.value[-1])
        if at is not None:
            unit = "1" if quantities is QUAT else unit_named("mag", layout.units[at])
            columns.append(MappedColumn(at, quantity, unit, layout.columns[at]))
    return ColumnMapping(tuple(columns))
