"""Does cleaning help the search for leaks? The pass and the detector over raw and over cleaned sound of the same runs.

python tests/benchmarks/bench_cleaning_leaks.py [FIRST_SEED] [RUNS]

Runs of the usual kind, as they are and with rolling lines added. Each row: the leak's own level, the score of the
candidate at its place from the raw and from the cleaned sound; below, how many false candidates came with each.
"""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import soundfile

from processing.settings import CleaningSettings, DetectorSettings, SoundSettings
from processing.simulation.leak_trials import leaky_main
from processing.simulation.run import simulate
from processing.simulation.scenario import RollingLine
from processing.simulation.sound import sound_blocks
from processing.sound.candidates import find_candidates
from processing.sound.cells import frames_of
from processing.sound.cleaning import CleanReader, learn_cleaning
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import Track

ORDERS = (2, 7, 18, 36, 54, 72, 96, 144, 200, 288)
OVER_ROLLING_DB = -12.0  # of each line against all of the rolling noise


def with_lines(scenario):
    level = scenario.sound.rolling_dbfs + OVER_ROLLING_DB
    lines = tuple(RollingLine(float(order), level) for order in ORDERS)
    return replace(scenario, sound=replace(scenario.sound, rolling_lines=lines))


def track_of(run):
    motion, every = run.motion, slice(None, None, 10)
    place = motion.chainage_m[every]
    flat = np.zeros(len(place))
    return Track(
        motion.time_s[every], place, np.column_stack([place, flat, flat]), flat + 0.1, flat + 0.1, flat + 0.1,
        np.tile([1.0, 0, 0, 0], (len(flat), 1)), motion.speed_mps[every], "truth",
    )  # fmt: skip


def found_in(scanned, run, track):
    heard = find_candidates(scanned, run.clock, track, run.survey, DetectorSettings(min_score=0.0), imu=run.imu)
    return heard.candidates


def scores(candidates, leaks):
    """Return the best score at each leak's place, and the scores of what is at none."""
    near = {leak.name: max(5.0, 2 * leak.half_width_m) for leak in leaks}
    best = dict.fromkeys(near, 0.0)
    false = []
    for candidate in candidates:
        at = [leak.name for leak in leaks if abs(candidate.chainage_m - leak.chainage_m) < near[leak.name]]
        for name in at:
            best[name] = max(best[name], candidate.score)
        if not at:
            false.append(candidate.score)
    return best, np.array(false)


def written(path, rate, blocks):
    with soundfile.SoundFile(path, "w", rate, 1, "FLOAT") as file:
        for block in blocks:
            file.write(block)
    return open_audio([path])[0]


def compare(seed, name, scenario, folder):
    run = simulate(scenario, seed)
    track, rate = track_of(run), run.sound.rate_hz
    raw = written(folder / "raw.wav", rate, sound_blocks(run.sound))
    scanned = scan(raw, SoundSettings(), out_dir=folder / "scan-raw", threads=1)
    before = scores(found_in(scanned, run, track), run.leaks)
    frames = frames_of(scanned, run.clock, track, (), DetectorSettings())
    context = learn_cleaning(raw, run.imu, scanned, frames, run.clock, CleaningSettings())
    with CleanReader(raw, context) as reader:
        blocks = (reader.read(at, 1 << 18) for at in range(0, raw.frames, 1 << 18))
        clean = written(folder / "clean.wav", rate, blocks)
    cleaned = scan(clean, SoundSettings(), out_dir=folder / "scan-clean", threads=1)
    after = scores(found_in(cleaned, run, track), run.leaks)
    for leak in sorted(run.leaks, key=lambda leak: -leak.snr_db):
        print(f"  {leak.snr_db:+5.1f} dB  raw {before[0][leak.name]:.2f}  cleaned {after[0][leak.name]:.2f}")
    counts = "  ".join(
        f">= {limit}: raw {np.sum(before[1] >= limit)}, cleaned {np.sum(after[1] >= limit)}"
        for limit in (0.2, 0.5, 0.8)
    )
    lines = len(context.lines.orders)
    print(f"seed {seed} {name}: false candidates {counts}; lines {lines}", flush=True)
    return [(leak.snr_db, before[0][leak.name], after[0][leak.name]) for leak in run.leaks]


def main():
    first = int(sys.argv[1]) if len(sys.argv) > 1 else 700
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 2
    rows = {"usual": [], "with lines": []}
    for seed in range(first, first + count):
        for name, scenario in (("usual", leaky_main(seed)), ("with lines", with_lines(leaky_main(seed)))):
            with tempfile.TemporaryDirectory() as folder:
                rows[name] += compare(seed, name, scenario, Path(folder))
    for name, found in rows.items():
        table = np.array(found)
        for low, high in ((1.0, 99.0), (-4.0, 1.0), (-99.0, -4.0)):
            part = table[(table[:, 0] > low) & (table[:, 0] <= high)]
            if len(part):
                raw, clean = (np.mean(part[:, column] >= 0.5) for column in (1, 2))
                span = f"{name}, {low:g} to {high:g} dB, {len(part)} leaks"
                print(f"{span}: found at >= 0.5 raw {raw:.2f} cleaned {clean:.2f}")


if __name__ == "__main__":
    main()
