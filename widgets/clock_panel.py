"""The clocks of sound and motion: a sentence, the picture of how they fit, and what to do where they do not."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from processing.clock_picture import ClockPicture
from widgets.clock_view import ClockView
from widgets.plot_theme import LIGHT, Theme


class ClockPanel(QWidget):
    """A line of words over a :class:`ClockView`."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = ClockView(theme)
        self._words = QLabel()
        self._words.setTextFormat(Qt.TextFormat.PlainText)
        self._words.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addWidget(self._words)
        layout.addWidget(self.view, 1)

    @property
    def words(self) -> str:
        """What is said."""
        return self._words.text()

    def show_clock(self, words: str, picture: ClockPicture | None) -> None:
        """Say this and show the picture; None shows none."""
        self._words.setText(words)
        self.view.show_picture(
            picture, self.tr("No blow was found that both felt. Next time knock five times at both ends.")
        )

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.view.apply_theme(theme)
