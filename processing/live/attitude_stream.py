"""The attitude of every sample as it comes: LiveAttitude, calibrated by the first rest and again by later ones."""

from dataclasses import dataclass, replace

import numpy as np

from processing.live.live_rest import RestWatch
from processing.orientation import quaternions as qt
from processing.orientation.calibration import Calibration
from processing.orientation.live import LiveAttitude
from processing.settings import OrientationSettings
from processing.survey import FloatArray, ImuSamples

_WAIT_S = 4.0  # for a first rest
_ESTIMATOR = "eskf"


@dataclass(frozen=True)
class OrientedRows:
    """Trusted rows (k,) with their attitude: ``rate_s_radps`` is calibrated, the others are as they came."""

    time_s: FloatArray
    acc_s_mps2: FloatArray
    gyr_s_radps: FloatArray
    rate_s_radps: FloatArray
    quat_ws: FloatArray

    def part(self, rows: slice) -> "OrientedRows":
        """Return some of the rows."""
        return OrientedRows(*(getattr(self, name)[rows] for name in _FIELDS))


_FIELDS = ("time_s", "acc_s_mps2", "gyr_s_radps", "rate_s_radps", "quat_ws")


def joined_rows(parts: list[OrientedRows]) -> OrientedRows:
    """Return rows that follow each other as one."""
    return OrientedRows(*(np.concatenate([getattr(p, name) for p in parts]) for name in _FIELDS))


class AttitudeStream:
    """Rows go in as they come; rows with attitudes come out, later by what the estimator needs to find the tilt."""

    def __init__(self, settings: OrientationSettings, yaw_rad: float = 0.0, known: Calibration | None = None) -> None:
        """Begin; ``yaw_rad`` is the first yaw, which nobody can know, ``known`` what was found out before."""
        self._settings, self._yaw_rad = settings, yaw_rad
        self.rest = RestWatch(settings)
        self._held: list[ImuSamples] = []  # before the attitude begins
        self._waiting: list[
            tuple[FloatArray, FloatArray, FloatArray, FloatArray]
        ] = []  # rows whose attitude is to come
        self._live: LiveAttitude | None = None
        self._found = known  # what the way itself has told, or an earlier one
        self._was_calibrated = known is not None and known.basis == "rest"

    @property
    def is_calibrated(self) -> bool:
        """Whether a rest has told the gyro's offset."""
        return self._was_calibrated or self.rest.rests > 0

    @property
    def is_waiting(self) -> bool:
        """Whether rows wait for their attitude: at the beginning, and after a gap that lost it."""
        return self._live is None or bool(self._waiting)

    def calibration(self) -> Calibration:
        """Return what rests and the way itself have told so far."""
        rested, found = self.rest.calibration(), self._found
        if found is None:
            return rested
        if not self.rest.rests:
            return found
        return replace(
            found,
            bias_time_s=rested.bias_time_s,
            bias_radps=rested.bias_radps,
            bias_sigma_radps=rested.bias_sigma_radps,
        )

    def learn(self, calibration: Calibration, turn_rad: float) -> None:
        """Go on with what a look back over the way has told, and turned about up as it says."""
        self._found = calibration
        if self._live is not None:
            self._live.recalibrate(self.calibration(), turn_rad)

    def add(self, imu: ImuSamples) -> OrientedRows:
        """Take trusted rows (m,), later than all before; return those whose attitude has become known."""
        rows = imu
        if not len(rows.time_s):
            return _NO_ROWS
        better = self.rest.add(rows)
        if self._live is None:
            self._held.append(rows)
            held_s = rows.time_s[-1] - self._held[0].time_s[0]
            if not self.is_calibrated and held_s < _WAIT_S:
                return _NO_ROWS
            rows, self._held = _joined(self._held), []
            self._live = self._begin(rows)
        elif better:
            self._live.recalibrate(self.calibration())
        calibration = self.calibration()
        rate = calibration.corrected(rows.time_s, rows.gyr_s_radps) - self._live.bias_radps
        self._waiting.append((rows.time_s, rows.acc_s_mps2, rows.gyr_s_radps, rate))
        times, quats = self._live.add(rows)
        return self._taken(len(times), quats)

    def _begin(self, rows: ImuSamples) -> LiveAttitude:
        period = float(np.median(np.diff(rows.time_s))) if len(rows.time_s) > 1 else 0.01
        return LiveAttitude(_ESTIMATOR, self.calibration(), self._settings, period, yaw_rad=self._yaw_rad)

    def _taken(self, count: int, quats: FloatArray) -> OrientedRows:
        if count == 0:
            return _NO_ROWS
        time_s, acc, gyr, rate = (np.concatenate(column) for column in zip(*self._waiting, strict=True))
        left = slice(count, None)
        self._waiting = [(time_s[left], acc[left], gyr[left], rate[left])] if count < len(time_s) else []
        return OrientedRows(time_s[:count], acc[:count], gyr[:count], rate[:count], quats)


_NONE = np.zeros((0, 3))
_NO_ROWS = OrientedRows(np.zeros(0), _NONE, _NONE, _NONE, np.tile(qt.IDENTITY, (0, 1)))


def _joined(parts: list[ImuSamples]) -> ImuSamples:
    time_s, acc, gyr, valid = (
        np.concatenate([getattr(p, name) for p in parts]) for name in ("time_s", "acc_s_mps2", "gyr_s_radps", "valid")
    )
    return ImuSamples(time_s, acc, gyr, valid)
