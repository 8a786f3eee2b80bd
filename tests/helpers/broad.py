"""Reads BROAD's trials and scores attitudes by BROAD's own definition (Laidig, Caruso, Cereatti, Seel 2021)."""

from dataclasses import dataclass

import numpy as np
from scipy.io import loadmat

from processing.orientation import quaternions as qt
from processing.survey import ImuSamples


@dataclass(frozen=True)
class Trial:
    imu: ImuSamples
    truth_ws: np.ndarray
    movement: np.ndarray
    rate_hz: float


def read_trial(folder, number):
    """Return the trial whose file name begins with ``number`` (two digits)."""
    content = loadmat(next(folder.glob(f"{number:02d}_*.mat")))
    rate_hz = float(content["sampling_rate"].squeeze())
    rows = len(content["imu_gyr"])
    imu = ImuSamples(
        time_s=np.arange(rows) / rate_hz,
        acc_s_mps2=np.ascontiguousarray(content["imu_acc"], dtype=np.float64),
        gyr_s_radps=np.ascontiguousarray(content["imu_gyr"], dtype=np.float64),
        valid=np.ones(rows, dtype=bool),
        mag_s_ut=np.ascontiguousarray(content["imu_mag"], dtype=np.float64),
    )
    return Trial(imu, content["opt_quat"], content["movement"].squeeze().astype(bool), rate_hz)


def rmse_deg(quat_ws, truth_ws, rows):
    """Return total, heading and inclination RMSE in degrees of the error ``q ⊗ truth*`` in the earth frame.

    total = 2 acos |w|, heading = 2 atan |z/w|, inclination = 2 acos √(w² + z²); over ``rows``, NaN left out.
    """
    error = qt.multiply(quat_ws[rows], qt.conjugate(truth_ws[rows]))
    w, z = error[:, 0], error[:, 3]
    angles = (
        2.0 * np.arccos(np.clip(np.abs(w), 0.0, 1.0)),
        2.0 * np.arctan(np.abs(z / np.where(w == 0.0, 1e-300, w))),
        2.0 * np.arccos(np.clip(np.hypot(w, z), 0.0, 1.0)),
    )
    return tuple(float(np.degrees(np.sqrt(np.nanmean(a * a)))) for a in angles)
