"""Remembers where the window and its splitters stood, in the preferences."""

import base64
import binascii

from PySide6.QtCore import QByteArray
from PySide6.QtWidgets import QMainWindow

from app.review_page import ReviewPage
from app.settings import PreferencesStore

LARGEST, FRAME = (1920, 1080), 32  # of the first start: the whole of a laptop's screen, less the title bar


class WindowMemory:
    """Puts a window back where it was; what cannot be understood is as if it had not been remembered."""

    def __init__(self, window: QMainWindow, page: ReviewPage, preferences: PreferencesStore) -> None:
        self._window, self._page, self._preferences = window, page, preferences
        page.layout_changed.connect(self.restore_splitters)
        for splitter in page.splitters.values():
            splitter.splitterMoved.connect(self.note_splitters)

    def restore(self) -> None:
        """Give the window its size and place."""
        if not self._window.restoreGeometry(_bytes(self._preferences.values.geometry)):
            room = self._window.screen().availableGeometry()
            self._window.resize(min(room.width(), LARGEST[0]), min(room.height() - FRAME, LARGEST[1]))

    def restore_splitters(self) -> None:
        """Give the splitters of the present arrangement their places."""
        for name, splitter in self._page.splitters.items():
            state = self._preferences.values.splitters.get(name)
            if state:
                splitter.restoreState(_bytes(state))

    def note_splitters(self) -> None:
        """Note where the splitters stand; written with the geometry, at closing."""
        for name, splitter in self._page.splitters.items():
            self._preferences.values.splitters[name] = _text(splitter.saveState())

    def save(self) -> None:
        """Write everything down."""
        splitters = dict(self._preferences.values.splitters)
        self._preferences.change(geometry=_text(self._window.saveGeometry()), splitters=splitters)


def _text(data: QByteArray) -> str:
    return base64.b64encode(data.data()).decode()


def _bytes(text: str) -> QByteArray:
    try:
        return QByteArray(base64.b64decode(text, validate=True))
    except (binascii.Error, ValueError):
        return QByteArray()
