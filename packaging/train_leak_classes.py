#!/usr/bin/env python3
"""Trains the model that tells a leak from what sounds like one, on simulated mains, and writes it as readable JSON.

    python packaging/train_leak_classes.py gather usual 5000 5060 ROWS.json   # simulates, listens, measures
    python packaging/train_leak_classes.py fit ROWS.json resources/leak_classes/model.json
    python packaging/train_leak_classes.py check resources/leak_classes/model.json ROWS.json [ROWS.json ...]

``gather`` takes mains of :mod:`processing.simulation.leak_trials` (``usual``, or ``other`` for checking only: nothing
of it may be trained on) at 16 kHz with their true path, runs the detector in metres down to a score of LOW_SCORE, and
measures the figures of :mod:`processing.sound.place_features` at each spot, and at each valve, bend, air pocket,
passing car, pump and some joints whether the detector minded them or not, in the band and width of a usual leak.

``fit``: bins with the borders EDGES; p(bin | class) by counting, smoothed towards all classes' share; figures'
weights (0..1) by the greatest likelihood of leak or not, over the detector's own spots, the detector's probability
being the prior, and, counting NAMING as much, of which false source it was. Figures that the simulation cannot teach
are STATED below, with their reason.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.survey import LeakClass

CLASSES = [c.value for c in LeakClass]
LOW_SCORE = 0.02
RATE_HZ = 16_000
SMOOTHING = 4.0  # rows that each class has before it has any
USUAL_LEAK = (1.5, (700.0, 2800.0))
AROUND_LEAK_M = 6.0
NAMING = 0.15

# borders of the bins: round figures that part what differs, never finer than the figure repeats from place to place
EDGES = {
    "rumble_db": [-6.0, -3.0, -1.0, 1.0, 3.0],
    "flutter": [-0.1, 0.1, 0.25, 0.4, 0.7, 1.0],
    "impulsive_share": [0.1, 0.25, 0.5],
    "knock": [1.0, 4.5],
    "joint_m": [0.3, 0.8],
    "turn_deg": [8.0, 20.0],
    "tones_db": [0.08, 0.2],
    "tones_s": [60.0, 180.0],
    "place_not_moment": [-0.1, -0.03, 0.03, 0.1],
    "width_m": [0.4, 0.8, 1.5, 2.5, 4.0, 7.0],
    "peak_hz": [250.0, 450.0, 800.0, 1200.0, 1800.0, 2600.0],
    "spread_octaves": [0.6, 0.9, 1.2, 1.5],
    "lopsided": [-1.5, -0.6, 0.6, 1.5],
    "speed_ratio": [-0.2, -0.07, 0.07, 0.2],
}
# p of the bins, the reason with each
STATED = {
    "valve_m": {
        "edges": [2.0, 5.0],
        "p": {"valve": [0.75, 0.2, 0.05], "": [0.02, 0.03, 0.95]},
        "why": "a valve stands within the doubt of path and map from its name; anything else is there by chance, "
        "one named valve in some 200 m",
    },
}


def gather(kind: str, seeds: range, out: Path) -> None:
    """Write the rows of these mains."""
    rows: list[dict[str, object]] = []
    for seed in seeds:
        rows += rows_of(kind, seed)
        print(kind, seed, len(rows), flush=True)
        out.write_text(json.dumps(rows), encoding="utf-8")


def rows_of(kind: str, seed: int) -> list[dict[str, object]]:
    """Return a row for each spot and each false source of one main."""
    import soundfile

    from processing.settings import SoundSettings
    from processing.simulation.leak_trials import leaky_main, other_main
    from processing.simulation.run import simulate
    from processing.simulation.sound import sound_blocks
    from processing.sound.scan import scan
    from processing.sound.source import open_audio

    scenario = (leaky_main if kind == "usual" else other_main)(seed)
    run = simulate(replace(scenario, sound=replace(scenario.sound, rate_hz=RATE_HZ)), seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "audio.wav"
        with soundfile.SoundFile(path, "w", RATE_HZ, 1, "PCM_16") as file:
            for block in sound_blocks(run.sound):
                file.write(block)
        source, _ = open_audio([path])
        heard = scan(source, SoundSettings(), out_dir=Path(folder) / "scan", threads=1)
        return measured(run, heard, kind, seed)


def measured(run, heard, kind: str, seed: int) -> list[dict[str, object]]:  # noqa: ANN001  # SimulatedRun, SoundScan
    """Return the rows of one simulated run that was scanned."""
    from processing.settings import DetectorSettings
    from processing.sound.candidates import find_candidates
    from processing.sound.cells import frames_of
    from processing.sound.ground import ground_of
    from processing.sound.place_features import features_at
    from processing.survey import Survey, Track

    m, few = run.motion, slice(None, None, 5)
    sigma = np.full(len(m.time_s[few]), 0.1)
    track = Track(
        m.time_s[few], np.maximum.accumulate(m.chainage_m[few]), m.position_w_m[few], sigma, sigma, sigma,
        m.quat_ws[few], m.speed_mps[few], "truth",
    )  # fmt: skip
    settings = replace(DetectorSettings(), min_score=LOW_SCORE)
    found = find_candidates(heard, run.clock, track, Survey(), settings, imu=run.imu)
    rows: list[dict[str, object]] = []
    for c in found.candidates:
        figures = {name: value for name, value in c.evidence.items() if isinstance(value, float)}
        label = label_of(run, c.chainage_m, c.time_s, c.width_m, figures.get("impulsive_share", 0.0))
        rows.append({"kind": kind, "seed": seed, "label": label, "p": figures["heard_score"], "figures": figures})
    ground = ground_of(
        heard, frames_of(heard, run.clock, track, (), settings), track, run.imu, Survey(), in_metres=True
    )
    width, band = USUAL_LEAK
    for label, place, own_width in false_sources(run, track):
        figures = features_at(ground, place, own_width or width, band)
        figures["width_m"] = float("nan")  # it is ours, not the sound's
        rows.append({"kind": kind, "seed": seed, "label": label, "p": None, "figures": figures})
    return rows


def label_of(run, place: float, time_s: float, width: float, impulsive: float) -> str:  # noqa: ANN001
    """Return what really is at a spot; ``near`` where it may be the flank of a leak."""
    own = [(p.kind.value, abs(p.chainage_m - place), p.half_width_m) for p in run.places]
    for kind, away, half in own:
        if kind == "leak" and away <= max(5.0, 2 * half):
            return "leak" if away <= max(3.0, 1.5 * half) else "near"
    for kind, away, half in own:
        if away <= max(2.5, 1.5 * half):
            return kind
    if any(abs(c - place) <= 2.5 and a > np.radians(10) for c, a in run.route.bends_m):
        return "bend"
    sound = run.scenario.sound
    if any(abs(t.time_s - time_s) <= 0.6 * t.duration_s for t in sound.timed):
        return "traffic"
    if any(abs(edge - time_s) <= 8 for p in sound.pumps for edge in (p.start_s, p.end_s)):
        return "pump"
    knocked = any(abs(b.time_s - time_s) < 0.3 for b in run.blows)
    return "bump" if knocked and (width < 0.5 or impulsive > 0.3) else "unknown"


def false_sources(run, track) -> list[tuple[str, float, float | None]]:  # noqa: ANN001
    """Return class, chainage and half-width (None: a usual leak's) of what is no leak and no leak is near."""

    def at(time_s: float) -> float:
        return float(np.interp(time_s, track.time_s, track.chainage_m))

    sound = run.scenario.sound
    found: list[tuple[str, float, float | None]] = [
        (p.kind.value, p.chainage_m, p.half_width_m) for p in run.places if p.kind is not LeakClass.LEAK
    ]
    found += [("bend", float(c), None) for c, a in run.route.bends_m if a > np.radians(10)]
    found += [("traffic", at(t.time_s), None) for t in sound.timed]
    hummed = [0.75 * p.start_s + 0.25 * p.end_s for p in sound.pumps]
    found += [("pump", at(t), None) for t in hummed if track.time_s[0] + 30 < t < track.time_s[-1] - 30]
    blows = [b for b in run.blows if b.kind != "knock"]
    chosen = np.random.default_rng(run.seed).permutation(len(blows))[:6]
    found += [("bump", blows[i].chainage_m, 0.4) for i in chosen]
    leaks = [p.chainage_m for p in run.leaks]
    end = float(track.chainage_m[-1])
    return [f for f in found if 1 < f[1] < end - 1 and all(abs(f[1] - s) >= AROUND_LEAK_M for s in leaks)]


def fit(rows: list[dict], out: Path) -> None:
    """Write the model that the rows teach."""
    from scipy import optimize

    from processing.sound.place_features import FEATURES

    rows = [r for r in rows if r["label"] != "near"]
    names = [n for n in FEATURES if n not in STATED]
    features: dict[str, dict] = {}
    for name in names:
        table = counted(rows, name)
        if table is not None:
            features[name] = table
    for name, stated in STATED.items():
        p = {c: stated["p"].get(c, stated["p"][""]) for c in CLASSES}
        features[name] = {"edges": stated["edges"], "p": p, "weight": 1.0, "basis": "stated", "why": stated["why"]}
    spots = [r for r in rows if r["p"] is not None]
    others = [r["label"] for r in spots if r["label"] != "leak"]
    prior = {c: (others.count(c) + 2.0) if c != "leak" else 0.0 for c in CLASSES}
    prior = {c: n / sum(prior.values()) for c, n in prior.items()}
    trained = [n for n, t in features.items() if t["basis"] == "trained"]

    wrong = [r for r in rows if r["label"] not in ("leak", "unknown")]

    def loss(weights: np.ndarray) -> float:
        as_leak = cross_entropy(weights, trained, features, prior, spots)
        as_class = NAMING * confusion(weights, trained, features, wrong)
        return as_leak + as_class + 0.002 * len(spots) * float(weights @ weights)

    best = optimize.minimize(loss, np.full(len(trained), 0.4), bounds=[(0.0, 1.0)] * len(trained), method="L-BFGS-B")
    for name, weight in zip(trained, best.x):
        features[name]["weight"] = round(float(weight), 3)
    mains = sorted({(r["kind"], r["seed"]) for r in rows})
    record = {
        "trained_on": f"{len(mains)} simulated mains ({mains[0][0]}, seeds {mains[0][1]}–{mains[-1][1]})",
        "rows": {c: sum(r["label"] == c for r in rows) for c in CLASSES},
        "detector_spots": len(spots),
    }
    out.parent.mkdir(parents=True, exist_ok=True)
    document = {"record": record, "prior": prior, "features": features}
    out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    for name, table in features.items():
        print(
            f"{name:18s} {table['basis']:8s} weight {table['weight']:.2f}  edges {np.round(table['edges'], 2).tolist()}"
        )


def counted(rows: list[dict], name: str) -> dict | None:
    """Return the bins and the smoothed share of each class in them; None where too few rows know the figure."""
    known = [(r["label"], r["figures"][name]) for r in rows if np.isfinite(r["figures"].get(name, np.nan))]
    if len(known) < 50:
        return None
    values = np.array([v for _, v in known])
    edges = np.array(EDGES[name])
    bins = np.searchsorted(edges, values, side="right")
    labels = np.array([label for label, _ in known])
    overall = np.bincount(bins, minlength=len(edges) + 1) / len(bins)
    p = {}
    for c in CLASSES:
        count = np.bincount(bins[labels == c], minlength=len(edges) + 1) + SMOOTHING * overall
        p[c] = [round(float(x), 5) for x in count / count.sum()]
    return {"edges": edges.tolist(), "p": p, "weight": 1.0, "basis": "trained"}


def cross_entropy(weights: np.ndarray, trained: list[str], features: dict, prior: dict, spots: list[dict]) -> float:
    """Return −Σ ln p(what it was: leak or not) of the spots under these weights."""
    leak = CLASSES.index("leak")
    total = 0.0
    for p, is_leak, said in _said(trained, features, spots):
        joint = weights @ said[: len(trained)] + said[len(trained) :].sum(axis=0)
        with np.errstate(divide="ignore"):
            ln_prior = np.log([(1 - p) * prior[c] if c != "leak" else p for c in CLASSES])
        joint = joint + ln_prior
        whole = np.logaddexp.reduce(joint)
        ln_leak = joint[leak] - whole
        ln_not = np.logaddexp.reduce(np.delete(joint, leak)) - whole
        total -= ln_leak if is_leak else ln_not
    return float(total)


def confusion(weights: np.ndarray, trained: list[str], features: dict, wrong: list[dict]) -> float:
    """Return −Σ ln p(the class that a false source has, it being known that it is no leak), all equally likely."""
    rest = [i for i, c in enumerate(CLASSES) if c != "leak"]
    total = 0.0
    for row, (_, _, said) in zip(wrong, _said(trained, features, wrong)):
        joint = (weights @ said[: len(trained)] + said[len(trained) :].sum(axis=0))[rest]
        total -= joint[rest.index(CLASSES.index(row["label"]))] - np.logaddexp.reduce(joint)
    return float(total)


_CACHE: dict[int, list[tuple[float, bool, np.ndarray]]] = {}


def _said(trained: list[str], features: dict, spots: list[dict]) -> list[tuple[float, bool, np.ndarray]]:
    """Per spot the detector's probability, the truth, ln p of each figure (figures, classes), trained ones first."""
    if id(spots) not in _CACHE:
        order = trained + [n for n in features if n not in trained]
        out = []
        for r in spots:
            said = np.zeros((len(order), len(CLASSES)))
            for i, name in enumerate(order):
                value = r["figures"].get(name, np.nan)
                if np.isfinite(value):
                    k = int(np.searchsorted(features[name]["edges"], value, side="right"))
                    said[i] = np.log([max(features[name]["p"][c][k], 1e-4) for c in CLASSES])
            out.append((float(np.clip(r["p"] or 0.5, 1e-3, 0.95)), r["label"] == "leak", said))
        _CACHE[id(spots)] = out
    return _CACHE[id(spots)]


def check(model_path: Path, rows: list[dict]) -> None:
    """Print the confusion matrix, the calibration before and after, and false alarms of a kilometre."""
    from processing.sound.classes import checked, judge

    model = checked(json.loads(model_path.read_text(encoding="utf-8")))
    rows = [r for r in rows if r["label"] != "near"]
    for title, some in (
        ("spots of the detector", [r for r in rows if r["p"] is not None]),
        ("false sources, told or not told by the detector (prior: even odds)", [r for r in rows if r["p"] is None]),
    ):
        matrix = np.zeros((len(CLASSES), len(CLASSES)), int)
        for r in some:
            found = judge(0.5 if r["p"] is None else r["p"], r["figures"], model)
            matrix[CLASSES.index(r["label"]), CLASSES.index(found.leak_class.value)] += 1
        print(f"\n{title}: rows truth, columns told\n{'':9s}" + "".join(f"{c:>8s}" for c in CLASSES))
        for c, row in zip(CLASSES, matrix):
            print(f"{c:9s}" + "".join(f"{n:8d}" for n in row))
    spots = [r for r in rows if r["p"] is not None]
    truth = np.array([r["label"] == "leak" for r in spots])
    before = np.array([r["p"] for r in spots])
    after = np.array([judge(r["p"], r["figures"], model).score for r in spots])
    for name, p in (("detector alone", before), ("with classes", after)):
        order = np.argsort(-p)
        hits, misses = np.cumsum(truth[order]), np.cumsum(~truth[order])
        mains = len({r["seed"] for r in spots})
        at = {n: int(hits[np.searchsorted(misses, n * mains, side="right") - 1]) for n in (0.25, 0.5, 1.0)}
        brier = float(np.mean((p - truth) ** 2))
        print(f"{name}: Brier {brier:.4f}, ECE {ece(p, truth):.3f}, leaks found at so many false ones a main: {at}")


def ece(p: np.ndarray, truth: np.ndarray) -> float:
    """Return the expected calibration error over ten equal bins."""
    bins = np.minimum((p * 10).astype(int), 9)
    return float(
        sum(abs(p[bins == b].mean() - truth[bins == b].mean()) * np.mean(bins == b) for b in set(bins.tolist()))
    )


def main() -> None:
    """Do what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    steps = parser.add_subparsers(dest="step", required=True)
    gathering = steps.add_parser("gather")
    gathering.add_argument("kind", choices=("usual", "other"))
    gathering.add_argument("first", type=int)
    gathering.add_argument("end", type=int)
    gathering.add_argument("out", type=Path)
    fitting = steps.add_parser("fit")
    fitting.add_argument("rows", type=Path)
    fitting.add_argument("out", type=Path)
    checking = steps.add_parser("check")
    checking.add_argument("model", type=Path)
    checking.add_argument("rows", type=Path, nargs="+")
    told = parser.parse_args()
    if told.step == "gather":
        gather(told.kind, range(told.first, told.end), told.out)
    elif told.step == "fit":
        fit(json.loads(told.rows.read_text(encoding="utf-8")), told.out)
    else:
        check(told.model, [r for p in told.rows for r in json.loads(p.read_text(encoding="utf-8"))])


if __name__ == "__main__":
    main()
