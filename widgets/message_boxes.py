"""Every message that interrupts the operator: one sentence, what to do, and buttons that say what they do."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QMessageBox, QPushButton, QWidget

from processing import messages
from processing.errors import LeaklineError
from widgets.units import quantities


@dataclass(frozen=True)
class Choice:
    """A button: ``key`` is returned when it is pressed."""

    key: str
    text: str


class MessageBoxes:
    """Shows boxes over ``parent``; tests hand in another one that answers by itself."""

    def __init__(self, parent: QWidget, language: str) -> None:
        self._parent = parent
        self.language = language

    def error(self, error: LeaklineError) -> None:
        """Tell what the user can mend."""
        self.tell(messages.error_sentence(error, self.language, quantities().units))

    def tell(self, text: str) -> None:
        """Tell something that needs a look before going on."""
        self.ask(text, (Choice("ok", QCoreApplication.translate("MessageBoxes", "OK")),))

    def ask(self, text: str, choices: Sequence[Choice]) -> str:
        """Ask; returns the key of the chosen button, the last one's for Escape and the closing cross."""
        text = text.replace(messages.THEN, f"\n\n{messages.THEN.strip()} ")  # what to do stands by itself
        box = QMessageBox(QMessageBox.Icon.NoIcon, "Leakline", text, QMessageBox.StandardButton.NoButton, self._parent)
        buttons: dict[QPushButton, str] = {}
        for choice in choices:
            button = box.addButton(choice.text, QMessageBox.ButtonRole.AcceptRole)
            button.setMinimumHeight(44)
            button.setMinimumWidth(96)
            buttons[button] = choice.key
        first, *_, last = [*buttons, *buttons]
        box.setDefaultButton(first)
        box.setEscapeButton(last)
        box.exec()
        return next((key for button, key in buttons.items() if button is box.clickedButton()), choices[-1].key)
