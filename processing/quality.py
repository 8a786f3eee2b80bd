"""What the quality plots show: the course of attitude, offsets, speed, slip and intervals over a run.

Pure functions of the results, at the track's rate; the keys are those of ``[quality]`` in the messages.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.orientation.magnetic_series import magnetic_series
from processing.position.fit_results import FitSeries
from processing.results import Results
from processing.survey import FloatArray

NORMAL_95 = 1.959964
_SPIKE_S = 1e-3


@dataclass(frozen=True)
class QualityCurve:
    """One curve: its key, and values (m,) at times (m,)."""

    key: str
    time_s: FloatArray
    values: FloatArray


@dataclass(frozen=True)
class QualityStrip:
    """One strip of up to three curves; ``least`` is the smallest span worth an axis, which may have to hold zero."""

    key: str
    unit: str
    curves: tuple[QualityCurve, ...]
    least: float
    from_zero: bool = False

    @property
    def interval(self) -> bool:
        """Whether the curves are a value, and the ends of its 95 % interval."""
        return len(self.curves) == 3 and self.curves[1].key == "low95"


def quality_strips(results: Results, group: str) -> tuple[QualityStrip, ...]:
    """Return the strips of one group of :data:`GROUPS`; none where the run has nothing to show for it."""
    return GROUPS[group](results)


def _attitude(results: Results) -> tuple[QualityStrip, ...]:
    track = results.track
    if track is None:
        return ()
    roll, pitch, yaw = (np.degrees(angle) for angle in qt.to_roll_pitch_yaw(track.quat_ws).T)
    heading = np.mod(90.0 - yaw, 360.0)
    return (
        QualityStrip("heading", "°", (QualityCurve("heading", track.time_s, heading),), 10.0),
        QualityStrip("roll", "°", (QualityCurve("roll", track.time_s, roll),), 10.0),
        QualityStrip("pitch", "°", (QualityCurve("pitch", track.time_s, pitch),), 10.0),
    )


def _speed(results: Results) -> tuple[QualityStrip, ...]:
    track, series = results.track, results.series
    if track is None:
        return ()
    strips = [
        QualityStrip("speed", "m/s", (QualityCurve("speed", track.time_s, track.speed_mps),), 0.1, from_zero=True)
    ]
    if series is not None:
        slip = _banded("slip", series.time_s, 100.0 * series.slip_share, 100.0 * series.slip_sigma)
        strips.append(QualityStrip("slip", "%", slip, 1.0))
    return tuple(strips)


def _interval(results: Results) -> tuple[QualityStrip, ...]:
    track = results.track
    if track is None:
        return ()
    parts = (("along", track.sigma_along_m), ("cross", track.sigma_cross_m), ("up", track.sigma_up_m))
    return tuple(
        QualityStrip(key, "m", (QualityCurve(key, track.time_s, NORMAL_95 * sigma),), 0.2, from_zero=True)
        for key, sigma in parts
    )


def _offset(results: Results) -> tuple[QualityStrip, ...]:
    calibration, imu = results.calibration, results.recording.imu
    if calibration is None or imu is None:
        return ()
    ends = np.array([imu.time_s[0], imu.time_s[-1]])
    time_s = np.unique(np.concatenate([np.linspace(ends[0], ends[1], 500), calibration.bias_time_s]))
    bias, sigma = calibration.bias_at(time_s), calibration.sigma_at(time_s)
    return tuple(
        QualityStrip(f"offset_{axis}", "°/s", _banded("offset", time_s, *np.degrees([bias[:, k], sigma[:, k]])), 0.05)
        for k, axis in enumerate("xyz")
    )


def _heading(results: Results) -> tuple[QualityStrip, ...]:
    series = results.series
    if series is None:
        return ()
    turn = _banded(
        "correction", series.time_s, np.degrees(series.heading_correction_rad), np.degrees(series.heading_sigma_rad)
    )
    per_hour = 3600.0 * np.degrees([series.heading_drift_radps, series.heading_drift_sigma_radps])
    drift = _banded("drift", series.time_s, per_hour[0], per_hour[1])
    return QualityStrip("correction", "°", turn, 1.0), QualityStrip("drift", "°/h", drift, 10.0)


def _innovations(results: Results) -> tuple[QualityStrip, ...]:
    series = results.series
    if series is None or not series.innovations:
        return ()
    kinds = sorted({innovation.kind for innovation in series.innovations})
    return tuple(QualityStrip(f"innovation_{kind}", "σ", (_spikes(series, kind),), 6.0) for kind in kinds)


def _field(results: Results) -> tuple[QualityStrip, ...]:
    """Strength and inclination between the limits of what is believed, and how far north was off the attitude's."""
    imu, attitude, calibration = results.recording.imu, results.attitude, results.calibration
    if imu is None or attitude is None or calibration is None:
        return ()
    field = magnetic_series(imu, attitude, calibration, results.survey.pipe.material, results.settings.orientation)
    if field is None:
        return ()
    norm = _limited("norm", field.time_s, field.norm_ut, field.expected_norm_ut, field.norm_tolerance_ut)
    dip = _limited("dip", field.time_s, field.dip_deg, field.expected_dip_deg, field.dip_tolerance_deg)
    north = (QualityCurve("north", field.time_s, field.innovation_deg),)
    return (
        QualityStrip("norm", "µT", norm, 5.0),
        QualityStrip("dip", "°", dip, 5.0),
        QualityStrip("north", "°", north, 5.0),
    )


def _limited(
    key: str, time_s: FloatArray, values: FloatArray, expected: float, tolerance: float
) -> tuple[QualityCurve, ...]:
    """Return a curve with the limits within which it is believed."""
    ends = np.array([time_s[0], time_s[-1]])
    limits = (QualityCurve("limit", ends, np.full(2, expected + sign * tolerance)) for sign in (-1.0, 1.0))
    return (QualityCurve(key, time_s, values), *limits)


def _spikes(series: FitSeries, kind: str) -> QualityCurve:
    """One spike for each innovation: from zero, and back to it."""
    some = sorted((i for i in series.innovations if i.kind == kind), key=lambda i: i.time_s)
    times = np.concatenate([[i.time_s - _SPIKE_S, i.time_s, i.time_s + _SPIKE_S] for i in some])
    values = np.concatenate([[0.0, i.sigmas, 0.0] for i in some])
    ends = [series.time_s[0], series.time_s[-1]]
    order = np.argsort(np.concatenate([times, ends]), kind="stable")
    return QualityCurve(
        f"innovation_{kind}", np.concatenate([times, ends])[order], np.concatenate([values, [0.0, 0.0]])[order]
    )


def _banded(key: str, time_s: FloatArray, values: FloatArray, sigma: FloatArray) -> tuple[QualityCurve, ...]:
    """Return a curve between the ends of its 95 % interval."""
    half = NORMAL_95 * sigma
    return (
        QualityCurve(key, time_s, values),
        QualityCurve("low95", time_s, values - half),
        QualityCurve("high95", time_s, values + half),
    )


GROUPS: dict[str, Callable[[Results], tuple[QualityStrip, ...]]] = {
    "interval": _interval,
    "speed": _speed,
    "attitude": _attitude,
    "offset": _offset,
    "heading": _heading,
    "innovations": _innovations,
    "field": _field,
}
