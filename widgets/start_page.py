"""What the window shows while nothing is open: record, open a folder, a recent survey, or the demonstration."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

PATH = Qt.ItemDataRole.UserRole


class StartPage(QWidget):
    """Signals out; it opens nothing itself."""

    open_asked = Signal()
    record_asked = Signal()
    demo_asked = Signal()
    recent_chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        title = QLabel("Leakline")
        title.setStyleSheet("font-size: 30pt; font-weight: bold")
        claim = QLabel(self.tr("From the folder off the device to a leak on the map, the same day."))
        claim.setWordWrap(True)
        self._record = self._button("start_record", self.tr("●  Record"), self.record_asked)
        self._record.setMinimumHeight(76)
        self._open = self._button("start_open", self.tr("Open the device's folder…"), self.open_asked)
        self._demo = self._button("start_demo", self.tr("Look at the demonstration"), self.demo_asked)
        drop = QLabel(self.tr("or drop a folder anywhere on this window"))
        drop.setAlignment(Qt.AlignmentFlag.AlignCenter)
        drop.setFrameShape(QFrame.Shape.StyledPanel)
        drop.setMinimumHeight(72)
        left = QVBoxLayout()
        for widget in (title, claim, self._record, self._open, self._demo, drop):
            left.addWidget(widget)
        left.addStretch(1)
        self._recent = QListWidget()
        self._recent.setObjectName("recent")
        self._recent.setAccessibleName(self.tr("Recent surveys"))
        self._recent.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self._recent.itemActivated.connect(self._on_recent)
        self._recent.itemClicked.connect(self._on_recent)
        right = QVBoxLayout()
        right.addWidget(QLabel(self.tr("Recent surveys")))
        right.addWidget(self._recent, 1)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(40, 30, 40, 30)
        layout.setSpacing(40)
        layout.addLayout(left, 1)
        layout.addLayout(right, 1)

    def _button(self, name: str, text: str, signal: object) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(60)
        button.clicked.connect(signal)
        return button

    def set_recent(self, paths: Sequence[str]) -> None:
        """Show the recent surveys, newest first."""
        self._recent.clear()
        self._recent.setEnabled(bool(paths))
        if not paths:
            self._recent.addItem(self.tr("Nothing has been opened yet."))
        for text in paths:
            path = Path(text)
            item = QListWidgetItem(f"{path.stem}\n{path.parent}")
            item.setData(PATH, text)
            item.setSizeHint(QSize(0, 56))
            item.setToolTip(text)
            self._recent.addItem(item)

    def _on_recent(self, item: QListWidgetItem) -> None:
        path = item.data(PATH)
        if path is not None:
            self.recent_chosen.emit(path)
