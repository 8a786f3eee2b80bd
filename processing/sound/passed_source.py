"""Fits a passed source into the field: its place, how fast it falls off on either side, and its spectrum.

The source adds to the background's power, so in band b and at distance d it raises the log power by
ln(1 + a_b h(d)), h = 1/(1+(d/w)²) or exp(−|d|/w), with a width of its own on either side. For given place and widths
the strengths a_b and the background follow in closed form but for a few Newton steps (variable projection).
"""

from dataclasses import dataclass

import numpy as np
from scipy import optimize

from processing.sound.sound_field import OVERLAP, SoundField
from processing.survey import BoolArray, FloatArray

_REACH_WIDTHS, _REACH_M = 6.0, 6.0
_ROOM_M = 1.5
_WIDTHS_M = (0.15, 14.0)
_STRONGEST = 1e4
_FIRST_STEPS, _STEPS = 8, 3
_EVALUATIONS = 12


@dataclass(frozen=True)
class Source:
    """A source at ``place_m`` that falls off over ``before_m`` and ``after_m``, ``strength`` (b,) backgrounds loud."""

    place_m: float
    before_m: float
    after_m: float
    is_exponential: bool
    strength: FloatArray

    @property
    def width_m(self) -> float:
        """The mean of both sides."""
        return float(np.sqrt(self.before_m * self.after_m))

    def log_rise(self, chainage_m: FloatArray) -> FloatArray:
        """Return (n, b) by how much the source raises the log power."""
        distance = chainage_m - self.place_m
        return np.asarray(
            np.log1p(self.strength * _fall(distance, self.before_m, self.after_m, self.is_exponential)[:, None])
        )


def fit_source(field: SoundField, excess: FloatArray, weight: FloatArray, cell: int, width_m: float) -> Source | None:
    """Return the source near ``cell``, about ``width_m`` wide, in ``excess`` (n, b); None where too little is heard."""
    near_m = float(field.chainage_m[cell])
    inside = field.heard & (np.abs(field.chainage_m - near_m) <= max(_REACH_WIDTHS * width_m, _REACH_M))
    if np.count_nonzero(inside) < 8:
        return None
    patch = _Patch(field.chainage_m[inside], excess[inside], weight[inside], field.variance, near_m)
    fits = [_fitted(patch, near_m, width_m, is_exponential) for is_exponential in (False, True)]
    return min(fits, key=lambda fit: fit[0])[1]


class _Patch:
    """The cells around a source, and the strengths found last: the next evaluation starts from them."""

    def __init__(
        self, chainage_m: FloatArray, excess: FloatArray, weight: FloatArray, variance: FloatArray, near_m: float
    ) -> None:
        self.chainage_m, self.excess = chainage_m, excess
        self.weight = weight[:, None] / max(float(weight.sum()), 1e-9)
        self.root = np.sqrt(weight[:, None] / variance / OVERLAP)
        top = excess[int(np.argmin(np.abs(chainage_m - near_m)))]
        self.start = np.maximum(np.expm1(np.minimum(top, 5.0)), 0.05)

    def strengths(self, fall: FloatArray, start: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Return the strengths (b,) under a shape ``fall`` (n, 1), and what is left over (n, b)."""
        strength = start
        for _ in range(steps):
            slope = fall / (1.0 + strength * fall)
            slope = slope - (self.weight * slope).sum(axis=0)
            left = self._left(strength, fall)
            step = (self.weight * slope * left).sum(axis=0) / np.maximum((self.weight * slope**2).sum(axis=0), 1e-12)
            room = strength + 0.3
            strength = np.clip(strength + np.clip(step, -0.7 * room, 2 * room), 0.0, _STRONGEST)
        return strength, self._left(strength, fall)

    def _left(self, strength: FloatArray, fall: FloatArray) -> FloatArray:
        left = self.excess - np.log1p(strength * fall)
        return np.asarray(left - (self.weight * left).sum(axis=0))


def _fitted(patch: _Patch, near_m: float, width_m: float, is_exponential: bool) -> tuple[float, Source]:
    room = max(_ROOM_M, width_m)
    low, high = np.log(_WIDTHS_M)
    last = patch.strengths(_column(patch, near_m, width_m, width_m, is_exponential), patch.start, _FIRST_STEPS)[0]

    def left_over(at: FloatArray) -> FloatArray:
        nonlocal last
        fall = _column(patch, float(at[0]), float(np.exp(at[1])), float(np.exp(at[2])), is_exponential)
        last, left = patch.strengths(fall, last, _STEPS)
        return np.asarray((patch.root * left).ravel())

    found = optimize.least_squares(
        left_over,
        [near_m, np.log(width_m), np.log(width_m)],
        bounds=([near_m - room, low, low], [near_m + room, high, high]),
        x_scale=[0.3, 0.5, 0.5],
        diff_step=[1e-3],
        max_nfev=_EVALUATIONS,
    )
    place, before, after = float(found.x[0]), float(np.exp(found.x[1])), float(np.exp(found.x[2]))
    left_over(found.x)
    return float(found.cost), Source(place, before, after, is_exponential, last)


def _column(patch: _Patch, place_m: float, before_m: float, after_m: float, is_exponential: bool) -> FloatArray:
    return _fall(patch.chainage_m - place_m, before_m, after_m, is_exponential)[:, None]


def _fall(distance_m: FloatArray, before_m: float, after_m: float, is_exponential: bool) -> FloatArray:
    away = np.abs(distance_m) / np.where(distance_m < 0, before_m, after_m)
    return np.asarray(np.exp(-away) if is_exponential else 1.0 / (1.0 + away**2), np.float64)


def around(chainage_m: FloatArray, source: Source, widths: float) -> BoolArray:
    """Return the cells within ``widths`` half-widths of a source, on its wider side."""
    reach = widths * max(source.before_m, source.after_m)
    near: BoolArray = np.abs(chainage_m - source.place_m) <= reach
    return near
