"""A plot of curves over the common axis: pyramids in, pixel columns out, a vertical axis that does not jump."""

import math
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QWidget

from processing.survey import FloatArray
from widgets.envelope import EnvelopePyramid, joined
from widgets.linked_plot import LinkedPlot
from widgets.plot_canvas import ColumnsItem
from widgets.plot_scale import Scale, number_text, tick_digits
from widgets.plot_theme import LIGHT, Theme
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor


@dataclass(frozen=True)
class Curve:
    """One signal, over time and, where it was computed in metres, over chainage too."""

    by_time: EnvelopePyramid
    by_chainage: EnvelopePyramid | None = None

    def columns(self, cursor: TimeCursor, count: int, *, whole: bool = False) -> tuple[FloatArray, FloatArray]:
        """Return minima and maxima (count,) in the pixel columns of the visible, or the whole, range."""
        if self.by_chainage is not None and cursor.axis_mode is AxisMode.DISTANCE:
            low, high = cursor.x_extent if whole else cursor.x_range
            return self.by_chainage.columns(np.linspace(low, high, count + 1))
        return self.by_time.columns(cursor.column_edges_s(count, whole=whole))

    def value_at_cursor(self, cursor: TimeCursor) -> float:
        """Return the value at the cursor; NaN for none."""
        if self.by_chainage is not None and cursor.axis_mode is AxisMode.DISTANCE:
            return self.by_chainage.value_at(float(cursor.x_of_time(cursor.time_s)))
        return self.by_time.value_at(cursor.time_s)


def padded(span: tuple[float, float] | None, least: float, margin: float = 0.06) -> tuple[float, float]:
    """Return a span widened to ``least`` and by a margin on either side, so that curves do not lie on the frame."""
    low, high = span if span is not None else (0.0, least)
    if high - low < least:
        low, high = 0.5 * (low + high - least), 0.5 * (low + high + least)
    return low - margin * (high - low), high + margin * (high - low)


class CurvePlot(LinkedPlot):
    """A plot with one vertical axis; subclasses fill it with curves."""

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self._whole_scale = Scale(0.0, 1.0)
        self._scale = self._whole_scale

    @property
    def y_range(self) -> tuple[float, float]:
        """The visible span of the vertical axis."""
        return self._scale.low, self._scale.high

    def y_of(self, value: float) -> float:
        """Return the widget's pixel of a value."""
        rect = self.plot_rect()
        return rect.bottom() - float(self._scale.fraction(value)) * rect.height()

    def value_of_pixel(self, y: float) -> float:
        """Return the value of one of the widget's pixels."""
        rect = self.plot_rect()
        return float(self._scale.value((rect.bottom() - y) / rect.height()))

    def _set_whole(self, low: float, high: float) -> None:
        self._whole_scale = self._scale = Scale(low, high)

    def _new_curve(self) -> ColumnsItem:
        item = ColumnsItem()
        self._plot.addItem(item, ignoreBounds=True)
        return item

    def _show_scale(self, scale: Scale | None, name: str = "") -> None:
        """Let the vertical axis have this scale; None leaves it empty."""
        self._value_axis.show_scale(scale, name, self._tick_text, self._axis_left())
        self._plot.vb.setRange(yRange=self.y_range, padding=0.0, disableAutoRange=False)

    def _tick_text(self, value: float, step: float) -> str:
        return number_text(value, tick_digits(step), self.locale())

    def _show_curve(self, item: ColumnsItem, curve: Curve | None, colour: str, width: float = 1.0) -> None:
        if curve is None:
            item.hide()
        else:
            low, high = joined(*curve.columns(self._cursor, self.columns()))
            self._show_columns(item, low, high, QColor(colour), width * self._theme.line_width)

    def _show_columns(
        self, item: ColumnsItem, low: FloatArray, high: FloatArray, colour: QColor, width: float = 0.0
    ) -> None:
        ratio = self.devicePixelRatioF()
        rows = round(self.plot_rect().height() * ratio)
        item.show_columns(low, high, self.x_span(), self._scale, rows, colour, width * ratio)

    def _paint_value(self, painter: QPainter, rect: QRectF, row: int, text: str, colour: str) -> None:
        height = self._theme.metrics().height()
        painter.setPen(QColor(colour))
        box = QRectF(rect.left() + 2, rect.top() + row * height, rect.width() - 2, height)
        if box.bottom() <= rect.bottom() + 2:
            shown = self._theme.metrics().elidedText(text, Qt.TextElideMode.ElideRight, box.width())
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, shown)

    def _value_text(self, value: float, digits: int, unit: str) -> str:
        return f"{number_text(value, digits, self.locale())} {unit}" if math.isfinite(value) else "–"

    def _zoom_vertical(self, factor: float, place: QPointF) -> None:
        rect = self.plot_rect()
        whole = self._whole_scale
        part = (rect.bottom() - place.y()) / rect.height()
        limits = (whole.low, whole.high)
        self._scale = self._scale.zoomed(factor, part, limits, (whole.high - whole.low) * 1e-3)
        self.invalidate()

    def _fit_vertical(self) -> None:
        self._scale = self._whole_scale
        self.invalidate()
