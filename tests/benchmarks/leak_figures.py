"""What runs say of a leak detector: recall by SNR at a false-alarm rate, precision, apex error, coverage, calibration.

A candidate is a hit when it lies within max(5 m, 2 half-widths) of a leak that no better candidate has taken; every
other candidate is a false alarm, a second one at the same leak too. Apex errors are told beside the path that the
detector was given (the sound's own error) and beside the truth (path and clock with it).
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

TOLERANCE_M, TOLERANCE_WIDTHS = 5.0, 2.0
WORTH_SHOWING = 0.2  # the least score that the program lists by default
EDGES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)  # of the scores, for calibration
_Z = 1.959964


@dataclass(frozen=True)
class Row:
    """A candidate of one run: ``leak`` is the index of the leak it hits, −1 for none."""

    run: int
    score: float
    leak: int
    own_error_m: float = float("nan")
    error_m: float = float("nan")
    own_sigma_m: float = float("nan")
    half_m: float = float("nan")


@dataclass(frozen=True)
class Outcome:
    """All candidates of all runs, with the SNR of each run's leaks and its length."""

    rows: tuple[Row, ...]
    snr_db: tuple[tuple[float, ...], ...]
    length_m: tuple[float, ...]


def plain(outcome):
    """Return an outcome as lists, for JSON."""
    return [[list(vars(row).values()) for row in outcome.rows], outcome.snr_db, outcome.length_m]


def from_plain(lists):
    """Return the outcome of :func:`plain`'s lists."""
    rows, levels, lengths = lists
    return Outcome(tuple(Row(*row) for row in rows), tuple(tuple(x) for x in levels), tuple(lengths))


def joined(outcomes):
    """Return several outcomes as one, run after run."""
    rows, levels, lengths = [], [], []
    for outcome in outcomes:
        rows += [replace(row, run=row.run + len(levels)) for row in outcome.rows]
        levels += outcome.snr_db
        lengths += outcome.length_m
    return Outcome(tuple(rows), tuple(levels), tuple(lengths))


def matched_rows(run_index, leaks, candidates):
    """Return a row for each candidate (with ``chainage_m``, ``score``, interval and ``evidence``), best score first."""
    taken, rows = set(), []
    for c in sorted(candidates, key=lambda c: -c.score):
        near = [
            (abs(c.chainage_m - leak.told_m), i)
            for i, leak in enumerate(leaks)
            if i not in taken
            and abs(c.chainage_m - leak.told_m) <= max(TOLERANCE_M, TOLERANCE_WIDTHS * leak.half_width_m)
        ]
        if not near:
            rows.append(Row(run_index, c.score, -1))
            continue
        index = min(near)[1]
        taken.add(index)
        leak = leaks[index]
        half = 0.5 * (c.chainage_high95_m - c.chainage_low95_m)
        sigma = float(c.evidence.get("sigma_sound_m", float("nan")))
        rows.append(
            Row(run_index, c.score, index, c.chainage_m - leak.told_m, c.chainage_m - leak.chainage_m, sigma, half)
        )
    return rows


def threshold_at(outcome, per_km):
    """Return the least score at which there are no more than ``per_km`` false alarms a kilometre."""
    allowed = int(np.floor(per_km * sum(outcome.length_m) / 1000.0))
    false = sorted((r.score for r in outcome.rows if r.leak < 0), reverse=True)
    return float(np.nextafter(false[allowed], np.inf)) if len(false) > allowed else 0.0


def recall(outcome, threshold):
    """Return SNR class → (found, of); the key None counts all."""
    found = {(r.run, r.leak) for r in outcome.rows if r.leak >= 0 and r.score >= threshold}
    out = {}
    for run, levels in enumerate(outcome.snr_db):
        for i, level in enumerate(levels):
            for key in (round(level), None):
                hit, of = out.get(key, (0, 0))
                out[key] = (hit + ((run, i) in found), of + 1)
    return out


def false_per_km(outcome, threshold):
    """Return false alarms a kilometre at or above a score."""
    return 1000.0 * sum(r.leak < 0 and r.score >= threshold for r in outcome.rows) / sum(outcome.length_m)


def average_precision(outcome):
    """Return the area under precision over recall, all runs in one ranking; leaks never proposed count as missed."""
    rows = sorted(outcome.rows, key=lambda r: -r.score)
    hits = np.cumsum([r.leak >= 0 for r in rows])
    precision = hits / np.arange(1, len(rows) + 1)
    leaks = sum(len(levels) for levels in outcome.snr_db)
    return float(sum(p for p, r in zip(precision, rows) if r.leak >= 0) / leaks) if rows else 0.0


def apex(outcome, threshold, least_snr_db=-2.0):
    """Return figures of the hits at or above ``threshold`` on leaks of ``least_snr_db`` and more."""
    rows = [
        r for r in outcome.rows
        if r.leak >= 0 and r.score >= threshold and outcome.snr_db[r.run][r.leak] >= least_snr_db - 0.01
    ]  # fmt: skip
    if not rows:
        return {"hits": 0}
    own, whole = (np.abs([getattr(r, name) for r in rows]) for name in ("own_error_m", "error_m"))
    sigma, half = (np.array([getattr(r, name) for r in rows]) for name in ("own_sigma_m", "half_m"))
    return {
        "hits": len(rows),
        "own": spread(own),
        "whole": spread(whole),
        "own_inside": 100 * float(np.mean(own <= _Z * sigma)),
        "whole_inside": 100 * float(np.mean(whole <= half)),
        "half": float(np.median(half)),
    }


def spread(errors):
    """Return median, 95th percentile and rms."""
    return float(np.median(errors)), float(np.percentile(errors, 95)), float(np.sqrt(np.mean(np.square(errors))))


def calibration(outcome, least=WORTH_SHOWING):
    """Return (low, high, count, mean score, share of leaks) a bin, and the expected calibration error from ``least``.

    That error is the mean gap between what is stated and what is true, weighed by the candidates in each bin.
    """
    score = np.array([r.score for r in outcome.rows])
    right = np.array([r.leak >= 0 for r in outcome.rows])
    table, error, total = [], 0.0, max(int(np.sum(score >= least)), 1)
    for low, high in pairwise(EDGES):
        inside = (score >= low) & ((score < high) | (high == EDGES[-1]))
        count = int(inside.sum())
        stated, true = (float(score[inside].mean()), float(right[inside].mean())) if count else (0.0, 0.0)
        table.append((low, high, count, stated, true))
        if low >= least - 1e-9:
            error += count / total * abs(stated - true)
    return table, error


def resampled(outcome, runs):
    """Return the outcome of the given runs (indices, with repetition)."""
    by_run = {}
    for row in outcome.rows:
        by_run.setdefault(row.run, []).append(row)
    rows = [
        Row(new, r.score, r.leak, r.own_error_m, r.error_m, r.own_sigma_m, r.half_m)
        for new, old in enumerate(runs)
        for r in by_run.get(int(old), ())
    ]
    return Outcome(
        tuple(rows), tuple(outcome.snr_db[int(i)] for i in runs), tuple(outcome.length_m[int(i)] for i in runs)
    )


def bootstrap(outcome, figure, draws=300, seed=0):
    """Return the 5th and 95th percentile of ``figure(outcome)`` over runs drawn with repetition."""
    rng = np.random.default_rng(seed)
    count = len(outcome.length_m)
    values = [figure(resampled(outcome, rng.integers(0, count, count))) for _ in range(draws)]
    known = [x for x in values if np.isfinite(x)]
    return tuple(float(x) for x in np.percentile(known, [5, 95])) if known else (float("nan"), float("nan"))
