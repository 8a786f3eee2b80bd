"""The coordinate system that map files are written in: its unit, its name, and the way into it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from processing.coordinates import LOCAL, LocalFrame, is_local
from processing.importing.route_files.crs import area_of, crs_label, crs_name, is_degrees, known_crs, utm_zone
from processing.quantities import METRES_PER_US_FOOT, Units
from processing.reporting.options import HandoverOptions
from processing.survey import FloatArray

INTERNATIONAL_FOOT_M = 0.3048
UNIT_TOLERANCE = 1e-9
WGS84 = "EPSG:4326"


@dataclass(frozen=True)
class TargetSystem:
    """``crs`` is ``EPSG:n`` or ``local``; one unit of x and y is ``unit_m`` metres, and is called ``unit`` in names.

    ``unit`` is ``m``, ``ft``, ``ftus``, ``deg``, or ``unit`` for a rare one (yards, links, chains).
    """

    frame: LocalFrame
    crs: str
    unit: str
    unit_m: float

    @property
    def is_local(self) -> bool:
        """Whether places are only known from the launch, not in the world."""
        return is_local(self.crs)

    @property
    def is_degrees(self) -> bool:
        """Whether x and y are longitude and latitude."""
        return self.unit == "deg"

    @property
    def code(self) -> int | None:
        """The EPSG number."""
        return None if self.is_local else int(self.crs.split(":")[1])

    @property
    def label(self) -> str:
        """``EPSG:2263 NAD83 / New York Long Island (ftUS)``, or ``local``."""
        return crs_label(self.crs)

    @property
    def name(self) -> str:
        """What the register calls it."""
        return crs_name(self.crs)

    def wkt(self, version: str) -> str:
        """Return the system as WKT1 (``WKT1_GDAL`` or ``WKT1_ESRI``); not for a local one."""
        from pyproj import CRS

        return str(CRS.from_user_input(self.crs).to_wkt(version))

    def coordinates(self, points_w_m: FloatArray) -> FloatArray:
        """Return x (east), y (north) and z, shape (n, 3), of local places (n, 3).

        x and y are in the system's own unit, longitude before latitude; z is the height in the same unit, in metres
        beside degrees. It is an elevation where the launch's is known, else above the launch.
        """
        points = np.asarray(points_w_m, dtype=np.float64).reshape(-1, 3)
        if self.is_local:
            return np.asarray(self.frame.to_grid(points, LOCAL) / self.unit_m)
        degrees = self.frame.to_geographic(points)
        height = degrees[:, 2] / (1.0 if self.is_degrees else self.unit_m)
        if self.crs == WGS84:
            return np.column_stack([degrees[:, 1], degrees[:, 0], height])
        x, y = _transformer(self.crs).transform(degrees[:, 1], degrees[:, 0])
        return np.column_stack([x, y, height])

    def holds(self, points_w_m: FloatArray) -> bool:
        """Return whether the system is meant for these places: inside of its area of use."""
        area = None if self.is_local else area_of(self.crs)
        if area is None:
            return True
        west, south, east, north = area
        degrees = self.frame.to_geographic(np.asarray(points_w_m).reshape(-1, 3))
        across = (degrees[:, 1] - west) % 360.0 <= (east - west) % 360.0
        if east - west >= 360.0:
            across[:] = True
        return bool(np.all(across & (degrees[:, 0] >= south) & (degrees[:, 0] <= north)))


def target_system(frame: LocalFrame, options: HandoverOptions) -> TargetSystem:
    """Return the system to write in: the chosen one, else the survey's own, else the UTM zone of the launch.

    Without a known launch it is ``local``, whatever was chosen, in metres, as map programs take an unnamed system.

    Raises:
        LeaklineError: CRS_UNKNOWN for a code that does not exist.
    """
    if not frame.is_geographic:
        return TargetSystem(frame, LOCAL, "m", 1.0)
    chosen = options.crs.strip()
    if is_local(chosen):
        chosen = proposed(frame)
    return _system(frame, known_crs(chosen))


def proposed(frame: LocalFrame) -> str:
    """Return the system that nobody chose: the survey's own, else the UTM zone of the launch; ``local`` without one."""
    if not frame.is_geographic:
        return LOCAL
    assert frame.latitude is not None  # what geographic means
    assert frame.longitude is not None
    return utm_zone(frame.longitude, frame.latitude) if is_local(frame.grid) else frame.grid


def for_drawing(system: TargetSystem, options: HandoverOptions) -> TargetSystem:
    """Return a system for drawings, which know no degrees and tell their unit.

    It is the given one, or the UTM zone of the launch in place of degrees, or local feet where lengths are in feet.
    """
    if system.is_local and options.units is Units.US:
        return TargetSystem(system.frame, LOCAL, "ftus", METRES_PER_US_FOOT)
    return _system(system.frame, proposed(system.frame)) if system.is_degrees else system


def wgs84(frame: LocalFrame) -> TargetSystem:
    """Return longitude and latitude, as KML and GPX have them."""
    return _system(frame, WGS84)


def _system(frame: LocalFrame, crs: str) -> TargetSystem:
    from pyproj import CRS

    if is_degrees(crs):
        return TargetSystem(frame, crs, "deg", 1.0)
    unit_m = float(CRS.from_user_input(crs).axis_info[0].unit_conversion_factor)
    return TargetSystem(frame, crs, _unit_name(unit_m), unit_m)


def _unit_name(unit_m: float) -> str:
    for name, metres in (("m", 1.0), ("ftus", METRES_PER_US_FOOT), ("ft", INTERNATIONAL_FOOT_M)):
        if abs(unit_m - metres) < UNIT_TOLERANCE:
            return name
    return "unit"


def _transformer(crs: str) -> Any:  # noqa: ANN401  # pyproj is untyped
    from pyproj import Transformer

    return Transformer.from_crs(WGS84, crs, always_xy=True)
