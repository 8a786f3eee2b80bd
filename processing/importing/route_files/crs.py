"""The coordinate systems of map files: what a text names, which ones there are, and the way into a route's grid.

A system is ``EPSG:n``, ``local``, or a WKT that no EPSG code fits. Coordinates go east before north and longitude
before latitude. A :class:`~processing.survey.Route` holds metres of a map projection with an EPSG code or local ones:
degrees, and grids without a code, become metres of the UTM zone (WGS 84) they lie in.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from processing.coordinates import LOCAL, is_local
from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files.lines import WGS84, RouteLineString
from processing.survey import FloatArray

MAX_WKT = 64_000
_CODE = re.compile(
    r"(?:(?:urn:ogc:def:crs:|https?://www\.opengis\.net/def/crs/)?EPSG[:/](?:[\d.]*[:/])?)?(\d{4,6})", re.IGNORECASE
)
_CRS84 = re.compile(r".*\bCRS:?84h?", re.IGNORECASE)


@dataclass(frozen=True)
class CrsEntry:
    """A system to choose from; ``area`` is where it is used, in words, and ``bounds`` west, south, east, north (°)."""

    code: str
    name: str
    area: str
    bounds: tuple[float, float, float, float]


def known_crs(text: str) -> str:
    """Return ``EPSG:n`` or ``local`` of what a file or an operator calls a system of two dimensions.

    Raises:
        LeaklineError: CRS_UNKNOWN.
    """
    told = text.strip()
    if is_local(told):
        return LOCAL
    if _CRS84.fullmatch(told):
        return WGS84
    found = _CODE.fullmatch(told)
    if found is None or not _usable(_from_code(int(found.group(1)))):
        raise LeaklineError(ErrorCode.CRS_UNKNOWN, crs=told[:80])
    return f"EPSG:{found.group(1)}"


def crs_of_wkt(text: str) -> str | None:
    """Return the ``EPSG:n`` that a WKT is the same as, else the WKT itself; None for what is no map's system."""
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    if len(text) > MAX_WKT:
        return None
    try:
        told = CRS.from_wkt(text)
        code = told.to_epsg(min_confidence=25)
    except CRSError:
        return None
    if not _usable(told):
        return None
    if code is not None and _same_places(told, _from_code(code)):
        return f"EPSG:{code}"
    return text


def is_degrees(crs: str) -> bool:
    """Return whether x and y of a system are longitude and latitude."""
    return not is_local(crs) and bool(_system(crs).is_geographic)


def crs_name(crs: str) -> str:
    """Return what a system is called, ``local`` as it is."""
    return LOCAL if is_local(crs) else str(_system(crs).name)


def area_of(crs: str) -> tuple[float, float, float, float] | None:
    """Return west, south, east, north (degrees) of where a system is meant to be used, None where that is unsaid."""
    area = None if is_local(crs) else _system(crs).area_of_use
    return None if area is None else (area.west, area.south, area.east, area.north)


def metres_scale(crs: str, points: FloatArray) -> tuple[float, float]:
    """Return about how many metres one unit of x and of y is where ``points`` (n, 2 or more) lie."""
    if is_local(crs):
        return 1.0, 1.0
    system = _system(crs)
    if not system.is_geographic:
        unit = float(system.axis_info[0].unit_conversion_factor)
        return unit, unit
    degree = 111_320.0 * float(system.axis_info[0].unit_conversion_factor) / np.radians(1.0)
    return degree * float(np.cos(np.radians(np.clip(np.median(points[:, 1]), -89.0, 89.0)))), degree


def to_degrees(points: FloatArray, crs: str) -> FloatArray:
    """Return longitude, latitude (WGS 84) and z of points (n, 3); not finite where the system does not reach."""
    return _moved(points, crs, WGS84)


def from_degrees(degrees: FloatArray, crs: str) -> FloatArray:
    """Return x and y (n, 2) in a system of longitude and latitude in WGS 84 (n, 2)."""
    return _moved(np.column_stack([degrees, np.zeros(len(degrees))]), WGS84, crs)[:, :2]


def projected_roughly(place: tuple[float, float], crs: str) -> FloatArray | None:
    """Return x and y (2,) of a longitude and latitude without minding the datum: some 300 m wrong, but soon done.

    None for a system of degrees.
    """
    from pyproj import Proj

    system = _system(crs)
    return np.array(Proj(system)(*place)) if system.is_projected else None


def transformed(lines: Iterable[RouteLineString], crs: str, other: str) -> list[RouteLineString]:
    """Return the lines in another system."""
    return [replace(line, points=_moved(line.points, crs, other)) for line in lines]


def in_route_grid(points: FloatArray, crs: str) -> tuple[FloatArray, str]:
    """Return east, north, elevation (n, 3) in metres, and the code of their grid: what a Route holds.

    A projection with an EPSG code is kept, feet become metres; anything else goes into its UTM zone of WGS 84.

    Raises:
        LeaklineError: ROUTE_OUTSIDE_CRS where the system does not reach to these coordinates.
    """
    if is_local(crs):
        return points, LOCAL
    system = _system(crs)
    factors = [float(axis.unit_conversion_factor) for axis in system.axis_info]
    heights_m = points[:, 2] * (factors[2] if len(factors) > 2 else 1.0 if system.is_geographic else factors[0])
    degrees = to_degrees(points, crs)
    if not np.isfinite(degrees).all() or np.abs(degrees[:, 1]).max() > 90.0:
        raise LeaklineError(ErrorCode.ROUTE_OUTSIDE_CRS, crs=crs_label(crs))
    code = _projected_code(crs, system)
    if code is not None:
        return np.column_stack([points[:, :2] * factors[0], heights_m]), code
    code = utm_zone(float(np.median(degrees[:, 0])), float(np.median(degrees[:, 1])))
    return np.column_stack([_moved(points, crs, code)[:, :2], heights_m]), code


def utm_zone(longitude: float, latitude: float) -> str:
    """Return the code of the WGS 84 UTM zone of a place; the widened zones of Norway are not minded."""
    zone = int(np.clip(np.floor((longitude + 180.0) / 6.0) + 1, 1, 60))
    return f"EPSG:{(32600 if latitude >= 0.0 else 32700) + zone}"


def crs_label(crs: str) -> str:
    """Return how a system is shown: its code and name, or the name alone where it has no code."""
    if is_local(crs):
        return LOCAL
    return f"{crs} {crs_name(crs)}" if crs.upper().startswith("EPSG:") else crs_name(crs)


def all_systems() -> tuple[CrsEntry, ...]:
    """Return every map projection and system of degrees that is in use, by code (some 5000; a tenth of a second)."""
    import pyproj  # the package first: a submodule asked for in one thread while another loads the package is half made
    from pyproj.enums import PJType

    query_crs_info = pyproj.database.query_crs_info

    infos = query_crs_info("EPSG", [PJType.PROJECTED_CRS, PJType.GEOGRAPHIC_2D_CRS])
    entries = []
    for info in infos:
        area = info.area_of_use
        if area is not None and not info.deprecated:
            bounds = (area.west, area.south, area.east, area.north)
            entries.append(CrsEntry(f"EPSG:{info.code}", info.name, area.name or "", bounds))
    return tuple(sorted(entries, key=lambda entry: int(entry.code[5:])))


def search(
    entries: Iterable[CrsEntry], text: str, near: tuple[float, float] | None = None, limit: int = 60
) -> list[CrsEntry]:
    """Return the systems whose code, name or area hold all words of ``text``.

    Those meant for ``near`` (longitude, latitude) come first, the ones for smaller areas before those for larger.
    """
    words = text.casefold().split()
    found = [e for e in entries if all(w in f"{e.code} {e.name} {e.area}".casefold() for w in words)]

    def rank(entry: CrsEntry) -> tuple[bool, bool, float, str]:
        west, south, east, north = entry.bounds
        exact = entry.code.casefold() in (text.strip().casefold(), f"epsg:{text.strip()}")
        if near is None:
            return not exact, False, 0.0, ""
        width = east - west if east >= west else east - west + 360.0
        inside = (near[0] - west) % 360.0 <= width and south <= near[1] <= north
        return not exact, not inside, width * (north - south) if inside else 0.0, ""

    return sorted(found, key=rank)[:limit]


def _projected_code(crs: str, system: Any) -> str | None:  # noqa: ANN401  # pyproj is untyped
    """The code under which :func:`processing.coordinates.crs_code` takes a grid, None where there is none."""
    if not system.is_projected or not crs.upper().startswith("EPSG:") or system.is_compound:
        return None
    return crs.upper()


def _usable(system: Any) -> bool:  # noqa: ANN401
    return bool(system is not None and (system.is_projected or system.is_geographic) and len(system.axis_info) >= 2)


def _from_code(code: int) -> Any:  # noqa: ANN401
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        return CRS.from_epsg(code)
    except CRSError:
        return None


def _system(crs: str) -> Any:  # noqa: ANN401
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    found = _CODE.fullmatch(crs)
    try:
        return CRS.from_epsg(int(found.group(1))) if found is not None else CRS.from_wkt(crs)
    except CRSError:
        raise LeaklineError(ErrorCode.CRS_UNKNOWN, crs=crs[:80]) from None


def _same_places(told: Any, known: Any) -> bool:  # noqa: ANN401
    """Whether a code found by likeness puts the same numbers at the same places, to a millimetre."""
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    if not _usable(known) or told.is_geographic != known.is_geographic or told.datum is None:
        return False
    area = known.area_of_use
    if area is None:
        return False
    if told.is_geographic:  # a datum has many names; the library knows them
        same_earth = told.ellipsoid.semi_major_metre == known.ellipsoid.semi_major_metre
        return bool(same_earth and told.to_epsg(min_confidence=70) == known.to_epsg())
    try:
        to_told = Transformer.from_crs(known.geodetic_crs, told, always_xy=True)
        to_known = Transformer.from_crs(known.geodetic_crs, known, always_xy=True)
        longitude = (area.west + (area.east - area.west) % 360.0 * 0.3 + 180.0) % 360.0 - 180.0
        latitude = 0.3 * area.south + 0.7 * area.north
        one, other = to_told.transform(longitude, latitude), to_known.transform(longitude, latitude)
    except ProjError:
        return False
    return bool(np.isfinite(one).all() and np.allclose(one, other, rtol=0.0, atol=0.001))


def _moved(points: FloatArray, crs: str, other: str) -> FloatArray:
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    try:
        move = Transformer.from_crs(_system(crs), _system(other), always_xy=True)
    except ProjError:  # no way is known from the one to the other
        raise LeaklineError(ErrorCode.ROUTE_OUTSIDE_CRS, crs=crs_label(other if crs == WGS84 else crs)) from None
    x, y = move.transform(points[:, 0], points[:, 1])
    return np.column_stack([x, y, points[:, 2]])
