"""What the machine says about the selected candidate, and the large buttons for what the operator says."""

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPixmap, QResizeEvent
from PySide6.QtWidgets import (
    QComboBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QMenu,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Decision, LeakClass, Verdict
from widgets.candidate_row import CandidateRow
from widgets.note_field import NoteField
from widgets.plot_theme import Theme, paint_verdict
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import class_text, place_text

BUTTON_HEIGHT = 62
NOTE_HEIGHT = 44
LONGEST_PHRASE = 48  # letters of a note in the list of notes
EVIDENCE_LINES = 2
BESIDE_TEXT = 12  # pixels of a button that are not its word, with the gap to the next
MACHINE = "\N{GEAR}"
MARK = QSize(54, 28)
_DIGITS = {Verdict.CONFIRMED: "1", Verdict.REJECTED: "2", Verdict.UNSURE: "3", Verdict.NONE: "0"}
LEAST_CLASS = 110
_ON_BUTTONS = (Verdict.CONFIRMED, Verdict.REJECTED, Verdict.UNSURE, Verdict.NONE)


class DecisionPanel(QWidget):
    """Verdict, class and note of one candidate. Signals out; it changes nothing itself."""

    verdict_chosen = Signal(object)  # Verdict
    class_chosen = Signal(object)  # LeakClass, or None for the machine's
    note_changed = Signal(int, str)  # candidate id, text
    note_left = Signal()
    phrase_chosen = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._row: CandidateRow | None = None
        self._told_phrases: tuple[str, ...] = ()
        self._title = QLabel()
        self._title.setObjectName("candidate_title")
        self._title.setTextFormat(Qt.TextFormat.PlainText)
        self._evidence = QLabel()
        self._evidence.setObjectName("candidate_evidence")
        self._evidence.setWordWrap(True)
        self._evidence.setTextFormat(Qt.TextFormat.PlainText)
        self._evidence.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._evidence.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._buttons = {verdict: self._button(verdict) for verdict in Verdict}
        self._class = self._class_box()
        self._note = NoteField()
        self._note.setObjectName("note")
        self._note.setPlaceholderText(self.tr("Note (Enter)"))
        self._note.setAccessibleName(self.tr("Note"))
        self._note.setFixedHeight(NOTE_HEIGHT)
        self._note.note_changed.connect(self._on_note)
        self._note.left.connect(self.note_left)
        self._phrases = self._phrase_button()
        self._lay_out()
        self.set_theme(theme)
        self._fit_evidence()
        self.show_row(None, writable=False)

    def _lay_out(self) -> None:
        top = QHBoxLayout()
        top.setSpacing(6)
        top.addWidget(self._title, 3)
        top.addWidget(self._class, 2)
        self._grid = QGridLayout()
        self._grid.setSpacing(4)
        self._columns = 0
        self._arrange(len(self._buttons))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addLayout(top)
        layout.addWidget(self._evidence)
        layout.addLayout(self._grid)
        foot = QHBoxLayout()
        foot.setSpacing(4)
        foot.addWidget(self._note, 1)
        foot.addWidget(self._phrases)
        layout.addLayout(foot)

    def _arrange(self, columns: int) -> None:
        if columns != self._columns:
            self._columns = columns
            for i, verdict in enumerate(_ON_BUTTONS):
                self._grid.addWidget(self._buttons[verdict], i // columns, i % columns)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: where the words do not fit side by side, the buttons stand two by two."""
        super().resizeEvent(event)
        need = max(button.fontMetrics().horizontalAdvance(button.text()) for button in self._buttons.values())
        self._arrange(len(_ON_BUTTONS) if self.width() >= len(_ON_BUTTONS) * (need + BESIDE_TEXT) else 2)

    def _fit_evidence(self) -> None:
        self._evidence.setFixedHeight(EVIDENCE_LINES * self._evidence.fontMetrics().lineSpacing() + 2)

    def changeEvent(self, event: QEvent) -> None:
        """Qt: two lines of evidence are two lines in any font."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit_evidence()

    def _button(self, verdict: Verdict) -> QToolButton:
        text = {
            Verdict.CONFIRMED: self.tr("Confirm"),
            Verdict.REJECTED: self.tr("Reject"),
            Verdict.UNSURE: self.tr("Unsure"),
            Verdict.NONE: self.tr("Clear"),
        }[verdict]
        button = QToolButton()
        button.setText(text)
        button.setToolTip(f"{text} ({_DIGITS[verdict]})")
        button.setAccessibleName(button.toolTip())
        button.setStyleSheet("padding: 2px 0px;")  # the word needs the room that the padding of other buttons takes
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
        button.setObjectName(f"verdict_{verdict.value}")
        button.setMinimumHeight(BUTTON_HEIGHT)
        button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        button.setIconSize(MARK)
        button.setCheckable(verdict is not Verdict.NONE)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its key is the digit; Space belongs to the playback
        button.clicked.connect(lambda _checked=False, v=verdict: self._on_verdict(v))
        return button

    def _phrase_button(self) -> QToolButton:
        button = QToolButton()
        button.setObjectName("note_phrases")
        button.setText("…")
        button.setToolTip(self.tr("Notes used in this survey (Shift+Enter)"))
        button.setAccessibleName(button.toolTip())
        button.setFixedSize(NOTE_HEIGHT, NOTE_HEIGHT)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        button.clicked.connect(self.open_phrases)
        return button

    def set_phrases(self, phrases: Sequence[str]) -> None:
        """Take the notes that may be written again with one choice."""
        self._told_phrases = tuple(phrases)
        self._phrases.setEnabled(bool(phrases) and self._class.isEnabled())

    def open_phrases(self) -> None:
        """Show the notes to choose from, for keyboard, mouse or glove."""
        if not self._phrases.isEnabled():
            return
        menu = QMenu(self)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        for phrase in self._told_phrases:
            line = " ".join(phrase.split())
            shown = line if len(line) <= LONGEST_PHRASE else line[: LONGEST_PHRASE - 1] + "…"
            action = menu.addAction(shown.replace("&", "&&"))
            action.triggered.connect(lambda _checked=False, text=phrase: self.phrase_chosen.emit(text))
        menu.setActiveAction(menu.actions()[0])
        menu.popup(self._phrases.mapToGlobal(QPoint(0, 0)) - QPoint(0, menu.sizeHint().height()))

    def _class_box(self) -> QComboBox:
        box = QuietCombo()
        box.setObjectName("leak_class")
        box.setMinimumHeight(40)
        box.setMinimumWidth(LEAST_CLASS)
        box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        box.setAccessibleName(self.tr("Class"))
        box.setToolTip(self.tr("Class (C); {sign} is what the machine takes it for").format(sign=MACHINE))
        box.addItem("", None)
        for leak_class in LeakClass:
            box.addItem(class_text(leak_class), leak_class)
        box.activated.connect(self._on_class)
        return box

    def set_theme(self, theme: Theme) -> None:
        """Draw the verdicts as this theme does."""
        for verdict, button in self._buttons.items():
            button.setIcon(_numbered(theme, verdict))

    def show_row(self, row: CandidateRow | None, *, writable: bool, evidence: str = "", story: str = "") -> None:
        """Show a candidate, or None; ``evidence`` is what fits two lines, ``story`` all of it, for the tool tip.

        What was typed before is announced.
        """
        if self._row is None or row is None or row.candidate.id != self._row.candidate.id:
            self._note.flush()
        self._row = row
        for widget in (*self._buttons.values(), self._class):
            widget.setEnabled(row is not None and writable)
        self._note.setEnabled(row is not None)
        self._phrases.setEnabled(row is not None and writable and bool(self._told_phrases))
        self._note.setReadOnly(not writable)
        self._evidence.setText(evidence)
        self._evidence.setToolTip(story)
        self._evidence.setAccessibleDescription(story)
        if row is None:
            self._title.setText(self.tr("No candidate selected"))
            self._note.set_note("")
            self._show_decision(Decision())
            return
        self._title.setText(f"{row.name} · {place_text(row.candidate)}")
        machine = class_text(row.candidate.leak_class)
        self._class.setItemText(0, f"{MACHINE} {machine}")
        self._show_decision(row.decision)

    def _show_decision(self, decision: Decision) -> None:
        for verdict, button in self._buttons.items():
            button.setChecked(verdict is not Verdict.NONE and verdict is decision.verdict)
        self._class.setCurrentIndex(max(0, self._class.findData(decision.leak_class)) if decision.leak_class else 0)
        if decision.note != self._note.toPlainText():
            self._note.set_note(decision.note)

    def flush(self) -> None:
        """Announce a note that is still being typed."""
        self._note.flush()

    def focus_note(self) -> None:
        """Put the caret at the end of the note."""
        self._note.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self._note.moveCursor(self._note.textCursor().MoveOperation.End)

    def open_classes(self) -> None:
        """Open the list of classes for the keyboard."""
        self._class.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self._class.showPopup()

    def _on_verdict(self, verdict: Verdict) -> None:
        if self._row is not None:
            self._show_decision(self._row.decision)  # the button shows what is decided, not what was clicked
            self.verdict_chosen.emit(verdict)

    def _on_class(self, index: int) -> None:
        if self._row is not None:
            data = self._class.itemData(index)
            self.class_chosen.emit(None if data is None else LeakClass(data))  # Qt gives a plain string back

    def _on_note(self, text: str) -> None:
        if self._row is not None:
            self.note_changed.emit(self._row.candidate.id, text)


def _numbered(theme: Theme, verdict: Verdict) -> QIcon:
    """Return the mark of a verdict with the digit of its key before it."""
    scale = 2  # crisp on displays with two pixels a point
    pixmap = QPixmap(MARK * scale)
    pixmap.setDevicePixelRatio(scale)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    font = theme.font()
    font.setPixelSize(20)
    font.setBold(True)
    painter.setFont(font)
    painter.setPen(QColor(theme.text))
    painter.drawText(QRectF(0, 0, MARK.width() / 2 - 4, MARK.height()), Qt.AlignmentFlag.AlignCenter, _DIGITS[verdict])
    paint_verdict(painter, theme, verdict, QPointF(MARK.width() * 0.72, MARK.height() / 2), MARK.height() * 0.4)
    painter.end()
    return QIcon(pixmap)
