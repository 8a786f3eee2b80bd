"""Every attitude estimator on BROAD's trials, by BROAD's own definition of the error, as a table in Markdown.

    OMP_NUM_THREADS=1 python tests/benchmarks/broad.py FOLDER [--trials 2,4,6] [--each]

FOLDER holds BROAD's ``.mat`` files (github.com/dlaidig/broad). Each estimator runs as the program runs it, calibration
at rest included, with one set of settings, told to trust the magnetometer; the six-axis ones have no heading to score,
so only their inclination counts. Beside them VQF and offline VQF as their package gives them. BROAD's error takes no
heading offset away: total = 2 acos |w|, heading = 2 atan |z/w|, inclination = 2 acos √(w² + z²) of ``q ⊗ truth*``, root
of the mean square over the moving samples. ``--each`` prints every trial.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from vqf import VQF, offlineVQF

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers"))
from broad import read_trial, rmse_deg  # the helper beside the tests

from processing.orientation.registry import ESTIMATORS, estimate_attitude
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, Motion, ProcessingChoice, Survey

SETTINGS = OrientationSettings(magnetometer="use")
NAMES = [row.name for row in ESTIMATORS if row.name != "device"]
HAS_HEADING = {row.name for row in ESTIMATORS if row.uses_field}
UNDISTURBED = 23  # trials up to this number


def packages(trial):
    """Return the quaternions of VQF and offline VQF without anything of ours."""
    imu, period = trial.imu, 1.0 / trial.rate_hz
    readings = (imu.gyr_s_radps, imu.acc_s_mps2, imu.mag_s_ut)
    return {
        "package: VQF": VQF(period).updateBatch(*readings)["quat9D"],
        "package: offlineVQF": offlineVQF(*readings, period)["quat9D"],
    }


def scores_of(trial):
    """Return {method: (total, heading, inclination)} in degrees."""
    found = {name: rmse_deg(quat, trial.truth_ws, trial.movement) for name, quat in packages(trial).items()}
    for name in NAMES:
        survey = Survey(device=DeviceInfo(motion=Motion.CARRIED), processing=ProcessingChoice(orientation=name))
        attitude, _, _ = estimate_attitude(trial.imu, survey, SETTINGS, silent())
        found[name] = rmse_deg(attitude.quat_ws, trial.truth_ws, trial.movement)
        if name not in HAS_HEADING:
            found[name] = (np.nan, np.nan, found[name][2])
    return found


def written(values):
    """Return three angles as a cell."""
    return " / ".join("–" if np.isnan(v) else f"{v:.2f}" for v in values)


def print_means(scores):
    """Print the means over all trials and over each kind, and the worst trial."""
    groups = {
        "all": list(scores),
        "undisturbed": [n for n in scores if n <= UNDISTURBED],
        "disturbed": [n for n in scores if n > UNDISTURBED],
        "even numbers": [n for n in scores if n % 2 == 0],
    }
    groups = {title: numbers for title, numbers in groups.items() if numbers}
    print("Total / heading / inclination RMSE in degrees, means over trials\n")
    print("| estimator | " + " | ".join(f"{title} ({len(n)})" for title, n in groups.items()) + " | worst |")
    print("|---" * (len(groups) + 2) + "|")
    for name in next(iter(scores.values())):
        cells = [written(np.mean([scores[n][name] for n in numbers], axis=0)) for numbers in groups.values()]
        worst = max(scores, key=lambda n: np.nan_to_num(scores[n][name][0]))
        cells.append(
            f"{scores[worst][name][0]:.1f} (trial {worst})" if name not in NAMES or name in HAS_HEADING else "–"
        )
        print(f"| {name} | " + " | ".join(cells) + " |")


def print_each(scores):
    """Print every trial's total / heading / inclination."""
    names = list(next(iter(scores.values())))
    print("\n| trial | " + " | ".join(names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for number, found in scores.items():
        print(f"| {number:02d} | " + " | ".join(written(found[n]) for n in names) + " |")


def main():
    """Read, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--trials", default="", help="numbers, separated by commas; all without")
    parser.add_argument("--each", action="store_true", help="print every trial too")
    options = parser.parse_args()
    present = sorted(int(file.name[:2]) for file in options.folder.glob("[0-9][0-9]_*.mat"))
    wanted = [int(n) for n in options.trials.split(",") if n] or present
    scores = {}
    for number in wanted:
        scores[number] = scores_of(read_trial(options.folder, number))
        print(f"trial {number:02d}", file=sys.stderr)
    if not scores:
        sys.exit(f"{options.folder}: no trial of BROAD (NN_….mat)")
    print_means(scores)
    if options.each:
        print_each(scores)


if __name__ == "__main__":
    main()
