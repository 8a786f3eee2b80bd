"""The named places on the plan: launch, retrieval and tie points; which one lies under the mouse, and their strokes."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QPainter, QPen

from processing.survey import FloatArray, TiePoint
from widgets.path_paint import Labels, paint_pin
from widgets.plan_geometry import PlanScale
from widgets.plot_theme import Theme

SAME_PLACE_M = 2.0
REACH_PIXELS = 18.0  # a gloved finger on a small square
ToLocal = Callable[[TiePoint], tuple[float, float] | None]
PositionAt = Callable[[float], tuple[float, float, float] | None]


@dataclass(frozen=True)
class Pin:
    """A named place on the plan; ``number`` is that of its tie point, None for the ends of the path."""

    name: str
    east_m: float
    north_m: float
    kind: str = "tie"  # tie | unused | doubted | launch | retrieval
    number: int | None = None


class PlanPins:
    """Holds the tie points' pins; a dragged one stands under the hand until it is told its new place."""

    def __init__(self) -> None:
        self.pins: tuple[Pin, ...] = ()
        self._ties: tuple[TiePoint, ...] = ()
        self._to_local: ToLocal | None = None
        self._doubted: frozenset[int] = frozenset()
        self.selected: int | None = None

    def set_tie_points(self, tie_points: Sequence[TiePoint], to_local: ToLocal | None, position_at: PositionAt) -> None:
        """Take these: they stand where ``to_local`` puts them, else where the device was at their moment."""
        self._ties, self._to_local = tuple(tie_points), to_local
        self.place(position_at)

    def set_doubted(self, numbers: frozenset[int]) -> None:
        """Mark those that the others contradict."""
        self._doubted = numbers
        kinds = {n: self._kind(n, tie) for n, tie in enumerate(self._ties)}
        self.pins = tuple(
            Pin(p.name, p.east_m, p.north_m, p.kind if p.number is None else kinds[p.number], p.number)
            for p in self.pins
        )

    def place(self, position_at: PositionAt) -> None:
        """Put the pins where their tie points are now: those without coordinates follow the path."""
        pins = []
        for number, tie in enumerate(self._ties):
            given = self._to_local(tie) if self._to_local is not None else None
            place = given if given is not None else position_at(tie.time_s)
            if place is not None and math.isfinite(place[0]) and math.isfinite(place[1]):
                pins.append(Pin(tie.name, place[0], place[1], self._kind(number, tie), number))
        self.pins = tuple(pins)

    def _kind(self, number: int, tie: TiePoint) -> str:
        if not tie.enabled:
            return "unused"
        return "doubted" if number in self._doubted else "tie"

    def at(self, place: QPointF, scale: PlanScale) -> int | None:
        """Return the number of the tie point whose pin lies under a pixel, the nearest one."""
        away = [
            (math.dist(scale.pixel(pin.east_m, pin.north_m), place.toTuple()), pin.number)
            for pin in self.pins
            if pin.number is not None
        ]
        near = [pair for pair in away if pair[0] <= REACH_PIXELS]
        return min(near)[1] if near else None

    @property
    def places(self) -> FloatArray:
        """East and north (n, 2) of all pins."""
        return np.array([(pin.east_m, pin.north_m) for pin in self.pins]).reshape(-1, 2)

    def ends(self, plane_m: FloatArray, launch: str, retrieval: str) -> tuple[Pin, ...]:
        """Return the pins of a path's ends (n, 2)."""
        (east, north), (east_last, north_last) = plane_m[0], plane_m[-1]
        ends = [Pin(launch, float(east), float(north), "launch")]
        # a tie point that stands at the end already names it, in whatever language
        if not any(np.hypot(pin.east_m - east_last, pin.north_m - north_last) < SAME_PLACE_M for pin in self.pins):
            ends.append(Pin(retrieval, float(east_last), float(north_last), "retrieval"))
        return tuple(ends)


def paint_pins(
    painter: QPainter,
    theme: Theme,
    pins: Sequence[tuple[Pin, QPointF]],
    radius: float,
    selected: int | None,
) -> None:
    """Draw pins at their pixels; the selected one is ringed."""
    for pin, centre in pins:
        paint_pin(painter, theme, pin.kind, centre, radius)
        if selected is not None and pin.number == selected:
            painter.setPen(QPen(QColor(theme.cursor), 2.5))
            painter.setBrush(QColor(0, 0, 0, 0))
            painter.drawEllipse(centre, 2.0 * radius, 2.0 * radius)


def name_pins(labels: Labels, pins: Sequence[tuple[Pin, QPointF]], away: float, *, strong: bool = False) -> None:
    """Write the pins' names beside them, as far as there is room."""
    for pin, centre in pins:
        labels.write(pin.name, centre, away, strong=strong)
