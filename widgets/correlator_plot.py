"""The correlation over metres from sensor A, with its peaks, the leak's interval, and what was taken out."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen
from PySide6.QtWidgets import QWidget

from processing.correlation.correlogram import Correlogram, Peak, Suppressed
from processing.correlation.pipe import Pipe, Position, delay_of_place, place_of_delay, places_of_delays
from widgets.plot_paint import paint_hatch
from widgets.plot_scale import Scale, linear_ticks, number_text, tick_digits
from widgets.plot_theme import LIGHT, Theme
from widgets.xy_plot import XyPlot

_NEAR_PIXELS = 26.0
_BEYOND = 0.18


@dataclass(frozen=True)
class ShownCorrelation:
    """What the plot shows; ``position`` is None where no place may be given."""

    pipe: Pipe
    correlogram: Correlogram
    peaks: tuple[Peak, ...]
    chosen: Peak | None
    position: Position | None
    suppressed: tuple[Suppressed, ...]
    chance: float  # the height that chance seldom passes


class CorrelationPlot(XyPlot):
    """Click a peak to choose it; left and right go from peak to peak. Above stands the delay in milliseconds."""

    peak_chosen = Signal(float)  # its delay, s

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self._shown: ShownCorrelation | None = None
        self._metres = np.zeros(0)
        self.setAccessibleName(self.tr("Correlation along the pipe"))
        self.setToolTip(self.tr("Click a peak to choose it. Wheel zooms, drag moves, F shows all."))
        self.set_hint(self.tr("Choose the recordings of sensor A and sensor B, and say what pipe lies between them."))

    def show_correlation(self, shown: ShownCorrelation) -> None:
        """Show this result."""
        self._shown = shown
        self._metres = places_of_delays(shown.pipe, shown.correlogram.delay_s)
        length = shown.pipe.length_m
        self._set_whole(Scale(-_BEYOND * length, (1.0 + _BEYOND) * length))
        seen = (self._metres >= self._whole.low) & (self._metres <= self._whole.high)
        low = float(shown.correlogram.value[seen].min(initial=0.0))
        high = float(shown.correlogram.envelope[seen].max(initial=shown.chance))
        self._y = Scale(min(1.15 * low, -0.3 * high), 1.18 * max(high, 1e-9))
        self._x_name = self.tr("metres from sensor A")
        self._y_name = self.tr("correlation")
        self.set_hint("")

    @property
    def shown(self) -> ShownCorrelation | None:
        """What is shown."""
        return self._shown

    def pixel_of_peak(self, peak: Peak) -> QPointF:
        """Return where a peak stands in the widget."""
        assert self._shown is not None
        return QPointF(self.x_pixel(place_of_delay(self._shown.pipe, peak.delay_s)), self.y_pixel(peak.height))

    def _room_above(self) -> float:
        return 2.6 * self._theme.metrics().height()

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        shown = self._shown
        if shown is None:
            return
        length = shown.pipe.length_m
        for low, high in ((self._whole.low, 0.0), (length, self._whole.high)):
            left, right = self.x_pixel(low), self.x_pixel(high)
            if right > left:
                paint_hatch(painter, QRectF(left, rect.top(), right - left, rect.height()), self._theme)
        self._paint_suppressed(painter, rect, shown)
        if shown.position is not None:
            self._shade(painter, shown.position.low95_m, shown.position.high95_m, self._theme.curve_third, 90)
        painter.setPen(QPen(QColor(self._theme.not_assessed), self._theme.line_width, Qt.PenStyle.DashLine))
        for height in (shown.chance, -shown.chance):
            painter.drawLine(QPointF(rect.left(), self.y_pixel(height)), QPointF(rect.right(), self.y_pixel(height)))
        self._curve(painter, self._metres, shown.correlogram.envelope, self._theme.route, 0.8)
        self._curve(painter, self._metres, shown.correlogram.value, self._theme.curve)
        self._paint_peaks(painter, shown)

    def _paint_suppressed(self, painter: QPainter, rect: QRectF, shown: ShownCorrelation) -> None:
        metrics = self._theme.metrics()
        for gone in shown.suppressed:
            edges = [place_of_delay(shown.pipe, gone.delay_s + s * gone.half_width_s) for s in (1, -1)]
            self._shade(painter, edges[0], edges[1], self._theme.not_assessed, 60)
            painter.setPen(QColor(self._theme.not_assessed))
            name = gone.name or self.tr("taken out")
            painter.drawText(QPointF(self.x_pixel(edges[1]) + 3, rect.bottom() - 0.4 * metrics.height()), name)

    def _paint_peaks(self, painter: QPainter, shown: ShownCorrelation) -> None:
        metrics = self._theme.metrics()
        for number, peak in enumerate(shown.peaks, 1):
            if abs(peak.height) < shown.chance and peak is not shown.chosen:
                continue
            place = self.pixel_of_peak(peak)
            chosen = peak is shown.chosen
            radius = (0.42 if chosen else 0.3) * metrics.height()
            painter.setPen(QPen(QColor(self._theme.outline), 1.0))
            painter.setBrush(QColor(self._theme.cursor if chosen else self._theme.curve_second))
            painter.drawEllipse(place, radius, radius)
            painter.setPen(QColor(self._theme.text))
            above = -1 if peak.height >= 0 else 1
            height = metrics.height()
            box = QRectF(place.x() - 20, place.y() + above * 1.05 * height - 0.5 * height, 40, height)
            if box.top() < self.plot_rect().top() or box.bottom() > self.plot_rect().bottom():
                box.moveCenter(QPointF(place.x() + 1.1 * height, place.y()))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, str(number))

    def _paint_over(self, painter: QPainter, rect: QRectF) -> None:
        shown = self._shown
        if shown is None:
            return
        metrics = self._theme.metrics()
        painter.setPen(QPen(QColor(self._theme.text), 1.3 * self._theme.line_width))
        for name, metres in (("A", 0.0), ("B", shown.pipe.length_m)):
            x = self.x_pixel(metres)
            if rect.left() <= x <= rect.right():
                painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
                foot = QRectF(x + 4, rect.bottom() - metrics.height() - 3, 30, metrics.height())
                painter.drawText(foot, Qt.AlignmentFlag.AlignLeft, name)
        position = shown.position
        if position is not None and rect.left() <= self.x_pixel(position.from_a_m) <= rect.right():
            x = self.x_pixel(position.from_a_m)
            painter.setPen(QPen(QColor(self._theme.cursor), 1.3 * self._theme.line_width))
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
        self._paint_delays(painter, rect, shown)
        entries = [
            (self.tr("correlation"), self._theme.curve),
            (self.tr("envelope"), self._theme.route),
            (self.tr("chance (99 %)"), self._theme.not_assessed),
        ]
        self._legend(painter, rect, entries)

    def _paint_delays(self, painter: QPainter, rect: QRectF, shown: ShownCorrelation) -> None:
        """Write the delay in milliseconds along the upper edge."""
        metrics = self._theme.metrics()
        high_ms, low_ms = (1e3 * delay_of_place(shown.pipe, metres) for metres in self.x_range)
        painter.setPen(QColor(self._theme.text))
        if not (math.isfinite(low_ms) and high_ms > low_ms):
            return
        values = linear_ticks(low_ms, high_ms, max(2, int(rect.width() / 90)))
        step = min((b - a for a, b in pairwise(values)), default=1.0)
        for value in values:
            x = self.x_pixel(place_of_delay(shown.pipe, 1e-3 * value))
            painter.drawLine(QPointF(x, rect.top() - 4), QPointF(x, rect.top()))
            text = number_text(value, tick_digits(step), self.locale())
            box = QRectF(x - 60, rect.top() - 5 - metrics.height(), 120, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
        name = QRectF(rect.left(), 0.0, rect.width(), 1.3 * metrics.height())
        painter.drawText(name, Qt.AlignmentFlag.AlignCenter, self.tr("delay of B (ms)"))

    def _click(self, place: QPointF) -> None:
        shown = self._shown
        if shown is None or not shown.peaks:
            return
        nearest = min(shown.peaks, key=lambda peak: abs(self.pixel_of_peak(peak).x() - place.x()))
        if abs(self.pixel_of_peak(nearest).x() - place.x()) <= _NEAR_PIXELS:
            self.peak_chosen.emit(nearest.delay_s)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Left and right choose the next peak; the rest is zooming."""
        shown = self._shown
        arrows = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
        step = arrows.get(Qt.Key(event.key()))
        plain = event.modifiers() == Qt.KeyboardModifier.NoModifier
        if step is None or not plain or shown is None or not shown.peaks:
            super().keyPressEvent(event)
            return
        in_order: Sequence[Peak] = sorted(shown.peaks, key=lambda peak: -peak.delay_s)
        at = in_order.index(shown.chosen) if shown.chosen in in_order else 0
        self.peak_chosen.emit(in_order[min(max(at + step, 0), len(in_order) - 1)].delay_s)

    def _words_at(self, place: QPointF) -> str:
        shown = self._shown
        if shown is None:
            return ""
        metres = self.x_value(place.x())
        delay_s = delay_of_place(shown.pipe, metres)
        return self.tr("{metres} m from A · {delay} ms · correlation {value}").format(
            metres=number_text(metres, 2, self.locale()),
            delay=number_text(1e3 * delay_s, 2, self.locale()),
            value=number_text(shown.correlogram.at(delay_s), 3, self.locale()),
        )
