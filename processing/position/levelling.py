"""The attitude for double integration: the gyro between quiet moments, levelled by gravity at them.

An attitude filter that pulls towards the accelerometer also leans into each push: half a second of 0.6 m/s² is taken
for a tilt, gravity leaks back, and a carried path comes out some 10–50 % short. So over a moving stretch the gyro is
integrated alone, and what the vertical misses at the quiet spans on both sides is spread over the stretch. At constant
speed, too, the specific force is gravity, so a quiet span need not be a standstill. The heading stays the estimator's.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.position.error_model import Rows
from processing.position.odometry import BLOCK_ROWS
from processing.survey import Attitude, FloatArray, ImuSamples

_WINDOW_S = 1.0
_RIM_S = 0.5


@dataclass(frozen=True)
class Levelling:
    """Rotations ``turn_w`` (k, 4) that bring the integrated gyro upright at ``time_s`` (k,); they change slowly."""

    time_s: FloatArray
    turn_w: FloatArray


@dataclass(frozen=True)
class WorldRows:
    """Consecutive usable rows ``start``..``stop`` with their times (k,) and integrated attitude (k, 4)."""

    start: int
    stop: int
    time_s: FloatArray
    quat_ws: FloatArray


def find_levelling(imu: ImuSamples, attitude: Attitude, index: Rows, quiet: Rows) -> Levelling:
    """Return the levelling at quiet spans ``quiet`` (k, 2), first and last of the usable rows ``index`` (n,)."""
    windows = _windows(imu.time_s[index], quiet)
    gravity, middle = np.zeros((len(windows), 3)), np.zeros((len(windows), 4))
    centre = (windows[:, 0] + windows[:, 1]) // 2
    for rows in integrated(imu, attitude, index):
        acc = qt.rotate(rows.quat_ws, imu.acc_s_mps2[index[rows.start : rows.stop]])
        sums = np.vstack([np.zeros(3), np.cumsum(acc, axis=0)])
        # a window may reach over the edge of a block: each block adds its share
        first, last = (np.clip(w - rows.start, 0, rows.stop - rows.start) for w in (windows[:, 0], windows[:, 1] + 1))
        gravity += sums[last] - sums[first]
        here = (centre >= rows.start) & (centre < rows.stop)
        middle[here] = rows.quat_ws[centre[here] - rows.start]
    level = qt.from_two_vectors(gravity, np.array([0.0, 0.0, 1.0])) if len(windows) else np.empty((0, 4))
    left = qt.multiply(attitude.quat_ws[index[centre]], qt.conjugate(qt.multiply(level, middle)))
    turn = qt.multiply(qt.turn_about_up(2.0 * np.arctan2(left[:, 3], left[:, 0])), level)
    return Levelling(imu.time_s[index[centre]], turn)


def upright(levelling: Levelling, rows: WorldRows) -> FloatArray:
    """Return the levelled attitude (k, 4) of integrated rows."""
    return qt.multiply(qt.slerp_at(levelling.time_s, levelling.turn_w, rows.time_s), rows.quat_ws)


def integrated(imu: ImuSamples, attitude: Attitude, index: Rows) -> Iterator[WorldRows]:
    """Yield the gyro's own attitude over the usable rows ``index`` (n,), in blocks that share a row with the next.

    Rates are linear between samples, coning included; the attitude begins as the estimator's.
    """
    state = np.array(attitude.quat_ws[index[0]], dtype=np.float64)
    for start in range(0, len(index) - 1, BLOCK_ROWS):
        rows = index[start : start + BLOCK_ROWS + 1]
        bias = attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[rows]
        gyr = imu.gyr_s_radps[rows] - bias
        step = np.diff(imu.time_s[rows])[:, None]
        turn = 0.5 * step * (gyr[1:] + gyr[:-1]) + np.cross(gyr[:-1], gyr[1:]) * (step**2 / 12.0)
        quat = np.empty((len(rows), 4))
        quat[0] = state
        out = np.empty((len(rows) - 1, 4))
        kernels.integrate(np.ascontiguousarray(turn), state, out)
        quat[1:] = out
        yield WorldRows(start, start + len(rows), imu.time_s[rows], quat)


def _windows(time_s: FloatArray, quiet: Rows) -> Rows:
    """A second near each end of every quiet span, as rows (first, last); one window where it is shorter.

    A little is left out at the ends, where a bend or a start may have begun too gently to be felt.
    """
    out: list[tuple[int, int]] = []
    for first, last in quiet.tolist():
        rim = min(_RIM_S, 0.2 * (time_s[last] - time_s[first]))
        start, end = time_s[first] + rim, time_s[last] - rim
        first, last = (int(r) for r in np.searchsorted(time_s, [start, end]))
        head = int(np.searchsorted(time_s, min(start + _WINDOW_S, end)))
        tail = int(np.searchsorted(time_s, max(end - _WINDOW_S, start)))
        out += [(first, last)] if tail <= head else [(first, head), (tail, last)]
    return np.array(out, dtype=np.intp).reshape(-1, 2)
