"""Reads lines from GeoPackage (OGC 12-128r19): an SQLite file opened read-only, its SQL never run."""

import sqlite3
from dataclasses import dataclass
from pathlib import Path

from processing.errors import LeaklineError
from processing.importing.route_files.crs import crs_of_wkt, known_crs, transformed
from processing.importing.route_files.lines import (
    CrsSource,
    LineCollector,
    RouteFile,
    RouteLineString,
    check_size,
    damaged,
    name_column,
)
from processing.importing.route_files.wkb import WkbError, lines_of_wkb
from processing.progress import Progress
from processing.survey import Finding, Severity

MAX_BLOB = 64_000_000
MAX_STEPS = 400  # of a million SQLite instructions each: no honest read of 200 MB takes so many
_ENVELOPES = {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}  # bytes, by the flag (clause 2.1.3)


@dataclass(frozen=True)
class _Layer:
    table: str
    column: str
    crs: str | None


def read_geopackage(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of all feature layers, in the coordinate system of the first of them.

    Raises:
        LeaklineError: ROUTE_DAMAGED, ROUTE_EMPTY, ROUTE_TOO_MANY; those of reading.
    """
    check_size(path)
    try:
        connection = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
        try:
            _guard(connection)
            return _read(connection, path, progress)
        finally:
            connection.close()
    except (sqlite3.Error, UnicodeDecodeError, OverflowError) as fault:
        raise damaged(path, fault) from None


def _guard(connection: sqlite3.Connection) -> None:
    """Give a file that a stranger made no way to run code, to write, or to go on for ever."""
    connection.execute("PRAGMA query_only = ON")
    connection.execute("PRAGMA trusted_schema = OFF")
    connection.execute("PRAGMA cell_size_check = ON")
    connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_BLOB)
    steps = iter(range(MAX_STEPS))
    connection.set_progress_handler(lambda: next(steps, None) is None, 1_000_000)
    connection.text_factory = lambda data: data.decode("utf-8", errors="replace")


def _read(connection: sqlite3.Connection, path: Path, progress: Progress) -> RouteFile:
    layers = _layers(connection, path)
    per_layer: list[tuple[_Layer, tuple[RouteLineString, ...]]] = []
    collector = LineCollector(path)
    for nth, layer in enumerate(layers):
        progress.update(nth / len(layers), "route_reading")
        before = len(collector.lines)
        _read_layer(connection, path, layer, collector)
        per_layer.append((layer, tuple(collector.lines[before:])))
    _, findings = collector.finish()
    filled = [(layer, lines) for layer, lines in per_layer if lines]
    crs = next((layer.crs for layer, _ in filled if layer.crs is not None), None)
    lines: list[RouteLineString] = []
    for layer, own in filled:
        if layer.crs is None and crs is not None:
            findings += (Finding("route_layer_without_crs", Severity.WARNING, {"layer": layer.table}),)
            continue
        lines += own if layer.crs == crs or crs is None or layer.crs is None else transformed(own, layer.crs, crs)
    return RouteFile(path, "GeoPackage", tuple(lines), crs, CrsSource.ASK if crs is None else CrsSource.FILE, findings)


def _layers(connection: sqlite3.Connection, path: Path) -> list[_Layer]:
    rows = connection.execute(
        "SELECT g.table_name, g.column_name, s.organization, s.organization_coordsys_id, s.definition"
        " FROM gpkg_geometry_columns g LEFT JOIN gpkg_spatial_ref_sys s ON s.srs_id = g.srs_id LIMIT 1000"
    ).fetchall()
    # a view of a stranger's is a program of a stranger's: only tables are read
    tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    layers = []
    for table, column, organization, number, definition in rows:
        if isinstance(table, str) and isinstance(column, str) and table in tables:
            layers.append(_Layer(table, column, _crs(organization, number, definition)))
    if not layers:
        raise damaged(path, "gpkg_geometry_columns")
    return layers


def _crs(organization: object, number: object, definition: object) -> str | None:
    try:
        if isinstance(organization, str) and isinstance(number, int) and number > 0 and organization.isalpha():
            return known_crs(f"{organization}:{number}")
    except LeaklineError:
        pass  # a number of its own: the definition tells
    return crs_of_wkt(definition) if isinstance(definition, str) else None


def _read_layer(connection: sqlite3.Connection, path: Path, layer: _Layer, collector: LineCollector) -> None:
    table, geometry = _quoted(layer.table), _quoted(layer.column)
    columns = [str(row[1]) for row in connection.execute(f"PRAGMA table_info({table})")]
    if layer.column not in columns:
        raise damaged(path, f"{layer.table}.{layer.column}")
    at = name_column([c for c in columns if c != layer.column])
    name = "rowid" if at is None else _quoted([c for c in columns if c != layer.column][at])
    for blob, called in connection.execute(f"SELECT {geometry}, {name} FROM {table}"):  # noqa: S608  # quoted above
        if not isinstance(blob, bytes):
            continue
        try:
            for points in lines_of_wkb(_wkb(blob)):
                collector.add(called, layer.table, points)
        except WkbError as fault:
            raise damaged(path, f"{layer.table}: {fault}") from None


def _wkb(blob: bytes) -> bytes:
    """The geometry behind the header (clause 2.1.3: magic, version, flags, reference system, envelope)."""
    if len(blob) < 8 or blob[:2] != b"GP":
        raise WkbError("GeoPackageBinaryHeader")
    envelope = _ENVELOPES.get((blob[3] >> 1) & 0x07)
    if envelope is None:
        raise WkbError("envelope")
    return blob[8 + envelope :]


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
