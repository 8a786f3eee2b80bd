"""The tools beside the views: one tab bar beside the plan, one over the list of leaks; each page shows its own tabs."""

from collections.abc import Collection, Sequence
from typing import Protocol, runtime_checkable

from PySide6.QtCore import QObject, QSize, Qt, Signal
from PySide6.QtWidgets import QStackedWidget, QTabBar, QVBoxLayout, QWidget

from widgets.plot_theme import Theme

FIRST = ""
_BESIDE_NAME = 24  # pixels of a tab that are not its name
_LEAST_TAB = 40
_SHORT_NAME = 50  # pixels: it is not cut


@runtime_checkable
class Themed(Protocol):
    """A tool that draws in the colours of the theme."""

    def apply_theme(self, theme: Theme) -> None:
        """Draw everything in this theme."""
        ...


class _NarrowTabs(QTabBar):
    """Tabs that share what room there is: scroll buttons beside them are nothing for a glove."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setUsesScrollButtons(False)
        self.setElideMode(Qt.TextElideMode.ElideRight)

    def tabSizeHint(self, index: int) -> QSize:
        """Qt: the name with little beside it."""
        size = super().tabSizeHint(index)
        text = self.fontMetrics().horizontalAdvance(self.tabText(index))
        return QSize(min(size.width(), text + _BESIDE_NAME), size.height())

    def minimumTabSizeHint(self, index: int) -> QSize:
        """Qt: the least, with a long name cut."""
        text = self.fontMetrics().horizontalAdvance(self.tabText(index))
        least = text if text <= _SHORT_NAME else max(_SHORT_NAME, round(0.6 * text))
        return QSize(least + _BESIDE_NAME, super().minimumTabSizeHint(index).height())

    def minimumSizeHint(self) -> QSize:
        """Qt: as wide as the tabs are when cut."""
        return QSize(_LEAST_TAB * self.count(), super().minimumSizeHint().height())


class TabTools(QWidget):
    """Holds a first widget and named tools; on a page for which no tool is there it shows the first alone."""

    chosen = Signal(str)  # the tool in front; empty for the first widget

    def __init__(self, first: QWidget, title: str, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._first = first
        self._names = [FIRST]
        self._pages: list[Collection[str]] = [()]
        self._page = ""
        self._left: dict[str, int] = {}  # the tab that was in front when a page was left
        self._tabs = _NarrowTabs()
        self._tabs.setObjectName(name)
        self._tabs.setExpanding(True)
        self._tabs.setDrawBase(False)
        self._tabs.setMinimumHeight(40)
        self._tabs.addTab(title)
        self._tabs.setAccessibleName(title)
        self._stack = QStackedWidget()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self._tabs)
        layout.addWidget(first, 1)
        layout.addWidget(self._stack, 1)
        self._tabs.currentChanged.connect(self._show)
        self._show()

    def add_tool(self, name: str, title: str, tool: QWidget, pages: Collection[str]) -> None:
        """Add a tool with its tab, which is there on ``pages``."""
        self._names.append(name)
        self._pages.append(pages)
        self._stack.addWidget(tool)
        row = self._tabs.addTab(title)
        self._tabs.setTabToolTip(row, title)
        self._tabs.setTabVisible(row, self._page in pages)
        self._show()

    def set_title(self, name: str, title: str) -> None:
        """Change what a tab says."""
        self._tabs.setTabText(self._names.index(name), title)
        self._tabs.setTabToolTip(self._names.index(name), title)

    def set_page(self, page: str) -> None:
        """Show the tabs of this page, with the one in front that was there when the page was left."""
        self._left[self._page] = self._tabs.currentIndex()
        self._page = page
        for row, pages in enumerate(self._pages):
            self._tabs.setTabVisible(row, row == 0 or page in pages)
        self._tabs.setCurrentIndex(self._left.get(page, 0))
        self._show()

    @property
    def names(self) -> Sequence[str]:
        """The tools' names in the order of the tabs, the empty one of the first widget in front."""
        return tuple(self._names)

    @property
    def current(self) -> str:
        """The name of what is shown."""
        return self._names[self._tabs.currentIndex()]

    @property
    def tools(self) -> Sequence[QWidget]:
        """The tools in the order of their tabs."""
        return tuple(tool for row in range(self._stack.count()) if (tool := self._stack.widget(row)) is not None)

    def choose(self, name: str) -> None:
        """Bring a tool of this page to the front."""
        row = self._names.index(name)
        if row == 0 or self._page in self._pages[row]:
            self._tabs.setCurrentIndex(row)

    def _show(self) -> None:
        row = self._tabs.currentIndex()
        self._tabs.setVisible(any(self._page in pages for pages in self._pages))
        self._first.setVisible(row == 0)
        self._stack.setVisible(row != 0)
        if row:
            self._stack.setCurrentIndex(row - 1)
        self.chosen.emit(self.current)


class PageTools(QObject):
    """All tools of the review page: those of the path page stand beside the plan, all others over the list of leaks."""

    chosen = Signal(str)  # what came to the front on either side

    def __init__(self, beside: TabTools, side: TabTools, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._holders = (beside, side)
        for holder in self._holders:
            holder.chosen.connect(self.chosen)

    def add_tool(self, name: str, title: str, tool: QWidget, pages: Collection[str] = ("path",)) -> None:
        """Add a tool with its tab on ``pages``: on ``path``, or on any of ``sound`` and ``leaks``."""
        self._holders[0 if "path" in pages else 1].add_tool(name, title, tool, pages)

    def set_title(self, name: str, title: str) -> None:
        """Change what a tool's tab says."""
        self._of(name).set_title(name, title)

    def set_page(self, page: str) -> None:
        """Show the tabs of this page."""
        for holder in self._holders:
            holder.set_page(page)

    def choose(self, name: str) -> None:
        """Bring a tool to the front, if it belongs to the page that is shown."""
        self._of(name).choose(name)

    def leave(self, name: str) -> None:
        """Bring back what a tool covers: the views, or the list of leaks."""
        self._of(name).choose(FIRST)

    def is_in_front(self, name: str) -> bool:
        """Return whether this tool's tab is the chosen one."""
        return self._of(name).current == name

    def apply_theme(self, theme: Theme) -> None:
        """Let all tools draw in this theme."""
        for holder in self._holders:
            for tool in holder.tools:
                if isinstance(tool, Themed):
                    tool.apply_theme(theme)

    def _of(self, name: str) -> TabTools:
        return next(holder for holder in self._holders if name in holder.names)
