"""The whole navigation of a long run: wall time and peak memory of calibration, attitude, path and fit, step by step.

    python tests/benchmarks/long_navigation.py [--hours 12] [--rate 400] [--method auto] [--profile] [--folder DIR]

The recording is a ball that rolls on for hours with rests, slow bends, spin, noise, bias and scale errors; it is made
block by block into memory-mapped files, as the program reads them, before the clock starts. Tie points each kilometre.

Memory: *own* is what the process has allocated (RssAnon), *all* also counts the mapped pages of the recording that
happen to be in memory (RSS, what ``ru_maxrss`` says); the machine takes those back when it needs them.
"""

import argparse
import cProfile
import pstats
import resource
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from processing.orientation import quaternions as qt
from processing.orientation.registry import estimate_attitude
from processing.position.fitting import fit, refit
from processing.position.registry import find_reckoned, problem_of
from processing.progress import Progress
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.motion import chained
from processing.simulation.smooth import step
from processing.survey import DeviceInfo, ImuSamples, Launch, ProcessingChoice, Survey, TiePoint

RADIUS_M, SPEED_MPS, REST_S, LEG_S = 0.0475, 0.5, 15.0, 1800.0
BLOCK = 1 << 18


def going(t, end_s):
    """Share of the speed (n,): nought in the rests, with smooth ramps of four seconds."""
    within = np.mod(t, LEG_S)
    out = step(np.clip((within - REST_S) / 4.0, 0, 1)) * step(np.clip((LEG_S - within) / 4.0, 0, 1))
    return out * step(np.clip((end_s - REST_S - t) / 4.0, 0, 1))


def write_run(folder, hours, rate_hz):
    """Write the recording, and return it mapped, with the true chainage at each minute."""
    rows = int(hours * 3600 * rate_hz)
    end_s = rows / rate_hz
    shapes = {"time": (rows,), "acc": (rows, 3), "gyr": (rows, 3)}
    maps = {
        k: np.lib.format.open_memmap(folder / f"{k}.npy", mode="w+", dtype=np.float64, shape=s)
        for k, s in shapes.items()
    }
    rng = np.random.default_rng(0)
    quat, way, minutes = np.array([1.0, 0.0, 0.0, 0.0]), 0.0, [(0.0, 0.0)]
    for a in range(0, rows, BLOCK):
        t = np.arange(a, min(a + BLOCK, rows)) / rate_hz
        under_way = going(t, end_s)
        speed = SPEED_MPS * under_way * (1 + 0.1 * np.sin(2 * np.pi * t / 40))
        yaw = 0.5 * np.sin(2 * np.pi * t / 900)
        spin = under_way * 0.2 * np.sin(2 * np.pi * t / 7)
        turn_w = np.column_stack([-np.sin(yaw) * speed / RADIUS_M, np.cos(yaw) * speed / RADIUS_M, spin])
        turn_w[~(under_way > 0)] = 0.0
        steps = qt.exp_map(turn_w / rate_hz)
        quats = chained(steps, qt.multiply(steps[0], quat))
        before = np.vstack([quat, quats[:-1]])
        gyr = qt.log_map(qt.multiply(qt.conjugate(before), quats)) * rate_hz
        quat = quats[-1]
        rows_ = slice(a, a + len(t))
        maps["time"][rows_] = t
        maps["gyr"][rows_] = gyr * [1.003, 0.998, 1.002] + [3e-3, -2e-3, 1e-3] + 3e-3 * rng.standard_normal(gyr.shape)
        up = qt.rotate_inverse(quats, np.array([0.0, 0.0, 9.81]))
        maps["acc"][rows_] = up + 0.04 * rng.standard_normal(gyr.shape)
        gone = way + np.cumsum(speed) / rate_hz
        minutes += list(zip(t[:: int(60 * rate_hz)].tolist(), gone[:: int(60 * rate_hz)].tolist()))
        way = float(gone[-1])
    for m in maps.values():
        m.flush()
    del maps
    time_s, acc, gyr = (np.load(folder / f"{k}.npy", mmap_mode="r") for k in shapes)
    return ImuSamples(time_s, acc, gyr, np.ones(rows, dtype=bool)), np.array(minutes), way


class Memory:
    """Watches this process's memory from a thread; ``peak()`` returns the most since the last call, in MB."""

    def __init__(self):
        self._own = self._all = 0.0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self):
        while not self._stop.wait(0.05):
            self._look()

    def _look(self):
        text = Path("/proc/self/status").read_text(encoding="ascii")
        sizes = {line.split(":")[0]: line.split()[1] for line in text.splitlines() if line.startswith(("Rss", "VmRSS"))}
        self._own = max(self._own, int(sizes["RssAnon"]) / 1024)
        self._all = max(self._all, int(sizes["VmRSS"]) / 1024)

    def peak(self):
        """Return own and all, and begin anew."""
        self._look()
        out, self._own, self._all = (self._own, self._all), 0.0, 0.0
        return out

    def close(self):
        """Stop watching."""
        self._stop.set()
        self._thread.join()


class Clock:
    """Times steps and prints them; a progress handed out tells their parts from each other by their phrases."""

    def __init__(self, rows):
        self.rows, self.memory, self.total_s, self.shares = rows, Memory(), 0.0, []

    def timed(self, name, run):
        """Run a step; return what it returns."""
        self.memory.peak()
        phases = {}
        last = [time.perf_counter(), ""]

        def tick(_fraction, phrase):
            now = time.perf_counter()
            phases[last[1]] = phases.get(last[1], 0.0) + now - last[0]
            last[:] = [now, phrase or last[1]]

        began, began_cpu = time.perf_counter(), time.process_time()
        result = run(Progress(tick))
        tick(1.0, "")
        seconds, cpu = time.perf_counter() - began, time.process_time() - began_cpu
        own, every = self.memory.peak()
        self.total_s += seconds
        self.shares.append((name, seconds))
        print(
            f"{name:12s} {seconds:8.2f} s ({cpu:.2f} s of CPU) {self.rows / seconds / 1e6:7.2f} Msamples/s   "
            f"peak {own:6.0f} MB own, {every:6.0f} MB all",
            flush=True,
        )
        for phrase, spent in sorted(phases.items(), key=lambda p: -p[1]):
            if spent > 0.02 * seconds and len(phases) > 1:
                print(f"    while '{phrase or 'nothing'}' was shown: {spent:.2f} s")
        return result


def main():
    """Make the recording, navigate it, print."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--hours", type=float, default=12.0)
    words.add_argument("--rate", type=float, default=400.0)
    words.add_argument("--method", default="auto")
    words.add_argument("--profile", action="store_true", help="print the functions that cost most")
    words.add_argument("--folder", type=Path, help="where to make the recording")
    told = words.parse_args()
    with tempfile.TemporaryDirectory(dir=told.folder) as name:
        imu, minutes, length = write_run(Path(name), told.hours, told.rate)
        navigate(imu, minutes, length, told)


def navigate(imu, minutes, length_m, told):
    """Time the steps."""
    rows = len(imu.time_s)
    print(f"{told.hours:g} h at {told.rate:g} Hz: {rows / 1e6:.1f} M samples, {length_m / 1000:.1f} km", flush=True)
    ties = tuple(
        TiePoint(f"marker {k + 1}", float(np.interp(s, minutes[:, 1], minutes[:, 0])), chainage_m=float(s), sigma_m=2.0)
        for k, s in enumerate(np.arange(1000.0, length_m, 1000.0))
    )
    survey = Survey(
        launch=Launch(heading_deg=90.0),
        device=DeviceInfo(radius_m=RADIUS_M),
        processing=ProcessingChoice(orientation=told.method),
        tie_points=ties,
    )
    options = PositionSettings()
    clock = Clock(rows)
    profile = cProfile.Profile()
    if told.profile:
        profile.enable()
    attitude, _, _ = clock.timed("attitude", lambda p: estimate_attitude(imu, survey, OrientationSettings(), p))
    reckoned = clock.timed("reckoning", lambda p: find_reckoned(imu, attitude, survey, options, p))
    problem = clock.timed("preparing", lambda _: problem_of(reckoned, survey, options))
    fitted = clock.timed("fit", lambda p: fit(problem, survey, options, p))
    clock.timed("refit", lambda _: refit(problem, survey, options))
    if told.profile:
        profile.disable()
        pstats.Stats(profile).sort_stats("tottime").print_stats(18)
    clock.memory.close()
    found = np.interp(minutes[:, 0], fitted.track.time_s, fitted.track.chainage_m)
    shares = ", ".join(f"{n} {100 * s / clock.total_s:.0f} %" for n, s in clock.shares)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    worst = float(np.max(np.abs(found - minutes[:, 1])))
    print(
        f"total {clock.total_s:.1f} s ({told.hours * 3600 / clock.total_s:.0f} × real time), {shares}; method "
        f"{attitude.method}; peak of the process {peak:.0f} MB; largest chainage error {worst:.2f} m"
    )


if __name__ == "__main__":
    main()
