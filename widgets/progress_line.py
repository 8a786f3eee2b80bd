"""A bar with its words on it, painted when there is time: QProgressBar repaints at once, and the views with it."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPalette, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from widgets.painted_widget import PaintedWidget

HEIGHT = 32
MARGIN = 6.0


class ProgressLine(PaintedWidget):
    """How much of something is done; the words stay readable on the filled part and beside it."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts: tuple[str, ...] = ("",)
        self._part = 0.0
        self.setMinimumHeight(HEIGHT)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)

    def show_part(self, part: float, *texts: str) -> None:
        """Show a part of 0..1 and the first of ``texts`` that there is room for, else the last."""
        if (part, texts) != (self._part, self._texts):
            self._part, self._texts = min(max(part, 0.0), 1.0), texts
            self.setAccessibleName(texts[0])
            self.update()

    @property
    def text(self) -> str:
        """What it says."""
        return self._texts[0]

    def sizeHint(self) -> QSize:
        """Qt: as high as its words need."""
        return QSize(160, max(HEIGHT, self.fontMetrics().height() + 10))

    def _paint(self, painter: QPainter) -> None:
        palette, rect = self.palette(), QRectF(self.rect()).adjusted(1, 1, -1, -1)
        done = QRectF(rect.left(), rect.top(), rect.width() * self._part, rect.height())
        ground, fill = palette.color(QPalette.ColorRole.Base), palette.color(QPalette.ColorRole.Highlight)
        painter.fillRect(rect, ground)
        painter.fillRect(done, fill)
        text = self._fitting(rect.width() - 2 * MARGIN)
        for area, role in ((done, QPalette.ColorRole.HighlightedText), (_rest(rect, done), QPalette.ColorRole.Text)):
            painter.setClipRect(area)
            painter.setPen(palette.color(role))
            painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, text)
        painter.setClipping(False)
        painter.setPen(QPen(QColor(palette.color(QPalette.ColorRole.Text)), 1.0))
        painter.drawRect(rect)

    def _fitting(self, width: float) -> str:
        metrics = self.fontMetrics()
        return next((text for text in self._texts if metrics.horizontalAdvance(text) <= width), self._texts[-1])


def _rest(whole: QRectF, done: QRectF) -> QRectF:
    return QRectF(done.right(), whole.top(), whole.right() - done.right(), whole.height())
