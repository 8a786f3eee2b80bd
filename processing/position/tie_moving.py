"""Tie points moved by hand: what a tie point says after it was put elsewhere on the plan or at another moment."""

from dataclasses import replace

import numpy as np

from processing.coordinates import LocalFrame
from processing.survey import FloatArray, TiePoint

_AS_NEAR_M = 2.0  # places of a path that are this much further away are as good: the one near the old chainage counts


def moved_on_plan(
    tie: TiePoint, place_m: tuple[float, float], frame: LocalFrame, path_m: FloatArray, chainage_m: FloatArray
) -> TiePoint:
    """Return the tie point at local east and north ``place_m``, in the terms it is told in.

    Coordinates stay coordinates of their kind. A tie point that only has a chainage slides along the path ``path_m``
    (k, 2 or more) with ``chainage_m`` (k,), to where it passes nearest; of several passes the one nearest to its old
    chainage. One that says nothing yet becomes a place in the survey's own system.
    """
    east, north = place_m
    local = np.array([[east, north, 0.0]])
    if tie.latitude is not None and tie.longitude is not None and frame.is_geographic:
        latitude, longitude, _ = frame.to_geographic(local)[0]
        return replace(tie, latitude=round(float(latitude), 8), longitude=round(float(longitude), 8))
    if tie.chainage_m is not None and tie.east_m is None:
        return replace(tie, chainage_m=_rounded(_nearest_chainage(place_m, path_m, chainage_m, tie.chainage_m)))
    grid = frame.to_grid(local, frame.grid)[0]
    return replace(tie, east_m=_rounded(float(grid[0])), north_m=_rounded(float(grid[1])))


def moved_in_time(tie: TiePoint, time_s: float, start_s: float, end_s: float) -> TiePoint:
    """Return the tie point at another moment, within the run."""
    return replace(tie, time_s=_rounded(min(max(time_s, start_s), end_s)))


def _rounded(value: float) -> float:
    return round(value, 3)  # a hand is no better than a millimetre


def _nearest_chainage(
    place_m: tuple[float, float], path_m: FloatArray, chainage_m: FloatArray, before_m: float
) -> float:
    start, step = path_m[:-1, :2], np.diff(path_m[:, :2], axis=0)
    length2 = np.maximum(np.sum(step**2, axis=1), 1e-12)
    part = np.clip(np.sum((np.array(place_m) - start) * step, axis=1) / length2, 0.0, 1.0)
    away = np.hypot(*(start + part[:, None] * step - np.array(place_m)).T)
    chainage = chainage_m[:-1] + part * np.diff(chainage_m)
    near = np.flatnonzero(away <= float(np.min(away)) + _AS_NEAR_M)
    # each pass of the path has its own nearest place
    passes = [p[np.argmin(away[p])] for p in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)]
    return float(min((chainage[k] for k in passes), key=lambda c: abs(c - before_m)))
