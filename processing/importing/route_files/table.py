"""Reads lines from delimited text: named columns of coordinates in any order, or a column of WKT."""

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.route_files.lines import (
    MAX_TEXT_BYTES,
    WGS84,
    CrsSource,
    LineCollector,
    RouteFile,
    check_size,
    damaged,
    name_of,
    read_bytes,
)
from processing.importing.text_layout import TextLayout, encoding_of, find_layout, is_number, read_head, split
from processing.progress import Progress
from processing.survey import FloatArray

_COLUMNS: dict[str, tuple[str, ...]] = {
    "lon": ("lon", "lng", "long", "longitude", "boylam"),
    "lat": ("lat", "latitude", "enlem"),
    "east": ("east", "easting", "e", "x", "xcoord", "pointx", "doğu", "dogu", "sağa", "saga"),
    "north": ("north", "northing", "n", "y", "ycoord", "pointy", "kuzey", "yukarı", "yukari"),
    "up": ("up", "z", "elevation", "elev", "height", "h", "alt", "altitude", "kot", "yükseklik", "yukseklik", "rakım"),
    "chainage": ("chainage", "station", "km", "metraj", "mesafe"),
    "line": ("line", "lineid", "route", "routeid", "pipe", "pipeid", "hat", "hatno", "part"),
}
_WKT = re.compile(r"(MULTI)?LINESTRING\s*(?:ZM|Z|M)?\s*\(", re.IGNORECASE)
_SRID = re.compile(r"SRID\s*=\s*(\d{4,6})\s*;", re.IGNORECASE)
_WKT_CELL = 8_000_000


def read_table(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of a table, one point a row; an empty row or another value in a column *line* begins a new one.

    Raises:
        LeaklineError: COLUMN_MISSING, TEXT_NOT_A_TABLE, VALUE_NOT_A_NUMBER with its line, ROUTE_EMPTY, ROUTE_TOO_MANY;
            those of reading.
    """
    check_size(path, MAX_TEXT_BYTES)
    head = read_head(path)
    progress.update(0.0, "route_reading")
    encoding = encoding_of(head)
    if _WKT.search(head.decode(encoding, errors="replace")):
        return _read_wkt(path, encoding)
    return _read_columns(path, find_layout(path, head))


# --- one point a row ----------------------------------------------------------------------------------------------


def _read_columns(path: Path, layout: TextLayout) -> RouteFile:
    columns = _columns_of(path, layout)
    degrees = "lon" in columns and "lat" in columns
    pair = ("lon", "lat") if degrees else ("east", "north")
    text = read_bytes(path, MAX_TEXT_BYTES).decode(layout.encoding, errors="replace")
    wanted = [columns[pair[0]], columns[pair[1]], *([columns["up"]] if "up" in columns else [])]
    collector = LineCollector(path)
    rows: list[list[float]] = []
    chainages: list[float] = []
    before: str | None = None

    def end_line() -> None:
        collector.add(before, path.stem, _in_order(rows, chainages))
        rows.clear()
        chainages.clear()

    for number, line in enumerate(text.splitlines(), start=1):
        if number < layout.data_line or line.lstrip().startswith("#"):
            continue
        cells = split(line, layout.separator)
        if not any(cells):
            end_line()
            continue
        called = cells[columns["line"]] if "line" in columns and columns["line"] < len(cells) else None
        if called != before:
            end_line()
            before = called
        rows.append([_number(path, number, cells, at, layout, needed=nth < 2) for nth, at in enumerate(wanted)])
        if "chainage" in columns:
            chainages.append(_number(path, number, cells, columns["chainage"], layout, needed=False))
        collector.expect(len(rows))
    end_line()
    lines, findings = collector.finish()
    if degrees:
        return RouteFile(path, "CSV", lines, WGS84, CrsSource.FILE, findings)
    return RouteFile(path, "CSV", lines, None, CrsSource.ASK, findings)


def _columns_of(path: Path, layout: TextLayout) -> dict[str, int]:
    found: dict[str, int] = {}
    names = [_bare(name) for name in layout.columns]
    for role, known in _COLUMNS.items():
        at = next((names.index(name) for name in known if name in names), None)
        if at is not None:
            found[role] = at
    if "lon" in found and "lat" in found:
        return found
    if "east" in found and "north" in found:
        return found
    if not layout.has_header and layout.width in (2, 3):
        return dict(zip(("east", "north", "up"), range(layout.width), strict=False))
    missing = "north" if "east" in found else "lat" if "lon" in found else "lon" if "lat" in found else "east"
    raise LeaklineError(ErrorCode.COLUMN_MISSING, Place(path), column_name=missing)


def _bare(name: str) -> str:
    """A column's name without its unit: ``East (m)``, ``up_m`` and ``EAST`` are the same."""
    folded = re.sub(r"[\[(].*?[\])]", "", name.casefold().replace("i̇", "i")).strip()
    folded = re.sub(r"[_ ](m|metre|meter|deg|ft)$", "", folded)
    return re.sub(r"[\s_.\-]", "", folded)


def _number(path: Path, line: int, cells: list[str], at: int, layout: TextLayout, *, needed: bool) -> float:
    cell = cells[at] if at < len(cells) else ""
    if is_number(cell, layout.decimal_comma):
        return float(cell.replace(",", ".") if layout.decimal_comma else cell)
    if needed:
        raise LeaklineError(ErrorCode.VALUE_NOT_A_NUMBER, Place(path, line=line, column=at + 1), value=cell[:40])
    return float("nan")


def _in_order(rows: list[list[float]], chainages: list[float]) -> FloatArray:
    points = np.array(rows, dtype=np.float64)
    along = np.array(chainages)
    if len(along) == len(points) and np.isfinite(along).all():
        return np.asarray(points[np.argsort(along, kind="stable")])
    return points


# --- WKT ----------------------------------------------------------------------------------------------------------


def _read_wkt(path: Path, encoding: str) -> RouteFile:
    text = read_bytes(path, MAX_TEXT_BYTES).decode(encoding, errors="replace").replace("\0", "").lstrip("\ufeff")
    collector = LineCollector(path)
    srid = _SRID.search(text)
    for name, geometry in _geometries(path, text):
        found = _WKT.search(geometry)
        if found is None:
            continue
        for part in re.findall(r"\(([^()]*)\)", geometry[found.end() - 1 :]):
            rows = [position.split() for position in part.split(",") if position.strip()]
            width = min(map(len, rows), default=0)
            try:
                numbers = [[float(n) for n in row[: min(width, 3)]] for row in rows]
            except ValueError:
                raise damaged(path, f"WKT: {part[:60]}") from None
            measured = re.search(r"LINESTRING\s*M\b", geometry, re.IGNORECASE) is not None
            collector.add(name, path.stem, numbers, has_z=width > 2 and not measured)
    lines, findings = collector.finish()
    crs = None if srid is None else f"EPSG:{srid.group(1)}"
    return RouteFile(path, "CSV", lines, crs, CrsSource.ASK if crs is None else CrsSource.FILE, findings)


def _geometries(path: Path, text: str) -> Iterator[tuple[str, str]]:
    lines = text.splitlines()
    first = next((line.strip() for line in lines if line.strip()), "")
    if _WKT.match(_SRID.sub("", first)):
        yield from (("", line) for line in lines)
        return
    separator = max(";,\t|", key=first.count)
    before = csv.field_size_limit(_WKT_CELL)
    try:
        for row in csv.DictReader(lines, delimiter=separator):
            cells = {key: value for key, value in row.items() if isinstance(key, str) and isinstance(value, str)}
            geometry = next((value for value in cells.values() if _WKT.search(value)), None)
            if geometry is not None:
                yield name_of({key: value for key, value in cells.items() if value != geometry}), geometry
    except csv.Error as fault:
        raise damaged(path, fault) from None
    finally:
        csv.field_size_limit(before)
