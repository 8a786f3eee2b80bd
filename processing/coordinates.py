"""Places of a survey: the local frame at the launch, WGS 84, and the grids of the utility's map.

The local frame is east-north with ``up`` the height above the launch. East and north are the exact ellipsoidal tangent
coordinates (by way of earth-centred ones) of the point's foot at the launch's height; ``up`` follows the local
vertical, as gravity, levels and maps do, so a level main stays level over 20 km, where a tangent plane rises by 31 m.
Heights pass through unchanged: no geoid model is at work. Grids take east before north and longitude before latitude.
"""

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError
from processing.survey import FloatArray, Launch, Route, Survey, TiePoint

LOCAL = "local"

# WGS 84 (NIMA TR8350.2): semi-major axis and first eccentricity squared
_SEMI_MAJOR_M = 6378137.0
_FLATTENING = 1.0 / 298.257223563
_ECCENTRICITY2 = _FLATTENING * (2.0 - _FLATTENING)

_WGS84 = "EPSG:4326"
_EPSG = re.compile(r"(?:EPSG:)?(\d{4,6})", re.IGNORECASE)


@dataclass(frozen=True)
class LocalFrame:
    """The launch as origin: ``latitude`` and ``longitude`` in degrees, None where it is only known locally.

    ``grid`` is the system in which the survey's own east and north are given (``local`` or ``EPSG:n``);
    ``grid_origin`` are the launch's coordinates there, ``height_m`` its elevation (0 where unknown).
    """

    latitude: float | None = None
    longitude: float | None = None
    height_m: float = 0.0
    grid: str = LOCAL
    grid_origin: tuple[float, float] = (0.0, 0.0)

    @property
    def is_geographic(self) -> bool:
        """Whether local places have a latitude and a longitude."""
        return self.latitude is not None

    def to_geographic(self, points_w_m: npt.ArrayLike) -> FloatArray:
        """Return latitude, longitude (degrees), elevation (m), shape (n, 3), of local places (n, 3).

        Raises ValueError where the launch has no latitude: ask :attr:`is_geographic` first.
        """
        points = _rows(points_w_m)
        lat0, lon0 = self._origin()
        tangent = points.copy()
        tangent[:, 2] = 0.0
        geographic = points
        for _ in range(4):  # sink each foot from the tangent plane to the launch's height; gains five digits a turn
            geographic = _geodetic(_from_tangent(tangent, lat0, lon0, self.height_m))
            tangent[:, 2] += self.height_m - geographic[:, 2]
        geographic[:, 2] = self.height_m + points[:, 2]
        return geographic

    def from_geographic(self, lat_lon_height: npt.ArrayLike) -> FloatArray:
        """Return local places (n, 3) of latitude, longitude (degrees) and elevation (m), shape (n, 3)."""
        places = _rows(lat_lon_height)
        lat0, lon0 = self._origin()
        feet = places.copy()
        feet[:, 2] = self.height_m
        local = _to_tangent(_earth_centred(feet), lat0, lon0, self.height_m)
        local[:, 2] = places[:, 2] - self.height_m
        return local

    def to_grid(self, points_w_m: npt.ArrayLike, crs: str) -> FloatArray:
        """Return east, north, elevation (n, 3), metres in ``crs``, of local places (n, 3).

        ``local`` gives the survey's local grid, in which the launch keeps its own east and north.

        Raises:
            LeaklineError: CRS_UNKNOWN for a code that does not exist.
        """
        points = _rows(points_w_m)
        if is_local(crs):
            east, north = self.grid_origin if is_local(self.grid) else (0.0, 0.0)
            return np.asarray(points + np.array([east, north, 0.0]))
        geographic = self.to_geographic(points)
        x, y = _from_degrees(crs, geographic[:, 1], geographic[:, 0])
        return np.column_stack([x, y, geographic[:, 2]])

    def from_grid(self, points: npt.ArrayLike, crs: str) -> FloatArray:
        """Return local places (n, 3) of east, north, elevation (n, 3) in ``crs``; the inverse of :meth:`to_grid`."""
        places = _rows(points)
        if is_local(crs):
            east, north = self.grid_origin if is_local(self.grid) else (0.0, 0.0)
            return np.asarray(places - np.array([east, north, 0.0]))
        longitude, latitude = _to_degrees(crs, places[:, 0], places[:, 1])
        return self.from_geographic(np.column_stack([latitude, longitude, places[:, 2]]))

    def _origin(self) -> tuple[float, float]:
        if self.latitude is None or self.longitude is None:
            raise ValueError("the launch has no latitude and longitude")
        return self.latitude, self.longitude


def local_frame(launch: Launch, route: Route | None = None) -> LocalFrame:
    """Return the local frame of a launch; one without coordinates borrows those of the mapped route's first point.

    Raises:
        LeaklineError: CRS_UNKNOWN; LAUNCH_INCOMPLETE for half a coordinate pair, or a CRS without coordinates;
            LAUNCH_INVALID for a latitude or longitude that does not exist.
    """
    crs = LOCAL if is_local(launch.crs) else crs_code(str(launch.crs))
    height = launch.elevation_m or 0.0
    if (launch.latitude is None) != (launch.longitude is None):
        raise LeaklineError(ErrorCode.LAUNCH_INCOMPLETE)
    if (launch.east_m is None) != (launch.north_m is None):
        raise LeaklineError(ErrorCode.LAUNCH_INCOMPLETE)
    grid_origin = (launch.east_m or 0.0, launch.north_m or 0.0)
    if launch.latitude is not None and launch.longitude is not None:
        _check_degrees(launch.latitude, launch.longitude)
        return LocalFrame(launch.latitude, launch.longitude, height, crs, grid_origin)
    if not is_local(crs):
        if launch.east_m is None:
            raise LeaklineError(ErrorCode.LAUNCH_INCOMPLETE)
        return _at_grid_point(crs, grid_origin, height)
    if route is not None and not is_local(route.crs) and route.points:
        east, north, up = route.points[0]
        on_map = _at_grid_point(crs_code(route.crs), (east, north), launch.elevation_m or up)
        return LocalFrame(on_map.latitude, on_map.longitude, on_map.height_m, LOCAL, grid_origin)
    return LocalFrame(height_m=height, grid_origin=grid_origin)


def frame_of(survey: Survey) -> LocalFrame:
    """Return the local frame of a survey; errors as :func:`local_frame`."""
    return local_frame(survey.launch, survey.route)


def tie_place(frame: LocalFrame, tie: TiePoint) -> tuple[float, float, float | None] | None:
    """Return the local place of a tie point, up None where unknown; None where it has no usable coordinates.

    East and north are in the launch's CRS, else metres from the local origin. ``up_m`` is an elevation where the launch
    has a CRS, else metres above the launch. Latitude and longitude win over east and north.
    """
    elevation = not is_local(frame.grid)
    up = None if tie.up_m is None else tie.up_m - (frame.height_m if elevation else 0.0)
    if tie.latitude is not None and tie.longitude is not None:
        if not frame.is_geographic:
            return None
        local = frame.from_geographic([[tie.latitude, tie.longitude, frame.height_m]])[0]
    elif tie.east_m is not None and tie.north_m is not None:
        local = frame.from_grid([[tie.east_m, tie.north_m, frame.height_m]], frame.grid)[0]
    else:
        return None
    return float(local[0]), float(local[1]), up


def route_local(frame: LocalFrame, route: Route) -> FloatArray:
    """Return the route's points (n, 3) in the local frame.

    In a CRS the third coordinate is an elevation; where the launch's elevation is 0 or unknown, that of the first point
    stands for it, so that the path begins at up = 0.

    Raises:
        LeaklineError: CRS_UNKNOWN; LAUNCH_INCOMPLETE where the route has a CRS and the launch no place in the world.
    """
    points = _rows(route.points) if route.points else np.empty((0, 3))
    if is_local(route.crs):
        return points
    if not frame.is_geographic:
        raise LeaklineError(ErrorCode.LAUNCH_INCOMPLETE)
    local = frame.from_grid(points, crs_code(route.crs))
    if frame.height_m == 0.0 and len(local):
        local[:, 2] -= local[0, 2]
    return local


def is_local(crs: str | None) -> bool:
    """Return whether ``crs`` names the local frame (or nothing)."""
    return crs is None or crs.strip().lower() in ("", LOCAL)


def crs_code(crs: str) -> str:
    """Return ``EPSG:n`` for a map projection that PROJ knows; raises LeaklineError CRS_UNKNOWN for any other text.

    Systems of degrees, heights or earth-centred coordinates have no east and north in metres and are refused.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    found = _EPSG.fullmatch(crs.strip())
    if found is None:
        raise LeaklineError(ErrorCode.CRS_UNKNOWN, crs=crs)
    try:
        known = CRS.from_epsg(int(found.group(1)))
    except CRSError:
        raise LeaklineError(ErrorCode.CRS_UNKNOWN, crs=crs) from None
    if not known.is_projected:
        raise LeaklineError(ErrorCode.CRS_UNKNOWN, crs=crs)
    return f"EPSG:{found.group(1)}"


def _at_grid_point(crs: str, point: tuple[float, float], height_m: float) -> LocalFrame:
    longitude, latitude = _to_degrees(crs, np.array([point[0]]), np.array([point[1]]))
    _check_degrees(float(latitude[0]), float(longitude[0]))
    back = np.ravel(_from_degrees(crs, longitude, latitude))
    if not np.allclose(back, point, atol=1.0):  # far outside of its zone a projection gives places that are none
        raise LeaklineError(ErrorCode.LAUNCH_INVALID, latitude=float(latitude[0]), longitude=float(longitude[0]))
    return LocalFrame(float(latitude[0]), float(longitude[0]), height_m, crs, point)


def _check_degrees(latitude: float, longitude: float) -> None:
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):  # also false for NaN and the infinity of a failed grid
        raise LeaklineError(ErrorCode.LAUNCH_INVALID, latitude=latitude, longitude=longitude)


def _to_degrees(crs: str, east_m: FloatArray, north_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return longitude and latitude of places in ``crs``; in a system of feet too, ours are metres."""
    from pyproj import CRS, Transformer

    grid = CRS.from_user_input(crs_code(crs))
    metres = grid.axis_info[0].unit_conversion_factor
    longitude, latitude = Transformer.from_crs(grid, _WGS84, always_xy=True).transform(
        east_m / metres, north_m / metres
    )
    return np.asarray(longitude, dtype=np.float64), np.asarray(latitude, dtype=np.float64)


def _from_degrees(crs: str, longitude: FloatArray, latitude: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return east and north (m) in ``crs``; the inverse of :func:`_to_degrees`."""
    from pyproj import CRS, Transformer

    grid = CRS.from_user_input(crs_code(crs))
    metres = grid.axis_info[0].unit_conversion_factor
    east, north = Transformer.from_crs(_WGS84, grid, always_xy=True).transform(longitude, latitude)
    return np.asarray(east, dtype=np.float64) * metres, np.asarray(north, dtype=np.float64) * metres


def _rows(points: npt.ArrayLike) -> FloatArray:
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _earth_centred(geographic: FloatArray) -> FloatArray:
    """Earth-centred coordinates (n, 3) of latitude, longitude (degrees), height."""
    lat, lon = np.radians(geographic[:, 0]), np.radians(geographic[:, 1])
    normal = _SEMI_MAJOR_M / np.sqrt(1.0 - _ECCENTRICITY2 * np.sin(lat) ** 2)
    across = (normal + geographic[:, 2]) * np.cos(lat)
    polar = (normal * (1.0 - _ECCENTRICITY2) + geographic[:, 2]) * np.sin(lat)
    return np.column_stack([across * np.cos(lon), across * np.sin(lon), polar])


def _geodetic(centred: FloatArray) -> FloatArray:
    """Latitude, longitude (degrees), height (n, 3) of earth-centred points (n, 3); Bowring 1976, two turns."""
    x, y, z = centred.T
    across = np.hypot(x, y)
    minor = _SEMI_MAJOR_M * (1.0 - _FLATTENING)
    second = _ECCENTRICITY2 / (1.0 - _ECCENTRICITY2)
    reduced = np.arctan2(z * _SEMI_MAJOR_M, across * minor)
    lat = reduced
    for _ in range(2):
        lat = np.arctan2(
            z + second * minor * np.sin(reduced) ** 3, across - _ECCENTRICITY2 * _SEMI_MAJOR_M * np.cos(reduced) ** 3
        )
        reduced = np.arctan2((1.0 - _FLATTENING) * np.sin(lat), np.cos(lat))
    normal = _SEMI_MAJOR_M / np.sqrt(1.0 - _ECCENTRICITY2 * np.sin(lat) ** 2)
    # holds at the poles too, where across / cos(lat) does not
    height = across * np.cos(lat) + z * np.sin(lat) - _SEMI_MAJOR_M**2 / normal
    return np.column_stack([np.degrees(lat), np.degrees(np.arctan2(y, x)), height])


def _tangent_axes(latitude: float, longitude: float) -> FloatArray:
    """Rows east, north, up in earth-centred coordinates."""
    lat, lon = np.radians(latitude), np.radians(longitude)
    return np.array(
        [
            [-np.sin(lon), np.cos(lon), 0.0],
            [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)],
            [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)],
        ]
    )


def _to_tangent(centred: FloatArray, latitude: float, longitude: float, height_m: float) -> FloatArray:
    origin = _earth_centred(np.array([[latitude, longitude, height_m]]))
    return np.asarray((centred - origin) @ _tangent_axes(latitude, longitude).T)


def _from_tangent(tangent: FloatArray, latitude: float, longitude: float, height_m: float) -> FloatArray:
    origin = _earth_centred(np.array([[latitude, longitude, height_m]]))
    return np.asarray(tangent @ _tangent_axes(latitude, longitude) + origin)
