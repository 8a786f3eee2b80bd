"""What grows the path's history, by the kind of motion: causal rows with looks back, or windows reckoned anew.

No window reaches over a long gap: what was before it is settled there, and the way goes on from where it may have led.
"""

from typing import Protocol

import numpy as np

from processing.live.attitude_stream import AttitudeStream, OrientedRows
from processing.live.look_back import LookBack
from processing.live.path_history import COLUMNS, QUAT, PathHistory, shifted
from processing.live.rolling_steps import RollingSteps
from processing.live.windowed_steps import WindowedSteps
from processing.orientation.start import yaw_towards
from processing.position.odometry import Odometry
from processing.settings import Settings
from processing.survey import FloatArray, ImuSamples, Motion, Survey

LONG_GAP_S = 10.0
_CARRY_ON_S = 60.0  # so long a device is taken to have gone on in a gap
_PACE_S = 2.5  # two strides
_OPEN_MPS, _OPEN_S = 0.35, 10.0  # travel at constant speed feels like a rest until the device rests
_GAP_MPS = 1.0  # 1 sigma of a person's speed that nobody saw


class Trail(Protocol):
    """Rows with attitudes go in; the history grows, and ``base`` holds the sigmas of its odometry (None at first)."""

    base: Odometry | None
    is_still: bool
    open_sigma_m: float  # 1 sigma of what the way may turn out longer or shorter once the stretch under way has ended
    pace_w_mps: FloatArray  # (3,) the free path's mean velocity of late, for the time that its rows lag behind

    def add(self, rows: OrientedRows, gap_s: float) -> bool:
        """Take rows (m,) after a gap of ``gap_s``; return whether the free path has changed and is to be fitted."""
        ...


def trail_of(survey: Survey, settings: Settings, stream: AttitudeStream, history: PathHistory) -> Trail:
    """Return the trail for the survey's motion, or for the method that it names."""
    if survey.device.motion is Motion.ROLLING and survey.processing.position in ("auto", "rolling"):
        return RollingTrail(survey, settings, stream, history)
    return WindowedTrail(survey, settings, stream, history)


class RollingTrail:
    """A ball: every sample counts at once, and now and then the last minutes are looked at again."""

    def __init__(self, survey: Survey, settings: Settings, stream: AttitudeStream, history: PathHistory) -> None:
        """Begin at the origin."""
        self._stream, self._history = stream, history
        self._steps = RollingSteps(survey.device, settings.position)
        self._back = LookBack(survey, settings)
        self._shift: FloatArray | None = None  # (16,) from the causal rows to those of the last look back
        self.base: Odometry | None = self._steps.base
        self.is_still = True
        self.open_sigma_m = 0.0
        self.pace_w_mps = np.zeros(3)  # the rows do not lag

    def add(self, rows: OrientedRows, gap_s: float) -> bool:
        """Take rows; see :class:`Trail`."""
        found = self._steps.add(rows)
        found = found if self._shift is None else shifted(found, self._shift)
        if gap_s > LONG_GAP_S:
            self._history.settle_tail()
            self._back.begin_anew(found[0])
        self._history.extend_tail(found)
        self.is_still = self._steps.is_still
        raw = ImuSamples(rows.time_s, rows.acc_s_mps2, rows.gyr_s_radps, np.ones(len(rows.time_s), dtype=np.bool_))
        self._back.add(raw, is_still=self.is_still)
        if not self._back.is_due or self._stream.is_waiting:
            return False
        seen = self._back.look()
        self._history.settle(seen.settled)
        self._history.set_tail(seen.tail)
        self._shift = seen.tail[-1] - self._steps.row()
        turn = float(yaw_towards(rows.quat_ws[-1], seen.quat_ws))
        self._stream.learn(seen.calibration, turn)
        self._steps.turn(turn)
        return True


class WindowedTrail:
    """A carried or foot-mounted device."""

    def __init__(self, survey: Survey, settings: Settings, stream: AttitudeStream, history: PathHistory) -> None:
        """Begin at the origin."""
        self._stream, self._history = stream, history
        self._steps = WindowedSteps(survey, settings.position)
        self.base: Odometry | None = None
        self.is_still = True
        self.open_sigma_m = 0.0
        self.pace_w_mps = np.zeros(3)
        self._rested_s = np.nan

    def add(self, rows: OrientedRows, gap_s: float) -> bool:
        """Take rows; see :class:`Trail`."""
        if gap_s > LONG_GAP_S:
            self._history.settle_tail()
            self._steps.begin_anew(self._after_gap(rows, gap_s))
        self.is_still = self._stream.rest.is_resting
        settled = self._steps.add(rows, is_resting=self.is_still)
        now = float(rows.time_s[-1])
        if self.is_still:
            self.pace_w_mps = np.zeros(3)
            if settled is not None:
                self._rested_s = now
        if self._steps.method == "inertial":
            open_s = _OPEN_S if np.isnan(self._rested_s) else min(now - self._rested_s, _OPEN_S)
            self.open_sigma_m = _OPEN_MPS * open_s
        if settled is None:
            return False
        self._history.settle(settled.rows)
        self._history.set_tail(settled.tail)
        self.base = self._steps.base
        if not self.is_still:
            self.pace_w_mps = _pace(settled.tail)
        return False

    def _after_gap(self, rows: OrientedRows, gap_s: float) -> FloatArray | None:
        """Return the row (16,) at which the way goes on: the same place, in doubt by a minute's walk at most."""
        if not len(self._history):
            return None
        row = self._history.last
        row[0] = rows.time_s[0]
        row[COLUMNS["speed_mps"]] = 0.0
        row[COLUMNS["lost_var_m2"]] += (_GAP_MPS * min(gap_s, _CARRY_ON_S)) ** 2
        row[COLUMNS["lost_heading_rad2"]] += np.pi**2 / 3.0 * min(gap_s / _CARRY_ON_S, 1.0)
        row[QUAT] = rows.quat_ws[0]
        return row


def _pace(rows: FloatArray) -> FloatArray:
    """Return the mean velocity (3,) over the last seconds of rows (k, 16)."""
    if len(rows) < 2:
        return np.zeros(3)
    late = rows[np.searchsorted(rows[:, 0], rows[-1, 0] - _PACE_S) :]
    duration = float(late[-1, 0] - late[0, 0])
    return np.asarray((late[-1, 1:4] - late[0, 1:4]) / duration if duration > 0.0 else np.zeros(3))
