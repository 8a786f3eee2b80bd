"""Where a control puts a page of its own that is built when it is first asked for."""

from collections.abc import Callable
from dataclasses import dataclass, field

from PySide6.QtWidgets import QStackedWidget, QWidget


@dataclass(frozen=True)
class PageHost:
    """The window's pages by name, the stack that shows them, and the way to one of them."""

    pages: dict[str, QWidget]
    stack: QStackedWidget
    show: Callable[[str], None]
    current: Callable[[], str]
    openers: dict[str, Callable[[], None]] = field(default_factory=dict)  # of pages that are built when asked for

    def add(self, name: str, page: QWidget) -> None:
        """Put a page among the others; ``show`` brings it to the front."""
        self.pages[name] = page
        self.stack.addWidget(page)
