"""Real rolling: IMUs on the wheels of a car beside RTK positions; repeatability of distance, heading drift, end error.

    python tests/benchmarks/wheels.py FOLDER [--off]

FOLDER holds the public "Wheel Inertial Dataset" (Nemec, Versano et al. 2024): ``trialNN/IMUk[_radial].csv`` of Xsens
DOTs and ``trialNN/GNSS.csv``. Each wheel is taken for a ball: our import, ``estimate_attitude`` (auto) and the rolling
odometry, nothing tuned for it. ``--off`` leaves out what rolling tells of the sensors, for comparison.

- ``distance``: error of the length with the radius that the same sensor's *other* trials gave (leave one out);
- ``chainage``: largest error along the run with that radius, and with the run's own length known;
- ``end``: where the run ends after the first quarter of the way was laid onto the truth (turned, shifted);
- ``ATE``: rms distance after turning and shifting the whole; ``drift``: slope of the heading error.

Runs whose wheel speed does not follow the truth (correlation under 0.998) have no common clock and are left out.
"""

import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.signal import savgol_filter

from processing.errors import LeaklineError
from processing.importing.choosing import read_imu
from processing.importing.doctor import examine
from processing.importing.options import ImportOptions
from processing.importing.raw import ReadContext
from processing.orientation.registry import estimate_attitude
from processing.position.registry import reckon
from processing.progress import silent
from processing.settings import ImportSettings, OrientationSettings, PositionSettings
from processing.survey import DeviceInfo, ImuSamples, Survey

GRID_HZ = 20.0
LEAST_CORRELATION = 0.998
NOMINAL_M = 0.3


@dataclass(frozen=True)
class Truth:
    """RTK: times, plan positions (n, 2) in metres, speed, and the way gone."""

    time_s: np.ndarray
    position_m: np.ndarray
    speed_mps: np.ndarray
    way_m: np.ndarray


@dataclass(frozen=True)
class Run:
    """A wheel's odometry on the truth's times, for a wheel of ``NOMINAL_M``."""

    trial: str
    sensor: str
    position_m: np.ndarray
    way_m: np.ndarray
    truth: Truth
    correlation: float
    calibration: object


def read_truth(path: Path, duration_s: float) -> Truth:
    """Return the truth at 20 Hz; some files' stamps are ten times wrong, which the IMU's duration shows."""
    lat, lon = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(1, 2)).T
    stamps = np.loadtxt(path, delimiter=",", skiprows=1, usecols=0)
    stamps = stamps - stamps[0]
    if abs(np.log(0.1 * stamps[-1] / duration_s)) < abs(np.log(stamps[-1] / duration_s)):
        stamps = 0.1 * stamps
    sine = np.sin(np.radians(lat[0]))
    east_radius = 6378137.0 / np.sqrt(1.0 - 0.00669438 * sine**2)
    north_radius = east_radius * (1.0 - 0.00669438) / (1.0 - 0.00669438 * sine**2)
    east = np.radians(lon - lon[0]) * np.cos(np.radians(lat[0])) * east_radius
    north = np.radians(lat - lat[0]) * north_radius
    time_s = np.arange(0.0, stamps[-1], 1.0 / GRID_HZ)
    at, east, north = _fixes(stamps, east, north)
    position = np.column_stack([np.interp(time_s, at, east), np.interp(time_s, at, north)])
    position = savgol_filter(position, 21, 2, axis=0)  # 1 s: the receiver's centimetres would make a parked car walk
    velocity = np.gradient(position, time_s, axis=0)
    speed = np.hypot(*velocity.T)
    going = np.where(speed > 0.15, speed, 0.0)
    way = np.concatenate([[0.0], np.cumsum(0.5 * (going[1:] + going[:-1])) / GRID_HZ])
    return Truth(time_s, position, speed, way)


def _fixes(stamps, east, north):
    """Keep the rows with a new position: the receiver gives five a second, and the file repeats them."""
    new = np.flatnonzero(np.concatenate([[True], (np.diff(east) != 0.0) | (np.diff(north) != 0.0)]))
    waits = new[1:][np.diff(stamps[new]) > 0.45]  # parked: the old place holds until the fix before the next one
    at = np.concatenate([stamps[new], stamps[waits] - 0.2, stamps[-1:]])
    before = np.concatenate([new, waits - 1, [len(stamps) - 1]])
    order = np.argsort(at, kind="stable")
    return at[order], east[before][order], north[before][order]


def read_wheel(path: Path) -> ImuSamples:
    """Return the samples as the program imports them."""
    with tempfile.TemporaryDirectory() as scratch:
        raw = read_imu(path, ImportOptions(), ReadContext(Path(scratch)))
        return examine(raw, ImportSettings(), path).imu


def run_of(folder: Path, sensor: str, options: OrientationSettings) -> Run | None:
    """Return one wheel of one trial, on the truth's clock."""
    imu = read_wheel(folder / f"{sensor}.csv")
    imu = replace(imu, time_s=imu.time_s - imu.time_s[0])
    truth = read_truth(folder / "GNSS.csv", float(imu.time_s[-1]))
    survey = Survey(device=DeviceInfo(radius_m=NOMINAL_M))
    attitude, calibration, _ = estimate_attitude(imu, survey, options, silent())
    path = reckon(imu, attitude, survey, PositionSettings(), silent())
    lags = np.arange(-12.0, 12.0, 0.05)
    score = [_agreement(path.time_s + lag, path.speed_mps, truth) for lag in lags]
    lag = float(lags[int(np.argmax(score))])
    fine = np.arange(lag - 0.06, lag + 0.06, 0.005)
    score = [_agreement(path.time_s + f, path.speed_mps, truth) for f in fine]
    time_s = path.time_s + float(fine[int(np.argmax(score))])
    inside = (truth.time_s >= time_s[0]) & (truth.time_s <= time_s[-1])
    truth = Truth(*(v[inside] for v in vars(truth).values()))
    position = np.column_stack([np.interp(truth.time_s, time_s, path.position_w_m[:, k]) for k in (0, 1)])
    way = np.interp(truth.time_s, time_s, path.chainage_m)
    truth = replace(truth, way_m=truth.way_m - truth.way_m[0])
    return Run(folder.name, sensor, position - position[0], way - way[0], truth, max(score), calibration)


def _agreement(time_s, speed, truth):
    inside = (truth.time_s >= time_s[0]) & (truth.time_s <= time_s[-1])
    if inside.mean() < 0.5:
        return 0.0
    other = np.interp(truth.time_s[inside], time_s, speed)
    return float(np.corrcoef(other, truth.speed_mps[inside])[0, 1])


def laid_on(position, truth, rows):
    """Turn and shift ``position`` (n, 2) so that ``rows`` of it lie best on those of ``truth``."""
    a, b = position[rows], truth[rows]
    ca, cb = a.mean(axis=0), b.mean(axis=0)
    p, q = (a - ca) @ [1, 1j], (b - cb) @ [1, 1j]
    turned = (position - ca) @ [1, 1j] * np.exp(1j * np.angle(np.sum(q * p.conj()))) + cb @ [1, 1j]
    return np.column_stack([turned.real, turned.imag])


def drift_dph(position, truth: Truth) -> float:
    """Slope of the heading error in °/h over the seconds in which the car drives."""
    step = int(GRID_HZ)
    own, true = position[step:] - position[:-step], truth.position_m[step:] - truth.position_m[:-step]
    moving = np.hypot(*true.T) > 1.5
    error = np.unwrap(np.angle((own[moving] @ [1, 1j]) / (true[moving] @ [1, 1j])))
    time_s = truth.time_s[step:][moving]
    slope = np.polyfit(time_s - time_s.mean(), error, 1)[0]
    return float(np.degrees(slope) * 3600.0)


def figures(run: Run, radius_m: float) -> dict[str, float]:
    """Return a run's errors with a wheel of ``radius_m``; in per cent of the way, drift in °/h."""
    total = float(run.truth.way_m[-1])
    factor = radius_m / NOMINAL_M
    position, way = run.position_m * factor, run.way_m * factor
    known = run.way_m * total / run.way_m[-1]
    quarter = run.truth.way_m < 0.25 * total
    ended = laid_on(position, run.truth.position_m, quarter)[-1] - run.truth.position_m[-1]
    whole = laid_on(position, run.truth.position_m, slice(None)) - run.truth.position_m
    return {
        "distance": 100.0 * abs(way[-1] / total - 1.0),
        "chainage, other radius": 100.0 * np.max(np.abs(way - run.truth.way_m)) / total,
        "chainage, length known": 100.0 * np.max(np.abs(known - run.truth.way_m)) / total,
        "end": 100.0 * float(np.hypot(*ended)) / total,
        "ATE": 100.0 * float(np.sqrt(np.mean(np.sum(whole**2, axis=1)))) / total,
        "drift °/h": abs(drift_dph(position, run.truth)),
    }


def radius_of(run: Run) -> float:
    """Return the wheel's radius from the run's own length."""
    return float(NOMINAL_M * run.truth.way_m[-1] / run.way_m[-1])


def tabulate(runs: list[Run]) -> None:
    """Print each run's figures, and median, 90th percentile and largest."""
    rows = []
    for run in runs:
        others = [radius_of(r) for r in runs if r.sensor == run.sensor and r.trial != run.trial]
        radius = float(np.median(others)) if others else np.nan
        found = figures(run, radius if others else radius_of(run))
        if not others:
            found |= {"distance": np.nan, "chainage, other radius": np.nan}
        rows.append(found)
        scale = np.round(100.0 * (run.calibration.gyr_scale - 1.0), 2)
        print(f"{run.trial} {run.sensor:12s} {run.truth.way_m[-1]:6.1f} m  r {radius_of(run):.4f}  scale {scale} %  "
              + "  ".join(f"{v:7.2f}" for v in found.values()))  # fmt: skip
    print(f"{len(rows)} runs, {sum(r.truth.way_m[-1] for r in runs) / 1000.0:.1f} km")
    for name in rows[0]:
        values = np.array([row[name] for row in rows])
        values = values[np.isfinite(values)]
        print(f"{name:24s} n {len(values):3d}  median {np.median(values):8.3f}  p90 {np.percentile(values, 90):8.3f}"
              f"  max {values.max():8.3f}")  # fmt: skip


def main(root: Path, options: OrientationSettings) -> None:
    """Go through all trials below ``root``."""
    runs = []
    for path in sorted(root.rglob("IMU*.csv")):
        if not (path.parent / "GNSS.csv").exists():
            continue
        try:
            run = run_of(path.parent, path.stem, options)
        except LeaklineError as error:
            print(path.parent.name, path.stem, error)
            continue
        if run.correlation < LEAST_CORRELATION:
            print(f"{run.trial} {run.sensor}: speeds agree to {run.correlation:.4f} only; left out")
            continue
        runs.append(run)
    tabulate(runs)


if __name__ == "__main__":
    told = OrientationSettings()
    if "--off" in sys.argv:
        told = replace(told, gyro_scale="off", accelerometer="off")
    main(Path(sys.argv[1]), told)
