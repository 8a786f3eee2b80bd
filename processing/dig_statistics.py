"""What the digs say of the stated intervals: how often they held, how wrong they were, by what they should be widened.

A dig's error is found minus stated along the pipe. What the tape adds is taken into account everywhere: the stated
place may be right where the tape is not (as API 1163 does for in-line inspection of pipelines).

The widening factor. The error of dig i is taken as normal with a standard deviation of k·σ_i, σ_i being the stated
half interval over 1.96, and the tape's beside it; k is one scale for all digs of the pool. Its prior is Student's t
(3 degrees) about no widening, on the logarithm, with a scale of 0.3: k is between 0.6 and 1.6 for most, and many digs
overrule it. Three digs in a hundred may be gross errors (another leak was found, or a wrong pipe dug up), which no
widening mends and which therefore do not tell about k. The factor makes the interval of the *next* leak hold 95 %,
given all that the posterior leaves possible; it is 1 below :data:`FEWEST` measured digs (with right intervals, one of
five lies outside in 23 of 100 cases: that proves nothing), and 1 unless k > 1 with a probability of :data:`SURE`. It
goes below 1 only with :data:`MANY` digs and a probability of 0.99: a wrong dig costs more than a wide interval.
"""

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import optimize, stats

from processing.dig_history import DigKind, HistoryEntry
from processing.review_facts import MEASURED_SIGMA_M, DigFinding, DigHistory, DigResult, ScoreBand
from processing.survey import FloatArray

NORMAL_95 = 1.959964
FEWEST, MANY, SURE = 5, 30, 0.9
ENOUGH = 8  # measured digs: with fewer the next wider pool speaks
_LEAST_SIGMA_M = 0.01
_GROSS_SHARE, _GROSS_SIGMAS = 0.03, 30.0
_PRIOR_SCALE, _PRIOR_DEGREES = 0.3, 3
_LOG_K = np.linspace(math.log(0.1), math.log(50.0), 1500)
SCORE_EDGES = (0.0, 0.3, 0.5, 0.7, 0.9, 1.0)


@dataclass(frozen=True)
class Errors:
    """Measured digs: error found minus stated, the stated 1 sigma before any widening, the tape's 1 sigma, all (n,).

    ``held`` (n,) says whether the interval, as it was stated, contained the found place, the tape considered.
    """

    error_m: FloatArray
    sigma_m: FloatArray
    tape_sigma_m: FloatArray
    held: np.ndarray[tuple[int], np.dtype[np.bool_]]


@dataclass(frozen=True)
class Widening:
    """The factor, and the probability that the intervals are too narrow at all."""

    factor: float = 1.0
    chance_narrow: float = 0.5


def history_of(entries: Sequence[HistoryEntry], kind: DigKind) -> DigHistory | None:
    """Return what the digs of a kind say; None where there are none of that motion.

    The narrowest pool with :data:`ENOUGH` measured digs speaks; where none has as many, the one with most.
    """
    pools = [(name, [entry for entry in entries if name in entry.kind.pools()]) for name in kind.pools()]
    counts = [len(errors_of(_digs(found)).error_m) for _, found in pools]
    enough = [i for i, count in enumerate(counts) if count >= ENOUGH]
    dug = [len(found) for _, found in pools]
    best = enough[0] if enough else max(range(len(pools)), key=lambda i: (counts[i], dug[i], -i))
    name, found = pools[best]
    return _history(name, _digs(found)) if found else None


def errors_of(digs: Iterable[DigResult]) -> Errors:
    """Return the errors of those digs that found the source of the sound, measured, at a stated place."""
    rows = []
    for dig in digs:
        off, stated, low, high = dig.off_along_m, dig.stated_chainage_m, dig.stated_low95_m, dig.stated_high95_m
        if off is None or stated is None or low is None or high is None or dig.finding is DigFinding.NOTHING:
            continue
        sides = (stated - low, high - stated)
        half = max(sides) if low <= 0.0 else sides[1] if off >= 0.0 else sides[0]  # intervals end at the launch
        tape = dig.sigma_m if dig.sigma_m is not None else MEASURED_SIGMA_M.get(dig.measured, 0.2)
        held = abs(off) <= math.hypot(half, NORMAL_95 * tape)
        rows.append((off, max(half / NORMAL_95 / max(dig.stated_widen, 1.0), _LEAST_SIGMA_M), tape, held))
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    return Errors(table[:, 0], table[:, 1], table[:, 2], np.asarray(table[:, 3] > 0.5))


def widening(errors: Errors) -> Widening:
    """Return by what factor stated intervals should be multiplied; see the module's text."""
    count = len(errors.error_m)
    if count == 0:
        return Widening()
    posterior = _posterior(errors)
    wider = float(posterior[_LOG_K > 0.0].sum())
    needed = _needed(posterior)
    if count >= FEWEST and wider >= SURE:
        return Widening(max(needed, 1.0), wider)
    if count >= MANY and wider <= 0.01:
        return Widening(min(needed, 1.0), wider)
    return Widening(1.0, wider)


def _posterior(errors: Errors) -> FloatArray:
    """Return the probability of each scale of the grid."""
    scale = np.exp(_LOG_K)[:, None]
    sigma = np.hypot(scale * errors.sigma_m, errors.tape_sigma_m)
    gross = np.hypot(_GROSS_SIGMAS * errors.sigma_m, errors.tape_sigma_m)
    usual = np.log1p(-_GROSS_SHARE) + stats.norm.logpdf(errors.error_m, scale=sigma)
    other = np.log(_GROSS_SHARE) + stats.norm.logpdf(errors.error_m, scale=gross)
    likelihood = np.logaddexp(usual, other[None, :]).sum(axis=1)
    log_p = likelihood + stats.t.logpdf(_LOG_K / _PRIOR_SCALE, _PRIOR_DEGREES)
    weights = np.exp(log_p - log_p.max())
    return np.asarray(weights / weights.sum(), np.float64)


def _needed(posterior: FloatArray) -> float:
    """Return the factor whose interval holds the next leak in 95 of 100 cases, the scale being uncertain as it is."""
    scale = np.exp(_LOG_K)

    def held(log_factor: float) -> float:
        inside = 2.0 * stats.norm.cdf(NORMAL_95 * math.exp(log_factor) / scale) - 1.0
        return float(posterior @ inside) - 0.95

    return math.exp(optimize.brentq(held, math.log(0.05), math.log(200.0)))


def share_interval(hits: int, of: int) -> tuple[float, float]:
    """Return the exact 95 % interval of a share (C. J. Clopper, E. S. Pearson, Biometrika 26, 1934)."""
    if of == 0:
        return 0.0, 1.0
    low = 0.0 if hits == 0 else float(stats.beta.ppf(0.025, hits, of - hits + 1))
    high = 1.0 if hits == of else float(stats.beta.ppf(0.975, hits + 1, of - hits))
    return low, high


def score_bands(digs: Iterable[DigResult]) -> tuple[ScoreBand, ...]:
    """Return by band of the machine's score how many digs found a leak; bands without a dig are left out."""
    scored = [(d.stated_score, d.finding is DigFinding.LEAK) for d in digs if d.stated_score is not None]
    bands = []
    for low, high in itertools.pairwise(SCORE_EDGES):
        found = [leak for score, leak in scored if low <= score < high or score == high == 1.0]
        if found:
            bands.append(ScoreBand(low, high, len(found), sum(found), *share_interval(sum(found), len(found))))
    return tuple(bands)


def _digs(entries: Iterable[HistoryEntry]) -> list[DigResult]:
    return [entry.dig for entry in entries if entry.dig is not None]


def _history(kind: str, digs: Sequence[DigResult]) -> DigHistory:
    errors = errors_of(digs)
    count, held = len(errors.error_m), int(errors.held.sum())
    stated = [dig for dig in digs if not dig.missed]
    dry = sum(dig.finding is not DigFinding.LEAK for dig in stated)
    away = np.abs(errors.error_m)
    nan = float("nan")
    return DigHistory(
        kind=kind,
        count=count,
        held=held,
        median_error_m=float(np.median(away)) if count else nan,
        p95_error_m=float(np.quantile(away, 0.95, method="higher")) if count else nan,
        dry_holes=dry,
        widen=widening(errors).factor,
        dug=len(stated),
        missed=sum(dig.missed and dig.finding is DigFinding.LEAK for dig in digs),
        held_low=share_interval(held, count)[0],
        held_high=share_interval(held, count)[1],
        dry_low=share_interval(dry, len(stated))[0],
        dry_high=share_interval(dry, len(stated))[1],
        bias_m=float(np.mean(errors.error_m)) if count else nan,
        bias_sigma_m=float(np.std(errors.error_m, ddof=1) / math.sqrt(count)) if count > 1 else nan,
        bands=score_bands(stated),
    )
