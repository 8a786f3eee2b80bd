"""Quaternion algebra on arrays: scalar first ``(w, x, y, z)``, Hamilton, ``v_w = q_ws ⊗ v_s ⊗ q_ws*``.

Every function takes arrays whose last axis holds the quaternion (4) or the vector (3) and broadcasts over the others,
so one call serves one sample or a whole run. Angles are radians. Functions that take unit quaternions do not
normalise them: :func:`normalise` does, once, where rounding adds up.
"""

import numpy as np

from processing.survey import FloatArray

IDENTITY: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
_TINY_ANGLE_RAD = 1e-4  # below it sin(x)/x is taken from its series; the next term is under 1e-18


def normalise(q: FloatArray) -> FloatArray:
    """Return ``q`` (..., 4) divided by its norm; a zero quaternion becomes the identity."""
    norm = np.linalg.norm(q, axis=-1, keepdims=True)
    return np.where(norm > 0.0, q / np.where(norm > 0.0, norm, 1.0), np.asarray(IDENTITY))


def conjugate(q: FloatArray) -> FloatArray:
    """Return ``q*`` (..., 4), the inverse of a unit quaternion."""
    return np.asarray(np.asarray(q) * np.array([1.0, -1.0, -1.0, -1.0]), dtype=np.float64)


def multiply(p: FloatArray, q: FloatArray) -> FloatArray:
    """Return the Hamilton product ``p ⊗ q`` (..., 4): first turn by ``q``, then by ``p``."""
    p, q = np.asarray(p, dtype=np.float64), np.asarray(q, dtype=np.float64)
    pw, px, py, pz = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qw, qx, qy, qz = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    out = np.empty((*np.broadcast_shapes(p.shape[:-1], q.shape[:-1]), 4))
    out[..., 0] = pw * qw - px * qx - py * qy - pz * qz
    out[..., 1] = pw * qx + px * qw + py * qz - pz * qy
    out[..., 2] = pw * qy - px * qz + py * qw + pz * qx
    out[..., 3] = pw * qz + px * qy - py * qx + pz * qw
    return out


def rotate(q_ws: FloatArray, v_s: FloatArray) -> FloatArray:
    """Return sensor vectors ``v_s`` (..., 3) in the world: ``q ⊗ v ⊗ q*`` of unit quaternions ``q_ws`` (..., 4)."""
    q, v = np.asarray(q_ws, dtype=np.float64), np.asarray(v_s, dtype=np.float64)
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    # v + w·t + u × t with t = 2 u × v
    tx = 2.0 * (y * vz - z * vy)
    ty = 2.0 * (z * vx - x * vz)
    tz = 2.0 * (x * vy - y * vx)
    out = np.empty((*np.broadcast_shapes(q.shape[:-1], v.shape[:-1]), 3))
    out[..., 0] = vx + w * tx + y * tz - z * ty
    out[..., 1] = vy + w * ty + z * tx - x * tz
    out[..., 2] = vz + w * tz + x * ty - y * tx
    return out


def rotate_inverse(q_ws: FloatArray, v_w: FloatArray) -> FloatArray:
    """Return world vectors ``v_w`` (..., 3) in the sensor frame: ``q* ⊗ v ⊗ q``."""
    return rotate(conjugate(q_ws), v_w)


def exp_map(rotvec_rad: FloatArray) -> FloatArray:
    """Return the unit quaternion (..., 4) of a rotation vector (..., 3), exact for any angle."""
    r = np.asarray(rotvec_rad, dtype=np.float64)
    half = 0.5 * np.linalg.norm(r, axis=-1)
    small = half < _TINY_ANGLE_RAD
    sinc = np.where(small, 1.0 - half * half / 6.0, np.sin(half) / np.where(small, 1.0, half))
    out = np.empty((*r.shape[:-1], 4))
    out[..., 0] = np.cos(half)
    out[..., 1:] = 0.5 * sinc[..., None] * r
    return out


def log_map(q: FloatArray) -> FloatArray:
    """Return the rotation vector (..., 3) of unit quaternions (..., 4), the short way: its norm is at most π."""
    q = np.asarray(q, dtype=np.float64)
    q = np.where(q[..., :1] < 0.0, -q, q)
    size = np.linalg.norm(q[..., 1:], axis=-1)
    small = size < _TINY_ANGLE_RAD
    angle = 2.0 * np.arctan2(size, q[..., 0])
    factor = np.where(small, 2.0 + size * size / 3.0, angle / np.where(small, 1.0, size))
    return np.asarray(factor[..., None] * q[..., 1:], dtype=np.float64)


def angle_between(p: FloatArray, q: FloatArray) -> FloatArray:
    """Return the angle (...,) in 0..π of the rotation that leads from ``p`` to ``q``."""
    return np.asarray(np.linalg.norm(log_map(multiply(conjugate(p), q)), axis=-1), dtype=np.float64)


def to_matrix(q_ws: FloatArray) -> FloatArray:
    """Return the rotation matrices ``R`` (..., 3, 3) with ``v_w = R v_s``."""
    q = np.asarray(q_ws, dtype=np.float64)
    # the columns are the images of the sensor's axes
    columns = [rotate(q, axis) for axis in np.eye(3)]
    return np.stack(columns, axis=-1)


def from_matrix(R_ws: FloatArray) -> FloatArray:
    """Return unit quaternions (..., 4) with ``w ≥ 0`` of rotation matrices (..., 3, 3).

    Each is built from its largest component, so that no angle loses digits (Shepperd 1978).
    """
    R = np.asarray(R_ws, dtype=np.float64)
    xx, yy, zz = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    ww = np.stack([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz], axis=-1)  # 4 q_i²
    wx, wy, wz = R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]
    xy, xz, yz = R[..., 1, 0] + R[..., 0, 1], R[..., 0, 2] + R[..., 2, 0], R[..., 2, 1] + R[..., 1, 2]
    rows = np.stack(
        [
            np.stack([ww[..., 0], wx, wy, wz], axis=-1),
            np.stack([wx, ww[..., 1], xy, xz], axis=-1),
            np.stack([wy, xy, ww[..., 2], yz], axis=-1),
            np.stack([wz, xz, yz, ww[..., 3]], axis=-1),
        ],
        axis=-2,
    )  # 4 q qᵀ
    best = np.argmax(ww, axis=-1)[..., None, None]
    q = normalise(np.take_along_axis(rows, best, axis=-2)[..., 0, :])
    return np.where(q[..., :1] < 0.0, -q, q)


def from_euler_zyx(roll_rad: FloatArray, pitch_rad: FloatArray, yaw_rad: FloatArray) -> FloatArray:
    """Return ``q_ws`` (..., 4) of intrinsic Z-Y-X angles: ``Rz(yaw) Ry(pitch) Rx(roll)``, yaw from east to north."""
    half_roll, half_pitch, half_yaw = (
        0.5 * np.asarray(a, dtype=np.float64) for a in np.broadcast_arrays(roll_rad, pitch_rad, yaw_rad)
    )
    cr, sr = np.cos(half_roll), np.sin(half_roll)
    cp, sp = np.cos(half_pitch), np.sin(half_pitch)
    cy, sy = np.cos(half_yaw), np.sin(half_yaw)
    return np.stack(
        [
            cy * cp * cr + sy * sp * sr,
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
        ],
        axis=-1,
    )


def to_roll_pitch_yaw(q_ws: FloatArray) -> FloatArray:
    """Return roll, pitch, yaw (..., 3) in radians, intrinsic Z-Y-X; pitch in ±π/2, the others in ±π."""
    q = np.asarray(q_ws, dtype=np.float64)
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)


def heading_from_yaw(yaw_rad: FloatArray | float) -> FloatArray:
    """Return the heading (clockwise from north, 0..2π) of a yaw (counter-clockwise from east)."""
    return np.asarray(np.mod(0.5 * np.pi - np.asarray(yaw_rad), 2.0 * np.pi), dtype=np.float64)


def yaw_from_heading(heading_rad: FloatArray | float) -> FloatArray:
    """Return the yaw (counter-clockwise from east, −π..π) of a heading (clockwise from north)."""
    return np.asarray(np.pi - np.mod(0.5 * np.pi + np.asarray(heading_rad), 2.0 * np.pi), dtype=np.float64)


def from_two_vectors(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the shortest rotation (..., 4) that turns the direction of ``a`` into that of ``b`` (both (..., 3)).

    For opposite directions any axis across ``a`` is right, and one is taken.
    """
    a, b = np.broadcast_arrays(np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64))
    a = a / np.linalg.norm(a, axis=-1, keepdims=True)
    b = b / np.linalg.norm(b, axis=-1, keepdims=True)
    middle = a + b
    size = np.linalg.norm(middle, axis=-1, keepdims=True)
    opposite = size < 1e-8
    # half way between a and b: q = (a·m, a × m) turns by twice the angle from a to m
    across = np.cross(a, np.eye(3)[np.argmin(np.abs(a), axis=-1)])
    middle = np.where(opposite, across / np.linalg.norm(across, axis=-1, keepdims=True), middle)
    middle = middle / np.linalg.norm(middle, axis=-1, keepdims=True)
    q = np.empty((*a.shape[:-1], 4))
    q[..., 0] = np.sum(a * middle, axis=-1)
    q[..., 1:] = np.cross(a, middle)
    return normalise(q)


def turn_about_up(yaw_rad: FloatArray | float) -> FloatArray:
    """Return the rotation (..., 4) by ``yaw_rad`` counter-clockwise about world up."""
    half = 0.5 * np.asarray(yaw_rad, dtype=np.float64)
    zero = np.zeros_like(half)
    return np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)


def slerp(p: FloatArray, q: FloatArray, fraction: FloatArray | float) -> FloatArray:
    """Return the rotation (..., 4) at ``fraction`` (...,) of the short way from ``p`` to ``q``."""
    step = log_map(multiply(conjugate(p), q))
    return multiply(p, exp_map(np.asarray(fraction, dtype=np.float64)[..., None] * step))


def slerp_at(time_s: FloatArray, q: FloatArray, at_s: FloatArray) -> FloatArray:
    """Return the rotations (m, 4) at times ``at_s`` (m,) of a series ``q`` (n, 4) at increasing ``time_s`` (n,).

    Outside the series its first or last rotation holds.
    """
    at = np.asarray(at_s, dtype=np.float64)
    if len(time_s) == 1:
        return np.broadcast_to(np.asarray(q[0], dtype=np.float64), (*at.shape, 4)).copy()
    left = np.clip(np.searchsorted(time_s, at, side="right") - 1, 0, len(time_s) - 2)
    fraction = np.clip((at - time_s[left]) / (time_s[left + 1] - time_s[left]), 0.0, 1.0)
    return slerp(q[left], q[left + 1], fraction)
