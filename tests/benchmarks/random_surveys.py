"""Random realistic surveys through ``leakline process``: leaks found, false candidates, coverage of the intervals.

    python tests/benchmarks/random_surveys.py [--count 20] [--first 0] [--keep DIR]

Each survey is drawn by ``random-N``, simulated, processed by the command line in a process of its own, and the files it
writes are held against the truth. One line a survey, then the whole:

- *found*: leaks that some candidate's 95 % interval (and half a metre) holds, among the first k candidates, where k is
  the number of leaks, and among all;
- *false/km*: candidates above 0.5 that no leak, valve or air pocket lies at;
- *interval*: of the candidates nearest to a found leak (within 10 m), the share whose interval holds its true place;
- *track*: share of the moments in motion at which the true chainage lies within ±1.96 sigma of the track.
"""

import argparse
import csv
import json
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

NEAR_M, SLACK_M, CLEAR_SCORE = 10.0, 0.5, 0.5


@dataclass(frozen=True)
class Outcome:
    """What one survey gave."""

    length_m: float
    leaks: int
    found_first_k: int
    found: int
    false_clear: int
    near: int
    held: int
    track_share: float
    end_error_m: float
    seconds: float


def leakline(*words: str) -> None:
    """Run the command line; its own words go with the failure."""
    done = subprocess.run([sys.executable, "-m", "app", *words], capture_output=True, text=True, check=False)
    if done.returncode != 0 or done.stderr:
        raise SystemExit(f"leakline {' '.join(words)}: status {done.returncode}: {done.stderr}")


def judge(survey: Path, out: Path, seconds: float) -> Outcome:
    """Hold the written files against the truth."""
    truth = json.loads((survey / "truth.json").read_text(encoding="utf-8"))
    leaks = [p["chainage_m"] for p in truth["places"] if p["kind"] == "leak"]
    others = [p["chainage_m"] for p in truth["places"] if p["kind"] in ("valve", "air")]
    with (out / "leaks.csv").open(encoding="utf-8") as file:
        rows = [{k: float(row[k]) for k in KEYS} for row in csv.DictReader(file)]
    first = rows[: len(leaks)]
    nearest = [min(rows, key=lambda r: abs(r["chainage_m"] - at)) for at in leaks] if rows else []
    near = [(r, at) for r, at in zip(nearest, leaks) if abs(r["chainage_m"] - at) <= NEAR_M]
    clear = [r for r in rows if r["score"] >= CLEAR_SCORE]
    share, end_error = track_figures(survey / "truth_track.csv", out / "track.csv")
    return Outcome(
        length_m=truth["length_m"],
        leaks=len(leaks),
        found_first_k=sum(any(holds(r, at, SLACK_M) for r in first) for at in leaks),
        found=sum(any(holds(r, at, SLACK_M) for r in rows) for at in leaks),
        false_clear=sum(not any(holds(r, at, 3.0) for at in (*leaks, *others)) for r in clear),
        near=len(near),
        held=sum(holds(r, at, 0.0) for r, at in near),
        track_share=share,
        end_error_m=end_error,
        seconds=seconds,
    )


KEYS = ("chainage_m", "chainage_low95_m", "chainage_high95_m", "score")


def holds(row: dict[str, float], at_m: float, slack_m: float) -> bool:
    """Whether a candidate's interval holds a place."""
    return row["chainage_low95_m"] - slack_m <= at_m <= row["chainage_high95_m"] + slack_m


def track_figures(truth_file: Path, track_file: Path) -> tuple[float, float]:
    """Return the share of moments in motion at which ±1.96 sigma holds the truth, and the error at the end."""
    truth = np.genfromtxt(truth_file, delimiter=",", names=True)
    track = np.genfromtxt(track_file, delimiter=",", names=True)
    moving = np.interp(track["time_s"], truth["time_s"], truth["speed_mps"]) > 0.05
    error = track["chainage_m"] - np.interp(track["time_s"], truth["time_s"], truth["chainage_m"])
    return float(np.mean(np.abs(error[moving]) <= 1.96 * track["sigma_along_m"][moving])), float(error[-1])


def main() -> None:
    """Run the surveys and print the table."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--count", type=int, default=20)
    words.add_argument("--first", type=int, default=0)
    words.add_argument("--keep", type=Path)
    told = words.parse_args()
    outcomes = []
    print(" N   length  leaks  first-k  found  false  near  held  track  end error    time")
    with tempfile.TemporaryDirectory() as scratch:
        for number in range(told.first, told.first + told.count):
            survey = (told.keep or Path(scratch)) / f"random-{number}"
            leakline("simulate", f"random-{number}", "--out", str(survey), "--seed", str(number))
            began = time.perf_counter()
            leakline("process", str(survey), "--out", str(survey / "exports"))
            o = judge(survey, survey / "exports", time.perf_counter() - began)
            outcomes.append(o)
            print(
                f"{number:2} {o.length_m:7.0f} m {o.leaks:5} {o.found_first_k:8} {o.found:6} {o.false_clear:6} "
                f"{o.near:5} {o.held:5} {o.track_share:6.0%} {o.end_error_m:8.2f} m {o.seconds:5.1f} s",
                flush=True,
            )
    leaks, near = sum(o.leaks for o in outcomes), sum(o.near for o in outcomes)
    km = sum(o.length_m for o in outcomes) / 1000.0
    print(
        f"{km:.2f} km, {leaks} leaks: {sum(o.found_first_k for o in outcomes) / max(leaks, 1):.0%} among the first k, "
        f"{sum(o.found for o in outcomes) / max(leaks, 1):.0%} among all; "
        f"{sum(o.false_clear for o in outcomes) / km:.2f} false ones a kilometre; "
        f"intervals hold {sum(o.held for o in outcomes)} of {near}; "
        f"track within ±1.96 sigma {np.mean([o.track_share for o in outcomes]):.0%} of the time in motion "
        f"({sum(o.track_share > 0.5 for o in outcomes)} of {len(outcomes)} surveys mostly); "
        f"peak memory {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024:.0f} MB"
    )


if __name__ == "__main__":
    main()
