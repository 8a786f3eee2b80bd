"""The bar at the left: the steps from data to report as large buttons with their lights, and below them a few tools."""

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtGui import QAction, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QMenu, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from processing.readiness import Light, Step
from widgets.lights import light_icon
from widgets.plot_theme import LIGHT, Theme

PAGE_HEIGHT, TIES_HEIGHT, TOOL_HEIGHT = 52, 44, 42
LIGHT_WIDTH, LIGHT_PIXELS = 40, 26
LOW_HEIGHT = 44  # of all buttons in a low window
NARROW_WINDOW = 1100  # pixels: below it the steps are numbers
SPACING, MARGIN = 4, 6
TIES = "ties"  # a step that has no page of its own


class StepBar(QWidget):
    """One button a page, the current one checked, each with a light that says whether something is missing."""

    page_chosen = Signal(str)
    ties_chosen = Signal()
    light_pressed = Signal(str)  # a step

    def __init__(self, pages: Sequence[tuple[str, str]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)  # as wide as its words
        self._theme: Theme = LIGHT
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(4, 6, 4, 4)
        self._layout.setSpacing(SPACING)
        self._group = QButtonGroup(self)
        self._buttons: dict[str, QToolButton] = {}
        self._lights: dict[str, QToolButton] = {}
        self._shown: dict[str, Light] = {}
        self._words: dict[str, tuple[str, str]] = {}  # what a step's button says, with room and without
        self._tools: list[QToolButton] = []
        self._watched: QWidget | None = None
        for number, (key, text) in enumerate(pages, start=1):
            button = self._button(f"{number} {text}", PAGE_HEIGHT)
            button.setObjectName(f"page_{key}")
            button.setCheckable(True)
            button.clicked.connect(lambda _checked=False, k=key: self.page_chosen.emit(k))
            self._group.addButton(button)
            self._buttons[key] = button
            self._words[key] = button.text(), str(number)
            self._add_row(button, key, text, PAGE_HEIGHT)
            if key == Step.DATA:
                ties = self._button(self.tr("Tie points"), TIES_HEIGHT)
                ties.setObjectName("step_ties")
                ties.setEnabled(False)
                ties.clicked.connect(lambda _checked=False: self.ties_chosen.emit())
                self._buttons[TIES] = ties
                self._words[TIES] = ties.text(), "\N{BLACK SQUARE}"
                self._add_row(ties, TIES, ties.text(), TIES_HEIGHT)
        for key, button in self._buttons.items():
            button.setAccessibleName(self._words[key][0])
        self._layout.addStretch(1)
        self._more = self._button("\N{HORIZONTAL ELLIPSIS}", TOOL_HEIGHT)
        self._more.setObjectName("more_tools")
        self._more.setAccessibleName(self.tr("More tools"))
        self._more.setToolTip(self._more.accessibleName())
        self._more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self._more.setMenu(QMenu(self._more))
        self._more.hide()
        self._layout.addWidget(self._more)

    def add_tools(self, tools: Sequence[QAction]) -> None:
        """Add buttons for actions below the pages."""
        for action in tools:
            button = self._button("", TOOL_HEIGHT)
            button.setDefaultAction(action)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
            button.setObjectName(f"tool_{action.objectName()}")
            self._layout.insertWidget(self._layout.count() - 1, button)
            self._tools.append(button)
        self._fit()

    # --- what room there is ---

    def minimumSizeHint(self) -> QSize:
        """Qt: the steps in a low window, and one button for all tools."""
        rows = len(self._buttons) + (1 if self._tools else 0)
        return QSize(super().minimumSizeHint().width(), rows * (LOW_HEIGHT + SPACING) + 2 * MARGIN)

    def showEvent(self, event: QShowEvent) -> None:
        """Qt: look how wide the window is, from now on."""
        super().showEvent(event)
        if self._watched is not self.window():
            self._watched = self.window()
            self._watched.installEventFilter(self)
        self._fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: the window has another size."""
        if watched is self._watched and event.type() is QEvent.Type.Resize:
            self._fit()
        return super().eventFilter(watched, event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: there is other room."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        """Say steps by their numbers in a narrow window; put tools that have no room into one menu."""
        narrow = self.window().width() < NARROW_WINDOW
        for key, (words, number) in self._words.items():
            button = self._buttons[key]
            text = number if narrow else words
            if button.text() != text:
                button.setText(text)
                button.setToolTip(words if narrow else "")
        room = self.height() - 2 * MARGIN - len(self._tools) * (TOOL_HEIGHT + SPACING)
        low = room < len(self._buttons) * (PAGE_HEIGHT + SPACING)
        for key, button in self._buttons.items():
            height = LOW_HEIGHT if low else TIES_HEIGHT if key == TIES else PAGE_HEIGHT
            for part in (button, self._lights[key]):
                part.setFixedHeight(height)
        left = self.height() - 2 * MARGIN - sum(b.minimumHeight() + SPACING for b in self._buttons.values())
        fit = max(0, left // (TOOL_HEIGHT + SPACING))
        shown = len(self._tools) if fit >= len(self._tools) else max(0, fit - 1)
        for at, tool in enumerate(self._tools):
            tool.setVisible(at < shown)
        hidden = [action for tool in self._tools[shown:] if (action := tool.defaultAction()) is not None]
        if self._more.menu().actions() != hidden:
            self._more.menu().clear()
            self._more.menu().addActions(hidden)
        self._more.setVisible(bool(hidden))

    def _button(self, text: str, height: int) -> QToolButton:
        button = QToolButton()
        button.setText(text)
        button.setMinimumHeight(height)
        button.setIconSize(QSize(24, 24))
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _add_row(self, button: QToolButton, step: str, title: str, height: int) -> None:
        light = QToolButton()
        light.setObjectName(f"light_{step}")
        light.setProperty("step_title", title)
        light.setFixedWidth(LIGHT_WIDTH)
        light.setMinimumHeight(height)
        light.setIconSize(QSize(LIGHT_PIXELS, LIGHT_PIXELS))
        light.setStyleSheet("padding: 0px")
        light.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        light.clicked.connect(lambda _checked=False: self.light_pressed.emit(step))
        self._lights[step] = light
        self.set_light(step, Light.GREY, "", "")
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(2)
        row.addWidget(button, 1)
        row.addWidget(light)
        self._layout.addLayout(row)

    def set_light(self, step: str, light: Light, word: str, sentence: str) -> None:
        """Show a step's light; ``word`` names it to who cannot see it, ``sentence`` says why and what to do."""
        button = self._lights[step]
        if self._shown.get(step) is not light:
            self._shown[step] = light
            button.setIcon(light_icon(light, self._theme, LIGHT_PIXELS))
        button.setToolTip(sentence)
        button.setAccessibleName(f"{button.property('step_title')}: {word}")
        button.setAccessibleDescription(sentence)
        self._buttons[step].setAccessibleDescription(sentence)

    def light(self, step: str) -> Light:
        """Return which light a step shows."""
        return self._shown[step]

    def light_button(self, step: str) -> QToolButton:
        """Return a step's light: something can stand beside it."""
        return self._lights[step]

    def apply_theme(self, theme: Theme) -> None:
        """Draw the lights in these colours."""
        self._theme = theme
        for step, light in self._shown.items():
            self._lights[step].setIcon(light_icon(light, theme, LIGHT_PIXELS))

    def set_current(self, key: str) -> None:
        """Check the page's button without a signal; none for a page that is no step."""
        self._group.setExclusive(False)
        for name, button in self._buttons.items():
            button.setChecked(name == key)
        self._group.setExclusive(True)

    def set_enabled(self, key: str, *, enabled: bool) -> None:
        """Switch a page on or off; the tie points go with the data."""
        self._buttons[key].setEnabled(enabled)
        if key == Step.DATA:
            self._buttons[TIES].setEnabled(enabled)
