"""The live path against the offline one on the same data; run by hand, never by the test suite.

    python tests/benchmarks/live_path.py [--seeds 3] [--kinds rolling foot carried gait cost] [--cost-minutes 5]

Each run is fed to ``LivePath`` in blocks of 50 ms as a device sends them; its tie points are told at their moments. At
each tie point's moment and at the end, before that moment's tie is known, and every ten seconds in between, the live
chainage and place are held against the truth. The offline figures are those of the pipeline's own steps on the whole
run, with the same tie points and no known length (live nobody knows that the end is the end).
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from foot import loops

from processing.live.live_path import LivePath
from processing.orientation.registry import estimate_attitude
from processing.position.registry import find_track
from processing.progress import silent
from processing.settings import Settings
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.survey import DeviceInfo, ImuSamples, Motion, Survey

BLOCK_S = 0.05
LOOK_S = 10.0
ROLLING = ("rolling", "p1-01", "p1-04", "p1-06", "p1-09", "p1-11", "p1-14")
CARRIED = ("p0-straight", "p0-closed", "p0-50m")
RANDOM = tuple(f"random-{n}" for n in range(6))
FOOT = ("foot-square", "foot-circle", "walk-0", "walk-1", "walk-2", "walk-3")


@dataclass(frozen=True)
class Looks:
    """What the live path said at moments (k,): chainage, its sigma, place (k, 3)."""

    time_s: np.ndarray
    chainage_m: np.ndarray
    sigma_m: np.ndarray
    place_m: np.ndarray
    cross_m: np.ndarray
    cpu_share: float


def blocks(imu: ImuSamples, block_s: float = BLOCK_S) -> Iterator[ImuSamples]:
    """Cut a run as a link delivers it."""
    edges = np.searchsorted(imu.time_s, np.arange(imu.time_s[0], imu.time_s[-1] + block_s, block_s))
    edges = np.unique(np.append(edges, len(imu.time_s)))
    for a, b in pairwise(edges):
        rows = slice(a, b)
        yield ImuSamples(imu.time_s[rows], imu.acc_s_mps2[rows], imu.gyr_s_radps[rows], imu.valid[rows])


def follow(imu: ImuSamples, survey: Survey, make=LivePath) -> Looks:
    """Feed a run to the live path and look at it; ``make`` stands in for another one."""
    ties = sorted(survey.tie_points, key=lambda t: t.time_s)
    path = make(replace(survey, tie_points=()), Settings())
    found = []
    spent, due = 0.0, float(imu.time_s[0]) + LOOK_S
    for part in blocks(imu):
        began = time.process_time()
        path.add(part)
        spent += time.process_time() - began
        now = float(part.time_s[-1])
        pose = path.pose()
        if pose is not None and (now >= due or (ties and now >= ties[0].time_s)):
            found.append(row_of(pose))
            due = now + LOOK_S
        while ties and now >= ties[0].time_s:
            path.mark(ties.pop(0))
    found.append(row_of(path.pose()))
    table = np.array(found)
    return Looks(*table[:, :3].T, table[:, 3:6], table[:, 6], spent / (imu.time_s[-1] - imu.time_s[0]))


def row_of(pose) -> list[float]:
    return [pose.survey_s, pose.chainage_m, pose.sigma_along_m, *pose.position_w_m, pose.sigma_cross_m]


def offline(imu: ImuSamples, survey: Survey):
    """The pipeline's attitude and path of the whole run."""
    survey = replace(survey, pipe=replace(survey.pipe, length_m=None))
    settings = Settings()
    attitude, _, _ = estimate_attitude(imu, survey, settings.orientation, silent())
    return find_track(imu, attitude, survey, settings.position)


def one(name: str, seed: int, tied: bool) -> dict[str, float] | None:
    """Errors of one run in metres: live at all looks and at the end, offline at the end; None without tie points."""
    made = simulate(load_scenario(name), seed, quick=True)
    if tied and not made.survey.tie_points:
        return None
    survey = made.survey if tied else replace(made.survey, tie_points=())
    survey = replace(survey, route=None)  # with a map, the place is the chainage
    looks = follow(made.imu, survey)
    true = made.motion
    way = np.interp(looks.time_s, true.time_s, true.chainage_m)
    place = np.column_stack(
        [np.interp(looks.time_s, true.time_s, c) for c in (true.position_w_m - true.position_w_m[0]).T]
    )
    track = offline(made.imu, survey)
    off = looks.chainage_m - way
    level = np.hypot(*(looks.place_m - place)[:, :2].T)
    reach = np.hypot(looks.sigma_m, looks.cross_m)
    end_m = float(true.chainage_m[-1])
    at_look = np.interp(looks.time_s, track.time_s, track.chainage_m)
    return {
        "way": end_m,
        "live along": float(off[-1]),
        "offline along": float(track.chainage_m[-1] - end_m),
        "live place": float(level[-1]),
        "offline place": float(np.hypot(*(track.position_w_m[-1] - place[-1])[:2])),
        "live-offline rms": float(np.sqrt(np.mean((looks.chainage_m - at_look) ** 2))),
        "held along": float(np.mean(np.abs(off) < 1.96 * looks.sigma_m + 0.02)),
        "offline held": held(track, true),
        "held place": float(np.mean(level < 2.45 * reach / np.sqrt(2.0) + 0.02)),
        "end held": float(abs(off[-1]) < 1.96 * looks.sigma_m[-1]),
        "cpu %": 100.0 * looks.cpu_share,
    }


def held(track, true) -> float:
    """Share of the offline track whose chainage lies within its interval, for comparison."""
    way = np.interp(track.time_s, true.time_s, true.chainage_m)
    return float(np.mean(np.abs(track.chainage_m - way) < 1.96 * track.sigma_along_m + 0.02))


def gait() -> None:
    """Real walks that end where they began: how far from it live and offline."""
    print("\nreal walks, closed loops (shared/data/gait_tracking)")
    for walk in loops():
        survey = Survey(device=DeviceInfo(motion=Motion.FOOT))
        looks, track = follow(walk.imu, survey), offline(walk.imu, survey)
        live, after = looks.place_m[-1], track.position_w_m[-1] - track.position_w_m[0]
        print(f"{walk.name:12s} way live {looks.chainage_m[-1]:.2f} m offline {track.chainage_m[-1]:.2f} m, "
              f"from the start: live {np.hypot(*live[:2]):.2f} m level {abs(live[2]):.2f} m up, "
              f"offline {np.hypot(*after[:2]):.2f} m level {abs(after[2]):.2f} m up, "
              f"cpu {100 * looks.cpu_share:.1f} %", flush=True)  # fmt: skip


def table(title: str, names: tuple[str, ...], seeds: int, tied: bool) -> None:
    """One row a run, and what they come to."""
    print(f"\n{title}, {'with' if tied else 'without'} tie points")
    rows = []
    for name in names:
        for seed in range(seeds):
            row = one(name, seed, tied)
            if row is None:
                continue
            if not rows:
                print(" " * 16, *(f"{key:>16s}" for key in row))
            rows.append(row)
            print(f"{name:12s} {seed:3d}", *(f"{value:16.3f}" for value in row.values()), flush=True)
    if not rows:
        print("none of these has any")
        return
    print("median |.|      ", *(f"{np.median(np.abs([r[k] for r in rows])):16.3f}" for k in rows[0]))
    print("mean |.|        ", *(f"{np.mean(np.abs([r[k] for r in rows])):16.3f}" for k in rows[0]), flush=True)


def cost(minutes: float) -> None:
    """Processor time per second of data at 1 kHz in blocks of 10 ms."""
    made = simulate(load_scenario("rolling"), 0, quick=True)
    for rate_hz, block_s in ((100.0, 0.05), (400.0, 0.02), (1000.0, 0.01)):
        end = min(float(made.imu.time_s[-1]), 60.0 * minutes)
        at = np.arange(0.0, end, 1.0 / rate_hz)
        acc, gyr = (np.column_stack([np.interp(at, made.imu.time_s, c) for c in v.T])
                    for v in (made.imu.acc_s_mps2, made.imu.gyr_s_radps))  # fmt: skip
        imu = ImuSamples(at, acc, gyr, np.ones(len(at), bool))
        path = LivePath(made.survey, Settings())
        began, slowest = time.process_time(), 0.0
        for part in blocks(imu, block_s):
            before = time.process_time()
            path.add(part)
            path.pose()
            slowest = max(slowest, time.process_time() - before)
        share = (time.process_time() - began) / end
        print(f"{rate_hz:6.0f} Hz in blocks of {1000 * block_s:.0f} ms: {100 * share:.2f} % of a core, slowest block "
              f"{1000 * slowest:.1f} ms", flush=True)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--kinds", nargs="*", default=["rolling", "foot", "carried", "gait", "cost"])
    parser.add_argument("--names", nargs="*", default=None)
    parser.add_argument("--cost-minutes", type=float, default=2.0)
    given = parser.parse_args()
    names = tuple(given.names) if given.names else None
    if "rolling" in given.kinds:
        for tied in (False, True):
            table("rolling", names or ROLLING + RANDOM, given.seeds, tied)
    for kind, usual in (("foot", FOOT), ("carried", CARRIED)):
        if kind in given.kinds:
            for tied in (False, True):
                table(kind, names or usual, given.seeds, tied)
    if "gait" in given.kinds:
        gait()
    if "cost" in given.kinds:
        cost(given.cost_minutes)


if __name__ == "__main__":
    main()
