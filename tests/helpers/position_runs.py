"""Runs with a known truth for the tests of position: written from the physics, apart from the code under test.

The ball and the carried device follow a way given by its curvature; the rotations are composed of small exact turns.
"""

from dataclasses import dataclass

import numpy as np

from processing.survey import Attitude, ImuSamples

GRAVITY = 9.80665


@dataclass(frozen=True)
class MadeRun:
    imu: ImuSamples
    attitude: Attitude
    chainage_m: np.ndarray
    position_w_m: np.ndarray


def smooth_speed(time_s, pieces):
    """Speed at ``time_s`` of pieces (start, end, speed) that rise and fall within a second as a squared sine."""
    speed = np.zeros_like(time_s)
    for start, end, top in pieces:
        rise = np.clip(np.minimum(time_s - start, end - time_s), 0.0, 1.0)
        speed += top * np.sin(0.5 * np.pi * rise) ** 2
    return speed


def bend(s, start_m, angle_rad, radius_m):
    """Curvature at ``s`` of a bend: it rises and falls as a squared sine, ``radius_m`` is its mean radius."""
    part = np.clip((s - start_m) / (abs(angle_rad) * radius_m), 0.0, 1.0)
    return np.sign(angle_rad) * 2.0 / radius_m * np.sin(np.pi * part) ** 2


def _quaternions(omega_w, dt):
    """Attitude (n, 4) of world-frame rates (n, 3) held piecewise linear: the fourth-order Magnus step."""
    q = np.empty((len(omega_w), 4))
    q[0] = [0.8, 0.36, -0.48, 0.0]
    turn = 0.5 * dt * (omega_w[1:] + omega_w[:-1]) - dt**2 / 12.0 * np.cross(omega_w[:-1], omega_w[1:])
    angle = np.linalg.norm(turn, axis=1)
    s = 0.5 * np.sinc(0.5 * angle / np.pi)
    steps = np.column_stack([np.cos(0.5 * angle), s[:, None] * turn])
    w, x, y, z = q[0]
    for k, (a, b, c, d) in enumerate(steps, 1):
        w, x, y, z = (
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        )
        q[k] = w, x, y, z
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def _to_sensor(q, v):
    """q* v q by matrices: another formula than the code under test uses."""
    w, x, y, z = q.T
    rows = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.einsum("jki,ij->ik", rows, v)


def rolling_run(
    pieces, duration_s, curvature=lambda s: 0.0 * s, slope=0.0, radius_m=0.05, spin_radps=0.0, rate_hz=200.0, yaw0=0.0
):
    """A ball that rolls without slip along a way of ``curvature(s)`` (1/m) and one slope (m/m), with spin about n."""
    fine = 5  # the truth is integrated more finely than it is sampled
    dt = 1.0 / (rate_hz * fine)
    time_s = np.arange(int(duration_s * rate_hz * fine) + 1) * dt
    v = smooth_speed(time_s, pieces)
    s = np.concatenate([[0.0], np.cumsum(0.5 * dt * (v[1:] + v[:-1]))])
    turn = curvature(s) * v
    yaw = yaw0 + np.concatenate([[0.0], np.cumsum(0.5 * dt * (turn[1:] + turn[:-1]))])
    tilt = np.arctan(slope)
    u = np.column_stack([np.cos(yaw) * np.cos(tilt), np.sin(yaw) * np.cos(tilt), np.full_like(yaw, np.sin(tilt))])
    n = np.column_stack([-np.cos(yaw) * np.sin(tilt), -np.sin(yaw) * np.sin(tilt), np.full_like(yaw, np.cos(tilt))])
    position = np.vstack([[0.0, 0.0, 0.0], np.cumsum(0.5 * dt * (u[1:] * v[1:, None] + u[:-1] * v[:-1, None]), axis=0)])
    omega_w = (v / radius_m)[:, None] * np.cross(n, u) + spin_radps * n
    q = _quaternions(omega_w, dt)
    acc_w = np.gradient(u * v[:, None], dt, axis=0) + np.array([0.0, 0.0, GRAVITY])
    pick = slice(None, None, fine)
    imu = ImuSamples(
        time_s[pick], _to_sensor(q, acc_w)[pick], _to_sensor(q, omega_w)[pick], np.ones(len(time_s[pick]), bool)
    )
    return MadeRun(imu, Attitude(q[pick], np.zeros(3), "truth"), s[pick], position[pick])


def carried_run(pieces, duration_s, curvature=lambda s: 0.0 * s, slope=0.0, rate_hz=100.0, yaw0=0.0, tremor=0.0):
    """A device that is carried along the way, turning with it; ``tremor`` shakes it up and down (m/s² at 7 Hz)."""
    fine = 20
    dt = 1.0 / (rate_hz * fine)
    time_s = np.arange(int(duration_s * rate_hz * fine) + 1) * dt
    v = smooth_speed(time_s, pieces)
    s = np.concatenate([[0.0], np.cumsum(0.5 * dt * (v[1:] + v[:-1]))])
    turn = curvature(s) * v
    yaw = yaw0 + np.concatenate([[0.0], np.cumsum(0.5 * dt * (turn[1:] + turn[:-1]))])
    velocity = v[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw), np.full_like(yaw, slope)])
    position = np.vstack([[0.0, 0.0, 0.0], np.cumsum(0.5 * dt * (velocity[1:] + velocity[:-1]), axis=0)])
    acc_w = np.gradient(velocity, dt, axis=0) + np.array([0.0, 0.0, GRAVITY])
    acc_w[:, 2] += tremor * np.cos(2 * np.pi * 7.0 * time_s) * (v > 0.0)  # begins at its peak: no net speed
    omega_w = np.column_stack([0.0 * turn, 0.0 * turn, turn])
    q = _quaternions(omega_w, dt)
    pick = slice(None, None, fine)
    imu = ImuSamples(
        time_s[pick], _to_sensor(q, acc_w)[pick], _to_sensor(q, omega_w)[pick], np.ones(len(time_s[pick]), bool)
    )
    chainage = s * np.sqrt(1.0 + slope**2)
    return MadeRun(imu, Attitude(q[pick], np.zeros(3), "truth"), chainage[pick], position[pick])
