"""Reads lines from GeoJSON (RFC 7946), the older form with a ``crs`` member (2008), and our own exports."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from processing.errors import LeaklineError
from processing.importing.route_files.crs import known_crs
from processing.importing.route_files.lines import (
    MAX_TEXT_BYTES,
    WGS84,
    CrsSource,
    LineCollector,
    RouteFile,
    damaged,
    name_of,
    printable,
    read_bytes,
)
from processing.progress import Progress
from processing.survey import Finding, Severity

MAX_DEPTH = 8


def read_geojson(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of a GeoJSON file.

    Raises:
        LeaklineError: ROUTE_DAMAGED with the line, ROUTE_EMPTY, ROUTE_TOO_MANY; those of reading.
    """
    data = read_bytes(path, MAX_TEXT_BYTES)
    progress.update(0.1, "route_reading")
    try:
        document = json.loads(data.decode("utf-8-sig", errors="replace"))
    except json.JSONDecodeError as fault:
        raise damaged(path, fault.msg, line=fault.lineno) from None
    except (ValueError, RecursionError) as fault:
        raise damaged(path, fault) from None
    if not isinstance(document, dict):
        raise damaged(path, "FeatureCollection")
    progress.update(0.6)
    collector = LineCollector(path)
    layer = printable(str(document.get("name") or path.stem), 120)
    for feature in _features(document, path):
        properties = feature.get("properties")
        properties = properties if isinstance(properties, dict) else {}
        kind = properties.get("kind")
        name = name_of(properties) or (kind if isinstance(kind, str) else "")
        for coordinates in _lines(feature.get("geometry"), path):
            collector.add(name, layer, _even(coordinates))
    lines, findings = collector.finish()
    crs, source = _crs(document)
    if crs == WGS84 and any(abs(line.points[:, :2]).max() > 360.0 for line in lines):
        findings += (Finding("route_not_degrees", Severity.WARNING),)
        crs, source = None, CrsSource.ASK
    return RouteFile(path, "GeoJSON", lines, crs, source, findings)


def _features(document: dict[str, Any], path: Path) -> Iterator[dict[str, Any]]:
    if document.get("type") == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise damaged(path, "features")
        yield from (feature for feature in features if isinstance(feature, dict))
    elif document.get("type") == "Feature":
        yield document
    else:
        yield {"geometry": document}


def _lines(geometry: object, path: Path, depth: int = 0) -> Iterator[list[Any]]:
    if geometry is None:
        return
    if not isinstance(geometry, dict) or depth > MAX_DEPTH:
        raise damaged(path, "geometry")
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind == "GeometryCollection":
        for one in _list(geometry.get("geometries"), path):
            yield from _lines(one, path, depth + 1)
    elif kind == "LineString":
        yield _list(coordinates, path)
    elif kind == "MultiLineString":
        for part in _list(coordinates, path):
            yield _list(part, path)


def _even(coordinates: list[Any]) -> list[Any]:
    """Positions cut to one width: some writers give a height to some of them only."""
    widths = {len(c) if isinstance(c, list) else 0 for c in coordinates}
    width = min(widths, default=0)
    return coordinates if len(widths) == 1 and width <= 3 else [c[: min(width, 3)] for c in coordinates if width]


def _list(value: object, path: Path) -> list[Any]:
    if not isinstance(value, list):
        raise damaged(path, "coordinates")
    return value


def _crs(document: dict[str, Any]) -> tuple[str | None, CrsSource]:
    if str(document.get("frame", "")).startswith("local"):  # our own export of a survey without coordinates
        return "local", CrsSource.FILE
    member = document.get("crs")
    if not isinstance(member, dict):
        return WGS84, CrsSource.FORMAT
    properties = member.get("properties")
    name = properties.get("name") if isinstance(properties, dict) else None
    try:
        return known_crs(str(name)), CrsSource.FILE
    except LeaklineError:
        return None, CrsSource.ASK  # it names a system, but none that can be known
