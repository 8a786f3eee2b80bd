"""Any delimited text whose columns can be guessed, and the shared way of the readers that know their names."""

from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.column_mapping import ColumnMapping
from processing.importing.delimited import read_delimited
from processing.importing.guess import guess_mapping
from processing.importing.raw import RawImu, ReadContext
from processing.importing.text_layout import TextLayout, find_layout


def sniff(_path: Path, layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that the columns are guessed right; headers are trusted more than values."""
    if layout is None or guess_mapping(layout).missing:
        return 0.0
    return 0.6 if layout.has_header else 0.3


def mapping_of(layout: TextLayout) -> ColumnMapping:
    """Return what the columns hold, by guess."""
    return guess_mapping(layout)


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows; raises COLUMN_MISSING where an axis or the time cannot be guessed, and the errors of reading."""
    layout = find_layout(path)
    mapping = guess_mapping(layout)
    if mapping.missing:
        raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path), column_name=str(mapping.missing[0]))
    return read_delimited(path, mapping, context, layout)
