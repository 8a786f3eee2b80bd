"""The reduced run that is fitted: odometry at k keyframes, and what happened between each and the next.

A keyframe stands at even shares of way and time, and at every moment that something is known of. What lies between is
summed exactly, so that few keyframes lose nothing but detail.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.position.evidence import Evidence
from processing.position.odometry import Odometry, Rows, cumulated, directions, thinned
from processing.survey import FloatArray

_WAY_SHARE = 0.8


@dataclass(frozen=True)
class Keyframes:
    """k keyframes: the thinned ``odometry`` (k rows), and per step between them (k − 1 rows each) what was summed.

    ``late_m`` (k − 1, 2) is the part of each level step that a turn made evenly during the step acts upon: the
    integral of the free step, weighted from 0 at its beginning to 1 at its end.
    """

    odometry: Odometry
    rows: Rows  # (k,) in the full odometry
    late_m: FloatArray

    @property
    def step_s(self) -> FloatArray:
        """Durations (k − 1,)."""
        return np.diff(self.odometry.time_s)

    @property
    def way_m(self) -> FloatArray:
        """Lengths along the pipe (k − 1,)."""
        return np.diff(self.odometry.chainage_m)

    @property
    def free_m(self) -> FloatArray:
        """Steps (k − 1, 2) of the free path seen from above."""
        return np.diff(self.odometry.position_w_m[:, :2], axis=0)

    @property
    def ahead(self) -> FloatArray:
        """Unit directions (k − 1, 2) of the free path."""
        return directions(self.odometry.position_w_m[:, :2])


def moments_of(odometry: Odometry) -> FloatArray:
    """Return the cumulated products (m, 2) of level steps and their middle times since the start."""
    since = odometry.time_s - odometry.time_s[0]
    middle = 0.5 * (since[1:] + since[:-1])
    return cumulated(np.diff(odometry.position_w_m[:, :2], axis=0) * middle[:, None])


def even_rows(odometry: Odometry, count: int) -> Rows:
    """Return rows that share out way and time evenly, the ends among them."""
    way = odometry.chainage_m / max(float(odometry.chainage_m[-1]), 1e-9)
    since = (odometry.time_s - odometry.time_s[0]) / (odometry.time_s[-1] - odometry.time_s[0])
    shares = np.linspace(0.0, 1.0, max(count, 2))
    rows = np.clip(np.searchsorted(_WAY_SHARE * way + (1.0 - _WAY_SHARE) * since, shares), 0, len(way) - 1)
    return np.unique(np.concatenate([[0], rows, [len(way) - 1]]))


def event_times(evidence: Evidence) -> list[float]:
    """Return the moments that the evidence speaks of, those of a series of heights apart."""
    out = [fix.time_s for fix in evidence.fixes]
    for increment in evidence.increments:
        out += [increment.start_s, increment.end_s]
    for revisit in evidence.revisits:
        out += [revisit.first_s, revisit.second_s]
    for slip in evidence.slips:
        out += [slip.start_s, slip.end_s]
    return out


def nearest_rows(time_s: FloatArray, moments: npt.ArrayLike) -> Rows:
    """Return the rows of ``time_s`` (m,) nearest to ``moments`` (j,)."""
    at = np.asarray(moments, dtype=np.float64)
    right = np.clip(np.searchsorted(time_s, at), 1, len(time_s) - 1)
    return np.asarray(right - (at - time_s[right - 1] < time_s[right] - at), dtype=np.intp)


def keyframes_at(odometry: Odometry, moments_m: FloatArray, rows: Rows) -> Keyframes:
    """Return the run reduced to ``rows`` (k,), increasing; ``moments_m`` as of :func:`moments_of`."""
    thin = thinned(odometry, rows)
    since = thin.time_s[:-1] - odometry.time_s[0]
    step = np.diff(thin.position_w_m[:, :2], axis=0)
    late = (np.diff(moments_m[rows], axis=0) - since[:, None] * step) / np.diff(thin.time_s)[:, None]
    return Keyframes(thin, rows, late)
