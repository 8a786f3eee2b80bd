"""What the window shows while nothing is open: record, open a folder, a recent survey, the demonstration, and help."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent, QShowEvent
from PySide6.QtWidgets import QBoxLayout, QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from widgets.recent_surveys import RecentRow, RecentSurveys

NARROW = 760  # pixels: two columns would have no room for their words
LIST_HEIGHT = 320  # pixels of the list below the buttons


class StartPage(QWidget):
    """Signals out; it opens nothing itself."""

    open_asked = Signal()
    record_asked = Signal()
    demo_asked = Signal()
    correlator_asked = Signal()
    settings_asked = Signal()
    manual_asked = Signal()
    tour_asked = Signal()
    recent_chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        title = QLabel("Leakline")
        title.setStyleSheet("font-size: 30pt; font-weight: bold")
        claim = QLabel(self.tr("From the folder off the device to a leak on the map, the same day."))
        claim.setWordWrap(True)
        self._record = self._button("start_record", self.tr("●  Record"), self.record_asked)
        self._record.setMinimumHeight(70)
        self._open = self._button("start_open", self.tr("Open the device's folder…"), self.open_asked)
        self._demo = self._button("start_demo", self.tr("Look at the demonstration"), self.demo_asked)
        others = QGridLayout()
        others.setSpacing(6)
        small = (
            ("start_correlator", self.tr("Correlator"), self.correlator_asked),
            ("start_settings", self.tr("Settings"), self.settings_asked),
            ("start_manual", self.tr("Manual"), self.manual_asked),
            ("start_tour", self.tr("Five hints"), self.tour_asked),
        )
        for number, (name, text, signal) in enumerate(small):
            others.addWidget(self._button(name, text, signal, height=48), number // 2, number % 2)
        drop = QLabel(self.tr("or drop a folder anywhere on this window"))
        drop.setAlignment(Qt.AlignmentFlag.AlignCenter)
        drop.setFrameShape(QFrame.Shape.StyledPanel)
        drop.setMinimumHeight(60)
        drop.setWordWrap(True)
        left = QVBoxLayout()
        for widget in (title, claim, self._record, self._open, self._demo):
            left.addWidget(widget)
        left.addLayout(others)
        left.addWidget(drop)
        left.addStretch(1)
        self.recent = RecentSurveys()
        self.recent.setObjectName("recent")
        self.recent.setAccessibleName(self.tr("Recent surveys"))
        self.recent.chosen.connect(self.recent_chosen)
        heading = QLabel(self.tr("Recent surveys"))
        heading.setStyleSheet("font-weight: bold")
        right = QVBoxLayout()
        right.addWidget(heading)
        right.addWidget(self.recent, 1)
        self._claim = claim
        self._columns = QHBoxLayout(self)
        self._columns.setContentsMargins(28, 20, 28, 20)
        self._columns.setSpacing(28)
        self._columns.addLayout(left, 2)
        self._columns.addLayout(right, 3)

    def _button(self, name: str, text: str, signal: object, *, height: int = 56) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(height)
        button.clicked.connect(signal)
        return button

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: in a narrow window the list stands below the buttons."""
        super().resizeEvent(event)
        narrow = event.size().width() < NARROW
        self._columns.setDirection(QBoxLayout.Direction.TopToBottom if narrow else QBoxLayout.Direction.LeftToRight)
        self._claim.setVisible(not narrow)
        self.recent.setMinimumHeight(LIST_HEIGHT if narrow else 0)

    def showEvent(self, event: QShowEvent) -> None:
        """Qt: the keyboard begins at the newest survey, else at opening one."""
        super().showEvent(event)
        rows = self.recent.shown
        (rows[0].button if rows else self._open).setFocus()

    def set_recent(self, rows: Sequence[RecentRow]) -> None:
        """Show the recent surveys, as they come."""
        self.recent.set_rows(rows)
