"""Spectra of chosen stretches over a logarithmic axis of frequency, with their intervals, or what one has over another.

Marks name lines that were found, such as the harmonics of a pump. The mouse, or the arrow keys, read values off.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QKeyEvent, QMouseEvent, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.painted_widget import PaintedWidget
from widgets.plot_paint import paint_legend, paint_tag
from widgets.plot_scale import Scale, ScaleKind, hertz_name, number_text, tick_digits
from widgets.plot_theme import LIGHT, Theme

LEAST_SPAN_DB = 12.0
KEY_STEP = 1.0 / 200.0  # of the axis
CELL_PIXELS = 1.5


@dataclass(frozen=True)
class SpectrumCurve:
    """A named curve, (n,) each: frequencies rising, decibels, and the ends of their intervals."""

    name: str
    frequency_hz: FloatArray
    level_db: FloatArray
    low_db: FloatArray
    high_db: FloatArray


@dataclass(frozen=True)
class SpectrumMark:
    """A frequency with a word, such as ``3 × 49.5 Hz``."""

    frequency_hz: float
    text: str


class SpectrumView(PaintedWidget):
    """Up to three curves; all of it is painted anew when something has changed, which is rare."""

    pointed = Signal(object)  # Hz under the mouse or the keyboard's line, or None

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._curves: tuple[SpectrumCurve, ...] = ()
        self._unit, self._hint = "", ""
        self._zero = False
        self._bands: tuple[tuple[float, float], ...] = ()
        self._marks: tuple[SpectrumMark, ...] = ()
        self._frequency = Scale(50.0, 10_000.0, ScaleKind.LOG)
        self._level = Scale(-100.0, 0.0)
        self._at_hz: float | None = None
        self.setAccessibleName(self.tr("Spectrum"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(220, 160)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    # --- what it is told ----------------------------------------------------------------------------------------

    def set_curves(
        self,
        curves: Sequence[SpectrumCurve],
        unit: str = "",
        *,
        zero: bool = False,
        bands_hz: Sequence[tuple[float, float]] = (),
        lowest_hz: float = 30.0,
    ) -> None:
        """Show curves in ``unit``, with a line at ``zero``, and shade the bands that stand out."""
        self._curves, self._unit, self._zero = tuple(curves), unit, zero
        self._bands = tuple(bands_hz)
        if curves:
            highest = max(float(curve.frequency_hz[-1]) for curve in curves)
            first = max(lowest_hz, *(float(curve.frequency_hz[1]) for curve in curves))
            self._frequency = Scale(min(first, 0.5 * highest), highest, ScaleKind.LOG)
            self._level = self._span_of(curves)
        self.update()

    def set_hint(self, text: str) -> None:
        """Say this where there is no curve."""
        self._hint = text
        self.update()

    def set_marks(self, marks: Sequence[SpectrumMark]) -> None:
        """Name these frequencies."""
        self._marks = tuple(marks)
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    @property
    def curves(self) -> tuple[SpectrumCurve, ...]:
        """What is shown."""
        return self._curves

    def _span_of(self, curves: Sequence[SpectrumCurve]) -> Scale:
        """Return a vertical axis that holds the curves and nearly all of their intervals."""
        values = []
        for curve in curves:
            seen = (curve.frequency_hz >= self._frequency.low) & (curve.frequency_hz <= 0.95 * self._frequency.high)
            values.append(curve.level_db[seen])
        known = np.concatenate(values)
        known = known[np.isfinite(known)]
        low, high = (float(v) for v in np.percentile(known, (0.2, 100.0))) if len(known) else (-100.0, 0.0)
        if self._zero:
            low, high = min(low, 0.0), max(high, 0.0)
        spare = max(0.06 * (high - low), 0.5 * (LEAST_SPAN_DB - (high - low)))
        return Scale(low - spare, high + spare)

    # --- geometry -----------------------------------------------------------------------------------------------

    def plot_rect(self) -> QRectF:
        """Return where the curves are drawn."""
        metrics = self._theme.metrics()
        left = metrics.horizontalAdvance("−100") + 1.3 * metrics.height() + 10
        return QRectF(self.rect()).adjusted(left, 6.0, -12.0, -1.6 * metrics.height())

    def x_of(self, frequency_hz: float) -> float:
        """Return the pixel of a frequency."""
        rect = self.plot_rect()
        return rect.left() + float(self._frequency.fraction(frequency_hz)) * rect.width()

    def frequency_at(self, x: float) -> float:
        """Return the frequency of a pixel."""
        rect = self.plot_rect()
        part = (x - rect.left()) / max(rect.width(), 1.0)
        return float(self._frequency.value(min(max(part, 0.0), 1.0)))

    def y_of(self, level_db: float) -> float:
        """Return the pixel of a level."""
        rect = self.plot_rect()
        return rect.bottom() - float(self._level.fraction(level_db)) * rect.height()

    def values_at(self, frequency_hz: float) -> list[tuple[str, float, float, float]]:
        """Return name, level and interval of each curve at a frequency."""
        found = []
        for curve in self._curves:
            row = int(np.argmin(np.abs(curve.frequency_hz - frequency_hz)))
            level, low, high = (float(v[row]) for v in (curve.level_db, curve.low_db, curve.high_db))
            found.append((curve.name, level, low, high))
        return found

    def sizeHint(self) -> QSize:
        """Prefer some height."""
        return QSize(420, round(16 * self._theme.metrics().height()))

    # --- painting -----------------------------------------------------------------------------------------------

    def image(self, width: int = 1400, height: int = 700) -> QImage:
        """Return the plot as a picture, as it is now, at another size."""
        target = QImage(width, height, QImage.Format.Format_RGB32)
        whole = SpectrumView(self._theme)
        whole.resize(width, height)
        whole._curves, whole._unit, whole._zero, whole._bands = self._curves, self._unit, self._zero, self._bands
        whole._marks, whole._frequency, whole._level = self._marks, self._frequency, self._level
        whole._hint = self._hint
        painter = QPainter(target)
        try:
            whole._paint(painter)
        finally:
            painter.end()
        return target

    def _paint(self, painter: QPainter) -> None:
        theme, rect = self._theme, self.plot_rect()
        painter.setFont(theme.font())
        painter.fillRect(self.rect(), QColor(theme.background))
        painter.fillRect(rect, QColor(theme.canvas))
        if not self._curves:
            painter.setPen(QColor(theme.text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(rect.adjusted(8, 8, -8, -8), flags, self._hint)
            return
        painter.save()
        painter.setClipRect(rect)
        for low_hz, high_hz in self._bands:
            shade = QColor(theme.accent)
            shade.setAlpha(45)
            painter.fillRect(
                QRectF(QPointF(self.x_of(low_hz), rect.top()), QPointF(self.x_of(high_hz), rect.bottom())), shade
            )
        painter.restore()
        self._paint_axes(painter, rect)
        painter.save()
        painter.setClipRect(rect)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for curve, colour in zip(self._curves, self._colours(), strict=False):
            self._paint_curve(painter, rect, curve, colour)
        painter.restore()
        self._paint_marks(painter, rect)
        pairs = [(c.name, colour) for c, colour in zip(self._curves, self._colours(), strict=False)]
        paint_legend(painter, rect, theme, pairs)
        self._paint_reading(painter, rect)
        painter.setPen(QPen(QColor(theme.accent if self.hasFocus() else theme.text), 2 if self.hasFocus() else 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(rect)

    def _colours(self) -> tuple[str, str, str]:
        return self._theme.curve, self._theme.curve_second, self._theme.curve_third

    def _paint_axes(self, painter: QPainter, rect: QRectF) -> None:
        theme, metrics = self._theme, self._theme.metrics()
        grid, text = QPen(QColor(theme.grid), 1), QColor(theme.text)
        most = max(3, int(rect.width() / (1.8 * metrics.horizontalAdvance("0.0 kHz"))))
        for value in self._frequency.ticks(most):
            x = self.x_of(value)
            painter.setPen(grid)
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
            painter.setPen(text)
            label = hertz_name(value, self.locale())
            box = QRectF(x - 40, rect.bottom() + 2, 80, 1.4 * metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, label)
        ticks = self._level.ticks(max(3, int(rect.height() / (2.0 * metrics.height()))))
        digits = tick_digits(ticks[1] - ticks[0]) if len(ticks) > 1 else 0
        for value in ticks:
            y = self.y_of(value)
            painter.setPen(grid)
            painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
            painter.setPen(text)
            box = QRectF(
                1.3 * metrics.height(),
                y - metrics.height(),
                rect.left() - 1.3 * metrics.height() - 5,
                2 * metrics.height(),
            )
            flags = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            painter.drawText(box, flags, number_text(value, digits, self.locale()))
        if self._zero:
            painter.setPen(QPen(text, 1.5))
            painter.drawLine(QPointF(rect.left(), self.y_of(0.0)), QPointF(rect.right(), self.y_of(0.0)))
        painter.save()
        painter.translate(0.75 * metrics.height(), rect.center().y())
        painter.rotate(-90.0)
        painter.setPen(text)
        painter.drawText(
            QRectF(-0.5 * rect.height(), -metrics.height(), rect.height(), 2 * metrics.height()),
            Qt.AlignmentFlag.AlignCenter,
            self._unit,
        )
        painter.restore()

    def _paint_curve(self, painter: QPainter, rect: QRectF, curve: SpectrumCurve, colour: str) -> None:
        x, level, low, high = _cells(curve, self._frequency, rect)
        if len(x) < 2:
            return
        pixels = [
            rect.bottom() - self._level.fraction(np.clip(v, -400.0, 400.0)) * rect.height() for v in (level, low, high)
        ]
        middle, bottom, top = (np.clip(p, rect.top() - 2000, rect.bottom() + 2000).tolist() for p in pixels)
        places = x.tolist()
        shade = QColor(colour)
        shade.setAlpha(60)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(shade)
        edge = [QPointF(a, b) for a, b in zip(places, top, strict=True)]
        edge += [QPointF(a, b) for a, b in zip(places[::-1], bottom[::-1], strict=True)]
        painter.drawPolygon(QPolygonF(edge))
        painter.setPen(QPen(QColor(colour), self._theme.line_width))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolyline(QPolygonF([QPointF(a, b) for a, b in zip(places, middle, strict=True)]))

    def _paint_marks(self, painter: QPainter, rect: QRectF) -> None:
        metrics, last = self._theme.metrics(), -math.inf
        for mark in sorted(self._marks, key=lambda m: m.frequency_hz):
            if not self._frequency.low <= mark.frequency_hz <= self._frequency.high:
                continue
            x = self.x_of(mark.frequency_hz)
            painter.setPen(QPen(QColor(self._theme.cursor), 1, Qt.PenStyle.DotLine))
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
            width = metrics.horizontalAdvance(mark.text) + 8
            if x - 0.5 * width > max(last, rect.left()) and x + 0.5 * width < rect.right():
                box = QRectF(x - 0.5 * width, rect.bottom() - 1.4 * metrics.height(), width, 1.3 * metrics.height())
                paint_tag(painter, self._theme, mark.text, box)
                last = box.right()

    def _paint_reading(self, painter: QPainter, rect: QRectF) -> None:
        if self._at_hz is None:
            return
        x, metrics = self.x_of(self._at_hz), self._theme.metrics()
        painter.setPen(QPen(QColor(self._theme.cursor), self._theme.line_width))
        painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
        lines = self.reading(self._at_hz)
        width = max(metrics.horizontalAdvance(line) for line in lines) + 14
        height = metrics.height() * len(lines) + 6
        left = x + 8 if x + 8 + width < rect.right() else x - 8 - width
        box = QRectF(max(left, rect.left()), rect.top() + 1.6 * metrics.height(), width, height)
        paint_tag(painter, self._theme, "\n".join(lines), box, strong=True)

    def reading(self, frequency_hz: float) -> list[str]:
        """Return what is read off at a frequency: the frequency, and a line a curve."""
        locale = self.locale()
        lines = [f"{number_text(frequency_hz, 0, locale)} Hz"]
        for name, level, low, high in self.values_at(frequency_hz):
            half = number_text(0.5 * (high - low), 1, locale)
            lines.append(f"{name}: {number_text(level, 1, locale)} ± {half} dB")
        return lines

    # --- mouse and keys -----------------------------------------------------------------------------------------

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Read off under the mouse."""
        inside = self.plot_rect().contains(event.position())
        self._point(self.frequency_at(event.position().x()) if inside else None)

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing lies under the mouse any more."""
        super().leaveEvent(event)
        self._point(None)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Let the arrow keys move the line, with Shift by as much as ten steps."""
        steps = {Qt.Key.Key_Left: -1.0, Qt.Key.Key_Right: 1.0}.get(Qt.Key(event.key()))
        if steps is None or not self._curves:
            super().keyPressEvent(event)
            return
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            steps *= 10.0
        at = 0.5 if self._at_hz is None else float(self._frequency.fraction(self._at_hz))
        self._point(float(self._frequency.value(min(max(at + steps * KEY_STEP, 0.0), 1.0))))

    def _point(self, frequency_hz: float | None) -> None:
        if frequency_hz != self._at_hz and self._curves:
            self._at_hz = frequency_hz
            self.pointed.emit(frequency_hz)
            self.update()


def _cells(curve: SpectrumCurve, axis: Scale, rect: QRectF) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return pixels and values of a curve, the bins that share a pixel averaged: few where bins are wide."""
    seen = np.flatnonzero((curve.frequency_hz >= axis.low) & (curve.frequency_hz <= axis.high))
    if len(seen) == 0:
        return (np.zeros(0),) * 4
    x = rect.left() + axis.fraction(curve.frequency_hz[seen]) * rect.width()
    cell = np.floor(x / CELL_PIXELS)
    starts = np.flatnonzero(np.append(True, np.diff(cell) > 0))
    counts = np.diff(np.append(starts, len(seen)))
    means = [
        np.add.reduceat(v, starts) / counts
        for v in (x, *(c[seen] for c in (curve.level_db, curve.low_db, curve.high_db)))
    ]
    return means[0], means[1], means[2], means[3]
