"""Kilometres of main with markers: error along and across, whether the intervals hold, and one marker that is wrong.

    python tests/benchmarks/mains.py [--seeds 200] [--keep FILE] [--jobs 1] [--map] [--wrong-only]

A run is :func:`processing.simulation.trials.random_main`: 1 km, MEMS gyro, 1 % slip wandering over 15 s, the radius
told 1 % wrong, launch heading told. It is reckoned once and fitted to each layout of markers:

- ``ends``: the retrieval alone; ``500``, ``250``: and a marker each 500 or 250 m;
- by ``chainage`` (each wrong by N(0, 0.5 m), and saying so), or by ``coordinates`` (likewise, east and north);
- with the mapped route (shifted as a whole by N(0, 0.5 m)), or without (``free``).

``wrong``: of the four markers at 250 m one, drawn at random, is 20 m off. *Found* is when its check is held down
or it is said to lie off the route; *alone* when no other is.

``best`` is the ceiling along the pipe: the same chainages with the true way of rolling, by Gaussian regression with the
true statistics of slip, radius and markers. No method that knows only the markers can be better on the mean.

Along: found less true chainage. Across: distance of the found place from the true one, square to the true pipe, level.
All moments in motion. *In a run* is the share of moments inside ±1.96 sigma; its spread shows how honest it is.
"""

import argparse
from dataclasses import replace

import numpy as np
from kept import Kept, common_words, run_all

from processing.orientation.registry import estimate_attitude
from processing.position.fitting import fit
from processing.position.registry import find_reckoned, problem_of
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.events import time_at_chainage
from processing.simulation.run import simulate
from processing.simulation.trials import random_main
from processing.survey import TiePoint

SIGMA_M, WRONG_M, SAMPLES = 0.5, 20.0, 400
SPACINGS = {"ends": 1000.0, "500": 500.0, "250": 250.0}
BINS = (0.5, 1.0, 1.645, 1.96, 2.576, 3.29)


def layouts_of(length_m, spacing_m, by, run, seed):
    """The markers as the crew has them: the retrieval is one of them."""
    rng = np.random.default_rng([seed, 5])  # the same errors whatever the layout
    ties = []
    for k in range(1, 5):
        chainage = length_m * k / 4
        error = rng.normal(0.0, SIGMA_M, 3)
        if chainage % spacing_m > 1e-3 and chainage % spacing_m < spacing_m - 1e-3:
            continue
        at = min(chainage, run.route.length_m - 1e-6)
        place = run.route.points(np.array([at])).position_w_m[0]
        told = {"chainage_m": chainage + error[0]}
        if by == "coordinates":
            told = {"east_m": place[0] + error[1], "north_m": place[1] + error[2]}
        ties.append(TiePoint(f"marker {k}", time_at_chainage(run.motion, at), sigma_m=SIGMA_M, **told))
    return tuple(ties)


def with_one_wrong(ties, seed):
    """Return the markers with one 20 m off, and its name."""
    rng = np.random.default_rng([seed, 6])
    k, sign, way = int(rng.integers(len(ties))), float(rng.choice([-1.0, 1.0])), float(rng.uniform(0, 2 * np.pi))
    tie = ties[k]
    if tie.chainage_m is not None:
        tie = replace(tie, chainage_m=tie.chainage_m + sign * WRONG_M)
    else:
        tie = replace(tie, east_m=tie.east_m + WRONG_M * np.cos(way), north_m=tie.north_m + WRONG_M * np.sin(way))
    return (*ties[:k], tie, *ties[k + 1 :]), tie.name


def figures_of(fitted, run):
    """Errors and normalised errors of a track at evenly spaced moments in motion."""
    track, motion = fitted.track, run.motion
    moving = np.interp(track.time_s, motion.time_s, motion.speed_mps) > 0.05
    rows = np.flatnonzero(moving)
    rows = rows[np.linspace(0, len(rows) - 1, SAMPLES).astype(int)]
    true_m = np.interp(track.time_s[rows], motion.time_s, motion.chainage_m)
    where = run.route.points(true_m)
    along = track.chainage_m[rows] - true_m
    off = (track.position_w_m[rows] - where.position_w_m)[:, :2]
    ahead = where.tangent_w[:, :2] / np.linalg.norm(where.tangent_w[:, :2], axis=1, keepdims=True)
    across = -off[:, 0] * ahead[:, 1] + off[:, 1] * ahead[:, 0]
    return {
        "along": np.round(along, 4).tolist(),
        "across": np.round(across, 4).tolist(),
        "sigma_along": np.round(track.sigma_along_m[rows], 4).tolist(),
        "sigma_across": np.round(track.sigma_cross_m[rows], 4).tolist(),
        "held": sorted({c.name for c in fitted.checks if c.held_down} | off_route(track)),
    }


def off_route(track):
    """Names of the markers that the track found far from the map: one moved across the pipe hardly moves the path."""
    return {str(f.params["name"]) for f in track.findings if f.code == "tie_off_route"}


def best_along(run, ties):
    """The optimal estimate of the chainage error and its sigma, knowing how slip, radius and markers err.

    With slip of correlation exp(-|u|/tau) the distance error has the covariance
    ``(sigma v tau)^2 (2 min/tau - 1 + e^(-t/tau) + e^(-t'/tau) - e^(-|t-t'|/tau))``.
    """
    ball, motion = run.scenario.ball, run.motion
    speed = run.scenario.drive.speed_mps
    start = float(motion.time_s[np.searchsorted(motion.chainage_m, 1e-6)])

    def covariance(a, b):
        s, t = np.maximum(a - start, 0.0)[:, None], np.maximum(b - start, 0.0)[None, :]
        tau = ball.slip_tau_s
        walk = 2 * np.minimum(s, t) / tau - 1 + np.exp(-s / tau) + np.exp(-t / tau) - np.exp(-np.abs(s - t) / tau)
        return (ball.slip_sigma * speed * tau) ** 2 * walk + (0.01 * speed) ** 2 * s * t

    def rolled(t):
        return np.interp(t, motion.time_s, motion.rotation_rad) * ball.told_radius_m

    at = np.array([tie.time_s for tie in ties])
    moving = motion.time_s[motion.speed_mps > 0.05]
    t = moving[np.linspace(0, len(moving) - 1, SAMPLES).astype(int)]
    gain = np.linalg.solve(covariance(at, at) + SIGMA_M**2 * np.eye(len(at)), covariance(at, t)).T
    told = np.array([tie.chainage_m for tie in ties])
    along = rolled(t) + gain @ (told - rolled(at)) - np.interp(t, motion.time_s, motion.chainage_m)
    variance = np.diag(covariance(t, t)) - np.sum(gain * covariance(t, at), axis=1)
    return {
        "along": np.round(along, 4).tolist(),
        "across": [0.0] * SAMPLES,
        "sigma_along": np.round(np.sqrt(np.maximum(variance, 0.0)), 4).tolist(),
        "sigma_across": [1.0] * SAMPLES,
        "held": [],
    }


class Main:
    """One main with all layouts: the work of a task ``(seed,)``."""

    def __init__(self, kinds, mapped, wrong_only, length_m):
        self.kinds, self.mapped, self.wrong_only, self.length_m = kinds, mapped, wrong_only, length_m

    def __call__(self, task):
        (seed,) = task
        run = simulate(random_main(seed, self.length_m), seed, quick=True)
        told = run.survey
        options = PositionSettings()
        attitude, _, _ = estimate_attitude(run.imu, told, OrientationSettings(), silent())
        reckoned = find_reckoned(run.imu, attitude, told, options)
        out = {}
        for name, spacing in SPACINGS.items():
            ties = layouts_of(self.length_m, spacing * self.length_m / 1000.0, "chainage", run, seed)
            out[f"chainage best {name}"] = best_along(run, ties)
        for mapped in self.mapped:
            survey = told if mapped else replace(told, route=None)
            problem = problem_of(reckoned, survey, options)
            for by in self.kinds:
                for name, spacing in SPACINGS.items():
                    ties = layouts_of(self.length_m, spacing * self.length_m / 1000.0, by, run, seed)
                    key = f"{by} {'mapped' if mapped else 'free'} {name}"
                    if not self.wrong_only:
                        out[key] = figures_of(fit(problem, replace(survey, tie_points=ties), options, silent()), run)
                    if name == "250":
                        ties, wrong = with_one_wrong(ties, seed)
                        fitted = fit(problem, replace(survey, tie_points=ties), options, silent())
                        out[key.replace("250", "wrong")] = figures_of(fitted, run) | {"wrong": wrong}
        return out


def said_of(result):
    """One run in a line."""
    words = []
    for key, row in result.items():
        by, mapped, name = key.split()
        along = np.percentile(np.abs(row["along"]), 95)
        words.append(f"{by[:2]}/{mapped[:1]}/{name} {along:.2f}")
    return " ".join(words)


def print_table(kept):
    """Print one line a layout."""
    runs = list(kept.rows.values())
    if not runs:
        return
    print(
        f"\n{len(runs)} runs                 along, m                     inside ±1.96 sigma, %        across, m    "
        "   inside, %\n"
        "                       median    p95   p95 of runs  worst    all   (runs: p5  median)   median    p95   "
        "all   (runs: p5)  sigma along/across"
    )
    for key in runs[0]:
        rows = [run[key] for run in runs if key in run]
        along, across = (np.array([r[n] for r in rows]) for n in ("along", "across"))
        sigma_along, sigma_across = (np.array([r[n] for r in rows]) for n in ("sigma_along", "sigma_across"))
        inside = np.abs(along) <= 1.96 * sigma_along
        inside_across = np.abs(across) <= 1.96 * sigma_across
        size, size_across = np.abs(along), np.abs(across)
        of_runs = np.percentile(size, 95, axis=1)
        low, middle = np.percentile(100 * inside.mean(axis=1), [5, 50])
        print(
            f"{key:22s} {np.median(size):6.2f} {np.percentile(size, 95):6.2f}  {np.median(of_runs):6.2f}      "
            f"{size.max():6.2f}   {100 * inside.mean():5.1f}  ({low:5.1f}  {middle:5.1f})     "
            f"{np.median(size_across):6.2f} {np.percentile(size_across, 95):6.2f}  {100 * inside_across.mean():5.1f}  "
            f"({np.percentile(100 * inside_across.mean(axis=1), 5):5.1f})     "
            f"{np.median(sigma_along):5.2f} {np.median(sigma_across):5.2f}"
        )
    print_levels(runs)
    print_wrong(runs)
    print_summary(runs)


def print_levels(runs):
    """Print how many moments lie within so many sigma, against the normal distribution's shares."""
    from scipy.stats import norm

    print("\nwithin k sigma, %, k =  " + " ".join(f"{k:6.3f}" for k in BINS))
    print(f"{'normal':24s}" + " ".join(f"{100 * (2 * norm.cdf(k) - 1):6.1f}" for k in BINS))
    for key in runs[0]:
        for name in ("along",) if " best " in key else ("along", "across"):
            z = np.array([np.abs(r[key][name]) / np.maximum(r[key][f"sigma_{name}"], 1e-6) for r in runs])
            print(f"{key + ' ' + name:28s}"[:30] + " ".join(f"{100 * np.mean(z <= k):6.1f}" for k in BINS))


def print_wrong(runs):
    """Print how often the wrong marker was found."""
    print("\none of four markers 20 m off       found, %   alone, %   false alarms with all right, %")
    for key in (k for k in runs[0] if k.endswith("wrong")):
        rows = [run[key] for run in runs]
        found = np.mean([r["wrong"] in r["held"] for r in rows])
        alone = np.mean([r["held"] == [r["wrong"]] for r in rows])
        right = [run[key.replace("wrong", "250")] for run in runs if key.replace("wrong", "250") in run]
        false = np.mean([bool(r["held"]) for r in right]) if right else float("nan")
        print(f"{key:32s} {100 * found:8.1f} {100 * alone:10.1f} {100 * false:10.1f}", flush=True)


def print_summary(runs):
    """Print what the acceptance list asks for, kind by kind."""
    print("\nsummary, targets: 250 m 95 % <= 1 m, 500 m <= 2 m, ends <= 3 m; coverage 92 to 98 %; wrong found >= 95 %")
    for kind in sorted({key.rpartition(" ")[0] for key in runs[0]}):
        words = []
        for name in ("250", "500", "ends"):
            rows = [run[f"{kind} {name}"] for run in runs if f"{kind} {name}" in run]
            if not rows:
                continue
            along, across = (np.abs([r[n] for r in rows]) for n in ("along", "across"))
            shares = [
                100 * np.mean(error <= 1.96 * np.array([r[n] for r in rows]))
                for error, n in ((along, "sigma_along"), (across, "sigma_across"))
            ]
            cross = "" if "best" in kind else f"/{shares[1]:.1f}"
            words.append(f"{name}: {np.percentile(along, 95):.2f} m, {shares[0]:.1f}{cross} %")
        wrong = [run[f"{kind} wrong"] for run in runs if f"{kind} wrong" in run]
        if wrong:
            words.append(f"wrong: {100 * np.mean([r['wrong'] in r['held'] for r in wrong]):.1f} % found")
            words.append(f"then {np.percentile(np.abs([r['along'] for r in wrong]), 95):.2f} m")
        print(f"{kind:20s} " + "; ".join(words), flush=True)


def main():
    """Run and print."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    common_words(words)
    words.set_defaults(seeds=200)
    words.add_argument("--map", choices=("both", "mapped", "free"), default="both")
    words.add_argument("--by", choices=("both", "chainage", "coordinates"), default="both")
    words.add_argument("--wrong-only", action="store_true", help="only with one wrong marker")
    words.add_argument("--length", type=float, default=1000.0)
    told = words.parse_args()
    kept = Kept(told.keep)
    kinds = ("chainage", "coordinates") if told.by == "both" else (told.by,)
    mapped = {"both": (False, True), "mapped": (True,), "free": (False,)}[told.map]
    tasks = [(seed,) for seed in range(told.first, told.first + told.seeds)]
    run_all(tasks, Main(kinds, mapped, told.wrong_only, told.length), kept, told.jobs, said_of)
    print_table(kept)


if __name__ == "__main__":
    main()
