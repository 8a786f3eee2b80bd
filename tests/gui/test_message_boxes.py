"""A box says one sentence, its buttons say what they do, and Escape is the last of them."""

from pathlib import Path

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox, QPushButton, QWidget

from processing.errors import ErrorCode, LeaklineError, Place
from widgets.message_boxes import Choice, MessageBoxes

CHOICES = (Choice("restore", "Restore"), Choice("look", "Only look"), Choice("cancel", "Cancel"))


@pytest.fixture
def boxes(qtbot):
    parent = QWidget()
    qtbot.addWidget(parent)
    return MessageBoxes(parent, "tr")


def answer(action):
    """Do something with the box as soon as it is there; returns the texts that it showed."""
    seen = []

    def act():
        box = QApplication.activeModalWidget()
        assert isinstance(box, QMessageBox)
        seen.append(box.text())
        action(box)

    QTimer.singleShot(50, act)
    return seen


def press(text):
    def click(box):
        button = next(b for b in box.findChildren(QPushButton) if b.text() == text)
        assert button.minimumHeight() >= 40
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    return click


@pytest.mark.parametrize("choice", CHOICES)
def test_the_key_of_the_pressed_button_comes_back(boxes, choice):
    answer(press(choice.text))
    assert boxes.ask("What now?", CHOICES) == choice.key


def test_escape_is_the_last_choice_and_enter_the_first(boxes):
    answer(lambda box: QTest.keyClick(box, Qt.Key.Key_Escape))
    assert boxes.ask("What now?", CHOICES) == "cancel"
    answer(lambda box: QTest.keyClick(box, Qt.Key.Key_Return))
    assert boxes.ask("What now?", CHOICES) == "restore"


def test_an_error_is_said_in_the_windows_language_with_its_place(boxes):
    seen = answer(lambda box: QTest.keyClick(box, Qt.Key.Key_Return))
    boxes.error(LeaklineError(ErrorCode.FILE_EMPTY, Place(Path("imu.csv"), line=3)))
    assert seen[0].startswith("imu.csv, satır 3: ")
