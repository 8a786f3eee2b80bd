"""All that is known of a run beside its odometry, as linear readings of the level chain.

A piece of knowledge that speaks of two moments (an increment of chainage, the same place twice) reads the later
keyframe and a copy of the earlier one, which the chain carries along from there: so the chain stays a chain.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from processing.position.chain import Chain, Readings
from processing.position.evidence import ChainageIncrement, Evidence, Revisit
from processing.position.keyframes import Keyframes, nearest_rows
from processing.position.motion_model import CLOCK, EAST, LEVEL_SIZE, NORTH, WAY
from processing.position.ties import Observation
from processing.survey import FloatArray

_MOST_COPIES = 6
_LEAST_SIGMA_M = 1e-3


@dataclass(frozen=True)
class Item:
    """One piece of knowledge at a keyframe: ``value = rows · x ± covariance`` (j values), which may be held down."""

    kind: str  # tie | fix | increment | revisit
    name: str
    time_s: float
    node: int
    rows: FloatArray  # (j, d)
    value: FloatArray  # (j,)
    covariance_m2: FloatArray  # (j, j)
    is_place: bool = False


@dataclass(frozen=True)
class Copies:
    """Unknowns beyond the eight: which keyframe's chainage or place a copy takes on, and the sources' own scales."""

    size: int = LEVEL_SIZE
    taken: tuple[tuple[int, int, int], ...] = ()  # (keyframe, copy, what it copies)
    constants: tuple[tuple[int, float], ...] = ()  # (unknown, its sigma)


@dataclass(frozen=True)
class Factors:
    """All items in the order of their keyframes, and the copies that they read."""

    items: tuple[Item, ...]
    copies: Copies
    dropped: int = 0  # increments that overlap with too many others


def collect(frames: Keyframes, ties: Sequence[Observation], evidence: Evidence, on_route: bool) -> Factors:
    """Return everything that pulls on the level chain; with a route, places say nothing that chainage does not."""
    spans: list[ChainageIncrement | Revisit] = [*evidence.increments]
    if not on_route:
        spans += evidence.revisits
    offsets = {fix.source: fix.shared_sigma_m for fix in evidence.fixes if fix.shared_sigma_m > 0.0}
    placed, copies, dropped = _placed(frames, spans, len(offsets))
    offset_at = {source: copies.size - len(offsets) + k for k, source in enumerate(offsets)}
    own = tuple((offset_at[source], sigma) for source, sigma in offsets.items())
    copies = replace(copies, constants=(*copies.constants, *own))
    items = [_of_tie(frames, tie, copies.size) for tie in ties]
    time_s = frames.odometry.time_s
    for fix in evidence.fixes:
        row = np.zeros((1, copies.size))
        row[0, WAY] = 1.0
        if fix.source in offset_at:
            row[0, offset_at[fix.source]] = 1.0
        node = int(nearest_rows(time_s, [fix.time_s])[0])
        value = np.array([fix.chainage_m])
        items.append(Item("fix", fix.source, fix.time_s, node, row, value, _square(fix.sigma_m)))
    items += placed
    order = sorted(range(len(items)), key=lambda k: (items[k].node, items[k].kind, items[k].name, items[k].time_s))
    return Factors(tuple(items[k] for k in order), copies, dropped)


def with_copies(chain: Chain, copies: Copies) -> Chain:
    """Return the chain in which each copy takes on its keyframe's value, and the sources' scales have their prior."""
    if copies.size == LEVEL_SIZE:
        return chain
    step, prior = chain.step.copy(), chain.prior_cov.copy()
    for node, copy, of in copies.taken:
        if node < len(step):
            step[node, copy] = 0.0
            step[node, copy, of] = 1.0
    for unknown, sigma in copies.constants:
        prior[unknown, unknown] = sigma**2
    return replace(chain, step=step, prior_cov=prior)


@dataclass(frozen=True)
class Read:
    """Readings of items, and which of them (start, stop) belong to each item."""

    readings: Readings
    parts: tuple[tuple[int, int], ...]


def readings_of(items: Sequence[Item], size: int) -> Read:
    """Return the items as scalar readings: several values of one item are turned and scaled to be independent."""
    if not items:
        return Read(Readings(np.zeros(0, np.intp), np.zeros((0, size)), np.zeros(0), np.zeros(0)), ())
    nodes, rows, values, variances, parts = [], [], [], [], []
    at = 0
    for item in items:
        count = len(item.value)
        parts.append((at, at + count))
        at += count
        if count == 1:
            nodes.append(item.node)
            rows.append(item.rows)
            values.append(item.value)
            variances.append(item.covariance_m2[0, 0])
            continue
        white = np.linalg.inv(np.linalg.cholesky(item.covariance_m2))
        nodes += [item.node] * count
        rows.append(white @ item.rows)
        values.append(white @ item.value)
        variances += [1.0] * count
    readings = Readings(
        np.array(nodes, np.intp), np.concatenate(rows), np.concatenate(values), np.array(variances, dtype=np.float64)
    )
    return Read(readings, tuple(parts))


def _of_tie(frames: Keyframes, tie: Observation, size: int) -> Item:
    count = 2 if tie.is_place else 1
    rows = np.zeros((count, size))
    step = min(tie.row, len(frames.rows) - 2)
    if tie.is_place:
        rows[0, EAST] = rows[1, NORTH] = 1.0
        rows[:, CLOCK] = tie.speed_mps * frames.ahead[step]
    else:
        rows[0, WAY] = 1.0
        rows[0, CLOCK] = tie.speed_mps
    value, covariance = tie.value[:count], tie.covariance_m2[:count, :count]
    return Item("tie", tie.name, tie.time_s, tie.row, rows, value, covariance, tie.is_place)


def _placed(
    frames: Keyframes, spans: Sequence[ChainageIncrement | Revisit], more: int
) -> tuple[list[Item], Copies, int]:
    """Share out copies among spans, each free again where its span ends; ``more`` unknowns stand behind them."""
    scales = sorted({s.source: s.scale_sigma for s in spans if isinstance(s, ChainageIncrement) and s.scale_sigma > 0})
    time_s = frames.odometry.time_s
    free_from: dict[int, list[int]] = {1: [], 2: []}  # by how many unknowns a copy has: when each is free again
    chosen = []
    dropped = 0
    for span in sorted(spans, key=_times):
        first, last = (int(n) for n in nearest_rows(time_s, _times(span)))
        if last <= first:
            continue
        width = 1 if isinstance(span, ChainageIncrement) else 2
        slots = free_from[width]
        slot = next((k for k, free in enumerate(slots) if free <= first), len(slots))
        if slot == _MOST_COPIES:
            dropped += 1
            continue
        if slot == len(slots):
            slots.append(0)
        slots[slot] = last
        chosen.append((span, first, last, slot))
    singles = len(free_from[1])
    scale_at = LEVEL_SIZE + singles + 2 * len(free_from[2])
    size = scale_at + len(scales) + more
    items, taken = [], []
    for span, first, last, slot in chosen:
        if isinstance(span, ChainageIncrement):
            copy = LEVEL_SIZE + slot
            taken.append((first, copy, WAY))
            unknown = scale_at + scales.index(span.source) if span.source in scales else None
            rolled_m = float(frames.odometry.chainage_m[last] - frames.odometry.chainage_m[first])
            items.append(_of_increment(span, last, copy, unknown, size, rolled_m))
        else:
            copy = LEVEL_SIZE + singles + 2 * slot
            taken += [(first, copy, EAST), (first, copy + 1, NORTH)]
            items.append(_of_revisit(span, last, copy, size))
    constants = tuple(
        (scale_at + k, max(s.scale_sigma for s in spans if isinstance(s, ChainageIncrement) and s.source == source))
        for k, source in enumerate(scales)
    )
    return items, Copies(size, tuple(taken), constants), dropped


def _times(span: ChainageIncrement | Revisit) -> tuple[float, float]:
    return (span.start_s, span.end_s) if isinstance(span, ChainageIncrement) else (span.first_s, span.second_s)


def _of_increment(span: ChainageIncrement, node: int, copy: int, scale: int | None, size: int, rolled_m: float) -> Item:
    """The source's own scale acts on what was rolled, not on what was told: were it otherwise, both scales would shrink
    together, because with them shrinks the slip between (regression dilution)."""
    row = np.zeros((1, size))
    row[0, WAY], row[0, copy] = 1.0, -1.0
    if scale is not None:
        row[0, scale] = -rolled_m
    value = np.array([span.length_m])
    return Item("increment", span.source, span.end_s, node, row, value, _square(span.sigma_m))


def _of_revisit(span: Revisit, node: int, copy: int, size: int) -> Item:
    rows = np.zeros((2, size))
    rows[0, EAST], rows[0, copy] = 1.0, -1.0
    rows[1, NORTH], rows[1, copy + 1] = 1.0, -1.0
    covariance = np.eye(2) * max(span.sigma_m, _LEAST_SIGMA_M) ** 2
    return Item("revisit", span.source, span.second_s, node, rows, np.zeros(2), covariance, is_place=True)


def _square(sigma_m: float) -> FloatArray:
    return np.array([[max(sigma_m, _LEAST_SIGMA_M) ** 2]])
