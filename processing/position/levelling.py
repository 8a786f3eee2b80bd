"""The attitude for double integration: the gyro between quiet moments, levelled by gravity at them.

An attitude filter that pulls towards the accelerometer also leans into each push: half a second of 0.6 m/s² is taken
for a tilt, gravity leaks back, and a carried path comes out some 10–50 % short. So over a moving stretch the gyro is
integrated alone, less the offset that it shows at the rests around, and what the vertical misses at the quiet spans on
both sides is spread over the stretch. At constant speed, too, the specific force is gravity, so a quiet span need not
be a standstill. The heading is the gyro's own, or the estimator's where that rests on something else.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from processing.orientation import kernels
from processing.orientation import quaternions as qt
from processing.position.odometry import BLOCK_ROWS, Rows
from processing.survey import Attitude, FloatArray, ImuSamples

_WINDOW_S = 1.0
_RIM_S = 0.5
_MOST_OFFSET_RADPS = 0.1
_CONVENTION_ROWS = 20_000


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


@dataclass(frozen=True)
class GyroOffset:
    """Offset ``radps`` (k, 3) at ``time_s`` (k,), linear in between; without any row the estimator's holds."""

    time_s: FloatArray
    radps: FloatArray

    def corrected(self, imu: ImuSamples, attitude: Attitude, rows: Rows) -> FloatArray:
        """Return the rates (k, 3) of ``rows`` less the offset."""
        gyr = imu.gyr_s_radps[rows]
        if len(self.time_s) == 0:
            return np.asarray(
                gyr - (attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[rows])
            )
        at = imu.time_s[rows]
        return np.asarray(gyr - np.column_stack([np.interp(at, self.time_s, axis) for axis in self.radps.T]))


def gyro_offset(imu: ImuSamples, index: Rows, quiet: Rows) -> GyroOffset:
    """Return the mean rate at each quiet span (k, 2) of more than a second, unless it is too large for an offset."""
    time_s, radps = [], []
    for first, last in quiet.tolist():
        first, last = _inner(imu.time_s[index], first, last)
        if imu.time_s[index[last]] - imu.time_s[index[first]] < _WINDOW_S:
            continue
        mean = np.mean(imu.gyr_s_radps[index[first : last + 1]], axis=0)
        if float(np.linalg.norm(mean)) < _MOST_OFFSET_RADPS:
            time_s.append(float(imu.time_s[index[(first + last) // 2]]))
            radps.append(mean)
    return GyroOffset(np.array(time_s), np.array(radps).reshape(-1, 3))


def find_levelling(imu: ImuSamples, attitude: Attitude, index: Rows, quiet: Rows, offset: GyroOffset) -> Levelling:
    """Return the levelling at quiet spans ``quiet`` (k, 2), first and last of the usable rows ``index`` (n,)."""
    windows = _windows(imu.time_s[index], quiet)
    gravity, middle = np.zeros((len(windows), 3)), np.zeros((len(windows), 4))
    centre = (windows[:, 0] + windows[:, 1]) // 2
    for rows in integrated(imu, attitude, index, offset):
        acc = qt.rotate(rows.quat_ws, imu.acc_s_mps2[index[rows.start : rows.stop]])
        sums = np.vstack([np.zeros(3), np.cumsum(acc, axis=0)])
        # a window may reach over the edge of a block: each block adds its share
        first, last = (np.clip(w - rows.start, 0, rows.stop - rows.start) for w in (windows[:, 0], windows[:, 1] + 1))
        gravity += sums[last] - sums[first]
        here = (centre >= rows.start) & (centre < rows.stop)
        middle[here] = rows.quat_ws[centre[here] - rows.start]
    turn = qt.from_two_vectors(gravity, np.array([0.0, 0.0, 1.0]))
    if attitude.heading_from != "launch":
        left = qt.multiply(attitude.quat_ws[index[centre]], qt.conjugate(qt.multiply(turn, middle)))
        turn = qt.multiply(qt.turn_about_up(2.0 * np.arctan2(left[:, 3], left[:, 0])), turn)
    return Levelling(imu.time_s[index[centre]], turn)


def upright(levelling: Levelling, rows: WorldRows) -> FloatArray:
    """Return the levelled attitude (k, 4) of integrated rows."""
    return qt.multiply(qt.slerp_at(levelling.time_s, levelling.turn_w, rows.time_s), rows.quat_ws)


def integrated(imu: ImuSamples, attitude: Attitude, index: Rows, offset: GyroOffset) -> Iterator[WorldRows]:
    """Yield the gyro's own attitude over the usable rows ``index`` (n,), in blocks that share a row with the next.

    The attitude begins as the estimator's and follows its convention: a rate is the mean since the sample before, or
    that of the moment and linear in between, coning included.
    """
    means = rates_are_means(imu, attitude, index, offset)
    state = np.array(attitude.quat_ws[index[0]], dtype=np.float64)
    for start in range(0, len(index) - 1, BLOCK_ROWS):
        rows = index[start : start + BLOCK_ROWS + 1]
        gyr = offset.corrected(imu, attitude, rows)
        step = np.diff(imu.time_s[rows])[:, None]
        turn = step * gyr[1:] if means else _turn_of_moments(gyr, step)
        quat = np.empty((len(rows), 4))
        quat[0] = state
        out = np.empty((len(rows) - 1, 4))
        kernels.integrate(np.ascontiguousarray(turn), state, out)
        quat[1:] = out
        yield WorldRows(start, start + len(rows), imu.time_s[rows], quat)


def rates_are_means(imu: ImuSamples, attitude: Attitude, index: Rows, offset: GyroOffset) -> bool:
    """Return whether the attitude turns by each rate as the mean since the sample before, rather than of the moment."""
    middle = len(index) // 2
    rows = index[max(middle - _CONVENTION_ROWS, 0) : middle + _CONVENTION_ROWS]
    quat, gyr = attitude.quat_ws[rows], offset.corrected(imu, attitude, rows)
    step = np.diff(imu.time_s[rows])[:, None]
    turned = qt.log_map(qt.multiply(qt.conjugate(quat[:-1]), quat[1:]))
    # medians: an estimator's corrections and a gap's jump must not decide
    of_mean, of_moment = (
        np.median(np.abs(turned - t).sum(axis=1)) for t in (step * gyr[1:], _turn_of_moments(gyr, step))
    )
    return bool(of_mean < of_moment)


def _turn_of_moments(gyr_radps: FloatArray, step_s: FloatArray) -> FloatArray:
    """Rotation vectors (k − 1, 3) between moments whose rates (k, 3) are known, to second order."""
    before, after = gyr_radps[:-1], gyr_radps[1:]
    return np.asarray(0.5 * step_s * (after + before) + np.cross(before, after) * (step_s**2 / 12.0))


def _windows(time_s: FloatArray, quiet: Rows) -> Rows:
    """A second near each end of every quiet span, as rows (first, last); one window where it is shorter."""
    out: list[tuple[int, int]] = []
    for first, last in quiet.tolist():
        first, last = _inner(time_s, first, last)
        head = int(np.searchsorted(time_s, min(time_s[first] + _WINDOW_S, time_s[last])))
        tail = int(np.searchsorted(time_s, max(time_s[last] - _WINDOW_S, time_s[first])))
        out += [(first, last)] if tail <= head else [(first, head), (tail, last)]
    return np.array(out, dtype=np.intp).reshape(-1, 2)


def _inner(time_s: FloatArray, first: int, last: int) -> tuple[int, int]:
    """Leave out a little at the ends of a span, where a bend or a start may have begun too gently to be felt."""
    rim = min(_RIM_S, 0.2 * (time_s[last] - time_s[first]))
    inner = np.searchsorted(time_s, [time_s[first] + rim, time_s[last] - rim])
    return int(inner[0]), int(inner[1])
