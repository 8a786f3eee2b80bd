"""An hour of survey through `leakline process`: time and peak memory in a process of its own, and where the time goes.

python tests/benchmarks/bench_process.py [FOLDER]      without FOLDER, the scenario long-main is simulated first
"""

import cProfile
import pstats
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from app import cli
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run
from processing.sound.source import open_audio


def main() -> None:
    """Print wall time as a multiple of real time, peak memory, and the profile's top entries."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(scratch) / "in"
        if len(sys.argv) < 2:
            write_run(simulate(load_scenario("long-main"), 0), folder)
        source, _ = open_audio(sorted(folder.glob("audio.*")))
        out = str(Path(scratch) / "out")
        words = ["process", str(folder), "--out", out]
        began = time.perf_counter()
        subprocess.run([sys.executable, "-m", "app", *words], check=True, stdout=subprocess.DEVNULL)
        wall = time.perf_counter() - began
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(f"recording {source.duration_s:.0f} s; wall {wall:.1f} s = {source.duration_s / wall:.0f} x real time")
        print(f"cpu {used.ru_utime + used.ru_stime:.1f} s, peak memory {used.ru_maxrss / 1024:.0f} MiB")
        profile = cProfile.Profile()
        profile.enable()
        cli.run(words)
        profile.disable()
        pstats.Stats(profile).sort_stats("tottime").print_stats(14)


if __name__ == "__main__":
    main()
