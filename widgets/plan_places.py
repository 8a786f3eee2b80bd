"""The places on the plan: pins of known places and marks of leaks, each with its name where there is room for one."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from processing.survey import Candidate
from widgets.path_paint import Labels
from widgets.plan_pins import Pin, name_pins, paint_pins
from widgets.plot_marks import Marks
from widgets.plot_theme import Theme, VerdictMarks


@dataclass(frozen=True)
class PlanPlaces:
    """What is to be drawn: pins and candidates with their pixels, the lesser ones first."""

    pins: Sequence[tuple[Pin, QPointF]]
    selected_pin: int | None
    candidates: Sequence[tuple[Candidate, QPointF]]
    marks: Marks
    radius: float


def paint_dug(painter: QPainter, theme: Theme, centre: QPointF, radius: float) -> None:
    """Draw the pit around a leak that was dug up: a square, which no verdict has."""
    side = 3.0 * radius
    painter.setPen(QPen(QColor(theme.text), theme.line_width))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRect(QRectF(centre.x() - side / 2, centre.y() - side / 2, side, side))


def paint_places(
    painter: QPainter, labels: Labels, theme: Theme, places: PlanPlaces, pixmaps: VerdictMarks, *, names: bool
) -> None:
    """Draw pins and marks; ``names`` also writes those of the leaks."""
    pins, radius, selected = places.pins, places.radius, places.marks.selected
    chosen = [pair for pair in pins if pair[0].number is not None and pair[0].number == places.selected_pin]
    name_pins(labels, chosen, radius + 3, strong=True)  # what one works on is named while there is room
    paint_pins(painter, theme, list(pins), 0.7 * radius, places.selected_pin)
    for candidate, centre in places.candidates:
        pixmaps.paint(painter, places.marks.verdict(candidate), centre, selected=candidate.id == selected)
        if candidate.label in (places.marks.dug or {}):
            paint_dug(painter, theme, centre, radius)
    # the weighty ones are painted last but named first, so that they get a place
    for candidate, centre in reversed(places.candidates) if names else ():
        sign = (places.marks.dug or {}).get(candidate.label)
        name = str(candidate.label) if sign is None else f"{candidate.label} [{sign}]"
        labels.write(name, centre, radius + 3, strong=candidate.id == selected)
    name_pins(labels, [pair for pair in pins if pair not in chosen], radius + 3)
