"""Small painted pieces of the evidence panel: chances of classes, a value among its usual ones, two little plots."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.painted_widget import PaintedWidget
from widgets.plot_theme import Theme
from widgets.vocabulary import number

_MOST_NATS = 4.0  # of evidence that fill the bar
_LEAST_SPAN_DB = 6.0


class Painted(PaintedWidget):
    """A piece of fixed height that paints itself in the theme's colours."""

    def __init__(self, theme: Theme, lines: float, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme, self._lines = theme, lines
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def apply_theme(self, theme: Theme) -> None:
        """Paint in this theme from now on."""
        self._theme = theme
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        """Qt: as many lines of text high as was asked for."""
        return QSize(200, round(self._lines * self._theme.metrics().height()) + 6)

    def minimumSizeHint(self) -> QSize:
        """Qt: as narrow as one likes."""
        return QSize(60, self.sizeHint().height())

    def _paint(self, painter: QPainter) -> None:
        """Qt: paint on the canvas's colour."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        self.paint_piece(painter, QRectF(self.rect()))

    def paint_piece(self, painter: QPainter, rect: QRectF) -> None:
        """Paint the piece into ``rect``."""
        raise NotImplementedError

    def _pen(self, colour: str, width: float = 1.0) -> QPen:
        return QPen(QColor(colour), width * self._theme.line_width)


class ChancesBar(Painted):
    """The chances of the likeliest classes as bars with their names."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(theme, 3.6, parent)
        self._chances: tuple[tuple[str, float], ...] = ()

    def show_chances(self, chances: Sequence[tuple[str, float]]) -> None:
        """Show up to three names with their probability (0..1), likeliest first."""
        self._chances = tuple(chances)[:3]
        told = ", ".join(f"{name} {number(100 * p, 0)} %" for name, p in self._chances)
        self.setAccessibleDescription(told)
        self.update()

    def paint_piece(self, painter: QPainter, rect: QRectF) -> None:
        """Paint one bar a class."""
        height = rect.height() / 3
        metrics = self._theme.metrics()
        left = max((metrics.horizontalAdvance(name) for name, _ in self._chances), default=0.0) + 10
        right = metrics.horizontalAdvance("100 %") + 8
        for row, (name, chance) in enumerate(self._chances):
            box = QRectF(rect.left(), rect.top() + row * height, rect.width(), height)
            painter.setPen(QColor(self._theme.text))
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, name)
            painter.drawText(
                box, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignRight, f"{number(100 * chance, 0)} %"
            )
            bar = box.adjusted(left, height * 0.2, -right, -height * 0.2)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(self._theme.grid))
            painter.drawRect(bar)
            painter.setBrush(QColor(self._theme.accent if row == 0 else self._theme.route))
            painter.drawRect(QRectF(bar.left(), bar.top(), bar.width() * chance, bar.height()))


@dataclass(frozen=True)
class Weighed:
    """A value among its usual ones (``quantiles``: 5, 25, 50, 75, 95 %) and what it says for a leak, in nats."""

    value: float
    quantiles: tuple[float, ...]
    for_leak: float


class WeighedStrip(Painted):
    """Left: the value as a dot on the spread of the rest of the pipe. Right: a bar to the side that it speaks for."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(theme, 1.3, parent)
        self._weighed = Weighed(math.nan, (math.nan,) * 5, 0.0)

    def show_weighed(self, weighed: Weighed) -> None:
        """Show this figure."""
        self._weighed = weighed
        self.update()

    def paint_piece(self, painter: QPainter, rect: QRectF) -> None:
        """Paint both halves."""
        usual = QRectF(rect.left() + 4, rect.top() + 2, rect.width() * 0.62 - 10, rect.height() - 4)
        verdict = QRectF(rect.left() + rect.width() * 0.66, rect.top() + 2, rect.width() * 0.34 - 4, rect.height() - 4)
        self._paint_spread(painter, usual)
        self._paint_bar(painter, verdict)

    def _paint_spread(self, painter: QPainter, rect: QRectF) -> None:
        shown = self._weighed
        known = [v for v in (*shown.quantiles, shown.value) if math.isfinite(v)]
        low, high = (min(known), max(known)) if known else (0.0, 1.0)
        margin = 0.08 * (high - low) or 1.0
        low, high = low - margin, high + margin
        middle = rect.center().y()

        def x(value: float) -> float:
            return rect.left() + (value - low) / (high - low) * rect.width()

        painter.setPen(self._pen(self._theme.grid))
        painter.drawLine(QPointF(rect.left(), middle), QPointF(rect.right(), middle))
        if all(math.isfinite(q) for q in shown.quantiles):
            first, quarter, half, three, last = (x(q) for q in shown.quantiles)
            painter.setPen(self._pen(self._theme.route))
            painter.drawLine(QPointF(first, middle), QPointF(last, middle))
            painter.setBrush(QColor(self._theme.band))
            box = rect.height() * 0.3
            painter.drawRect(QRectF(quarter, middle - box, max(three - quarter, 1.0), 2 * box))
            painter.setPen(self._pen(self._theme.text))
            painter.drawLine(QPointF(half, middle - box), QPointF(half, middle + box))
        if math.isfinite(shown.value):
            painter.setPen(QPen(QColor(self._theme.outline), 2.0))
            painter.setBrush(QColor(self._theme.cursor))
            radius = rect.height() * 0.3
            painter.drawEllipse(QPointF(x(shown.value), middle), radius, radius)

    def _paint_bar(self, painter: QPainter, rect: QRectF) -> None:
        nats = self._weighed.for_leak
        middle, part = rect.center().x(), min(abs(nats) / _MOST_NATS, 1.0)
        painter.setPen(Qt.PenStyle.NoPen)
        colour = self._theme.curve_third if nats > 0 else self._theme.curve_second
        painter.setBrush(QColor(colour))
        length = part * (rect.width() / 2 - 14)
        box = QRectF(middle if nats > 0 else middle - length, rect.top() + 3, length, rect.height() - 6)
        painter.drawRect(box)
        painter.setPen(self._pen(self._theme.text))
        painter.drawLine(QPointF(middle, rect.top()), QPointF(middle, rect.bottom()))
        # the sign beside the bar says it without the colour
        side = QRectF(middle + (length + 2 if nats > 0 else -length - 16), rect.top(), 14, rect.height())
        painter.drawText(side, Qt.AlignmentFlag.AlignCenter, "+" if nats > 0 else "−")


@dataclass(frozen=True)
class SmallPlot:
    """A curve ``y`` over ``x`` (ascending), an optional band (2, n) at the same x, and an optional second curve."""

    x: FloatArray
    y: FloatArray
    band: FloatArray | None = None
    fit_x: FloatArray | None = None
    fit_y: FloatArray | None = None
    logarithmic: bool = False
    dots: bool = False


class SmallPlotView(Painted):
    """A little plot with a title, its least and largest values named at the axes."""

    def __init__(self, theme: Theme, unit: str, parent: QWidget | None = None) -> None:
        super().__init__(theme, 5.8, parent)
        self._unit = unit
        self._title = ""
        self._plot: SmallPlot | None = None

    def show_plot(self, title: str, plot: SmallPlot | None) -> None:
        """Show this plot; None shows only the title."""
        self._title, self._plot = title, plot
        self.setAccessibleName(title)
        self.update()

    def paint_piece(self, painter: QPainter, rect: QRectF) -> None:
        """Paint title, axes, band and curves."""
        metrics = self._theme.metrics()
        line = metrics.height()
        painter.setPen(QColor(self._theme.text))
        head = QRectF(rect.left(), rect.top(), rect.width(), line)
        title = metrics.elidedText(self._title, Qt.TextElideMode.ElideRight, rect.width())
        painter.drawText(head, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, title)
        plot = self._plot
        if plot is None or not len(plot.x):
            return
        area = QRectF(rect.left() + metrics.horizontalAdvance("−00 dB"), rect.top() + line + 2, 0, 0)
        area.setRight(rect.right() - 4)
        area.setBottom(rect.bottom() - line - 2)
        painter.fillRect(area, QColor(self._theme.canvas))
        spans = [plot.y, *(part.ravel() for part in (plot.band, plot.fit_y) if part is not None)]
        values = np.concatenate(spans)
        values = values[np.isfinite(values)]
        low = min(float(values.min(initial=0.0)), -1.0)
        high = max(float(values.max(initial=0.0)), low + _LEAST_SPAN_DB)
        at = _Axes(area, plot, low, high)
        if plot.band is not None:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(self._theme.band))
            corners = [*at.points(plot.x, plot.band[0]), *reversed(at.points(plot.x, plot.band[1]))]
            painter.drawPolygon(QPolygonF(corners))
        painter.setPen(self._pen(self._theme.grid))
        painter.drawLine(at.point(at.first, 0.0), at.point(at.last, 0.0))
        if plot.fit_x is not None and plot.fit_y is not None:
            painter.setPen(self._pen(self._theme.curve_second, 1.4))
            painter.drawPolyline(QPolygonF(at.points(plot.fit_x, np.clip(plot.fit_y, low, high))))
        painter.setPen(self._pen(self._theme.curve, 1.3))
        if plot.dots:
            painter.setBrush(QColor(self._theme.curve))
            for point in at.points(plot.x, plot.y):
                painter.drawEllipse(point, 1.6, 1.6)
        else:
            painter.drawPolyline(QPolygonF(at.points(plot.x, plot.y)))
        self._paint_labels(painter, area, at, (low, high), line)

    def _paint_labels(
        self, painter: QPainter, area: QRectF, at: "_Axes", span: tuple[float, float], line: float
    ) -> None:
        painter.setPen(QColor(self._theme.text))
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        for value in span:
            box = QRectF(0, at.point(at.first, value).y() - line / 2, area.left() - 4, line)
            box.moveTop(min(max(box.top(), area.top() - line / 3), area.bottom() - line))
            painter.drawText(box, right, f"{number(value, 0)} dB")
        marks = at.marks()
        for value in marks:
            text = f"{number(value / 1000, 0)} k" if at.logarithmic and value >= 1000 else number(value, 0)
            text = f"{text} {self._unit}" if value == marks[-1] else text
            box = QRectF(at.point(value, 0.0).x() - 40, area.bottom() + 1, 80, line)
            box.moveRight(min(box.right(), area.right()))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


class _Axes:
    """From values to pixels."""

    def __init__(self, area: QRectF, plot: SmallPlot, low: float, high: float) -> None:
        self._area, self._low, self._high = area, low, high
        self.logarithmic = plot.logarithmic
        self.first, self.last = float(plot.x[0]), float(plot.x[-1])

    def point(self, x: float, y: float) -> QPointF:
        first, last, value = self.first, self.last, x
        if self.logarithmic:
            first, last, value = math.log(first), math.log(last), math.log(max(x, 1e-9))
        across = (value - first) / max(last - first, 1e-9)
        up = (y - self._low) / (self._high - self._low)
        return QPointF(self._area.left() + across * self._area.width(), self._area.bottom() - up * self._area.height())

    def points(self, x: FloatArray, y: FloatArray) -> list[QPointF]:
        return [self.point(float(a), float(b)) for a, b in zip(x, y, strict=True) if math.isfinite(b)]

    def marks(self) -> list[float]:
        if self.logarithmic:
            return [hz for hz in (100.0, 300.0, 1000.0, 3000.0, 10000.0) if self.first <= hz <= self.last]
        reach = min(-self.first, self.last)
        step = next((s for s in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if s >= reach / 2), 100.0)
        return [-step, 0.0, step]
