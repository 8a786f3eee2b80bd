"""Strips above one another over the common axis, each with its own curves, unit and vertical axis."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QWidget

from processing.survey import Channel
from widgets.curve_plot import Curve, CurvePlot, padded
from widgets.envelope import joined
from widgets.plot_axes import ValueAxis
from widgets.plot_canvas import ColumnsItem, view_box
from widgets.plot_marks import Readout
from widgets.plot_scale import Scale
from widgets.plot_theme import LIGHT, Theme
from widgets.time_cursor import TimeCursor

SHOWN_PART = 0.999
MOST_STRIPS = 3
MOST_CURVES = 3


class StripBox:
    """One strip's place in a plot: a vertical axis, and a view box with up to three curves."""

    def __init__(self, plot: pg.PlotItem, theme: Theme) -> None:
        self.axis, self.box = ValueAxis(theme), view_box()
        self.items = tuple(ColumnsItem() for _ in range(MOST_CURVES))
        for part in (self.axis, self.box):
            part.setParentItem(plot)
        for item in self.items:
            self.box.addItem(item, ignoreBounds=True)

    def place(self, room: QRectF, theme: Theme, axis_room: QRectF) -> None:
        """Stand in ``room``, with the axis left of it; its labels may fill ``axis_room``."""
        self.axis.apply_theme(theme)
        if self.box.geometry() != room:
            self.box.setGeometry(room)
            self.axis.setWidth(room.left())
            self.axis.setGeometry(QRectF(0.0, room.top(), room.left(), room.height()))
        self.axis.set_room(axis_room.translated(0.0, -room.top()))

    def show(self, visible: bool) -> None:
        """Show or hide the strip."""
        self.axis.setVisible(visible)
        self.box.setVisible(visible)


@dataclass(frozen=True)
class Strip:
    """One strip: its name, unit, curves with their colours, and its vertical axis.

    ``labels`` name the curves. Of an ``interval`` the curves are lower end, upper end and value, in this order.
    """

    name: str
    unit: str
    curves: tuple[tuple[Curve, str], ...]
    scale: Scale
    labels: tuple[str, ...] = ()
    interval: bool = False


def strip_of(
    name: str,
    unit: str,
    curves: tuple[tuple[Curve, str], ...],
    least: float,
    labels: tuple[str, ...] = (),
    *,
    from_zero: bool = False,
    interval: bool = False,
) -> Strip:
    """Return a strip whose axis holds all but the rarest values of its curves, and is at least ``least`` high."""
    spans = [span for curve, _ in curves if (span := curve.by_time.span(SHOWN_PART)) is not None]
    zero = [0.0] if from_zero else []
    whole = (min([s[0] for s in spans] + zero), max([s[1] for s in spans] + zero)) if spans else None
    return Strip(name, unit, curves, Scale(*padded(whole, least)), labels, interval)


class StripsView(CurvePlot):
    """Up to three strips; subclasses give them to :meth:`_set_strips`, and again in :meth:`_arrange`."""

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self._channel = Channel.PATH
        self._strips: tuple[Strip, ...] = ()
        self._boxes: tuple[StripBox, ...] = tuple(StripBox(self._plot, theme) for _ in range(MOST_STRIPS))

    # --- for subclasses ---

    def _arrange(self) -> None:
        """Make the strips anew: the colours may have changed."""

    def _hint(self) -> str:
        """Return what is said where there is no strip."""
        return self.tr("No motion data: the data page says why")

    def _set_strips(self, strips: Sequence[Strip]) -> None:
        self._strips = tuple(strips[:MOST_STRIPS])
        self.invalidate()

    # --- looks ---

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        super().apply_theme(theme)
        self._arrange()

    def strip_rects(self) -> list[QRectF]:
        """Return where the strips stand within the plot, top first."""
        rect, count = self.plot_rect(), len(self._strips)
        tops = [round(rect.top() + k * rect.height() / count) for k in range(count + 1)] if count else []
        return [QRectF(rect.left(), a, rect.width(), b - a - 2) for a, b in pairwise(tops)]

    def _show_data(self) -> None:
        self._show_scale(None)
        rooms = self.strip_rects()
        for number, box in enumerate(self._boxes):
            box.show(number < len(rooms))
            if number < len(rooms):
                self._show_strip(box, self._strips[number], rooms[number])

    def _show_strip(self, box: StripBox, strip: Strip, room: QRectF) -> None:
        label = strip.name if room.height() > 5 * self._theme.metrics().height() else ""
        box.axis.show_scale(strip.scale, label, self._tick_text, self._axis_left())
        box.place(room, self._theme, QRectF(self.rect()))
        box.box.setRange(
            xRange=self.x_span(), yRange=(strip.scale.low, strip.scale.high), padding=0.0, disableAutoRange=False
        )
        ratio, width = self.devicePixelRatioF(), 0.8 * self._theme.line_width
        rows = round(room.height() * ratio)
        for item in box.items[len(strip.curves) :]:
            item.hide()
        for item, (curve, colour) in zip(box.items, strip.curves, strict=False):
            low, high = joined(*curve.columns(self._cursor, self.columns()))
            item.show_columns(low, high, self.x_span(), strip.scale, rows, QColor(colour), width * ratio)

    def _value_axes(self, rect: QRectF) -> list[tuple[QRectF, ValueAxis]]:
        del rect
        return [(room, box.axis) for room, box in zip(self.strip_rects(), self._boxes, strict=False)]

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        if not self._strips:
            self._paint_hint(painter, rect, self._hint())
            return
        painter.setPen(QColor(self._theme.text))
        for room in self.strip_rects():
            painter.drawLine(room.bottomLeft() + QPointF(0, 1), room.bottomRight() + QPointF(0, 1))

    def _paint_values(self, painter: QPainter, rect: QRectF) -> None:
        for strip, room in zip(self._strips, self.strip_rects(), strict=True):
            box = QRectF(rect.left(), room.top(), rect.width(), room.height())
            self._paint_value(painter, box, 0, strip.name, self._theme.text)
            for row, (text, colour) in enumerate(self._value_lines(strip), start=1):
                self._paint_value(painter, box, row, text, colour)

    def _value_lines(self, strip: Strip) -> list[tuple[str, str]]:
        """Return what stands beside a strip, with its colour."""
        values = [curve.value_at_cursor(self._cursor) for curve, _ in strip.curves]
        if strip.interval:
            _, high, value = values
            colour = strip.curves[2][1]
            return [
                (self._value_text(value, _digits(value), strip.unit), colour),
                ("± " + self._value_text(high - value, _digits(high - value), strip.unit), self._theme.text),
            ]
        labels = strip.labels or ("",) * len(strip.curves)
        # beside a name there is little room: the first one tells the unit of all
        units = [strip.unit if k == 0 or not label else "" for k, label in enumerate(labels)]
        texts = [
            self._value_text(value, _digits(value), unit).rstrip() for value, unit in zip(values, units, strict=True)
        ]
        return [
            (f"{label} {text}" if label else text, colour)
            for label, text, (_, colour) in zip(labels, texts, strip.curves, strict=True)
        ]

    # --- the mouse ---

    def _strip_at(self, place: QPointF) -> int | None:
        return next((k for k, room in enumerate(self.strip_rects()) if room.top() <= place.y() <= room.bottom()), None)

    def _readout(self, place: QPointF) -> Readout:
        base, number = super()._readout(place), self._strip_at(place)
        if number is None:
            return base
        strip = self._strips[number]
        value = strip.curves[0][0].by_time.value_at(self.time_of_pixel(place.x()))
        known = value if math.isfinite(value) else None
        return Readout(base.time_s, base.chainage_m, base.position_w_m, value=known, unit=strip.unit)

    def _zoom_vertical(self, factor: float, place: QPointF) -> None:
        number = self._strip_at(place)
        if number is None:
            return
        strip, room = self._strips[number], self.strip_rects()[number]
        part = (room.bottom() - place.y()) / max(room.height(), 1.0)
        changed = replace(strip, scale=strip.scale.zoomed(factor, part, (-1e6, 1e6), 1e-3))
        self._strips = (*self._strips[:number], changed, *self._strips[number + 1 :])
        self.invalidate()

    def _fit_vertical(self) -> None:
        self._arrange()


def _digits(value: float) -> int:
    return 0 if abs(value) >= 1000 else 1 if abs(value) >= 10 else 2 if abs(value) >= 0.1 or value == 0.0 else 3
