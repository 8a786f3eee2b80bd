"""Names of tools in one line: tabs where all names fit, else one large choice; a name that is cut is no name."""

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QFont, QFontMetrics, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QTabBar, QWidget

from widgets.quiet_combo import QuietCombo

HEIGHT = 40
LEAST_WIDTH = 120
_BESIDE_NAME = 32  # pixels of a tab that are not its name


class _WholeTabs(QTabBar):
    """Tabs as wide as their names, with room for those in bold."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setUsesScrollButtons(False)
        self.setElideMode(Qt.TextElideMode.ElideNone)

    def tabSizeHint(self, index: int) -> QSize:
        """Qt: the name with little beside it."""
        font = QFont(self.font())
        font.setBold(True)
        text = QFontMetrics(font).horizontalAdvance(self.tabText(index))
        return QSize(text + _BESIDE_NAME, max(HEIGHT, super().tabSizeHint(index).height()))

    def minimumTabSizeHint(self, index: int) -> QSize:
        """Qt: the same: a name is never cut."""
        return self.tabSizeHint(index)

    @property
    def wanted_width(self) -> int:
        """How wide all names are together."""
        return sum(self.tabSizeHint(row).width() for row in range(self.count()) if self.isTabVisible(row))


class TabHead(QWidget):
    """Rows by number, each with a name; ``changed`` tells that another came to the front."""

    changed = Signal()

    def __init__(self, name: str, accessible_name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._tabs = _WholeTabs()
        self._tabs.setObjectName(name)
        self._tabs.setExpanding(True)
        self._tabs.setDrawBase(False)
        self._tabs.setAccessibleName(accessible_name)
        self._tabs.currentChanged.connect(self._on_tab)
        self._choice = QuietCombo()
        self._choice.setObjectName(f"{name}_choice")
        self._choice.setMinimumHeight(HEIGHT)
        self._choice.setAccessibleName(accessible_name)
        self._choice.activated.connect(self._on_choice)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._tabs, 1)
        layout.addWidget(self._choice, 1)
        self._fit()

    def minimumSizeHint(self) -> QSize:
        """Qt: room for the choice; the tabs come where there is more."""
        return QSize(LEAST_WIDTH, HEIGHT)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: tabs or choice."""
        super().resizeEvent(event)
        self._fit()

    def changeEvent(self, event: QEvent) -> None:
        """Qt: other letters need other room."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit()

    # --- rows ---

    def add(self, title: str) -> int:
        """Add a name; returns its row."""
        row = self._tabs.addTab(title)
        self._tabs.setTabToolTip(row, title)
        self._fit()
        return row

    def set_title(self, row: int, title: str) -> None:
        """Change a name."""
        self._tabs.setTabText(row, title)
        self._tabs.setTabToolTip(row, title)
        self._fit()

    def show_rows(self, rows: frozenset[int]) -> None:
        """Offer these rows only."""
        for row in range(self._tabs.count()):
            self._tabs.setTabVisible(row, row in rows)
        self._fit()

    @property
    def current(self) -> int:
        """The row in front."""
        return self._tabs.currentIndex()

    def choose(self, row: int) -> None:
        """Bring a row to the front."""
        self._tabs.setCurrentIndex(row)

    def _on_tab(self) -> None:
        self._show_choice()
        self.changed.emit()

    def _on_choice(self, at: int) -> None:
        self.choose(int(self._choice.itemData(at)))

    def _fit(self) -> None:
        whole = self._tabs.wanted_width <= self.width()
        self._tabs.setVisible(whole)
        self._choice.setVisible(not whole)
        shown = [(self._tabs.tabText(row), row) for row in range(self._tabs.count()) if self._tabs.isTabVisible(row)]
        if shown != [(self._choice.itemText(at), self._choice.itemData(at)) for at in range(self._choice.count())]:
            self._choice.clear()
            for title, row in shown:
                self._choice.addItem(title, row)
        self._show_choice()

    def _show_choice(self) -> None:
        self._choice.setCurrentIndex(self._choice.findData(self.current))
