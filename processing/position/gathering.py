"""All that a recording itself says of the place, gathered for the fit: bends, joints, pressure, slip, as settings ask.

What needs only the recording (:func:`gather`) is found once; what needs the map beside it (:func:`gather_on_route`) is
found when the map or the launch is known, from the free path alone. Each kind leaves a finding of what it used.
"""

from dataclasses import replace

import numpy as np

from processing.coordinates import frame_of
from processing.position.bend_checks import Doubt, Known, denied_by, start_off
from processing.position.bends import SLIP_WALK, find_bends, start_sigma_m
from processing.position.evidence import ChainageFix, ChainageIncrement, Evidence, HeightSeries, SlipSpan
from processing.position.joints import find_joints
from processing.position.odometry import Odometry, cumulated, in_spans, rescaled, started_at
from processing.position.pressure import find_heights
from processing.position.route import RouteLine, route_line
from processing.position.slip import find_slips
from processing.position.ties import launch_tie
from processing.progress import Progress
from processing.settings import PositionSettings
from processing.survey import Attitude, Finding, FloatArray, ImuSamples, Motion, Severity, Survey

_UNKNOWN_SCALE = 0.3  # an odometer without a radius: only the known ends tell its scale
_TOLD_BY_ENDS = 0.03


def gather(
    imu: ImuSamples,
    attitude: Attitude,
    odometry: Odometry,
    survey: Survey,
    settings: PositionSettings,
    progress: Progress,
) -> Evidence:
    """Return what the recording says without a map: joints, heights, slips, with their findings.

    Of the survey only motion, radius, and the pipe's joint spacing and diameter have a part in it.
    """
    if float(odometry.chainage_m[-1]) <= 0.0:
        return Evidence()
    rolling = survey.device.motion is Motion.ROLLING
    increments: tuple[ChainageIncrement, ...] = ()
    findings: list[Finding] = []
    slips: tuple[SlipSpan, ...] = ()
    if rolling and settings.slips == "auto":
        slips = find_slips(imu, attitude, odometry, progress.part(0.0, 0.5, "position_slip"))
        if slips:
            seconds = sum(s.end_s - s.start_s for s in slips)
            params = {"count": float(len(slips)), "seconds": seconds}
            findings.append(Finding("slips_found", Severity.MASKED, params))
    if rolling and settings.joints == "auto":
        joints = find_joints(imu, odometry, survey.pipe.joint_spacing_m, progress.part(0.5, 0.9, "position_joints"))
        increments = joints.increments
        findings += joints.findings
    heights: tuple[HeightSeries, ...] = ()
    if survey.device.motion is not Motion.FOOT and settings.pressure == "auto":
        diameter = survey.pipe.diameter_m
        found = find_heights(imu, odometry, progress.part(0.9, 1.0, "position_pressure"), diameter)
        heights = found.heights
        findings += found.findings
    return Evidence(increments=increments, heights=heights, slips=slips, findings=tuple(findings))


def gather_on_route(
    odometry: Odometry, survey: Survey, settings: PositionSettings, progress: Progress, known: Evidence | None = None
) -> Evidence:
    """Return ``known`` (none by default) together with what the mapped route adds: the bends recognised on it.

    Raises:
        LeaklineError: CRS_UNKNOWN, LAUNCH_INCOMPLETE, LAUNCH_INVALID.
    """
    known = known or Evidence()
    if survey.route is None or settings.bends != "auto" or float(odometry.chainage_m[-1]) <= 0.0:
        return known
    route, _ = route_line(frame_of(survey), survey.route)
    if route is None:
        return known
    launch = launch_tie(odometry, survey)
    if launch is not None:
        odometry = started_at(odometry, launch.time_s, launch.sigma_m)
    scaled, sigma = _scaled(odometry, survey, route)
    lost_m2 = _lost(scaled, known.slips)
    found = find_bends(scaled, route, settings, progress, sigma, lost_m2)
    against = _against(found.fixes, scaled, survey, lost_m2, Doubt(sigma, start_sigma_m(route), SLIP_WALK))
    if against is not None:
        return replace(known, findings=(*known.findings, against))
    return replace(known, fixes=(*known.fixes, *found.fixes), findings=(*known.findings, *found.findings))


def _against(
    fixes: tuple[ChainageFix, ...], odometry: Odometry, survey: Survey, lost_m2: FloatArray, doubt: Doubt
) -> Finding | None:
    """What speaks against the map that the bends were recognised on: the launch, or most of the tie points."""
    if not fixes:
        return None
    bends = _known([(f.time_s, f.chainage_m, f.sigma_m) for f in fixes], odometry, lost_m2)
    off, wrong = start_off(bends, doubt)
    if wrong:
        return Finding("bends_shifted", Severity.WARNING, {"metres": off})
    ties = [(t.time_s, t.chainage_m, max(t.sigma_m, 0.1)) for t in survey.tie_points if t.enabled and t.chainage_m]
    if not ties:
        return None
    denied = denied_by(bends, _known(ties, odometry, lost_m2), doubt)
    if sum(denied) <= 0.5 * len(denied):
        return None
    return Finding("bends_against_ties", Severity.WARNING, {"count": float(sum(denied)), "ties": float(len(ties))})


def _known(told: list[tuple[float, float, float]], odometry: Odometry, lost_m2: FloatArray) -> Known:
    time_s, place, sigma = (np.array(column) for column in zip(*told, strict=True))
    at = np.interp(time_s, odometry.time_s, odometry.chainage_m)
    return Known(at, place, sigma, np.interp(time_s, odometry.time_s, lost_m2))


def _lost(odometry: Odometry, slips: tuple[SlipSpan, ...]) -> FloatArray:
    """Cumulated variance (m,) of what gaps and slides lost, beyond the usual slip."""
    lost = odometry.lost_var_m2
    steps = np.diff(lost) if lost is not None else np.zeros(len(odometry.time_s) - 1)
    for slip in slips:
        inside = in_spans(odometry.time_s, np.array([[slip.start_s, slip.end_s]]))
        told = float(np.diff(np.interp([slip.start_s, slip.end_s], odometry.time_s, odometry.chainage_m))[0])
        shares = max(int(np.count_nonzero(inside)), 1)
        steps[inside] += ((slip.sigma_share * told) ** 2 + slip.sigma_m**2) / shares
    return cumulated(steps)


def _scaled(odometry: Odometry, survey: Survey, route: RouteLine) -> tuple[Odometry, float]:
    """An odometer without a radius is first laid on the known length, or on the map's."""
    if odometry.scale_sigma < _UNKNOWN_SCALE:
        return odometry, odometry.scale_sigma
    ties = [(t.chainage_m, t.time_s) for t in survey.tie_points if t.enabled and t.chainage_m]
    far = max(ties, default=(survey.pipe.length_m or float(route.chainage_m[-1]), float(odometry.time_s[-1])))
    rolled = float(np.interp(far[1], odometry.time_s, odometry.chainage_m))
    if rolled <= 0.0:
        return odometry, odometry.scale_sigma
    return rescaled(odometry, far[0] / rolled), _TOLD_BY_ENDS
