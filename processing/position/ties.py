"""What is known of the run from outside, as observations of the path: tie points, the pipe's length, the route.

Everything that pulls on the fit passes here, and what cannot be used leaves a finding.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from processing.coordinates import LocalFrame, tie_place
from processing.position.odometry import Odometry
from processing.position.route import RouteLine
from processing.settings import PositionSettings
from processing.survey import Finding, FloatArray, Params, Severity, Survey, TiePoint

LENGTH = "\0length"  # no tie point can have this name
_SIGMA_FLOOR_M = 0.01
_LENGTH_SIGMA_M = 0.1
_SPEED_WINDOW_S = 4.0


@dataclass(frozen=True)
class Observation:
    """One tie at a row of the odometry: chainage, or place (up may be NaN), with the covariance of what is observed.

    ``value`` is ``(chainage,)``, ``(east, north)`` or ``(east, north, up)``; ``covariance_m2`` fits it.
    """

    name: str
    time_s: float
    row: int
    is_place: bool
    value: FloatArray
    covariance_m2: FloatArray
    speed_mps: float = 0.0  # what a wrong clock costs


def observations(
    odometry: Odometry, survey: Survey, frame: LocalFrame, route: RouteLine | None, settings: PositionSettings
) -> tuple[tuple[Observation, ...], tuple[Finding, ...]]:
    """Return all that the path is fitted to, in order of time and name, and what is wrong with the rest.

    With a route, places become chainages: the route leads the path, and the device was where the place is nearest.
    """
    found: list[Observation] = []
    findings: list[Finding] = []
    for tie in sorted((t for t in survey.tie_points if t.enabled), key=lambda t: (t.time_s, t.name, repr(t))):
        if not odometry.time_s[0] - 1.0 <= tie.time_s <= odometry.time_s[-1] + 1.0:
            findings.append(Finding("tie_outside", Severity.WARNING, {"name": tie.name, "time_s": tie.time_s}))
            continue
        if tie.latitude is not None and not frame.is_geographic:
            findings.append(Finding("tie_without_launch", Severity.WARNING, {"name": tie.name}))
        place = tie_place(frame, tie)
        if place is not None:
            found.append(_of_place(odometry, tie, place, settings))
        if tie.chainage_m is not None:
            found.append(_of_chainage(odometry, tie.name, tie.time_s, tie.chainage_m, tie.sigma_m, settings))
        elif place is None:
            findings.append(Finding("tie_empty", Severity.WARNING, {"name": tie.name}))
    length = _of_length(odometry, survey, settings)
    if length is not None:
        found.append(length)
    if route is not None:
        found, off_route = _onto_route(found, odometry, route)
        findings.extend(off_route)
    findings.extend(_contradictions(found))
    return tuple(found), tuple(findings)


def launch_tie(odometry: Odometry, survey: Survey) -> TiePoint | None:
    """Return the enabled tie point that says when the launch was: chainage 0, in the first part of the way."""
    for tie in sorted((t for t in survey.tie_points if t.enabled), key=lambda t: -t.time_s):
        inside = odometry.time_s[0] <= tie.time_s <= odometry.time_s[-1]
        if tie.chainage_m == 0.0 and inside:
            before = float(np.interp(tie.time_s, odometry.time_s, odometry.chainage_m))
            if before <= 0.2 * odometry.chainage_m[-1]:
                return tie
    return None


def _of_chainage(
    odometry: Odometry, name: str, time_s: float, chainage_m: float, sigma_m: float, settings: PositionSettings
) -> Observation:
    row, ahead_m = _row_at(odometry, time_s)
    variance = max(sigma_m, _SIGMA_FLOOR_M) ** 2 + (_speed_at(odometry, time_s) * settings.tie_time_sigma_s) ** 2
    value = np.array([chainage_m + ahead_m])
    return Observation(name, time_s, row, False, value, np.array([[variance]]), _speed_at(odometry, time_s))


def _of_place(
    odometry: Odometry, tie: TiePoint, place: tuple[float, float, float | None], settings: PositionSettings
) -> Observation:
    row, _ = _row_at(odometry, tie.time_s)
    level = place[2] is None
    variance = (
        max(tie.sigma_m, _SIGMA_FLOOR_M) ** 2 + (_speed_at(odometry, tie.time_s) * settings.tie_time_sigma_s) ** 2
    )
    size = 2 if level else 3
    covariance = np.eye(size) * variance
    if not level:
        covariance[2, 2] = max(tie.sigma_m, _SIGMA_FLOOR_M) ** 2
    value = np.array([v for v in place if v is not None])
    return Observation(tie.name, tie.time_s, row, True, value, covariance, _speed_at(odometry, tie.time_s))


def _of_length(odometry: Odometry, survey: Survey, settings: PositionSettings) -> Observation | None:
    """The pipe's length, reached where the device last moved, unless a tie point says when it was at the end."""
    length = survey.pipe.length_m
    if length is None or length <= 0.0 or odometry.chainage_m[-1] <= 0.0:
        return None
    if any(
        t.enabled and t.chainage_m is not None and abs(t.chainage_m / length - 1.0) < 0.02 for t in survey.tie_points
    ):
        return None
    row = int(np.searchsorted(odometry.chainage_m, odometry.chainage_m[-1], side="left"))
    sigma = _LENGTH_SIGMA_M + length * settings.length_sigma_pct / 100.0
    return Observation(LENGTH, float(odometry.time_s[row]), row, False, np.array([length]), np.array([[sigma**2]]))


def _row_at(odometry: Odometry, time_s: float) -> tuple[int, float]:
    """The nearest row, and how much further along the device is there than at ``time_s``."""
    row = int(np.clip(np.searchsorted(odometry.time_s, time_s), 0, len(odometry.time_s) - 1))
    if row > 0 and time_s - odometry.time_s[row - 1] < odometry.time_s[row] - time_s:
        row -= 1
    return row, float(odometry.chainage_m[row] - np.interp(time_s, odometry.time_s, odometry.chainage_m))


def _speed_at(odometry: Odometry, time_s: float) -> float:
    """Mean speed around a moment: what a wrong time costs in metres."""
    times = np.array([time_s - 0.5 * _SPEED_WINDOW_S, time_s + 0.5 * _SPEED_WINDOW_S])
    before, after = np.interp(times, odometry.time_s, odometry.chainage_m)
    return float(after - before) / _SPEED_WINDOW_S


def _onto_route(
    found: list[Observation], odometry: Odometry, route: RouteLine
) -> tuple[list[Observation], list[Finding]]:
    placed: list[Observation] = []
    findings: list[Finding] = []
    chainages = [(o.row, float(o.value[0])) for o in found if not o.is_place]
    for tie in found:
        if not tie.is_place:
            placed.append(tie)
            continue
        sigma = float(np.sqrt(tie.covariance_m2[0, 0]))
        expected = _expected(odometry, tie.row, chainages)
        chainage, off = route.chainage_of((float(tie.value[0]), float(tie.value[1])), expected, sigma)
        if off > 3.0 * np.hypot(sigma, route.sigma_m) + 1.0:
            findings.append(Finding("tie_off_route", Severity.WARNING, {"name": tie.name, "metres": off}))
        variance = tie.covariance_m2[0, 0] + route.sigma_m**2
        placed.append(replace(tie, is_place=False, value=np.array([chainage]), covariance_m2=np.array([[variance]])))
    return placed, findings


def _expected(odometry: Odometry, row: int, chainages: list[tuple[int, float]]) -> float:
    """Chainage at a row by odometry, scaled by the other ties where there are any."""
    ends = [(r, c) for r, c in chainages if odometry.chainage_m[r] > 0.0 and c > 0.0]
    scale = ends[-1][1] / float(odometry.chainage_m[ends[-1][0]]) if ends else 1.0
    return float(odometry.chainage_m[row]) * scale


def _contradictions(found: list[Observation]) -> list[Finding]:
    """Chainages that go back in time by more than their sigmas allow."""
    chainages = sorted((o for o in found if not o.is_place), key=lambda o: o.time_s)
    out = []
    for earlier, later in pairwise(chainages):
        back = float(earlier.value[0] - later.value[0])
        if back > 3.0 * float(np.sqrt(earlier.covariance_m2[0, 0] + later.covariance_m2[0, 0])):
            if LENGTH in (earlier.name, later.name):
                name = later.name if earlier.name == LENGTH else earlier.name
                out.append(Finding("tie_beyond_length", Severity.WARNING, {"name": name, "metres": back}))
            else:
                names: Params = {"name": later.name, "other": earlier.name, "metres": back}
                out.append(Finding("tie_contradiction", Severity.WARNING, names))
    return out
