"""The plan view's numbers: metres to pixels with equal scales, a path thinned for the zoom, its nearest moment."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray, Track

Indices = npt.NDArray[np.intp]
FINEST_M = 0.05
FEWEST_POINTS = 400


@dataclass(frozen=True)
class PlanScale:
    """East and north to pixels: ``centre_m`` lies in the middle of ``size`` (pixels), north is up."""

    centre_m: tuple[float, float]
    pixels_per_m: float
    size: tuple[float, float]

    def pixels(self, plane_m: FloatArray) -> FloatArray:
        """Return x and y in pixels (n, 2) of east and north (n, 2 or more)."""
        x = 0.5 * self.size[0] + (plane_m[:, 0] - self.centre_m[0]) * self.pixels_per_m
        y = 0.5 * self.size[1] - (plane_m[:, 1] - self.centre_m[1]) * self.pixels_per_m
        return np.stack((x, y), axis=1)

    def pixel(self, east_m: float, north_m: float) -> tuple[float, float]:
        """Return x and y in pixels of one place."""
        x, y = self.pixels(np.array([[east_m, north_m]]))[0]
        return float(x), float(y)

    def metres(self, x: float, y: float) -> tuple[float, float]:
        """Return east and north of a pixel."""
        east = self.centre_m[0] + (x - 0.5 * self.size[0]) / self.pixels_per_m
        north = self.centre_m[1] - (y - 0.5 * self.size[1]) / self.pixels_per_m
        return east, north

    def zoomed(self, factor: float, x: float, y: float) -> "PlanScale":
        """Return the scale with metres ``factor`` times as large; the place at the pixel stays there."""
        east, north = self.metres(x, y)
        larger = replace(self, pixels_per_m=min(max(self.pixels_per_m * factor, 1e-4), 1e4))
        east_now, north_now = larger.metres(x, y)
        return replace(larger, centre_m=(self.centre_m[0] + east - east_now, self.centre_m[1] + north - north_now))

    def moved(self, dx: float, dy: float) -> "PlanScale":
        """Return the scale with everything moved by pixels."""
        east, north = self.centre_m
        return replace(self, centre_m=(east - dx / self.pixels_per_m, north + dy / self.pixels_per_m))


def fitting(plane_m: FloatArray, size: tuple[float, float], margin: float) -> PlanScale:
    """Return the scale that shows all places (n, 2) within ``size`` less a margin on each side; NaN are passed over."""
    places = plane_m[np.all(np.isfinite(plane_m[:, :2]), axis=1), :2]
    if len(places) == 0:
        return PlanScale((0.0, 0.0), 10.0, size)
    low, high = places.min(axis=0), places.max(axis=0)
    room = np.maximum(np.array(size) - 2.0 * margin, 20.0)
    pixels_per_m = float(np.min(room / np.maximum(high - low, 1.0)))
    middle = 0.5 * (low + high)
    return PlanScale((float(middle[0]), float(middle[1])), pixels_per_m, size)


@dataclass(frozen=True)
class ThinnedPath:
    """A track with lists of ever fewer points: ``levels[k]`` are rows that lie ``FINEST_M · 2**k`` metres apart."""

    time_s: FloatArray  # (m,)
    plane_m: FloatArray  # (m, 2)
    levels: tuple[Indices, ...]

    @classmethod
    def from_track(cls, track: Track | None) -> "ThinnedPath | None":
        """Return the path of a track; None for none or an empty one."""
        if track is None:
            return None
        rows = np.flatnonzero(np.all(np.isfinite(track.position_w_m[:, :2]), axis=1))
        if len(rows) == 0:
            return None
        plane = np.ascontiguousarray(track.position_w_m[rows, :2])
        travelled = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(plane, axis=0).T))))
        levels: list[Indices] = []
        apart = FINEST_M
        while not levels or len(levels[-1]) > FEWEST_POINTS:
            cells = np.floor(travelled / apart)
            keep = np.flatnonzero(np.diff(cells, prepend=-1.0, append=np.inf)[:-1] > 0)
            levels.append(np.unique(np.append(keep, len(plane) - 1)))
            apart *= 2.0
            if apart > 1e7:
                break
        return cls(track.time_s[rows], plane, tuple(levels))

    def rows_for(self, metres_per_pixel: float) -> Indices:
        """Return the rows that draw the path to within a pixel."""
        level = int(np.floor(np.log2(max(metres_per_pixel / FINEST_M, 1.0))))
        return self.levels[min(level, len(self.levels) - 1)]


def way_between(path: ThinnedPath, scale: PlanScale, ends_s: tuple[float, float]) -> FloatArray:
    """Return the pixels (n ≥ 2, 2) of the path from one moment to another, drawn to within a pixel."""
    start_s, end_s = min(ends_s), max(ends_s)
    rows = path.rows_for(1.0 / scale.pixels_per_m)
    times = path.time_s[rows]
    inside = rows[np.searchsorted(times, start_s, side="right") : np.searchsorted(times, end_s, side="left")]
    ends = np.column_stack([np.interp([start_s, end_s], path.time_s, column) for column in path.plane_m.T])
    return scale.pixels(np.concatenate((ends[:1], path.plane_m[inside], ends[1:])))


def runs(keep: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return where stretches of True begin and end (exclusive)."""
    edges = np.flatnonzero(np.diff(keep.astype(np.int8), prepend=0, append=0))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def visible_runs(pixels: FloatArray, size: tuple[float, float], margin: float) -> list[tuple[int, int]]:
    """Return the stretches of a polyline (n, 2) that may touch the picture, each with its neighbours outside."""
    if len(pixels) == 0:
        return []
    x, y = pixels[:, 0], pixels[:, 1]
    inside = (x >= -margin) & (x <= size[0] + margin) & (y >= -margin) & (y <= size[1] + margin)
    near = inside.copy()
    near[1:] |= inside[:-1]
    near[:-1] |= inside[1:]
    # a long segment may cross the picture with both ends outside
    crossing = (np.minimum(x[1:], x[:-1]) <= size[0]) & (np.maximum(x[1:], x[:-1]) >= 0)
    crossing &= (np.minimum(y[1:], y[:-1]) <= size[1]) & (np.maximum(y[1:], y[:-1]) >= 0)
    near[1:] |= crossing
    near[:-1] |= crossing
    return runs(near)


def nearest_moment(
    time_s: FloatArray, pixels: FloatArray, place: tuple[float, float], now_s: float, reach: float
) -> float | None:
    """Return the moment at which the polyline ``pixels`` (n, 2) passes nearest to a pixel; None beyond ``reach``.

    Where the path passes there several times (a loop, a return), the pass nearest in time to ``now_s`` is taken.
    """
    if len(pixels) == 1:
        away = float(np.hypot(pixels[0, 0] - place[0], pixels[0, 1] - place[1]))
        return float(time_s[0]) if away <= reach else None
    start, step = pixels[:-1], np.diff(pixels, axis=0)
    length2 = np.maximum(np.sum(step**2, axis=1), 1e-12)
    part = np.clip(np.sum((np.array(place) - start) * step, axis=1) / length2, 0.0, 1.0)
    away = np.hypot(*(start + part[:, None] * step - np.array(place)).T)
    least = float(np.min(away))
    if least > reach:
        return None
    times = time_s[:-1] + part * np.diff(time_s)
    near = np.flatnonzero(away <= least + 3.0)
    best = [group[np.argmin(away[group])] for group in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1)]
    return float(min((times[k] for k in best), key=lambda t: abs(t - now_s)))


def band_outline(plane_m: FloatArray, half_width_m: FloatArray) -> FloatArray:
    """Return the outline (2n, 2) of a band of ± ``half_width_m`` (n,) across a path (n, 2), n ≥ 2."""
    along = np.gradient(plane_m, axis=0)
    length = np.maximum(np.hypot(*along.T), 1e-12)
    across = np.stack((-along[:, 1], along[:, 0]), axis=1) / length[:, None] * half_width_m[:, None]
    return np.concatenate((plane_m + across, (plane_m - across)[::-1]))
