"""The list of recent surveys as large rows: name, day, pipe, how far the review is, and a small picture of the path."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPalette, QPen, QPolygonF, QResizeEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from widgets.folding import has_all_words
from widgets.painted_widget import PaintedWidget
from widgets.units import quantities

MANY = 5  # rows: with more of them there is a field to search in
OUTLINE = QSize(84, 62)
BUTTON = 44
NARROW = 380  # pixels of a row
BETWEEN = "\N{NO-BREAK SPACE}\N{MIDDLE DOT}  "  # a line does not begin with the dot


class Presence(StrEnum):
    """Whether a survey's folder is where it was."""

    ASKED = "asked"  # not known yet: its disc may take a while to answer
    THERE = "there"
    MISSING = "missing"


@dataclass(frozen=True)
class RecentRow:
    """What was last known of a survey; ``outline`` is its path seen from above, (n, 2) in metres, coarse."""

    path: str
    name: str
    folder: str
    date: str = ""  # ISO day
    client: str = ""
    pipe: str = ""
    length_m: float | None = None
    candidates: int | None = None  # None: it was never processed, or nobody knows
    decided: int = 0
    confirmed: int = 0
    exported: str | None = None  # ISO day
    simulated: bool = False
    outline: tuple[tuple[float, float], ...] = ()
    pinned: bool = False
    presence: Presence = Presence.ASKED


class PathOutline(PaintedWidget):
    """The path as a thin line, north up, with a dot where it began."""

    def __init__(self, points: Sequence[tuple[float, float]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._points = tuple(points)
        self.setFixedSize(OUTLINE)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def _paint(self, painter: QPainter) -> None:
        if len(self._points) < 2:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        east, north = [p[0] for p in self._points], [p[1] for p in self._points]
        room = QRectF(self.rect()).adjusted(6, 6, -6, -6)
        width, height = max(east) - min(east), max(north) - min(north)
        scale = min(room.width() / max(width, 1e-6), room.height() / max(height, 1e-6))
        middle_e, middle_n = (max(east) + min(east)) / 2, (max(north) + min(north)) / 2
        line = [
            QPointF(room.center().x() + (e - middle_e) * scale, room.center().y() - (n - middle_n) * scale)
            for e, n in self._points
        ]
        colour = self.palette().color(QPalette.ColorRole.Highlight)
        painter.setPen(QPen(colour, 2.5, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap, Qt.PenJoinStyle.RoundJoin))
        painter.drawPolyline(QPolygonF(line))
        painter.setBrush(QColor(colour))
        painter.drawEllipse(line[0], 4.0, 4.0)


class _RowButton(QPushButton):
    """The part of a row that opens the survey; arrow keys go from row to row."""

    stepped = Signal(int)
    removed = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: up and down step, Delete takes off the list, Enter opens."""
        steps = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: +1}
        key = Qt.Key(event.key())
        if key in steps:
            self.stepped.emit(steps[key])
        elif key == Qt.Key.Key_Delete:
            self.removed.emit()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.click()
        else:
            super().keyPressEvent(event)


class RecentSurveyRow(QFrame):
    """One survey: the large button, the pin, and the button that takes it off the list."""

    chosen = Signal()
    pin_asked = Signal()
    removal_asked = Signal()
    stepped = Signal(int)

    def __init__(self, row: RecentRow, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.row = row
        self._outline: PathOutline | None = None
        self.button = _RowButton()
        self.button.setObjectName("recent_survey")
        self.button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.button.setMinimumHeight(OUTLINE.height() + 12)
        self.button.setAccessibleName(". ".join(line for line in self.lines() if line))
        self.button.setToolTip(row.path)
        self.button.clicked.connect(self.chosen)
        self.button.stepped.connect(self.stepped)
        self.button.removed.connect(self.removal_asked)
        words = QVBoxLayout()
        words.setSpacing(1)
        for number, text in enumerate(self.lines()):
            label = QLabel(text)
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            label.setWordWrap(True)
            if number == 0:
                label.setStyleSheet("font-weight: bold; font-size: 13pt")
            label.setVisible(bool(text))
            words.addWidget(label)
        inside = QHBoxLayout(self.button)
        inside.setContentsMargins(10, 6, 8, 6)
        inside.addLayout(words, 1)
        if row.outline:
            self._outline = PathOutline(row.outline)
            inside.addWidget(self._outline)
        pin = self._tool("★" if row.pinned else "☆", "recent_pin")
        pin.setToolTip(self.tr("Let go") if row.pinned else self.tr("Keep on top"))
        pin.setAccessibleName(f"{pin.toolTip()}: {row.name}")
        pin.clicked.connect(self.pin_asked)
        off = self._tool("×", "recent_remove")
        off.setToolTip(self.tr("Take off the list; the survey itself stays (Delete)"))
        off.setAccessibleName(f"{off.toolTip()}: {row.name}")
        off.clicked.connect(self.removal_asked)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.button, 1)
        layout.addWidget(pin)
        layout.addWidget(off)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: without room the words go before the picture."""
        super().resizeEvent(event)
        if self._outline is not None:
            self._outline.setVisible(event.size().width() >= NARROW)

    def _tool(self, text: str, name: str) -> QToolButton:
        button = QToolButton()
        button.setText(text)
        button.setObjectName(name)
        button.setMinimumSize(BUTTON, BUTTON)
        button.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def lines(self) -> tuple[str, str, str]:
        """Return the three lines: name and day; whose pipe; how far the review is, or why it cannot be opened."""
        row, write = self.row, quantities()
        name = f"{row.name}{BETWEEN}{write.day(row.date)}" if row.date else row.name
        facts = [row.client, row.pipe, "" if row.length_m is None else write.length(row.length_m, 0)]
        if row.simulated:
            facts.insert(0, self.tr("Demonstration"))
        where = BETWEEN.join(fact for fact in facts if fact) or row.folder
        return name, where, self._state()

    def _state(self) -> str:
        row = self.row
        if row.presence is Presence.MISSING:
            text = self.tr("Not there now: {folder}. Plug the stick in, or take it off the list.")
            return text.format(folder=row.folder)
        if row.candidates is None:
            return self.tr("Not processed yet")
        parts = [self.tr("{done} of {count} decided").format(done=row.decided, count=row.candidates)]
        if row.confirmed:
            parts.append(self.tr("{count} confirmed").format(count=row.confirmed))
        if row.exported:
            parts.append(self.tr("exported on {day}").format(day=quantities().day(row.exported)))
        return BETWEEN.join(parts)


class RecentSurveys(QWidget):
    """Signals out; it opens and forgets nothing itself."""

    chosen = Signal(str)
    pin_asked = Signal(str)
    removal_asked = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._rows: tuple[RecentRow, ...] = ()
        self._shown: list[RecentSurveyRow] = []
        self._search = QLineEdit()
        self._search.setObjectName("recent_search")
        self._search.setMinimumHeight(44)
        self._search.setClearButtonEnabled(True)
        self._search.setPlaceholderText(self.tr("Search by name, client, folder or year"))
        self._search.setAccessibleName(self._search.placeholderText())
        self._search.textChanged.connect(self._filter)
        self._nothing = QLabel()
        self._nothing.setWordWrap(True)
        self._nothing.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._scroll = QScrollArea()
        self._scroll.setWidgetResizable(True)
        self._scroll.setFrameShape(QFrame.Shape.NoFrame)
        self._scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._search)
        layout.addWidget(self._nothing)
        layout.addWidget(self._scroll, 1)
        self.set_rows(())

    @property
    def shown(self) -> tuple[RecentSurveyRow, ...]:
        """The rows that the search leaves, from the top."""
        return tuple(row for row in self._shown if not row.isHidden())

    def set_rows(self, rows: Sequence[RecentRow]) -> None:
        """Show these surveys, keeping the keyboard and the place in the list where they were."""
        if tuple(rows) == self._rows and self._scroll.widget() is not None:
            return
        held = next((row.row.path for row in self._shown if row.button.hasFocus()), None)
        at = self._scroll.verticalScrollBar().value()
        self._rows = tuple(rows)
        content = QWidget()
        stack = QVBoxLayout(content)
        stack.setContentsMargins(0, 0, 4, 0)
        stack.setSpacing(6)
        self._shown = [self._made(row) for row in rows]
        for shown in self._shown:
            stack.addWidget(shown)
        stack.addStretch(1)
        old = self._scroll.takeWidget()
        self._scroll.setWidget(content)
        if old is not None:
            old.deleteLater()
        self._search.setVisible(len(rows) > MANY)
        self._filter()
        self._scroll.verticalScrollBar().setValue(at)
        for shown in self._shown:
            if shown.row.path == held:
                shown.button.setFocus()

    def _made(self, row: RecentRow) -> RecentSurveyRow:
        shown = RecentSurveyRow(row)
        shown.chosen.connect(lambda: self.chosen.emit(row.path))
        shown.pin_asked.connect(lambda: self.pin_asked.emit(row.path))
        shown.removal_asked.connect(lambda: self.removal_asked.emit(row.path))
        shown.stepped.connect(lambda step: self._step(shown, step))
        return shown

    def _step(self, origin: RecentSurveyRow, step: int) -> None:
        rows = self.shown
        at = min(max(rows.index(origin) + step, 0), len(rows) - 1)
        rows[at].button.setFocus()
        self._scroll.ensureWidgetVisible(rows[at])

    def _filter(self) -> None:
        query = self._search.text() if len(self._rows) > MANY else ""
        for shown in self._shown:
            row = shown.row
            shown.setVisible(has_all_words(query, f"{row.name} {row.client} {row.folder} {row.date} {row.pipe}"))
        nothing = self.tr("Nothing has been opened yet. Open a device's folder, or look at the demonstration.")
        if self._rows:
            nothing = self.tr("No survey in the list has these words. Search for fewer of them.")
        self._nothing.setText(nothing)
        self._nothing.setVisible(not self.shown)
