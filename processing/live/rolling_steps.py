"""A rolling ball's free path as its samples come: :mod:`processing.position.rolling`, without looking ahead.

What that one knows and this one cannot: whether a way back will become longer than ``reverse_max_m`` and is a turn of
the pipe after all. The way back then counts twice, forwards, at the moment at which it is known.
"""

from copy import copy

import numpy as np

from processing.live.attitude_stream import OrientedRows
from processing.live.path_history import WIDTH
from processing.orientation.quaternions import rotate
from processing.position.odometry import GAP_S, Odometry
from processing.position.rolling import UNKNOWN_RADIUS_M, UNKNOWN_RADIUS_SIGMA
from processing.settings import PositionSettings
from processing.survey import DeviceInfo, FloatArray

_STILL_S = 0.5
_REVERSAL_COS = -0.7  # as rolling.travel
_CREEP_MPS = 0.01
_LOST_HEADING_RAD = 0.5
_HEIGHT_WALK = 0.1  # m/√m
_CARRY_ON_S = 60.0  # so long a ball is taken to have rolled on in a gap


class RollingSteps:
    """Rows with attitudes go in, rows of the free path at track rate come out."""

    def __init__(self, device: DeviceInfo, settings: PositionSettings) -> None:
        """Begin at the origin."""
        told = device.radius_m is not None and device.radius_m > 0.0
        self.radius_m = device.radius_m if told and device.radius_m is not None else UNKNOWN_RADIUS_M
        self._settings = settings
        self._still_radps2 = float(np.radians(settings.rolling_still_dps)) ** 2
        self.base = _base(settings, settings.scale_sigma_pct / 100.0 if told else UNKNOWN_RADIUS_SIGMA)
        self._energy = np.zeros((0, 2))  # of the last half second: time, |ω|²
        self._time_s = np.nan  # the last row
        self._rate = np.zeros(3)  # r (ω × up) and its size there
        self._sums = np.zeros(3)  # their integrals there
        self._grid = 0  # track rows so far
        self._start_s = 0.0
        self._row = np.zeros(3)  # the integrals at the last track row
        self._row_s = np.nan
        self._travel = Travel(settings.reverse_max_m)
        self._walks = np.zeros(4)  # along, up, lost way, lost heading
        self._heading_var = 0.0
        self.is_still = True

    def add(self, rows: OrientedRows) -> FloatArray:
        """Take rows (m,); return new rows of the path (k, 16; see ``path_history``)."""
        if not len(rows.time_s):
            return np.zeros((0, WIDTH))
        out: list[FloatArray] = []
        rates = self._rates(rows)
        starts = np.flatnonzero(np.diff(rows.time_s, prepend=self._time_s) > GAP_S)  # nan at first: none
        for part in np.split(np.arange(len(rows.time_s)), starts):
            if not len(part):
                continue
            first = float(rows.time_s[part[0]])
            if np.isnan(self._time_s):
                self._begin(first, rates[part[0]])
                out.append(self._path_row(first, rows.quat_ws[part[0]], np.zeros(3)))
            elif first - self._time_s > GAP_S:
                out.append(self._over_gap(first, rates[part[0]], rows.quat_ws[part[0]]))
            out += self._advance(rows.time_s[part], rates[part], rows.quat_ws[part])
        return np.array(out).reshape(-1, WIDTH)

    def turn(self, angle_rad: float) -> None:
        """Go on with attitudes that are turned about up by so much."""
        c, s = np.cos(angle_rad), np.sin(angle_rad)
        by = np.array([[c, -s], [s, c]])
        self._rate = np.array([*(by @ self._rate[:2]), self._rate[2]])
        self._travel.turn(by)

    def row(self) -> FloatArray:
        """Return the path's row (16,) at the very last sample."""
        walks, var = self._walks.copy(), self._heading_var
        travel, row, row_s = copy(self._travel), self._row, self._row_s
        self._row = self._sums
        out = self._path_row(self._time_s, np.array([1.0, 0.0, 0.0, 0.0]), self._sums - row)
        self._travel, self._row, self._row_s, self._walks, self._heading_var = travel, row, row_s, walks, var
        return out

    def _begin(self, time_s: float, rate: FloatArray) -> None:
        self._time_s = self._row_s = self._start_s = time_s
        self._rate = rate

    def _rates(self, rows: OrientedRows) -> FloatArray:
        """Return ``r (ω_w × up)`` (m, 2) and its size (m, 3 in all), zero where the ball lies still."""
        omega = rotate(rows.quat_ws, rows.rate_s_radps)
        square = np.einsum("ij,ij->i", rows.rate_s_radps, rows.rate_s_radps)
        energy = np.vstack([self._energy, np.column_stack([rows.time_s, square])])
        total = np.concatenate([[0.0], np.cumsum(energy[:, 1])])
        last = np.arange(len(self._energy), len(energy)) + 1
        first = np.searchsorted(energy[:, 0], rows.time_s - _STILL_S)
        still = (total[last] - total[first]) / (last - first) < self._still_radps2
        self._energy = energy[np.searchsorted(energy[:, 0], rows.time_s[-1] - _STILL_S) :]
        self.is_still = bool(still[-1])
        omega[still] = 0.0
        return self.radius_m * np.column_stack([omega[:, 1], -omega[:, 0], np.hypot(omega[:, 0], omega[:, 1])])

    def _advance(self, time_s: FloatArray, rates: FloatArray, quats: FloatArray) -> list[FloatArray]:
        """Integrate on from the last row, and return what falls on the track's grid."""
        times = np.concatenate([[self._time_s], time_s])
        values = np.vstack([self._rate, rates])
        steps = 0.5 * np.diff(times)[:, None] * (values[1:] + values[:-1])
        sums = np.vstack([self._sums, self._sums + np.cumsum(steps, axis=0)])
        period = 1.0 / self._settings.track_rate_hz
        first = max(self._grid, int(np.floor((times[0] - self._start_s) / period)))
        last = int(np.floor((times[-1] - self._start_s) / period))
        at = self._start_s + np.arange(first + 1, last + 1) * period
        at = at[at > self._row_s]
        out = []
        if len(at):
            self._grid = last
            found = np.column_stack([np.interp(at, times, column) for column in sums.T])
            nearest = np.minimum(np.searchsorted(time_s, at), len(time_s) - 1)
            for when, here, row in zip(at.tolist(), found, nearest.tolist(), strict=True):
                step, self._row = here - self._row, here
                out.append(self._path_row(when, quats[row], step))
        self._time_s, self._rate, self._sums = float(times[-1]), values[-1], sums[-1]
        return out

    def _over_gap(self, time_s: float, rate: FloatArray, quat_ws: FloatArray) -> FloatArray:
        """Carry on as before over a gap; all of the way bridged, and soon the heading, are in doubt."""
        duration = time_s - self._time_s
        self._sums = self._sums + 0.5 * min(duration, _CARRY_ON_S) * (self._rate + rate)
        bridged = float(self._sums[2] - self._row[2])
        rolled = float(np.hypot(*(self._sums - self._row)[:2]))
        turn = min(_LOST_HEADING_RAD**2 * duration / GAP_S, np.pi**2 / 3.0) if rolled > 0.0 else 0.0
        self._walks += [0.0, 0.0, bridged**2 + 0.05**2, turn]
        step, self._row = self._sums - self._row, self._sums
        self._time_s, self._rate = time_s, rate
        return self._path_row(time_s, quat_ws, step)

    def _path_row(self, time_s: float, quat_ws: FloatArray, step: FloatArray) -> FloatArray:
        duration = time_s - self._row_s
        before = self._travel.chainage_m
        self._travel.add(step[:2], float(step[2]), duration)
        gone = self._travel.chainage_m - before
        self._walks += [self._settings.slip_walk**2 * gone, _HEIGHT_WALK**2 * gone, 0.0, 0.0]
        self._heading_var += float(np.radians(self._settings.heading_walk)) ** 2 * duration
        self._row_s = time_s
        speed = float(step[2]) / duration if duration > 0.0 else 0.0
        along, up, way, turn = self._walks.tolist()
        place = (float(self._row[0]), float(self._row[1]), 0.0)
        head = [time_s, *place, self._travel.chainage_m, speed, *quat_ws.tolist()]
        return np.array([*head, along, 0.25 * along, up, self._heading_var, way, turn])


class Travel:
    """Distance along the pipe of a ball that may roll back: :func:`processing.position.rolling.travel`, causal."""

    def __init__(self, reverse_max_m: float) -> None:
        self._most_m = reverse_max_m
        self._direction: FloatArray | None = None
        self._forward = True
        self._run_m = 0.0  # of the way back under way
        self._signed_m = 0.0
        self.chainage_m = 0.0  # never decreases

    def turn(self, by: FloatArray) -> None:
        """Turn the direction of travel by a rotation (2, 2)."""
        if self._direction is not None:
            self._direction = by @ self._direction

    def add(self, step_m: FloatArray, length_m: float, duration_s: float) -> None:
        """Take a step (2,) of the free path with its length and duration."""
        size = float(np.hypot(step_m[0], step_m[1]))
        if size > _CREEP_MPS * duration_s and size > 0.0:
            direction = step_m / size
            if self._direction is not None and float(direction @ self._direction) < _REVERSAL_COS:
                self._forward, self._run_m = not self._forward, 0.0
            self._direction = direction
        if self._forward:
            self._signed_m += length_m
        else:
            self._run_m += length_m
            self._signed_m -= length_m
            if self._run_m > self._most_m:  # a turn of the pipe after all
                self._signed_m += 2.0 * self._run_m
                self._forward = True
        self.chainage_m = max(self.chainage_m, self._signed_m)


def _base(settings: PositionSettings, scale_sigma: float) -> Odometry:
    """Return what does not change from row to row, about an empty path."""
    none, plane = np.zeros(0), np.zeros((0, 3))
    return Odometry(
        none, plane, none, none, np.zeros((0, 4)), none, none, none, none,
        scale_sigma=scale_sigma,
        slope_sigma=settings.slope_sigma_pct / 100.0,
        method="rolling",
        slip_sigma=settings.slip_sigma_pct / 100.0,
        slip_tau_s=settings.slip_tau_s,
    )  # fmt: skip
