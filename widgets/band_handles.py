"""The two edges of the detector's band on a spectrogram: lines with grips wide enough for gloves, and read-outs."""

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from widgets.plot_paint import paint_tag
from widgets.plot_theme import Theme

GRIP_WIDTH, GRIP_HEIGHT = 46.0, 26.0
LINE_PIXELS = 5.0  # on either side of a line away from the grips: less, so that a pan rarely begins on it


@dataclass(frozen=True)
class BandHandles:
    """Where the lower and the upper edge of the band stand in a plot; NaN-free pixels, the upper one smaller."""

    rect: QRectF
    low_y: float
    high_y: float

    def visible(self) -> list[tuple[int, float]]:
        """Return which edges are in sight: 0 for the lower, 1 for the upper, each with its pixel."""
        edges = ((0, self.low_y), (1, self.high_y))
        return [(which, y) for which, y in edges if self.rect.top() - 1 <= y <= self.rect.bottom() + 1]

    def grips(self, which: int, y: float) -> tuple[QRectF, QRectF]:
        """Return the grips of an edge, left and right; they stand off the band, so that a narrow one has both."""
        top = y - (GRIP_HEIGHT - 6.0 if which else 6.0)
        top = min(max(top, self.rect.top()), self.rect.bottom() - GRIP_HEIGHT)
        left = QRectF(self.rect.left(), top, GRIP_WIDTH, GRIP_HEIGHT)
        return left, left.translated(self.rect.width() - GRIP_WIDTH, 0.0)

    def grabbed(self, place: QPointF) -> int | None:
        """Return which edge follows the mouse when it is pressed here."""
        for which, y in self.visible():
            if any(grip.contains(place) for grip in self.grips(which, y)):
                return which
        if not self.rect.contains(place):
            return None
        near = [(abs(y - place.y()), which) for which, y in self.visible()]
        return min(near)[1] if near and min(near)[0] <= LINE_PIXELS else None

    def paint(self, painter: QPainter, theme: Theme, texts: tuple[str, str], *, name: str = "") -> None:
        """Draw lines and grips, with the frequencies ``texts`` of lower and upper edge in the left grips.

        ``name`` stands beside the upper left grip.
        """
        rect = self.rect
        painter.save()
        painter.setClipRect(rect)
        for _, y in self.visible():
            for colour, width in ((theme.outline, 3.0), (theme.text, 1.0)):
                style = Qt.PenStyle.SolidLine if width > 1 else Qt.PenStyle.DashLine
                painter.setPen(QPen(QColor(colour), width, style))
                painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
        for which, y in self.visible():
            left, right = self.grips(which, y)
            text = texts[which]
            wide = max(GRIP_WIDTH, theme.metrics().horizontalAdvance(text) + 10.0)
            paint_tag(painter, theme, text, QRectF(left.left(), left.top(), wide, GRIP_HEIGHT), strong=True)
            paint_tag(painter, theme, "", right, strong=True)
            painter.setPen(QPen(QColor(theme.text), 2))
            for step in (-5.0, 0.0, 5.0):  # three bars: what is made to be taken hold of
                middle = right.center().y() + step
                painter.drawLine(QPointF(right.left() + 12, middle), QPointF(right.right() - 12, middle))
            if which and name:
                box = QRectF(left.left() + wide + 4, left.top(), theme.metrics().horizontalAdvance(name) + 12, 0.0)
                box.setHeight(GRIP_HEIGHT)
                if box.right() < right.left():
                    paint_tag(painter, theme, name, box)
        painter.restore()
