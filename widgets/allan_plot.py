"""The sensors' own noise at rest: Allan deviation against averaging time, on two logarithmic axes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme

MOST_DIGITS = 5


@dataclass(frozen=True)
class AllanLines:
    """One sensor's curves: ``tau_s`` (k,), deviation and its 95 % interval (k, 3), in ``unit``."""

    title: str
    unit: str
    tau_s: FloatArray
    deviation: FloatArray
    low: FloatArray
    high: FloatArray


class AllanPlot(PaintedWidget):
    """Two plots side by side, gyro and accelerometer; the shade is the 95 % interval of each axis."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._lines: tuple[AllanLines, ...] = ()
        self._hint = ""
        self.setAccessibleName(self.tr("Noise of the sensors"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(220, 140)

    def set_lines(self, lines: Sequence[AllanLines], hint: str = "") -> None:
        """Show these; ``hint`` is said where there are none."""
        self._lines, self._hint = tuple(lines), hint
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def _paint(self, painter: QPainter) -> None:
        """Draw the plots below one another."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        painter.fillRect(self.rect(), QColor(self._theme.background))
        if not self._lines:
            painter.setPen(QColor(self._theme.text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(QRectF(self.rect()).adjusted(20, 20, -20, -20), flags, self._hint)
            return
        height = self.height() / len(self._lines)
        for number, lines in enumerate(self._lines):
            self._paint_plot(painter, lines, QRectF(0.0, number * height, self.width(), height))

    def _paint_plot(self, painter: QPainter, lines: AllanLines, room: QRectF) -> None:
        metrics = self._theme.metrics()
        rect = room.adjusted(
            metrics.horizontalAdvance("0.00001") + 10, 1.6 * metrics.height(), -14, -1.7 * metrics.height()
        )
        axes = _Axes(rect, lines)
        painter.fillRect(rect, QColor(self._theme.canvas))
        painter.setPen(QColor(self._theme.text))
        painter.drawText(QPointF(rect.left(), rect.top() - 0.5 * metrics.height()), f"{lines.title} ({lines.unit})")
        self._paint_grid(painter, axes, rect)
        painter.save()
        painter.setClipRect(rect)
        colours = (self._theme.curve, self._theme.curve_second, self._theme.curve_third)
        for axis, colour in enumerate(colours):
            shade = QColor(colour)
            shade.setAlpha(45)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(shade)
            low, high = lines.low[:, axis], lines.high[:, axis]
            painter.drawPolygon(
                axes.polygon(np.concatenate([lines.tau_s, lines.tau_s[::-1]]), np.concatenate([low, high[::-1]]))
            )
            painter.setPen(QPen(QColor(colour), 1.3 * self._theme.line_width))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawPolyline(axes.polygon(lines.tau_s, lines.deviation[:, axis]))
        painter.restore()
        painter.setPen(QPen(QColor(self._theme.text), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(rect)
        for axis, (name, colour) in enumerate(zip("xyz", colours, strict=True)):
            painter.setPen(QColor(colour))
            painter.drawText(QPointF(rect.right() - (3 - axis) * 1.2 * metrics.height(), rect.top() - 4), name)

    def _paint_grid(self, painter: QPainter, axes: "_Axes", rect: QRectF) -> None:
        metrics, grid, text = self._theme.metrics(), QPen(QColor(self._theme.grid), 1), QColor(self._theme.text)
        for power in range(math.ceil(axes.x_low), math.floor(axes.x_high) + 1):
            x = axes.pixel(10.0**power, 1.0).x()
            painter.setPen(grid)
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
            painter.setPen(text)
            box = QRectF(x - 40, rect.bottom() + 2, 80, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"{_tick(power)} s")
        for power in range(math.ceil(axes.y_low), math.floor(axes.y_high) + 1):
            y = axes.pixel(1.0, 10.0**power).y()
            painter.setPen(grid)
            painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
            painter.setPen(text)
            box = QRectF(0, y - 0.5 * metrics.height(), rect.left() - 5, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, _tick(power))


class _Axes:
    """Where averaging times and deviations lie in a plot: both logarithmic, with a whole decade at least."""

    def __init__(self, rect: QRectF, lines: AllanLines) -> None:
        self._rect = rect
        self.x_low, self.x_high = np.log10(lines.tau_s[0]), np.log10(max(lines.tau_s[-1], 2.0 * lines.tau_s[0]))
        known = lines.deviation[np.isfinite(lines.deviation) & (lines.deviation > 0.0)]
        low, high = (np.log10(known.min()), np.log10(known.max())) if len(known) else (-3.0, 0.0)
        middle, half = 0.5 * (low + high), max(0.55 * (high - low) + 0.15, 0.6)
        self.y_low, self.y_high = middle - half, middle + half

    def pixel(self, tau_s: float, deviation: float) -> QPointF:
        """Return the pixel of one point."""
        return self.polygon(np.array([tau_s]), np.array([deviation])).at(0)

    def polygon(self, tau_s: FloatArray, deviation: FloatArray) -> QPolygonF:
        """Return pixels of points (k,)."""
        x = (np.log10(tau_s) - self.x_low) / (self.x_high - self.x_low)
        y = (np.log10(np.maximum(np.nan_to_num(deviation, posinf=1e9), 1e-12)) - self.y_low) / (
            self.y_high - self.y_low
        )
        left = self._rect.left() + x * self._rect.width()
        top = self._rect.bottom() - np.clip(y, -3.0, 4.0) * self._rect.height()
        return QPolygonF([QPointF(a, b) for a, b in zip(left.tolist(), top.tolist(), strict=True)])


def _tick(power: int) -> str:
    """Return a power of ten as the window's locale writes it."""
    return number_text(10.0**power, max(0, -power)) if abs(power) <= MOST_DIGITS else f"1e{power}"
