"""A map of frequency bands: wide bands above, narrow ones below, coloured by how much a stretch stands out in each."""

import math
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.color_maps import color_table
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import Scale, hertz_text, number_text
from widgets.plot_theme import LIGHT, Theme

_COLOURS = "viridis"


class BandMapView(PaintedWidget):
    """Paints the bands of one map; ``band_clicked`` names the one that was clicked."""

    band_clicked = Signal(float, float)
    pointed = Signal(str)  # what is read off under the mouse, empty outside

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._bands, self._row, self._value = np.zeros((0, 2)), np.zeros(0), np.zeros(0)
        self._chosen: tuple[float, float] | None = None
        self._hint, self._unit = "", ""
        self._colours = color_table(_COLOURS)
        self.setAccessibleName(self.tr("Map of the bands"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(220, 120)
        self.setMouseTracking(True)

    def set_map(
        self,
        bands_hz: FloatArray,
        row: FloatArray,
        value: FloatArray,
        chosen: tuple[float, float] | None,
        unit: str = "",
    ) -> None:
        """Show bands (n, 2) in their rows (n,), with values (n,) in ``unit``; ``chosen`` is framed."""
        self._bands, self._row, self._value = bands_hz, row, value
        self._chosen, self._unit = chosen, unit
        self.update()

    def set_hint(self, text: str) -> None:
        """Show nothing but this."""
        self._bands, self._hint = np.zeros((0, 2)), text
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def sizeHint(self) -> QSize:
        """Prefer some height."""
        return QSize(420, round(14 * self._theme.metrics().height()))

    def plot_rect(self) -> QRectF:
        """Return where the bands are drawn."""
        return QRectF(self.rect()).adjusted(8.0, 4.0, -12.0, -1.6 * self._theme.metrics().height())

    def band_rect(self, number: int) -> QRectF:
        """Return the pixels of one band."""
        rect = self.plot_rect()
        low, high = (rect.left() + rect.width() * edge / self._highest for edge in self._bands[number])
        rows = max(float(self._row.max()) + 1.0, 1.0)
        top, bottom = (rect.top() + rect.height() * (self._row[number] + k) / rows for k in (0.0, 1.0))
        return QRectF(QPointF(low, top), QPointF(high, bottom))

    def reading_at(self, place: QPointF) -> str:
        """Return what the band under a pixel says; empty where there is none."""
        number = self._band_at(place)
        if number is None:
            return ""
        low, high = (hertz_text(float(edge), self.locale()) for edge in np.round(self._bands[number]))
        digits = 1 if abs(self._value[number]) >= 1.0 else 3
        return f"{low}–{high}Hz: {number_text(float(self._value[number]), digits, self.locale())} {self._unit}".rstrip()

    @property
    def _highest(self) -> float:
        return float(self._bands[:, 1].max(initial=1.0))

    def _band_at(self, place: QPointF) -> int | None:
        rects: Sequence[QRectF] = [self.band_rect(k) for k in range(len(self._bands))]
        return next((k for k, rect in enumerate(rects) if rect.contains(place)), None)

    def _paint(self, painter: QPainter) -> None:
        theme, rect = self._theme, self.plot_rect()
        painter.setFont(theme.font())
        painter.fillRect(self.rect(), QColor(theme.background))
        painter.setPen(QColor(theme.text))
        if not len(self._bands):
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(rect.adjusted(8, 8, -8, -8), flags, self._hint)
            return
        top = float(np.nanmax(self._value, initial=0.0)) or 1.0
        shade = np.clip(np.nan_to_num(self._value) / top, 0.0, 1.0) * 255.0
        for number, colour in enumerate(self._colours[shade.astype(int)]):
            painter.fillRect(self.band_rect(number), QColor(*(int(part) for part in colour)))
        self._paint_axis(painter, rect)
        if self._chosen is not None:
            self._paint_chosen(painter, rect, self._chosen)

    def _paint_axis(self, painter: QPainter, rect: QRectF) -> None:
        metrics = self._theme.metrics()
        painter.setPen(QColor(self._theme.text))
        most = max(3, int(rect.width() / (2.0 * metrics.horizontalAdvance("00.0kHz"))))
        for value in Scale(0.0, self._highest).ticks(most):
            x = rect.left() + rect.width() * value / self._highest
            painter.drawLine(QPointF(x, rect.bottom()), QPointF(x, rect.bottom() + 4))
            half = 0.5 * metrics.horizontalAdvance("00.0kHz") + 4
            left = min(max(x - half, 0.0), self.width() - 2 * half)
            box = QRectF(left, rect.bottom() + 4, 2 * half, 1.3 * metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, hertz_text(float(value), self.locale()) + "Hz")
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(rect)

    def _paint_chosen(self, painter: QPainter, rect: QRectF, chosen: tuple[float, float]) -> None:
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for number, band in enumerate(self._bands):
            if math.isclose(band[0], chosen[0], abs_tol=0.5) and math.isclose(band[1], chosen[1], abs_tol=0.5):
                box = self.band_rect(number).adjusted(1, 1, -1, -1)
                painter.setPen(QPen(QColor("#000000"), 5))
                painter.drawRect(box)
                painter.setPen(QPen(QColor("#ffffff"), 2))
                painter.drawRect(box)
                return
        del rect

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Read off under the mouse."""
        self.pointed.emit(self.reading_at(event.position()))

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing lies under the mouse any more."""
        super().leaveEvent(event)
        self.pointed.emit("")

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Name the band that was clicked."""
        number = self._band_at(event.position())
        if number is not None and event.button() is Qt.MouseButton.LeftButton:
            self.band_clicked.emit(float(self._bands[number, 0]), float(self._bands[number, 1]))
