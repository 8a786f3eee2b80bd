"""Two runs of one pipe above each other in metres: both sounds as pictures, both levels as curves, one cursor."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QKeyEvent, QPainter, QPen, QPixmap, QPolygonF
from PySide6.QtWidgets import QWidget

from processing.survey import FloatArray
from widgets.color_maps import DARK_EXCESS_MAP, EXCESS_MAP, color_table, level_color_index
from widgets.plot_paint import paint_hatch, paint_tag
from widgets.plot_scale import Scale, hertz_text, linear_ticks
from widgets.plot_theme import LIGHT, Theme
from widgets.units import length_unit, quantities
from widgets.xy_plot import ZOOM_STEP, XyPlot

_LOW_DB, _HIGH_DB = -12.0, 12.0
_GAP = 6.0
_LEVELS_SHARE = 0.34
_NEAR_PIXELS = 24.0


@dataclass(frozen=True)
class RepeatStrip:
    """A run: its title, its sound (n, b) and its level (n,) in decibels over the background, NaN where not assessed."""

    title: str
    picture_db: FloatArray
    excess_db: FloatArray


@dataclass(frozen=True)
class RepeatMark:
    """A place in metres of the common axis, with the sign of what became of it."""

    chainage_m: float
    half95_m: float
    sign: str


class RepeatView(XyPlot):
    """Click sets the cursor, or chooses a place near it; Z and X zoom, F shows all, Shift and arrows pan."""

    cursor_asked = Signal(float)  # metres
    mark_chosen = Signal(int)

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self.setAccessibleName(self.tr("Both runs along the pipe"))
        self._chainage = np.empty(0)
        self._strips: tuple[RepeatStrip, ...] = ()
        self._bands = np.empty((0, 2))
        self._marks: tuple[RepeatMark, ...] = ()
        self._chosen = -1
        self._cursor_m: float | None = None
        self._kept: tuple[tuple[object, ...], QPixmap] | None = None

    # --- what it is told ---

    def set_content(
        self, chainage_m: FloatArray, strips: Sequence[RepeatStrip], bands_hz: FloatArray, marks: Sequence[RepeatMark]
    ) -> None:
        """Show two runs on cells (n,) of equal length; none shows nothing."""
        factor = quantities().length_factor
        self._chainage = factor * chainage_m
        self._strips, self._bands, self._marks = tuple(strips), bands_hz, tuple(marks)
        self._chosen = -1
        self._kept = None
        if len(chainage_m) > 1:
            self._set_whole(Scale(float(self._chainage[0]), float(self._chainage[-1])))
            self.fit()
        self._x_name = self.tr("metres of this survey") if factor == 1.0 else self.tr("feet of this survey")
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._kept = None
        super().apply_theme(theme)

    def set_cursor(self, chainage_m: float | None) -> None:
        """Show where the linked cursor stands."""
        self._cursor_m = chainage_m
        self.update()

    def choose(self, mark: int) -> None:
        """Lift a place out, and bring it into view."""
        self._chosen = mark
        if 0 <= mark < len(self._marks):
            at = self._shown(self._marks[mark].chainage_m)
            low, high = self.x_range
            if not low <= at <= high:
                half = (high - low) / 2.0
                self.set_x_range(at - half, at + half)
        self.update()

    def minimumSizeHint(self) -> QSize:
        """Need room for three strips."""
        return QSize(320, 220)

    # --- painting ---

    def _shown(self, chainage_m: float) -> float:
        return chainage_m / length_unit().factor

    def _room_above(self) -> float:
        return 1.6 * self._theme.metrics().height()

    def _rects(self, rect: QRectF) -> tuple[QRectF, QRectF, QRectF]:
        """Return where both pictures and the levels are drawn."""
        levels = _LEVELS_SHARE * rect.height()
        picture = (rect.height() - levels - 2 * _GAP) / 2.0
        first = QRectF(rect.left(), rect.top(), rect.width(), picture)
        second = first.translated(0.0, picture + _GAP)
        return first, second, QRectF(rect.left(), rect.bottom() - levels, rect.width(), levels)

    def _paint_axes(self, painter: QPainter, rect: QRectF) -> None:
        metrics = self._theme.metrics()
        painter.setPen(QColor(self._theme.text))
        values = self._x.ticks(max(3, int(rect.width() / (5.0 * metrics.averageCharWidth() + 40))))
        step = values[1] - values[0] if len(values) > 1 else 1.0
        for value in values:
            x = self.x_pixel(value)
            painter.drawLine(QPointF(x, rect.bottom()), QPointF(x, rect.bottom() + 4))
            box = QRectF(x - 60, rect.bottom() + 3, 120, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._x_text(value, step))
        below = QRectF(rect.left(), rect.bottom() + 1.3 * metrics.height(), rect.width(), 1.3 * metrics.height())
        painter.drawText(below, Qt.AlignmentFlag.AlignCenter, self._x_name)

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        ratio = self.devicePixelRatioF()
        key = (self._x, rect.getRect(), self._chosen, ratio)
        if self._kept is None or self._kept[0] != key:  # a moved cursor costs no new pictures
            self._kept = (key, self._painted(rect, ratio))
        painter.drawPixmap(rect.topLeft(), self._kept[1])
        if self._cursor_m is not None:
            x = self.x_pixel(self._shown(self._cursor_m))
            painter.setPen(QPen(QColor(self._theme.cursor), 1.3 * self._theme.line_width))
            painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))

    def _painted(self, rect: QRectF, ratio: float) -> QPixmap:
        """Return both runs with all places, without the cursor."""
        pixmap = QPixmap((rect.size() * ratio).toSize())
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(QColor(self._theme.canvas))
        painter = QPainter(pixmap)
        try:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setFont(self._theme.font())
            painter.translate(-rect.topLeft())
            first, second, levels = self._rects(rect)
            for strip, place in zip(self._strips, (first, second), strict=False):
                self._paint_picture(painter, strip, place)
            self._paint_levels(painter, levels)
            for number, mark in enumerate(self._marks):
                self._paint_mark(painter, mark, rect, chosen=number == self._chosen)
        finally:
            painter.end()
        return pixmap

    def _paint_picture(self, painter: QPainter, strip: RepeatStrip, rect: QRectF) -> None:
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, on=False)
        painter.drawImage(rect, self._picture(strip.picture_db, max(1, round(rect.width()))))
        for left, right in _gaps(strip.excess_db):
            x1, x2 = self.x_pixel(float(self._chainage[left])), self.x_pixel(float(self._chainage[right]))
            paint_hatch(painter, QRectF(x1, rect.top(), max(x2 - x1, 1.0), rect.height()), self._theme)
        metrics = self._theme.metrics()
        width = metrics.horizontalAdvance(strip.title) + 12
        paint_tag(
            painter, self._theme, strip.title, QRectF(rect.left() + 6, rect.top() + 4, width, metrics.height() + 4)
        )

    def _picture(self, picture_db: FloatArray, columns: int) -> QImage:
        """Return the visible part: the loudest cell of each pixel column, high bands above."""
        first, stop = self._columns_of(columns)
        filled = np.where(np.isfinite(picture_db), picture_db, -np.inf)
        pooled = np.maximum.reduceat(filled[:stop], first, axis=0)  # of equal edges: the cell itself
        table = color_table(DARK_EXCESS_MAP if self._theme.name == "dark" else EXCESS_MAP)
        colours = table[level_color_index(pooled, _LOW_DB, _HIGH_DB)]
        pixels = np.ascontiguousarray(colours.transpose(1, 0, 2)[::-1])
        rows = pixels.shape[0]
        return QImage(pixels.tobytes(), columns, rows, 3 * columns, QImage.Format.Format_RGB888).copy()

    def _columns_of(self, columns: int) -> tuple[npt.NDArray[np.intp], int]:
        """Return the first cell of each pixel column of what is visible, and the cell where all ends."""
        edges = np.searchsorted(self._chainage, np.linspace(*self.x_range, columns + 1))
        edges = np.clip(edges, 0, len(self._chainage) - 1)
        return edges[:-1], int(edges[-1]) + 1

    def _paint_levels(self, painter: QPainter, rect: QRectF) -> None:
        known = [strip.excess_db[np.isfinite(strip.excess_db)] for strip in self._strips]
        top = max([6.0, *(float(np.quantile(values, 0.999)) for values in known if len(values))]) * 1.25 + 2.0
        scale = Scale(-4.0, top)
        metrics = self._theme.metrics()
        for value in linear_ticks(-4.0, top, max(2, int(rect.height() / (2.5 * metrics.height())))):
            y = rect.bottom() - float(scale.fraction(value)) * rect.height()
            painter.setPen(QPen(QColor(self._theme.grid), 1))
            painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
            painter.setPen(QColor(self._theme.text))
            painter.drawText(QPointF(rect.left() + 4, y - 2), f"{quantities().number(value, 0)} dB")
        styles = ((self._theme.curve, Qt.PenStyle.SolidLine), (self._theme.curve_second, Qt.PenStyle.DashLine))
        for strip, (colour, style) in zip(self._strips, styles, strict=False):
            pen = QPen(QColor(colour), self._theme.line_width)
            pen.setStyle(style)
            painter.setPen(pen)
            for part in self._runs(strip.excess_db, rect, scale):
                painter.drawPolyline(part)

    def _runs(self, level_db: FloatArray, rect: QRectF, scale: Scale) -> list[QPolygonF]:
        """Return the level as lines, broken where nothing was heard, its highest a pixel."""
        columns = max(2, round(rect.width()))
        first, stop = self._columns_of(columns)
        pooled = np.fmax.reduceat(level_db[:stop], first)
        y = rect.bottom() - np.asarray(scale.fraction(pooled), np.float64) * rect.height()
        x = rect.left() + np.arange(columns) * rect.width() / columns
        parts: list[QPolygonF] = []
        for piece in np.split(np.arange(columns), np.flatnonzero(~np.isfinite(y))):
            piece = piece[np.isfinite(y[piece])]
            if len(piece) > 1:
                parts.append(QPolygonF([QPointF(a, b) for a, b in zip(x[piece], y[piece], strict=True)]))
        return parts

    def _paint_mark(self, painter: QPainter, mark: RepeatMark, rect: QRectF, *, chosen: bool) -> None:
        x = self.x_pixel(self._shown(mark.chainage_m))
        half = self.x_pixel(self._shown(mark.chainage_m + mark.half95_m)) - x
        colour = QColor(self._theme.cursor if chosen else self._theme.text)
        colour.setAlpha(60 if chosen else 30)
        painter.fillRect(QRectF(x - half, rect.top(), 2 * half, rect.height()), colour)
        colour.setAlpha(255)
        painter.setPen(QPen(colour, (2.0 if chosen else 1.0) * self._theme.line_width, Qt.PenStyle.DotLine))
        painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))

    def _paint_over(self, painter: QPainter, rect: QRectF) -> None:
        metrics = self._theme.metrics()
        size = 1.35 * metrics.height()
        for number, mark in enumerate(self._marks):
            x = self.x_pixel(self._shown(mark.chainage_m))
            if rect.left() <= x <= rect.right():
                box = QRectF(x - size / 2, rect.top() - size - 1, size, size)
                paint_tag(painter, self._theme, mark.sign, box, strong=number == self._chosen)
        first, second, levels = self._rects(rect)
        painter.setPen(QColor(self._theme.text))
        for picture in (first, second):
            if len(self._bands):
                for hz, y in (
                    (self._bands[-1, 1], picture.top()),
                    (self._bands[0, 0], picture.bottom() - metrics.height()),
                ):
                    box = QRectF(0.0, y, rect.left() - 5, metrics.height())
                    painter.drawText(box, Qt.AlignmentFlag.AlignRight, hertz_text(float(hz), self.locale()))
        entries = [
            (strip.title, colour)
            for strip, colour in zip(self._strips, (self._theme.curve, self._theme.curve_second), strict=False)
        ]
        self._legend(painter, levels, entries)

    # --- hands ---

    def _click(self, place: QPointF) -> None:
        near = [(abs(self.x_pixel(self._shown(m.chainage_m)) - place.x()), n) for n, m in enumerate(self._marks)]
        if near and min(near)[0] <= _NEAR_PIXELS:
            self.mark_chosen.emit(min(near)[1])
        self.cursor_asked.emit(self.x_value(place.x()) * length_unit().factor)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Zoom by the keys of the other views, too."""
        middle = self.plot_rect().center().x()
        if event.key() == Qt.Key.Key_Z:
            self._zoom(ZOOM_STEP**2, middle)
        elif event.key() == Qt.Key.Key_X:
            self._zoom(ZOOM_STEP**-2, middle)
        else:
            super().keyPressEvent(event)


def _gaps(level_db: FloatArray) -> list[tuple[int, int]]:
    """Return first and last cell of each stretch that was not assessed."""
    bad = np.concatenate([[False], ~np.isfinite(level_db), [False]])
    edges = np.flatnonzero(bad[1:] != bad[:-1])
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
