"""A picture that scrolls for ever at the cost of its new columns: a ring of pixel columns, stretched when it is drawn.

It is stretched here, not by Qt, whose scaling of an image costs thirty times as much.
"""

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QRectF
from PySide6.QtGui import QImage, QPainter

Pixels = npt.NDArray[np.uint32]  # 0xffrrggbb


class RingImage:
    """Holds the last ``columns`` columns of ``rows`` pixels; row 0 is the uppermost."""

    def __init__(self, columns: int, rows: int, ground: int = 0xFF000000) -> None:
        self.columns, self.rows = columns, rows
        self._pixels: Pixels = np.full((rows, columns), ground, dtype=np.uint32)
        self._next = 0  # where the next column goes, which is where the oldest one stands

    def append(self, pixels: Pixels) -> None:
        """Add columns (rows, k) at the right end, the newest last."""
        pixels = pixels[:, -self.columns :]
        count = pixels.shape[1]
        first = min(count, self.columns - self._next)
        self._pixels[:, self._next : self._next + first] = pixels[:, :first]
        self._pixels[:, : count - first] = pixels[:, first:]
        self._next = (self._next + count) % self.columns

    def take_back(self, count: int) -> None:
        """Let the next columns be drawn over the newest ``count``."""
        self._next = (self._next - count) % self.columns

    def in_order(self) -> Pixels:
        """Return a copy of all columns, oldest first."""
        return np.roll(self._pixels, -self._next, axis=1)

    def paint(self, painter: QPainter, rect: QRectF) -> None:
        """Draw it into ``rect``, oldest column at the left."""
        ratio = painter.device().devicePixelRatio()
        width, height = round(rect.width() * ratio), round(rect.height() * ratio)
        if width < 1 or height < 1:
            return
        column = (self._next + np.arange(width) * self.columns // width) % self.columns
        row = np.arange(height) * self.rows // height
        shown = self._pixels.take(column, axis=1).take(row, axis=0)
        image = QImage(shown.data, width, height, 4 * width, QImage.Format.Format_RGB32)
        image.setDevicePixelRatio(ratio)
        painter.drawImage(rect.topLeft().toPoint(), image)
