"""Made odometry with known errors, drawn step by step: independent of the equations of the fit."""

from dataclasses import dataclass

import numpy as np

from processing.position.odometry import Odometry
from processing.settings import PositionSettings


@dataclass(frozen=True)
class Truth:
    time_s: np.ndarray
    chainage_m: np.ndarray
    position_w_m: np.ndarray


def odometry(time_s, speed_mps, yaw_rad, settings=PositionSettings()):  # noqa: B008  # frozen
    """What a ball would report that rolls with ``speed_mps`` into ``yaw_rad``: the prior sigmas are the defaults."""
    truth = way(time_s, speed_mps, yaw_rad)
    walked = settings.slip_walk**2 * truth.chainage_m
    quat = np.zeros((len(time_s), 4))
    quat[:, 0] = 1.0
    return Odometry(
        time_s=time_s,
        position_w_m=truth.position_w_m,
        chainage_m=truth.chainage_m,
        speed_mps=np.asarray(speed_mps, dtype=float),
        quat_ws=quat,
        along_var_m2=walked,
        cross_var_m2=0.25 * walked,
        up_var_m2=0.01 * truth.chainage_m,
        heading_var_rad2=np.radians(settings.heading_walk) ** 2 * (time_s - time_s[0]),
        scale_sigma=settings.scale_sigma_pct / 100.0,
        slope_sigma=settings.slope_sigma_pct / 100.0,
        method="rolling",
        slip_sigma=settings.slip_sigma_pct / 100.0,
        slip_tau_s=settings.slip_tau_s,
    )


def way(time_s, speed_mps, yaw_rad):
    step = np.diff(time_s) * 0.5 * (speed_mps[1:] + speed_mps[:-1])
    yaw = 0.5 * (yaw_rad[1:] + yaw_rad[:-1])
    zero = np.zeros((1, 3))
    position = np.cumsum(np.column_stack([step * np.cos(yaw), step * np.sin(yaw), 0.0 * step]), axis=0)
    return Truth(time_s, np.concatenate([[0.0], np.cumsum(step)]), np.vstack([zero, position]))


def realistic(
    rng,
    length_m,
    bends=6,
    scale_sigma=0.02,
    loop=False,
    slip_walk=0.042,
    drift_dph=80.0,
    settings=PositionSettings(),  # noqa: B008  # frozen
):
    """A run as in a main, with errors as on the wheels of navigation §4.4: heavy tails between runs, and stops.

    Slip walk 0.042 m/√m in the median, as 1 % of slip that wanders over 15 s makes at 0.6 m/s (the wheels show twice
    that), and twice it at the 90th percentile; yaw drift 80 °/h, as is left on wheels whose own turning calibrated the
    gyro; a launch heading good to 2.5°; a radius good to 2 %, as the settings say of a ball that was never calibrated.
    """
    dt = 0.1
    speed = rng.uniform(0.4, 1.0)
    time_s = np.arange(0.0, length_m / speed + 60.0, dt)
    pace = np.full(len(time_s), speed) * (1.0 + 0.1 * np.sin(time_s / rng.uniform(20, 60)))
    pace[:50] = 0.0
    for start in rng.uniform(0.1, 0.9, 2) * time_s[-1]:
        pace[(time_s > start) & (time_s < start + 12.0)] = 0.0
    pace[time_s > time_s[-1] - 20.0] = 0.0
    yaw = np.zeros(len(time_s))
    angles = np.full(bends, 2 * np.pi / bends) if loop else rng.uniform(-1.5, 1.5, bends)
    for k, angle in enumerate(angles):
        start = time_s[-1] * (k + 1) / (bends + (0 if loop else 1))
        yaw += angle * np.clip((time_s - start) / 4.0, 0.0, 1.0)
    truth = way(time_s, pace, yaw)
    if loop:  # bring the end to the start by a small steady change of each step
        miss = truth.position_w_m[-1] * truth.chainage_m[:, None] / truth.chainage_m[-1]
        position = truth.position_w_m - miss
        step = np.diff(position[:, :2], axis=0)
        yaw = np.concatenate([[0.0], np.unwrap(np.arctan2(step[:, 1], step[:, 0]))])
        pace = np.concatenate([[0.0], np.hypot(*step.T) / dt])
        truth = way(time_s, np.repeat(pace, 1), yaw)
        truth = Truth(time_s, np.concatenate([[0.0], np.cumsum(np.hypot(*step.T))]), position)
    slip = slip_walk * np.exp(0.555 * rng.standard_normal())
    step = np.diff(truth.chainage_m)
    rolled = step * (1.0 + scale_sigma * rng.standard_normal()) + slip * np.sqrt(step) * rng.standard_normal(len(step))
    drift = np.radians(drift_dph) / 3600.0 * rng.standard_normal()
    wander = np.cumsum(np.radians(settings.heading_walk) * np.sqrt(dt) * rng.standard_normal(len(time_s)))
    heading = np.radians(2.5) * rng.standard_normal() + drift * time_s + wander
    made = odometry(time_s, np.concatenate([[0.0], np.maximum(rolled, 0.0) / dt]), yaw, settings)
    level = np.diff(truth.position_w_m[:, :2], axis=0)
    way_yaw = np.arctan2(level[:, 1], level[:, 0]) + 0.5 * (heading[1:] + heading[:-1])
    signed = np.cumsum(rolled)
    chainage = np.maximum.accumulate(np.concatenate([[0.0], np.maximum(signed, 0.0)]))
    position = np.zeros((len(time_s), 3))
    position[1:, 0] = np.cumsum(rolled * np.cos(way_yaw))
    position[1:, 1] = np.cumsum(rolled * np.sin(way_yaw))
    walked = PositionSettings().slip_walk ** 2 * chainage
    return truth, Odometry(
        time_s=time_s,
        position_w_m=position,
        chainage_m=chainage,
        speed_mps=made.speed_mps,
        quat_ws=made.quat_ws,
        along_var_m2=walked,
        cross_var_m2=0.25 * walked,
        up_var_m2=0.01 * chainage,
        heading_var_rad2=made.heading_var_rad2,
        scale_sigma=made.scale_sigma,
        slope_sigma=made.slope_sigma,
        method="rolling",
        slip_sigma=made.slip_sigma,
        slip_tau_s=made.slip_tau_s,
    )
