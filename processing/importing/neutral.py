"""The neutral imu.csv: names with units, any order, extra columns ignored."""

from collections.abc import Mapping
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.column_mapping import ACC, GYR, MAG, QUAT, ColumnMapping, MappedColumn, Quantity
from processing.importing.delimited import read_delimited
from processing.importing.raw import RawImu, ReadContext
from processing.importing.text_layout import TextLayout, find_layout

NAMES: Mapping[str, tuple[Quantity, str]] = {
    "time_s": (Quantity.TIME, "s"),
    **{f"{q.value}_mps2": (q, "mps2") for q in ACC},
    **{f"{q.value}_radps": (q, "radps") for q in GYR},
    **{f"{q.value}_ut": (q, "ut") for q in MAG},
    **{q.value: (q, "1") for q in QUAT},
    "pressure_kpa": (Quantity.PRESSURE, "kpa"),
    "temperature_c": (Quantity.TEMPERATURE, "c"),
}


def mapping_of(layout: TextLayout) -> ColumnMapping:
    """Return which columns hold what, by the names of the contract; upper or lower case."""
    columns: dict[Quantity, MappedColumn] = {}
    for number, name in enumerate(layout.columns[: layout.width]):
        known = NAMES.get(name.strip().casefold())
        if known is not None and known[0] not in columns:
            columns[known[0]] = MappedColumn(number, known[0], known[1], name)
    return ColumnMapping(tuple(columns.values()))


def sniff(_path: Path, layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that this is the neutral form."""
    if layout is None or not layout.has_header:
        return 0.0
    found = len(mapping_of(layout).columns)
    complete = not mapping_of(layout).missing
    return 1.0 if complete else 0.6 if found >= 4 else 0.0


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows; raises COLUMN_MISSING with the name of the contract, and the errors of reading."""
    layout = find_layout(path)
    mapping = mapping_of(layout)
    if mapping.missing:
        name = next(n for n, (q, _) in NAMES.items() if q is mapping.missing[0])
        line = max(layout.data_line - 1, 1)
        raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path, line=line), column_name=name)
    raw = read_delimited(path, mapping, context, layout)
    raw.keep_origin = True
    return raw
