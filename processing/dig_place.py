"""Where a dig found the leak, along the path: from a tape, a chainage, or coordinates of the place."""

import re
from dataclasses import dataclass

import numpy as np

from processing.coordinates import LocalFrame
from processing.errors import ErrorCode, LeaklineError
from processing.survey import FloatArray, Track

_ANOTHER_PASS = 0.002  # metres of distance that a metre along the pipe is worth: of two passes the nearer one along it
_MOST_ROWS = 200_000
FAR_M = 100.0  # farther beside the path nobody has dug up its pipe: numbers were mistyped or changed places
_NORTH, _EAST = "NSKG", "EWDB"  # English and Turkish (kuzey, güney, doğu, batı); the second of each pair is negative
_NEGATIVE = "SGWB"


@dataclass(frozen=True)
class Projected:
    """A place on the path: ``across_m`` is how far beside it, positive to the right as seen away from the launch."""

    chainage_m: float
    across_m: float


def local_place(text: str, frame: LocalFrame) -> tuple[float, float]:
    """Return the local east and north of typed coordinates: latitude and longitude, or east and north of the grid.

    Two numbers apart by a comma with a blank, a blank, a semicolon or a slash; decimal points or commas. Where they can
    be degrees and the survey has a place in the world, they are taken for degrees. Letters of the compass (``75.2 W``,
    ``32,85 D``) give sign and order.

    Raises:
        LeaklineError: PLACE_UNREADABLE for anything else.
    """
    numbers = _pair(text)
    if numbers is None:
        raise LeaklineError(ErrorCode.PLACE_UNREADABLE, text=text[:80])
    (first, axis), (second, other) = numbers
    if axis and axis == other:
        raise LeaklineError(ErrorCode.PLACE_UNREADABLE, text=text[:80])
    if axis == _EAST or other == _NORTH:
        east, north = first, second
    elif axis == _NORTH or other == _EAST:
        east, north = second, first
    else:  # as people say them: degrees of latitude first, metres east first
        degrees = frame.is_geographic and abs(first) <= 90.0 and abs(second) <= 180.0
        east, north = (second, first) if degrees else (first, second)
    if frame.is_geographic and abs(north) <= 90.0 and abs(east) <= 180.0:
        local = frame.from_geographic([[north, east, frame.height_m]])[0]
    else:
        local = frame.from_grid([[east, north, frame.height_m]], frame.grid)[0]
    if not np.all(np.isfinite(local)):
        raise LeaklineError(ErrorCode.PLACE_UNREADABLE, text=text[:80])
    return float(local[0]), float(local[1])


def _pair(text: str) -> tuple[tuple[float, str], tuple[float, str]] | None:
    """Return two numbers, each with the letters of its axis where one of them was written at it."""
    bare = text.replace("°", " ").replace("\N{MINUS SIGN}", "-").strip().upper()
    letter = f"[{_NORTH}{_EAST}]"
    # N 39.92 or 39.92 N: the letter stands at its number
    bare = re.sub(rf"({letter})\s+", r"\1", bare) if bare[:1].isalpha() else re.sub(rf"\s+({letter})", r"\1", bare)
    parts = re.split(r"\s*[;/]\s*|,\s+|\s+", bare)
    if len(parts) == 1 and bare.count(",") == 1 and "." in bare:
        parts = bare.split(",")  # 39.92,32.85
    if len(parts) != 2:
        return None
    first, second = (_number(part) for part in parts)
    return None if first is None or second is None else (first, second)


def _number(part: str) -> tuple[float, str] | None:
    """Return a number and the letters of its axis; south and west are negative, whether or not a sign says so too."""
    found = re.fullmatch(rf"([{_NORTH}{_EAST}])?([-+]?[\d.,]+)([{_NORTH}{_EAST}])?", part)
    if found is None or (found[1] and found[3]):
        return None
    try:
        value = float(found[2].replace(",", "."))
    except ValueError:
        return None
    letter = found[1] or found[3] or ""
    axis = _NORTH if letter and letter in _NORTH else _EAST if letter else ""
    return (-abs(value) if letter and letter in _NEGATIVE else value), axis


def on_path(track: Track, east_m: float, north_m: float, near_m: float | None = None) -> Projected:
    """Return the nearest place of the path in plan; where it passes twice, that closer along the pipe to ``near_m``."""
    step = max(1, len(track.time_s) // _MOST_ROWS)
    rows = np.unique(np.append(np.arange(0, len(track.time_s), step), len(track.time_s) - 1))
    plan, chainage = track.position_w_m[rows, :2], track.chainage_m[rows]
    start, way = plan[:-1], np.diff(plan, axis=0)
    length2 = np.einsum("ij,ij->i", way, way)
    away = np.array([east_m, north_m]) - start
    part = np.clip(np.einsum("ij,ij->i", away, way) / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
    beside: FloatArray = away - part[:, None] * way
    distance = np.hypot(beside[:, 0], beside[:, 1])
    along = chainage[:-1] + part * np.diff(chainage)
    cost = distance if near_m is None else distance + _ANOTHER_PASS * np.abs(along - near_m)
    cost = np.where(length2 > 0.0, cost, np.inf)
    if not np.any(np.isfinite(cost)):
        return Projected(float(chainage[0]), float(np.hypot(*away[0])))
    best = int(np.argmin(cost))
    cross = way[best, 0] * away[best, 1] - way[best, 1] * away[best, 0]
    return Projected(float(along[best]), float(-np.sign(cross) * distance[best]))
