"""Where on a mapped line a device was, from a profile along its way (turns, slopes) beside the same one of the map.

A hidden Markov model over the offset between odometer and map: each hypothesis of the odometer's scale carries a band
of offsets on a 0.25 m grid, that walks by the slip from step to step; each step is weighed by how well the profile fits
the map's there, with a bounded loss, so that what the map does not know cannot rule out the truth. Forward and backward
recursions give the posterior of the place (Rabiner 1989, "A tutorial on hidden Markov models", eq. 18–27), and the
evidence against a device that knows nothing of the map.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from processing.progress import Progress
from processing.survey import FloatArray

STEP_M = 0.5
_GRID_M = 0.25
_TABLE_M = 0.1
Rows = npt.NDArray[np.intp]

_MOST_SIGMAS = 6.0  # a worse misfit costs no more
_PRUNED = 1e-9
_PRUNE_EVERY = 50
_MOST_CELLS = 120_000
_BEYOND_DOUBT = 60.0  # nats
_FARTHEST_JUMP_M = 60.0


@dataclass(frozen=True)
class Prior:
    """What the odometer alone says: 1-sigma of its scale, of its start on the map, and of its walk (m/√m).

    ``jump_m`` is the 1-sigma of what it lost at some rows of the profile (slid, gap), by row.
    """

    scale_sigma: float
    start_sigma_m: float
    walk: float
    jump_m: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Profile:
    """The same quantity along the odometer, at ``odometer_m`` (k,) in steps of STEP_M, and along the map.

    ``measured`` (k,) and the map's ``mapped`` (j,), at the places of :func:`table_grid` from ``map_start_m`` on, differ
    by noise of ``sigma`` that is correlated over ``reach_m``.
    """

    odometer_m: FloatArray
    measured: FloatArray
    mapped: FloatArray
    map_start_m: float
    sigma: float
    reach_m: float

    def misfit(self, row: int, place_m: FloatArray) -> FloatArray:
        """Return the loss (nats, per independent stretch's share) of being at places (any shape) at one row."""
        at = ((place_m - self.map_start_m) * (1.0 / _TABLE_M) + 0.5).astype(np.int32)
        away = (self.mapped[np.clip(at, 0, len(self.mapped) - 1)] - self.measured[row]) / self.sigma
        return np.asarray(np.minimum(away * away, _MOST_SIGMAS**2) * (0.5 * STEP_M / self.reach_m))

    def misfit_without_map(self) -> float:
        """Return the whole loss of a line without any feature."""
        away = np.minimum((self.measured / self.sigma) ** 2, _MOST_SIGMAS**2)
        return float(np.sum(away) * 0.5 * STEP_M / self.reach_m)


@dataclass(frozen=True)
class PlacedAt:
    """Place on the map when the odometer told ``odometer_m``; ``share`` of the posterior lies within ±2 m of it."""

    odometer_m: float
    place_m: float
    share: float


@dataclass(frozen=True)
class Match:
    """Places at the wanted moments; ``gain`` and ``mirrored_gain`` (nats) of the map and of its mirror over no map."""

    placed: tuple[PlacedAt, ...]
    gain: float
    mirrored_gain: float
    scale: float


def table_grid(start_m: float, end_m: float) -> FloatArray:
    """Return the chainages at which a map's profile is tabulated."""
    return np.asarray(start_m + _TABLE_M * np.arange(int(np.ceil((end_m - start_m) / _TABLE_M)) + 1))


def match(profiles: tuple[Profile, ...], wanted: FloatArray, prior: Prior, progress: Progress) -> Match:
    """Return where on the map the device was at odometer readings ``wanted`` (n,), in ascending order.

    All profiles share ``odometer_m``. Cost: rows times hypotheses; memory: wanted readings times hypotheses.
    """
    cells = _Cells.of(profiles[0].odometer_m, prior)
    rows = np.clip(np.searchsorted(profiles[0].odometer_m, wanted), 0, len(profiles[0].odometer_m) - 1)
    plain = sum(p.misfit_without_map() for p in profiles)
    forward = _forward(profiles, cells, rows, progress.part(0.0, 0.4))
    gain = forward.log_evidence + plain
    mirrored_gain = -np.inf
    if gain < _BEYOND_DOUBT:  # turns that fit so well cannot fit their mirror images too
        mirror = tuple(replace(p, mapped=-p.mapped) for p in profiles)
        mirrored_gain = _forward(mirror, cells, rows[:0], progress.part(0.4, 0.7)).log_evidence + plain
    placed, scale = _backward(profiles, cells, rows, forward, progress.part(0.7, 1.0))
    return Match(placed, gain, mirrored_gain, scale)


@dataclass(frozen=True)
class _Cells:
    """Hypotheses: scales (k,) with their prior, offsets (d,) with theirs, and the share that walks to a neighbour."""

    scale: FloatArray
    weight: FloatArray
    offset_m: FloatArray
    start: FloatArray
    walking: float
    jump_m: Mapping[int, float]

    @classmethod
    def of(cls, odometer_m: FloatArray, prior: Prior) -> "_Cells":
        length = float(odometer_m[-1] - odometer_m[0]) + 1.0
        spread = prior.walk * np.sqrt(length)
        lost = np.sqrt(sum(jump**2 for jump in prior.jump_m.values()))
        band = 3.5 * np.hypot(spread, prior.start_sigma_m) + min(3.0 * lost, _FARTHEST_JUMP_M) + 1.0
        offset = _GRID_M * np.arange(-np.ceil(band / _GRID_M), np.ceil(band / _GRID_M) + 1)
        step = max(0.7 * spread / length, 6.0 * prior.scale_sigma * len(offset) / _MOST_CELLS)
        most = np.ceil(3.0 * prior.scale_sigma / step)
        scale = step * np.arange(-most, most + 1)
        weight = np.exp(-0.5 * (scale / prior.scale_sigma) ** 2)
        start = np.exp(-0.5 * (offset / max(prior.start_sigma_m, _GRID_M)) ** 2)
        walking = min(0.5 * prior.walk**2 * STEP_M / _GRID_M**2, 0.33)
        return cls(scale, weight / weight.sum(), offset, start / start.sum(), walking, prior.jump_m)

    def walked(self, mass: FloatArray, row: int) -> FloatArray:
        """The step up to ``row`` of the slip's random walk, of variance ``walk²·STEP_M``, and what was lost there."""
        if row in self.jump_m:
            from scipy.ndimage import gaussian_filter1d

            mass = gaussian_filter1d(mass, self.jump_m[row] / _GRID_M, axis=1, mode="constant", truncate=3.0)
        out = (1.0 - 2.0 * self.walking) * mass
        out[:, 1:] += self.walking * mass[:, :-1]
        out[:, :-1] += self.walking * mass[:, 1:]
        return np.asarray(out)

    def places(self, odometer_m: float, kept: FloatArray) -> FloatArray:
        """Where each hypothesis puts the device (k, d)."""
        return np.asarray((odometer_m * (1.0 + kept))[:, None] + self.offset_m)


@dataclass(frozen=True)
class _Forward:
    log_evidence: float
    at: dict[int, FloatArray]
    kept: Rows  # indices of the scales that survive


def _likelihood(profiles: tuple[Profile, ...], row: int, places: FloatArray) -> FloatArray:
    return np.asarray(np.exp(-sum(p.misfit(row, places) for p in profiles)))


def _forward(profiles: tuple[Profile, ...], cells: _Cells, rows: Rows, progress: Progress) -> _Forward:
    """Run forward, keep the mass at ``rows``, and drop scales that the profile has ruled out."""
    odometer = profiles[0].odometer_m
    kept = np.arange(len(cells.scale))
    mass = cells.weight[:, None] * cells.start
    log_evidence = 0.0
    at: dict[int, tuple[Rows, FloatArray]] = {}
    wanted = set(np.asarray(rows).tolist())
    for row in range(len(odometer)):
        mass = cells.walked(mass, row) * _likelihood(
            profiles, row, cells.places(float(odometer[row]), cells.scale[kept])
        )
        total = float(mass.sum())
        log_evidence += float(np.log(total))
        mass /= total
        if row in wanted:
            at[row] = (kept, mass.copy())
        if row % _PRUNE_EVERY == 0:
            alive = mass.sum(axis=1) > _PRUNED
            kept, mass = kept[alive], mass[alive]
            progress.update(row / len(odometer), "position_bends")
    return _Forward(log_evidence, {row: m[np.isin(k, kept)] for row, (k, m) in at.items()}, kept)


def _backward(
    profiles: tuple[Profile, ...], cells: _Cells, rows: Rows, forward: _Forward, progress: Progress
) -> tuple[tuple[PlacedAt, ...], float]:
    odometer = profiles[0].odometer_m
    scale = cells.scale[forward.kept]
    mass = np.ones((len(scale), len(cells.offset_m)))
    placed: dict[int, PlacedAt] = {}
    best_scale = 0.0
    wanted = set(np.asarray(rows).tolist())
    for row in range(len(odometer) - 1, -1, -1):
        places = cells.places(float(odometer[row]), scale)
        if row in wanted:
            posterior = forward.at[row] * mass
            placed[row] = _mode(float(odometer[row]), posterior, places)
            best_scale = float(np.sum(posterior.sum(axis=1) * scale) / posterior.sum())
        mass = cells.walked(mass * _likelihood(profiles, row, places), row)
        mass /= mass.max()
        if row % _PRUNE_EVERY == 0:
            progress.update(1.0 - row / len(odometer), "position_bends")
    return tuple(placed[int(row)] for row in rows), best_scale


def _mode(odometer_m: float, posterior: FloatArray, places: FloatArray) -> PlacedAt:
    """Sum over the scales on a common grid; the mode is the metre-wide window with the most mass."""
    low = float(places.min())
    at = ((places - low) / _GRID_M).astype(np.int64).ravel()
    bins: FloatArray = np.asarray(np.bincount(at, posterior.ravel()) / posterior.sum(), dtype=np.float64)
    window = np.convolve(bins, np.ones(5), mode="same")
    best = int(np.argmax(window))
    near = slice(max(best - 8, 0), best + 9)
    mean = float(np.sum(np.arange(len(bins))[near] * bins[near]) / bins[near].sum())
    return PlacedAt(odometer_m, low + (mean + 0.5) * _GRID_M, float(bins[near].sum()))
