"""Kill a recording at 100 random moments (or as many as the argument says) and report what was missing.

    python tests/benchmarks/kill_recording.py [KILLS] [SPEED] [AT_ONCE]

Real time unless a speed is given; several recorders run at once, each writing 48 kHz of sound and 400 Hz of motion.
"""

import random
import statistics
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "helpers"))


def main() -> None:
    """Report the figures of the acceptance."""
    from killed_recording import kill_once

    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    speed = float(sys.argv[2]) if len(sys.argv) > 2 else 1.0
    at_once = int(sys.argv[3]) if len(sys.argv) > 3 else 4
    chance = random.Random(5)
    moments = [chance.uniform(2.0, 15.0) for _ in range(kills)]
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(at_once) as pool:
        places = [Path(folder) / str(i) for i in range(kills)]
        done = list(pool.map(kill_once, places, moments, [speed] * kills))
    for name in ("sound_s", "motion_s"):
        missing = [getattr(one, name) for one in done]
        print(f"{name}: missing {statistics.median(missing):.3f} s in the middle, {max(missing):.3f} s at worst")
    recorded = [one.recorded_s for one in done]
    print(f"marks missing: {sum(one.marks for one in done)} of {sum(round(r) for r in recorded)}")
    print(
        f"{kills} kills after {min(recorded):.1f}–{max(recorded):.1f} s of sound; every folder opened, all bits right"
    )
    print(f"{time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
