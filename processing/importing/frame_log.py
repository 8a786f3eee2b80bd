"""A file of Leakline's binary frames (``.lkf``): see :mod:`processing.importing.frames`."""

from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.frames import FrameDecoder
from processing.importing.raw import GrowingArray, RawImu, ReadContext
from processing.importing.streams import decoded
from processing.importing.text_layout import TextLayout
from processing.survey import Finding, FloatArray, Severity

SUFFIX = ".lkf"
_HEAD_BYTES = 1 << 16
_FEWEST = 3
_COUNTER_SPAN = 1 << 32
_COLUMNS = (
    ("acc_s_mps2", 3),
    ("gyr_s_radps", 3),
    ("mag_s_ut", 3),
    ("quat_ws", 4),
    ("pressure_kpa", 0),
    ("temperature_c", 0),
)


def sniff(path: Path, _layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that the file holds such frames."""
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    return 1.0 if len(FrameDecoder().feed(head)) >= _FEWEST else 0.0


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows; their times are those of the device, from the first on.

    Raises:
        LeaklineError: FILE_UNREADABLE, and where no frame is in it.
    """
    decoder = FrameDecoder()
    stores = {name: GrowingArray(width, context.scratch) for name, width in _COLUMNS}
    times, counters = GrowingArray(0, context.scratch), GrowingArray(0, context.scratch)
    is_known = dict.fromkeys(stores, False)
    first_us, rows = None, 0
    for frames in decoded(path, decoder, context):
        if first_us is None and len(frames):
            first_us = int(frames.time_us[0])
        for name, store in stores.items():
            values = getattr(frames, name)
            is_known[name] |= bool(np.isfinite(values).any())
            store.append(values.astype(np.float64))
        times.append(np.asarray(1e-6 * (frames.time_us - np.uint64(first_us or 0)).astype(np.int64), np.float64))
        counters.append(frames.counter.astype(np.float64))
        rows += len(frames)
    if not rows:
        raise LeaklineError(
            ErrorCode.FILE_UNREADABLE, Place(path), reason="no frame of Leakline's binary form is in it"
        )
    columns: dict[str, FloatArray] = {name: store.finish() for name, store in stores.items()}
    optional = {name: columns[name] if is_known[name] else None for name in is_known}
    raw = RawImu(
        times.finish(),
        columns["acc_s_mps2"],
        columns["gyr_s_radps"],
        mag=optional["mag_s_ut"],
        quat=optional["quat_ws"],
        pressure=optional["pressure_kpa"],
        temperature=optional["temperature_c"],
        counter=_unwrapped(counters.finish()),
        time_unit="s",
        acc_unit="mps2",
        gyr_unit="radps",
        mag_unit="ut",
    )
    if decoder.garbage_bytes:
        params = {"bytes": decoder.garbage_bytes, "bad_sums": decoder.bad_sums}
        raw.findings.append(Finding("frames_garbage", Severity.MASKED, params))
    return raw


def _unwrapped(counter: FloatArray) -> FloatArray:
    """Return the counter without its jumps from 4294967295 to 0."""
    if len(counter) < 2:
        return counter
    turns = np.cumsum(np.diff(counter, prepend=counter[0]) < -0.5 * _COUNTER_SPAN)
    counter += _COUNTER_SPAN * turns
    return counter
