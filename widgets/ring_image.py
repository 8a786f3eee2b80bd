"""A picture that scrolls for ever at the cost of its new columns: a ring of pixel columns, drawn as two pieces."""

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
        # the image looks at the array's memory: what is written there is seen without a copy
        self._image = QImage(self._pixels.data, columns, rows, 4 * columns, QImage.Format.Format_RGB32)
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
        old = self.columns - self._next
        part = rect.width() * old / self.columns
        left = QRectF(rect.left(), rect.top(), part, rect.height())
        painter.drawImage(left, self._image, QRectF(self._next, 0, old, self.rows))
        if self._next:
            right = QRectF(rect.left() + part, rect.top(), rect.width() - part, rect.height())
            painter.drawImage(right, self._image, QRectF(0, 0, self._next, self.rows))
