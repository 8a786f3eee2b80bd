"""Speed and memory of the position step on an hour of survey (or more), rolling and carried.

python tests/benchmarks/bench_position.py [hours] [rate_hz]
"""

import resource
import sys
import time

import numpy as np

from processing.position.registry import find_track
from processing.settings import PositionSettings
from processing.survey import Attitude, DeviceInfo, ImuSamples, Launch, Motion, PipeInfo, Survey, TiePoint

RADIUS_M, SPEED_MPS = 0.0475, 0.6


def rolling_samples(hours: float, rate_hz: float) -> tuple[ImuSamples, Attitude]:
    """A ball that rolls east at one speed for ever, with noise."""
    n = int(hours * 3600 * rate_hz)
    time_s = np.arange(n) / rate_hz
    rng = np.random.default_rng(0)
    half = 0.5 * SPEED_MPS / RADIUS_M * time_s
    quat = np.zeros((n, 4))
    quat[:, 0], quat[:, 2] = np.cos(half), np.sin(half)
    gyr = 0.003 * rng.standard_normal((n, 3))
    gyr[:, 1] += SPEED_MPS / RADIUS_M
    acc = 9.81 * np.column_stack([-np.sin(2 * half), np.zeros(n), np.cos(2 * half)])
    return ImuSamples(time_s, acc, gyr, np.ones(n, dtype=bool)), Attitude(quat, np.zeros(3), "made")


def carried_samples(hours: float, rate_hz: float) -> tuple[ImuSamples, Attitude]:
    """A device that is carried ten seconds and rests five, for ever."""
    n = int(hours * 3600 * rate_hz)
    time_s = np.arange(n) / rate_hz
    rng = np.random.default_rng(0)
    phase = np.mod(time_s, 15.0)
    moving = phase < 10.0
    acc = 0.02 * rng.standard_normal((n, 3))
    acc[:, 2] += 9.81 + moving * 2.0 * np.cos(2 * np.pi * 2.0 * phase)
    acc[:, 0] += np.where(phase < 1.0, 0.8, np.where((phase > 9.0) & moving, -0.8, 0.0))
    gyr = 0.003 * rng.standard_normal((n, 3))
    quat = np.zeros((n, 4))
    quat[:, 0] = 1.0
    return ImuSamples(time_s, acc, gyr, np.ones(n, dtype=bool)), Attitude(quat, np.zeros(3), "made")


def main(hours: float, rate_hz: float) -> None:
    length = SPEED_MPS * hours * 3600
    ties = tuple(
        TiePoint(f"tie {k}", hours * 3600 * k / 11, east_m=length * k / 11, north_m=0.0, sigma_m=0.5)
        for k in range(1, 11)
    )
    for name, make, motion in (
        ("rolling", rolling_samples, Motion.ROLLING),
        ("carried", carried_samples, Motion.CARRIED),
    ):
        imu, attitude = make(hours, rate_hz)
        device = DeviceInfo(motion, RADIUS_M)
        for known, survey in (
            ("free", Survey(launch=Launch(heading_deg=90.0), device=device)),
            ("length", Survey(launch=Launch(heading_deg=90.0), device=device, pipe=PipeInfo(length_m=length))),
            ("10 places", Survey(launch=Launch(heading_deg=90.0), device=device, tie_points=ties)),
        ):
            if name == "carried" and known != "free":
                continue
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            start = time.perf_counter()
            track = find_track(imu, attitude, survey, PositionSettings())
            seconds = time.perf_counter() - start
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            print(
                f"{name:8s} {known:10s} {hours:g} h at {rate_hz:g} Hz, {len(imu.time_s) / 1e6:.2f} M rows: "
                f"{seconds:.2f} s, {hours * 3600 / seconds:.0f} × real time, "
                f"track {len(track.time_s)} rows, peak {peak / 1024:.0f} MB (before: {before / 1024:.0f} MB)",
                flush=True,
            )


if __name__ == "__main__":
    main(*(float(v) for v in sys.argv[1:3]) if len(sys.argv) > 2 else (1.0, 200.0))
