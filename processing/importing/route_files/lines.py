"""What every reader of route files gives: named lines with their coordinates, and how much of them is allowed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place
from processing.survey import Finding, FloatArray, Severity

MAX_BYTES = 200_000_000
MAX_TEXT_BYTES = 64_000_000  # a parsed JSON or XML tree takes some twenty times its text
MAX_POINTS = 2_000_000
MAX_LINES = 100_000
WGS84 = "EPSG:4326"

_NAMES = (
    "name", "pipe_id", "pipeid", "label", "adi", "adı", "ad", "isim", "hat_adi", "hat", "id", "objectid", "fid",
)  # fmt: skip


class CrsSource(StrEnum):
    """Where the coordinate system of a route file is known from."""

    FILE = "file"  # the file, or one beside it, names it
    FORMAT = "format"  # the format allows no other
    ASK = "ask"  # nothing tells: the operator has to


@dataclass(frozen=True)
class RouteLineString:
    """One line of the map: ``points`` (n, 3), n ≥ 2, all finite: x (east, longitude), y (north, latitude), z.

    x and y are in the units of the file's coordinate system; z is 0 where ``has_z`` is False.
    """

    name: str
    layer: str
    points: FloatArray
    has_z: bool


@dataclass(frozen=True)
class RouteFile:
    """The lines of one file, all in ``crs``: ``EPSG:n``, ``local``, or WKT; None where the operator has to tell.

    ``unit_m`` is what one unit is in metres where the file says so itself (a drawing), else None: the unit of ``crs``.
    """

    path: Path
    format: str
    lines: tuple[RouteLineString, ...]
    crs: str | None
    crs_source: CrsSource
    findings: tuple[Finding, ...] = ()
    unit_m: float | None = None


class LineCollector:
    """Gathers lines while a file is read, and stops at what no route needs."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines: list[RouteLineString] = []
        self._points = 0
        self._unusable = 0

    def add(self, name: object, layer: str, coordinates: npt.ArrayLike, *, has_z: bool | None = None) -> None:
        """Take the coordinates (n, 2 or more) of one line; rows that are not finite are left out.

        ``has_z`` None: where there is a third column. A line of fewer than two points is none.

        Raises:
            LeaklineError: ROUTE_TOO_MANY; ROUTE_DAMAGED where the coordinates are no table of numbers.
        """
        try:
            given = np.asarray(coordinates, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise damaged(self.path, "coordinates") from None
        if given.size == 0:
            return
        if given.ndim != 2 or given.shape[1] < 2:
            raise damaged(self.path, "coordinates")
        self.expect(len(given))
        third = given.shape[1] > 2 if has_z is None else has_z and given.shape[1] > 2
        points = np.zeros((len(given), 3))
        points[:, : 3 if third else 2] = given[:, : 3 if third else 2]
        if third and not np.isfinite(points[:, 2]).all():  # a height that is missing somewhere is no height
            third, points[:, 2] = False, 0.0
        good = np.isfinite(points).all(axis=1) & (np.abs(points) < 1e9).all(axis=1)
        self._unusable += int(np.count_nonzero(~good))
        points = points[good]
        if len(points) < 2:
            return
        self._points += len(points)
        if len(self.lines) >= MAX_LINES:
            raise LeaklineError(ErrorCode.ROUTE_TOO_MANY, Place(self.path), points=MAX_POINTS, lines=MAX_LINES)
        shown = str(name).strip() if name is not None else ""
        self.lines.append(RouteLineString(printable(shown, 120), printable(layer, 120), points, third))

    def expect(self, points: int) -> None:
        """Refuse what would be too much, before it is held.

        Raises:
            LeaklineError: ROUTE_TOO_MANY.
        """
        if self._points + points > MAX_POINTS:
            raise LeaklineError(ErrorCode.ROUTE_TOO_MANY, Place(self.path), points=MAX_POINTS, lines=MAX_LINES)

    def finish(self) -> tuple[tuple[RouteLineString, ...], tuple[Finding, ...]]:
        """Return the lines, and a finding for points that were no numbers.

        Raises:
            LeaklineError: ROUTE_EMPTY.
        """
        if not self.lines:
            raise LeaklineError(ErrorCode.ROUTE_EMPTY, Place(self.path))
        if not self._unusable:
            return tuple(self.lines), ()
        return tuple(self.lines), (Finding("route_points_unusable", Severity.WARNING, {"count": self._unusable}),)


def read_bytes(path: Path, limit: int = MAX_BYTES) -> bytes:
    """Return the content of a file of at most ``limit`` bytes.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, FILE_EMPTY, FILE_TOO_LARGE.
    """
    check_size(path, limit)
    try:
        with path.open("rb") as file:
            return file.read(limit)
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None


def check_size(path: Path, limit: int = MAX_BYTES) -> int:
    """Return the size of a file; raises as :func:`read_bytes`."""
    try:
        size = path.stat().st_size
    except FileNotFoundError:
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path)) from None
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None
    if not path.is_file():
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason="not a file")
    if size == 0:
        raise LeaklineError(ErrorCode.FILE_EMPTY, Place(path))
    if size > limit:
        raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), size_mb=size / 1e6, limit_mb=limit / 1e6)
    return size


def damaged(path: Path, what: object, *, line: int | None = None, byte: int | None = None) -> LeaklineError:
    """Return the error of a file whose inside contradicts its format; ``what`` says where in words of the format."""
    return LeaklineError(ErrorCode.ROUTE_DAMAGED, Place(path, line=line, byte=byte), what=printable(str(what), 160))


def name_column(columns: Sequence[str]) -> int | None:
    """Return which attribute names a line to people, None where none does."""
    folded = [column.casefold().strip() for column in columns]
    return next((folded.index(name) for name in _NAMES if name in folded), None)


def name_of(properties: Mapping[str, object]) -> str:
    """Return what the attributes call a line, empty where nothing does."""
    columns = list(properties)
    at = name_column(columns)
    value = None if at is None else properties[columns[at]]
    return "" if value is None or isinstance(value, list | dict) else str(value)


def printable(text: str, longest: int) -> str:
    """Return ``text`` in one line without control characters, cut to ``longest``."""
    return "".join(c if c.isprintable() else " " for c in text[:longest]).strip()
