"""The axes of the stacked plots: pyqtgraph's axis items with the house's ticks, labels within the axis, and names."""

import math
from collections.abc import Callable
from itertools import pairwise

import pyqtgraph as pg
from PySide6.QtCore import QLocale, QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPen
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from processing.quantities import Quantities
from widgets.plot_marks import report_paint_error
from widgets.plot_scale import Scale
from widgets.plot_theme import Theme
from widgets.time_axis import METRIC, AxisMode, x_text, x_ticks

TickText = Callable[[float, float], str]
Line = tuple[QPen, QPointF, QPointF]
Label = tuple[QRectF, Qt.AlignmentFlag, str]
Specs = tuple[Line, list[Line], list[Label]]
MOST_TEXTS = 500


class PlotAxis(pg.AxisItem):  # type: ignore[misc]  # pyqtgraph has no types
    """An axis that draws exactly the ticks that the house's scales name."""

    def __init__(self, orientation: str, theme: Theme) -> None:
        super().__init__(orientation)
        self.enableAutoSIPrefix(False)
        self._theme = theme
        self._applied: Theme | None = None
        self._room = QRectF()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        if self._applied is theme:
            return
        self._theme = self._applied = theme
        self.setTickFont(theme.font())
        self.setTextPen(theme.text)
        self.setTickPen(theme.text)

    def set_room(self, room: QRectF) -> None:
        """Let labels stand anywhere within ``room``, in the axis' own pixels, and draw everything anew."""
        if room != self._room:
            self.prepareGeometryChange()
            self._room = room
        self.picture = None
        self.update()

    def boundingRect(self) -> QRectF:
        """Return where labels may stand."""
        return self._room

    def generateDrawSpecs(self, painter: QPainter) -> Specs | None:
        """Return line, ticks and labels as pyqtgraph draws them."""
        raise NotImplementedError

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None) -> None:
        """Draw the axis; pyqtgraph would record it first, which is dearer than the drawing."""
        del option, widget
        try:
            painter.save()
            painter.setFont(self._theme.font())
            specs = self.generateDrawSpecs(painter)
            if specs is not None:
                self.drawPicture(painter, *specs)
            painter.restore()
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()


class CommonAxis(PlotAxis):
    """The axis of time or metres; the last label gives way to the name, which stands right of the plot."""

    def __init__(self, theme: Theme) -> None:
        super().__init__("bottom", theme)
        self._mode, self._locale, self._name, self._write = AxisMode.TIME, QLocale(), "", METRIC
        self._known: tuple[float, tuple[list[float], float, float]] | None = None
        self._texts: dict[tuple[float, float], str] = {}  # of ticks; a pan shows the same ones again

    def show_unit(self, mode: AxisMode, name: str, locale: QLocale, write: Quantities = METRIC) -> None:
        """Count time or metres under this name, lengths as they are written."""
        if (mode, locale, write) != (self._mode, self._locale, self._write) or len(self._texts) > MOST_TEXTS:
            self._texts.clear()
        self._mode, self._name, self._locale, self._write = mode, name, locale, write
        self._known = None

    def ticks(self, width: float) -> tuple[list[float], float, float]:
        """Return the ticks for a plot of so many pixels, the step between them, and the room that a label needs."""
        if self._known is not None and self._known[0] == width:
            return self._known[1]
        (low, high), metrics = self.range, self._theme.metrics()
        sample = (x_text(value, (high - low) / 10, self._mode, self._locale, self._write) for value in (low, high))
        widest = max(metrics.horizontalAdvance(text) for text in sample)
        values, step = x_ticks(low, high, self._mode, max(2, int(width / (1.6 * widest + 8))), self._write)
        self._known = (width, (values, step, widest))
        return values, step, widest

    def generateDrawSpecs(self, painter: QPainter) -> Specs | None:
        """Return ticks and labels."""
        del painter
        metrics, width = self._theme.metrics(), self.size().width()
        low, high = self.range
        values, step, widest = self.ticks(width)
        lines: list[Line] = []
        labels: list[Label] = []
        pen = self.tickPen()
        for value in values:
            x = (value - low) / (high - low) * width
            lines.append((pen, QPointF(x, 0.0), QPointF(x, 4.0)))
            text = self._texts.get((value, step))
            if text is None:
                text = self._texts[value, step] = x_text(value, step, self._mode, self._locale, self._write)
            middle = min(x, width + 2 - 0.5 * metrics.horizontalAdvance(text))
            box = QRectF(middle - widest, 4.0, 2 * widest, metrics.height())
            labels.append((box, Qt.AlignmentFlag.AlignCenter, text))
        box = QRectF(width + 10, 4.0, max(0.0, self._room.right() - width - 10), metrics.height())
        name = metrics.elidedText(self._name, Qt.TextElideMode.ElideRight, box.width())
        labels.append((box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, name))
        return (pen, QPointF(0.0, 0.0), QPointF(width, 0.0)), lines, labels


class ValueAxis(PlotAxis):
    """A vertical axis; without a scale it is empty, but keeps its width, so that stacked plots stay in line."""

    def __init__(self, theme: Theme) -> None:
        super().__init__("left", theme)
        self._scale: Scale | None = None
        self._name, self._left = "", 0.0
        self._text: TickText = _no_text
        self._specs: tuple[object, Specs] | None = None  # for what, and what is drawn

    def show_scale(self, scale: Scale | None, name: str = "", text: TickText | None = None, left: float = 0.0) -> None:
        """Draw this scale under a name; ``text`` makes a label of a value and the step between ticks.

        Labels stand right of ``left`` pixels, the name left of it. Of a name such as ``elevation (m)`` only the unit is
        written where there is no room for more.
        """
        self._scale, self._name, self._left = scale, name, left
        self._text = text if text is not None else _no_text

    def ticks(self, height: float) -> list[tuple[float, float]]:
        """Return the ticks for a plot of so many pixels: value, and pixels below its upper edge."""
        if self._scale is None:
            return []
        values = self._scale.ticks(max(3, int(height / (1.7 * self._theme.metrics().height()))))
        return [(value, (1.0 - float(self._scale.fraction(value))) * height) for value in values]

    def generateDrawSpecs(self, painter: QPainter) -> Specs | None:
        """Return ticks and labels."""
        del painter
        if self._scale is None:
            return None
        key = (self._scale, self._name, self._left, self._text, self._theme, self.size().toTuple())
        if self._specs is None or self._specs[0] != key:
            self._specs = (key, self._new_specs())
        return self._specs[1]

    def _new_specs(self) -> Specs:
        line_height, width, height = self._theme.metrics().height(), self.size().width(), self.size().height()
        ticks = self.ticks(height)
        step = min((b - a for (a, _), (b, _) in pairwise(ticks)), default=1.0)
        pen = self.tickPen()
        lines = [(pen, QPointF(width - 4, y), QPointF(width, y)) for _, y in ticks]
        labels: list[Label] = []
        lowest = math.inf
        for value, y in ticks:
            # labels keep inside the axis, so that those of neighbouring strips do not run into each other
            middle = min(max(y, 0.45 * line_height), height - 0.45 * line_height)
            if lowest - middle < 0.8 * line_height:
                continue  # nor into each other, where there is room for few
            lowest = middle
            box = QRectF(self._left, middle - line_height, width - 6 - self._left, 2 * line_height)
            labels.append((box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, self._text(value, step)))
        return (pen, QPointF(width, 0.0), QPointF(width, height)), lines, labels

    def drawPicture(self, painter: QPainter, axis: Line, ticks: list[Line], labels: list[Label]) -> None:
        """Draw ticks and labels, and the name upwards."""
        super().drawPicture(painter, axis, ticks, labels)
        metrics, height = self._theme.metrics(), self.size().height()
        painter.translate(self._left - 0.65 * metrics.height(), 0.5 * height)
        painter.rotate(-90.0)
        span = height + metrics.height()
        fits = metrics.horizontalAdvance(self._name) <= span
        name = self._name if fits else self._name.rpartition("(")[2].rstrip(")")
        box = QRectF(-0.5 * span, -metrics.height(), span, 2 * metrics.height())
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, name)


def _no_text(value: float, step: float) -> str:
    del value, step
    return ""
