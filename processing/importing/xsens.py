"""Xsens (Movella): MT Manager's text export, with or without quaternions, and the DOT exporter's CSV with ``sep=,``.

MT Manager writes m/s² and rad/s, the DOT °/s; the magnetometer is in units of the local field. SampleTimeFine counts
0.1 ms in MTi devices and µs in the DOT, wraps at 2³², and is empty in MTw exports, where PacketCounter and the update
rate of the comment lines give the time (MTi User Manual MT0605P §4.12, DOT User Manual §4.2.5).
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.importing.column_mapping import ColumnMapping, Quantity
from processing.importing.delimited import read_delimited
from processing.importing.guess import guess_by_names
from processing.importing.raw import RawImu, ReadContext
from processing.importing.text_layout import TextLayout, find_layout
from processing.importing.time_stamps import PLAUSIBLE_HZ, mean_step, unwrap_counter
from processing.importing.units import AUTO
from processing.survey import FloatArray

_RATE = re.compile(r"(?:update|output|sampl\w*)\s*_?rate\D{0,4}?([\d.]+)\s*hz", re.IGNORECASE)
_UNITS = {"acc": "mps2", "gyr": "radps", "mag": "au"}
_TICKS_S = (1e-4, 1e-6, 1e-3, 1.0, 1e-9)


def sniff(_path: Path, layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that MT Manager or the DOT exporter wrote this."""
    if layout is None:
        return 0.0
    names = {n.strip().casefold() for n in layout.columns}
    if not {"acc_x", "gyr_x"} <= names:
        return 0.0
    return 0.97 if {"packetcounter", "sampletimefine"} & names else 0.8 if _rate_in(layout) else 0.0


def _rate_in(layout: TextLayout) -> float | None:
    found = next((m for line in layout.preamble if (m := _RATE.search(line[:500]))), None)
    try:
        rate = float(found[1]) if found else 0.0
    except ValueError:
        return None
    return rate if PLAUSIBLE_HZ[0] <= rate <= PLAUSIBLE_HZ[1] else None


def mapping_of(layout: TextLayout) -> ColumnMapping:
    """Return what the columns hold, in Xsens's units where the header states none."""
    dot = any(line.casefold().startswith(("sep=", "devicetag")) for line in layout.preamble)
    units = _UNITS | ({"gyr": "dps"} if dot else {})
    columns = []
    for column in guess_by_names(layout).columns:
        if column.quantity is Quantity.TIME and column.name.casefold() != "sampletimefine":
            continue
        unit = units.get(column.quantity.kind, column.unit) if column.unit == AUTO else column.unit
        columns.append(replace(column, unit=unit))
    return ColumnMapping(tuple(columns), _rate_in(layout))


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows; raises COLUMN_MISSING where a sensor was not exported, and the errors of reading."""
    layout = find_layout(path)
    raw = read_delimited(path, mapping_of(layout), context, layout)
    ticks = raw.time if raw.time_unit == AUTO else np.empty(0)
    if len(ticks) and np.isfinite(ticks).mean() > 0.5:
        raw.time, raw.time_unit = _seconds(ticks, raw.sample_rate_hz)
    elif raw.counter is not None:
        raw.time, raw.time_unit = raw.counter.copy(), "count"
    elif len(ticks):
        raw.time, raw.time_unit = np.arange(len(ticks), dtype=np.float64), "count"
    return raw


def _seconds(ticks: FloatArray, rate_hz: float | None) -> tuple[FloatArray, str]:
    """Seconds from SampleTimeFine: the tick under which the rate is the written one, else one that an IMU can have."""
    ticks, _ = unwrap_counter(ticks)
    step = mean_step(ticks)
    if not step > 0:
        return ticks, AUTO
    if rate_hz is not None:
        tick = min(_TICKS_S, key=lambda t: abs(np.log(step * t * rate_hz)))
        if 0.5 < step * tick * rate_hz < 2.0:
            return ticks * tick, "s"
    for tick in _TICKS_S:
        if PLAUSIBLE_HZ[0] <= 1.0 / (step * tick) <= PLAUSIBLE_HZ[1]:
            return ticks * tick, "s"
    return ticks, AUTO
