"""Reads lines from an ESRI Shapefile (white paper of 1998), also one in a zip: .shp, .dbf, .prj, .cpg."""

import codecs
import io
import struct
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np

from processing.importing.route_files.archive import members_of, read_member
from processing.importing.route_files.crs import crs_of_wkt
from processing.importing.route_files.lines import (
    CrsSource,
    LineCollector,
    RouteFile,
    damaged,
    name_column,
    read_bytes,
)
from processing.progress import Progress

_LINES = {3: False, 13: True, 23: False}  # shape type: whether it has heights (15 and 25 would be areas)
_PARTS = (".shp", ".dbf", ".prj", ".cpg")
_FAULTS = (
    struct.error, ValueError, IndexError, KeyError, TypeError, AttributeError, AssertionError, EOFError, OSError,
    OverflowError, MemoryError, RuntimeError,
)  # fmt: skip


def read_shape(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of a Shapefile of the type PolyLine, PolyLineM or PolyLineZ.

    Raises:
        LeaklineError: ROUTE_DAMAGED, ROUTE_EMPTY, ROUTE_TOO_MANY; those of reading.
    """
    parts = {".shp": read_bytes(path)}
    for beside in path.parent.iterdir():
        suffix = beside.suffix.casefold()
        if beside.stem == path.stem and suffix in _PARTS[1:] and beside.is_file() and beside.stat().st_size:
            parts[suffix] = read_bytes(beside)
    return _read(path, path.stem, parts, progress)


def read_zipped_shape(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of the one Shapefile in a zip; errors as :func:`read_shape`, FILE_TOO_LARGE for a bomb."""
    members = members_of(path)
    shapes = [m for m in members if m.filename.casefold().endswith(".shp")]
    if len(shapes) != 1:
        raise damaged(path, f"zip: {len(shapes)} .shp")
    stem = shapes[0].filename[:-4]
    wanted = {m.filename[len(stem) :].casefold(): m for m in members if m.filename.startswith(stem)}
    parts = {suffix: read_member(path, wanted[suffix]) for suffix in _PARTS if suffix in wanted}
    return _read(path, Path(stem).name, parts, progress)


def _read(path: Path, layer: str, parts: dict[str, bytes], progress: Progress) -> RouteFile:
    import shapefile

    progress.update(0.1, "route_reading")
    if len(parts[".shp"]) < 100 or struct.unpack(">i", parts[".shp"][:4])[0] != 9994:
        raise damaged(path, "Shapefile: header", byte=0)
    collector = LineCollector(path)
    opened: dict[str, IO[bytes]] = {"shp": io.BytesIO(parts[".shp"])}
    if ".dbf" in parts:
        opened["dbf"] = io.BytesIO(parts[".dbf"])
    try:
        with warnings.catch_warnings():  # pyshp warns of padding and of sizes in headers, and reads on
            warnings.simplefilter("ignore")
            _collect(
                shapefile.Reader(**opened, encoding=_encoding(parts.get(".cpg")), encodingErrors="replace"),
                layer,
                collector,
                named=".dbf" in parts,
            )
    except (shapefile.ShapefileException, *_FAULTS) as fault:
        raise damaged(path, fault) from None
    lines, findings = collector.finish()
    text = parts.get(".prj", b"").decode("utf-8", errors="replace")
    crs = crs_of_wkt(text) if text.strip() else None
    return RouteFile(path, "Shapefile", lines, crs, CrsSource.ASK if crs is None else CrsSource.FILE, findings)


def _collect(reader: Any, layer: str, collector: LineCollector, *, named: bool) -> None:  # noqa: ANN401
    columns = [str(field[0]) for field in reader.fields if field[0] != "DeletionFlag"]
    at = name_column(columns) if named else None
    names = (record[at] for record in reader.iterRecords()) if at is not None else iter(())
    for shape in reader.iterShapes():
        name = next(names, None)
        if shape.shapeType in _LINES:
            for rows in _parts_of(shape):
                collector.add(name, layer, rows, has_z=_LINES[shape.shapeType])


def _parts_of(shape: Any) -> Iterator[np.ndarray]:  # noqa: ANN401  # pyshp's shapes are untyped
    plane = np.array(shape.points, dtype=np.float64).reshape(len(shape.points), -1)[:, :2]
    heights = np.array(getattr(shape, "z", ()), dtype=np.float64)
    rows = np.column_stack([plane, heights]) if len(heights) == len(plane) and len(plane) else plane
    starts = [int(start) for start in shape.parts]
    for start, end in zip(starts, [*starts[1:], len(rows)], strict=True):
        if not 0 <= start <= end <= len(rows):
            raise ValueError("parts")
        yield rows[start:end]


def _encoding(cpg: bytes | None) -> str:
    """The attributes' encoding; only names come from them, so what nobody knows is read as Latin-1."""
    told = "".join(c for c in (cpg or b"")[:40].decode("ascii", errors="ignore") if c.isalnum() or c in "-_")
    told = f"cp{told}" if told.isdigit() else told.removeprefix("ANSI")
    try:
        return codecs.lookup(told).name if told else "utf-8"
    except LookupError:
        return "latin-1"
