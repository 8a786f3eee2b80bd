"""All that a recording itself says of the place, gathered for the fit: bends, joints, pressure, slip, as settings ask.

What needs only the recording (:func:`gather`) is found once; what needs the map beside it (:func:`gather_on_route`) is
found when the map or the launch is known, from the free path alone. Each kind leaves a finding of what it used.
"""

from dataclasses import replace

import numpy as np

from processing.coordinates import frame_of
from processing.position.bends import find_bends
from processing.position.evidence import ChainageIncrement, Evidence, HeightSeries, SlipSpan
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
_ROUNDING = 1e-6


def gather(
    imu: ImuSamples,
    attitude: Attitude,
    odometry: Odometry,
    survey: Survey,
    settings: PositionSettings,
    progress: Progress,
) -> Evidence:
    """Return what the recording says without a map: joints, heights, slips, with their findings.

    Of the survey only motion, radius and the pipe's joint spacing have a part in it.
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
        found = find_heights(imu, odometry, progress.part(0.9, 1.0, "position_pressure"))
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
    found = find_bends(scaled, route, settings, progress, sigma, _lost(scaled, known.slips, settings))
    return replace(known, fixes=(*known.fixes, *found.fixes), findings=(*known.findings, *found.findings))


def _lost(odometry: Odometry, slips: tuple[SlipSpan, ...], settings: PositionSettings) -> FloatArray:
    """Cumulated variance (m,) of what gaps and slides lost, beyond the usual slip."""
    steps = np.diff(odometry.along_var_m2) - settings.slip_walk**2 * np.diff(odometry.chainage_m)
    steps = np.where(steps > _ROUNDING, steps, 0.0)
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
