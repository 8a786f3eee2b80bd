"""A stack of pages, each of which scrolls where the window is smaller than it: whatever the size, all is reachable."""

from typing import cast

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QFrame, QScrollArea, QStackedWidget, QWidget

LEAST = QSize(320, 240)


class _Frame(QScrollArea):
    """A page with scroll bars that show when they are needed."""

    def __init__(self, page: QWidget) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.page = page
        self.setWidget(page)

    def minimumSizeHint(self) -> QSize:
        """Qt: far less than the page: it scrolls."""
        return LEAST


class PageStack(QStackedWidget):
    """Used as Qt's stack is: pages go in and come out as they are, the scroll areas around them are its own."""

    def addWidget(self, page: QWidget) -> int:
        """Qt: put a page in."""
        return super().addWidget(_Frame(page))

    def currentWidget(self) -> QWidget:
        """Qt: the page in front."""
        return cast("_Frame", super().currentWidget()).page

    def setCurrentWidget(self, page: QWidget) -> None:
        """Qt: bring a page to the front."""
        for row in range(self.count()):
            if cast("_Frame", super().widget(row)).page is page:
                self.setCurrentIndex(row)

    def widget(self, row: int) -> QWidget:
        """Qt: a page by its number."""
        return cast("_Frame", super().widget(row)).page

    def minimumSizeHint(self) -> QSize:
        """Qt: what a page that scrolls needs at least; pages that are not in front have no say."""
        return LEAST
