"""Velocity and position of a whole run by double integration, at the IMU's rate, kept where they are asked for."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from processing.orientation.quaternions import rotate, slerp_at
from processing.position.levelling import WorldRows, find_levelling, gyro_offset, integrated, upright
from processing.position.odometry import BLOCK_ROWS, Rows, cumulated
from processing.progress import Progress
from processing.survey import Attitude, FloatArray, ImuSamples


@dataclass(frozen=True)
class Integrals:
    """Velocity and position (m, 3) from rest, without any correction, and the attitude (m, 4) that they rest on."""

    velocity_w_mps: FloatArray
    position_w_m: FloatArray
    quat_ws: FloatArray


def levelled(
    imu: ImuSamples,
    attitude: Attitude,
    index: Rows,
    rests: Rows,
    gravity_mps2: float,
    at_s: FloatArray,
    progress: Progress,
) -> Integrals:
    """Return the integrals at ``at_s`` (m,) with the attitude levelled at ``rests`` (k, 2), rows of ``index`` (n,).

    Without any rest there is only the estimator's attitude.
    """
    if len(rests) == 0:
        worlds = _as_estimated(imu, attitude, index)
    else:
        offset = gyro_offset(imu, index, rests)
        levelling = find_levelling(imu, attitude, index, rests, offset)
        worlds = (replace(w, quat_ws=upright(levelling, w)) for w in integrated(imu, attitude, index, offset))
    return _twice_integrated(imu, worlds, index, gravity_mps2, at_s, progress)


def _as_estimated(imu: ImuSamples, attitude: Attitude, index: Rows) -> Iterator[WorldRows]:
    for start in range(0, len(index) - 1, BLOCK_ROWS):
        rows = index[start : start + BLOCK_ROWS + 1]
        yield WorldRows(start, start + len(rows), imu.time_s[rows], attitude.quat_ws[rows])


def _twice_integrated(
    imu: ImuSamples, worlds: Iterator[WorldRows], index: Rows, gravity_mps2: float, at_s: FloatArray, progress: Progress
) -> Integrals:
    """Integrate the world acceleration; exact where it is linear between samples."""
    velocity, position, quat = np.zeros((len(at_s), 3)), np.zeros((len(at_s), 3)), np.zeros((len(at_s), 4))
    v0, p0 = np.zeros(3), np.zeros(3)
    for rows in worlds:
        times = rows.time_s
        acc_w = rotate(rows.quat_ws, imu.acc_s_mps2[index[rows.start : rows.stop]])
        acc_w[:, 2] -= gravity_mps2
        step = np.diff(times)[:, None]
        v = v0 + cumulated(0.5 * step * (acc_w[1:] + acc_w[:-1]))
        p = p0 + cumulated(v[:-1] * step + step**2 * (2.0 * acc_w[:-1] + acc_w[1:]) / 6.0)
        stop = len(at_s) if rows.stop == len(index) else int(np.searchsorted(at_s, times[-1]))
        wanted = slice(int(np.searchsorted(at_s, times[0])), stop)
        left = np.clip(np.searchsorted(times, at_s[wanted], side="right") - 1, 0, len(times) - 2)
        part = (at_s[wanted] - times[left])[:, None]
        slope = (acc_w[left + 1] - acc_w[left]) / step[left]
        velocity[wanted] = v[left] + part * acc_w[left] + 0.5 * part**2 * slope
        position[wanted] = p[left] + part * v[left] + part**2 * (3.0 * acc_w[left] + part * slope) / 6.0
        quat[wanted] = slerp_at(times, rows.quat_ws, at_s[wanted])
        v0, p0 = v[-1], p[-1]
        progress.update(0.2 + 0.7 * rows.stop / len(index), "position_reckon")
    return Integrals(velocity, position, quat)
