"""Throughput of every attitude estimator beside the public packages in the same run; start it by hand, it is no test.

    OMP_NUM_THREADS=1 python tests/benchmarks/bench_orientation.py [rows] [--peak]

Prints samples a second, nine axes, the fastest of three in the process's own time, so that what else runs on the
machine matters less: first the packages (VQF; Fusion where ``imufusion`` is installed, its time extrapolated from fewer
rows), then every row of the table of estimators, then the recursions in blocks of a second, as they run while
recording. ``--peak`` runs the whole step once, in memory-mapped rows as the program reads them, and prints time and
peak resident memory.
"""

import importlib.util
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from vqf import VQF, offlineVQF

from processing.orientation.calibration import calibrate
from processing.orientation.live import LIVE_NAMES, LiveAttitude
from processing.orientation.magnetometer import FieldReference
from processing.orientation.registry import ESTIMATORS, estimate_attitude
from processing.orientation.samples import trusted_samples
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import ImuSamples, Survey

RATE_HZ = 400.0
SETTINGS = OrientationSettings()


def write_run(folder: Path, rows: int) -> ImuSamples:
    """Write a rolling run of noise, spin and field block by block, and return it memory-mapped."""
    rng = np.random.default_rng(0)
    names = {"time": (rows,), "acc": (rows, 3), "gyr": (rows, 3), "mag": (rows, 3)}
    maps = {
        k: np.lib.format.open_memmap(folder / f"{k}.npy", mode="w+", dtype=np.float64, shape=s)
        for k, s in names.items()
    }
    for a in range(0, rows, 1 << 18):
        k = np.arange(a, min(a + (1 << 18), rows))
        t = k / RATE_HZ
        spin = np.where(t < 10.0, 0.0, 10.0)
        angle = 10.0 * np.maximum(t - 10.0, 0.0)
        zero = np.zeros_like(t)
        maps["time"][k] = t
        maps["gyr"][k] = np.column_stack([spin, zero, zero]) + 0.002 * rng.standard_normal((len(k), 3))
        up = np.column_stack([zero, np.sin(angle), np.cos(angle)])
        maps["acc"][k] = 9.81 * up + 0.05 * rng.standard_normal((len(k), 3))
        north = np.column_stack([zero, np.cos(angle), -np.sin(angle)])
        maps["mag"][k] = 25.0 * north - 40.0 * up + 0.3 * rng.standard_normal((len(k), 3))
    for m in maps.values():
        m.flush()
    time_s, acc, gyr, mag = (np.load(folder / f"{k}.npy", mmap_mode="r") for k in names)
    return ImuSamples(time_s, acc, gyr, np.ones(rows, dtype=bool), mag)


def fastest(run, repeats=3):
    """Return the least of the times that this process worked, in s."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


def fusion_seconds(gyr, acc, mag, rows=50_000):
    """Return the seconds that Fusion's filter takes for all rows, one call a row; None where it is not installed."""
    if importlib.util.find_spec("imufusion") is None:
        return None
    import imufusion

    rows = min(rows, len(gyr))
    readings = list(zip(np.degrees(gyr[:rows]), acc[:rows] / 9.81, mag[:rows], strict=True))

    def run():
        ahrs = imufusion.Ahrs()
        ahrs.set_sample_period(1.0 / RATE_HZ)
        for g, a, m in readings:
            ahrs.update(g, a, m)
            ahrs.get_quaternion()

    return fastest(run) * len(gyr) / rows


def live_run(name, imu, calibration, field):
    """Take a run as it is recorded, a second at a time."""
    attitude = LiveAttitude(name, calibration, SETTINGS, 1.0 / RATE_HZ, field=field)
    step = int(RATE_HZ)
    for a in range(0, len(imu.time_s), step):
        rows = slice(a, a + step)
        attitude.add(
            ImuSamples(
                imu.time_s[rows], imu.acc_s_mps2[rows], imu.gyr_s_radps[rows], imu.valid[rows], imu.mag_s_ut[rows]
            )
        )
    attitude.finish()


def main(rows: int, peak: bool) -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as name:
        imu = write_run(Path(name), rows)
        if peak:
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            start = time.perf_counter()
            attitude, _, _ = estimate_attitude(imu, Survey(), SETTINGS, silent())
            seconds = time.perf_counter() - start
            top = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{attitude.method}: {rows / 1e6:.1f} M rows, {seconds:.0f} s, peak {top:.0f} MB, before {before:.0f}"
            )
            return
        gyr, acc, mag = (np.array(a) for a in (imu.gyr_s_radps, imu.acc_s_mps2, imu.mag_s_ut))
        calibration, field = calibrate(imu, SETTINGS), FieldReference(47.2, 1.0)
        samples = trusted_samples(imu, calibration, SETTINGS, field)
        named = {
            "package vqf: VQF": fastest(lambda: VQF(1 / RATE_HZ).updateBatch(gyr, acc, mag)),
            "package vqf: offlineVQF": fastest(lambda: offlineVQF(gyr, acc, mag, 1 / RATE_HZ)),
        }
        fusion = fusion_seconds(gyr, acc, mag)
        if fusion is not None:
            named["package imufusion: Ahrs"] = fusion
        for row in ESTIMATORS:
            if row.name != "device":
                named[row.name] = fastest(lambda f=row.function: f(samples, 0.0, silent()))
        for name in LIVE_NAMES:
            named[f"live: {name}"] = fastest(lambda n=name: live_run(n, imu, calibration, field), 1)
        named["calibrate"] = fastest(lambda: calibrate(imu, SETTINGS))
        named["estimate_attitude"] = fastest(lambda: estimate_attitude(imu, Survey(), SETTINGS, silent()), 1)
        print(f"{'':26s} samples/s  µs a sample  times VQF's")
        for name, seconds in named.items():
            slower = seconds / named["package vqf: VQF"]
            print(f"{name:26s} {rows / seconds:9.0f}  {1e6 * seconds / rows:11.2f}  {slower:11.2f}")


if __name__ == "__main__":
    numbers = [a for a in sys.argv[1:] if not a.startswith("-")]
    main(int(float(numbers[0])) if numbers else 1_000_000, "--peak" in sys.argv)
