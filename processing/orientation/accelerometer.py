"""Offset, scale and place of the accelerometer, from the attitudes that a run covers (navigation §6.2).

A rolling ball shows its accelerometer to gravity from all sides of a ring, many times over. In the frame that the gyro
carries along, gravity and the ball's own slow acceleration change slowly; what turns with the ball is the sensor's own:

    a_measured = A (g u + r ω̇ × u) + b + ω̇ × l + ω × (ω × l)

with ``A`` scale and misalignment, ``b`` the offset, ``l`` the place of the sensor from the centre of the ball, ``u``
up in the sensor's frame, and ``r`` the rolling radius, which only takes the ball's own acceleration out of the way.
All are linear. Spells of some seconds are taken; in each, whatever is a parabola of time in the carried frame is
regressed out of measurement and design alike, so that tilt, creep and slow acceleration say nothing. Spells are the
witnesses: each is weighted by its own scatter, and their disagreement gives the sigma, whatever the noise looks like.

Not observable this way, and left to the prior: the common scale (it is the unit of gravity in this run), and on a
straight way the offset along the spin axis, which looks like a tilt. A turn of the accelerometer against the *shell*
does not matter at all: the ball has no front, nobody knows how the board lies in it, and rotation and heading are those
of the whole body whatever axes describe it. Only the turn between accelerometer and gyro means something, and ``A``
holds it.

Devices that are carried are calibrated from rests, if these are in nine or more attitudes: there ``|A⁻¹(a − b)| = g``.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from processing.orientation import kernels, kernels_calibration
from processing.orientation import quaternions as qt
from processing.orientation.calibration import STANDARD_GRAVITY_MPS2, Calibration, slope_of
from processing.orientation.samples import TrustedSamples
from processing.progress import Progress
from processing.survey import BoolArray, Finding, FloatArray, Severity

_SPELL_S = 5.0
_MOST_SPELLS = 300
_LEAST_SPELLS = 10
_LEAST_TURN_RAD = 3.0 * 2.0 * np.pi
_SCALE, _MISALIGNMENT, _OFFSET_MPS2, _ARM_M, _RADIUS_M = 0.005, 0.005, 0.05, 0.005, 0.2  # 1 sigma before the run
_PRIOR = np.array(
    [*np.where(np.eye(3) > 0, _SCALE, _MISALIGNMENT).ravel(), *[_OFFSET_MPS2] * 3, *[_ARM_M] * 3, _RADIUS_M]
)
_UNKNOWNS = 16
_LARGEST_BIAS_MPS2, _LARGEST = 0.3, 0.03  # more is no sensor's error but a hand that swings the device as it turns
_SIGNIFICANT = 3.0
_SEEN = 0.5  # of a direction's prior sigma: what the run tells no better than that is not applied
_ATTITUDES = 9
_APART_COS = np.cos(np.radians(25.0))


@dataclass(frozen=True)
class _Spells:
    """Normal equations of k spells: ``normal`` (k, 16, 16), ``right`` (k, 16), ``square`` and ``rows`` (k,)."""

    normal: FloatArray
    right: FloatArray
    square: FloatArray
    rows: FloatArray

    def error(self, x: FloatArray) -> FloatArray:
        """Return the sum of squared residuals of each spell (k,)."""
        return np.asarray(self.square - 2.0 * self.right @ x + np.einsum("i,kij,j->k", x, self.normal, x))

    def part(self, which: "BoolArray | slice") -> "_Spells":
        """Return some of the spells."""
        return _Spells(self.normal[which], self.right[which], self.square[which], self.rows[which])


def calibrate_rolling(samples: TrustedSamples, progress: Progress) -> Calibration:
    """Return the calibration with the accelerometer's errors, unchanged where they explain nothing that is significant.

    Significant is what half of the spells says if it lessens the residuals of the other half by three standard errors,
    both ways round.
    """
    spells = _gather(samples, progress)
    calibration = samples.calibration
    if len(spells.rows) < _LEAST_SPELLS or not (_helps(spells, 0) and _helps(spells, 1)):
        return calibration
    x, covariance = _fit(spells)
    if np.max(np.abs(x[:9])) > _LARGEST or np.max(np.abs(x[9:12])) > _LARGEST_BIAS_MPS2:
        return calibration
    x, sigma = _seen(x, covariance), np.sqrt(np.diag(covariance))
    return replace(
        calibration,
        acc_matrix=np.eye(3) + x[:9].reshape(3, 3),
        acc_matrix_sigma=sigma[:9].reshape(3, 3),
        acc_bias_mps2=x[9:12],
        acc_bias_sigma_mps2=sigma[9:12],
        lever_arm_m=x[12:15],
        lever_arm_sigma_m=sigma[12:15],
        acc_basis="rolling",
    )


def accelerometer_findings(calibration: Calibration) -> tuple[Finding, ...]:
    """Return what the operator should know of the accelerometer: size of the offset and place of the sensor."""
    if calibration.acc_basis == "none":
        return ()
    params = {
        "offset_mps2": float(np.linalg.norm(calibration.acc_bias_mps2)),
        "scale_pct": float(100.0 * np.max(np.abs(calibration.acc_matrix - np.eye(3)))),
        "arm_mm": float(1e3 * np.linalg.norm(calibration.lever_arm_m)),
    }
    code = "accelerometer_calibrated" if calibration.acc_basis == "rolling" else "accelerometer_calibrated_rests"
    return (Finding(code, Severity.INFO, params),)


def _seen(x: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the part of the unknowns (16,) in those directions that the run has made surer than the prior was."""
    whitened = covariance / np.outer(_PRIOR, _PRIOR)
    variance, directions = np.linalg.eigh(whitened)
    seen = directions[:, variance < _SEEN**2]
    return np.asarray(_PRIOR * (seen @ (seen.T @ (x / _PRIOR))), dtype=np.float64)


def _gather(samples: TrustedSamples, progress: Progress) -> _Spells:
    found = [(_equations(samples, rows, progress)) for rows in _spell_rows(samples)]
    kept = [f for f in found if f is not None]
    if not kept:
        return _Spells(np.zeros((0, 16, 16)), np.zeros((0, 16)), np.zeros(0), np.zeros(0))
    normal, right, square, rows = (np.array(part) for part in zip(*kept, strict=True))
    return _Spells(normal, right, square, rows)


def _spell_rows(samples: TrustedSamples) -> Iterator[tuple[int, int]]:
    """Yield rows (start, stop) of spells, spread evenly over runs that have more than enough."""
    width = max(int(_SPELL_S / samples.period_s), 20)
    spells = [(a, a + width) for start, stop in samples.segments for a in range(start, stop - width + 1, width)]
    picked = np.linspace(0, len(spells) - 1, min(len(spells), _MOST_SPELLS)).astype(int).tolist()
    yield from (spells[k] for k in picked)


def _equations(
    samples: TrustedSamples, rows: tuple[int, int], progress: Progress
) -> tuple[FloatArray, FloatArray, float, float] | None:
    """Return a spell's normal matrix, right side, sum of squares and number of values; None where it does not roll."""
    progress.update(rows[1] / samples.count, "orientation_calibration")
    time, rate = samples.times(*rows), samples.rates(*rows)
    turn = samples.turns(time, rate)
    if np.linalg.norm(turn, axis=1).sum() < _LEAST_TURN_RAD or np.any(np.diff(time) > samples.bridge_s):
        return None
    acc = np.ascontiguousarray(samples.imu.acc_s_mps2[samples.index(*rows)], dtype=np.float64)
    quat = np.empty((len(acc), 4))
    kernels.integrate(turn, np.array(qt.IDENTITY), quat)
    up = qt.rotate(quat, acc).mean(axis=0)
    size = float(np.linalg.norm(up))
    gravity = samples.calibration.gravity_mps2
    if size < 0.5 * gravity:
        return None
    both = np.empty((len(acc), 3, _UNKNOWNS + 1))
    kernels_calibration.accelerometer_design(acc, rate, slope_of(rate, time), quat, up / size, gravity, both)
    # less the parabolas of time
    basis, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, len(time)), 3))
    flat = both.reshape(len(time), -1)
    flat -= basis @ (basis.T @ flat)
    square = both.reshape(-1, _UNKNOWNS + 1).T @ both.reshape(-1, _UNKNOWNS + 1)
    return square[:-1, :-1], square[:-1, -1], float(square[-1, -1]), 3.0 * len(acc)


def _fit(spells: _Spells, unknowns: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Return the unknowns (16,) and their covariance; ``unknowns`` (16,) of 0 are held at nothing."""
    allowed = np.ones(_UNKNOWNS) if unknowns is None else unknowns
    precision = np.diag(1.0 / np.where(allowed > 0.0, _PRIOR, 1e-9) ** 2)
    x = np.zeros(_UNKNOWNS)
    for _ in range(4):
        scatter = spells.error(x) / spells.rows
        weight = 1.0 / np.maximum(scatter, 0.25 * float(np.median(scatter)) + 1e-12)
        inverse = np.linalg.inv(np.einsum("k,kij->ij", weight, spells.normal) + precision)
        x = inverse @ (weight @ spells.right)
    score = weight[:, None] * (spells.right - spells.normal @ x)
    meat = score.T @ score + precision
    return x, np.asarray(inverse @ meat @ inverse, dtype=np.float64)


def _helps(spells: _Spells, parity: int) -> bool:
    """Return whether the calibration from every other spell explains those between better than rolling alone."""
    learnt = np.arange(len(spells.rows)) % 2 == parity
    radius_only = np.zeros(_UNKNOWNS)
    radius_only[15] = 1.0
    with_all, _ = _fit(spells.part(learnt))
    with_radius, _ = _fit(spells.part(learnt), radius_only)
    test = spells.part(~learnt)
    before, after = test.error(with_radius) / test.rows, test.error(with_all) / test.rows
    gain = np.log(np.maximum(before, 1e-12) / np.maximum(after, 1e-12))
    return bool(gain.mean() > _SIGNIFICANT * gain.std() / np.sqrt(len(gain)))


def calibrate_at_rests(calibration: Calibration) -> Calibration:
    """Return the calibration with offset and scales from rests in nine or more attitudes, else unchanged.

    Unchanged, too, where predicting each rest from the others does not come closer to gravity than doing nothing.
    """
    rests = [r for r in calibration.rests if not r.shaken]
    forces = _distinct(np.array([r.acc_mean_mps2 for r in rests]).reshape(-1, 3))
    if len(forces) < _ATTITUDES:
        return calibration
    missed = []
    for k in range(len(forces)):
        x, _ = _fit_norms(np.delete(forces, k, axis=0))
        missed.append(_norm_error(forces[k : k + 1], x)[0])
    plain = np.linalg.norm(forces, axis=1)
    if np.sqrt(np.mean(np.square(missed))) > 0.7 * np.std(plain):
        return calibration
    x, sigma = _fit_norms(forces)
    return replace(
        calibration,
        acc_matrix=np.diag(1.0 + x[3:]),
        acc_matrix_sigma=np.where(np.eye(3) > 0.0, np.diag(sigma[3:]), np.nan),
        acc_bias_mps2=x[:3],
        acc_bias_sigma_mps2=sigma[:3],
        acc_basis="rests",
        gravity_mps2=STANDARD_GRAVITY_MPS2,
    )


def _distinct(forces: FloatArray) -> FloatArray:
    """Return the rests' forces (k, 3) that point 25° or more away from all others kept."""
    kept: list[FloatArray] = []
    for force in forces:
        unit = force / max(float(np.linalg.norm(force)), 1e-9)
        if all(float(unit @ (k / np.linalg.norm(k))) < _APART_COS for k in kept):
            kept.append(force)
    return np.array(kept).reshape(-1, 3)


def _norm_error(forces: FloatArray, x: FloatArray) -> FloatArray:
    size = np.linalg.norm((forces - x[:3]) / (1.0 + x[3:]), axis=1)
    return np.asarray(size - STANDARD_GRAVITY_MPS2, dtype=np.float64)


def _fit_norms(forces: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return offset and scale errors (6,) and their sigma by Gauss–Newton on the norms of forces (k, 3)."""
    # a whole per cent: unlike in rolling, the common scale is one of the unknowns
    precision = np.diag(1.0 / np.array([3.0 * _OFFSET_MPS2] * 3 + [0.02] * 3) ** 2)
    x, noise = np.zeros(6), 0.005
    for _ in range(8):
        true = (forces - x[:3]) / (1.0 + x[3:])
        unit = true / np.linalg.norm(true, axis=1, keepdims=True)
        design = np.hstack([-unit / (1.0 + x[3:]), -unit * true / (1.0 + x[3:])])
        inverse = np.linalg.inv(design.T @ design / noise**2 + precision)
        x = x - inverse @ (design.T @ _norm_error(forces, x) / noise**2 + precision @ x)
    spread = float(np.sqrt(np.sum(_norm_error(forces, x) ** 2) / max(len(forces) - 6, 1)))
    return x, np.asarray(np.sqrt(np.diag(inverse)) * max(spread / noise, 1.0), dtype=np.float64)
