"""Reads any delimited text through a column mapping: the engine under every reader of tables."""

from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.column_mapping import ACC, GYR, MAG, QUAT, ColumnMapping, MappedColumn, Quantity
from processing.importing.raw import GrowingArray, RawImu, ReadContext
from processing.importing.text_blocks import BLOCK_BYTES, Faults, read_blocks
from processing.importing.text_layout import TextLayout, find_layout
from processing.importing.time_stamps import DAY_S, seconds_of_clock, unwrap, unwrap_counter
from processing.importing.units import factor, offset
from processing.survey import FloatArray

_GROUPS: dict[str, tuple[Quantity, ...]] = {
    "acc": ACC,
    "gyr": GYR,
    "mag": MAG,
    "quat": QUAT,
    "counter": (Quantity.COUNTER,),
    "pressure": (Quantity.PRESSURE,),
    "temperature": (Quantity.TEMPERATURE,),
}


def read_delimited(
    path: Path, mapping: ColumnMapping, context: ReadContext, layout: TextLayout | None = None
) -> RawImu:
    """Return the rows of an IMU log.

    Raises:
        LeaklineError: COLUMN_MISSING where the mapping lacks time or an axis of accelerometer or gyroscope or names a
            column that the file has not; TEXT_NOT_A_TABLE and the errors of reading.
    """
    layout = find_layout(path) if layout is None else layout
    if mapping.missing:
        raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path), column_name=str(mapping.missing[0]))
    return read_group_columns(path, mapping, context, layout)


def read_group_columns(path: Path, mapping: ColumnMapping, context: ReadContext, layout: TextLayout) -> RawImu:
    """Return what the mapping holds, also where an axis or the time is missing: then that array is empty."""
    beyond = next((c for c in mapping.columns if c.column >= max(layout.width, len(layout.columns))), None)
    if beyond is not None:
        name = beyond.name or f"{beyond.column + 1}"
        raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path), column_name=name)
    groups = {name: qs for name, qs in _GROUPS.items() if mapping.complete(qs)}
    stores = {name: GrowingArray(len(qs) if len(qs) > 1 else 0, context.scratch) for name, qs in groups.items()}
    times = GrowingArray(0, context.scratch)
    used = [mapping.column_of(q) for qs in groups.values() for q in qs]
    columns = [c for c in used if c is not None]
    clock = mapping.column_of(Quantity.TIME)
    text_column = clock.column if clock is not None and clock.unit == "clock" else None
    if clock is not None and text_column is None:
        columns.append(clock)
    faults = Faults()
    total = max(path.stat().st_size, 1)
    size = BLOCK_BYTES if context.max_bytes is None else min(BLOCK_BYTES, context.max_bytes)
    for block in read_blocks(path, layout, [c.column for c in columns], faults, text_column, size):
        at = 0
        for name, quantities in groups.items():
            part = block.values[:, at : at + len(quantities)]
            stores[name].append(_in_si(part, columns[at : at + len(quantities)]))
            at += len(quantities)
        if block.texts is not None:
            times.append(seconds_of_clock(block.texts))
        elif clock is not None:
            times.append(block.values[:, -1] * factor("time", clock.unit))
        context.progress.update(block.bytes_done / total, "import_reading")
        if context.max_bytes is not None and block.bytes_done >= context.max_bytes:
            break
    return _gathered(mapping, clock, {n: s.finish() for n, s in stores.items()}, times.finish(), faults, context)


def _in_si(values: FloatArray, columns: list[MappedColumn]) -> FloatArray:
    kind = columns[0].quantity.kind
    scale = np.array([factor(kind, c.unit) for c in columns])
    shift = np.array([offset(kind, c.unit) for c in columns])
    scaled = np.asarray(values * scale + shift, dtype=np.float64)
    return scaled[:, 0] if len(columns) == 1 else scaled


def _gathered(
    mapping: ColumnMapping,
    clock: MappedColumn | None,
    arrays: dict[str, FloatArray],
    time: FloatArray,
    faults: Faults,
    context: ReadContext,
) -> RawImu:
    counter = arrays.get("counter")
    if counter is not None:
        counter, _ = unwrap_counter(counter)
    rows = max((len(a) for a in arrays.values()), default=len(time))
    unit = "count"
    if clock is not None:
        unit = "s" if clock.unit in ("clock", "s", "ms", "us", "ns", "100us", "min") else clock.unit
        if clock.unit == "clock" and not np.nanmax(time, initial=0.0) > DAY_S:
            time, _ = unwrap(time, DAY_S)
        elif clock.unit in ("us", "100us"):
            time, _ = unwrap_clock_ticks(time, factor("time", clock.unit))
    elif counter is not None:
        time = counter.copy()
    else:
        time = np.arange(rows, dtype=np.float64)
    empty = np.empty((0, 3))
    return RawImu(
        time=time,
        acc=arrays.get("acc", empty),
        gyr=arrays.get("gyr", empty),
        mag=arrays.get("mag"),
        quat=arrays.get("quat"),
        pressure=arrays.get("pressure"),
        temperature=arrays.get("temperature"),
        counter=counter,
        time_unit=unit,
        acc_unit=_unit_of(mapping, ACC),
        gyr_unit=_unit_of(mapping, GYR),
        mag_unit=_unit_of(mapping, MAG),
        sample_rate_hz=context.sample_rate_hz or mapping.sample_rate_hz,
        faults=faults,
    )


def unwrap_clock_ticks(time: FloatArray, tick_s: float) -> tuple[FloatArray, int]:
    """Return times in seconds whose 32-bit tick counter may have wrapped, unwrapped."""
    ticks, turns = unwrap_counter(np.round(time / tick_s))
    return (ticks * tick_s, turns) if turns else (time, 0)


def _unit_of(mapping: ColumnMapping, quantities: tuple[Quantity, ...]) -> str:
    column = mapping.column_of(quantities[0])
    return column.unit if column is not None else "auto"
