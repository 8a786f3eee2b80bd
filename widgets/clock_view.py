"""Shows whether the clocks of sound and motion fit: blows side by side, one peak or none, and what is left over."""

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.clock_picture import SHIFT_STEP_S, ClockPicture, CloseUp
from processing.survey import FloatArray
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.vocabulary import clock_text

_LEAST_SPAN_MS = 10.0


@dataclass(frozen=True)
class _Frame:
    """A plot's rectangle and what its edges stand for."""

    rect: QRectF
    left: float
    right: float
    bottom: float
    top: float

    def point(self, x: float, y: float) -> QPointF:
        across = (x - self.left) / (self.right - self.left) if self.right > self.left else 0.5
        up = (y - self.bottom) / (self.top - self.bottom) if self.top > self.bottom else 0.5
        return QPointF(self.rect.left() + across * self.rect.width(), self.rect.bottom() - up * self.rect.height())

    def polygon(self, x: FloatArray, y: FloatArray) -> QPolygonF:
        return QPolygonF([self.point(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)])


class ClockView(PaintedWidget):
    """Three plots below one another; without a picture it says ``hint``."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._picture: ClockPicture | None = None
        self._hint = ""
        self.setAccessibleName(self.tr("How the clocks of sound and motion fit"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 300)

    def show_picture(self, picture: ClockPicture | None, hint: str = "") -> None:
        """Show this; ``hint`` is said where there is nothing to show."""
        self._picture, self._hint = picture, hint
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def _paint(self, painter: QPainter) -> None:
        """Draw the plots."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        painter.fillRect(self.rect(), QColor(self._theme.background))
        picture = self._picture
        if picture is None or not len(picture.residual_ms):
            painter.setPen(QColor(self._theme.text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(QRectF(self.rect()).adjusted(16, 16, -16, -16), flags, self._hint)
            return
        height = self.height() / 3.0
        rows = [QRectF(0.0, k * height, self.width(), height) for k in range(3)]
        self._paint_close_ups(painter, picture.close_ups, rows[0])
        self._paint_peak(painter, picture, rows[1])
        self._paint_left_over(painter, picture, rows[2])

    def _frame(self, painter: QPainter, room: QRectF, title: str, span: tuple[float, float, float, float]) -> _Frame:
        line = self._theme.metrics().height()
        rect = room.adjusted(8, 1.5 * line, -8, -1.5 * line)
        painter.fillRect(rect, QColor(self._theme.canvas))
        painter.setPen(QColor(self._theme.text))
        shown = self._theme.metrics().elidedText(title, Qt.TextElideMode.ElideRight, round(rect.width()))
        painter.drawText(QPointF(rect.left(), rect.top() - 0.35 * line), shown)
        painter.setPen(QPen(QColor(self._theme.text), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(rect)
        return _Frame(rect, *span)

    def _foot(self, painter: QPainter, frame: _Frame, left: str, middle: str, right: str) -> None:
        box = QRectF(frame.rect.left(), frame.rect.bottom() + 2, frame.rect.width(), self._theme.metrics().height())
        painter.setPen(QColor(self._theme.text))
        sides = (Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignHCenter, Qt.AlignmentFlag.AlignRight)
        for text, side in zip((left, middle, right), sides, strict=True):
            painter.drawText(box, side | Qt.AlignmentFlag.AlignTop, text)

    def _paint_close_ups(self, painter: QPainter, close_ups: tuple[CloseUp, ...], room: QRectF) -> None:
        width = room.width() / len(close_ups)
        line = self._theme.metrics().height()
        painter.setPen(QColor(self._theme.text))
        painter.drawText(QPointF(room.left() + 8, room.top() + 1.15 * line), self.tr("Blows: felt above, heard below"))
        for number, close in enumerate(close_ups):
            part = QRectF(room.left() + number * width, room.top(), width, room.height())
            frame = self._frame(painter, part, "", (close.start_s, close.end_s, -1.0, 1.0))
            styles = (
                (close.felt_s, 0.08, 0.8, self._theme.curve, 1.5),
                (close.heard_s, -0.8, -0.08, self._theme.curve_second, 1.5),
                (close.both_s, -0.95, 0.95, self._theme.text, 0.8),
            )
            for times, low, high, colour, weight in styles:
                painter.setPen(QPen(QColor(colour), weight * self._theme.line_width))
                for time in times.tolist():
                    painter.drawLine(frame.point(time, low), frame.point(time, high))
            seconds = self.tr("{seconds} s").format(seconds=number_text(close.end_s - close.start_s, 0))
            self._foot(painter, frame, clock_text(close.start_s), "", seconds)

    def _paint_peak(self, painter: QPainter, picture: ClockPicture, room: QRectF) -> None:
        title = self.tr("How far the sound comes after the motion: one peak fits")
        half, most = float(-picture.shift_ms[0]), max(1.0, float(picture.counts.max()))
        frame = self._frame(painter, room, title, (-half, half, 0.0, 1.05 * most))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self._theme.curve))
        for left, count in zip(picture.shift_ms.tolist(), picture.counts.tolist(), strict=True):
            painter.drawRect(QRectF(frame.point(left, count), frame.point(left + 1000 * SHIFT_STEP_S, 0.0)))
        ends = (f"−{number_text(half, 0)} ms", "0", f"+{number_text(half, 0)} ms")
        self._foot(painter, frame, *ends)

    def _paint_left_over(self, painter: QPainter, picture: ClockPicture, room: QRectF) -> None:
        near = float(np.quantile(np.abs(picture.residual_ms), 0.98))
        half = max(_LEAST_SPAN_MS, 1.2 * near, min(1.2 * float(picture.band_ms.max()), 20 * near))
        times = picture.band_time_s
        title = self.tr("Left over along the run, ±{ms} ms (shaded: 95 %)").format(ms=number_text(half, 0))
        frame = self._frame(painter, room, title, (float(times[0]), float(times[-1]), -half, half))
        painter.save()
        painter.setClipRect(frame.rect)
        shade = QColor(self._theme.curve)
        shade.setAlpha(60)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(shade)
        both = np.concatenate([picture.band_ms, -picture.band_ms[::-1]])
        painter.drawPolygon(frame.polygon(np.concatenate([times, times[::-1]]), both))
        painter.setPen(QPen(QColor(self._theme.text), 1))
        painter.drawLine(frame.point(times[0], 0.0), frame.point(times[-1], 0.0))
        painter.setPen(QPen(QColor(self._theme.background), 1))
        painter.setBrush(QColor(self._theme.curve_second))
        for time, left in zip(picture.time_s.tolist(), picture.residual_ms.tolist(), strict=True):
            painter.drawEllipse(frame.point(time, left), 3.5, 3.5)
        painter.restore()
        self._foot(painter, frame, clock_text(float(times[0])), "", clock_text(float(times[-1])))
