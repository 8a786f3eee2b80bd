"""Decides whether the magnetometer may tell the heading of a run: the field must be Earth's, and steady.

In a pipe of iron or steel it may not: there the field is homogeneous along a joint, and wrong (navigation §6.2).

Three tests, each of a reading against the run's own reference: strength, inclination, and *innovation*, by which the
field, carried along by the gyro over some seconds, must not turn. The iron of the device itself is taken off first,
where the run shows it (:mod:`processing.orientation.field_ellipsoid`); never in a pipe of iron or steel, where the
field differs from joint to joint and no sphere means anything.
"""

import math
from dataclasses import dataclass

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.orientation.calibration import Calibration
from processing.orientation.field_ellipsoid import FieldEllipsoid, fit_ellipsoid
from processing.settings import OrientationSettings
from processing.survey import BoolArray, Finding, FloatArray, ImuSamples, Severity

_SAMPLE_ROWS = 100_000
_SPELL_S = 4.0
_MOST_SPELLS = 300
_LEAST_SPELLS = 5
_LEAST_MOVING = 1.0 / 3.0
_EARTH_UT = (20.0, 70.0)  # the main field at the surface is 22 to 67 µT
_FERROUS = ("iron", "steel", "ferrous", "demir", "çelik", "celik", "font", "döküm", "dokum", "düktil", "duktil", "pik")
_FERROUS_SHORT = frozenset({"di", "ci", "gi", "ms"})  # ductile, cast, galvanised iron, mild steel


@dataclass(frozen=True)
class FieldReference:
    """The undisturbed field of a run: strength and inclination below the horizontal."""

    norm_ut: float
    dip_rad: float
    ellipsoid: FieldEllipsoid | None = None  # the device's own iron, taken off every reading

    def corrected(self, mag_s_ut: FloatArray) -> FloatArray:
        """Return readings (m, 3) without the field of the device itself."""
        return mag_s_ut if self.ellipsoid is None else self.ellipsoid.corrected(mag_s_ut)


@dataclass(frozen=True)
class MagnetometerVerdict:
    """Whether the magnetometer may tell the heading; ``reason`` is a key of ``[reasons]``.

    ``clean_share`` is the share of readings accepted by all tests, NaN where none was made.
    """

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
    ferrous = is_ferrous(material)
    measured = measure_field(imu, calibration, settings, iron_of_its_own=not ferrous)
    if measured is None:
        return MagnetometerVerdict(trusted=False, reason="magnetometer_dead")
    field, share = measured
    if settings.magnetometer == "use":
        return MagnetometerVerdict(trusted=True, reason="magnetometer_forced", field=field, clean_share=share)
    if ferrous:
        return MagnetometerVerdict(trusted=False, reason="pipe_ferrous", clean_share=share)
    if not _EARTH_UT[0] <= field.norm_ut <= _EARTH_UT[1]:
        return MagnetometerVerdict(trusted=False, reason="field_not_earths", clean_share=share)
    if _half_seen(field, settings):
        return MagnetometerVerdict(trusted=False, reason="field_ring", clean_share=share)
    if not share >= settings.mag_clean_share:
        return MagnetometerVerdict(trusted=False, reason="field_unsteady", clean_share=share)
    return MagnetometerVerdict(trusted=True, reason="field_steady", field=field, clean_share=share)


def _half_seen(field: FieldReference, settings: OrientationSettings) -> bool:
    """Return whether much iron was seen across the spin axis: as much may lie along it, where nothing shows it."""
    found = field.ellipsoid
    if found is None or found.extent != "ring":
        return False
    return bool(np.linalg.norm(found.centre_ut) > settings.mag_norm_tolerance_pct / 100.0 * field.norm_ut)


def magnetometer_findings(verdict: MagnetometerVerdict) -> tuple[Finding, ...]:
    """Return what the operator should know: why the heading does not come from the field, or what was taken off it."""
    if verdict.reason in {"field_not_earths", "field_unsteady", "field_ring", "pipe_ferrous", "magnetometer_dead"}:
        known = math.isfinite(verdict.clean_share)
        params = {"accepted_pct": 100.0 * verdict.clean_share} if known else {}
        return (Finding(f"magnetometer_{verdict.reason}", Severity.INFO, params),)
    iron = verdict.field.ellipsoid if verdict.field is not None else None
    if iron is None:
        return ()
    shift = {"shift_ut": float(np.linalg.norm(iron.centre_ut)), "bend_pct": 100.0 * (iron.condition - 1.0)}
    return (Finding(f"magnetometer_iron_{iron.extent}", Severity.INFO, shift),)


def measure_field(
    imu: ImuSamples, calibration: Calibration, settings: OrientationSettings, *, iron_of_its_own: bool
) -> tuple[FieldReference, float] | None:
    """Return the field's reference and the share of readings that agree with it; None for a dead sensor.

    ``iron_of_its_own`` lets the device's own field be looked for and taken off.
    """
    assert imu.mag_s_ut is not None
    step = max(1, len(imu.time_s) // _SAMPLE_ROWS)
    valid = imu.valid[::step]
    time_s, mag, acc = imu.time_s[::step][valid], imu.mag_s_ut[::step][valid], imu.acc_s_mps2[::step][valid]
    norm = np.linalg.norm(mag, axis=1)
    if not len(norm) or np.median(norm) <= 0.0 or not np.any(np.ptp(mag, axis=0) > 0.0):
        return None
    ellipsoid = fit_ellipsoid(mag[_moving(time_s, calibration)]) if iron_of_its_own else None
    if ellipsoid is not None and ellipsoid.extent == "none":
        ellipsoid = None
    if ellipsoid is not None:
        mag = ellipsoid.corrected(mag)
        norm = np.linalg.norm(mag, axis=1)
    spells = _spells(imu, calibration, FieldReference(1.0, 0.0, ellipsoid))
    if len(spells) < _LEAST_SPELLS:
        return _measure_rows(mag, acc, calibration, settings, ellipsoid)
    moving = _moving(spells[:, 0], calibration)
    reference = float(np.median(norm[_moving(time_s, calibration)]))
    dip_reference = float(np.median(spells[moving, 1]))
    norm_ok = np.abs(norm / reference - 1.0) < settings.mag_norm_tolerance_pct / 100.0
    tolerance = np.radians(settings.mag_dip_tolerance_deg)
    steady = (np.abs(spells[:, 1] - dip_reference) < tolerance) & (spells[:, 2] < tolerance)
    return FieldReference(reference, dip_reference, ellipsoid), float(min(np.mean(norm_ok), np.mean(steady)))


def _measure_rows(
    mag: FloatArray,
    acc: FloatArray,
    calibration: Calibration,
    settings: OrientationSettings,
    ellipsoid: FieldEllipsoid | None,
) -> tuple[FieldReference, float]:
    """Return reference and share from single readings (n, 3), for runs too short, or without a gyro, for spells."""
    norm = np.linalg.norm(mag, axis=1)
    reference = float(np.median(norm))
    norm_ok = np.abs(norm / reference - 1.0) < settings.mag_norm_tolerance_pct / 100.0
    calm, dip = _dips(mag, acc, calibration.gravity_mps2)
    if not len(dip):
        return FieldReference(reference, 0.0, ellipsoid), float(np.mean(norm_ok))
    dip_reference = float(np.median(dip))
    dip_ok = np.abs(dip - dip_reference) < np.radians(settings.mag_dip_tolerance_deg)
    share = float(min(np.mean(norm_ok), np.mean(dip_ok & norm_ok[calm])))
    return FieldReference(reference, dip_reference, ellipsoid), share


def _moving(time_s: FloatArray, calibration: Calibration) -> BoolArray:
    """Return which times are outside the rests, if a third is: beside a lid or a car, a long rest is a wrong field."""
    moving = np.ones(len(time_s), dtype=np.bool_)
    for rest in calibration.rests:
        moving[slice(*np.searchsorted(time_s, [rest.start_s, rest.end_s]))] = False
    return moving if np.mean(moving) > _LEAST_MOVING else np.ones(len(time_s), dtype=np.bool_)


def _spells(imu: ImuSamples, calibration: Calibration, field: FieldReference) -> FloatArray:
    """Return middle, inclination and turn of the field (k, 3) of some hundred spells of seconds, spread over the run.

    The gyro carries acceleration and field over the spell, so that motion averages out.
    """
    if not np.any(np.ptp(imu.gyr_s_radps[:: max(1, len(imu.time_s) // 10_000)], axis=0) > 0.0):
        return np.zeros((0, 3))  # a dead gyro carries nothing
    width = max(int(_SPELL_S * imu.sample_rate_hz), 8)
    count = len(imu.time_s) // width
    picked = np.linspace(0, count - 1, min(count, _MOST_SPELLS)).astype(int).tolist()
    found = [_spell(imu, calibration, field, slice(k * width, (k + 1) * width)) for k in picked]
    return np.array([f for f in found if f is not None]).reshape(-1, 3)


def _spell(
    imu: ImuSamples, calibration: Calibration, field: FieldReference, rows: slice
) -> tuple[float, float, float] | None:
    assert imu.mag_s_ut is not None
    time_s = np.asarray(imu.time_s[rows], dtype=np.float64)
    if not np.all(imu.valid[rows]) or time_s[-1] - time_s[0] > 2.0 * _SPELL_S:
        return None
    rate = calibration.corrected(time_s, np.asarray(imu.gyr_s_radps[rows], dtype=np.float64))
    turn = np.zeros_like(rate)
    turn[1:] = rate[1:] * np.diff(time_s)[:, None]
    quat = np.empty((len(turn), 4))
    kernels.integrate(np.ascontiguousarray(turn), np.array(qt.IDENTITY), quat)
    carried = qt.rotate(quat, field.corrected(np.asarray(imu.mag_s_ut[rows], dtype=np.float64)))
    up = qt.rotate(quat, np.asarray(imu.acc_s_mps2[rows], dtype=np.float64)).mean(axis=0)
    middle = carried.mean(axis=0)
    sine = float(-up @ middle) / max(float(np.linalg.norm(up) * np.linalg.norm(middle)), 1e-9)
    first, last = carried[: len(carried) // 4].mean(axis=0), carried[-(len(carried) // 4) :].mean(axis=0)
    turned = float(np.arctan2(np.linalg.norm(np.cross(first, last)), first @ last))
    return float(time_s[len(time_s) // 2]), float(np.arcsin(np.clip(sine, -1.0, 1.0))), turned


def _dips(
    mag: FloatArray, acc: FloatArray, gravity_mps2: float
) -> "tuple[np.ndarray[tuple[int], np.dtype[np.intp]], FloatArray]":
    """Return the rows whose specific force is near gravity, and the field's inclination there."""
    size = np.linalg.norm(acc, axis=1)
    norm = np.linalg.norm(mag, axis=1)
    calm = np.flatnonzero((np.abs(size / gravity_mps2 - 1.0) < 0.05) & (norm > 0.0))
    sine = np.sum(mag[calm] * acc[calm], axis=1) / (norm[calm] * size[calm])
    return calm, np.asarray(-np.arcsin(np.clip(sine, -1.0, 1.0)), dtype=np.float64)
