"""Decides whether the magnetometer may tell the heading of a run: the field must be Earth's, and steady.

In a pipe of iron or steel it may not: there the field is homogeneous along a joint, and wrong (navigation §6.2).
"""

import math
from dataclasses import dataclass

import numpy as np

from processing.orientation.calibration import Calibration
from processing.settings import OrientationSettings
from processing.survey import FloatArray, ImuSamples

_SAMPLE_ROWS = 100_000
_EARTH_UT = (20.0, 70.0)  # the main field at the surface is 22 to 67 µT
_FERROUS = ("iron", "steel", "ferrous", "demir", "çelik", "celik", "font", "döküm", "dokum", "düktil", "duktil", "pik")
_FERROUS_SHORT = frozenset({"di", "ci", "gi", "ms"})  # ductile, cast, galvanised iron, mild steel


@dataclass(frozen=True)
class FieldReference:
    """The undisturbed field of a run: strength and inclination below the horizontal."""

    norm_ut: float
    dip_rad: float


@dataclass(frozen=True)
class MagnetometerVerdict:
    """Whether the magnetometer may tell the heading; ``reason`` is a key of ``[reasons]``."""

    trusted: bool
    reason: str
    field: FieldReference | None = None
    clean_share: float = math.nan


def is_ferrous(material: str) -> bool:
    """Return whether a pipe's material, as the operator names it in English or Turkish, carries magnetism."""
    name = material.replace("İ", "i").lower()
    return any(word in name for word in _FERROUS) or not _FERROUS_SHORT.isdisjoint(name.split())


def judge_magnetometer(
    imu: ImuSamples, calibration: Calibration, material: str, settings: OrientationSettings
) -> MagnetometerVerdict:
    """Return the verdict on the magnetometer, from some 100 000 rows spread over the run.

    Strength and inclination are compared with their medians; the inclination is measured against the specific force
    where that is within 5 % of gravity, so that no attitude is needed. ``settings.magnetometer`` overrules.
    """
    if imu.mag_s_ut is None:
        return MagnetometerVerdict(trusted=False, reason="no_magnetometer")
    if settings.magnetometer == "ignore":
        return MagnetometerVerdict(trusted=False, reason="magnetometer_ignored")
    measured = _measure(imu, calibration, settings)
    if measured is None:
        return MagnetometerVerdict(trusted=False, reason="magnetometer_dead")
    field, share = measured
    if settings.magnetometer == "use":
        return MagnetometerVerdict(trusted=True, reason="magnetometer_forced", field=field, clean_share=share)
    if is_ferrous(material):
        return MagnetometerVerdict(trusted=False, reason="pipe_ferrous", clean_share=share)
    if not _EARTH_UT[0] <= field.norm_ut <= _EARTH_UT[1]:
        return MagnetometerVerdict(trusted=False, reason="field_not_earths", clean_share=share)
    if not share >= settings.mag_clean_share:
        return MagnetometerVerdict(trusted=False, reason="field_unsteady", clean_share=share)
    return MagnetometerVerdict(trusted=True, reason="field_steady", field=field, clean_share=share)


def _measure(
    imu: ImuSamples, calibration: Calibration, settings: OrientationSettings
) -> tuple[FieldReference, float] | None:
    """Return the field's reference and the share of readings that agree with it; None for a dead sensor."""
    assert imu.mag_s_ut is not None
    step = max(1, len(imu.time_s) // _SAMPLE_ROWS)
    valid = imu.valid[::step]
    mag, acc = imu.mag_s_ut[::step][valid], imu.acc_s_mps2[::step][valid]
    norm = np.linalg.norm(mag, axis=1)
    if not len(norm) or np.median(norm) <= 0.0 or not np.any(np.ptp(mag, axis=0) > 0.0):
        return None
    reference = float(np.median(norm))
    norm_ok = np.abs(norm / reference - 1.0) < settings.mag_norm_tolerance_pct / 100.0
    calm, dip = _dips(mag, acc, calibration.gravity_mps2)
    if not len(dip):
        return FieldReference(reference, 0.0), float(np.mean(norm_ok))
    dip_reference = float(np.median(dip))
    dip_ok = np.abs(dip - dip_reference) < np.radians(settings.mag_dip_tolerance_deg)
    return FieldReference(reference, dip_reference), float(min(np.mean(norm_ok), np.mean(dip_ok & norm_ok[calm])))


def _dips(
    mag: FloatArray, acc: FloatArray, gravity_mps2: float
) -> "tuple[np.ndarray[tuple[int], np.dtype[np.intp]], FloatArray]":
    """Return the rows whose specific force is near gravity, and the field's inclination there."""
    size = np.linalg.norm(acc, axis=1)
    norm = np.linalg.norm(mag, axis=1)
    calm = np.flatnonzero((np.abs(size / gravity_mps2 - 1.0) < 0.05) & (norm > 0.0))
    sine = np.sum(mag[calm] * acc[calm], axis=1) / (norm[calm] * size[calm])
    return calm, np.asarray(-np.arcsin(np.clip(sine, -1.0, 1.0)), dtype=np.float64)
