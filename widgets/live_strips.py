"""What the IMU feels now: strips of specific force and turn rate that scroll, each column drawn once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from widgets.live_spectrogram import plot_left
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.recording_words import paint_hint
from widgets.ring_image import Pixels, RingImage

_ROWS = 96  # pixels that a strip's picture is high, whatever the strip is
_SHRINK = 0.35  # a strip narrows its range when it uses less than this part of it

Values = npt.NDArray[np.float32]


@dataclass(frozen=True)
class StripKind:
    """What a strip shows: three curves with a common unit, which stand in ``columns`` of the values that come.

    ``least`` is the smallest half range; values are multiplied by ``factor``.
    """

    title: str
    unit: str
    least: float
    columns: slice
    factor: float = 1.0
    curves: Sequence[str] = ("x", "y", "z")


class _Strip:
    """One strip's extremes and its picture."""

    def __init__(self, kind: StripKind, columns: int) -> None:
        self.kind = kind
        self.low = np.full((columns, len(kind.curves)), np.nan, np.float32)
        self.high = self.low.copy()
        self.half = kind.least
        self.seen = 0  # of the columns shown, how many came
        self.ring = RingImage(columns, _ROWS)

    def add(self, low: Values, high: Values, over: int, colours: "_Colours") -> None:
        """Take columns, the first ``over`` of which are drawn over the newest ones."""
        columns = len(self.low)
        low, high = low[-columns:], high[-columns:]
        self.low = np.concatenate([self.low[: columns - over], low])[-columns:]
        self.high = np.concatenate([self.high[: columns - over], high])[-columns:]
        self.seen = min(self.seen + len(low) - over, columns)
        known = np.isfinite(self.low)
        most = float(np.max(np.abs([self.low[known], self.high[known]]), initial=0.0))
        wanted = max(1.15 * most, self.kind.least)
        if most > self.half or wanted < _SHRINK * self.half:
            self.half = wanted
            self.draw_all(colours)
        else:
            self.ring.take_back(over)
            self.ring.append(self._pixels(len(low), colours))

    def draw_all(self, colours: "_Colours") -> None:
        self.ring.append(self._pixels(len(self.low), colours))

    def _pixels(self, count: int, colours: "_Colours") -> Pixels:
        """Return the newest columns: each curve covers the rows from its least to its greatest value, and what lies
        between it and the column before.
        """
        low, high = self.low[-count:], self.high[-count:]
        low_before, high_before = (np.concatenate([part[:1], part])[-count - 1 : -1] for part in (self.low, self.high))
        low, high = np.fmin(low, high_before), np.fmax(high, low_before)
        low[np.isnan(self.low[-count:])] = np.nan
        pixels = np.full((_ROWS, len(low)), colours.ground, dtype=np.uint32)
        pixels[_ROWS // 2] = colours.grid
        row = np.arange(_ROWS)[:, None]
        for curve, colour in enumerate(colours.curves):
            top = np.floor((0.5 - 0.5 * high[:, curve] / self.half) * _ROWS)
            bottom = np.maximum(np.ceil((0.5 - 0.5 * low[:, curve] / self.half) * _ROWS), top + colours.thickness)
            covered = (row >= top) & (row < bottom)  # NaN compares as False: a gap stays empty
            pixels[covered] = colour
        missing = ~np.all(np.isfinite(low), axis=1)
        missing[: max(count - self.seen, 0)] = False  # nothing could be missing yet
        pixels[:, missing] = colours.missing
        return pixels


@dataclass(frozen=True)
class _Colours:
    ground: int
    grid: int
    missing: int
    curves: tuple[int, ...]
    thickness: int


class LiveStrips(PaintedWidget):
    """Takes least and greatest values a column for each of its kinds."""

    def __init__(self, kinds: Sequence[StripKind], theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._kinds, self._theme = tuple(kinds), theme
        self._strips: list[_Strip] = []
        self._hint = ""
        self.setAccessibleName(self.tr("Live motion"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 50 * len(self._kinds))

    def sizeHint(self) -> QSize:
        """Prefer some height a strip."""
        return QSize(600, 90 * len(self._kinds))

    def set_columns(self, columns: int) -> None:
        """Begin anew with so many columns."""
        self._strips = [_Strip(kind, columns) for kind in self._kinds]
        self._stop: int | None = None
        self._redraw()

    def set_hint(self, text: str) -> None:
        """Say why nothing is seen; empty where something is."""
        if text != self._hint:
            self._hint = text
            self.update()

    def add_columns(self, first: int, low: Values, high: Values) -> None:
        """Take columns (k, channels) of least and greatest values from number ``first`` on, NaN where nothing came.

        The newest column of the call before may come again, and then replaces it.
        """
        if not self._strips or not len(low):
            return
        stop = first if self._stop is None else self._stop
        columns = self._strips[0].ring.columns
        over = min(max(stop - first, 0), len(low), columns)
        skipped = min(max(first - stop, 0), columns)
        empty = np.full((skipped, low.shape[1]), np.nan, np.float32)
        low, high = np.concatenate([empty, low]), np.concatenate([empty, high])
        self._stop = max(stop, first + len(low) - skipped)
        colours = self._colours()
        for strip in self._strips:
            part, factor = strip.kind.columns, np.float32(strip.kind.factor)
            strip.add(factor * low[:, part], factor * high[:, part], over, colours)
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self._redraw()

    def _redraw(self) -> None:
        colours = self._colours()
        for strip in self._strips:
            strip.draw_all(colours)
        self.update()

    def _colours(self) -> _Colours:
        theme = self._theme

        def pixel(text: str) -> int:
            return int(QColor(text).rgb()) & 0xFFFFFFFF

        curves = tuple(pixel(text) for text in (theme.curve, theme.curve_second, theme.curve_third))
        return _Colours(
            pixel(theme.canvas), pixel(theme.grid), pixel(theme.grid), curves, round(1.4 * theme.line_width)
        )

    def _paint(self, painter: QPainter) -> None:
        theme = self._theme
        painter.setFont(theme.font())
        each = self.height() / max(len(self._kinds), 1)
        left = plot_left(theme)  # as the spectrogram above: one moment stands below the other
        for number, kind in enumerate(self._kinds):
            rect = QRectF(left, number * each + 1, self.width() - left - 4, each - 3)
            painter.fillRect(rect, QColor(theme.canvas))
            strip = self._strips[number] if self._strips else None
            if strip is not None:
                strip.ring.paint(painter, rect)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(theme.text), 1))
            painter.drawRect(rect)
            self._paint_words(painter, rect, kind, strip)
        if self._hint or not self._strips:
            whole = QRectF(self.rect()).adjusted(left, 0.0, 0.0, 0.0)
            paint_hint(painter, self._hint or self.tr("No motion yet"), whole, theme)

    def _paint_words(self, painter: QPainter, rect: QRectF, kind: StripKind, strip: _Strip | None) -> None:
        theme, metrics = self._theme, self._theme.metrics()
        half = strip.half if strip is not None else kind.least
        text = f"{kind.title}  ±{number_text(half, 0 if half >= 10 else 1, self.locale())} {kind.unit}  "
        ground = QColor(theme.canvas)
        ground.setAlpha(215)
        width = metrics.horizontalAdvance(text) + sum(metrics.horizontalAdvance(f" {c} ") for c in kind.curves) + 8
        painter.fillRect(QRectF(rect.left() + 1, rect.top() + 1, width, metrics.height() + 1), ground)
        x, y = rect.left() + 4, rect.top() + metrics.ascent() + 1
        painter.setPen(QColor(theme.text))
        painter.drawText(QPointF(x, y), text)
        x += metrics.horizontalAdvance(text)
        for curve, colour in zip(kind.curves, (theme.curve, theme.curve_second, theme.curve_third), strict=False):
            painter.setPen(QColor(colour))
            painter.drawText(QPointF(x, y), f" {curve} ")
            x += metrics.horizontalAdvance(f" {curve} ")
