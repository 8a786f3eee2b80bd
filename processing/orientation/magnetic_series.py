"""Strength, inclination and direction of the magnetic field along a run, thinned for the quality plots, and judged.

Direction is the *innovation*: by how much the field's heading departs from what the attitude expects. An attitude that
took its heading from the field expects north; any other expects what the field said in the middle of the run, so only
changes count. Means over bins of half a second or more; a bin without trusted rows is NaN.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.orientation.binning import BinSums
from processing.orientation.calibration import Calibration
from processing.orientation.magnetometer import is_ferrous, measure_field
from processing.settings import OrientationSettings
from processing.survey import Attitude, BoolArray, FloatArray, ImuSamples

_BLOCK_ROWS = 1 << 17
_LEAST_BIN_S = 0.5
_MOST_BINS = 4000
_INNOVATION_SIGMAS = 3.0
_HEADING_SIGMA_RAD = np.radians(8.0)  # near pipes (navigation §6.2)
_MOST_EMPTY = 100


@dataclass(frozen=True)
class MagneticSeries:
    """The field at ``time_s`` (m,), the middles of the bins, the device's own iron taken off where it was found.

    ``accepted`` (m,) is False where strength, inclination or innovation fails its test; ``used`` says whether the
    attitude takes its heading from the field at all, ``accepted_share`` how much of the run passes.
    """

    time_s: FloatArray
    norm_ut: FloatArray
    dip_deg: FloatArray
    innovation_deg: FloatArray
    accepted: BoolArray
    expected_norm_ut: float
    expected_dip_deg: float
    norm_tolerance_ut: float
    dip_tolerance_deg: float
    used: bool

    @property
    def accepted_share(self) -> float:
        """The share of bins with readings that are accepted; NaN where there are none."""
        known = np.isfinite(self.norm_ut)
        return float(np.mean(self.accepted[known])) if np.any(known) else float("nan")


def magnetic_series(
    imu: ImuSamples, attitude: Attitude, calibration: Calibration, material: str, settings: OrientationSettings
) -> MagneticSeries | None:
    """Return the series of a run in a pipe of ``material``; None without a magnetometer or with a dead one."""
    if imu.mag_s_ut is None:
        return None
    measured = measure_field(imu, calibration, settings, iron_of_its_own=not is_ferrous(material))
    if measured is None:
        return None
    field, _ = measured
    span = float(imu.time_s[-1] - imu.time_s[0])
    width = max(_LEAST_BIN_S, span / _MOST_BINS)
    sums = BinSums(float(imu.time_s[0]), width, 5, most_empty=_MOST_EMPTY)
    for start in range(0, len(imu.time_s), _BLOCK_ROWS):
        rows = slice(start, start + _BLOCK_ROWS)
        valid = np.asarray(imu.valid[rows])
        mag = field.corrected(np.asarray(imu.mag_s_ut[rows], dtype=np.float64)[valid])
        mag_w = qt.rotate(np.asarray(attitude.quat_ws[rows], dtype=np.float64)[valid], mag)
        terms = np.column_stack([np.ones(len(mag)), np.linalg.norm(mag, axis=1), mag_w])
        sums.add(np.asarray(imu.time_s[rows], dtype=np.float64)[valid], terms)
    bins = sums.result()
    count = np.where(bins.sums[:, 0] > 0.0, bins.sums[:, 0], np.nan)
    norm = bins.sums[:, 1] / count
    east, north, up = (bins.sums[:, 2:] / count[:, None]).T
    dip = np.arctan2(-up, np.hypot(east, north))
    used = attitude.heading_from == "magnetometer"
    innovation = _innovation(east, north, float(np.radians(settings.declination_deg)) if used else None)
    norm_tolerance = settings.mag_norm_tolerance_pct / 100.0 * field.norm_ut
    dip_tolerance = float(np.radians(settings.mag_dip_tolerance_deg))
    with np.errstate(invalid="ignore"):
        accepted = (
            (np.abs(norm - field.norm_ut) < norm_tolerance)
            & (np.abs(dip - field.dip_rad) < dip_tolerance)
            & (np.abs(innovation) < _INNOVATION_SIGMAS * _HEADING_SIGMA_RAD)
        )
    return MagneticSeries(
        time_s=bins.start_of + 0.5 * width,
        norm_ut=norm,
        dip_deg=np.degrees(dip),
        innovation_deg=np.degrees(innovation),
        accepted=accepted,
        expected_norm_ut=field.norm_ut,
        expected_dip_deg=float(np.degrees(field.dip_rad)),
        norm_tolerance_ut=norm_tolerance,
        dip_tolerance_deg=settings.mag_dip_tolerance_deg,
        used=used,
    )


def _innovation(east: FloatArray, north: FloatArray, expected_rad: float | None) -> FloatArray:
    """Return the field's azimuth (m,) less the expected one, or less the middle of all where none is told."""
    azimuth = np.arctan2(east, north)
    if expected_rad is None:
        known = azimuth[np.isfinite(azimuth)]
        if not len(known):
            return azimuth
        # first the mean direction, then the median about it: a few wild readings move neither
        centre = float(np.angle(np.mean(np.exp(1j * known))))
        expected_rad = centre + float(np.median(np.angle(np.exp(1j * (known - centre)))))
    return np.asarray(np.angle(np.exp(1j * (azimuth - expected_rad))), dtype=np.float64)
