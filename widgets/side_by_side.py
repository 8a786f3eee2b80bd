"""Two rows of controls in one line where there is room, else one over the other: nothing is cut and nothing is gone."""

from PySide6.QtCore import QEvent, QSize
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QGridLayout, QWidget

SPACING = 6


class SideBySide(QWidget):
    """``first`` takes what room is left beside ``second``."""

    def __init__(self, first: QWidget, second: QWidget, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._first, self._second = first, second
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(SPACING)
        self._grid.setVerticalSpacing(4)
        self._stacked: bool | None = None
        self._place(stacked=False)

    @property
    def stacked(self) -> bool:
        """Whether they stand one over the other now."""
        return bool(self._stacked)

    def minimumSizeHint(self) -> QSize:
        """Qt: as wide as the wider of the two, as high as they stand now."""
        sizes = self._first.minimumSizeHint(), self._second.minimumSizeHint()
        width = max(size.width() for size in sizes)
        return QSize(width, self._grid.minimumSize().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: one line or two."""
        super().resizeEvent(event)
        self._fit()

    def event(self, event: QEvent) -> bool:
        """Qt: longer words need more room too."""
        done = super().event(event)
        if event.type() is QEvent.Type.LayoutRequest:
            self._fit()
        return done

    def _fit(self) -> None:
        wanted = sum(
            widget.minimumSizeHint().width() for widget in (self._first, self._second) if widget.isVisibleTo(self)
        )
        self._place(stacked=wanted + SPACING > self.width())

    def _place(self, *, stacked: bool) -> None:
        if stacked is self._stacked:
            return
        self._stacked = stacked
        self._grid.addWidget(self._first, 0, 0)
        self._grid.addWidget(self._second, 1 if stacked else 0, 0 if stacked else 1)
        self._grid.setColumnStretch(0, 1)
        self.updateGeometry()
