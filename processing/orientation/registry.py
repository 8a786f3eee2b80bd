"""The table of attitude estimators, and the step of the pipeline that calibrates, chooses one and runs it."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from processing.errors import ErrorCode, LeaklineError
from processing.orientation import (
    kernels,
    kernels_calibration,
    kernels_ekf7,
    kernels_ekf_gd,
    kernels_eskf,
    kernels_preintegration,
    kernels_samples,
    kernels_ukf,
)
from processing.orientation import quaternions as qt
from processing.orientation.accelerometer import accelerometer_findings, calibrate_at_rests, calibrate_rolling
from processing.orientation.batch import batch
from processing.orientation.calibration import Calibration, calibrate, calibration_findings
from processing.orientation.direct import acc_mag, device, device_disagrees, device_turns_the_other_way
from processing.orientation.ekf7 import ekf7, ekf7_recursion
from processing.orientation.ekf_gd import ekf_gd, ekf_gd_recursion
from processing.orientation.eskf import eskf, eskf_recursion
from processing.orientation.gyro import gyro_recursion, integrate_gyro
from processing.orientation.gyro_scale import calibrate_scale
from processing.orientation.madgwick import madgwick, madgwick_recursion
from processing.orientation.magnetometer import MagnetometerVerdict, judge_magnetometer, magnetometer_findings
from processing.orientation.mahony import mahony, mahony_recursion
from processing.orientation.recursion import Estimate, Recursion
from processing.orientation.samples import BLOCK_ROWS, TrustedSamples, trusted_samples
from processing.orientation.ukf import ukf, ukf_recursion
from processing.orientation.vqf_filters import bias_in_motion, offline_vqf, vqf
from processing.progress import Progress
from processing.settings import OrientationSettings
from processing.survey import Attitude, Finding, FloatArray, ImuSamples, Motion, Severity, Survey

Function = Callable[[TrustedSamples, float, Progress], Estimate]
_KERNELS = (
    kernels,
    kernels_calibration,
    kernels_ekf7,
    kernels_ekf_gd,
    kernels_eskf,
    kernels_preintegration,
    kernels_samples,
    kernels_ukf,
)
_EARTH_RADPS = 7.292115e-5  # WGS 84
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Estimator:
    """One row of the table: ``title`` is a key of ``[orientation]`` in the messages, ``source`` what it rests on.

    ``recursion`` is there where the estimator can follow a recording as it comes (:mod:`processing.orientation.live`).
    """

    name: str
    title: str
    uses_field: bool  # takes its heading from the magnetometer where that is trusted
    needs_field: bool  # has no heading at all without it
    function: Function
    source: str
    recursion: Callable[[TrustedSamples], Recursion] | None = None


_MADGWICK = "Madgwick, Harrison, Vaidyanathan 2011"
_MAHONY = "Mahony, Hamel, Pflimlin 2008"
ESTIMATORS: tuple[Estimator, ...] = (
    Estimator("batch", "batch", True, False, batch, "Forster 2017, with a bounded velocity"),
    Estimator("offline_vqf", "offline_vqf", True, False, offline_vqf, "Laidig, Seel 2023"),
    Estimator("vqf", "vqf", True, False, vqf, "Laidig, Seel 2023"),
    Estimator("eskf", "eskf", True, False, eskf, "Solà 2017, with a bounded velocity", eskf_recursion),
    Estimator("ukf", "ukf", True, False, ukf, "Crassidis, Markley 2003", ukf_recursion),
    Estimator("ekf7", "ekf7", True, False, ekf7, "Akkaya, Talu 2017", ekf7_recursion),
    Estimator("ekf_gd", "ekf_gd", True, False, ekf_gd, "Akkaya 2017", ekf_gd_recursion),
    Estimator("madgwick", "madgwick", True, False, madgwick, _MADGWICK, madgwick_recursion),
    Estimator("madgwick6", "madgwick6", False, False, madgwick, _MADGWICK, madgwick_recursion),
    Estimator("mahony", "mahony", True, False, mahony, _MAHONY, mahony_recursion),
    Estimator("mahony6", "mahony6", False, False, mahony, _MAHONY, mahony_recursion),
    Estimator("accmag", "accmag", True, True, acc_mag, "Akkaya 2017"),
    Estimator("gyro", "gyro", False, False, integrate_gyro, "closed form", gyro_recursion),
    Estimator("device", "device", False, False, device, "the recorder"),
)
DEFAULT = "batch"  # best on BROAD and on P1's loops, with a field and without


def estimator(name: str) -> Estimator:
    """Return the estimator of that name.

    Raises:
        LeaklineError: SETTING_INVALID for a name that is not in the table.
    """
    for row in ESTIMATORS:
        if row.name == name:
            return row
    allowed = ", ".join(["auto", *(row.name for row in ESTIMATORS)])
    raise LeaklineError(ErrorCode.SETTING_INVALID, name="processing.orientation", value=name, allowed=allowed)


def estimate_attitude(
    imu: ImuSamples, survey: Survey, settings: OrientationSettings, progress: Progress
) -> tuple[Attitude, Calibration, tuple[Finding, ...]]:
    """Return the attitude at every sample, the calibration it rests on, and what the operator should know.

    ``survey.processing.orientation`` names the estimator; ``auto`` takes the batch smoother, with its heading from
    the magnetometer where that is trusted, and the device's own quaternions only where there is no gyro.
    ``Attitude.reason`` says why. Unless ``heading_from`` is ``magnetometer`` or ``device`` the yaw is arbitrary
    (:mod:`processing.orientation.start`).

    Raises:
        LeaklineError: TOO_FEW_SAMPLES; SETTING_INVALID for an unknown estimator, or ``device`` without quaternions.
    """
    progress.update(0.0, "orientation_rests")
    calibration = _calibrate(imu, survey, settings, progress)
    found = list(calibration_findings(calibration, survey.launch, settings))
    progress.update(0.2, "orientation_attitude")
    verdict = judge_magnetometer(imu, calibration, survey.pipe.material, settings)
    chosen, reason = _choose(imu, survey, verdict)
    samples = trusted_samples(imu, calibration, settings, verdict.field if chosen.uses_field else None)
    if survey.device.motion is Motion.ROLLING:
        samples = replace(samples, rolling_radius_m=_rolling_radius(survey.device.radius_m))
    if survey.launch.latitude is not None:
        earth_up = _EARTH_RADPS * float(np.sin(np.radians(survey.launch.latitude)))
        samples = replace(samples, earth_up_radps=earth_up)
    found += _sensor_findings(samples, chosen, verdict)
    if not all(k.COMPILED for k in _KERNELS) and len(imu.time_s) > BLOCK_ROWS:
        _log.info(
            "the attitude recursions run uncompiled, some hundred times slower: build them with setup.py build_ext"
        )
    yaw = float(
        qt.yaw_from_heading(np.radians(90.0 if survey.launch.heading_deg is None else survey.launch.heading_deg))
    )
    estimate = chosen.function(samples, yaw, progress.part(0.2, 0.95))
    heading_from = "device" if chosen.name == "device" else "launch" if samples.field is None else "magnetometer"
    if heading_from == "magnetometer" and settings.declination_deg != 0.0:
        _turn_in_place(estimate.quat_ws, -float(np.radians(settings.declination_deg)))
    bias = _taken_off(imu, calibration, estimate.bias_radps)
    progress.update(1.0)
    return Attitude(estimate.quat_ws, bias, chosen.name, reason, heading_from), calibration, tuple(found)


def _rolling_radius(told_m: float | None) -> tuple[float, float]:
    """Return a ball's radius ± 1 sigma in metres; balls that go through pipes are about as large when nobody says."""
    return (0.06, 0.05) if told_m is None else (told_m, 0.05 * told_m)


def _calibrate(imu: ImuSamples, survey: Survey, settings: OrientationSettings, progress: Progress) -> Calibration:
    calibration = calibrate(imu, settings)
    progress.update(0.05, "orientation_calibration")
    if _has_no_gyro(imu):
        return calibration
    if calibration.basis == "none":
        bias, sigma = bias_in_motion(trusted_samples(imu, calibration, settings, None))
        calibration = replace(calibration, bias_radps=bias[None], bias_sigma_radps=sigma[None], basis="motion")
    if survey.device.motion is not Motion.ROLLING:
        return calibrate_at_rests(calibration) if settings.accelerometer == "auto" else calibration
    samples = trusted_samples(imu, calibration, settings, None)
    if settings.gyro_scale == "auto":
        samples = replace(samples, calibration=calibrate_scale(samples, progress.part(0.05, 0.11)))
    if settings.accelerometer == "auto":
        samples = replace(samples, calibration=calibrate_rolling(samples, progress.part(0.11, 0.14)))
        if settings.gyro_scale == "auto" and samples.calibration.acc_basis != "none":
            # gravity is seen better now, and the scale with it
            samples = replace(samples, calibration=calibrate_scale(samples, progress.part(0.14, 0.2)))
    return samples.calibration


def _has_no_gyro(imu: ImuSamples) -> bool:
    return not np.any(np.ptp(imu.gyr_s_radps[:: max(1, len(imu.time_s) // 100_000)], axis=0) > 0.0)


def _choose(imu: ImuSamples, survey: Survey, verdict: MagnetometerVerdict) -> tuple[Estimator, str]:
    if survey.processing.orientation != "auto":
        return estimator(survey.processing.orientation), "orientation_chosen"
    if _has_no_gyro(imu) and imu.quat_ws is not None:
        return estimator("device"), "orientation_auto_no_gyro"
    return estimator(DEFAULT), f"orientation_auto_{verdict.reason}"


def _sensor_findings(samples: TrustedSamples, chosen: Estimator, verdict: MagnetometerVerdict) -> list[Finding]:
    found: list[Finding] = []
    if _has_no_gyro(samples.imu):
        found.append(Finding("gyro_dead", Severity.WARNING))
    found += magnetometer_findings(verdict)
    if chosen.needs_field and samples.field is None:
        found.append(Finding("estimator_lacks_field", Severity.WARNING, {"method": chosen.name}))
    if chosen.name == "device" and samples.imu.quat_ws is not None:
        if device_turns_the_other_way(samples):
            found.append(Finding("device_quaternions_conjugated", Severity.REPAIRED))
        elif device_disagrees(samples):
            found.append(Finding("device_quaternions_disagree", Severity.WARNING))
    scale = samples.calibration.gyr_scale
    if np.any(scale != 1.0):
        x, y, z = (float(v) for v in 100.0 * (scale - 1.0))
        found.append(Finding("gyro_scale_found", Severity.INFO, {"x_pct": x, "y_pct": y, "z_pct": z}))
    found += accelerometer_findings(samples.calibration)
    return found


def _turn_in_place(quat_ws: FloatArray, yaw_rad: float) -> None:
    turn = qt.turn_about_up(yaw_rad)
    for start in range(0, len(quat_ws), BLOCK_ROWS):
        rows = slice(start, start + BLOCK_ROWS)
        quat_ws[rows] = qt.multiply(turn, quat_ws[rows])


def _taken_off(imu: ImuSamples, calibration: Calibration, residual: FloatArray | None) -> FloatArray:
    """Return measured minus true rate: (3,) where it is constant, else (n, 3); ``residual`` is used up."""
    constant = len(calibration.bias_time_s) == 1 and np.array_equal(calibration.gyr_matrix, np.eye(3))
    if residual is None and constant:
        return np.array(calibration.bias_radps[0], dtype=np.float64)
    off = np.zeros((len(imu.time_s), 3)) if residual is None else residual
    for start in range(0, len(off), BLOCK_ROWS):
        rows = slice(start, start + BLOCK_ROWS)
        gyr = np.asarray(imu.gyr_s_radps[rows], dtype=np.float64)
        off[rows] += gyr - calibration.corrected(imu.time_s[rows], gyr)
    return off
