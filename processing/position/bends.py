"""Bends of the mapped route, recognised in the turns of the ball: each says when the device was at a known chainage.

Turning angles between chords of REACH_M need no heading at the launch, and a bend takes seconds, so the gyro's drift
does not matter. Which turn is which bend is decided by :mod:`processing.position.profile_matching` over the whole run;
the place of each is then measured from its own shape alone, so that the odometer is not counted twice. Nothing is said
where the match is ambiguous (a straight route, equal bends at equal distances) or no better than chance.
"""

from dataclasses import dataclass

import numpy as np

from processing.position.evidence import ChainageFix
from processing.position.odometry import Odometry
from processing.position.profile_matching import STEP_M, Match, PlacedAt, Prior, Profile, match, table_grid
from processing.position.route import RouteLine
from processing.progress import Progress
from processing.settings import PositionSettings
from processing.survey import Finding, FloatArray, Severity

REACH_M = 5.0
SOURCE = "bend"
_LEAST_BEND_RAD = np.radians(10.0)
_NOISE_RAD = np.radians(3.0)  # of a turn beside the map's: weaving of the ball, corners drawn square
SLIP_WALK = 0.13  # m/√m: covers 95 % over the wheels of navigation §4.4, so that no map is missed
_LEAST_GAIN = 10.0  # nats over no map; random turns beside a map gain less in 999 of 1000 cases
_START_MOST_M = 100.0  # a launch further off than this is another launch
_LEAST_LEAD = 6.0  # over the mirrored map
_LEAST_SHARE = 0.99  # of the posterior in one place
_SIGMA_FLOOR_M = 0.3  # a ball in a bend cuts or climbs
_LOCAL_SEARCH_M = 2.5
_LEAST_JUMP_M = 0.1
_MAP_GROWTH = 0.0005  # of the length: what a drawn line is longer or shorter than the pipe
_CORNER_M = 0.15  # what a square corner is longer than a bend of a metre or two, per radian
_SQUARE_RAD = np.radians(20.0)  # a bend drawn with points in it turns by less at each


@dataclass(frozen=True)
class BendMatch:
    """The fixes, how many bends the map has within the way, and the findings."""

    fixes: tuple[ChainageFix, ...]
    mapped: int
    findings: tuple[Finding, ...]


def find_bends(
    odometry: Odometry,
    route: RouteLine,
    settings: PositionSettings,
    progress: Progress,
    scale_sigma: float = 0.0,
    lost_m2: FloatArray | None = None,
) -> BendMatch:
    """Return a fix for each bend of the route that the ball's turns show beyond doubt.

    ``scale_sigma`` replaces the odometry's where something outside (the pipe's length) has already told the scale.
    ``lost_m2`` (m,) is the cumulated variance of what the odometer lost besides slip (slides, gaps): where it grows, no
    bend is measured. The odometry's chainage begins at the launch, as the route's does.
    """
    way = _Way.of(odometry, lost_m2)
    length = float(way.chainage_m[-1])
    if length < 4.0 * REACH_M:
        return BendMatch((), 0, ())
    turns = _measured(way)
    table = table_grid(float(route.chainage_m[0]) + REACH_M, float(route.chainage_m[-1]) - REACH_M)
    if len(table) < 2:
        return BendMatch((), 0, ())
    mapped = turning(route.at(table - REACH_M), route.at(table), route.at(table + REACH_M))
    sigma = scale_sigma or odometry.scale_sigma
    within = table < length * (1.0 + 3.0 * sigma)
    bends = _apexes(np.where(within, mapped, 0.0), REACH_M / 2.0 / 0.1)
    if len(bends) == 0:
        return BendMatch((), 0, ())
    seen = _apexes(turns.value, REACH_M / 2.0 / STEP_M)
    profile = Profile(turns.odometer_m, turns.value, mapped, float(table[0]), turns.sigma_rad, 2.0 * REACH_M)
    walk = max(settings.slip_walk, SLIP_WALK)
    prior = Prior(sigma, start_sigma_m(route), walk, _jumps(way, turns.odometer_m))
    found = match((profile,), turns.odometer_m[seen], prior, progress)
    if not len(seen) or found.gain < _LEAST_GAIN or found.gain - max(found.mirrored_gain, 0.0) < _LEAST_LEAD:
        return BendMatch((), len(bends), (_refused(found, len(seen), len(bends)),))
    places = table[bends]
    fixes = tuple(f for at in found.placed for f in _fix(at, odometry, route, way, places, mapped[bends]))
    if len(fixes) < 0.5 * min(len(seen), len(bends)):
        return BendMatch((), len(bends), (_refused(found, len(seen), len(bends)),))
    count = {"count": float(len(fixes)), "mapped": float(len(bends))}
    return BendMatch(fixes, len(bends), (Finding("bends_recognised", Severity.INFO, count),))


def start_sigma_m(route: RouteLine) -> float:
    """Return how far the launch may lie from where the map has it: the map's sigma, and a metre of handling.

    No further than the map is long, however little it is believed: every place within is a hypothesis of the matching.
    """
    return float(np.hypot(1.0, min(route.sigma_m, float(route.chainage_m[-1] - route.chainage_m[0]), _START_MOST_M)))


def turning(before_m: FloatArray, here_m: FloatArray, after_m: FloatArray) -> FloatArray:
    """Return the turning angles (n,), counter-clockwise, between the chords of three rows of places (n, 2 or 3)."""
    u, v = here_m - before_m, after_m - here_m
    cross = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return np.asarray(np.arctan2(cross, u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1]))


def _refused(found: Match, seen: int, mapped: int) -> Finding:
    figures = {"turns": float(seen), "mapped": float(mapped), "gain": found.gain}
    # a map that fits worse than its mirror image is worth a look
    wrong = seen > 0 and found.mirrored_gain - found.gain > _LEAST_LEAD and found.mirrored_gain > _LEAST_GAIN
    return Finding("bends_mirrored" if wrong else "bends_not_recognised", Severity.WARNING, figures)


@dataclass(frozen=True)
class _Way:
    """The free path by odometer: distinct chainages (k,), places (k, 2), variance lost before leaving each (k,)."""

    chainage_m: FloatArray
    place_m: FloatArray
    lost_m2: FloatArray

    @classmethod
    def of(cls, odometry: Odometry, lost_m2: FloatArray | None = None) -> "_Way":
        distinct, first = np.unique(odometry.chainage_m, return_index=True)
        last = np.append(first[1:], len(odometry.chainage_m)) - 1
        lost = np.zeros(len(distinct)) if lost_m2 is None else lost_m2[last]
        return cls(distinct, odometry.position_w_m[first, :2], lost)

    def lost(self, low_m: float, high_m: float) -> float:
        """1-sigma of what was lost between two readings."""
        low, high = np.interp([low_m, high_m], self.chainage_m, self.lost_m2)
        return float(np.sqrt(max(high - low, 0.0)))

    def at(self, chainage_m: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(chainage_m, self.chainage_m, axis) for axis in self.place_m.T])


@dataclass(frozen=True)
class _Turns:
    odometer_m: FloatArray
    value: FloatArray
    sigma_rad: float


def _measured(way: _Way) -> _Turns:
    at = np.arange(REACH_M, float(way.chainage_m[-1]) - REACH_M, STEP_M)
    value = turning(way.at(at - REACH_M), way.at(at), way.at(at + REACH_M))
    # half of a way is straight, or nearly
    noise = float(np.median(np.abs(value - np.median(value)))) / 0.6745
    return _Turns(at, value, float(np.hypot(_NOISE_RAD, min(noise, 2.0 * _NOISE_RAD))))


def _jumps(way: _Way, odometer_m: FloatArray) -> dict[int, float]:
    """What was lost within the step up to each row of the profile, where that is more than the grid resolves."""
    lost = np.interp(odometer_m, way.chainage_m, way.lost_m2, left=0.0)
    jump = np.sqrt(np.maximum(np.diff(lost, prepend=0.0), 0.0))
    return {int(row): float(jump[row]) for row in np.flatnonzero(jump > _LEAST_JUMP_M)}


def _apexes(turn: FloatArray, apart: float) -> FloatArray:
    """Rows where the turn is largest within ``apart`` rows, and large enough for a bend."""
    from scipy.ndimage import maximum_filter1d

    size = np.abs(turn)
    top = maximum_filter1d(size, 2 * round(apart) + 1)
    rows = np.flatnonzero((size >= top) & (size > _LEAST_BEND_RAD))
    # a plateau is one bend: its middle
    groups = np.split(rows, np.flatnonzero(np.diff(rows) > apart) + 1) if len(rows) else []
    return np.array([int(np.mean(group)) for group in groups], dtype=np.intp)


def _fix(
    at: PlacedAt,
    odometry: Odometry,
    route: RouteLine,
    way: _Way,
    bend_m: FloatArray,
    bend_rad: FloatArray,
) -> tuple[ChainageFix, ...]:
    """Measure where the turn near ``at`` lies on the map, from its shape alone; nothing where it does not fit."""
    nearest = int(np.argmin(np.abs(bend_m - at.place_m)))
    reach = 2.0 * REACH_M
    if way.lost(at.odometer_m - reach, at.odometer_m + reach) > _LEAST_JUMP_M:
        return ()
    if at.share < _LEAST_SHARE or abs(bend_m[nearest] - at.place_m) > _LOCAL_SEARCH_M:
        return ()
    shift = np.arange(-_LOCAL_SEARCH_M, _LOCAL_SEARCH_M + 1e-9, 0.05)
    along = np.arange(-1.5 * REACH_M, 1.5 * REACH_M + 1e-9, STEP_M)
    own = along + at.odometer_m
    # cells without a whole chord on the way say nothing
    inside = (own > REACH_M) & (own < way.chainage_m[-1] - REACH_M)
    along, own = along[inside], own[inside]
    measured = turning(way.at(own - REACH_M), way.at(own), way.at(own + REACH_M))
    place = (at.place_m + along)[None, :] + shift[:, None]
    flat = place.ravel()
    there = turning(route.at(flat - REACH_M), route.at(flat), route.at(flat + REACH_M)).reshape(place.shape)
    misfit = np.mean((there - measured) ** 2, axis=1)
    best = int(np.argmin(misfit))
    left = float(np.sqrt(misfit[best]))
    size = abs(float(bend_rad[nearest]))
    if best in (0, len(shift) - 1) or left > max(0.25 * size, 0.5 * _NOISE_RAD):
        return ()
    steepness = np.gradient(there[best], STEP_M)
    # neighbouring turns share their chords, so only one in 2·REACH_M is its own witness
    own_sigma = max(left, 0.3 * _NOISE_RAD) * np.sqrt(2.0 * REACH_M / STEP_M / max(float(steepness @ steepness), 1e-9))
    drawn = np.hypot(_MAP_GROWTH * at.place_m, _CORNER_M * _square_corners(route, at.place_m))
    sigma = float(np.sqrt(_SIGMA_FLOOR_M**2 + own_sigma**2 + drawn**2))
    time_s = _time_at(odometry, at.odometer_m)
    return (ChainageFix(time_s, float(at.place_m + shift[best]), sigma, SOURCE, route.sigma_m),)


def _square_corners(route: RouteLine, until_m: float) -> float:
    """Radians turned at corners that the map draws square, before ``until_m``."""
    inner = (route.chainage_m[1:-1] > 0.0) & (route.chainage_m[1:-1] <= until_m)
    angle = np.abs(turning(route.points_w_m[:-2], route.points_w_m[1:-1], route.points_w_m[2:]))[inner]
    return float(np.sum(angle[angle > _SQUARE_RAD]))


def _time_at(odometry: Odometry, chainage_m: float) -> float:
    """When the odometer first told ``chainage_m``."""
    after = int(np.clip(np.searchsorted(odometry.chainage_m, chainage_m), 1, len(odometry.chainage_m) - 1))
    low, high = odometry.chainage_m[after - 1], odometry.chainage_m[after]
    part = (chainage_m - low) / (high - low) if high > low else 0.0
    return float(odometry.time_s[after - 1] + part * (odometry.time_s[after] - odometry.time_s[after - 1]))


def straight_share(odometry: Odometry) -> float:
    """Return the share of the way (0..1) on which the path turns by less than a bend."""
    way = _Way.of(odometry)
    if float(way.chainage_m[-1]) < 4.0 * REACH_M:
        return 1.0
    return float(np.mean(np.abs(_measured(way).value) < _LEAST_BEND_RAD))
