"""A rectangle of sound, from a moment to another and from a frequency to another, and what is in it and beside it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from PySide6.QtCore import QPointF, QRectF

from widgets.tile_source import TileSource

EDGE_PIXELS = 8.0
_COLUMNS = 256


@dataclass(frozen=True)
class SoundSelection:
    """Survey seconds and Hz, each pair rising."""

    start_s: float
    end_s: float
    low_hz: float
    high_hz: float


@dataclass(frozen=True)
class SelectionFigures:
    """The level of the mean power in a selection, as the picture shows it, dB; None where there is no sound."""

    of: SoundSelection
    level_db: float | None
    beside_db: float | None  # in the same frequencies before and after it

    @property
    def excess_db(self) -> float | None:
        """By how much it is louder than beside it."""
        if self.level_db is None or self.beside_db is None:
            return None
        return self.level_db - self.beside_db


def measure(source: TileSource, of: SoundSelection, beside_s: Sequence[tuple[float, float]]) -> SelectionFigures:
    """Return the figures of a selection, with what is ``beside_s`` for comparison; called in a worker."""
    inside = _mean_power(source, of, ((of.start_s, of.end_s),))
    outside = _mean_power(source, of, beside_s)
    return SelectionFigures(of, _decibels(source, inside), _decibels(source, outside))


def _mean_power(source: TileSource, of: SoundSelection, spans: Sequence[tuple[float, float]]) -> float | None:
    """Return the mean power over spans of time and the bins between two frequencies, in units of the level 0."""
    frequencies = source.frequencies_hz
    rows = (frequencies >= of.low_hz) & (frequencies <= of.high_hz)
    if not rows.any():
        rows[int(np.argmin(np.abs(frequencies - 0.5 * (of.low_hz + of.high_hz))))] = True
    total = seconds = 0.0
    for start_s, end_s in spans:
        start_s, end_s = max(start_s, source.start_s), min(end_s, source.end_s)
        if end_s - start_s <= 0.0:
            continue
        levels = source.columns(start_s, end_s, _COLUMNS, "mean")[rows]
        there = levels.any(axis=0)
        if there.any():
            power = 10.0 ** (0.1 * source.step_db * levels[:, there].astype(np.float64))
            weight = (end_s - start_s) * float(there.mean())
            total, seconds = total + weight * float(power.mean()), seconds + weight
    return total / seconds if seconds else None


def _decibels(source: TileSource, power: float | None) -> float | None:
    return None if power is None else source.low_db + 10.0 * float(np.log10(power))


def grabbed_edge(area: QRectF, place: QPointF) -> str:
    """Return which edge of a selection's area lies under the mouse: ``start``, ``end``, ``low``, ``high`` or ``""``."""
    if not area.adjusted(-EDGE_PIXELS, -EDGE_PIXELS, EDGE_PIXELS, EDGE_PIXELS).contains(place):
        return ""
    away = {
        "start": abs(place.x() - area.left()),
        "end": abs(place.x() - area.right()),
        "high": abs(place.y() - area.top()),
        "low": abs(place.y() - area.bottom()),
    }
    nearest = min(away, key=lambda edge: away[edge])
    return nearest if away[nearest] <= EDGE_PIXELS else ""


def with_edge(of: SoundSelection, edge: str, time_s: float, frequency_hz: float) -> SoundSelection:
    """Return a selection one edge of which has been brought elsewhere; an edge may pass the opposite one."""
    if edge in ("start", "end"):
        fixed = of.end_s if edge == "start" else of.start_s
        return replace(of, start_s=min(time_s, fixed), end_s=max(time_s, fixed))
    fixed = of.high_hz if edge == "low" else of.low_hz
    return replace(of, low_hz=min(frequency_hz, fixed), high_hz=max(frequency_hz, fixed))
