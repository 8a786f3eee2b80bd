"""The tools beside the views: one tab bar beside the plan, one over the list of leaks; each page shows its own tabs."""

from collections.abc import Collection, Mapping, Sequence
from typing import Protocol, runtime_checkable

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QStackedWidget, QVBoxLayout, QWidget

from widgets.plot_theme import Theme
from widgets.tab_head import TabHead

FIRST = ""
SIDES = ("beside", "side")


@runtime_checkable
class Themed(Protocol):
    """A tool that draws in the colours of the theme."""

    def apply_theme(self, theme: Theme) -> None:
        """Draw everything in this theme."""
        ...


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
        self._tabs = TabHead(name, title)
        self._tabs.add(title)
        self._stack = QStackedWidget()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self._tabs)
        layout.addWidget(first, 1)
        layout.addWidget(self._stack, 1)
        self._tabs.changed.connect(self._show)
        self._show()

    def add_tool(self, name: str, title: str, tool: QWidget, pages: Collection[str]) -> None:
        """Add a tool with its tab, which is there on ``pages``."""
        self._names.append(name)
        self._pages.append(pages)
        self._stack.addWidget(tool)
        self._tabs.add(title)
        self._show_rows()
        self._show()

    @property
    def page(self) -> str:
        """The page that was set last."""
        return self._page

    def restore(self, fronts: Mapping[str, str]) -> None:
        """Bring to the front, on each page, the tool that ``fronts`` names by page; the first one where it does not."""
        named = {page: self._names.index(name) for page, name in fronts.items() if name in self._names}
        self._left = {page: row for page, row in named.items() if row == 0 or page in self._pages[row]}
        self._tabs.choose(self._left.get(self._page, 0))

    def set_title(self, name: str, title: str) -> None:
        """Change what a tab says."""
        self._tabs.set_title(self._names.index(name), title)

    def set_page(self, page: str) -> None:
        """Show the tabs of this page, with the one in front that was there when the page was left."""
        self._left[self._page] = self._tabs.current
        self._page = page
        self._show_rows()
        self._tabs.choose(self._left.get(page, 0))
        self._show()

    @property
    def names(self) -> Sequence[str]:
        """The tools' names in the order of the tabs, the empty one of the first widget in front."""
        return tuple(self._names)

    @property
    def current(self) -> str:
        """The name of what is shown."""
        return self._names[self._tabs.current]

    @property
    def tools(self) -> Sequence[QWidget]:
        """The tools in the order of their tabs."""
        return tuple(tool for row in range(self._stack.count()) if (tool := self._stack.widget(row)) is not None)

    def choose(self, name: str) -> None:
        """Bring a tool of this page to the front."""
        row = self._names.index(name)
        if row == 0 or self._page in self._pages[row]:
            self._tabs.choose(row)

    def _show_rows(self) -> None:
        shown = (row for row, pages in enumerate(self._pages) if row == 0 or self._page in pages)
        self._tabs.show_rows(frozenset(shown))

    def _show(self) -> None:
        row = self._tabs.current
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

    def in_front(self) -> dict[str, str]:
        """Return the tools in front on the page that is shown, by ``beside.page`` and ``side.page``."""
        return {f"{side}.{holder.page}": holder.current for side, holder in zip(SIDES, self._holders, strict=True)}

    def restore(self, fronts: Mapping[str, str]) -> None:
        """Bring to the front what :meth:`in_front` told of each page; the first tool where it did not."""
        for side, holder in zip(SIDES, self._holders, strict=True):
            start = f"{side}."
            holder.restore({key.removeprefix(start): name for key, name in fronts.items() if key.startswith(start)})

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
