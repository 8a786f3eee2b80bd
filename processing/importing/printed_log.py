"""The printed lines of the recorder of P0 and P3: ``Accelerometer(xyz)=…, Gyroscope(xyz)=…, Magnetometer(xyz)=…---``.

Values are in g, °/s and about µT, 100 lines a second (methods.md §5). Anything may stand before the values, a time
among it, and other prints may stand between the lines.
"""

import re
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.raw import GrowingArray, RawImu, ReadContext
from processing.importing.text_blocks import BLOCK_BYTES, Faults, drop_absurd, whole_lines
from processing.importing.text_layout import TextLayout, encoding_of, head_lines, read_head
from processing.importing.time_stamps import DAY_S, seconds_of_clock, unwrap
from processing.importing.units import factor
from processing.survey import Finding, FloatArray, Severity

RATE_HZ = 100.0
_NUMBER = r"[ \t]*([-+]?[\d.]{1,40}(?:[eE][-+]?\d{1,4})?)[ \t]*"
_TRIPLE = r"[ \t]*\([ \t]*xyz[ \t]*\)[ \t]*[=:]" + ",".join([_NUMBER] * 3)
# every repetition is bounded: a megabyte without a line feed must not take forever
LINE = re.compile(
    (
        rf"^([^\n]{{0,300}}?)Acc(?:elerometer)?{_TRIPLE},?[^\n]{{0,100}}?Gyr(?:o|oscope)?{_TRIPLE}"
        rf"(?:,?[^\n]{{0,100}}?Mag(?:netometer)?{_TRIPLE})?"
    ).encode(),
    re.MULTILINE | re.IGNORECASE,
)
CLOCK = re.compile(rb"((?:\d{4}[-/.]\d\d?[-/.]\d\d?[T ])?\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)")
PLAIN = re.compile(rb"^\W*([0-9]+(?:\.[0-9]+)?)\s*(ms|us|s)?\b", re.IGNORECASE)


def sniff(path: Path, _layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that the file holds such lines."""
    head = read_head(path)
    text = "\n".join(head_lines(head, encoding_of(head))).encode()
    found = len(LINE.findall(text[:60_000]))
    return 0.99 if found >= 3 else 0.0


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows; times are those before the values where there are any, else 100 a second are assumed.

    Raises:
        LeaklineError: TEXT_NOT_A_TABLE where no line is of this form; the errors of reading.
    """
    head = read_head(path)
    stores = [GrowingArray(3, context.scratch) for _ in range(3)]
    times = GrowingArray(0, context.scratch)
    faults = Faults()
    total = max(path.stat().st_size, 1)
    line = 1
    stamps = _Stamps(head)
    for data, done in whole_lines(path, encoding_of(head), faults, min(BLOCK_BYTES, context.max_bytes or BLOCK_BYTES)):
        lines = data.replace(b"\0", b"")
        found = list(LINE.finditer(lines))
        _count_faults(lines, found, line, faults)
        values = np.array([[_number(g) for g in m.groups()[1:]] for m in found], dtype=np.float64).reshape(-1, 9)
        drop_absurd(values)
        for k, store in enumerate(stores):
            store.append(values[:, 3 * k : 3 * k + 3] * (factor("acc", "g"), factor("gyr", "dps"), 1.0)[k])
        times.append(stamps.of([m[1] for m in found]))
        line += data.count(b"\n")
        context.progress.update(done / total, "import_reading")
        if context.max_bytes is not None and done >= context.max_bytes:
            break
    acc, gyr, mag = (s.finish() for s in stores)
    if not len(acc):
        raise LeaklineError(ErrorCode.TEXT_NOT_A_TABLE, Place(path))
    raw = RawImu(times.finish(), acc, gyr, mag, acc_unit="g", gyr_unit="dps", mag_unit="ut", faults=faults)
    return _timed(raw, stamps, context)


def _number(text: bytes | None) -> float:
    try:
        return float(text) if text is not None else float("nan")
    except ValueError:
        return float("nan")


def _count_faults(lines: bytes, found: list[re.Match[bytes]], line: int, faults: Faults) -> None:
    """Lines that look like a row but cannot be read are told; other prints in between are no concern of ours."""
    torn = lines.lower().count(b"accelerometer(") - len(found)
    if torn <= 0:
        return
    feeds = np.nonzero(np.frombuffer(lines, np.uint8) == ord("\n"))[0]
    good = set(np.searchsorted(feeds, [m.start(2) for m in found]).tolist())
    marks = [m.start() for m in re.finditer(rb"accelerometer\(", lines, re.IGNORECASE)]
    first = next((n for n in np.searchsorted(feeds, marks).tolist() if n not in good), 0)
    faults.lines += torn - 1
    faults.add_line(line + first)


class _Stamps:
    """Finds the time in what stands before the values of a line: a clock, a rising number, or nothing."""

    def __init__(self, head: bytes) -> None:
        before = [m[1] for m in LINE.finditer(head)][:50]
        plain = [m for text in before if (m := PLAIN.match(text))]
        numbers = [float(m[1]) for m in plain]
        self.clock = bool(before) and all(CLOCK.search(text) for text in before)
        rising = len(numbers) == len(before) > 1 and numbers == sorted(numbers) and numbers[-1] > numbers[0]
        self.unit = ""
        if rising and not self.clock:
            self.unit = (plain[0][2] or b"auto").decode().lower()

    def of(self, before: list[bytes]) -> FloatArray:
        """Return the times (k,) of lines, NaN where there is none; in s for a clock, else as written."""
        if self.clock:
            found = [m[1] if (m := CLOCK.search(text)) else b"" for text in before]
            return seconds_of_clock(np.array(found, dtype="S40"))
        if self.unit:
            return np.array([_number(m[1] if (m := PLAIN.match(text)) else None) for text in before])
        return np.full(len(before), np.nan)


def _timed(raw: RawImu, stamps: _Stamps, context: ReadContext) -> RawImu:
    raw.sample_rate_hz = context.sample_rate_hz or RATE_HZ
    if stamps.clock:
        raw.time_unit = "s"
        if not np.nanmax(raw.time, initial=0.0) > DAY_S:
            raw.time = unwrap(raw.time, DAY_S)[0]
    elif stamps.unit:
        raw.time_unit = "auto" if stamps.unit == "auto" else "s"
        raw.time *= factor("time", stamps.unit)
    else:
        raw.time, raw.time_unit = np.arange(len(raw.acc), dtype=np.float64), "count"
        if context.sample_rate_hz is None:
            raw.findings.append(Finding("rate_assumed", Severity.WARNING, {"rate_hz": RATE_HZ}))
    return raw
