"""The trusted rows of a run as the estimators want them: turns between samples, weighted readings, block by block.

Rows that are not valid are left out. A rate stands for the mean since the row before (setting ``rate_stands_for``), so
that its product with the time between is the turn; recorders that sample the rate of the moment have it taken as linear
between rows, to second order: ``(ω₀+ω₁)Δt/2 + (ω₀×ω₁)Δt²/12``, coning included. Across a hole longer than ``bridge_s``
nothing is known and the attitude is held. A hole longer than ``restart_s``, or in which the device went on turning by
more than ``restart_deg`` at the rates around it, begins a new *segment*, whose tilt is found anew.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError
from processing.orientation import kernels_samples
from processing.orientation.calibration import Calibration
from processing.orientation.magnetometer import FieldReference
from processing.settings import OrientationSettings
from processing.survey import BoolArray, FloatArray, ImuSamples

BLOCK_ROWS = 1 << 17
IndexArray = npt.NDArray[np.intp]
_LEAST_ROWS = 10
_NO_FIELD = np.zeros((0, 3))


@dataclass(frozen=True)
class Block:
    """Trusted rows ``start``..``stop``: contiguous float64 arrays made for this block alone."""

    start: int
    stop: int
    time_s: FloatArray  # (m,)
    dt_s: FloatArray  # (m,) since the row before, at most bridge_s; 0 at the first row of a segment
    turn: FloatArray  # (m, 3) rotation vector since the row before, calibrated
    acc_g: FloatArray  # (m, 3) specific force in units of the run's own gravity
    acc_weight: FloatArray  # (m,) 0..1, less where |a| is not g
    mag: FloatArray  # (m, 3) in units of the undisturbed field, or (0, 3) without a trusted magnetometer
    mag_weight: FloatArray  # (m,) 0..1, less where the field's strength is not the reference's


@dataclass(frozen=True)
class TrustedSamples:
    """View of the trusted rows; holds no copy of the samples, only row numbers where some had to be left out."""

    imu: ImuSamples
    calibration: Calibration
    settings: OrientationSettings
    field: FieldReference | None
    rows: IndexArray | None  # None: every row is trusted
    segments: tuple[tuple[int, int], ...]  # (start, stop) in trusted rows
    period_s: float
    rolling_radius_m: tuple[float, float] | None = None  # of a ball that rolls, ± 1 sigma
    earth_up_radps: float = 0.0  # Earth's rotation about the vertical, 0 where the latitude is unknown

    @property
    def count(self) -> int:
        """Number of trusted rows."""
        return len(self.imu.time_s) if self.rows is None else len(self.rows)

    def index(self, start: int, stop: int) -> "slice | IndexArray":
        """Return what picks the trusted rows ``start``..``stop`` from the run's arrays."""
        return slice(start, stop) if self.rows is None else self.rows[start:stop]

    def times(self, start: int, stop: int) -> FloatArray:
        """Return the times (m,) of trusted rows."""
        return np.asarray(self.imu.time_s[self.index(start, stop)], dtype=np.float64)

    def block(self, start: int, stop: int, *, first: bool) -> Block:
        """Return rows ``start``..``stop``; ``first`` when row ``start`` begins a segment, so nothing leads up to it."""
        before = start if first else start - 1
        index, inner = self.index(before, stop), slice(0 if first else 1, None)
        time = self.times(before, stop)
        rate = self.rates(before, stop)
        force = self.calibration.force(np.asarray(self.imu.acc_s_mps2[index], dtype=np.float64), rate, time)
        acc = np.ascontiguousarray(force[inner] / self.calibration.gravity_mps2)
        weight = np.empty(len(acc))
        kernels_samples.gravity_weights(acc, self.settings.acc_deviation_g, weight)
        mag, mag_weight = self._field(index, inner)
        return Block(
            start=start,
            stop=stop,
            time_s=time[inner],
            dt_s=np.minimum(np.diff(time, prepend=time[:1] if first else time[:0]), self.bridge_s),
            turn=self.turns(time, rate)[inner],
            acc_g=acc,
            acc_weight=weight,
            mag=mag,
            mag_weight=mag_weight,
        )

    def rates(self, start: int, stop: int) -> FloatArray:
        """Return the calibrated rates (m, 3) of trusted rows."""
        gyr = np.asarray(self.imu.gyr_s_radps[self.index(start, stop)], dtype=np.float64)
        return self.calibration.corrected(self.times(start, stop), gyr)

    def turns(self, time_s: FloatArray, rate_radps: FloatArray) -> FloatArray:
        """Return the turns (m, 3) since the row before, 0 at the first, of calibrated rates (m, 3) at times (m,)."""
        out = np.zeros((len(time_s), 3))
        of_interval = self.settings.rate_stands_for == "interval"
        kernels_samples.turns(rate_radps, np.ascontiguousarray(time_s), of_interval, self.period_s, self.bridge_s, out)
        return out

    def blocks(self, segment: tuple[int, int]) -> Iterator[Block]:
        """Yield a segment's rows in order, block by block."""
        for start in range(segment[0], segment[1], BLOCK_ROWS):
            yield self.block(start, min(start + BLOCK_ROWS, segment[1]), first=start == segment[0])

    @property
    def bridge_s(self) -> float:
        """The longest hole over which the turn is interpolated; a slow logger's plain sample period is none."""
        return max(self.settings.bridge_s, 2.5 * self.period_s)

    def _field(self, index: "slice | IndexArray", inner: slice) -> tuple[FloatArray, FloatArray]:
        if self.field is None or self.imu.mag_s_ut is None:
            return _NO_FIELD, np.zeros(0)
        mag = np.ascontiguousarray(self.field.corrected(self.imu.mag_s_ut[index][inner]) / self.field.norm_ut)
        off = np.abs(np.linalg.norm(mag, axis=1) - 1.0) / (self.settings.mag_norm_tolerance_pct / 100.0)
        return mag, np.where(off < 1.0, 1.0, 0.0)


def trusted_samples(
    imu: ImuSamples, calibration: Calibration, settings: OrientationSettings, field: FieldReference | None
) -> TrustedSamples:
    """Return the view of the trusted rows.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES when fewer than ten rows can be trusted.
    """
    rows = None if bool(np.all(imu.valid)) else np.flatnonzero(imu.valid)
    count = len(imu.time_s) if rows is None else len(rows)
    if count < _LEAST_ROWS:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=count, needed=_LEAST_ROWS)
    steps = np.diff(imu.time_s if rows is None else imu.time_s[rows])
    period = float(np.median(steps, overwrite_input=True))
    return in_segments(TrustedSamples(imu, calibration, settings, field, rows, ((0, count),), period))


def in_segments(whole: TrustedSamples) -> TrustedSamples:
    """Return the same view, cut where a hole loses the attitude."""
    step = np.diff(whole.imu.time_s if whole.rows is None else whole.imu.time_s[whole.rows])
    holes = np.flatnonzero(step > whole.bridge_s)
    cuts = (holes[_loses_track(whole, holes, step[holes])] + 1).tolist()
    return replace(whole, segments=tuple(zip([0, *cuts], [*cuts, whole.count], strict=True)))


def _loses_track(samples: TrustedSamples, before: IndexArray, hole_s: FloatArray) -> BoolArray:
    """Return which holes, after trusted rows ``before``, are too long or too turbulent to hold the attitude across."""
    gyr = samples.imu.gyr_s_radps
    rows = [before + k if samples.rows is None else samples.rows[before + k] for k in (0, 1)]
    rate = np.maximum(*(np.linalg.norm(gyr[r], axis=1) for r in rows))
    long = hole_s > max(samples.settings.restart_s, 2.5 * samples.period_s)
    return np.asarray(long | (rate * hole_s > np.radians(samples.settings.restart_deg)), dtype=np.bool_)
