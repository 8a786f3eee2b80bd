"""From the many pieces of a map to the sections between its branches, and from chosen sections to one line."""

import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files.lines import RouteLineString
from processing.survey import FloatArray

TOLERANCE_M = 0.5
Scale = tuple[float, float]


@dataclass(frozen=True)
class Section:
    """A line without branches: pieces of one layer that touch end to end, drawn the way most of them were."""

    name: str
    layer: str
    points: FloatArray  # (n, 3)
    has_z: bool
    pieces: tuple[int, ...]  # which lines of the file

    def length_m(self, scale: Scale) -> float:
        """Return the length on the map, metres; ``scale`` is what a unit of x and of y is in metres."""
        return float(np.hypot(*(np.diff(self.points[:, :2], axis=0) * scale).T).sum())


@dataclass(frozen=True)
class _Edge:
    """An oriented chain of pieces, growing while it is joined: each piece with whether it is turned round."""

    pieces: tuple[tuple[int, bool], ...]
    nodes: tuple[int, int]

    def turned(self) -> "_Edge":
        return _Edge(tuple((piece, not back) for piece, back in reversed(self.pieces)), self.nodes[::-1])


def sections_of(
    lines: Sequence[RouteLineString], scale: Scale, tolerance_m: float = TOLERANCE_M
) -> tuple[Section, ...]:
    """Return the sections that the lines form; where three or more ends meet, sections end. The longest come first."""
    out = []
    for layer in dict.fromkeys(line.layer for line in lines):
        own = [i for i, line in enumerate(lines) if line.layer == layer]
        for chain in _chains([lines[i].points for i in own], scale, tolerance_m):
            pieces = tuple((own[piece], back) for piece, back in chain.pieces)
            if sum(back for _, back in pieces) * 2 > len(pieces):
                pieces = tuple((piece, not back) for piece, back in reversed(pieces))
            out.append(_section([lines[i] for i, _ in pieces], pieces, scale, tolerance_m))
    return tuple(sorted(out, key=lambda section: -section.length_m(scale)))


def one_line(sections: Sequence[Section], scale: Scale, tolerance_m: float = TOLERANCE_M) -> Section:
    """Return the sections joined end to end into one, whatever their order and directions.

    Raises:
        LeaklineError: ROUTE_NOT_ONE_LINE with the number of separate lines and the smallest gap in metres between
            them (0 where they branch).
    """
    if not sections:
        raise LeaklineError(ErrorCode.ROUTE_NOT_ONE_LINE, lines=0, gap_m=0.0)
    chains = _chains([section.points for section in sections], scale, tolerance_m)
    if len(chains) != 1:
        gap = _smallest_gap([_joined(sections, c.pieces, scale, tolerance_m) for c in chains], scale)
        raise LeaklineError(ErrorCode.ROUTE_NOT_ONE_LINE, lines=len(chains), gap_m=gap if gap > tolerance_m else 0.0)
    return _section([sections[i] for i, _ in chains[0].pieces], chains[0].pieces, scale, tolerance_m)


def with_connections(
    sections: Sequence[Section], chosen: Iterable[int], scale: Scale, tolerance_m: float = TOLERANCE_M
) -> frozenset[int]:
    """Return ``chosen`` and the sections that connect them by the shortest way; as they are where none does."""
    ends, starts = _nodes([section.points for section in sections], scale, tolerance_m)
    lengths = [section.length_m(scale) for section in sections]
    around: dict[int, list[tuple[int, int]]] = {}
    for i, (a, b) in enumerate(zip(starts, ends, strict=True)):
        around.setdefault(a, []).append((i, b))
        around.setdefault(b, []).append((i, a))
    picked = sorted(set(chosen))
    reached = set(picked[:1])
    for target in picked[1:]:
        if target not in reached:
            goal = {starts[target], ends[target]}
            sources = {node for i in reached for node in (starts[i], ends[i])}
            reached |= {target, *_shortest(around, lengths, sources, goal)}
    return frozenset(reached)


def _shortest(
    around: dict[int, list[tuple[int, int]]], lengths: list[float], sources: set[int], goal: set[int]
) -> list[int]:
    """The sections of the shortest way between two sets of nodes (Dijkstra 1959); empty where there is none."""
    queue = [(0.0, node) for node in sorted(sources)]
    heapq.heapify(queue)
    best = dict.fromkeys(sources, 0.0)
    came: dict[int, tuple[int, int]] = {}
    while queue:
        cost, node = heapq.heappop(queue)
        if node in goal:
            way = []
            while node in came:
                section, node = came[node]
                way.append(section)
            return way
        if cost > best[node]:
            continue
        for section, other in around.get(node, ()):
            further = cost + lengths[section]
            if further < best.get(other, np.inf):
                best[other], came[other] = further, (section, node)
                heapq.heappush(queue, (further, other))
    return []


def _chains(parts: Sequence[FloatArray], scale: Scale, tolerance_m: float) -> list[_Edge]:
    """Merge parts at each node where exactly two ends meet; a ring stays one edge with equal nodes."""
    last, first = _nodes(parts, scale, tolerance_m)
    edges = {i: _Edge(((i, False),), (a, b)) for i, (a, b) in enumerate(zip(first, last, strict=True))}
    at: dict[int, list[int]] = {}
    for i, edge in edges.items():
        for node in edge.nodes:
            at.setdefault(node, []).append(i)
    for node, met in at.items():
        if len(met) != 2 or met[0] == met[1]:
            continue
        one, other = edges[met[0]], edges.pop(met[1])
        one = one if one.nodes[1] == node else one.turned()
        other = other if other.nodes[0] == node else other.turned()
        merged = _Edge(one.pieces + other.pieces, (one.nodes[0], other.nodes[1]))
        edges[met[0]] = merged
        far = at[other.nodes[1]]
        far[far.index(met[1])] = met[0]
    return list(edges.values())


def _nodes(parts: Sequence[FloatArray], scale: Scale, tolerance_m: float) -> tuple[list[int], list[int]]:
    """For each part the node of its end and of its start: ends within the tolerance of each other are one node."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    places = np.array([p[0, :2] for p in parts] + [p[-1, :2] for p in parts]) * scale
    pairs: npt.NDArray[np.intp] = KDTree(places).query_pairs(tolerance_m, output_type="ndarray")
    count = len(places)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    nodes = [int(label) for label in labels]
    return nodes[len(parts) :], nodes[: len(parts)]


def _section(
    held: Sequence[RouteLineString | Section], pieces: tuple[tuple[int, bool], ...], scale: Scale, tolerance_m: float
) -> Section:
    turned = tuple((k, back) for k, (_, back) in enumerate(pieces))
    names = dict.fromkeys(one.name for one in held if one.name)
    shown = next(iter(names), "") if len(names) < 2 else f"{next(iter(names))} …"
    points = _joined(held, turned, scale, tolerance_m)
    layer = held[0].layer
    return Section(shown, layer, points, all(one.has_z for one in held), tuple(piece for piece, _ in pieces))


def _joined(
    held: Sequence[RouteLineString | Section],
    pieces: tuple[tuple[int, bool], ...],
    scale: Scale,
    tolerance_m: float,
) -> FloatArray:
    """One polyline; of two ends that meet within the tolerance the first stands, so that no small hook is left."""
    parts: list[FloatArray] = []
    for k, back in pieces:
        points = held[k].points[::-1] if back else held[k].points
        near = bool(parts) and np.hypot(*((points[0, :2] - parts[-1][-1, :2]) * scale)) <= tolerance_m
        parts.append(points[1:] if near else points)
    return np.concatenate(parts)


def _smallest_gap(lines: Sequence[FloatArray], scale: Scale) -> float:
    ends = [np.array([line[0, :2], line[-1, :2]]) * scale for line in lines[:200]]
    gaps = [
        float(np.hypot(*(a[:, None, :] - b[None, :, :]).reshape(-1, 2).T).min())
        for i, a in enumerate(ends)
        for b in ends[i + 1 :]
    ]
    return min(gaps, default=0.0)
