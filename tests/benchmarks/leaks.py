"""Mains with leaks of known place and SNR: what each detector finds, at which false alarms, how well placed and stated.

    python tests/benchmarks/leaks.py --keep DIR [--detector auto,envelope|all] [--setting usual|other] [--seeds 0-39]
        [--threshold FILE] [--list] [--ceiling] [--results FILE] [--out FILE]

A run is :func:`processing.simulation.leak_trials.leaky_main` (``usual``) or ``other_main`` (``other``); it is made and
listened to once and kept in DIR (about 15 s and 15 MB each), after which a detector takes a second or two a run.
``--list`` names each run's misses and false alarms with what stands nearest. ``--threshold`` also gives the recall at a
score that was fixed on other seeds. ``--ceiling`` adds the detector that is told the truth (:mod:`leak_ceiling`).

Seeds 0–39 usual are for tuning; 1000–1039 usual and 2000–2039 other are looked at once, at the end.
Figures: :mod:`leak_figures`. Intervals in brackets: 90 %, bootstrap over runs.
"""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
from kept import Kept
from leak_figures import (
    Outcome,
    apex,
    average_precision,
    bootstrap,
    calibration,
    false_per_km,
    from_plain,
    joined,
    matched_rows,
    plain,
    recall,
    threshold_at,
)
from leak_runs import SETTINGS, trial

from processing.settings import DetectorSettings
from processing.simulation.leak_trials import SNR_CLASSES_DB
from processing.sound.candidates import DETECTORS, find_candidates

LEAST_SCORE = 0.001
CEILINGS = ("told the truth", "levels unknown")


def searched(detector, setting, seeds, folder, listed=False, kept=None):
    """Return the outcome of a detector on runs; those in ``kept`` are not searched again."""
    settings = DetectorSettings(min_score=LEAST_SCORE)
    outcomes, seconds, kept = [], 0.0, kept or Kept()
    for seed in seeds:
        key = (detector, setting, seed)
        if key not in kept.rows:
            run = trial(setting, seed, folder)
            begun = time.process_time()
            found = find_candidates(run.scan, run.clock, run.track, run.survey_for(detector), settings, imu=run.imu)
            seconds += time.process_time() - begun
            rows = matched_rows(0, run.leaks, found.candidates)
            outcome = Outcome(tuple(rows), (tuple(leak.snr_db for leak in run.leaks),), (run.length_m,))
            kept.add(key, plain(outcome))
            if listed:
                print_run(run, found.candidates)
        outcomes.append(from_plain(kept.rows[key]))
    print(f"  {detector}: {seconds / max(len(seeds), 1):.1f} s CPU a run", file=sys.stderr, flush=True)
    return joined(outcomes)


def truth_told(name, setting, seeds, kept):
    """Return the outcome of the detector that is told the truth."""
    from leak_ceiling import told_the_truth

    outcomes = []
    for seed in seeds:
        key = (name, setting, seed)
        if key not in kept.rows:
            kept.add(key, plain(told_the_truth(setting, [seed], levels_known=name == "told the truth")))
        outcomes.append(from_plain(kept.rows[key]))
    return joined(outcomes)


def print_run(run, candidates, least=0.2):
    """Print what was missed and what was found where there is nothing."""
    rows = matched_rows(0, run.leaks, candidates)
    ordered = sorted(candidates, key=lambda c: -c.score)
    scores = {row.leak: row.score for row in rows if row.leak >= 0}
    missed = [(x.snr_db, round(x.told_m), round(scores.get(i, 0.0), 3)) for i, x in enumerate(run.leaks)
              if scores.get(i, 0.0) < 0.5]  # fmt: skip
    print(f"{run.setting} {run.seed}: missed or doubted {missed}")
    for row, c in zip(rows, ordered):
        if row.leak < 0 and c.score >= least:
            near = sorted((abs(p.told_m - c.chainage_m), p.kind) for p in run.false_places)[:2]
            near += [min((abs(x.told_m - c.chainage_m), f"leak {x.snr_db:+.0f} dB") for x in run.leaks)]
            said = ", ".join(f"{kind} {away:.1f} m" for away, kind in near)
            print(f"    false {c.score:.2f} at {c.chainage_m:.1f} m as {c.leak_class}, {c.level_db:.1f} dB, "
                  f"{c.band_hz[0]:.0f}–{c.band_hz[1]:.0f} Hz, width {c.width_m:.1f} m; near {said}")  # fmt: skip


def print_recall(name, outcome, threshold, per_km=None):
    """Print a line of recalls; with ``per_km`` the threshold is read off each resampled set again."""
    counts = recall(outcome, threshold)

    def share(key):
        def figure(sample):
            at = threshold if per_km is None else threshold_at(sample, per_km)
            hit, of = recall(sample, at).get(key, (0, 0))
            return hit / of if of else np.nan

        return figure

    words = []
    for key in (None, *(round(db) for db in SNR_CLASSES_DB)):
        hit, of = counts.get(key, (0, 0))
        low, high = bootstrap(outcome, share(key), 100)
        words.append(f"{hit / of if of else np.nan:5.2f} ({low:.2f}-{high:.2f})")
    rate = false_per_km(outcome, threshold)
    print(f"{name:24s} {threshold:8.4g} {rate:6.2f}  " + " ".join(words), flush=True)


def print_tables(results, fixed):
    """Print all tables of one setting."""
    any_result = next(iter(results.values()))
    leaks = sum(len(x) for x in any_result.snr_db)
    print(f"{len(any_result.length_m)} runs, {sum(any_result.length_m) / 1000:.2f} km, {leaks} leaks")
    head = " ".join(f"{f'{db:+.0f} dB':>17s}" for db in SNR_CLASSES_DB)
    print(f"\nrecall                    score   FA/km  {'all':>16s} {head}")
    for name, outcome in results.items():
        for per_km in (0.5, 1.0, 2.0):
            print_recall(f"{name} @{per_km:g}/km", outcome, threshold_at(outcome, per_km), per_km)
        if fixed is not None and name in fixed:
            print_recall(f"{name} fixed", outcome, fixed[name])
    print("\nFA/km at score >= 0.2, 0.5, 0.8; average precision; of hits at >= -2 dB the apex error in m (median, p95,")
    print(
        "rms) beside the told path and beside the truth, and % inside the 95 % interval of the sound alone and of the"
    )
    print("whole, with its median half-width in m; then the same shares for hits of all SNRs")
    for name, outcome in results.items():
        at = threshold_at(outcome, 1.0)
        own = apex(outcome, at)
        everything = apex(outcome, at, -100.0)
        limits = (np.nan,) * 3 if name in CEILINGS else (0.2, 0.5, 0.8)
        rates = "  ".join(f"{false_per_km(outcome, s) if s == s else s:5.2f}" for s in limits)
        low, high = bootstrap(outcome, average_precision, 100)
        line = f"{name:22s} {rates}   {average_precision(outcome):.3f} ({low:.2f}-{high:.2f})"
        if own["hits"]:
            line += "   " + " ".join(f"{x:5.2f}" for x in own["own"]) + "      " + " ".join(
                f"{x:5.2f}" for x in own["whole"])  # fmt: skip
            line += f"       {own['own_inside']:5.1f}   {own['whole_inside']:5.1f}   {own['half']:5.2f}    "
            line += f"({everything['own_inside']:.1f}, {everything['whole_inside']:.1f})"
        print(line)
    print("\ncalibration: stated -> true (count)")
    for name, outcome in results.items():
        if name in CEILINGS:  # its scores are no probabilities
            continue
        table, error = calibration(outcome)
        _, wide = calibration(outcome, 0.05)
        words = " ".join(f"{stated:.2f}->{true:.2f} ({count})" for _, _, count, stated, true in table if count)
        print(f"{name:22s} expected calibration error {error:.3f} (from 0.05 on {wide:.3f}): {words}", flush=True)


def main():
    """Run and print."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--keep", type=Path, required=True, help="folder of the runs")
    words.add_argument("--detector", default="auto", help="names with commas between, or all")
    words.add_argument("--setting", choices=tuple(SETTINGS), default="usual")
    words.add_argument("--seeds", default="0-39")
    words.add_argument("--threshold", type=Path, help="JSON file with a score for each detector")
    words.add_argument("--list", action="store_true", help="misses and false alarms, run by run")
    words.add_argument("--ceiling", action="store_true")
    words.add_argument("--results", type=Path, help="file of outcomes, to go on with or to print again later")
    words.add_argument("--out", type=Path, help="write the scores at 1 FA/km, for --threshold on other seeds")
    told = words.parse_args()
    first, _, last = told.seeds.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    names = ["auto", *DETECTORS] if told.detector == "all" else [x for x in told.detector.split(",") if x]
    kept = Kept(told.results)
    results = {name: searched(name, told.setting, seeds, told.keep, told.list, kept) for name in names}
    if told.ceiling:
        for name in CEILINGS:
            results[name] = truth_told(name, told.setting, seeds, kept)
    fixed = json.loads(told.threshold.read_text()) if told.threshold else None
    print_tables(results, fixed)
    if told.out:
        told.out.write_text(json.dumps({name: threshold_at(outcome, 1.0) for name, outcome in results.items()}))


if __name__ == "__main__":
    main()
