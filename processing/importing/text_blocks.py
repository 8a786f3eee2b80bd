"""Reads the numbers of a text table of any length in blocks, fast where it is clean and tolerant where it is not."""

import codecs
import io
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.text_layout import COMMENTS, TextLayout
from processing.survey import FloatArray

BLOCK_BYTES = 8 << 20
MAX_LINE_BYTES = 1 << 20
TEXT_WIDTH = 40
ABSURD = 1e30
_SLOW_LINES = 48
_BLANKS = re.compile(rb"[ \t]+")
_EMPTY_WORDS = frozenset({b"", b"nan", b"null", b"none", b"na", b"n/a", b"-", b"--", b"inf", b"-inf", b"+inf"})


@dataclass
class Faults:
    """What could not be read, counted while the blocks go by; lines count from 1."""

    lines: int = 0
    first_line: int | None = None
    long_lines: int = 0
    nul_bytes: int = 0

    def add_line(self, line: int) -> None:
        """Count a line that is no row of the table."""
        self.lines += 1
        if self.first_line is None or line < self.first_line:
            self.first_line = line


@dataclass(frozen=True)
class Block:
    """Rows of a table: ``values`` (k, m), NaN where a cell is no number; ``texts`` (k,) of the text column, if any."""

    values: FloatArray
    texts: npt.NDArray[np.bytes_] | None
    bytes_done: int


def read_blocks(
    path: Path,
    layout: TextLayout,
    columns: Sequence[int],
    faults: Faults,
    text_column: int | None = None,
    block_bytes: int = BLOCK_BYTES,
) -> Iterator[Block]:
    """Yield the rows of the table in ``path`` from its first line of numbers on.

    Args:
        path: the file.
        layout: how it is written.
        columns: which columns (from 0) become ``values``, in this order.
        faults: what could not be read is counted here.
        text_column: a column handed on as bytes of at most 40 characters: times of day.
        block_bytes: how much is held at a time.

    Raises:
        LeaklineError: FILE_UNREADABLE where the disc fails.
    """
    parser = _Parser(layout, tuple(columns), text_column, faults)
    line = 1
    for lines, done in whole_lines(path, layout.encoding, faults, block_bytes):
        count = lines.count(b"\n")
        if line + count > layout.data_line:
            lines = lines[_after_lines(lines, max(layout.data_line - line, 0)) :]
            parsed = parser.parse(parser.normal(lines), max(line, layout.data_line))
            if parsed is not None and len(parsed.values):
                drop_absurd(parsed.values)
                yield Block(parsed.values, parsed.texts, done)
        line += count


def drop_absurd(values: FloatArray) -> None:
    """Make NaN of numbers whose squares no longer fit: damage, never a measurement (ns since 1970 are 2e18)."""
    with np.errstate(invalid="ignore"):
        values[~(np.abs(values) < ABSURD)] = np.nan


def whole_lines(path: Path, encoding: str, faults: Faults, block_bytes: int) -> Iterator[tuple[bytes, int]]:
    """Yield blocks of ASCII-compatible bytes that end with a line feed, and how many bytes of the file are done."""
    decoder = codecs.getincrementaldecoder(encoding)("replace") if encoding.startswith("utf-16") else None
    carry, held, done = b"", b"", 0
    dropping = False
    try:
        with path.open("rb") as file:
            if encoding == "utf-8-sig":
                done = len(file.read(3))
            while raw := file.read(block_bytes):
                done += len(raw)
                data = held + (raw if decoder is None else decoder.decode(raw).encode("utf-8", errors="replace"))
                held = b"\r" if data.endswith(b"\r") else b""  # its line feed may come next
                data = data[: len(data) - len(held)]
                if b"\r" in data:
                    data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
                end = data.rfind(b"\n") + 1
                if end and dropping:
                    data, end, dropping = data[data.index(b"\n") :], end - data.index(b"\n"), False
                if end:
                    yield carry + data[:end], done
                    carry = b""
                carry = b"" if dropping else carry + data[end:]
                if len(carry) > MAX_LINE_BYTES:
                    carry, dropping = b"", True
                    faults.long_lines += 1
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None
    if carry:
        yield carry + b"\n", done


def _after_lines(data: bytes, count: int) -> int:
    """The offset behind the first ``count`` lines."""
    at = 0
    for _ in range(count):
        at = data.index(b"\n", at) + 1
    return at


class _Parser:
    """Turns normalised lines into rows; halves a block until the bad lines stand alone."""

    def __init__(self, layout: TextLayout, columns: tuple[int, ...], text_column: int | None, faults: Faults) -> None:
        self._layout = layout
        self._columns = columns
        self._text_column = text_column
        self._faults = faults
        used = [*columns] if text_column is None else [text_column, *columns]
        self._order = np.unique(used)
        self._where = [int(np.searchsorted(self._order, c)) for c in columns]
        swap = bytes.maketrans(b",", b".") if layout.decimal_comma else None
        self._translate = swap
        self._separator = layout.separator.encode()

    def normal(self, lines: bytes) -> bytes:
        """Return the lines with commas between cells, points in numbers, no quotes and no NUL bytes."""
        if b"\0" in lines:
            self._faults.nul_bytes += lines.count(b"\0")
            lines = lines.replace(b"\0", b"")
        if b'"' in lines:
            lines = lines.replace(b'"', b"")
        if self._translate is not None:
            lines = lines.translate(self._translate)
        if not self._separator:
            lines = _BLANKS.sub(b",", lines)
            lines = lines.replace(b"\n,", b"\n").replace(b",\n", b"\n").lstrip(b",")
        elif self._separator != b",":
            lines = lines.replace(self._separator, b",")
        return lines

    def parse(self, lines: bytes, line: int) -> Block | None:
        """Return the rows in normalised ``lines``, whose first one is ``line`` of the file."""
        fast = self._fast(lines)
        if fast is not None:
            return fast
        count = lines.count(b"\n")
        if count <= _SLOW_LINES:
            return self._slow(lines, line)
        middle = lines.find(b"\n", len(lines) // 2) + 1
        if middle in (0, len(lines)):  # the second half is one long line
            middle = lines.rfind(b"\n", 0, len(lines) - 1) + 1
        first = self.parse(lines[:middle], line)
        second = self.parse(lines[middle:], line + lines.count(b"\n", 0, middle))
        if first is None or second is None:
            return first or second
        texts = None
        if first.texts is not None and second.texts is not None:
            texts = np.concatenate([first.texts, second.texts])
        return Block(np.concatenate([first.values, second.values]), texts, 0)

    def _fast(self, lines: bytes) -> Block | None:
        rows = lines.count(b"\n")
        if not self._layout.ragged and lines.count(b",") != rows * (self._layout.width - 1):
            return None
        filled = lines
        if b",," in filled:
            filled = filled.replace(b",,", b",nan,").replace(b",,", b",nan,")
        if b",\n" in filled or b"\n," in filled or filled.startswith(b","):
            filled = (b"\n" + filled).replace(b"\n,", b"\nnan,").replace(b",\n", b",nan\n")[1:]
        cells: list[tuple[str, str]] = [
            (f"c{c}", f"S{TEXT_WIDTH}" if c == self._text_column else "f8") for c in self._order
        ]
        plain = self._text_column is None
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a block without data is no fault
                table: Any = np.loadtxt(
                    io.BytesIO(filled),
                    dtype=np.float64 if plain else np.dtype(cells),
                    delimiter=",",
                    usecols=self._order.tolist(),
                    comments=None,
                    ndmin=2 if plain else 1,
                    encoding="latin-1",
                )
        except (ValueError, UnicodeError, OverflowError):
            return None
        if len(table) != rows:  # blank lines hide the line numbers: leave them to the tolerant way
            return None
        if plain:
            return Block(np.ascontiguousarray(table[:, self._where]), None, 0)
        values = np.column_stack([table[f"c{c}"] for c in self._columns]).astype(np.float64)
        return Block(values, table[f"c{self._text_column}"].copy(), 0)

    def _slow(self, lines: bytes, line: int) -> Block | None:
        rows: list[list[float]] = []
        texts: list[bytes] = []
        for number, text in enumerate(lines.split(b"\n")[:-1], start=line):
            bare = text.strip()
            if not bare or bare.startswith(tuple(c.encode() for c in COMMENTS)):
                continue
            cells = [c.strip() for c in text.split(b",")]
            row = self._row(cells)
            if row is None:
                self._faults.add_line(number)
                continue
            rows.append(row)
            if self._text_column is not None:
                texts.append(cells[self._text_column][:TEXT_WIDTH])
        if not rows:
            return None
        kept = np.array(texts, dtype=f"S{TEXT_WIDTH}") if self._text_column is not None else None
        return Block(np.array(rows, dtype=np.float64).reshape(len(rows), len(self._columns)), kept, 0)

    def _row(self, cells: list[bytes]) -> list[float] | None:
        """The wanted numbers of a line, or None where it is no row: of another width, or without any number."""
        if len(cells) <= self._order[-1]:
            return None
        if not self._layout.ragged and (len(cells) < self._layout.width or any(cells[self._layout.width :])):
            return None
        row = [_number(cells[c]) for c in self._columns]
        readable = [value for value in row if value is not None]
        if not readable and row:
            return None
        return [np.nan if value is None else value for value in row]


def _number(cell: bytes) -> float | None:
    """The number in a cell, NaN for an empty one, None for what is neither."""
    if cell.lower() in _EMPTY_WORDS:
        return float("nan")
    try:
        return float(cell) if b"_" not in cell else None
    except ValueError:
        return None
