"""The one table of what a route can be imported from, and the door to it: told by content first, then by name."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.route_files import dxf, geojson, geopackage, kml, shape, table
from processing.importing.route_files.archive import members_of
from processing.importing.route_files.lines import RouteFile
from processing.importing.text_layout import read_head
from processing.progress import Progress, silent


@dataclass(frozen=True)
class RouteFormat:
    """A kind of map file; ``suffixes`` are its usual ends of names."""

    name: str
    title: str
    suffixes: tuple[str, ...]
    read: Callable[[Path, Progress], RouteFile]


ROUTE_FORMATS: tuple[RouteFormat, ...] = (
    RouteFormat("geojson", "GeoJSON", (".geojson", ".json"), geojson.read_geojson),
    RouteFormat("shape", "Shapefile", (".shp",), shape.read_shape),
    RouteFormat("shape_zip", "Shapefile (zip)", (".zip",), shape.read_zipped_shape),
    RouteFormat("geopackage", "GeoPackage", (".gpkg",), geopackage.read_geopackage),
    RouteFormat("kml", "KML", (".kml",), kml.read_kml),
    RouteFormat("kmz", "KMZ", (".kmz",), kml.read_kmz),
    RouteFormat("gpx", "GPX", (".gpx",), kml.read_gpx),
    RouteFormat("dxf", "DXF", (".dxf",), dxf.read_dxf),
    RouteFormat("table", "CSV, WKT", (".csv", ".txt", ".wkt", ".tsv"), table.read_table),
)
_SHAPE_PARTS = (".shx", ".dbf", ".prj", ".cpg", ".sbn", ".sbx")


def read_route_file(path: Path, progress: Progress | None = None) -> RouteFile:
    """Return the lines of a map file of any known format.

    Raises:
        LeaklineError: ROUTE_FORMAT_UNKNOWN; ROUTE_DAMAGED, ROUTE_EMPTY, ROUTE_TOO_MANY, FILE_TOO_LARGE and what the
            reader of its format names. Cancelled passes through.
    """
    progress = progress or silent()
    if path.suffix.casefold() in _SHAPE_PARTS and path.with_suffix(".shp").is_file():
        path = path.with_suffix(".shp")
    wanted = format_of(path)
    progress.update(0.0, "route_reading")
    return {entry.name: entry for entry in ROUTE_FORMATS}[wanted].read(path, progress)


def looks_like_route(path: Path) -> bool:
    """Tell by its name whether a file is surely a map: tables and texts may be a logger's, and are not."""
    known = {suffix for entry in ROUTE_FORMATS if entry.name != "table" for suffix in entry.suffixes}
    return path.suffix.casefold() in known | set(_SHAPE_PARTS)


def format_of(path: Path) -> str:
    """Return the name of a file's format, by its first bytes where they tell, else by its name.

    Raises:
        LeaklineError: ROUTE_FORMAT_UNKNOWN; FILE_MISSING, FILE_UNREADABLE, FILE_EMPTY.
    """
    head = read_head(path, 4096)
    by_content = _by_content(path, head)
    if by_content is not None:
        return by_content
    suffix = path.suffix.casefold()
    by_name = next((entry.name for entry in ROUTE_FORMATS if suffix in entry.suffixes), None)
    if by_name is None:
        known = " ".join(suffix for entry in ROUTE_FORMATS for suffix in entry.suffixes)
        raise LeaklineError(ErrorCode.ROUTE_FORMAT_UNKNOWN, Place(path), known=known)
    return by_name


def _by_content(path: Path, head: bytes) -> str | None:
    magic = ((b"SQLite format 3\0", "geopackage"), (b"\x00\x00\x27\x0a", "shape"), (b"AutoCAD Binary DXF", "dxf"))
    for start, name in magic:
        if head.startswith(start):
            return name
    if head.startswith(b"PK\x03\x04"):
        names = [member.filename.casefold() for member in members_of(path)]
        return "shape_zip" if any(name.endswith(".shp") for name in names) else "kmz"
    text = head.decode("utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig", errors="ignore").lstrip()
    if text.startswith("<"):
        return "gpx" if "<gpx" in text else "kml" if "<kml" in text or path.suffix.casefold() != ".gpx" else "gpx"
    if text.startswith("{"):
        return "geojson"
    return "dxf" if text[:40].split()[:2] == ["0", "SECTION"] or text.startswith("999") else None
