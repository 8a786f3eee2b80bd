"""What the heading of a free path rests on, and how far to trust it.

Dead reckoning gives the path's shape in a heading of its own. It is turned to the launch's stated direction (and the
magnetic one, where that is trusted), to the magnetic or device heading, to the route, or onto the tie points, in this
order; without any of them north is unknown, and only chainage and shape are told.
"""

from dataclasses import dataclass

import numpy as np

from processing.position.odometry import Odometry
from processing.position.route import RouteLine
from processing.position.ties import Observation
from processing.settings import PositionSettings
from processing.survey import Finding, FloatArray, Severity, Survey

_SHORTEST_M = 3.0
_BASELINES_M = (20.0, 12.0, 8.0, 5.0, 3.0)
_FITS_M = 0.02  # rms; a pipe bend within the baseline leaves ten times as much
_BEND_M = 0.05  # rms over some baseline: no ball weaves so widely, the pipe itself turns soon after the launch
_BEFORE_BEND_M = (2.0, 1.2, 0.8, 0.5, 0.3)
_STRAIGHT = 0.003  # rms of a straight piece by its length
_UNKNOWN_RAD = float(np.pi / np.sqrt(3.0))  # the sigma of a heading that may be anything


@dataclass(frozen=True)
class HeadingStart:
    """Turn the free path by ``turn_rad`` (counter-clockwise); what is left is offset and drift of these sigmas."""

    turn_rad: float
    sigma_rad: float
    drift_radps: float
    basis: str  # launch | magnetometer | device | route | tie_points | unknown
    findings: tuple[Finding, ...] = ()


def heading_start(
    odometry: Odometry,
    survey: Survey,
    ties: tuple[Observation, ...],
    route: RouteLine | None,
    settings: PositionSettings,
    first: float | None,
) -> HeadingStart:
    """Return how the free path is turned before the fit; ``first`` is its :func:`initial_direction`."""
    rolling = odometry.method == "rolling"
    drift = float(np.radians(settings.rolling_drift_dph if rolling else settings.heading_drift_dph) / 3600.0)
    stated = float(np.radians(settings.heading_sigma_deg))
    magnetic = float(np.radians(settings.magnetic_sigma_deg))
    heading = survey.launch.heading_deg
    if heading is not None and first is not None:
        turn = _wrapped(float(np.radians(90.0 - heading)) - first)
        if odometry.heading_from == "magnetometer":  # two witnesses, by their weights; the field then holds the heading
            weight = magnetic**2 / (magnetic**2 + stated**2)
            findings = _disagreement(turn, magnetic, stated)
            return HeadingStart(weight * turn, float(np.sqrt(weight)) * stated, 0.0, "magnetometer", findings)
        return HeadingStart(turn, stated, drift, "launch")
    if odometry.heading_from == "magnetometer":
        return HeadingStart(0.0, magnetic, 0.0, "magnetometer")
    if odometry.heading_from == "device":
        return HeadingStart(0.0, magnetic, drift, "device")
    if route is not None and first is not None:
        east, north, _ = route.at(np.array([min(_SHORTEST_M, 0.5 * float(route.chainage_m[-1]))]))[0]
        origin = route.at(np.zeros(1))[0]
        turn = _wrapped(float(np.arctan2(north - origin[1], east - origin[0])) - first)
        return HeadingStart(turn, stated, drift, "route")
    turned = _onto_places(odometry, ties)
    if turned is not None:
        return HeadingStart(turned, _UNKNOWN_RAD, drift, "tie_points")
    return HeadingStart(0.0, _UNKNOWN_RAD, drift, "unknown", (Finding("heading_unknown", Severity.WARNING),))


def initial_direction(odometry: Odometry) -> float | None:
    """Return the yaw (rad) in which the free path sets out; None where the device never left.

    A parabola through the launch is laid over the first metres, over as many as it fits: sway and weaving average out,
    a gentle bend does not count. Where the pipe turns right after the launch, the piece before the bend counts alone.
    """
    total = float(odometry.chainage_m[-1])
    if total < 0.5:
        return None
    fits = [_first_metres(odometry, b) for b in _BASELINES_M if b < 0.3 * total]
    for fit in fits:
        if fit.rms_m < _FITS_M:
            return fit.direction_rad
    if max((fit.rms_m for fit in fits), default=0.0) > _BEND_M:
        for baseline in _BEFORE_BEND_M:
            fit = _first_metres(odometry, baseline)
            if fit.rms_m < _STRAIGHT * baseline:
                return fit.direction_rad
    return _first_metres(odometry, min(_SHORTEST_M, 0.1 * total)).chord_rad


@dataclass(frozen=True)
class _FirstMetres:
    """The first metres as a parabola: its direction at the launch, that of its chord, and what it leaves."""

    direction_rad: float
    chord_rad: float
    rms_m: float


def _first_metres(odometry: Odometry, baseline_m: float) -> _FirstMetres:
    distinct, first = np.unique(odometry.chainage_m, return_index=True)
    at = np.linspace(0.0, baseline_m, 100)
    east, north = (np.interp(at, distinct, axis[first]) for axis in odometry.position_w_m[:, :2].T)
    chord = float(np.arctan2(north[-1], east[-1]))
    along = east * np.cos(chord) + north * np.sin(chord)
    aside = north * np.cos(chord) - east * np.sin(chord)
    basis = np.column_stack([along, along**2])
    (slope, bend), *_ = np.linalg.lstsq(basis, aside, rcond=None)
    left = aside - basis @ np.array([slope, bend])
    return _FirstMetres(chord + float(np.arctan(slope)), chord, float(np.sqrt(np.mean(left**2))))


def route_turn(route: RouteLine, chainage_m: FloatArray, free_m: FloatArray) -> FloatArray:
    """Return by how much (m,) the free path (m, 3) is turned against the route at ``chainage_m`` (m,), unwrapped.

    Compared are chords of ±2 m, which bridge joints and noise, and are shorter than what lies between bends.
    """
    distinct, first = np.unique(chainage_m, return_index=True)
    if len(distinct) < 2 or distinct[-1] <= 0.0:
        return np.zeros(len(chainage_m))
    ends = np.clip(np.stack([chainage_m - 2.0, chainage_m + 2.0]), 0.0, distinct[-1])
    free = [np.interp(ends[1], distinct, c[first]) - np.interp(ends[0], distinct, c[first]) for c in free_m[:, :2].T]
    mapped = route.at(ends[1]) - route.at(ends[0])
    turn = np.arctan2(mapped[:, 1], mapped[:, 0]) - np.arctan2(free[1], free[0])
    return np.asarray(np.unwrap(turn))


def _onto_places(odometry: Odometry, ties: tuple[Observation, ...]) -> float | None:
    """The turn that brings the free path closest to the observed places; None where they say nothing of it."""
    dot = cross = size = 0.0
    for tie in ties:
        if tie.is_place:
            east, north = odometry.position_w_m[tie.row, :2]
            dot += float(east * tie.value[0] + north * tie.value[1])
            cross += float(east * tie.value[1] - north * tie.value[0])
            size += float(tie.covariance_m2[0, 0])
    # a place at the launch (a closed loop) has no direction
    return float(np.arctan2(cross, dot)) if np.hypot(dot, cross) > 9.0 * size > 0.0 else None


def _disagreement(turn: float, magnetic: float, stated: float) -> tuple[Finding, ...]:
    if abs(turn) < 3.0 * np.hypot(magnetic, stated):
        return ()
    return (Finding("heading_disagrees", Severity.WARNING, {"degrees": float(np.degrees(abs(turn)))}),)


def _wrapped(angle: float) -> float:
    return float(np.arctan2(np.sin(angle), np.cos(angle)))
