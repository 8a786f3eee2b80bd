"""Writes ``survey.gpkg``: a GeoPackage (OGC 12-128r19) with a layer for each table and their QGIS styles.

Written with SQLite alone, so that GDAL can check it as a stranger. Coordinates go x (east, longitude) before y,
whatever the register says of the axes, as the standard wants.
"""

import sqlite3
import struct
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from processing.reporting.files import whole_path
from processing.reporting.handover.columns import ColumnKind
from processing.reporting.handover.layers import Layer, Layers, Shape
from processing.reporting.handover.qgis_styles import STYLES, style
from processing.reporting.handover.system import TargetSystem
from processing.reporting.handover.words import HandoverWords
from processing.survey import FloatArray

FILE_NAME = "survey.gpkg"
APPLICATION_ID = 0x47504B47  # "GPKG"
VERSION = 10300
UNDEFINED_CARTESIAN = -1
POINT_Z, LINE_Z = 1001, 1002  # ISO well-known binary
ENVELOPE_XY = 0b011  # little-endian, with the envelope of x and y
_SQL_KINDS = {ColumnKind.INTEGER: "INTEGER", ColumnKind.REAL: "REAL", ColumnKind.TEXT: "TEXT"}

_TABLES = """
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL,
 organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
 description TEXT DEFAULT '', last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
 min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
 CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,
 geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
 CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name), CONSTRAINT uk_gc_table_name UNIQUE (table_name),
 CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
 CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
CREATE TABLE layer_styles (id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, f_table_catalog TEXT(256),
 f_table_schema TEXT(256), f_table_name TEXT(256), f_geometry_column TEXT(256), styleName TEXT(30), styleQML TEXT,
 styleSLD TEXT, useAsDefault BOOLEAN, description TEXT, owner TEXT(30), ui TEXT(30),
 update_time DATETIME DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')));
"""


def write_geopackage(path: Path, layers: Layers, title: str, words: HandoverWords) -> None:
    """Write all layers into one file; ``title`` heads their descriptions, ``words`` are those of the legend.

    Raises OSError and sqlite3.Error.
    """
    with whole_path(path) as aside, closing(sqlite3.connect(aside)) as database:
        database.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        database.execute(f"PRAGMA user_version = {VERSION}")
        database.executescript(_TABLES)
        with database:
            srs_id = _write_systems(database, layers.system)
            for layer in layers.all:
                _write_layer(database, layer, layers.system, srs_id, title)
            _write_styles(database, layers, words)


def _write_systems(database: sqlite3.Connection, system: TargetSystem) -> int:
    """Write the systems that the standard asks for, and ours; return the number of ours."""
    from pyproj import CRS

    rows = [
        ("Undefined cartesian SRS", -1, "NONE", -1, "undefined", "undefined cartesian coordinate reference system"),
        ("Undefined geographic SRS", 0, "NONE", 0, "undefined", "undefined geographic coordinate reference system"),
        ("WGS 84 geodetic", 4326, "EPSG", 4326, CRS.from_epsg(4326).to_wkt("WKT1_GDAL"), "longitude and latitude"),
    ]
    code = system.code
    if code is not None and code != 4326:
        rows.append((system.name, code, "EPSG", code, system.wkt("WKT1_GDAL"), system.label))
    database.executemany("INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, ?)", rows)
    return UNDEFINED_CARTESIAN if code is None else code


def _write_layer(database: sqlite3.Connection, layer: Layer, system: TargetSystem, srs_id: int, title: str) -> None:
    columns = ", ".join(f"{_quoted(column.name)} {_SQL_KINDS[column.kind]}" for column in layer.columns)
    kind = "POINT" if layer.shape is Shape.POINT else "LINESTRING"
    table = _quoted(layer.name)
    database.execute(f"CREATE TABLE {table} (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {kind}, {columns})")
    places = layer.coordinates(system)
    box = _box(places)
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S.000Z")
    about = f"{title} ({system.label})"
    contents = (layer.name, "features", layer.name, about, now, *box, srs_id)
    database.execute("INSERT INTO gpkg_contents VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", contents)
    database.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 1, 0)", (layer.name, kind, srs_id))
    marks = ", ".join("?" * (len(layer.columns) + 1))
    names = ", ".join(["geom", *(_quoted(column.name) for column in layer.columns)])
    rows = (
        (geometry(points, layer.shape, srs_id), *feature.cells)
        for feature, points in zip(layer.features, places, strict=True)
    )
    database.executemany(f"INSERT INTO {table} ({names}) VALUES ({marks})", rows)  # noqa: S608  # quoted above


def geometry(points: FloatArray, shape: Shape, srs_id: int) -> bytes:
    """Return a GeoPackage geometry (clause 2.1.3): header with the envelope, then well-known binary with z."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    head = b"GP" + struct.pack("<BBi", 0, ENVELOPE_XY, srs_id) + struct.pack("<4d", low[0], high[0], low[1], high[1])
    body = np.ascontiguousarray(points, dtype="<f8").tobytes()
    if shape is Shape.POINT:
        return head + struct.pack("<BI", 1, POINT_Z) + body
    return head + struct.pack("<BII", 1, LINE_Z, len(points)) + body


def _write_styles(database: sqlite3.Connection, layers: Layers, words: HandoverWords) -> None:
    for layer in layers.all:
        if layer.name in STYLES:
            qml = style(layer, words.known)
            row = ("", "", layer.name, "geom", "Leakline", qml, 1, "")
            database.execute(
                "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName,"
                " styleQML, useAsDefault, description) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                row,
            )
    database.execute("INSERT INTO gpkg_contents (table_name, data_type, identifier, srs_id)"
                     " VALUES ('layer_styles', 'attributes', 'layer_styles', 0)")  # fmt: skip


def _box(places: list[FloatArray]) -> tuple[float | None, ...]:
    if not places:
        return None, None, None, None
    points = np.concatenate(places)[:, :2]
    return tuple(float(v) for v in (*points.min(axis=0), *points.max(axis=0)))


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
