"""What stands beside the plan on the path page: the motion strips, or one of the tools, chosen by tabs."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QStackedWidget, QTabBar, QVBoxLayout, QWidget

STRIPS = "motion"


class PathTools(QWidget):
    """Holds ``strips`` and named tools; without tabs (on other pages) it shows the strips alone."""

    chosen = Signal(str)

    def __init__(self, strips: QWidget, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._strips = strips
        self._names = [STRIPS]
        self._tabs = QTabBar()
        self._tabs.setObjectName("path_tools")
        self._tabs.setExpanding(True)
        self._tabs.setDrawBase(False)
        self._tabs.setUsesScrollButtons(False)
        self._tabs.setMinimumHeight(40)
        self._tabs.addTab(title)
        self._tabs.setAccessibleName(self.tr("Beside the plan"))
        self._stack = QStackedWidget()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self._tabs)
        layout.addWidget(strips, 1)
        layout.addWidget(self._stack, 1)
        self._shown = False
        self._tabs.currentChanged.connect(self._show)
        self._show()

    def add_tool(self, name: str, title: str, tool: QWidget) -> None:
        """Add a tool with its tab."""
        self._names.append(name)
        self._stack.addWidget(tool)
        self._tabs.addTab(title)

    def set_title(self, name: str, title: str) -> None:
        """Change what a tab says."""
        self._tabs.setTabText(self._names.index(name), title)

    def set_tabs_shown(self, shown: bool) -> None:
        """Show tabs and the chosen tool, or the strips alone."""
        self._shown = shown
        self._show()

    @property
    def names(self) -> Sequence[str]:
        """The tools' names in the order of the tabs, the strips first."""
        return tuple(self._names)

    @property
    def current(self) -> str:
        """The name of what is shown."""
        return self._names[self._tabs.currentIndex()] if self._shown else STRIPS

    def choose(self, name: str) -> None:
        """Bring a tool to the front."""
        self._tabs.setCurrentIndex(self._names.index(name))

    def _show(self) -> None:
        current = self.current
        self._tabs.setVisible(self._shown and len(self._names) > 1)
        self._strips.setVisible(current == STRIPS)
        self._stack.setVisible(current != STRIPS)
        if current != STRIPS:
            self._stack.setCurrentIndex(self._names.index(current) - 1)
        self.chosen.emit(current)
