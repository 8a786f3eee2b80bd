"""Finds out how a text table is written: encoding, separator, decimal sign, header rows, where the numbers begin."""

import re
from dataclasses import dataclass
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place

HEAD_BYTES = 1 << 18
COMMENTS = ("#", "//", "%")
MAX_COLUMNS = 4096

_SEPARATORS = ((",", False), (";", False), ("\t", False), (";", True), ("\t", True), ("", False), ("", True))
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$|[+-]?(nan|inf|infinity)$", re.IGNORECASE)
_COMMA_NUMBER = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?$")
_CLOCK = re.compile(r"(\d{4}[-/.]\d{1,2}[-/.]\d{1,2}[T _])?\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?(Z|[+-]\d{2}:?\d{2})?$")
_UNIT_ROW = re.compile(
    r"[\[(]?\s*(s|sec|seconds|ms|us|µs|μs|ns|g|mg|m/s\^?2|m/s²|m/s/s|m\.s-2|mps2|rad/s|rads|deg/s|°/s|dps|d/s|mdps|u?t|µt|μt|ut"
    r"|gauss|mgauss|n?t|a\.?u\.?|k?pa|hpa|m?bar|°?c|degc|k|°|deg|rad|1|-|n/a|%|v|mv|hh:mm:ss.*)?\s*[\])]?$",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class TextLayout:
    """How a text table is written.

    ``separator`` is one character, or empty for runs of blanks. ``columns`` are the names (header rows joined by a
    blank), ``units`` what a row of units or the brackets in the names say, empty where unknown. ``data_line`` (from 1)
    is the first line of numbers, ``width`` its cells, ``preamble`` the lines above the header; ``clock_column`` holds
    times of day or dates, ``sample`` the first rows as they are written. Where rows are not all
    of one width, ``ragged`` is True and short or long rows are trusted as far as their cells can be read.
    """

    encoding: str
    separator: str
    decimal_comma: bool
    columns: tuple[str, ...]
    units: tuple[str, ...]
    data_line: int
    has_header: bool
    width: int
    ragged: bool = False
    preamble: tuple[str, ...] = ()
    clock_column: int | None = None
    sample: tuple[tuple[str, ...], ...] = ()


def read_head(path: Path, size: int = HEAD_BYTES) -> bytes:
    """Return the first ``size`` bytes of a file.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, FILE_EMPTY.
    """
    try:
        if path.stat().st_size == 0:  # the system's own "files" among them, which may never answer
            raise LeaklineError(ErrorCode.FILE_EMPTY, Place(path))
        with path.open("rb") as file:
            head = file.read(size)
    except FileNotFoundError:
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path)) from None
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None
    if not head:
        raise LeaklineError(ErrorCode.FILE_EMPTY, Place(path))
    return head


def encoding_of(head: bytes) -> str:
    """Return the name of the encoding of a text's first bytes: a UTF-8, a UTF-16, or ``latin-1`` which fits all."""
    if head.startswith(b"\xef\xbb\xbf"):
        return "utf-8-sig"
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    even, odd = head[:4096:2].count(0), head[1:4096:2].count(0)
    half = max(len(head[:4096]) // 2, 1)
    # text of a western alphabet in UTF-16 has a NUL in nearly every second byte
    if odd > 0.7 * half and even < 0.1 * half:
        return "utf-16-le"
    if even > 0.7 * half and odd < 0.1 * half:
        return "utf-16-be"
    try:
        head[: max(len(head) - 3, 1)].decode("utf-8")
    except UnicodeDecodeError as fault:
        return "utf-8" if fault.start >= len(head) - 6 else "latin-1"
    return "utf-8"


def head_lines(head: bytes, encoding: str) -> list[str]:
    """Return the lines of a head, the last one (maybe cut) left out where there are several."""
    text = head.decode(encoding, errors="replace").replace("\0", "").lstrip("\ufeff")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if (lines and lines[-1] == "") or (len(lines) > 1 and len(head) >= HEAD_BYTES):
        lines.pop()
    return lines


def is_number(cell: str, decimal_comma: bool = False) -> bool:
    """True for a cell that holds one number."""
    cell = cell.strip().strip('"')
    return bool(_NUMBER.match(cell)) or (decimal_comma and bool(_COMMA_NUMBER.match(cell)))


def is_clock(cell: str) -> bool:
    """True for a cell that holds a time of day or an ISO date and time."""
    return bool(_CLOCK.match(cell.strip().strip('"')))


def split(line: str, separator: str) -> list[str]:
    """Return the cells of a line; an empty ``separator`` means runs of blanks."""
    cells = line.split(separator) if separator else line.split()
    return [cell.strip().strip('"').strip() for cell in cells]


def find_layout(path: Path, head: bytes | None = None) -> TextLayout:
    """Return how the table in ``path`` is written, judged by its first 256 kB.

    Raises:
        LeaklineError: TEXT_NOT_A_TABLE where no table of numbers is found; as :func:`read_head`.
    """
    head = read_head(path) if head is None else head
    encoding = encoding_of(head)
    lines = head_lines(head, encoding)
    best = _best_separator(lines)
    if best is None:
        raise LeaklineError(ErrorCode.TEXT_NOT_A_TABLE, Place(path))
    separator, decimal_comma, rows, ragged = best
    first = _first_data_line(lines, separator, decimal_comma, rows)
    header, units, start = _header_above(lines, first, separator)
    width = max(rows, len(header))
    columns = tuple(header[i] if i < len(header) and header[i] else f"column {i + 1}" for i in range(width))
    units = [units[i] if i < len(units) and units[i] else _bracketed(columns[i]) for i in range(width)]
    sample = tuple(tuple(split(line[:65536], separator)) for line in lines[first : first + 64] if not _skipped(line))
    return TextLayout(
        encoding=encoding,
        separator=separator,
        decimal_comma=decimal_comma,
        columns=columns,
        units=tuple(units),
        data_line=first + 1,
        has_header=bool(header),
        width=rows,
        ragged=ragged,
        preamble=tuple(lines[:start]),
        clock_column=next((i for i, cell in enumerate(sample[0][:4]) if is_clock(cell)), None),
        sample=sample,
    )


def _skipped(line: str) -> bool:
    bare = line.strip()
    return not bare or bare.startswith(COMMENTS) or bare.lower().startswith("sep=")


def _row_like(cells: list[str], decimal_comma: bool) -> int:
    """How many cells are numbers (or a clock), 0 where too few are to call it a row of numbers."""
    good = sum(is_number(c, decimal_comma) for c in cells)
    good += any(is_clock(c) for c in cells[:3])
    return good if good >= 2 and good + sum(c == "" for c in cells) >= 0.5 * len(cells) else 0


def _best_separator(lines: list[str]) -> tuple[str, bool, int, bool] | None:
    """The separator under which most lines are rows of numbers of one width; ties go to more numbers in a row."""
    sample = [line for line in lines if not _skipped(line)]
    sample = sample[:20] + sample[20 :: max(len(sample) // 180, 1)][:180]
    best: tuple[float, tuple[str, bool, int, bool]] | None = None
    for separator, decimal_comma in (
        (",", False),
        (";", False),
        ("\t", False),
        (";", True),
        ("\t", True),
        ("", False),
        ("", True),
    ):
        widths: dict[int, int] = {}
        goods: dict[int, int] = {}
        for line in sample:
            cells = split(line[:65536], separator)
            if (good := _row_like(cells, decimal_comma)) and len(cells) <= MAX_COLUMNS:
                widths[len(cells)] = widths.get(len(cells), 0) + 1
                goods[len(cells)] = goods.get(len(cells), 0) + good
        if not widths:
            continue
        width = max(widths, key=lambda w: (widths[w], w))
        score = goods[width]
        if best is None or score > best[0]:
            ragged = widths[width] < 0.9 * sum(widths.values())
            best = (score, (separator, decimal_comma, width, ragged))
    return None if best is None else best[1]


def _first_data_line(lines: list[str], separator: str, decimal_comma: bool, width: int) -> int:
    for number, line in enumerate(lines):
        if _skipped(line):
            continue
        cells = split(line[:65536], separator)
        if len(cells) >= min(width, 2) and abs(len(cells) - width) <= 1 and _row_like(cells, decimal_comma):
            return number
    return 0  # not reached: _best_separator has seen such a line


def _header_above(lines: list[str], first: int, separator: str) -> tuple[list[str], list[str], int]:
    """Names and units from up to three rows of words right above the numbers, and the line where they begin."""
    rows: list[list[str]] = []
    at = first - 1
    width = len(split(lines[first], separator))
    while at >= 0 and len(rows) < 3:
        line = lines[at]
        bare = line.strip()
        if not bare or bare.lower().startswith("sep="):
            break
        commented = bare.startswith(COMMENTS)
        cells = split(bare.lstrip("#/% \t") if commented else line, separator)
        if abs(len(cells) - width) > 1 or (commented and rows) or sum(is_number(c) for c in cells) > 0.3 * len(cells):
            break
        rows.insert(0, cells)
        at -= 1
        if commented:
            break
    rows = _drop_titles(rows)
    units: list[str] = []
    if len(rows) > 1 and all(_UNIT_ROW.match(c) for c in rows[-1]):
        units = [c.strip("[]() ") for c in rows.pop()]
    if not rows:
        return [], units, first
    names = [" ".join(dict.fromkeys(r[i] for r in rows if i < len(r) and r[i])) for i in range(max(map(len, rows)))]
    return names, units, at + 1


def _drop_titles(rows: list[list[str]]) -> list[list[str]]:
    """A title line that happens to be as wide as the table is mostly empty; a row of names is not."""
    while len(rows) > 1 and sum(c != "" for c in rows[0]) < 0.5 * len(rows[0]):
        rows = rows[1:]
    return rows


def _bracketed(name: str) -> str:
    found = re.search(r"[\[(]([^\])]*)[\])]\s*$", name)
    return found[1].strip() if found else ""
