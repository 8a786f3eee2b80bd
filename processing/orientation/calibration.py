"""Gyro offset, noise and the local gravity, from the moments at which the device lay still.

Model: ``ω_true = M (ω_measured − bias(t))``. The bias is the mean rate of each rest, linear in time between rests
and held beyond the first and the last; ``M`` is 1 unless :mod:`processing.orientation.gyro_scale` finds another.
"""

from dataclasses import dataclass, field

import numpy as np

from processing.orientation import kernels_samples
from processing.orientation.rests import Rest, find_rests
from processing.settings import OrientationSettings
from processing.survey import Finding, FloatArray, ImuSamples, Launch, Severity

STANDARD_GRAVITY_MPS2 = 9.80665
_INSTABILITY_RADPS = np.radians(0.003)  # a rest, however long, tells the bias no better (navigation §6.2)
_WALK_RADPS_RTS = np.radians(3e-3)  # bias random walk of consumer MEMS (navigation §6.4)
_SLOPE_S = 0.1
_UNKNOWN_RADPS = np.radians(1.0)  # 1 sigma of an offset that nobody measured (navigation §6.2)


@dataclass(frozen=True)
class Calibration:
    """What was found out about the sensors of this run.

    ``bias_radps`` (k, 3) ± ``bias_sigma_radps`` (k, 3) at survey times ``bias_time_s`` (k,), k ≥ 1. ``basis`` says
    where it comes from: ``rest``, ``motion`` (estimated from the whole run) or ``none`` (zero, wide sigma).
    """

    bias_time_s: FloatArray
    bias_radps: FloatArray
    bias_sigma_radps: FloatArray
    basis: str = "none"
    rests: tuple[Rest, ...] = ()
    gyr_noise_radps_rthz: float | None = None  # density, mean of the axes, from the rests
    acc_noise_mps2_rthz: float | None = None
    gravity_mps2: float = STANDARD_GRAVITY_MPS2  # mean |a| at rest: the unit of the accelerometer in this run
    gyr_matrix: FloatArray = field(default_factory=lambda: np.eye(3))  # scale, and misalignment off the diagonal
    gyr_matrix_sigma: FloatArray = field(default_factory=lambda: np.full((3, 3), np.nan))
    acc_matrix: FloatArray = field(default_factory=lambda: np.eye(3))  # measured = matrix · true + bias + arm's share
    acc_matrix_sigma: FloatArray = field(default_factory=lambda: np.full((3, 3), np.nan))
    acc_bias_mps2: FloatArray = field(default_factory=lambda: np.zeros(3))
    acc_bias_sigma_mps2: FloatArray = field(default_factory=lambda: np.full(3, np.nan))
    lever_arm_m: FloatArray = field(default_factory=lambda: np.zeros(3))  # of the sensor from the centre of the ball
    lever_arm_sigma_m: FloatArray = field(default_factory=lambda: np.full(3, np.nan))
    acc_basis: str = "none"  # rolling | rests | none

    @property
    def gyr_scale(self) -> FloatArray:
        """The scales of the axes (3,): the diagonal of ``gyr_matrix``."""
        return np.asarray(np.diag(self.gyr_matrix), dtype=np.float64)

    def bias_at(self, time_s: FloatArray) -> FloatArray:
        """Return the gyro offset (m, 3) in rad/s at times (m,)."""
        return np.column_stack([np.interp(time_s, self.bias_time_s, self.bias_radps[:, i]) for i in range(3)])

    def sigma_at(self, time_s: FloatArray) -> FloatArray:
        """Return 1 sigma (m, 3) of :meth:`bias_at`, growing as a random walk away from the nearest rest."""
        time = np.asarray(time_s, dtype=np.float64)
        away = np.min(np.abs(time[:, None] - self.bias_time_s[None, :]), axis=1)
        near = np.column_stack([np.interp(time, self.bias_time_s, self.bias_sigma_radps[:, i]) for i in range(3)])
        return np.asarray(np.hypot(near, (_WALK_RADPS_RTS * np.sqrt(away))[:, None]), dtype=np.float64)

    def corrected(self, time_s: FloatArray, gyr_s_radps: FloatArray) -> FloatArray:
        """Return angular rates (m, 3) with offset, scale and misalignment taken off."""
        bias_time, bias, matrix = _plain(self.bias_time_s), _plain(self.bias_radps), _plain(self.gyr_matrix)
        out = np.empty((len(gyr_s_radps), 3))
        kernels_samples.correct_rates(_plain(time_s), _plain(gyr_s_radps), bias_time, bias, matrix, out)
        return out

    def force(self, acc_s_mps2: FloatArray, gyr_s_radps: FloatArray, time_s: FloatArray) -> FloatArray:
        """Return the specific force (m, 3) at the centre of the device, without the accelerometer's own errors.

        ``gyr_s_radps`` (m, 3) are corrected rates at ``time_s`` (m,). Uncalibrated it is ``acc_s_mps2`` itself.
        """
        if self.acc_basis == "none":
            return acc_s_mps2
        slope = np.zeros((0, 3))
        if np.any(self.lever_arm_m != 0.0) and len(time_s) > 1:
            slope = slope_of(gyr_s_radps, time_s)
        acc, rate, bias, arm = (_plain(v) for v in (acc_s_mps2, gyr_s_radps, self.acc_bias_mps2, self.lever_arm_m))
        out = np.empty((len(acc), 3))
        kernels_samples.correct_force(acc, rate, slope, bias, arm, np.linalg.inv(self.acc_matrix), out)
        return out


def slope_of(rate_radps: FloatArray, time_s: FloatArray) -> FloatArray:
    """Return ``ω̇`` (m, 3) of rates smoothed over a tenth of a second: unsmoothed, it is the gyro's noise."""
    from scipy.ndimage import uniform_filter1d

    period = float(np.median(np.diff(time_s)))
    width = max(min(round(_SLOPE_S / period), len(time_s)), 1) if period > 0.0 else 1
    smooth = uniform_filter1d(rate_radps, width | 1, axis=0, mode="nearest")
    out = np.empty((len(smooth), 3))
    kernels_samples.slopes(_plain(smooth), _plain(time_s), out)
    return out


def _plain(values: FloatArray) -> FloatArray:
    """Return the same numbers as the kernels read them: float64, row by row."""
    return np.ascontiguousarray(values, dtype=np.float64)


def calibrate(imu: ImuSamples, settings: OrientationSettings) -> Calibration:
    """Return the calibration from all rests of a run; without one the offset is zero ± 1 °/s and ``basis`` ``none``."""
    rests = find_rests(imu, settings)
    start = float(imu.time_s[0])
    if not rests:
        return Calibration(np.array([start]), np.zeros((1, 3)), np.full((1, 3), _UNKNOWN_RADPS))
    rate_hz = imu.sample_rate_hz
    weight = np.array([r.count for r in rests], dtype=np.float64)
    quiet = np.array([0.0 if r.shaken else r.count for r in rests])
    told = bool(np.any(quiet > 0.0))  # what shakes the device is no noise of its sensors
    gyr_variance = np.average([np.mean(r.gyr_std_radps**2) for r in rests], weights=quiet) if told else 0.0
    acc_variance = np.average([np.mean(r.acc_std_mps2**2) for r in rests], weights=quiet) if told else 0.0
    gravity = float(np.average([np.linalg.norm(r.acc_mean_mps2) for r in rests], weights=weight))
    return Calibration(
        bias_time_s=np.array([r.middle_s for r in rests]),
        bias_radps=np.array([r.gyr_mean_radps for r in rests]),
        bias_sigma_radps=np.array([np.maximum(r.gyr_std_radps / np.sqrt(r.count), _INSTABILITY_RADPS) for r in rests]),
        basis="rest",
        rests=rests,
        # white noise of one-sided density N sampled at f has the variance N² f/2
        gyr_noise_radps_rthz=float(np.sqrt(2.0 * gyr_variance / rate_hz)) if told else None,
        acc_noise_mps2_rthz=float(np.sqrt(2.0 * acc_variance / rate_hz)) if told else None,
        gravity_mps2=gravity if gravity > 0.0 else STANDARD_GRAVITY_MPS2,
    )


def local_gravity_mps2(launch: Launch) -> float:
    """Return gravity at the launch (Somigliana's formula of WGS 84, free-air for height); the standard if unknown."""
    if launch.latitude is None:
        return STANDARD_GRAVITY_MPS2
    square = np.sin(np.radians(launch.latitude)) ** 2
    at_ellipsoid = 9.7803253359 * (1.0 + 0.00193185265241 * square) / np.sqrt(1.0 - 0.00669437999014 * square)
    return float(at_ellipsoid - 3.086e-6 * (launch.elevation_m or 0.0))


def calibration_findings(
    calibration: Calibration, launch: Launch, settings: OrientationSettings
) -> tuple[Finding, ...]:
    """Return what the operator should know: the rests and the offset, or that there was none; a wrong |a| at rest."""
    x, y, z = (float(v) for v in np.degrees(calibration.bias_radps[0]))
    offset = {"x_dps": x, "y_dps": y, "z_dps": z}
    if calibration.basis != "rest":
        sigma = float(np.degrees(calibration.bias_sigma_radps.max()))
        code = "no_rest_motion_bias" if calibration.basis == "motion" else "no_rest_no_bias"
        return (Finding(code, Severity.WARNING, offset | {"sigma_dps": sigma}),)
    total = sum(r.duration_s for r in calibration.rests)
    found = [Finding("rests_found", Severity.INFO, offset | {"count": len(calibration.rests), "total_s": total})]
    expected = local_gravity_mps2(launch)
    off_percent = 100.0 * (calibration.gravity_mps2 / expected - 1.0)
    if abs(off_percent) > settings.gravity_tolerance_pct:
        params = {"measured_mps2": calibration.gravity_mps2, "expected_mps2": expected, "off_percent": off_percent}
        found.append(Finding("gravity_off", Severity.WARNING, params))
    return tuple(found)
