"""The bar at the left: the steps from data to report as large buttons, and below them a few tools."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QButtonGroup, QSizePolicy, QToolButton, QVBoxLayout, QWidget

WIDTH = 104


class StepBar(QWidget):
    """One button a page, the current one checked."""

    page_chosen = Signal(str)

    def __init__(self, pages: Sequence[tuple[str, str]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumWidth(WIDTH)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)  # as wide as its words
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(4, 6, 4, 4)
        self._layout.setSpacing(4)
        self._group = QButtonGroup(self)
        self._buttons: dict[str, QToolButton] = {}
        for number, (key, text) in enumerate(pages, start=1):
            button = self._button(f"{number} {text}", 52)
            button.setObjectName(f"page_{key}")
            button.setCheckable(True)
            button.clicked.connect(lambda _checked=False, k=key: self.page_chosen.emit(k))
            self._group.addButton(button)
            self._buttons[key] = button
        self._layout.addStretch(1)

    def add_tools(self, tools: Sequence[QAction]) -> None:
        """Add buttons for actions below the pages."""
        for action in tools:
            button = self._button("", 42)
            button.setDefaultAction(action)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
            button.setObjectName(f"tool_{action.objectName()}")

    def _button(self, text: str, height: int) -> QToolButton:
        button = QToolButton()
        button.setText(text)
        button.setMinimumHeight(height)
        button.setIconSize(QSize(24, 24))
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._layout.addWidget(button)
        return button

    def set_current(self, key: str) -> None:
        """Check the page's button without a signal."""
        self._buttons[key].setChecked(True)

    def set_enabled(self, key: str, *, enabled: bool) -> None:
        """Switch a page on or off."""
        self._buttons[key].setEnabled(enabled)
