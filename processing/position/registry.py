"""The methods that give a path, in one visible table, and the step that picks one and fits what it gives."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from processing.errors import ErrorCode, LeaklineError
from processing.position import inertial, rolling, zupt
from processing.position.evidence import Evidence
from processing.position.fit_results import Fitted
from processing.position.fitting import FitProblem, fit, prepare
from processing.position.gathering import gather, gather_on_route
from processing.position.odometry import Odometry, held_back
from processing.progress import Progress, silent
from processing.settings import PositionSettings
from processing.survey import Attitude, ImuSamples, Motion, Survey, Track

Reckon = Callable[[ImuSamples, Attitude, Survey, PositionSettings, Progress], Odometry]


@dataclass(frozen=True)
class Reckoned:
    """What a recording gives before anything else is known: the free path, and what it says of the place itself."""

    odometry: Odometry
    evidence: Evidence


@dataclass(frozen=True)
class Method:
    """A way of dead reckoning: ``auto`` takes it for ``motions`` and says ``reason`` (a key of ``[reasons]``)."""

    reckon: Reckon
    motions: tuple[Motion, ...]
    reason: str


METHODS: dict[str, Method] = {
    "rolling": Method(rolling.reckon, (Motion.ROLLING,), "position_rolling"),
    "zupt": Method(zupt.reckon, (Motion.FOOT,), "position_zupt"),
    "inertial": Method(inertial.reckon, (Motion.CARRIED, Motion.FOOT), "position_inertial"),
}


def choose_method(survey: Survey) -> tuple[str, str]:
    """Return the method's name and the key of the reason for it.

    Raises:
        LeaklineError: SETTING_INVALID for a name that is not in :data:`METHODS`.
    """
    wanted = survey.processing.position
    if wanted in METHODS:
        return wanted, "position_chosen"
    if wanted != "auto":
        allowed = ", ".join(("auto", *METHODS))
        raise LeaklineError(ErrorCode.SETTING_INVALID, name="processing.position", value=wanted, allowed=allowed)
    return next((name, m.reason) for name, m in METHODS.items() if survey.device.motion in m.motions)


def reckon(
    imu: ImuSamples, attitude: Attitude, survey: Survey, settings: PositionSettings, progress: Progress
) -> Odometry:
    """Return the free path by the survey's method, before any fit; errors as :func:`choose_method`."""
    name, reason = choose_method(survey)
    odometry = METHODS[name].reckon(imu, attitude, survey, settings, progress)
    return replace(held_back(odometry), method=name, reason=reason, heading_from=attitude.heading_from)


def find_reckoned(
    imu: ImuSamples, attitude: Attitude, survey: Survey, settings: PositionSettings, progress: Progress | None = None
) -> Reckoned:
    """Return free path and evidence of a recording; ties, length and route of the survey have no part in it.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES, SETTING_INVALID.
    """
    progress = progress or silent()
    odometry = reckon(imu, attitude, survey, settings, progress.part(0.0, 0.8, "position_reckon"))
    return Reckoned(odometry, gather(imu, attitude, odometry, survey, settings, progress.part(0.8, 1.0)))


def find_track(
    imu: ImuSamples, attitude: Attitude, survey: Survey, settings: PositionSettings, progress: Progress | None = None
) -> Track:
    """Return the path of the run: dead reckoning by its motion, fitted to all that the survey knows.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES, SETTING_INVALID, CRS_UNKNOWN, LAUNCH_INCOMPLETE, LAUNCH_INVALID.
    """
    return find_fitted(imu, attitude, survey, settings, progress).track


def find_fitted(
    imu: ImuSamples,
    attitude: Attitude,
    survey: Survey,
    settings: PositionSettings,
    progress: Progress | None = None,
    evidence: Evidence | None = None,
) -> Fitted:
    """Return the track of :func:`find_track` with the table of its ties; ``evidence`` stands in for what is found."""
    progress = progress or silent()
    reckoned = find_reckoned(imu, attitude, survey, settings, progress.part(0.0, 0.8, "position_reckon"))
    if evidence is None:
        problem = problem_of(reckoned, survey, settings)
    else:
        problem = prepare(reckoned.odometry, survey, evidence, settings)
    return fit(problem, survey, settings, progress.part(0.8, 1.0, "position_fit"))


def problem_of(reckoned: Reckoned, survey: Survey, settings: PositionSettings) -> FitProblem:
    """Return the fit of a run as far as no tie point changes it; errors as :func:`processing.position.fitting.prepare`.

    With it, :func:`processing.position.fitting.refit` follows a tie point that is being dragged.
    """
    evidence = gather_on_route(reckoned.odometry, survey, settings, silent(), reckoned.evidence)
    return prepare(reckoned.odometry, survey, evidence, settings)
