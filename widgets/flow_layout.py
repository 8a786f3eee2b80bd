"""Buttons side by side while there is room, else in more rows; those of a row share its width."""

from PySide6.QtCore import QPoint, QRect, QSize, Qt
from PySide6.QtWidgets import QLayout, QLayoutItem, QWidget


class FlowLayout(QLayout):
    """Lays its items out in rows; an item is never narrower than its hint, unless the whole row is."""

    def __init__(self, spacing: int = 6, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._items: list[QLayoutItem] = []
        self.setSpacing(spacing)
        self.setContentsMargins(0, 0, 0, 0)

    def addItem(self, item: QLayoutItem) -> None:
        """Qt: take an item."""
        self._items.append(item)

    def count(self) -> int:
        """Qt: how many items there are."""
        return len(self._items)

    def itemAt(self, index: int) -> QLayoutItem | None:
        """Qt: an item, None beyond the last."""
        return self._items[index] if 0 <= index < len(self._items) else None

    def takeAt(self, index: int) -> QLayoutItem | None:
        """Qt: give an item back."""
        return self._items.pop(index) if 0 <= index < len(self._items) else None

    def expandingDirections(self) -> Qt.Orientation:
        """Qt: as wide as there is room."""
        return Qt.Orientation.Horizontal

    def hasHeightForWidth(self) -> bool:
        """Qt: more rows where it is narrow."""
        return True

    def heightForWidth(self, width: int) -> int:
        """Qt: how high the rows are."""
        rows = self._rows(width)
        return sum(_height(row) for row in rows) + self.spacing() * max(0, len(rows) - 1)

    def sizeHint(self) -> QSize:
        """Qt: everything in one row."""
        items = self._shown()
        width = sum(item.sizeHint().width() for item in items) + self.spacing() * max(0, len(items) - 1)
        return QSize(width, _height(items))

    def minimumSize(self) -> QSize:
        """Qt: as wide as the widest item."""
        items = self._shown()
        return QSize(max((item.minimumSize().width() for item in items), default=0), _height(items))

    def setGeometry(self, rect: QRect) -> None:
        """Qt: lay out."""
        super().setGeometry(rect)
        top = rect.top()
        for row in self._rows(rect.width()):
            height = _height(row)
            for item, (left, width) in zip(row, self._shares(row, rect.width()), strict=True):
                item.setGeometry(QRect(QPoint(rect.left() + left, top), QSize(width, height)))
            top += height + self.spacing()

    def _shown(self) -> list[QLayoutItem]:
        return [item for item in self._items if not item.isEmpty()]

    def _rows(self, width: int) -> list[list[QLayoutItem]]:
        rows: list[list[QLayoutItem]] = []
        used = 0
        for item in self._shown():
            need = item.sizeHint().width()
            if rows and used + self.spacing() + need <= width:
                rows[-1].append(item)
                used += self.spacing() + need
            else:
                rows.append([item])
                used = need
        return rows

    def _shares(self, row: list[QLayoutItem], width: int) -> list[tuple[int, int]]:
        """Return left and width of each item: what is over goes to those that want to grow, to all if none does."""
        hints = [item.sizeHint().width() for item in row]
        over = max(0, width - sum(hints) - self.spacing() * (len(row) - 1))
        wants = [bool(item.expandingDirections() & Qt.Orientation.Horizontal) for item in row]
        wants = wants if any(wants) else [True] * len(row)
        out, left = [], 0
        for hint, grows in zip(hints, wants, strict=True):
            mine = min(hint + (over // sum(wants) if grows else 0), width)
            out.append((left, mine))
            left += mine + self.spacing()
        return out


def _height(items: list[QLayoutItem]) -> int:
    return max((item.sizeHint().height() for item in items), default=0)
