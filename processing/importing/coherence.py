"""Does the gyroscope turn as gravity says? A test of units, times and axes that walking and shaking do not disturb.

Over a window of one or two seconds the specific force, turned back by the integrated gyroscope into the sensor's frame
at the window's start, is gravity plus an acceleration that averages out: its mean is as long as gravity where the
gyroscope is right. Where its unit, its sign or the time is wrong, the vectors point all ways and the mean is short, or
it keeps what should average out and is long. On feet, hands and balls the right hypothesis wins by 5 to 80 standard
errors (tests/processing/importing/test_coherence.py).
"""

from dataclasses import dataclass

import numpy as np

from processing.importing.units import STANDARD_GRAVITY_MPS2
from processing.survey import FloatArray

_WINDOW_S = 1.5
_ROWS = (64, 1024)
_TRIED = 500
_USED = 160
_FEWEST = 6


@dataclass(frozen=True)
class Coherence:
    """How well hypotheses fit: ``scores`` (windows, hypotheses) in 0..1, 1 where the mean is as long as gravity.

    A hypothesis is a factor on the gyroscope.
    """

    factors: tuple[float, ...]
    scores: FloatArray

    @property
    def mean(self) -> FloatArray:
        """The mean score of each hypothesis, 0 where there was no window."""
        return np.asarray(self.scores.mean(axis=0)) if len(self.scores) else np.zeros(len(self.factors))

    def best(self, among: tuple[float, ...]) -> float:
        """The factor of ``among`` with the highest score."""
        return max(among, key=lambda factor: self.mean[self.factors.index(factor)])

    def margin(self, winner: float, loser: float) -> tuple[float, float]:
        """By how much the ``winner`` scores higher, and how many standard errors that is."""
        if len(self.scores) < _FEWEST:
            return 0.0, 0.0
        lead = self.scores[:, self.factors.index(winner)] - self.scores[:, self.factors.index(loser)]
        error = float(np.std(lead)) / np.sqrt(len(lead)) + 1e-9
        return float(np.mean(lead)), float(np.mean(lead)) / float(error)


def coherence(time: FloatArray, acc: FloatArray, gyr: FloatArray, factors: tuple[float, ...]) -> Coherence:
    """Return how well each factor on ``gyr`` (n, 3), taken as rad/s, turns ``acc`` (n, 3) in m/s² back to gravity.

    The windows with most turn among evenly spread ones are used; those with gaps or unreadable rows are not.
    """
    steps = np.diff(time)
    step = float(np.median(steps)) if len(steps) else 0.0
    if not step > 0:
        return Coherence(factors, np.empty((0, len(factors))))
    rows = int(np.clip(round(_WINDOW_S / step), *_ROWS))
    starts = np.unique(np.linspace(0, max(len(time) - rows - 1, 0), _TRIED).astype(np.intp))
    starts = starts[starts + rows < len(time)]
    turn = np.array([_turn(time[s : s + rows], acc[s : s + rows], gyr[s : s + rows], step) for s in starts])
    usable = np.nonzero(turn >= 0)[0] if len(turn) else np.empty(0, dtype=np.intp)
    chosen = usable[np.argsort(turn[usable])[::-1][: max(min(_USED, round(0.6 * len(usable))), _FEWEST)]]
    if len(chosen) < _FEWEST:
        return Coherence(factors, np.empty((0, len(factors))))
    at = starts[chosen][:, None] + np.arange(rows)
    return Coherence(factors, _scores(np.diff(time[at], axis=1), acc[at], gyr[at], np.array(factors)))


def _turn(time: FloatArray, acc: FloatArray, gyr: FloatArray, step: float) -> float:
    """How much a window turns; −1 where it cannot be used."""
    if not (np.isfinite(acc).all() and np.isfinite(gyr).all()) or float(np.diff(time).max()) > 4.0 * step:
        return -1.0
    return float(np.sqrt(np.mean(np.square(gyr))))


def _scores(steps: FloatArray, acc: FloatArray, gyr: FloatArray, factors: FloatArray) -> FloatArray:
    """Scores (w, h) of windows ``acc`` and ``gyr`` (w, rows, 3) with ``steps`` (w, rows − 1)."""
    windows, rows = acc.shape[:2]
    scalar = np.ones((len(factors), windows, 1))
    vector = np.zeros((len(factors), windows, 3))
    total = np.zeros((len(factors), windows, 3))
    for row in range(rows):
        if row:
            turn = 0.5 * (gyr[:, row] + gyr[:, row - 1]) * steps[:, row - 1, None]
            scalar, vector = _turned(scalar, vector, factors[:, None, None] * turn)
        force = acc[:, row][None]
        cross = np.cross(vector, force) + scalar * force
        total += force + 2.0 * np.cross(vector, cross)
    length = np.linalg.norm(total / rows, axis=2) / STANDARD_GRAVITY_MPS2
    return np.asarray(np.maximum(1.0 - np.abs(length - 1.0), 0.0).T, dtype=np.float64)


def _turned(scalar: FloatArray, vector: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The quaternion (scalar, vector) times the exponential of half of ``turn`` (h, w, 3)."""
    angle = np.linalg.norm(turn, axis=2, keepdims=True)
    c, s = np.cos(0.5 * angle), 0.5 * np.sinc(angle / (2.0 * np.pi)) * turn
    new_scalar = scalar * c - np.sum(vector * s, axis=2, keepdims=True)
    new_vector = scalar * s + c * vector + np.cross(vector, s)
    return new_scalar, new_vector
