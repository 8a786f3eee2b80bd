"""Now and then the last minutes of a rolling run are looked at as after the run: calibrated, oriented, reckoned anew.

What the ball's own turning tells of gyro and accelerometer (:mod:`processing.orientation.gyro_scale`) is most of what
the offline path has before a live one: without it the heading drifts by hundreds of degrees an hour.
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.live.path_history import QUAT, laid, row_at, thinned
from processing.orientation.calibration import Calibration
from processing.orientation.registry import estimate_attitude
from processing.position import rolling
from processing.position.odometry import held_back
from processing.progress import silent
from processing.settings import Settings
from processing.survey import FloatArray, ImuSamples, ProcessingChoice, Survey

_RATE_HZ = 120.0  # a quicker device is thinned to at most so much: the ball turns by less than 0.1 rad in between
_FIRST_S = 15.0
_EVERY_S = 60.0
_MOST_S = 360.0  # a look over six minutes holds the others up for a sixth of a second
_KEPT_S = 180.0  # of the window when it has become too long
_REST_S = 5.0  # so much of the last rest stays, for the gyro's offset


@dataclass(frozen=True)
class Seen:
    """What a look has told: rows (k, 16) that are settled by it and (j, 16) that may change, up to ``time_s``.

    ``quat_ws`` (4,) is the attitude at ``time_s``.
    """

    time_s: float
    settled: FloatArray
    tail: FloatArray
    quat_ws: FloatArray
    calibration: Calibration


class LookBack:
    """Keeps the last minutes of samples, thinned, and says when it is time to look."""

    def __init__(self, survey: Survey, settings: Settings) -> None:
        """Begin without samples."""
        # a field in the pipe is judged after the run, by all of it
        self._orientation = replace(settings.orientation, magnetometer="ignore")
        self._survey = replace(survey, processing=ProcessingChoice(orientation="eskf"), tie_points=(), route=None)
        self._settings = settings
        self._parts: list[ImuSamples] = []
        self._rest: ImuSamples | None = None  # of before the window
        self._joint: FloatArray | None = None
        self._moved_s = 0.0  # since the last look
        self._wait_s = _FIRST_S
        self._period_s = np.nan
        self._calibration: Calibration | None = None  # of the last look

    def add(self, imu: ImuSamples, *, is_still: bool) -> None:
        """Take trusted rows (m,)."""
        if not len(imu.time_s):
            return
        if np.isnan(self._period_s) and len(imu.time_s) > 1:
            self._period_s = float(np.median(np.diff(imu.time_s)))
        width = max(1, int(1.0 / (_RATE_HZ * self._period_s))) if self._period_s > 0.0 else 1
        before = self._parts[-1].time_s[-1] if self._parts else imu.time_s[0]
        self._parts.append(_thinned(imu, width))
        if not is_still:
            self._moved_s += float(imu.time_s[-1] - before)

    def begin_anew(self, joint: FloatArray) -> None:
        """Forget the window but its last rest; the path goes on from ``joint`` (16,), at the time of the next row."""
        if self._parts and self._calibration is not None:
            self._keep_rest(_joined(self._parts), self._calibration, float(joint[0]))
        self._parts, self._joint, self._moved_s = [], joint, 0.0

    @property
    def is_due(self) -> bool:
        """Whether enough is new, or the window too long."""
        long = len(self._parts) > 1 and self._parts[-1].time_s[-1] - self._parts[0].time_s[0] > 1.2 * _MOST_S
        return bool(self._moved_s >= self._wait_s or long)

    def look(self) -> Seen:
        """Return the way of the last minutes, up to the last sample taken.

        Raises:
            LeaklineError: TOO_FEW_SAMPLES.
        """
        window = _joined(self._parts)
        self._parts, self._moved_s = [window], 0.0
        self._wait_s = min(2.0 * self._wait_s, _EVERY_S)
        rest = 0 if self._rest is None else len(self._rest.time_s)
        whole = window if self._rest is None else _joined([self._rest, window])
        attitude, calibration, _ = estimate_attitude(whole, self._survey, self._orientation, silent())
        self._calibration = calibration
        bias = attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[rest:]
        attitude = replace(attitude, quat_ws=attitude.quat_ws[rest:], bias_radps=bias)
        odometry = held_back(rolling.reckon(window, attitude, self._survey, self._settings.position, silent()))
        table = laid(odometry, self._joint)
        fresh = table if self._joint is None else table[table[:, 0] > self._joint[0]]
        settled = fresh[:0]
        end_s = float(window.time_s[-1])
        if end_s - window.time_s[0] > _MOST_S:
            cut_s = end_s - _KEPT_S
            settled = np.vstack([fresh[fresh[:, 0] <= cut_s], row_at(table, cut_s)])
            fresh = fresh[fresh[:, 0] > cut_s]
            self._joint = row_at(table, cut_s)
            self._keep_rest(whole, calibration, cut_s)
            self._parts = [_between(window, cut_s, np.inf)]
        return Seen(end_s, settled, thinned(fresh), table[-1, QUAT], calibration)

    def _keep_rest(self, whole: ImuSamples, calibration: Calibration, cut_s: float) -> None:
        before = [r for r in calibration.rests if whole.time_s[0] <= r.start_s and r.end_s <= cut_s]
        if before:
            kept = _between(whole, max(before[-1].start_s, before[-1].end_s - _REST_S), before[-1].end_s)
            self._rest = kept if len(kept.time_s) else self._rest


def _thinned(imu: ImuSamples, width: int) -> ImuSamples:
    """Return means over ``width`` rows; a rate stands for the time since the row before, so the last time counts."""
    if width <= 1:
        return imu
    starts = np.arange(0, len(imu.time_s), width)
    counts = np.diff(np.append(starts, len(imu.time_s)))[:, None]
    acc, gyr = (np.add.reduceat(v, starts, axis=0) / counts for v in (imu.acc_s_mps2, imu.gyr_s_radps))
    time_s = imu.time_s[starts + counts[:, 0] - 1]
    return ImuSamples(time_s, acc, gyr, np.ones(len(time_s), dtype=np.bool_))


def _joined(parts: list[ImuSamples]) -> ImuSamples:
    time_s, acc, gyr, valid = (
        np.concatenate([getattr(p, name) for p in parts]) for name in ("time_s", "acc_s_mps2", "gyr_s_radps", "valid")
    )
    return ImuSamples(time_s, acc, gyr, valid)


def _between(imu: ImuSamples, start_s: float, end_s: float) -> ImuSamples:
    part = slice(*np.searchsorted(imu.time_s, [start_s, end_s]).tolist())
    return ImuSamples(imu.time_s[part], imu.acc_s_mps2[part], imu.gyr_s_radps[part], imu.valid[part])
