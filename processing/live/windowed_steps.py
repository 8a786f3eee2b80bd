"""The free path of a carried or foot-mounted device as its samples come: the offline reckoning over a sliding window.

Every second or two the window, which begins at a standstill, is reckoned as after the run: smoothed, with drift taken
off between standstills. What lies before the last standstill but a few seconds is then settled and the window moves
on; each one is laid onto the one before by place and heading.
"""

from dataclasses import dataclass

import numpy as np

from processing.live.attitude_stream import OrientedRows, joined_rows
from processing.live.path_history import laid, row_at
from processing.position.odometry import Odometry, held_back
from processing.position.registry import METHODS
from processing.progress import silent
from processing.settings import PositionSettings
from processing.survey import Attitude, FloatArray, ImuSamples, Motion, Survey

_EVERY_S = 1.5
_EVERY_SHARE = 0.08  # of the window: a long one is reckoned less often, so the cost does not grow
_FOOT_SPAN_S = 16.0
_CARRIED_SPAN_S = 90.0  # without a rest: then it is cut anyway
_OVERLAP_S = (8.0, 5.0, 3.0)  # the next window begins and the settled path ends so long before now
_REST_S = 1.0
_LOOK_BACK_S = 20.0
_LEAST_S = 1.0
_LEAST_ROWS = 25
_ENERGY_S = 0.15


@dataclass(frozen=True)
class Settled:
    """Rows (k, 16) of the path that will not change, and (j, 16) that may; columns as of ``path_history``."""

    rows: FloatArray
    tail: FloatArray


class WindowedSteps:
    """Rows with attitudes go in; settled and provisional rows of the free path come out every second or two."""

    def __init__(self, survey: Survey, settings: PositionSettings) -> None:
        """Begin at the origin, with the method that the survey's motion asks for."""
        wanted = survey.processing.position
        on_foot = survey.device.motion is Motion.FOOT
        self.method = wanted if wanted in ("zupt", "inertial") else "zupt" if on_foot else "inertial"
        self._span_s = _FOOT_SPAN_S if self.method == "zupt" else _CARRIED_SPAN_S
        self._survey, self._settings = survey, settings
        self._parts: list[OrientedRows] = []
        self._joint: FloatArray | None = None  # (16,) where the settled path ends
        self._due_s = -np.inf
        self._rest_since_s = np.nan
        self._reckoned_s = -np.inf
        self._rests_s: list[float] = []  # moments of rest within the window
        self.base: Odometry | None = None
        self.is_still = True

    def begin_anew(self, joint: FloatArray | None) -> None:
        """Forget the window; the path goes on from ``joint`` (16,), at the time of the next row."""
        self._parts, self._joint = [], joint
        self._due_s, self._rest_since_s, self._rests_s = -np.inf, np.nan, []

    def add(self, rows: OrientedRows, *, is_resting: bool) -> Settled | None:
        """Take rows (m,); return the path where it was reckoned anew, None where not yet."""
        if not len(rows.time_s):
            return None
        self._parts.append(rows)
        now = float(rows.time_s[-1])
        self.is_still = is_resting
        if not is_resting:
            self._rest_since_s = np.nan
        elif np.isnan(self._rest_since_s):
            self._rest_since_s = now
        began = float(self._parts[0].time_s[0])
        if self.method == "inertial" and self._reckoned_s < self._rest_since_s + _REST_S <= now:
            self._due_s = now  # a rest tells what the stretch before it was
        if now < self._due_s or now - began < _LEAST_S or sum(len(p.time_s) for p in self._parts) < _LEAST_ROWS:
            return None
        self._due_s = now + max(_EVERY_S, _EVERY_SHARE * (now - began))
        return self._reckoned(now)

    def _reckoned(self, now: float) -> Settled:
        self._reckoned_s = now
        window = joined_rows(self._parts)
        self._parts = [window]
        reckon = METHODS[self.method].reckon
        imu = ImuSamples(window.time_s, window.acc_s_mps2, window.rate_s_radps, np.ones(len(window.time_s), np.bool_))
        attitude = Attitude(window.quat_ws, np.zeros(3), "live")
        odometry = held_back(reckon(imu, attitude, self._survey, self._settings, silent()))
        self.base = odometry
        table = laid(odometry, self._joint)
        fresh = table if self._joint is None else table[table[:, 0] > self._joint[0]]
        cut = self._cut(window, now)
        if cut is None:
            return Settled(table[:0], fresh)
        anchor_s, cut_s = cut
        done = fresh[fresh[:, 0] <= cut_s]
        self._joint = row_at(table, cut_s)
        self._parts = [window.part(slice(int(np.searchsorted(window.time_s, anchor_s)), None))]
        return Settled(np.vstack([done, self._joint]), fresh[len(done) :])

    def _cut(self, window: OrientedRows, now: float) -> tuple[float, float] | None:
        """Return where the next window begins and where the settled path ends; None while it is too early."""
        began = float(window.time_s[0])
        if self.method == "inertial" and now - self._rest_since_s >= _REST_S and now - began > 2.0 * _REST_S:
            # the stretch before is kept in view: by it the next one's quiet is told from travel at constant speed
            rest_s = now - 0.5 * _REST_S
            anchor_s = max((r for r in self._rests_s if r <= now - _LOOK_BACK_S), default=began)
            self._rests_s = [r for r in self._rests_s if r >= anchor_s] + [rest_s]
            return anchor_s, rest_s
        if now - began < self._span_s:
            return None
        first, middle, last = (now - s for s in _OVERLAP_S)
        return _stillest(window, first, middle), _stillest(window, middle, last)


def _stillest(window: OrientedRows, start_s: float, end_s: float) -> float:
    """Return the moment between two at which the device turned least for a sixth of a second: amid a stance."""
    from scipy.ndimage import uniform_filter1d

    part = slice(*np.searchsorted(window.time_s, [start_s, end_s]).tolist())
    rate = window.rate_s_radps[part]
    if not len(rate):  # a gap
        return start_s
    energy = np.einsum("ij,ij->i", rate, rate)
    period = (window.time_s[-1] - window.time_s[0]) / max(len(window.time_s) - 1, 1)
    width = max(round(_ENERGY_S / period), 1)
    return float(window.time_s[part][int(np.argmin(uniform_filter1d(energy, width, mode="nearest")))])
