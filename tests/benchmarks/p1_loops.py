"""P1's fourteen rolling loops under MEMS noise: end error of every estimator, beside what no filter can beat.

    python tests/benchmarks/p1_loops.py [--seeds 20] [--methods auto,eskf] [--loops 1,4] [--keep FILE] [--jobs 1]

The noise is that of :mod:`processing.simulation.trials`. The path is free: no length, no tie point, no closed loop.
The error is the distance between found and true end, in per cent of the way; as the true loop is closed this is the
distance between end and start. Filters take accelerometer and gyro, as in the paper; ``auto+mag`` may use the
magnetometer. Besides them:

- ``(truth)`` has the true attitude and the true rates: what remains is slip, which no attitude can mend;
- ``(plain vqf)`` is the public VQF, forward, as it comes, with its own rates and ``v = r (ω × z)``.

Published for real balls: device 0.948, Madgwick 0.817, Mahony 0.780 %.

``--without each`` tells what the rest is due to: the same runs with one of the sensor's errors taken away.

Then the same loops, but ending 2 m before their start: the found gap, and how often the interval holds the true end.
"""

import argparse
from dataclasses import replace

import numpy as np
from kept import Kept, common_words, run_all

from processing.orientation import quaternions as qt
from processing.orientation.registry import ESTIMATORS, estimate_attitude
from processing.position.registry import find_track
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.papers import P1_LOOPS
from processing.simulation.run import simulate
from processing.simulation.trials import mems_loop
from processing.survey import Attitude, DeviceInfo, Launch, ProcessingChoice, Survey

SHORT_M = 2.0
ERRORS = {
    "noise": {"gyro_noise": 0.0},
    "flicker": {"gyro_instability_radps": 0.0},
    "turn-on": {"gyro_bias_sigma_radps": 0.0},
    "scale": {"gyro_scale_range": (0.0, 0.0)},
    "axes": {"gyro_misalignment_range_rad": (0.0, 0.0)},
    "g": {"gyro_g_sensitivity": 0.0},
    "earth": {"latitude_deg": None},
    "accelerometer": {"acc_noise": 0.0, "acc_bias_sigma_mps2": 0.0, "acc_walk": 0.0, "acc_scale_sigma": 0.0,
                      "acc_misalignment_sigma_rad": 0.0},
    "stamps": {"stamp_jitter_s": 0.0},
}  # fmt: skip
IDEAL = ("(truth)", "(plain vqf)")


def methods_of(wanted):
    """Return the names of all methods, or those wanted."""
    if wanted:
        return tuple(wanted.split(","))
    return (*IDEAL, "auto", "auto+mag", *(row.name for row in ESTIMATORS if not row.needs_field))


def survey_of(run, method):
    """What is told: launch heading and radius, nothing else."""
    return Survey(
        launch=Launch(heading_deg=run.survey.launch.heading_deg),
        device=DeviceInfo(radius_m=run.scenario.ball.radius_m),
        processing=ProcessingChoice(orientation="auto" if method.startswith(("auto", "(")) else method),
    )


def attitude_of(run, method):
    """The attitude by one of our estimators, or the true one."""
    if method == "(truth)":
        return Attitude(run.motion.quat_ws, run.imu.gyr_s_radps - run.motion.gyr_s_radps, "truth")
    options = OrientationSettings(magnetometer="auto" if method.endswith("+mag") else "ignore")
    return estimate_attitude(run.imu, survey_of(run, method), options, silent())[0]


def plain_vqf_path(run):
    """The public VQF on the log as it is, and r (ω × z) of its turning."""
    from vqf import VQF

    filter_ = VQF(1.0 / run.scenario.imu.rate_hz)
    gyr, acc = (np.ascontiguousarray(a) for a in (run.imu.gyr_s_radps, run.imu.acc_s_mps2))
    quat = filter_.updateBatch(gyr, acc)["quat6D"]
    turns_w = qt.log_map(qt.multiply(quat[1:], qt.conjugate(quat[:-1])))
    steps = run.scenario.ball.radius_m * np.column_stack([turns_w[:, 1], -turns_w[:, 0]])
    moving = run.motion.speed_mps[1:] > 0.0  # as every method that knows a rest
    way = np.cumsum(steps * moving[:, None], axis=0)
    # its heading is arbitrary: as launched
    early = int(np.searchsorted(run.motion.chainage_m, 1.0))
    true = run.motion.position_w_m[early] - run.motion.position_w_m[0]
    turn = np.arctan2(true[1], true[0]) - np.arctan2(way[early, 1], way[early, 0])
    cos, sin = np.cos(turn), np.sin(turn)
    return way @ np.array([[cos, sin], [-sin, cos]])


def end_of(run, method):
    """Return the found end seen from the start, and its covariance (None where there is none)."""
    if method == "(plain vqf)":
        return plain_vqf_path(run)[-1], None
    track = find_track(run.imu, attitude_of(run, method), survey_of(run, method), PositionSettings())
    along, cross = track.sigma_along_m[-1], track.sigma_cross_m[-1]
    level = getattr(track, "cov_level_m2", None)
    if level is not None:
        (ee, en, nn) = level[-1]
        covariance = np.array([[ee, en], [en, nn]])
    else:
        ahead = track.position_w_m[-1, :2] - track.position_w_m[-40, :2]
        ahead /= max(np.linalg.norm(ahead), 1e-9)
        aside = np.array([-ahead[1], ahead[0]])
        covariance = along**2 * np.outer(ahead, ahead) + cross**2 * np.outer(aside, aside)
    return (track.position_w_m[-1] - track.position_w_m[0])[:2], covariance


class Loop:
    """One loop and seed with all methods: the work of one task ``(number, seed)``."""

    def __init__(self, methods, short_m):
        self.methods, self.short_m = methods, short_m

    def __call__(self, task):
        number, seed, kind = task
        scenario = mems_loop(number, self.short_m)
        changes = ERRORS.get(kind.removeprefix("without "), {})
        run = simulate(replace(scenario, imu=replace(scenario.imu, **changes)), seed, quick=True)
        true = (run.motion.position_w_m[-1] - run.motion.position_w_m[0])[:2]
        out = {}
        for method in self.methods:
            end, covariance = end_of(run, method)
            miss = end - true
            square = None if covariance is None else float(miss @ np.linalg.solve(covariance, miss))
            out[method] = [float(miss[0]), float(miss[1]), float(np.hypot(*end)), square]
        return out


def pct(result, number, method):
    """End error in per cent of the way."""
    return 100.0 * float(np.hypot(*result[method][:2])) / P1_LOOPS[number][2]


def print_table(kept, methods, loops, kind):
    """Print mean end errors loop by loop, then mean, 95th percentile and coverage of all runs."""
    width = max(len(m) for m in methods)
    runs = {key: row for key, row in kept.rows.items() if key[2] == kind and key[0] in loops}
    print(f"\nmean end error, % of the way, {len(runs)} runs\n{'':{width}} " + " ".join(f"{n:6d}" for n in loops))
    summary, means = [], {}
    for method in methods:
        rows = {n: [pct(r, n, method) for (number, _, _), r in runs.items() if number == n] for n in loops}
        every = np.array([e for errors in rows.values() for e in errors])
        if not len(every):
            continue
        print(f"{method:{width}} " + " ".join(f"{np.mean(rows[n]):6.3f}" if rows[n] else "     -" for n in loops))
        means[method] = every.mean()
        # what the method adds to the slip that no attitude can mend
        beyond = [
            100.0 * float(np.hypot(*np.subtract(r[method][:2], r["(truth)"][:2]))) / P1_LOOPS[n][2]
            for (n, _, _), r in runs.items()
            if "(truth)" in r
        ]
        squares = [r[method][3] for r in runs.values() if r[method][3] is not None]
        held = f"{np.mean(np.array(squares) <= 5.991):8.1%}" if squares else "       -"
        summary.append(
            f"{method:{width}} {every.mean():7.3f} {np.median(every):7.3f} {np.percentile(every, 95):7.3f} "
            f"{np.mean(beyond) if beyond else float('nan'):9.3f} {held}"
        )
    print(f"\n{'':{width}}    mean  median     p95  without slip  95 % ellipse holds   (%, all runs)")
    print("\n".join(summary))
    said = {
        "auto": "auto {:.3f} % (target 0.25)",
        "(truth)": "slip alone {:.3f} %",
        "(plain vqf)": "plain VQF {:.3f} %",
    }
    line = ", ".join(text.format(means[m]) for m, text in said.items() if m in means)
    print(f"summary: {line}; best {min(means, key=means.get, default='none')}", flush=True)


def print_gaps(kept, methods):
    """Print how far from the start the path that ends 2 m short was found to end."""
    runs = [row for key, row in kept.rows.items() if key[2] == "short"]
    width = max(len(m) for m in methods)
    print(f"\na path that ends {SHORT_M:g} m short of its start, {len(runs)} runs: found gap, m")
    print(f"{'':{width}}    mean      p5     p95   95 % ellipse holds the true end")
    for method in methods:
        gaps = [r[method][2] for r in runs if method in r]
        squares = [r[method][3] for r in runs if method in r and r[method][3] is not None]
        if gaps:
            low, high = np.percentile(gaps, [5, 95])
            held = f"{np.mean(np.array(squares) <= 5.991):8.1%}" if squares else "-"
            print(f"{method:{width}} {np.mean(gaps):7.3f} {low:7.3f} {high:7.3f}   {held}", flush=True)


def main():
    """Run and print."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    common_words(words)
    words.add_argument("--methods", help="names, separated by commas; all by default")
    words.add_argument("--loops", help="numbers, separated by commas; all by default")
    words.add_argument("--short-seeds", type=int, help="seeds for the paths that end 2 m short; as --seeds by default")
    words.add_argument("--without", choices=(*ERRORS, "each"), help="take an error of the sensor away")
    told = words.parse_args()
    methods = methods_of(told.methods)
    loops = [int(n) for n in told.loops.split(",")] if told.loops else list(P1_LOOPS)
    kept = Kept(told.keep)

    def said(result):
        return " ".join(f"{m} {100 * np.hypot(*r[:2]):.0f} cm" for m, r in result.items())

    seeds = range(told.first, told.first + told.seeds)
    if told.without:
        for name in ERRORS if told.without == "each" else (told.without,):
            kind = f"without {name}"
            run_all([(n, s, kind) for s in seeds for n in loops], Loop(methods, 0.0), kept, told.jobs, said)
            print(f"\n{kind}:")
            print_table(kept, methods, loops, kind)
        return
    run_all([(n, s, "loop") for s in seeds for n in loops], Loop(methods, 0.0), kept, told.jobs, said)
    print_table(kept, methods, loops, "loop")
    count = told.seeds if told.short_seeds is None else told.short_seeds
    some = tuple(m for m in methods if m in ("(truth)", "auto")) or methods
    short = [(n, s, "short") for s in range(told.first, told.first + count) for n in loops]
    run_all(short, Loop(some, SHORT_M), kept, told.jobs, said)
    print_gaps(kept, some)


if __name__ == "__main__":
    main()
