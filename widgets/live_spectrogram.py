"""What the ball hears now: a spectrogram that scrolls, each column coloured once, when it comes."""

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import BoolArray, FloatArray
from widgets.color_maps import color_table
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import hertz_text
from widgets.plot_theme import LIGHT, Theme
from widgets.recording_words import paint_hint
from widgets.ring_image import Pixels, RingImage

ROWS = 180  # of the picture, in octaves from the lowest to the highest frequency
LOWEST_HZ = 60.0
SPAN_STEPS = 90  # tile steps from the quietest colour to the loudest: 45 dB
_UNDER_STEPS = 8  # the quietest colour lies so much below the usual ground
_SETTLE = (5, 20, 60, 200)  # after so many columns the colours are fitted to what was heard; then they stay
_TICKS_HZ = (100.0, 300.0, 1000.0, 3000.0, 10_000.0, 30_000.0)

Tiles = npt.NDArray[np.uint8]


class LiveSpectrogram(PaintedWidget):
    """Takes numbered columns of tile values; the colours settle on what the first seconds hold, :meth:`refit` anew."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._frequencies: FloatArray = np.zeros(0)
        self._span_s = 0.0
        self._ring: RingImage | None = None
        self._hint = ""
        self._frame: tuple[object, QPixmap] | None = None
        self.setAccessibleName(self.tr("Live spectrogram"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 110)

    def sizeHint(self) -> QSize:
        """Prefer some height."""
        return QSize(600, 260)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        if self._ring is not None:
            self._draw_all()
        self.update()

    def set_axes(self, frequency_hz: FloatArray, columns: int, column_s: float) -> None:
        """Begin anew with columns of these frequencies (rising), of which ``columns`` are shown."""
        self._frequencies, self._span_s, self._frame = frequency_hz, columns * column_s, None
        edges = np.geomspace(max(LOWEST_HZ, float(frequency_hz[0])), float(frequency_hz[-1]), ROWS + 1)
        self._starts = np.minimum(np.searchsorted(frequency_hz, edges[:-1]), len(frequency_hz) - 1)
        self._edges = edges
        self._tiles = np.zeros((columns, ROWS), np.uint8)  # as shown, oldest first
        self._is_gap = np.ones(columns, np.bool_)
        self._seen = 0  # of the columns shown, how many came
        self._ring = RingImage(columns, ROWS)
        self._stop = 0  # number of the column to come
        self.refit()
        self._draw_all()
        self.update()

    def set_hint(self, text: str) -> None:
        """Say why nothing is seen; empty where something is."""
        if text != self._hint:
            self._hint = text
            self.update()

    def refit(self) -> None:
        """Let the colours settle anew on the columns that come now."""
        self._low, self._heard = 0, 0

    def add_columns(self, first: int, tiles: Tiles, is_gap: BoolArray) -> None:
        """Take columns (k, frequencies) from number ``first`` on; known ones are passed over, skipped ones are gaps."""
        if self._ring is None:
            return
        if self._stop == 0 or first - self._stop > len(self._tiles):
            self._stop = first
        known = max(self._stop - first, 0)
        tiles, is_gap = tiles[known:], is_gap[known:]
        if not len(tiles):
            return
        rows = np.maximum.reduceat(tiles, self._starts, axis=1)
        skipped = first + known - self._stop
        if skipped:
            rows = np.concatenate([np.zeros((skipped, ROWS), np.uint8), rows])
            is_gap = np.concatenate([np.ones(skipped, np.bool_), is_gap])
        self._stop += len(rows)
        self._seen = min(self._seen + len(rows), len(self._tiles))
        self._tiles = np.concatenate([self._tiles, rows])[-len(self._tiles) :]
        self._is_gap = np.concatenate([self._is_gap, is_gap])[-len(self._is_gap) :]
        before, self._heard = self._heard, self._heard + int(np.count_nonzero(~is_gap))
        if any(before < count <= self._heard for count in _SETTLE):
            self._draw_all()
        else:
            self._ring.append(self._coloured(rows, is_gap))
        self.update()

    def _draw_all(self) -> None:
        good = self._tiles[~self._is_gap]
        if len(good):
            self._low = int(np.percentile(good, 15)) - _UNDER_STEPS
        assert self._ring is not None
        pixels = self._coloured(self._tiles, self._is_gap)
        pixels[:, : len(self._tiles) - self._seen] = _pixel(self._theme.canvas)
        self._ring.append(pixels)

    def _coloured(self, rows: Tiles, is_gap: BoolArray) -> Pixels:
        step = np.clip((np.arange(256) - self._low) * (255.0 / SPAN_STEPS), 0, 255).astype(np.intp)
        pixels = color_pixels("grey" if self._theme.name == "sun" else "viridis")[step][rows]
        pixels[is_gap] = _pixel(self._theme.grid)
        return np.ascontiguousarray(pixels.T[::-1])

    # --- painting ---

    def plot_rect(self) -> QRectF:
        """Return where the sound is drawn."""
        return QRectF(self.rect()).adjusted(plot_left(self._theme), 4, -4, -1.4 * self._theme.metrics().height())

    def y_of(self, frequency_hz: float) -> float:
        """Return the pixel of a frequency."""
        rect = self.plot_rect()
        part = np.log(frequency_hz / self._edges[0]) / np.log(self._edges[-1] / self._edges[0])
        return float(rect.bottom() - rect.height() * part)

    def _paint(self, painter: QPainter) -> None:
        theme, rect = self._theme, self.plot_rect()
        painter.setFont(theme.font())
        if self._ring is None:
            painter.fillRect(rect, QColor(theme.canvas))
        else:
            self._ring.paint(painter, rect)
        key = (self.width(), self.height(), self.devicePixelRatioF(), theme, self._span_s, self._ring is None)
        if self._frame is None or self._frame[0] != key:
            self._frame = key, self._painted_frame(rect)
        frame, ratio = self._frame[1], self.devicePixelRatioF()
        below = rect.bottom()
        for part in (  # beside and below the sound only: a whole picture would be blended over all of it
            QRectF(0.0, 0.0, rect.left() + 1.0, self.height()),
            QRectF(rect.left() + 1.0, below, self.width() - rect.left() - 1.0, self.height() - below),
        ):
            painter.drawPixmap(part, frame, QRectF(part.topLeft() * ratio, part.size() * ratio))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.drawRect(rect)
        if self._hint or self._ring is None:
            paint_hint(painter, self._hint or self.tr("No sound yet"), rect, theme)

    def _painted_frame(self, rect: QRectF) -> QPixmap:
        """Return the axes, which stay the same from picture to picture."""
        ratio = self.devicePixelRatioF()
        frame = QPixmap(self.size() * ratio)
        frame.setDevicePixelRatio(ratio)
        frame.fill(Qt.GlobalColor.transparent)
        painter = QPainter(frame)
        painter.setFont(self._theme.font())
        if self._ring is not None:
            self._paint_axes(painter, rect)
        painter.end()
        return frame

    def _paint_axes(self, painter: QPainter, rect: QRectF) -> None:
        metrics = self._theme.metrics()
        painter.setPen(QColor(self._theme.text))
        last = rect.bottom() + metrics.height()
        for hertz in _TICKS_HZ:
            if not self._edges[0] <= hertz <= self._edges[-1]:
                continue
            y = self.y_of(hertz)
            if abs(y - last) < metrics.height():
                continue
            last = y
            painter.drawLine(QPointF(rect.left() - 4, y), QPointF(rect.left(), y))
            box = QRectF(0, y - metrics.height() / 2, rect.left() - 6, metrics.height())
            text = hertz_text(hertz, self.locale()) + "Hz"
            painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, text)
        below = QRectF(rect.left(), rect.bottom() + 2, rect.width(), 1.2 * metrics.height())
        painter.drawText(
            below, Qt.AlignmentFlag.AlignLeft, self.tr("{seconds} s ago").format(seconds=round(self._span_s))
        )
        painter.drawText(below, Qt.AlignmentFlag.AlignRight, self.tr("now"))


def plot_left(theme: Theme) -> float:
    """Return how much the axis of frequencies takes at the left of a picture."""
    return 4.0 + theme.metrics().horizontalAdvance("30kHz ")


def _pixel(colour: str) -> int:
    return int(QColor(colour).rgb()) & 0xFFFFFFFF


def color_pixels(name: str) -> Pixels:
    """Return the 256 colours of a map as 32-bit pixels."""
    table = color_table(name).astype(np.uint32)
    red, green, blue = table.T
    return np.asarray(0xFF000000 + (red << 16) + (green << 8) + blue, dtype=np.uint32)
