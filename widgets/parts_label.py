"""A line of figures that shows as many of them as there is room for, and all of them in its tool tip."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QWidget

BETWEEN = "   "
LEAST_WIDTH = 90


class PartsLabel(QLabel):
    """Parts in their order, each with its rank: the highest ranks go first where the room is short."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._parts: tuple[tuple[str, int], ...] = ()
        self._below = self._hint = ""
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)

    def set_parts(self, parts: Sequence[tuple[str, int]], below: str = "") -> None:
        """Show these texts with their ranks, and a line ``below`` them."""
        self._parts, self._below = tuple(parts), below
        self._show()

    def set_hint(self, hint: str) -> None:
        """Say more in the tool tip."""
        self._hint = hint
        self._show()

    def sizeHint(self) -> QSize:
        """Qt: room for all."""
        texts = (BETWEEN.join(text for text, _ in self._parts), self._below)
        width = max(self.fontMetrics().horizontalAdvance(text) for text in texts)
        return QSize(width + 8, super().sizeHint().height())

    def minimumSizeHint(self) -> QSize:
        """Qt: room for one figure."""
        return QSize(LEAST_WIDTH, super().minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: more or fewer parts."""
        super().resizeEvent(event)
        self._show()

    def _show(self) -> None:
        kept = list(self._parts)
        while len(kept) > 1 and self._width(kept) > self.width():
            kept.remove(max(kept, key=lambda part: part[1]))
        below = self._below.split(BETWEEN)
        while len(below) > 1 and self.fontMetrics().horizontalAdvance(BETWEEN.join(below)) + 4 > self.width():
            below.pop()  # what matters most stands first
        lines = (BETWEEN.join(text for text, _ in kept), BETWEEN.join(below))
        text = "\n".join(line for line in lines if line)
        if text != self.text():
            self.setText(text)
        whole = "" if len(kept) == len(self._parts) else BETWEEN.join(text for text, _ in self._parts)
        self.setToolTip("\n".join(line for line in (whole, self._below, self._hint) if line))

    def _width(self, parts: Sequence[tuple[str, int]]) -> int:
        return self.fontMetrics().horizontalAdvance(BETWEEN.join(text for text, _ in parts)) + 4
