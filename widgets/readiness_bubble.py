"""What the steps still lack, in sentences, each with its light and a button that leads to where it is mended."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from processing.readiness import Light
from widgets.bubble import Bubble
from widgets.lights import light_icon
from widgets.plot_theme import LIGHT, Theme

ICON = 28
HEAD = 90  # pixels of title and margins
TEXT_WIDTH = 360  # pixels; two or three lines of a sentence


@dataclass(frozen=True)
class ReadinessRow:
    """A line: the step's ``title`` (may be empty), what is to be known, and the ``lead`` with its button's words."""

    light: Light
    title: str
    text: str
    lead: str = ""
    lead_text: str = ""


class ReadinessBubble(Bubble):
    """Signals out; it goes nowhere itself."""

    lead_chosen = Signal(str)
    manual_asked = Signal()

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("readiness")
        self.setAccessibleName(self.tr("What is missing"))
        self._theme: Theme = LIGHT
        self._rows: tuple[ReadinessRow, ...] = ()
        title = QLabel(self.tr("What is missing"))
        title.setStyleSheet("font-weight: bold; font-size: 13pt")
        help_button = QToolButton()
        help_button.setText("?")
        help_button.setMinimumSize(44, 44)
        help_button.setToolTip(self.tr("Manual: what the lights mean"))
        help_button.setAccessibleName(self.tr("Manual: what the lights mean"))
        help_button.clicked.connect(self.manual_asked)
        self._close = QPushButton(self.tr("Close"))
        self._close.setObjectName("readiness_close")
        self._close.setMinimumHeight(44)
        self._close.clicked.connect(self.close_bubble)
        head = QHBoxLayout()
        head.addWidget(title, 1)
        head.addWidget(help_button)
        head.addWidget(self._close)
        self._scroll = QScrollArea()
        self._scroll.setWidgetResizable(True)
        self._scroll.setFrameShape(QScrollArea.Shape.NoFrame)
        self._scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(12, 10, 12, 10)
        layout.addLayout(head)
        layout.addWidget(self._scroll, 1)

    @property
    def rows(self) -> tuple[ReadinessRow, ...]:
        """What is shown."""
        return self._rows

    def set_rows(self, rows: Sequence[ReadinessRow]) -> None:
        """Show these lines."""
        self._rows = tuple(rows)
        content = QWidget()
        grid = QGridLayout(content)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setVerticalSpacing(8)
        grid.setColumnStretch(1, 1)
        for number, row in enumerate(rows):
            mark = QLabel()
            mark.setPixmap(light_icon(row.light, self._theme, ICON).pixmap(ICON, ICON))
            grid.addWidget(mark, number, 0, Qt.AlignmentFlag.AlignTop)
            words = QLabel(f"{row.title}: {row.text}" if row.title else row.text)
            words.setTextFormat(Qt.TextFormat.PlainText)
            words.setWordWrap(True)
            words.setMinimumWidth(TEXT_WIDTH)
            grid.addWidget(words, number, 1)
            if row.lead:
                button = QPushButton(row.lead_text)
                button.setObjectName(f"lead_{row.lead}")
                button.setMinimumHeight(44)
                button.setAccessibleDescription(row.text)
                button.clicked.connect(lambda _checked=False, lead=row.lead: self.lead_chosen.emit(lead))
                grid.addWidget(button, number, 2, Qt.AlignmentFlag.AlignTop)
        old = self._scroll.takeWidget()
        self._scroll.setWidget(content)
        if old is not None:
            old.deleteLater()

    def apply_theme(self, theme: Theme) -> None:
        """Draw the lights in these colours."""
        self._theme = theme
        self.set_rows(self._rows)

    def focus_first(self) -> None:
        """Put the keyboard on the first button that leads somewhere, else on Close."""
        content = self._scroll.widget()
        buttons = content.findChildren(QPushButton) if content is not None else []
        (buttons[0] if buttons else self._close).setFocus()

    def wanted_size(self, most: QSize) -> QSize:
        """Return room for all lines, so that nothing has to be scrolled while the window is large enough."""
        content = self._scroll.widget()
        if content is None:
            return super().wanted_size(most)
        layout = content.layout()
        assert layout is not None  # made in set_rows
        beside = 30 + 2 * self.lineWidth()
        width = min(layout.sizeHint().width() + beside, most.width())
        height = layout.heightForWidth(width - beside) if layout.hasHeightForWidth() else layout.sizeHint().height()
        if height + HEAD > most.height():  # the lines are scrolled: the bar must not cover the buttons
            width = min(width + self._scroll.verticalScrollBar().sizeHint().width(), most.width())
        return QSize(width, min(height + HEAD, most.height()))
