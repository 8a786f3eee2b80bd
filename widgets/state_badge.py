"""One line that says how a device is: shape, letter and colour, then its name, its state in words and figures."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.live.stream import LinkState
from widgets.painted_widget import PaintedWidget
from widgets.plot_theme import LIGHT, Theme
from widgets.recording_words import STATE_SIGNS, paint_mark, state_mark, state_text


class StateBadge(PaintedWidget):
    """Draws itself only when something changed."""

    def __init__(self, title: str, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._title, self._theme = title, theme
        self._shown = (LinkState.OFF, "", "")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    @property
    def state(self) -> LinkState:
        """The state that is shown."""
        return self._shown[0]

    @property
    def text(self) -> str:
        """What it says, as one sentence."""
        state, word, detail = self._shown
        word = word or state_text(state)
        return f"{self._title}: {word}" + (f" · {detail}" if detail else "")

    def set_state(self, state: LinkState, detail: str = "", word: str = "") -> None:
        """Show a state; ``word`` stands instead of the state's own word, ``detail`` after it."""
        if (state, word, detail) != self._shown:
            self._shown = (state, word, detail)
            self.setAccessibleName(self.text)
            self.setToolTip(self.text)
            self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        """Ask for one line."""
        return QSize(200, round(1.7 * self._theme.metrics().height()))

    def minimumSizeHint(self) -> QSize:
        """Ask for one line."""
        return QSize(120, self.sizeHint().height())

    def _paint(self, painter: QPainter) -> None:
        state = self._shown[0]
        side = float(self.height())
        paint_mark(painter, state_mark(state, self._theme), STATE_SIGNS[state], QRectF(0, 0, side, side), self._theme)
        font = self._theme.font()
        font.setBold(True)
        painter.setFont(font)
        painter.setPen(QColor(self._theme.text))
        room = QRectF(side + 6, 0, self.width() - side - 6, side)
        text = painter.fontMetrics().elidedText(self.text, Qt.TextElideMode.ElideRight, int(room.width()))
        painter.drawText(room, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, text)
