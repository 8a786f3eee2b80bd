"""What real recordings show band by band, and whether a real leak is found when the device passes it.

    python tests/benchmarks/real_recordings.py --data SHARED_DATA [--keep DIR] [--detector auto]

The first part prints the levels of ``hydrophone_pvc`` (four leaks, one quiet pipe) and ``pipesound`` per band, second
by second: median, and how often a second of the leak is louder than a second of the quiet pipe (0.5: no telling apart).
With ``--keep`` the second part mixes each leak recording into simulated passings and searches for it; as background
flow noise of the simulator, or the recorded quiet pipe and recorded wind on top of it; ``limited`` holds the
recordings' knocks down to 3 dB above their median.

What can be concluded from the recordings, and what cannot:

- There is one recording of some 36 s for each leak and one of the quiet pipe. Whatever differs may be the leak, or the
  day: nothing here tells the two apart. The halves of the quiet recording agree within 0.4 dB from 100 to 800 Hz, so
  differences of 2 dB there are real differences between recordings, not chance within them.
- Below 100 Hz lies 99.9 % of the energy, of the rig. Overall the quiet pipe is louder than three of the four leaks.
- From 100 to 400 Hz the orifice leak is 2 to 2.7 dB louder than the quiet pipe in nearly every second, the
  circumferential crack 1.6 dB at 100–200 Hz; the longitudinal crack is 3 dB quieter, the gasket leak 4 dB quieter at
  200–400 Hz. No sign holds for all leaks.
- Above 800 Hz the level changes by 11 to 25 dB from second to second, in the quiet pipe too: knocks, not hissing. The
  mean levels there (+3 to +7 dB for leaks) are those of some knocks; by the median second, leaks lie between −4 and
  +4 dB, and a second of a leak is louder than one of the quiet pipe in 25 to 71 of 100 pairs. There is no broadband
  hiss in these recordings that a detector could be shown to work on, nor one that it could be tuned by.
- So a recording mixed into a passing shows that the detector finds what a hydrophone really hears, with its knocks and
  its colour, where it rises and falls along the pipe. It does not show that a leak rises and falls so.
- In ``pipesound`` an event and a disturbance of the same tap stand out alike, by 15 to 21 dB at 400 Hz to 3 kHz, from
  ten backgrounds that agree within 0.5 dB there: a band level says that something happens, not what.
"""

import argparse
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers"))

import soundfile as sf
from leak_figures import matched_rows
from leak_runs import SETTINGS, trial
from mixed_leaks import Mixed, MixedLeak, high_passed, limited, recording
from scipy import signal

from processing.settings import DetectorSettings
from processing.sound.candidates import find_candidates

EDGES_HZ = (20, 50, 100, 200, 400, 800, 1600, 3200, 4000)
KINDS = ("circumferential-crack", "gasket-leak", "longitudinal-crack", "orifice-leak")
SNRS_DB = (12.0, 6.0, 2.0, -2.0, -6.0)
WIDTHS_M = (1.0, 2.5)
RATE = 44100


def seconds_db(path):
    """Return (seconds, bands) the level of each second of a recording in each band, dB of full scale."""
    x, rate = sf.read(path, always_2d=True)
    x = x[:, 0] - x[:, 0].mean()
    rows = []
    for second in x[: len(x) // rate * rate].reshape(-1, rate):
        f, p = signal.welch(second, rate, nperseg=min(4096, rate // 2))
        step = f[1] - f[0]
        rows.append([p[(f >= a) & (f < b)].sum() * step for a, b in pairwise(EDGES_HZ)])
    return 10 * np.log10(np.array(rows) + 1e-20)


def louder_share(a, b):
    """Return the share of pairs in which a second of ``a`` is louder than one of ``b``."""
    return float(np.mean(a[:, None] > b[None, :]))


def print_hydrophone(folder):
    """Print leaks against the quiet pipe, and the quiet pipe's halves against each other."""
    quiet = seconds_db(folder / "no-leak.wav")
    print("hydrophone_pvc, Hz          " + "".join(f"{f'{a}-{b}':>12s}" for a, b in pairwise(EDGES_HZ)))
    print(f"{'quiet pipe, dBFS':28s}" + "".join(f"{x:12.1f}" for x in np.median(quiet, axis=0)))
    low, high = np.percentile(quiet, [5, 95], axis=0)
    print(f"{'  its 5 to 95 % spread, dB':28s}" + "".join(f"{x:12.1f}" for x in high - low))
    half = len(quiet) // 2
    halves = np.median(quiet[:half], axis=0) - np.median(quiet[half:], axis=0)
    print(f"{'  first less second half, dB':28s}" + "".join(f"{x:12.1f}" for x in halves))
    for kind in KINDS:
        leak = seconds_db(folder / f"{kind}.wav")
        more = np.median(leak, axis=0) - np.median(quiet, axis=0)
        share = [louder_share(leak[:, k], quiet[:, k]) for k in range(leak.shape[1])]
        spread = np.subtract(*np.percentile(leak, [95, 5], axis=0))
        print(f"{kind + ', dB above':28s}" + "".join(f"{x:12.1f}" for x in more))
        print(f"{'  louder, share of seconds':28s}" + "".join(f"{x:12.2f}" for x in share))
        print(f"{'  its 5 to 95 % spread, dB':28s}" + "".join(f"{x:12.1f}" for x in spread))


def print_pipesound(folder):
    """Print events and disturbances of a tap's soundbank against its backgrounds."""
    backgrounds = sorted(folder.rglob("background.wav"))
    levels = np.array([np.median(seconds_db(path), axis=0) for path in backgrounds])
    print(f"\npipesound, {len(backgrounds)} backgrounds of one tap (every file is scaled to full scale on its own)")
    print(f"{'median of backgrounds, dBFS':28s}" + "".join(f"{x:12.1f}" for x in np.median(levels, axis=0)))
    print(f"{'  from file to file, dB':28s}" + "".join(f"{x:12.1f}" for x in np.ptp(levels, axis=0)))
    for path in sorted(folder.rglob("*_unfiltered.wav")):
        more = np.median(seconds_db(path), axis=0) - np.median(levels, axis=0)
        name = path.parent.name.lower()
        print(f"{name + ', dB above':28s}" + "".join(f"{x:12.1f}" for x in more))


def mixed_of(data, snr_db, places, noises, knocks):
    """Return what is mixed in: each recording at each width once, in a fixed order along the pipe."""
    names = {kind: data / f"hydrophone_pvc/{kind}.wav" for kind in (*KINDS, "no-leak")}
    names["wind"] = data / "ambient/wind.ogg"
    used = {*KINDS, *(name for name, _, _ in noises)}
    recordings = {name: recording(path, RATE) for name, path in names.items() if name in used}
    if not knocks:
        recordings = {name: limited(high_passed(x, RATE), RATE) for name, x in recordings.items()}
    pairs = [(kind, width) for width in WIDTHS_M for kind in KINDS]
    leaks = [MixedLeak(kind, float(at), width, snr_db) for (kind, width), at in zip(pairs, places)]
    return Mixed(leaks, recordings, noises)


def print_mixed(data, keep, detector, seeds):
    """Print, for each SNR and background, how many are found, with which score and apex error."""
    real = (("no-leak", 0.0, 150.0), ("wind", -6.0, 100.0))
    backgrounds = {"simulated": ((), True), "recorded": (real, True), "limited": ((), False)}
    print("\nreal leaks passed, each recording at half-widths 1 and 2.5 m; SNR in 800–3200 Hz by the steady part")
    print(
        "background   SNR   score >= 0.2  >= 0.5   apex error of >= 0.2, m: median  p95   FA/km >= 0.5   by recording"
    )
    real = (("no-leak", 0.0, 150.0), ("wind", -6.0, 100.0))
    backgrounds = {"simulated": ((), True), "recorded": (real, True), "limited": ((), False)}
    print("\nreal leaks passed, each recording at half-widths 1 and 2.5 m; SNR in 800–3200 Hz by the steady part")
    print(
        "background   SNR   found at >= 0.5    score median   apex error m: median  p95    FA/km >= 0.5   by recording"
    )
    for background, (noises, knocks) in backgrounds.items():
        for snr_db in SNRS_DB:
            scores, errors, false, length = {}, [], 0, 0.0
            for seed in seeds:
                scenario = SETTINGS["quiet"](seed)
                end = scenario.route.length_m - 15.0
                mixed = mixed_of(data, snr_db, np.linspace(18.0, end, 2 * len(KINDS)), noises, knocks)
                run = trial("quiet", seed, keep, mixed, f"real-{background}-{snr_db:+.0f}-{seed}")
                got = find_candidates(run.scan, run.clock, run.track, run.survey_for(detector),
                                      DetectorSettings(min_score=0.001), imu=run.imu).candidates  # fmt: skip
                rows = matched_rows(0, run.leaks, got)
                best = {row.leak: row for row in rows if row.leak >= 0}
                for i, leak in enumerate(run.leaks):
                    score = best[i].score if i in best else 0.0
                    scores.setdefault(leak.name.split()[0], []).append(score)
                    errors += [abs(best[i].own_error_m)] if score >= 0.2 else []
                false += sum(row.leak < 0 and row.score >= 0.5 for row in rows)
                length += run.length_m
            everything = [score for each in scores.values() for score in each]
            words = ", ".join(f"{kind} {sum(x >= 0.2 for x in each)}/{len(each)}" for kind, each in scores.items())
            middle, high = np.percentile(errors, [50, 95]) if errors else (np.nan, np.nan)
            listed, taken = (sum(x >= limit for x in everything) for limit in (0.2, 0.5))
            print(f"{background:10s} {snr_db:+5.0f}   {listed:3d} of {len(everything):2d}    {taken:3d} of "
                  f"{len(everything):2d}   {middle:20.2f} {high:11.2f}   {1000 * false / length:9.2f}      {words}",
                  flush=True)  # fmt: skip


def main():
    """Print both parts."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--data", type=Path, required=True, help="folder with hydrophone_pvc, pipesound and ambient")
    words.add_argument("--keep", type=Path, help="folder of the runs; without it only levels are printed")
    words.add_argument("--detector", default="auto")
    words.add_argument("--seeds", default="5000-5001")
    told = words.parse_args()
    print_hydrophone(told.data / "hydrophone_pvc")
    print_pipesound(told.data / "pipesound")
    if told.keep:
        first, _, last = told.seeds.partition("-")
        print_mixed(told.data, told.keep, told.detector, range(int(first), int(last or first) + 1))


if __name__ == "__main__":
    main()
