"""P0's three scenarios, simulated, through `leakline process` end to end: leak errors beside the published ones.

python tests/benchmarks/p0_scenarios.py [SEEDS]
"""

import csv
import json
import sys
import tempfile
from pathlib import Path

import numpy as np

from app import cli
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run

PUBLISHED_M = {"p0-straight": 0.093, "p0-closed": 0.069, "p0-50m": 0.105}


def errors_m(name: str, seed: int, folder: Path) -> tuple[float, bool]:
    """Return how far the best candidate lies from the leak along the pipe, and whether its interval holds it."""
    write_run(simulate(load_scenario(name), seed), folder / "in")
    if cli.run(["process", str(folder / "in"), "--out", str(folder / "out")]) != 0:
        raise SystemExit(f"{name}, seed {seed}: process failed")
    truth = json.loads((folder / "in" / "truth.json").read_text(encoding="utf-8"))
    (leak,) = [place["chainage_m"] for place in truth["places"] if place["kind"] == "leak"]
    with (folder / "out" / "leaks.csv").open(encoding="utf-8") as file:
        best = next(csv.DictReader(file))
    held = float(best["chainage_low95_m"]) <= leak <= float(best["chainage_high95_m"])
    return float(best["chainage_m"]) - leak, held


def main() -> None:
    """Print one row a scenario."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    rows = []
    for name, published in PUBLISHED_M.items():
        results = []
        for seed in range(seeds):
            with tempfile.TemporaryDirectory() as folder:
                results.append(errors_m(name, seed, Path(folder)))
        off = np.abs([error for error, _ in results])
        held = sum(h for _, h in results)
        rows.append(
            f"{name:12} published {published:.3f} m   median {np.median(off):.3f} m   worst {off.max():.3f} m   "
            f"interval held {held} of {seeds}"
        )
    print("\n".join(rows))


if __name__ == "__main__":
    main()
