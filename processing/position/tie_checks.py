"""How the pieces of knowledge agree with each other: leave-one-out residuals, and holding down what all others deny."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from processing.position.chain import Smoothed
from processing.position.factors import Item, Read
from processing.position.ties import LENGTH
from processing.settings import PositionSettings
from processing.survey import FloatArray

_INCREMENT_ROUNDS = 12


@dataclass(frozen=True)
class TieCheck:
    """How a tie agrees: its residual in the fit, and how far the path would miss it were it unknown (leave-one-out).

    ``left_out_m`` leaves out all that the tie tells, chainage and coordinates. For a place both are distances.
    """

    name: str  # empty for the pipe's length
    time_s: float
    kind: str  # chainage | place
    residual_m: float
    left_out_m: float
    left_out_sigma_m: float
    held_down: bool


@dataclass(frozen=True)
class Miss:
    """How far the path misses what it does not know: vector, covariance (with its own), squared size."""

    vector_m: FloatArray
    covariance_m2: FloatArray
    squared: float


Solve = Callable[[tuple[Item, ...]], tuple[Smoothed, Read]]


def hold_down(items: tuple[Item, ...], solve: Solve, settings: PositionSettings) -> tuple[Item, ...]:
    """Raise the covariance of items that all the others contradict until they fit (data snooping, Baarda).

    Of ties and fixes the worst goes first, so that a wrong one does not take right ones with it; two equally bad ones
    are both held down: nothing tells which is wrong. Increments are many: all go at once that disagree by nearly as
    much as the worst of them, as a wrong one drags its neighbours along. One item alone is believed.
    """
    held = list(items)
    if len(items) < 2:
        return items
    limits = {size: _limit(size, settings) for size in (1, 2)}
    single = np.array([item.kind in ("tie", "fix") for item in items])
    rounds = 2 * int(np.count_nonzero(single)) + _INCREMENT_ROUNDS
    for _ in range(rounds):
        smoothed, read = solve(tuple(held))
        excess = _excess(smoothed, held, read, limits)
        if excess.max() <= 1.0 + 1e-6:
            break
        worst = np.where(single, 0.9 * excess[single].max(initial=0.0), 0.4 * excess[~single].max(initial=0.0))
        for k in np.flatnonzero(excess > 1.0):
            if excess[k] >= worst[k]:
                miss = left_out(smoothed, held[k : k + 1], read.parts[k : k + 1])
                grown = held[k].covariance_m2 + miss.covariance_m2 * (excess[k] - 1.0)
                held[k] = replace(held[k], covariance_m2=grown)
    return tuple(held)


def _excess(smoothed: Smoothed, held: Sequence[Item], read: Read, limits: dict[int, float]) -> FloatArray:
    """By how many times what is allowed each item is missed (squared) when it is left out."""
    first = np.array([start for start, _ in read.parts])
    out = smoothed.pull[first] ** 2 / smoothed.weight[first] / limits[1]
    for k, (start, stop) in enumerate(read.parts):
        if stop - start > 1:
            out[k] = left_out(smoothed, held[k : k + 1], read.parts[k : k + 1]).squared / limits[stop - start]
    return np.asarray(out)


def _limit(size: int, settings: PositionSettings) -> float:
    """The chi-square value that is as rare for ``size`` coordinates as ``outlier_sigmas`` is for one."""
    from scipy.stats import chi2, norm

    return float(chi2.isf(2.0 * norm.sf(settings.outlier_sigmas), size))


def left_out(smoothed: Smoothed, items: Sequence[Item], parts: Sequence[tuple[int, int]]) -> Miss:
    """Leave items of one keyframe out, in closed form: with S⁻¹ the inverse and α = S⁻¹ r, they are missed by
    ``(S⁻¹_kk)⁻¹ α_k``.
    """  # fmt: skip
    start, stop = parts[0][0], parts[-1][1]
    if stop - start == 1:
        miss = smoothed.pull[start] / smoothed.weight[start]
        variance = np.array([[1.0 / smoothed.weight[start]]])
        return Miss(np.array([miss]), variance, float(smoothed.pull[start] * miss))
    inverse = np.linalg.inv(smoothed.inverse(start, stop))
    root = np.zeros((stop - start, stop - start))
    at = 0
    for item in items:
        size = len(item.value)
        # a single value is read as it is, several are whitened
        own = np.linalg.cholesky(item.covariance_m2) if size > 1 else np.eye(1)
        root[at : at + size, at : at + size] = own
        at += size
    pull = smoothed.pull[start:stop]
    return Miss(root @ inverse @ pull, root @ inverse @ root.T, float(pull @ inverse @ pull))


def checks_of(smoothed: Smoothed, read: Read, items: tuple[Item, ...], held: tuple[Item, ...]) -> tuple[TieCheck, ...]:
    """Return the table of ties among ``items`` as given, for a solution that knows them as ``held``."""
    out = []
    ties = [k for k, item in enumerate(items) if item.kind == "tie"]
    for _, group in groupby(ties, key=lambda k: (items[k].node, items[k].name, items[k].time_s)):
        members = list(group)
        together = slice(members[0], members[-1] + 1)
        miss = left_out(smoothed, held[together], read.parts[together])
        at = 0
        for k in members:
            part = slice(at, at + len(items[k].value))
            out.append(_check(smoothed, items[k], held[k], miss.vector_m[part], miss.covariance_m2[part, part]))
            at = part.stop
    return tuple(sorted(out, key=lambda check: (check.time_s, check.name, check.kind)))


def _check(smoothed: Smoothed, item: Item, kept: Item, miss: FloatArray, covariance: FloatArray) -> TieCheck:
    left = item.value - item.rows @ smoothed.mean[item.node]
    variance = covariance - kept.covariance_m2 + item.covariance_m2
    # along the direction of the miss for a place: comparable to its length
    size = float(np.linalg.norm(miss))
    way = miss / size if size > 1e-12 else np.eye(len(miss))[0]
    return TieCheck(
        name="" if item.name == LENGTH else item.name,
        time_s=item.time_s,
        kind="place" if item.is_place else "chainage",
        residual_m=float(np.linalg.norm(left) if item.is_place else left[0]),
        left_out_m=size if item.is_place else float(miss[0]),
        left_out_sigma_m=float(np.sqrt(max(float(way @ variance @ way), 0.0))),
        held_down=kept is not item,
    )
