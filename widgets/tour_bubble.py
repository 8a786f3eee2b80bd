"""A hint that points at a widget: its words, which of how many it is, and buttons for back, next and close."""

from PySide6.QtCore import QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from widgets.bubble import Bubble

WIDTH = 400  # pixels: three lines of a hint
RING = 4  # pixels between the widget and the frame around it


class TourBubble(Bubble):
    """It never takes the keyboard by itself; with the keyboard in it, arrows step, Enter goes on and Escape closes."""

    stepped = Signal(int)  # +1 on, -1 back

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("tour")
        self._ring = QFrame(window)
        self._ring.setObjectName("tour_ring")
        self._ring.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._ring.setStyleSheet("#tour_ring { border: 4px solid palette(highlight); border-radius: 8px; }")
        self._ring.hide()
        self._title = QLabel()
        self._title.setStyleSheet("font-weight: bold; font-size: 13pt")
        self._title.setWordWrap(True)
        self._count = QLabel()
        self._words = QLabel()
        self._words.setTextFormat(Qt.TextFormat.PlainText)
        self._words.setWordWrap(True)
        self._back = self._button("tour_back", self.tr("← Back"))
        self._back.clicked.connect(lambda: self.stepped.emit(-1))
        self.next_button = self._button("tour_next", self.tr("Next →"))
        self.next_button.clicked.connect(lambda: self.stepped.emit(+1))
        close = self._button("tour_close", self.tr("Close"))
        close.clicked.connect(self.close_bubble)
        head = QHBoxLayout()
        head.addWidget(self._title, 1)
        head.addWidget(self._count, 0, Qt.AlignmentFlag.AlignTop)
        foot = QHBoxLayout()
        foot.addWidget(close)
        foot.addStretch(1)
        foot.addWidget(self._back)
        foot.addWidget(self.next_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(14, 10, 14, 10)
        layout.addLayout(head)
        layout.addWidget(self._words)
        layout.addLayout(foot)

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        button.setAutoDefault(False)
        return button

    @property
    def words(self) -> str:
        """What the hint says."""
        return self._words.text()

    def set_hint(self, title: str, words: str, number: int, count: int) -> None:
        """Say this; ``number`` counts from 1."""
        self._title.setText(title)
        self._words.setText(words)
        self._count.setText(f"{number} / {count}")
        self._back.setEnabled(number > 1)
        self.next_button.setText(self.tr("Next →") if number < count else self.tr("Done"))
        self.setAccessibleName(f"{title}. {words}")

    def wanted_size(self, most: QSize) -> QSize:
        """Return room for all words."""
        width = min(max(WIDTH, self.minimumSizeHint().width()), most.width())
        layout = self.layout()
        assert layout is not None  # made with the bubble
        inner = width - 2 * self.lineWidth()
        height = layout.heightForWidth(inner) if layout.hasHeightForWidth() else layout.sizeHint().height()
        return QSize(width, min(height + 2 * self.lineWidth(), most.height()))

    def place(self) -> None:
        """Move beside the widget, and draw a frame around it."""
        super().place()
        anchor = self._anchor
        if anchor is None or not anchor.isVisible():
            self._ring.hide()
            return
        target = QRect(anchor.mapTo(self._host, QPoint()), anchor.size())
        self._ring.setGeometry(target.adjusted(-RING, -RING, RING, RING).intersected(self._host.rect()))
        self._ring.show()
        self._ring.raise_()
        self.raise_()

    def close_bubble(self) -> None:
        """Take the hint and its frame away."""
        self._ring.hide()
        super().close_bubble()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: arrows step, Enter goes on; Escape closes."""
        steps = {Qt.Key.Key_Right: 1, Qt.Key.Key_Return: 1, Qt.Key.Key_Enter: 1, Qt.Key.Key_Left: -1}
        step = steps.get(Qt.Key(event.key()))
        if step is not None and (step > 0 or self._back.isEnabled()):
            self.stepped.emit(step)
            return
        super().keyPressEvent(event)
