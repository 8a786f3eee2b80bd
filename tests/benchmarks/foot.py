"""How well a path on foot is found, per standstill detector; run by hand, never by the test suite.

    python tests/benchmarks/foot.py                      real walks of shared/data and simulated ones
    python tests/benchmarks/foot.py --vicon FOLDER       also the VICON trials (*.mat) of the data set that
                                                         packaging/train_zero_velocity.py names
    python tests/benchmarks/foot.py --detectors shoe lstm tcn --runs 6

Loop closure on the two walks of gait_tracking; horizontal error against the cameras on constrained_zupt_fgo and on
gaitmap, on VICON after the alignment of its authors (the first 0.8 m) and after the best rotation and shift; squares,
circles and stairs of the simulator, root mean square as in P4 and height at the furthest point, and walks of mixed
gaits. No network has seen
any of these but the training sessions of VICON, which stand in their own rows. ``inertial`` is P3's method.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from processing.orientation.registry import estimate_attitude
from processing.position.fitting import fit
from processing.position.registry import find_reckoned, problem_of
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.survey import DeviceInfo, ImuSamples, Motion, ProcessingChoice, Survey

GRAVITY = 9.80665
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
UNSEEN = ("2017-12-15", "2018-02-22")  # sessions that no network and no threshold was trained on
NOT_WALKED = "2018-02-09-11-16-53"  # 4 m of way in a minute, labels of standstill for 98 % of it
ALL = ("variance", "magnitude", "rate_energy", "shoe", "butterworth", "lstm", "tcn")


@dataclass(frozen=True)
class Walk:
    """A recording with its truth (n, 3) at ``truth_s``; without truth it ended where it began."""

    name: str
    imu: ImuSamples
    truth_s: np.ndarray | None = None
    truth_m: np.ndarray | None = None


def samples(time_s: np.ndarray, acc: np.ndarray, gyr: np.ndarray) -> ImuSamples:
    arrays = (np.ascontiguousarray(x, dtype=float) for x in (time_s, acc, gyr))
    return ImuSamples(*arrays, np.ones(len(time_s), bool))


def loops() -> Iterator[Walk]:
    for name in ("short_walk", "long_walk"):
        table = np.loadtxt(DATA / "gait_tracking" / f"{name}.csv", delimiter=",", skiprows=1)
        table = table[np.concatenate([[True], np.diff(table[:, 0]) > 0])]  # a repeated row stands for a lost one
        yield Walk(name, samples(table[:, 0], table[:, 4:7] * GRAVITY, np.radians(table[:, 1:4])))


def two_feet() -> Iterator[Walk]:
    folder = DATA / "constrained_zupt_fgo"
    truth = np.loadtxt(folder / "positionGt.csv", delimiter=",", skiprows=1)
    for side, columns in (("Right", slice(4, 7)), ("Left", slice(1, 4))):
        table = np.loadtxt(folder / f"imuMeas{side}.csv", delimiter=",", skiprows=1)
        place = truth[:, columns] * [1.0, -1.0, -1.0]  # north-east-down
        yield Walk(f"fgo {side.lower()}", samples(table[:, 0] / 60.0, table[:, 1:4], table[:, 4:7]),
                   truth[:, 0] / 60.0, place)  # fmt: skip


def gaitmap() -> Iterator[Walk]:
    table = np.genfromtxt(DATA / "gaitmap" / "imu_sample.csv", delimiter=",", skip_header=2)
    marks = np.genfromtxt(DATA / "gaitmap" / "mocap_sample.csv", delimiter=",", skip_header=3)
    for k, side in enumerate(("left", "right")):
        heel = slice(7, 10) if side == "left" else slice(10, 13)
        toe = slice(1, 4) if side == "left" else slice(4, 7)
        place = 0.5 * (marks[:, heel] + marks[:, toe]) / 1000.0
        yield Walk(f"gaitmap {side}", samples(table[:, 0] / 204.8, table[:, [1 + k, 3 + k, 5 + k]],
                   np.radians(table[:, [7 + k, 9 + k, 11 + k]])), marks[:, 0] / 100.0, place)  # fmt: skip


def vicon(folder: Path) -> Iterator[Walk]:
    from scipy.io import loadmat

    for path in sorted(folder.glob("*.mat")):
        if path.stem != NOT_WALKED:
            stored = loadmat(path)
            time_s, imu = np.ravel(stored["ts"]).astype(float), stored["imu"].astype(float)
            place = (stored["gt"] - stored["gt"][0]) * [1.0, -1.0, -1.0]
            yield Walk(path.stem, samples(time_s, imu[:, :3], imu[:, 3:]), time_s, place)


def simulated(runs: int) -> Iterator[Walk]:
    from processing.simulation.run import simulate
    from processing.simulation.walks import foot_circle, foot_square, foot_stairs, random_walk

    for scenario in (foot_square(), foot_circle(), foot_stairs()):
        for seed in range(runs):
            made = simulate(scenario, seed)
            yield Walk(f"{scenario.name} {seed}", made.imu, made.motion.time_s, made.motion.position_w_m)
    for seed in range(4 * runs):
        made = simulate(random_walk(seed), seed)
        yield Walk(f"random {seed}", made.imu, made.motion.time_s, made.motion.position_w_m)


@dataclass(frozen=True)
class Result:
    """Errors (n, 3) at the truth's times, as they are, after the start's alignment and the best; 1-sigma (n, 3)."""

    closure_m: np.ndarray
    length_m: float
    raw: np.ndarray | None = None
    aligned: np.ndarray | None = None
    fitted: np.ndarray | None = None
    sigma_m: np.ndarray | None = None


def turned(path: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([path[:, :2] @ np.array([[c, -s], [s, c]]).T, path[:, 2]])


def solve(walk: Walk, method: str, settings: PositionSettings, attitudes: dict[str, object]) -> Result:
    """Return the errors of one walk; ``attitudes`` keeps what was estimated, and under "orientation" the estimator."""
    survey = Survey(
        device=DeviceInfo(motion=Motion.FOOT),
        processing=ProcessingChoice(str(attitudes.get("orientation", "auto")), method),
    )
    if walk.name not in attitudes:
        attitudes[walk.name] = estimate_attitude(walk.imu, survey, OrientationSettings(), silent())[0]
    reckoned = find_reckoned(walk.imu, attitudes[walk.name], survey, settings, silent())
    odometry = reckoned.odometry
    path, length = odometry.position_w_m, float(odometry.chainage_m[-1])
    if walk.truth_m is None:
        return Result(path[-1] - path[0], length)
    track = fit(problem_of(reckoned, survey, settings), survey, settings, silent()).track
    inside = (walk.truth_s >= odometry.time_s[0]) & (walk.truth_s <= odometry.time_s[-1])
    inside &= np.all(np.isfinite(walk.truth_m), axis=1)
    at, truth = walk.truth_s[inside], walk.truth_m[inside] - walk.truth_m[inside][0]
    found = np.column_stack([np.interp(at, odometry.time_s, c) for c in path.T])
    found -= found[0]
    first = int(np.argmax(np.hypot(*truth[:, :2].T) > 0.8))
    by_start = np.arctan2(*truth[first, 1::-1]) - np.arctan2(*found[first, 1::-1])
    a, b = found - found.mean(axis=0), truth - truth.mean(axis=0)
    best = np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a[:, :2] * b[:, :2]))
    sigma = np.column_stack(
        [np.interp(at, track.time_s, s) for s in (track.sigma_along_m, track.sigma_cross_m, track.sigma_up_m)]
    )
    return Result(
        path[-1] - path[0], length, found - truth, turned(found, by_start) - truth, turned(a, best) - b, sigma
    )


def rms(errors: np.ndarray, columns: slice) -> float:
    return float(np.sqrt(np.mean(np.sum(errors[:, columns] ** 2, axis=1))))


def row(name: str, values: list[float], *, form: str = "{:8.3f}") -> None:
    print(f"{name:34s}", *(form.format(v) for v in values), flush=True)


def closures(method: str, settings: PositionSettings, attitudes: dict[str, object]) -> None:
    for walk in loops():
        r = solve(walk, method, settings, attitudes)
        size, level = float(np.linalg.norm(r.closure_m)), float(np.hypot(*r.closure_m[:2]))
        row(f"  {walk.name}: 3-D m, %, level m, %, up m",
            [size, 100 * size / r.length_m, level, 100 * level / r.length_m, r.closure_m[2]])  # fmt: skip


def against_cameras(walks: list[Walk], method: str, settings: PositionSettings, attitudes: dict[str, object]) -> None:
    for walk in walks:
        r = solve(walk, method, settings, attitudes)
        level = [float(np.mean(np.hypot(*e[:, :2].T))) for e in (r.aligned, r.fitted)]
        row(f"  {walk.name}: start-aligned, fitted, up", [*level, rms(r.fitted, slice(2, 3))])


def spread(
    title: str, walks: list[Walk], method: str, settings: PositionSettings, attitudes: dict[str, object]
) -> None:
    """2-D and 3-D root mean square after the start's alignment: mean, median, 95th percentile; fitted; coverage."""
    results = [solve(w, method, settings, attitudes) for w in walks]
    table = np.array([(rms(r.aligned, slice(0, 2)), rms(r.aligned, slice(0, 3)), rms(r.fitted, slice(0, 2)))
                      for r in results])  # fmt: skip
    row(f"  {title}: mean 2-D 3-D fitted", list(table.mean(axis=0)))
    row("      median, 95th percentile 2-D", [float(np.median(table[:, 0])), float(np.percentile(table[:, 0], 95))])
    row("      95 % interval holds: level, up", [coverage(results, 2), coverage(results, 1)])


def coverage(results: list[Result], axes: int) -> float:
    """Share of the time in which the fitted error lies within the 95 % interval of 2 axes (level) or of 1 (up).

    Equal weight to each trial; the best alignment takes out what a launch heading would give.
    """
    held = []
    for r in results:
        if axes == 2:
            held.append(np.mean(np.sum((r.fitted[:, :2] / r.sigma_m[:, :2]) ** 2, axis=1) < 5.99))
        else:
            held.append(np.mean(np.abs(r.raw[:, 2]) < 1.96 * r.sigma_m[:, 2]))
    return float(np.mean(held))


def simulations(walks: list[Walk], method: str, settings: PositionSettings, attitudes: dict[str, object]) -> None:
    for kind in ("foot-square", "foot-circle", "foot-stairs"):
        chosen = [w for w in walks if w.name.startswith(kind)]
        results = [solve(w, method, settings, attitudes) for w in chosen]
        far = [abs(float(r.raw[int(np.argmax(w.truth_m[:, 2])), 2])) for r, w in zip(results, chosen)]
        ends = [100 * float(np.linalg.norm(r.closure_m)) / r.length_m for r in results]
        row(f"  {kind}: rms m, height at top m, end %",
            [float(np.mean([rms(r.aligned, slice(0, 2)) for r in results])), float(np.mean(far)),
             float(np.mean(ends))])  # fmt: skip
    spread("mixed gaits", [w for w in walks if w.name.startswith("random")], method, settings, attitudes)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--vicon", type=Path)
    parser.add_argument("--detectors", nargs="*", default=list(ALL))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--fixed", action="store_true", help="fixed thresholds instead of adaptive ones")
    parser.add_argument("--orientation", default="auto")
    given = parser.parse_args()
    threshold = "fixed" if given.fixed else "adaptive"
    base = PositionSettings(zero_velocity_threshold=threshold)
    attitudes: dict[str, object] = {"orientation": given.orientation}
    cameras = [*two_feet(), *gaitmap()]
    trials = list(vicon(given.vicon)) if given.vicon else []
    unseen = [w for w in trials if w.name.startswith(UNSEEN)]
    seen = [w for w in trials if not w.name.startswith(UNSEEN)]
    made = list(simulated(given.runs))
    for detector in [*given.detectors, "inertial"]:
        method = "inertial" if detector == "inertial" else "zupt"
        settings = base if method == "inertial" else replace(base, zero_velocity_detector=detector)
        print(f"{detector} ({threshold})")
        closures(method, settings, attitudes)
        against_cameras(cameras, method, settings, attitudes)
        if trials:
            spread("VICON sessions not seen", unseen, method, settings, attitudes)
            spread("VICON sessions trained on", seen, method, settings, attitudes)
        simulations(made, method, settings, attitudes)


if __name__ == "__main__":
    main()
