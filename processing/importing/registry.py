"""The one table of what can be imported: a row a logger format; adding one is one module and one row."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError
from processing.importing import frame_log, generic, neutral, phone, printed_log, ximu3_stream, xio, xsens
from processing.importing.column_mapping import ColumnMapping
from processing.importing.raw import RawImu, ReadContext
from processing.importing.text_layout import TextLayout, find_layout, read_head


@dataclass(frozen=True)
class Format:
    """A logger format: ``sniff`` says how sure (0..1) a file is of it, ``read`` gives its rows, ``mapping_of``
    what its columns hold, where one table is all there is."""

    name: str
    title: str
    sniff: Callable[[Path, TextLayout | None], float]
    read: Callable[[Path, ReadContext], RawImu]
    mapping_of: Callable[[TextLayout], ColumnMapping] | None = None


@dataclass(frozen=True)
class Match:
    """A format that a file may be of, and how sure that is (0..1)."""

    format: Format
    confidence: float


FORMATS: tuple[Format, ...] = (
    Format("neutral", "Leakline imu.csv", neutral.sniff, neutral.read, neutral.mapping_of),
    Format("frames", "Leakline binary frames (.lkf)", frame_log.sniff, frame_log.read),
    Format("printed", "Printed log of the P0/P3 recorder", printed_log.sniff, printed_log.read),
    Format("ximu3", "xio x-IMU3 stream (.ximu3)", ximu3_stream.sniff, ximu3_stream.read),
    Format("xio", "xio x-IMU3, NGIMU, Gait-Tracking CSV", xio.sniff, xio.read, xio.mapping_of),
    Format("xsens", "Xsens MT Manager text, DOT CSV", xsens.sniff, xsens.read, xsens.mapping_of),
    Format("phone", "Phone: phyphox, Sensor Logger CSV", phone.sniff, phone.read),
    Format("table", "Any other delimited text", generic.sniff, generic.read, generic.mapping_of),
)


def layout_of(path: Path) -> TextLayout | None:
    """Return how the text table in ``path`` is written, None where it is none; raises the errors of the disc."""
    try:
        return find_layout(path, read_head(path))
    except LeaklineError as error:
        if error.code is not ErrorCode.TEXT_NOT_A_TABLE:
            raise
        return None


def sniff(path: Path) -> tuple[Match, ...]:
    """Return the formats that ``path`` may be of, the likeliest first; empty where it is none of them.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, FILE_EMPTY.
    """
    layout = layout_of(path)
    matches = [Match(f, f.sniff(path, layout)) for f in FORMATS]
    return tuple(sorted((m for m in matches if m.confidence > 0.0), key=lambda m: -m.confidence))


def format_named(name: str) -> Format:
    """Return the format called ``name``; raises KeyError."""
    return {f.name: f for f in FORMATS}[name]
