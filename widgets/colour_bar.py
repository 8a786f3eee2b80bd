"""The decibel bar beside a spectrogram: which colour stands for which level, and handles to change that."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF, qRgb

from widgets.color_maps import color_table, level_color_index
from widgets.plot_scale import Scale, number_text, tick_digits
from widgets.plot_theme import Theme

LEAST_RANGE_DB = 3.0
BAR_WIDTH = 14.0


@dataclass(frozen=True)
class ColourBar:
    """Levels from ``scale.low`` to ``scale.high`` dB, drawn upwards; colours run from ``low_db`` to ``high_db``."""

    scale: Scale
    low_db: float
    high_db: float
    color_map: str
    symmetric: bool = False  # the colours run as far below 0 dB as above it

    def bar_rect(self, rect: QRectF) -> QRectF:
        """Return where the colours stand within the room given."""
        return QRectF(rect.left() + 6, rect.top(), BAR_WIDTH, rect.height())

    def db_at(self, rect: QRectF, y: float) -> float:
        """Return the level at a height."""
        part = (rect.bottom() - y) / max(rect.height(), 1.0)
        return float(self.scale.value(min(max(part, 0.0), 1.0)))

    def y_of(self, rect: QRectF, level_db: float) -> float:
        """Return the height of a level."""
        return rect.bottom() - float(self.scale.fraction(level_db)) * rect.height()

    def colours(self, levels_db: np.ndarray) -> list[int]:
        """Return the colours (0xffrrggbb) of levels."""
        table = color_table(self.color_map)[level_color_index(levels_db, self.low_db, self.high_db)]
        return [qRgb(*row) for row in table.tolist()]

    def table(self, first_db: float, last_db: float) -> list[int]:
        """Return the 256 colours of numbers that stand for levels from ``first_db`` to ``last_db``."""
        # asked for with each frame, and the same until someone changes the colours
        found = self._tables.get((first_db, last_db))
        if found is None:
            found = self._tables[first_db, last_db] = self.colours(np.linspace(first_db, last_db, 256))
        return found

    @cached_property
    def _tables(self) -> dict[tuple[float, float], list[int]]:
        return {}

    def grabbed(self, rect: QRectF, place: QPointF) -> str:
        """Return which end follows the mouse when it is pressed here: ``low``, ``high``, ``both`` or ``""``."""
        if not rect.adjusted(0, -6, 0, 6).contains(place):
            return ""
        to_low = abs(place.y() - self.y_of(rect, self.low_db))
        to_high = abs(place.y() - self.y_of(rect, self.high_db))
        if min(to_low, to_high) > 9 and self.low_db < self.db_at(rect, place.y()) < self.high_db:
            return "both"
        return "low" if to_low < to_high else "high"

    def dragged(self, end: str, by_db: float) -> tuple[float, float]:
        """Return the ends of the colours after one of them (or both) was moved by decibels, within the scale."""
        low, high = self.low_db, self.high_db
        if self.symmetric:
            half = high if end == "both" else high + (by_db if end == "high" else -by_db)
            half = min(max(half, LEAST_RANGE_DB), self.scale.high)
            low, high = -half, half
        elif end == "low":
            low = min(max(low + by_db, self.scale.low), high - LEAST_RANGE_DB)
        elif end == "high":
            high = max(min(high + by_db, self.scale.high), low + LEAST_RANGE_DB)
        else:
            by_db = min(max(by_db, self.scale.low - low), self.scale.high - high)
            low, high = low + by_db, high + by_db
        return low, high

    def paint(self, painter: QPainter, rect: QRectF, theme: Theme, mode: str = "") -> None:
        """Draw the bar, its ticks and its two handles with their values; ``mode`` stands below the unit."""
        bar, metrics = self.bar_rect(rect), theme.metrics()
        rows = max(1, round(bar.height()))
        levels = self.scale.value(1.0 - (np.arange(rows) + 0.5) / rows)
        picture = np.array(self.colours(levels), dtype=np.uint32)[:, None].copy()
        painter.drawImage(bar, QImage(picture.data, 1, rows, 4, QImage.Format.Format_RGB32))
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(bar)
        ticks = self.scale.ticks(max(2, int(rect.height() / (2.2 * metrics.height()))))
        digits = tick_digits(ticks[1] - ticks[0]) if len(ticks) > 1 else 0
        for value in ticks:
            y = self.y_of(rect, value)
            ends = [self.y_of(rect, level_db) for level_db in (self.low_db, self.high_db)]
            if y < rect.top() + (2.4 if mode else 1.3) * metrics.height():
                continue  # the unit stands there
            if min(abs(y - end) for end in ends) < 0.9 * metrics.height():
                continue  # the value of an end does
            painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + 4, y))
            middle = min(y, rect.bottom() - 0.45 * metrics.height())
            box = QRectF(bar.right() + 7, middle - metrics.height(), rect.width(), 2 * metrics.height())
            painter.drawText(
                box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, number_text(value, digits)
            )
        painter.drawText(
            QRectF(bar.right() + 7, rect.top(), rect.width(), metrics.height()), Qt.AlignmentFlag.AlignLeft, "dB"
        )
        room = rect.right() - bar.right() - 7
        if mode:
            text = metrics.elidedText(mode, Qt.TextElideMode.ElideRight, room)
            place = QRectF(bar.right() + 7, rect.top() + metrics.height(), room, metrics.height())
            painter.drawText(place, Qt.AlignmentFlag.AlignLeft, text)
        highest = rect.top() + (2.4 if mode else 1.3) * metrics.height()
        for level_db in (self.low_db, self.high_db):
            y = self.y_of(rect, level_db)
            self._paint_handle(painter, bar, y, theme)
            middle = min(max(y, highest), rect.bottom() - 0.45 * metrics.height())
            painter.setPen(QColor(theme.cursor))
            box = QRectF(bar.right() + 7, middle - metrics.height(), room, 2 * metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, number_text(level_db, 0))

    def _paint_handle(self, painter: QPainter, bar: QRectF, y: float, theme: Theme) -> None:
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(theme.outline), 1))
        painter.setBrush(QColor(theme.cursor))
        tip = bar.left() + 3
        painter.drawPolygon(QPolygonF([QPointF(tip, y), QPointF(tip - 9, y - 5), QPointF(tip - 9, y + 5)]))
        painter.setPen(QPen(QColor(theme.cursor), 2))
        painter.drawLine(QPointF(bar.left(), y), QPointF(bar.right(), y))
        painter.restore()
