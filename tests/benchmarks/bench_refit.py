"""The live refit: how long a path needs to follow a dragged tie point, for runs of an hour and of twelve.

    python tests/benchmarks/bench_refit.py [--rounds 5] [--ties 20]

Each run rolls at 0.6 m/s through bends with 20 tie points, and is dragged at the tenth: every refit sees it elsewhere.
Processor time is told beside the clock's, as other work may share the machine. The yardstick is one product of two
600 × 600 matrices by numpy in the same minute. The whole track is fitted at 20 Hz for comparison.
"""

import argparse
import time
from dataclasses import replace
from itertools import pairwise

import numpy as np

from processing.position.evidence import ChainageIncrement, Evidence, HeightSeries
from processing.position.fitting import fit, prepare, refit
from processing.position.odometry import Odometry
from processing.progress import silent
from processing.settings import PositionSettings
from processing.survey import DeviceInfo, Launch, Survey, TiePoint

SPEED_MPS, RATE_HZ = 0.6, 20.0


def rolled(hours):
    """A run through bends: its truth (time, chainage, place) and what a ball of 1 % slip makes of it."""
    rng = np.random.default_rng(0)
    time_s = np.arange(0.0, 3600.0 * hours, 1.0 / RATE_HZ)
    yaw = np.cumsum(rng.standard_normal(len(time_s)) * 0.002) + 0.5 * np.sin(time_s / 200.0)
    step = SPEED_MPS / RATE_HZ
    way = step * np.arange(len(time_s))
    place = np.zeros((len(time_s), 3))
    place[1:, 0], place[1:, 1] = np.cumsum(step * np.cos(yaw[1:])), np.cumsum(step * np.sin(yaw[1:]))
    quat = np.zeros((len(time_s), 4))
    quat[:, 0] = 1.0
    wandered = np.cumsum(0.04 * np.sqrt(step) * rng.standard_normal(len(time_s)))
    chainage = np.maximum.accumulate(np.maximum(1.01 * way + wandered, 0.0))
    settings = PositionSettings()
    odometry = Odometry(
        time_s=time_s,
        position_w_m=1.01 * place,
        chainage_m=chainage,
        speed_mps=np.full(len(time_s), SPEED_MPS),
        quat_ws=quat,
        along_var_m2=settings.slip_walk**2 * chainage,
        cross_var_m2=0.25 * settings.slip_walk**2 * chainage,
        up_var_m2=0.01 * chainage,
        heading_var_rad2=np.radians(settings.heading_walk) ** 2 * time_s,
        scale_sigma=0.02,
        slope_sigma=0.01,
        slip_sigma=settings.slip_sigma_pct / 100.0,
        slip_tau_s=settings.slip_tau_s,
    )
    return (time_s, way, place), odometry


def tied(truth, count, kind):
    """Tie points at even times, by chainage or by coordinates."""
    rng = np.random.default_rng(1)
    time_s, way, place = truth
    out = []
    for k, at in enumerate(np.linspace(0.04, 0.99, count) * time_s[-1]):
        row = int(np.searchsorted(time_s, at))
        told = {"chainage_m": float(way[row] + 0.5 * rng.standard_normal())}
        if kind == "coordinates":
            east, north = place[row, :2] + 0.5 * rng.standard_normal(2)
            told = {"east_m": float(east), "north_m": float(north)}
        out.append(TiePoint(f"tie {k}", float(at), sigma_m=0.5, **told))
    return tuple(out)


def evidence(truth):
    """Three hundred joints and a pressure channel at 1 Hz."""
    time_s, way, _ = truth
    rng = np.random.default_rng(2)
    at = np.interp(np.arange(12.0, min(way[-1], 1812.0), 6.0), way, time_s)
    joints = tuple(
        ChainageIncrement(float(a), float(b), 6.0 + 0.05 * float(rng.standard_normal()), 0.05, "joints", 0.01)
        for a, b in pairwise(at)
    )
    seconds = np.arange(0.0, time_s[-1], 1.0)
    height = HeightSeries(seconds, 0.1 * rng.standard_normal(len(seconds)), 0.1)
    return Evidence(increments=joints, heights=(height,))


def dragged(survey, metres):
    """The survey with its tenth tie point moved."""
    ties = list(survey.tie_points)
    tie = ties[len(ties) // 2]
    moved = replace(tie, time_s=tie.time_s + metres / SPEED_MPS)
    ties[len(ties) // 2] = moved
    return replace(survey, tie_points=tuple(ties))


def yardstick():
    """Processor seconds of one matrix product."""
    a = np.random.default_rng(0).standard_normal((600, 600))
    best = np.inf
    for _ in range(5):
        began = time.process_time()
        a @ a
        best = min(best, time.process_time() - began)
    return best


def main():
    """Time it and print."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--rounds", type=int, default=5)
    words.add_argument("--ties", type=int, default=20)
    told = words.parse_args()
    settings = PositionSettings()
    print(
        "run    ties                           drawn   prepare  refit: own   clock: best, median  yardsticks  whole fit"
    )
    for hours in (1.0, 12.0):
        truth, odometry = rolled(hours)
        for kind, known in (("chainage", Evidence()), ("coordinates", Evidence()), ("chainage", evidence(truth))):
            survey = Survey(
                launch=Launch(heading_deg=90.0),
                device=DeviceInfo(radius_m=0.05),
                tie_points=tied(truth, told.ties, kind),
            )
            began = time.perf_counter()
            problem = prepare(odometry, survey, known, settings)
            prepared = time.perf_counter() - began
            refit(problem, survey, settings)
            clock, own = [], []
            for k in range(told.rounds):
                moved = dragged(survey, 0.1 * k)
                began, busy = time.perf_counter(), time.process_time()
                preview = refit(problem, moved, settings)
                clock.append(time.perf_counter() - began)
                own.append(time.process_time() - busy)
            began = time.process_time()
            fit(problem, survey, settings, silent())
            whole = time.process_time() - began
            name = f"{told.ties} {kind}{' + joints, pressure' if known.increments else ''}"
            print(
                f"{hours:3.0f} h  {name:32s} {len(preview.time_s):5}  {prepared:6.2f} s  "
                f"{1e3 * np.median(own):6.1f} ms   {1e3 * min(clock):6.1f} {1e3 * np.median(clock):6.1f} ms   "
                f"{np.median(own) / yardstick():6.1f}   {whole:6.2f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
