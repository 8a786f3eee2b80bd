"""Writes the layers as Shapefiles: ``leaks.shp`` and its companions, in UTF-8, each told its coordinate system.

dBase allows ten characters in a column's name and 254 bytes in a text; what had to be cut is told.
"""

import io
from pathlib import Path

import shapefile

from processing.reporting.files import whole_path
from processing.reporting.handover.columns import Column, ColumnKind
from processing.reporting.handover.layers import Cell, Layer, Layers, Shape
from processing.reporting.handover.outcome import Written
from processing.reporting.handover.system import TargetSystem
from processing.survey import Finding, FloatArray, Severity

FOLDER = "shapefile"
LONGEST_TEXT = 254  # bytes
NUMBER_WIDTH = 19  # digits with sign and point


def write_shapefiles(folder: Path, layers: Layers) -> Written:
    """Write each layer that has features into ``folder``: .shp, .shx, .dbf, .cpg, and .prj where the place is known.

    Raises OSError and shapefile.ShapefileException.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    cut: list[str] = []
    for layer in layers.all:
        if layer.features:
            files += _write_layer(folder, layer, layers.system, cut)
    findings: tuple[Finding, ...] = ()
    if cut:
        told: dict[str, str | float] = {
            "file": f"{FOLDER}/",
            "columns": ", ".join(dict.fromkeys(cut)),
            "bytes": LONGEST_TEXT,
        }
        findings = (Finding("handover_text_cut", Severity.WARNING, told),)
    return Written(tuple(files), findings)


def _write_layer(folder: Path, layer: Layer, system: TargetSystem, cut: list[str]) -> list[Path]:
    shp, shx, dbf = io.BytesIO(), io.BytesIO(), io.BytesIO()
    kind = shapefile.POINTZ if layer.shape is Shape.POINT else shapefile.POLYLINEZ
    with shapefile.Writer(shp=shp, shx=shx, dbf=dbf, shapeType=kind, encoding="utf-8") as writer:
        for i, column in enumerate(layer.columns):
            _declare(writer, column, max((_width(f.cells[i]) for f in layer.features), default=1))
        for feature, points in zip(layer.features, layer.coordinates(system), strict=True):
            _add_shape(writer, layer.shape, points)
            writer.record(*(_fitted(v, c, cut) for v, c in zip(feature.cells, layer.columns, strict=True)))
    parts = {".shp": shp.getvalue(), ".shx": shx.getvalue(), ".dbf": dbf.getvalue(), ".cpg": b"UTF-8"}
    if not system.is_local:
        parts[".prj"] = system.wkt("WKT1_ESRI").encode("ascii", "replace")
    written = []
    for suffix, data in parts.items():
        path = folder / f"{layer.name}{suffix}"
        with whole_path(path) as aside:
            aside.write_bytes(data)
        written.append(path)
    return written


def _declare(writer: "shapefile.Writer", column: Column, widest: int) -> None:
    if column.kind is ColumnKind.INTEGER:
        writer.field(column.short, "N", 9, 0)
    elif column.kind is ColumnKind.REAL:
        writer.field(column.short, "N", NUMBER_WIDTH, column.digits)
    else:
        writer.field(column.short, "C", min(max(widest, 16), LONGEST_TEXT))


def _add_shape(writer: "shapefile.Writer", shape: Shape, points: FloatArray) -> None:
    if shape is Shape.POINT:
        writer.pointz(*(float(v) for v in points[0]))
    else:
        writer.linez([points.tolist()])


def _width(value: Cell) -> int:
    return len(value.encode("utf-8", "ignore")) if isinstance(value, str) else 1


def _fitted(value: Cell, column: Column, cut: list[str]) -> Cell:
    """A text of at most 254 bytes, cut between characters: a half one would make the row unreadable."""
    if not isinstance(value, str):
        return "" if value is None and column.kind is ColumnKind.TEXT else value  # pyshp would write "None"
    told = value.encode("utf-8", "ignore")
    if len(told) <= LONGEST_TEXT:
        return told.decode("utf-8")
    cut.append(column.short)
    return told[:LONGEST_TEXT].decode("utf-8", "ignore").rstrip()  # dBase fills up with blanks
