"""How often two simulated runs of one main tell the truth: ``python tests/benchmarks/repeat_runs.py [pairs]``.

Each pair has a leak that stayed, one that grew by 3 to 8 dB, one mended, one new; speed and recorder's gain differ.
"""

import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "helpers"))

from repeated_main import listened

from processing.repeat_runs import Change, ComparedRun, compare

NEAR_M = 2.5


def main(pairs: int) -> None:
    """Compare so many pairs and print the tally and the errors of the growth."""
    tally, errors, inside, others = Counter(), [], 0, 0
    for seed in range(pairs):
        rng = np.random.default_rng(seed)
        speed, grown, gain = rng.uniform(0.45, 0.8), rng.uniform(3.0, 8.0), rng.uniform(-6.0, 6.0)
        with tempfile.TemporaryDirectory() as name:
            place = Path(name)
            then, old = listened(place, "old", "2025", [(20.0, 10.0), (45.0, 8.0), (80.0, 10.0)], seed=100 + seed)
            leaks = [(20.0, 10.0), (45.0, 8.0 + grown), (65.0, 10.0)]
            now, new = listened(place, "new", "2026", leaks, seed=200 + seed, speed_mps=speed, gain_db=gain)
            found = compare(ComparedRun("new", "2026-05-04", new), ComparedRun("old", "2025-05-04", old))
            then.close()
            now.close()
        truth = {
            20.0: (Change.SAME, 0.0),
            45.0: (Change.SAME, grown),
            65.0: (Change.NEW, None),
            80.0: (Change.GONE, None),
        }
        others += sum(all(abs(p.chainage_m - at) > NEAR_M for at in truth) for p in found.places)
        for at, (change, growth) in truth.items():
            hits = [p for p in found.places if abs(p.chainage_m - at) <= NEAR_M]
            right = len(hits) == 1 and hits[0].change is change
            tally[(change.value, right)] += 1
            if right and growth is not None:
                errors.append(hits[0].growth_db - growth)
                inside += abs(errors[-1]) <= hits[0].growth_half95_db
    for (change, right), count in sorted(tally.items()):
        print(f"{change:10} {'right' if right else 'wrong'} {count}")
    print(f"places that are none: {others}")
    print(f"growth: error {np.sqrt(np.mean(np.square(errors))):.2f} dB rms, within ± {inside} of {len(errors)}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)
