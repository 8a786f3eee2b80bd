"""The two methods without a filter: each sample's own readings, and the quaternions that the device itself recorded."""

import numpy as np

from processing.errors import ErrorCode, LeaklineError
from processing.orientation import quaternions as qt
from processing.orientation.recursion import Estimate, fill_untrusted
from processing.orientation.samples import TrustedSamples
from processing.progress import Progress
from processing.survey import FloatArray

_NO_BIAS = np.zeros((0, 3))
_DISAGREEMENT_RAD = np.radians(20.0)


def acc_mag(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return each sample's attitude from its specific force, taken for up, and from the field, taken for north.

    Roll and pitch are those of P0 and P3; without a trusted field every yaw is ``yaw_rad``. Right only without motion.
    """
    quat = np.empty((len(samples.imu.time_s), 4))
    for segment in samples.segments:
        for block in samples.blocks(segment):
            up = block.acc_g
            if len(block.mag):
                block_quat = _from_up_and_field(up, block.mag)
            else:
                roll = np.arctan2(up[:, 1], up[:, 2])
                pitch = -np.arctan2(up[:, 0], np.hypot(up[:, 1], up[:, 2]))
                block_quat = qt.from_euler_zyx(roll, pitch, np.full(len(roll), yaw_rad))
            quat[samples.index(block.start, block.stop)] = block_quat
            progress.update(block.stop / samples.count, "orientation_attitude")
    fill_untrusted(samples, quat, _NO_BIAS)
    return Estimate(quat)


def _from_up_and_field(up_s: FloatArray, field_s: FloatArray) -> FloatArray:
    east = np.cross(field_s, up_s)
    north = np.cross(up_s, east)
    rows = np.stack([east, north, up_s], axis=-2)
    size = np.linalg.norm(rows, axis=-1, keepdims=True)
    return qt.from_matrix(rows / np.where(size > 0.0, size, 1.0))


def device(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:  # noqa: ARG001  # one signature
    """Return the device's own quaternions, normalised, interpolated over rows that cannot be trusted.

    Raises:
        LeaklineError: SETTING_INVALID when the recording holds none.
    """
    recorded = samples.imu.quat_ws
    if recorded is None:
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, name="processing.orientation", value="device", allowed="auto, offline_vqf, …"
        )
    progress.update(0.0, "orientation_attitude")
    quat = qt.normalise(np.asarray(recorded, dtype=np.float64))
    if device_turns_the_other_way(samples):
        quat = qt.conjugate(quat)
    if samples.rows is not None:
        untrusted = ~samples.imu.valid
        time_s = np.asarray(samples.imu.time_s)
        quat[untrusted] = qt.slerp_at(time_s[samples.rows], quat[samples.rows], time_s[untrusted])
    progress.update(1.0)
    return Estimate(quat)


def device_turns_the_other_way(samples: TrustedSamples) -> bool:
    """Return whether the recorded quaternions turn world into sensor: only so do they lay the specific force up."""
    as_told, conjugated = device_tilt_errors(samples)
    return bool(conjugated < _DISAGREEMENT_RAD < as_told)


def device_disagrees(samples: TrustedSamples) -> bool:
    """Return whether the recorded quaternions contradict the accelerometer whichever way they are read."""
    return bool(min(device_tilt_errors(samples)) > _DISAGREEMENT_RAD)


def device_tilt_errors(samples: TrustedSamples) -> tuple[float, float]:
    """Return the angles between up and the mean specific force, turned by the quaternions as told, and conjugated."""
    recorded = samples.imu.quat_ws
    assert recorded is not None
    step = max(1, len(recorded) // 100_000)
    valid = samples.imu.valid[::step]
    quat, acc = qt.normalise(recorded[::step][valid]), samples.imu.acc_s_mps2[::step][valid]
    angles = []
    for q in (quat, qt.conjugate(quat)):
        mean = qt.rotate(q, acc).mean(axis=0)
        angles.append(float(np.arctan2(np.hypot(mean[0], mean[1]), mean[2])))
    return angles[0], angles[1]
