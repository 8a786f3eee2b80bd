"""Asks who reviews a second time, and says what that means."""

from collections.abc import Sequence

from PySide6.QtCore import QStringListModel
from PySide6.QtWidgets import (
    QCompleter,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

HEIGHT = 44


class ReviewerDialog(QDialog):
    """``name`` is what was typed; the first reviewer cannot be the second as well."""

    def __init__(self, first: str, proposed: str, known: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._first = " ".join(first.split()).casefold()
        self.setWindowTitle(self.tr("Second reviewer"))
        about = QLabel(
            self.tr(
                "A second person judges all candidates without seeing what the first one said. Their verdicts are kept "
                "beside the first ones, which stay as they are. Afterwards both are compared."
            )
        )
        about.setWordWrap(True)
        about.setMinimumWidth(420)
        self._name = QLineEdit(proposed)
        self._name.setObjectName("reviewer_name")
        self._name.setMaxLength(80)
        self._name.setMinimumHeight(HEIGHT)
        self._name.setPlaceholderText(self.tr("Name of the second reviewer"))
        self._name.setAccessibleName(self.tr("Name of the second reviewer"))
        completer = QCompleter(self)
        completer.setModel(QStringListModel(list(known), completer))
        self._name.setCompleter(completer)
        self._name.selectAll()
        self._why = QLabel()
        self._why.setWordWrap(True)
        buttons = QDialogButtonBox()
        self._go = QPushButton(self.tr("Review blind"))
        cancel = QPushButton(self.tr("Cancel"))
        for button in (self._go, cancel):
            button.setMinimumHeight(HEIGHT)
        buttons.addButton(self._go, QDialogButtonBox.ButtonRole.AcceptRole)
        buttons.addButton(cancel, QDialogButtonBox.ButtonRole.RejectRole)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        for widget in (about, self._name, self._why, buttons):
            layout.addWidget(widget)
        self._name.textChanged.connect(self._check)
        self._check()

    @property
    def name(self) -> str:
        """What was typed, in one line."""
        return " ".join(self._name.text().split())

    def _check(self) -> None:
        same = bool(self.name) and self.name.casefold() == self._first
        self._why.setText(self.tr("This is the first reviewer. The second has to be somebody else.") if same else "")
        self._go.setEnabled(bool(self.name) and not same)
