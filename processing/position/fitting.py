"""The fit of a free path to what is known, by least squares, with an interval at every moment.

The unknowns are those of :mod:`processing.position.error_model`; ties pull on them by their sigmas. A tie that all
others contradict is held down to what they allow, and named. :func:`prepare` does once what no tie changes,
:func:`fit` gives the whole track, :func:`refit` the same path at some keyframes, quickly enough to follow a hand.
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.coordinates import LocalFrame, frame_of
from processing.orientation.quaternions import multiply, turn_about_up
from processing.position.error_model import Rows, Sigmas, outer
from processing.position.evidence import Evidence
from processing.position.heading import HeadingStart, heading_start, route_turn
from processing.position.odometry import Odometry, rescaled, started_at, thinned
from processing.position.route import RouteLine, route_line
from processing.position.solving import TURNS, Solution, solve, variances
from processing.position.tie_checks import TieCheck, checks_of, hold_down, inflation_of
from processing.position.ties import Observation, launch_tie, observations
from processing.progress import Progress, silent
from processing.settings import PositionSettings
from processing.survey import Finding, FloatArray, Params, Severity, Survey, Track

_COARSE_ROWS = 4000
_OPEN_SCALE = 0.2  # while ties are checked against each other, the radius has no say
_RESCALE_SIGMA = 0.3


@dataclass(frozen=True)
class Fitted:
    """The track, and the table of its ties."""

    track: Track
    checks: tuple[TieCheck, ...]


@dataclass(frozen=True)
class FitProblem:
    """All of a fit that no tie point changes: what was reckoned, what else is known, and the keyframes (k,) rows."""

    odometry: Odometry
    evidence: Evidence
    frame: LocalFrame
    route: RouteLine | None
    rows: Rows
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True)
class FitPreview:
    """The fitted path at k keyframes, to be drawn while a tie point is dragged; sigmas as in :class:`Track`.

    ``cov_level_m2`` (k, 3) holds the variances east-east, east-north, north-north of the place.
    """

    time_s: FloatArray  # (k,)
    chainage_m: FloatArray  # (k,)
    position_w_m: FloatArray  # (k, 3)
    sigma_along_m: FloatArray  # (k,)
    sigma_cross_m: FloatArray  # (k,)
    cov_level_m2: FloatArray  # (k, 3)
    checks: tuple[TieCheck, ...]


def prepare(odometry: Odometry, survey: Survey, evidence: Evidence, settings: PositionSettings) -> FitProblem:
    """Return what every fit of this run shares; tie points and length of the survey have no part in it.

    Raises:
        LeaklineError: CRS_UNKNOWN, LAUNCH_INCOMPLETE, LAUNCH_INVALID.
    """
    frame = frame_of(survey)
    route, findings = route_line(frame, survey.route)
    return FitProblem(odometry, evidence, frame, route, _keyframes(odometry, round(settings.keyframes)), findings)


def fit(problem: FitProblem, survey: Survey, settings: PositionSettings, progress: Progress) -> Fitted:
    """Return the path fitted to the survey's ties, length and route, with its interval (95 % is ±1.96 sigma).

    Raises:
        LeaklineError: CRS_UNKNOWN, LAUNCH_INCOMPLETE, LAUNCH_INVALID.
    """
    return _fitted(problem.odometry, problem, survey, settings, progress)


def refit(problem: FitProblem, survey: Survey, settings: PositionSettings) -> FitPreview:
    """Return the same path as :func:`fit` at the keyframes; errors as there."""
    times = np.array([t.time_s for t in survey.tie_points if t.enabled])
    count = len(problem.odometry.time_s)
    near = np.clip(np.searchsorted(problem.odometry.time_s, times), 0, count - 1)
    rows = np.unique(np.concatenate([problem.rows, near, np.maximum(near - 1, 0)]))
    found = _fitted(thinned(problem.odometry, rows), problem, survey, settings, silent())
    track = found.track
    assert track.cov_level_m2 is not None
    return FitPreview(
        track.time_s,
        track.chainage_m,
        track.position_w_m,
        track.sigma_along_m,
        track.sigma_cross_m,
        track.cov_level_m2,
        found.checks,
    )


def _keyframes(odometry: Odometry, count: int) -> Rows:
    """Rows that share out way and time evenly, the ends among them."""
    way = odometry.chainage_m / max(float(odometry.chainage_m[-1]), 1e-9)
    since = (odometry.time_s - odometry.time_s[0]) / (odometry.time_s[-1] - odometry.time_s[0])
    shares = np.linspace(0.0, 1.0, count)
    rows = np.clip(np.searchsorted(0.8 * way + 0.2 * since, shares), 0, len(way) - 1)
    return np.unique(np.concatenate([[0], rows, [len(way) - 1]]))


def _fitted(
    odometry: Odometry, problem: FitProblem, survey: Survey, settings: PositionSettings, progress: Progress
) -> Fitted:
    frame, route, findings = problem.frame, problem.route, problem.findings
    launch = launch_tie(odometry, survey)
    if launch is not None:
        odometry = started_at(odometry, launch.time_s, launch.sigma_m)
        survey = replace(survey, tie_points=tuple(t for t in survey.tie_points if t is not launch))
    ties, more = observations(odometry, survey, frame, route, settings)
    findings += more
    odometry, factor = _first_scale(odometry, ties)
    if factor != 1.0:  # speeds and the nearest places on the route have changed with the radius
        ties, _ = observations(odometry, survey, frame, route, settings)
    start = heading_start(odometry, survey, ties, route, settings)
    odometry = _turned(odometry, start.turn_rad)
    sigmas = Sigmas(
        odometry.scale_sigma, start.sigma_rad, start.drift_radps, odometry.slope_sigma, odometry.start_sigma_m
    )
    doubting = replace(sigmas, scale=max(sigmas.scale, _OPEN_SCALE))
    held = _held_down(odometry, ties, doubting, settings)
    solution = solve(odometry, held, sigmas, progress)
    checks = checks_of(solution, ties, held)
    inflation = inflation_of(checks)
    track = _track(odometry, solution, route, inflation)
    quality = _quality(odometry, solution, checks, factor, inflation, start, track)
    findings += start.findings + _fit_findings(checks, solution, odometry, track, route)
    return Fitted(replace(track, findings=odometry.findings + findings, quality=quality), checks)


def _held_down(
    odometry: Odometry, ties: tuple[Observation, ...], sigmas: Sigmas, settings: PositionSettings
) -> tuple[Observation, ...]:
    """Hold down what all others contradict, on a coarse path: that takes many solutions."""
    coarse = np.linspace(0, len(odometry.time_s) - 1, _COARSE_ROWS).astype(np.intp)
    rows = np.unique(np.concatenate([coarse, np.array([t.row for t in ties], dtype=np.intp)]))
    thin = thinned(odometry, rows)
    placed = tuple(replace(t, row=int(np.searchsorted(rows, t.row))) for t in ties)
    held = hold_down(placed, lambda some: solve(thin, some, sigmas, None), settings)
    return tuple(tie if kept is mine else replace(kept, row=tie.row) for tie, mine, kept in zip(ties, placed, held))


def _first_scale(odometry: Odometry, ties: tuple[Observation, ...]) -> tuple[Odometry, float]:
    """An unknown radius is first taken from the furthest chainage, so that what follows is a small correction."""
    far = [(float(o.value[0]), float(odometry.chainage_m[o.row])) for o in ties if not o.is_place]
    far = [(value, rolled) for value, rolled in far if value > 0.0 and rolled > 0.0]
    if odometry.scale_sigma < _RESCALE_SIGMA and far:
        return odometry, 1.0
    if not far:
        return odometry, 1.0
    value, rolled = max(far)
    return rescaled(odometry, value / rolled), value / rolled


def _turned(odometry: Odometry, turn_rad: float) -> Odometry:
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    east, north, up = odometry.position_w_m.T
    return replace(
        odometry,
        position_w_m=np.column_stack([cos * east - sin * north, sin * east + cos * north, up]),
        quat_ws=multiply(turn_about_up(turn_rad), odometry.quat_ws),
    )


def _track(odometry: Odometry, solution: Solution, route: RouteLine | None, inflation: float) -> Track:
    deviation, path = solution.deviation, solution.path
    chainage = (1.0 + deviation.scale) * odometry.chainage_m + deviation.along_m
    chainage = np.maximum.accumulate(np.maximum(chainage, 0.0))
    spread = variances(solution)
    along, cross, up = (np.sqrt(inflation * v) for v in (spread.along_m2, spread.cross_m2, spread.up_m2))
    level = inflation * spread.level_m2
    place = np.column_stack([path.level_m, path.up_m])
    turn = deviation.heading_rad
    if route is not None:
        turn = route_turn(route, chainage, place)
        place = route.at(chainage)
        cross = np.full_like(cross, route.sigma_m)
        if np.ptp(route.points_w_m[:, 2]) > 0.0:
            up = np.full_like(up, route.sigma_m)
        ahead = route.directions(chainage)[:, :2]
        level = (along**2 - cross**2)[:, None] * outer(ahead) + (cross**2)[:, None] * np.array([1.0, 0.0, 1.0])
    return Track(
        time_s=odometry.time_s,
        chainage_m=chainage,
        position_w_m=place,
        sigma_along_m=along,
        sigma_cross_m=cross,
        sigma_up_m=up,
        quat_ws=multiply(turn_about_up(turn), odometry.quat_ws),
        speed_mps=odometry.speed_mps * (1.0 + deviation.scale),
        method=odometry.method,
        reason=odometry.reason,
        not_assessed=odometry.not_assessed,
        cov_level_m2=level,
    )


def _quality(
    odometry: Odometry,
    solution: Solution,
    checks: tuple[TieCheck, ...],
    factor: float,
    inflation: float,
    start: HeadingStart,
    track: Track,
) -> Params:
    model = solution.model
    rows = np.array([t.row for t in solution.ties], dtype=np.intp)
    taken = model.sigmas.scale**2 * np.concatenate(
        [model.scaled_m[r] if t.is_place else model.chainage_m[r : r + 1] for t, r in zip(solution.ties, rows)]
        + [np.empty(0)]
    )
    # the ups in between have no part in the scale
    full = np.zeros(len(solution.alpha))
    at = used = 0
    for tie in solution.ties:
        n = 2 if tie.is_place else 1
        full[at : at + n] = taken[used : used + n]
        at, used = at + len(tie.value), used + n
    variance = model.sigmas.scale**2 - float(full @ solution.inverse @ full)
    moving = track.speed_mps > 0.01
    out: dict[str, str | float] = dict(odometry.quality)
    out |= {
        "scale": factor * (1.0 + solution.deviation.scale),
        "scale_sigma": float(np.sqrt(max(variance, 0.0))),
        "path_length_m": float(track.chainage_m[-1]),
        "moving_share": float(np.mean(moving)),
        "mean_speed_mps": float(np.mean(track.speed_mps[moving])) if np.any(moving) else 0.0,
        "heading_basis": start.basis,
        "interval_basis": "ties" if len(checks) >= 3 else "prior",
        "interval_inflation": float(np.sqrt(inflation)),
        "ties_used": float(len(checks)),
        "ties_held_down": float(sum(c.held_down for c in checks)),
        "sigma_along_max_m": float(track.sigma_along_m.max()),
    }
    if "radius_m" in out:
        out["radius_fitted_m"] = float(out["radius_m"]) * float(out["scale"])
    if checks:
        out["tie_residual_rms_m"] = float(np.sqrt(np.mean([c.residual_m**2 for c in checks])))
        out["tie_left_out_max_m"] = max(abs(c.left_out_m) for c in checks)
    return out


def _fit_findings(
    checks: tuple[TieCheck, ...],
    solution: Solution,
    odometry: Odometry,
    track: Track,
    route: RouteLine | None,
) -> tuple[Finding, ...]:
    out = []
    for check in checks:
        if check.held_down:
            params: Params = {"name": check.name, "metres": abs(check.left_out_m), "sigma_m": check.left_out_sigma_m}
            out.append(Finding("tie_disagrees" if check.name else "length_disagrees", Severity.WARNING, params))
    scale = solution.deviation.scale
    if odometry.scale_sigma < _RESCALE_SIGMA and abs(scale) > 3.0 * odometry.scale_sigma:
        out.append(Finding("scale_unusual", Severity.WARNING, {"percent": 100.0 * scale}))
    if solution.turns == TURNS:
        out.append(Finding("fit_not_settled", Severity.WARNING))
    if route is not None:
        beyond = float(track.chainage_m[-1] - route.chainage_m[-1])
        if beyond > 3.0 * float(track.sigma_along_m[-1]) + 1.0:
            out.append(Finding("beyond_route", Severity.WARNING, {"metres": beyond}))
    return tuple(out)
