"""The fit of a free path to all that is known, with an interval at every moment.

One smoother over the whole run, its cost linear in the run's length: scale, slip, chainage, place, heading and its
drift at keyframes (:mod:`processing.position.motion_model`), pulled by tie points, length, route and what the
recording itself says (:mod:`processing.position.evidence`). :func:`prepare` does once what no tie point changes,
:func:`fit` gives the whole track, :func:`refit` the same path at the keyframes, quickly enough to follow a hand.
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.coordinates import LocalFrame, frame_of
from processing.orientation.quaternions import multiply, turn_about_up
from processing.position.evidence import Evidence
from processing.position.factors import collect
from processing.position.fit_results import FitPreview, FitSeries, Fitted
from processing.position.heading import HeadingStart, heading_start, initial_direction
from processing.position.height import Heights, find_heights
from processing.position.keyframes import (
    Keyframes,
    even_rows,
    event_times,
    keyframes_at,
    moments_of,
    nearest_rows,
)
from processing.position.motion_model import Prior
from processing.position.odometry import Odometry, Rows, rescaled, started_at, thinned, with_slips
from processing.position.route import RouteLine, route_line
from processing.position.smoothing import TURNS, Settled, settle
from processing.position.tie_checks import TieCheck, checks_of
from processing.position.ties import Observation, launch_tie, observations
from processing.position.whole_track import preview_of, series_of, track_of
from processing.progress import Progress, silent
from processing.settings import PositionSettings
from processing.survey import Finding, FloatArray, Params, Severity, Survey, TiePoint, Track

_RESCALE_SIGMA = 0.3
_SETTING_OUT_M = 70.0
_DRAWN = 3000
_SPEED_WINDOW_S = 2.0  # on both sides of a tie point


@dataclass(frozen=True)
class FitProblem:
    """All of a fit that no tie point changes: what was reckoned, what else is known, and the keyframes' ``rows``."""

    odometry: Odometry
    evidence: Evidence
    frame: LocalFrame
    route: RouteLine | None
    rows: Rows  # (k,)
    drawn: Rows  # (j,) rows that suffice to draw the path
    moments_m: FloatArray  # (m, 2) as of keyframes.moments_of
    first_rad: float | None  # in which direction the free path sets out
    findings: tuple[Finding, ...] = ()


def prepare(odometry: Odometry, survey: Survey, evidence: Evidence, settings: PositionSettings) -> FitProblem:
    """Return what every fit of this run shares; tie points and length of the survey have no part in it.

    Raises:
        LeaklineError: CRS_UNKNOWN, LAUNCH_INCOMPLETE, LAUNCH_INVALID.
    """
    frame = frame_of(survey)
    route, findings = route_line(frame, survey.route)
    odometry = with_slips(odometry, evidence.slips)
    events = nearest_rows(odometry.time_s, event_times(evidence))
    rows = np.unique(np.concatenate([even_rows(odometry, round(settings.keyframes)), events]))
    drawn = even_rows(odometry, _DRAWN)
    first = initial_direction(odometry)
    found = (*evidence.findings, *findings)
    return FitProblem(odometry, evidence, frame, route, rows, drawn, moments_of(odometry), first, found)


def fit(problem: FitProblem, survey: Survey, settings: PositionSettings, progress: Progress) -> Fitted:
    """Return the path fitted to the survey's ties, length and route, with its interval (95 % is ±1.96 sigma).

    Raises:
        LeaklineError: CRS_UNKNOWN, LAUNCH_INCOMPLETE, LAUNCH_INVALID.
    """
    fitted = _fitted(problem, survey, settings, progress)
    odometry = fitted.placing.applied(problem.odometry)
    track = track_of(odometry, fitted.frames, fitted.settled, fitted.heights, problem.route)
    series = series_of(fitted.frames, fitted.settled, fitted.placing.factor)
    findings = (*odometry.findings, *problem.findings, *fitted.findings, *_fit_findings(fitted, problem, track))
    quality = _quality(fitted, odometry, series, track)
    return Fitted(replace(track, findings=findings, quality=quality), fitted.checks, series)


def refit(problem: FitProblem, survey: Survey, settings: PositionSettings) -> FitPreview:
    """Return the same path as :func:`fit` at as many moments as are drawn; errors as there."""
    fitted = _fitted(problem, survey, settings, silent())
    rows = np.unique(np.concatenate([problem.drawn, fitted.frames.rows]))
    odometry = fitted.placing.applied(thinned(problem.odometry, rows))
    frames = replace(fitted.frames, rows=np.searchsorted(rows, fitted.frames.rows))
    return preview_of(odometry, frames, fitted.settled, fitted.heights, problem.route, fitted.checks)


@dataclass(frozen=True)
class _Placing:
    """How the free path is laid before the fit: begun at the launch, taken times a factor, turned."""

    launch: TiePoint | None
    factor: float
    turn_rad: float

    def applied(self, odometry: Odometry) -> Odometry:
        """Return the odometry so laid."""
        if self.launch is not None:
            odometry = started_at(odometry, self.launch.time_s, self.launch.sigma_m)
        if self.factor != 1.0:
            odometry = rescaled(odometry, self.factor)
        return replace(
            odometry,
            position_w_m=_turned(odometry.position_w_m, self.turn_rad),
            quat_ws=multiply(turn_about_up(self.turn_rad), odometry.quat_ws),
        )


@dataclass(frozen=True)
class _Fit:
    frames: Keyframes
    settled: Settled
    heights: Heights
    checks: tuple[TieCheck, ...]
    placing: _Placing
    start: HeadingStart
    findings: tuple[Finding, ...]
    dropped: int


def _fitted(problem: FitProblem, survey: Survey, settings: PositionSettings, progress: Progress) -> _Fit:
    free = keyframes_at(problem.odometry, problem.moments_m, _rows(problem, survey))
    launch = launch_tie(free.odometry, survey)
    thin, first = free.odometry, problem.first_rad
    if launch is not None:
        thin, first = started_at(thin, launch.time_s, launch.sigma_m), _first_after(problem.odometry, launch)
        survey = replace(survey, tie_points=tuple(t for t in survey.tie_points if t is not launch))
    ties, findings = observations(thin, survey, problem.frame, problem.route, settings)
    factor = _first_scale(thin, ties)
    if factor != 1.0:  # speeds and the nearest places on the route have changed with the radius
        thin = rescaled(thin, factor)
        ties, _ = observations(thin, survey, problem.frame, problem.route, settings)
    start = heading_start(thin, survey, ties, problem.route, settings, first)
    placing = _Placing(launch, factor, start.turn_rad)
    thin = placing.applied(free.odometry)
    begun = thin.time_s[:-1] >= launch.time_s if launch is not None else np.ones(len(thin.time_s) - 1, dtype=np.bool_)
    frames = Keyframes(thin, free.rows, _turned(free.late_m * factor, start.turn_rad) * begun[:, None])
    prior = Prior(
        scale=thin.scale_sigma,
        heading_rad=start.sigma_rad,
        drift_radps=start.drift_radps,
        slope=thin.slope_sigma,
        start_m=thin.start_sigma_m,
        clock_s=settings.tie_clock_sigma_s,
        drift_tau_s=settings.heading_drift_tau_s,
    )
    heights = find_heights(frames, ties, problem.evidence.heights, prior.slope, prior.start_m)
    factors = collect(frames, ties, problem.evidence, problem.route is not None)
    settled = settle(
        frames, factors, prior, heights.shorter, settings, lambda done: progress.update(done, "position_fit")
    )
    checks = checks_of(settled.amid, settled.read, settled.items, settled.held)
    return _Fit(frames, settled, heights, checks, placing, start, (*findings, *start.findings), factors.dropped)


def _rows(problem: FitProblem, survey: Survey) -> Rows:
    """The keyframes' rows, and those at and around the tie points, where speed and place are wanted exactly."""
    times = np.array([t.time_s for t in survey.tie_points if t.enabled])
    all_s = problem.odometry.time_s
    around = np.concatenate([times, times - _SPEED_WINDOW_S, times + _SPEED_WINDOW_S])
    near = np.clip(np.searchsorted(all_s, around), 1, len(all_s) - 1)
    moved = problem.odometry.chainage_m
    last = np.searchsorted(moved, moved[-1], side="left")  # where a known length is reached
    return np.unique(np.concatenate([problem.rows, near, near - 1, [last]]))


def _first_after(odometry: Odometry, launch: TiePoint) -> float | None:
    """The direction in which the free path sets out from the launch."""
    begin = max(int(np.searchsorted(odometry.time_s, launch.time_s)) - 1, 0)
    end = int(np.searchsorted(odometry.chainage_m, odometry.chainage_m[begin] + _SETTING_OUT_M)) + 1
    part = thinned(odometry, np.arange(begin, min(max(end, begin + 2), len(odometry.time_s))))
    return initial_direction(started_at(part, launch.time_s, launch.sigma_m))


def _first_scale(odometry: Odometry, ties: tuple[Observation, ...]) -> float:
    """An unknown radius is first taken from the furthest chainage, so that what follows is a small correction."""
    far = [(float(o.value[0]), float(odometry.chainage_m[o.row])) for o in ties if not o.is_place]
    far = [(value, rolled) for value, rolled in far if value > 0.0 and rolled > 0.0]
    if odometry.scale_sigma < _RESCALE_SIGMA or not far:
        return 1.0
    value, rolled = max(far)
    return value / rolled


def _turned(points: FloatArray, turn_rad: float) -> FloatArray:
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    level = np.column_stack([cos * points[:, 0] - sin * points[:, 1], sin * points[:, 0] + cos * points[:, 1]])
    return np.hstack([level, points[:, 2:]])


def _quality(fitted: _Fit, odometry: Odometry, series: FitSeries, track: Track) -> Params:
    moving = track.speed_mps > 0.01
    checks = fitted.checks
    out: dict[str, str | float] = dict(odometry.quality)
    out |= {
        "scale": series.scale,
        "scale_sigma": series.scale_sigma,
        "path_length_m": float(track.chainage_m[-1]),
        "moving_share": float(np.mean(moving)),
        "mean_speed_mps": float(np.mean(track.speed_mps[moving])) if np.any(moving) else 0.0,
        "heading_basis": fitted.start.basis,
        "interval_basis": "ties" if len(checks) >= 3 else "prior",
        "interval_inflation": series.slip_level,
        "ties_used": float(len(checks)),
        "ties_held_down": float(sum(c.held_down for c in checks)),
        "evidence_used": float(sum(item.kind != "tie" for item in fitted.settled.items)),
        "sigma_along_max_m": float(track.sigma_along_m.max()),
    }
    if "radius_m" in out:
        out["radius_fitted_m"] = float(out["radius_m"]) * float(out["scale"])
    if checks:
        out["tie_residual_rms_m"] = float(np.sqrt(np.mean([c.residual_m**2 for c in checks])))
        out["tie_left_out_max_m"] = max(abs(c.left_out_m) for c in checks)
    return out


def _fit_findings(fitted: _Fit, problem: FitProblem, track: Track) -> tuple[Finding, ...]:
    out = []
    for check in fitted.checks:
        if check.held_down:
            params: Params = {"name": check.name, "metres": abs(check.left_out_m), "sigma_m": check.left_out_sigma_m}
            out.append(Finding("tie_disagrees" if check.name else "length_disagrees", Severity.WARNING, params))
    out += _evidence_findings(fitted)
    scale, sigma = float(fitted.settled.mean[0, 0]), fitted.frames.odometry.scale_sigma
    if sigma < _RESCALE_SIGMA and abs(scale) > 3.0 * sigma:
        out.append(Finding("scale_unusual", Severity.WARNING, {"percent": 100.0 * scale}))
    if fitted.settled.turns == TURNS:
        out.append(Finding("fit_not_settled", Severity.WARNING))
    if problem.route is not None:
        beyond = float(track.chainage_m[-1] - problem.route.chainage_m[-1])
        if beyond > 3.0 * float(track.sigma_along_m[-1]) + 1.0:
            out.append(Finding("beyond_route", Severity.WARNING, {"metres": beyond}))
    return tuple(out)


def _evidence_findings(fitted: _Fit) -> list[Finding]:
    """What of the recording's own evidence was let go."""
    out = []
    beside = [(i, kept is not i) for i, kept in zip(fitted.settled.items, fitted.settled.held) if i.kind != "tie"]
    for kind in ("fix", "increment", "revisit"):
        let_go = [gone for item, gone in beside if item.kind == kind]
        if any(let_go):
            params: Params = {"count": float(sum(let_go)), "total": float(len(let_go))}
            code = {"fix": "fix_disagrees", "increment": "increment_disagrees"}.get(kind, "revisit_disagrees")
            out.append(Finding(code, Severity.INFO, params))
    if fitted.dropped:
        out.append(Finding("increments_dropped", Severity.INFO, {"count": float(fitted.dropped)}))
    return out
