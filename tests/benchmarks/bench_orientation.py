"""Throughput of the attitude estimators beside the public VQF in the same run; start it by hand, it is no test.

    python tests/benchmarks/bench_orientation.py [rows] [--peak]

Prints Msamples/s, the fastest of three, nine axes. ``--peak`` runs the whole step once, in memory-mapped rows as the
program reads them, and prints time and peak resident memory.
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from vqf import VQF, offlineVQF

from processing.orientation.calibration import calibrate
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
    """Return the least of the wall-clock times."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


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
        yardstick = rows / fastest(lambda: VQF(1 / RATE_HZ).updateBatch(gyr, acc, mag)) / 1e6
        print(f"{'vqf.VQF.updateBatch':22s} {yardstick:6.2f} Msamples/s   1.00")
        offline = rows / fastest(lambda: offlineVQF(gyr, acc, mag, 1 / RATE_HZ)) / 1e6
        print(f"{'vqf.offlineVQF':22s} {offline:6.2f} Msamples/s {offline / yardstick:6.2f}")
        calibration = calibrate(imu, SETTINGS)
        samples = trusted_samples(imu, calibration, SETTINGS, FieldReference(47.2, 1.0))
        for row in ESTIMATORS:
            if row.name == "device":
                continue
            speed = rows / fastest(lambda f=row.function: f(samples, 0.0, silent())) / 1e6
            print(f"{row.name:22s} {speed:6.2f} Msamples/s {speed / yardstick:6.2f}")
        speed = rows / fastest(lambda: calibrate(imu, SETTINGS)) / 1e6
        print(f"{'calibrate':22s} {speed:6.2f} Msamples/s {speed / yardstick:6.2f}")
        speed = rows / fastest(lambda: estimate_attitude(imu, Survey(), SETTINGS, silent()), 1) / 1e6
        print(f"{'estimate_attitude':22s} {speed:6.2f} Msamples/s {speed / yardstick:6.2f}")


if __name__ == "__main__":
    numbers = [a for a in sys.argv[1:] if not a.startswith("-")]
    main(int(float(numbers[0])) if numbers else 1_000_000, "--peak" in sys.argv)
