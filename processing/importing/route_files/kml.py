"""Reads lines from KML and KMZ (OGC 12-007r2) and GPX (1.0, 1.1): longitude and latitude in WGS 84."""

import xml.etree.ElementTree as ET  # only its plain tree, made by xml_tree
from collections.abc import Iterator
from pathlib import Path

from processing.importing.route_files.archive import members_of, read_member
from processing.importing.route_files.lines import (
    MAX_TEXT_BYTES,
    WGS84,
    CrsSource,
    LineCollector,
    RouteFile,
    damaged,
    read_bytes,
)
from processing.importing.route_files.xml_tree import xml_tree
from processing.progress import Progress

_FOLDERS = ("Document", "Folder")


def read_kml(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of a KML file; heights count where they are said to be absolute.

    Raises:
        LeaklineError: ROUTE_DAMAGED with the line, ROUTE_EMPTY, ROUTE_TOO_MANY; those of reading.
    """
    return _kml(path, read_bytes(path, MAX_TEXT_BYTES), progress)


def read_kmz(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of the first KML file in a KMZ; errors as :func:`read_kml`, FILE_TOO_LARGE for a zip bomb."""
    found = [member for member in members_of(path) if member.filename.casefold().endswith(".kml")]
    if not found:
        raise damaged(path, "KMZ: doc.kml")
    main = next((member for member in found if member.filename.casefold() == "doc.kml"), found[0])
    return _kml(path, read_member(path, main, MAX_TEXT_BYTES), progress)


def read_gpx(path: Path, progress: Progress) -> RouteFile:
    """Return tracks and routes of a GPX file; errors as :func:`read_kml`."""
    data = read_bytes(path, MAX_TEXT_BYTES)
    progress.update(0.1, "route_reading")
    root = xml_tree(path, data)
    collector = LineCollector(path)
    for kind, part, point in (("trk", "trkseg", "trkpt"), ("rte", None, "rtept")):
        for one in root.iter(kind):
            for segment in one.iter(part) if part else (one,):
                rows = [_gpx_point(p, path) for p in segment.iter(point)]
                heights = bool(rows) and all(len(row) == 3 for row in rows)
                collector.add(one.findtext("name"), kind, [row if heights else row[:2] for row in rows])
    lines, findings = collector.finish()
    return RouteFile(path, "GPX", lines, WGS84, CrsSource.FORMAT, findings)


def _gpx_point(point: ET.Element, path: Path) -> list[float]:
    height = (point.findtext("ele") or "").strip()
    try:
        place = [float(point.attrib["lon"]), float(point.attrib["lat"])]
        return [*place, float(height)] if height else place
    except (KeyError, ValueError):
        raise damaged(path, f"GPX: <{point.tag}>") from None


def _kml(path: Path, data: bytes, progress: Progress) -> RouteFile:
    progress.update(0.1, "route_reading")
    root = xml_tree(path, data)
    progress.update(0.6)
    collector = LineCollector(path)
    for layer, mark in _placemarks(root, path.stem):
        for line in mark.iter("LineString"):
            rows = [_tuple(word, path) for word in (line.findtext("coordinates") or "").split()]
            absolute = (line.findtext("altitudeMode") or "").strip() == "absolute"
            heights = absolute and all(len(row) > 2 for row in rows)
            collector.add(mark.findtext("name"), layer, [row[: 3 if heights else 2] for row in rows])
    lines, findings = collector.finish()
    return RouteFile(path, "KML", lines, WGS84, CrsSource.FORMAT, findings)


def _placemarks(element: ET.Element, layer: str) -> Iterator[tuple[str, ET.Element]]:
    """Every place mark with the name of the folder it lies in; the tree is at most a hundred deep."""
    for child in element:
        if child.tag == "Placemark":
            yield layer, child
        else:
            named = child.findtext("name") if child.tag in _FOLDERS else None
            yield from _placemarks(child, (named or "").strip() or layer)


def _tuple(word: str, path: Path) -> list[float]:
    try:
        row = [float(number) for number in word.split(",") if number]
    except ValueError:
        raise damaged(path, f"KML: <coordinates> {word[:40]}") from None
    if len(row) < 2:
        raise damaged(path, f"KML: <coordinates> {word[:40]}")
    return row
