"""Asks below which score undecided candidates shall be rejected at once, and says beforehand which those are."""

from collections import Counter
from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Verdict
from widgets.candidate_row import CandidateRow
from widgets.units import quantities
from widgets.vocabulary import class_text, number

HEIGHT = 44
STEPS = 100
FIRST_SCORE = 0.2
MOST_NAMED = 12


def rejected_below(rows: Sequence[CandidateRow], score: float) -> list[CandidateRow]:
    """Return the undecided rows below a score; marks made by hand have none and are never among them."""
    return [row for row in rows if row.decision.verdict is Verdict.NONE and row.candidate.score < score]


class BatchReject(QDialog):
    """Stays open beside the list, which goes on working; one press on *Reject* announces once."""

    reject_asked = Signal(float)  # score

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Reject below a score"))
        self.setModal(False)
        self._rows: tuple[CandidateRow, ...] = ()
        self._slider = QSlider(Qt.Orientation.Horizontal)
        self._slider.setRange(0, STEPS)
        self._slider.setMinimumHeight(HEIGHT)
        self._slider.setAccessibleName(self.tr("Score"))
        self._box = QDoubleSpinBox()
        self._box.setObjectName("batch_score")
        self._box.setRange(0.0, 1.0)
        self._box.setSingleStep(0.05)
        self._box.setMinimumHeight(HEIGHT)
        self._box.setAccessibleName(self.tr("Score"))
        self._slider.valueChanged.connect(lambda value: self._box.setValue(value / STEPS))
        self._box.valueChanged.connect(self._on_score)
        self._told = QLabel()
        self._told.setObjectName("batch_told")
        self._told.setWordWrap(True)
        self._told.setTextFormat(Qt.TextFormat.PlainText)
        self._told.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._told.setMinimumHeight(9 * self._told.fontMetrics().lineSpacing())
        buttons = QDialogButtonBox()
        self._reject = QPushButton()
        self._reject.setObjectName("batch_reject")
        close = QPushButton(self.tr("Close"))
        for button, role in (
            (self._reject, QDialogButtonBox.ButtonRole.ActionRole),
            (close, QDialogButtonBox.ButtonRole.RejectRole),
        ):
            button.setMinimumHeight(HEIGHT)
            buttons.addButton(button, role)
        self._reject.setMinimumWidth(160)
        self._reject.clicked.connect(lambda: self.reject_asked.emit(self.score))
        close.clicked.connect(self.reject)
        score = QHBoxLayout()
        asked = QLabel(self.tr("Reject what is undecided with a score below"))
        asked.setWordWrap(True)
        score.addWidget(asked, 1)
        score.addWidget(self._box)
        layout = QVBoxLayout(self)
        layout.addLayout(score)
        layout.addWidget(self._slider)
        layout.addWidget(self._told, 1)
        layout.addWidget(buttons)
        self.setMinimumWidth(520)
        self._box.setValue(FIRST_SCORE)
        self._box.setFocus(Qt.FocusReason.PopupFocusReason)

    @property
    def score(self) -> float:
        """The score below which is rejected."""
        return round(self._box.value(), 2)

    def set_rows(self, rows: Sequence[CandidateRow]) -> None:
        """Take the candidates that the list shows now."""
        self._rows = tuple(rows)
        self._show()

    def _on_score(self, value: float) -> None:
        self._slider.setValue(round(STEPS * value))
        self._show()

    def _show(self) -> None:
        found = rejected_below(self._rows, self.score)
        self._reject.setText(self.tr("Reject {count}").format(count=len(found)))
        self._reject.setEnabled(bool(found))
        self._told.setText(self._sentence(found))

    def _sentence(self, found: Sequence[CandidateRow]) -> str:
        undecided = sum(row.decision.verdict is Verdict.NONE for row in self._rows)
        lines = [
            self.tr("{count} of {all} undecided candidates in the list are below {score}.").format(
                count=len(found), all=undecided, score=number(self.score, 2)
            )
        ]
        if found:
            kinds = Counter(row.kind for row in found)
            lines.append(", ".join(f"{count} × {class_text(kind)}" for kind, count in kinds.most_common()))
            write = quantities()
            named = sorted(found, key=lambda row: row.candidate.chainage_m)[:MOST_NAMED]
            places = ", ".join(f"{row.name} ({write.place(row.candidate.chainage_m)})" for row in named)
            more = len(found) - len(named)
            lines.append(places + (self.tr(" and {count} more").format(count=more) if more else ""))
        lines.append(self.tr("Decided ones and marks made by hand stay as they are. One undo takes it all back."))
        return "\n".join(lines)
