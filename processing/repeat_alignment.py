"""Which place of an earlier run is which of a later one: the chainages of two runs of the same pipe, put side by side.

Best known first: tie points of the same name; tie points told at the same chainage; both paths' own coordinates; else
both launches are taken for the same place. Two runs in opposite directions have falling chainages.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from processing.coordinates import frame_of, tie_place
from processing.errors import LeaklineError
from processing.position.distance import chainage_at
from processing.results import Results
from processing.survey import FloatArray, TiePoint, Track

NAMES, CHAINAGES, COORDINATES, LAUNCH = "names", "chainages", "coordinates", "launch"
_ANCHOR_SIGMA_M = 0.3  # how well two people mark the same place
_LAUNCH_SIGMA_M = 0.5  # launches are put in by hand, at the same chamber
_STRETCH = 0.003  # a share of the way from the nearest anchor: odometers of two runs differ by some parts in a thousand
_SAME_CHAINAGE_M = 0.05
_SAME_PLACE_M = 3.0
_ODD_M = 3.0  # anchors that disagree by more than this, and _ODD_SHARE of the way between them, are no common places
_ODD_SHARE = 0.03
_STEP_M = 5.0
_BESIDE_M = 15.0  # farther beside each other, two paths are not the same pipe


@dataclass(frozen=True)
class Anchor:
    """A place that both runs passed."""

    name: str
    ours_m: float
    theirs_m: float


@dataclass(frozen=True)
class Alignment:
    """Chainages of another run on ours: straight between anchors (at least one), beyond them with slope ±1."""

    basis: str  # names | chainages | coordinates | launch
    anchors: tuple[Anchor, ...]  # by rising ``ours_m``
    is_reversed: bool = False
    sigma_m: float = _ANCHOR_SIGMA_M  # at an anchor

    def to_theirs(self, ours_m: FloatArray | float) -> FloatArray:
        """Return their chainage of our places."""
        x, y = self._knots()
        return _mapped(np.atleast_1d(np.asarray(ours_m, np.float64)), x, y, self._slope)

    def to_ours(self, theirs_m: FloatArray | float) -> FloatArray:
        """Return our chainage of their places."""
        x, y = self._knots()
        order = np.argsort(y)
        return _mapped(np.atleast_1d(np.asarray(theirs_m, np.float64)), y[order], x[order], self._slope)

    def sigma_at(self, ours_m: FloatArray | float) -> FloatArray:
        """Return how well places of the two runs are put side by side, 1 sigma, beside the runs' own intervals."""
        x, _ = self._knots()
        away = np.abs(np.atleast_1d(np.asarray(ours_m, np.float64))[:, None] - x[None, :]).min(axis=1)
        return np.asarray(np.hypot(self.sigma_m, _STRETCH * away), np.float64)

    @property
    def _slope(self) -> float:
        return -1.0 if self.is_reversed else 1.0

    def _knots(self) -> tuple[FloatArray, FloatArray]:
        return np.array([a.ours_m for a in self.anchors]), np.array([a.theirs_m for a in self.anchors])


def align(ours: Results, theirs: Results, *, is_reversed: bool | None = None) -> Alignment:
    """Return the alignment of two runs with a path; ``is_reversed`` is the operator's word, None lets the data say."""
    assert ours.track is not None  # the caller has asked for it
    assert theirs.track is not None
    for basis, anchors in (
        (NAMES, _by_name(ours, theirs)),
        (CHAINAGES, _by_chainage(ours, theirs)),
        (COORDINATES, _by_coordinates(ours, theirs)),
    ):
        agreed = _agreed(anchors, is_reversed)
        if agreed is not None:
            return replace(agreed, basis=basis)
    return _by_launch(theirs.track, is_reversed=bool(is_reversed))


def _by_launch(theirs: Track, *, is_reversed: bool) -> Alignment:
    if not is_reversed:
        return Alignment(LAUNCH, (Anchor("", 0.0, 0.0),), sigma_m=_LAUNCH_SIGMA_M)
    # launched where the other run ended
    far = Anchor("", 0.0, float(theirs.chainage_m[-1]))
    return Alignment(LAUNCH, (far,), is_reversed=True, sigma_m=_LAUNCH_SIGMA_M)


def _agreed(anchors: Sequence[Anchor], is_reversed: bool | None) -> Alignment | None:
    """Return the alignment by most anchors that agree in order and distance; None where one alone remains unsure.

    One anchor alone does not tell the direction: it serves where the operator did, or else the common one is taken.
    """
    ordered = sorted(anchors, key=lambda a: a.ours_m)
    if not ordered:
        return None
    directions = (False, True) if is_reversed is None else (is_reversed,)
    chains = [(_longest(ordered, -1.0 if turned else 1.0), turned) for turned in directions]
    chain, turned = max(chains, key=lambda found: len(found[0]))
    if len(ordered) >= 2 and len(chain) < 2:
        return None
    return Alignment(NAMES, tuple(chain), is_reversed=turned)


def _longest(ordered: Sequence[Anchor], slope: float) -> list[Anchor]:
    """Return the longest chain of anchors whose distances agree, in this direction (quadratic: tie points are few)."""
    best: list[list[Anchor]] = []
    for i, anchor in enumerate(ordered):
        chain = [anchor]
        for j in range(i):
            before = best[j][-1]
            way = anchor.ours_m - before.ours_m
            off = abs(slope * (anchor.theirs_m - before.theirs_m) - way)
            if way > 0.0 and off <= _ODD_M + _ODD_SHARE * way and len(best[j]) + 1 > len(chain):
                chain = [*best[j], anchor]
        best.append(chain)
    return max(best, key=len)


def _passed(results: Results) -> list[tuple[TiePoint, float]]:
    """Return the enabled tie points within the run, with the chainage that the path gives them."""
    track = results.track
    assert track is not None
    ties = [t for t in results.survey.tie_points if t.enabled and track.time_s[0] <= t.time_s <= track.time_s[-1]]
    return [(tie, float(chainage_at(track, tie.time_s)[0])) for tie in ties]


def _by_name(ours: Results, theirs: Results) -> list[Anchor]:
    """Tie points of the same name; one that a run has twice says nothing."""
    found = [_unique([(_bare(t.name), m) for t, m in _passed(r) if t.name.strip()]) for r in (ours, theirs)]
    names = {_bare(tie.name): tie.name for tie, _ in _passed(ours)}
    return [Anchor(names[key], found[0][key], found[1][key]) for key in found[0].keys() & found[1].keys()]


def _unique(pairs: Sequence[tuple[str, float]]) -> dict[str, float]:
    names = [name for name, _ in pairs]
    return {name: place for name, place in pairs if names.count(name) == 1}


def _bare(name: str) -> str:
    """Return a name as it is compared: small letters, dotted and dotless i alike."""
    return " ".join(name.replace("İ", "i").replace("I", "i").lower().replace("ı", "i").replace("\u0307", "").split())


def _by_chainage(ours: Results, theirs: Results) -> list[Anchor]:
    """Tie points told at the same chainage, as on the plan; and the launches with them, which both plans call 0."""
    pairs = []
    for a, ours_m in _passed(ours):
        for b, theirs_m in _passed(theirs):
            if a.chainage_m is None or b.chainage_m is None or abs(a.chainage_m - b.chainage_m) > _SAME_CHAINAGE_M:
                continue
            pairs.append(Anchor(a.name, ours_m, theirs_m))
    return [Anchor("", 0.0, 0.0), *pairs] if pairs else []


def _by_coordinates(ours: Results, theirs: Results) -> list[Anchor]:
    """Tie points at the same coordinates and, where both runs have a place in the world, their paths side by side."""
    try:
        here, there = frame_of(ours.survey), frame_of(theirs.survey)
    except LeaklineError:  # coordinates that cannot be: the data page tells of them
        return []
    if not (here.is_geographic and there.is_geographic):
        return []
    assert ours.track is not None
    assert theirs.track is not None
    anchors = []
    for a, ours_m in _passed(ours):
        for b, theirs_m in _passed(theirs):
            place_a, place_b = tie_place(here, a), tie_place(there, b)
            if place_a is None or place_b is None:
                continue
            moved = here.from_geographic(there.to_geographic([[place_b[0], place_b[1], 0.0]]))[0]
            if np.hypot(moved[0] - place_a[0], moved[1] - place_a[1]) <= _SAME_PLACE_M:
                anchors.append(Anchor(a.name, ours_m, theirs_m))
    if len(anchors) >= 2:  # one alone tells neither the direction nor how the odometers differ
        return anchors
    rows = _rows_every(theirs.track, _STEP_M)
    plan = theirs.track.position_w_m[rows]
    moved = here.from_geographic(there.to_geographic(np.column_stack([plan[:, :2], np.zeros(len(rows))])))
    return [*anchors, *_side_by_side(ours.track, moved[:, :2], theirs.track.chainage_m[rows])]


def _side_by_side(ours: Track, plan: FloatArray, theirs_m: FloatArray) -> list[Anchor]:
    """Return the places of our path nearest to each of theirs, every twentieth: ends and what lies between."""
    from scipy.spatial import cKDTree

    mine = _rows_every(ours, 0.5)
    found = cKDTree(ours.position_w_m[mine, :2]).query(plan)
    distance, nearest = np.asarray(found[0], np.float64), np.asarray(found[1], np.intp)
    inner = (nearest > 0) & (nearest < len(mine) - 1) & (distance <= _BESIDE_M)  # beyond our ends nothing is common
    which = np.flatnonzero(inner)
    which = (
        which[np.unique(np.linspace(0, len(which) - 1, min(20, len(which))).astype(np.intp))] if len(which) else which
    )
    return [Anchor("", float(ours.chainage_m[mine[nearest[i]]]), float(theirs_m[i])) for i in which]


def _rows_every(track: Track, step_m: float) -> npt.NDArray[np.intp]:
    """Return rows of a track that lie some metres apart."""
    wanted = np.arange(float(track.chainage_m[0]), float(track.chainage_m[-1]) + step_m, step_m)
    rows = np.minimum(np.searchsorted(track.chainage_m, wanted), len(track.chainage_m) - 1)
    return np.unique(rows).astype(np.intp)


def _mapped(at: FloatArray, x: FloatArray, y: FloatArray, slope: float) -> FloatArray:
    inside = np.interp(at, x, y)
    out = np.where(at < x[0], y[0] + slope * (at - x[0]), np.where(at > x[-1], y[-1] + slope * (at - x[-1]), inside))
    return np.asarray(out, np.float64)
