"""What mouse, fingers and wheel do, as rows beside the keys: the key sheet and the manual come from this table."""

from dataclasses import dataclass

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

N = QT_TRANSLATE_NOOP


@dataclass(frozen=True)
class Gesture:
    """A movement and what it does."""

    how: str
    what: str


def _row(how: object, what: object) -> Gesture:
    return Gesture(str(how), str(what))


TITLE = str(N("Gestures", "Mouse and fingers"))
GESTURES: tuple[Gesture, ...] = (
    _row(N("Gestures", "Click in a view"), N("Gestures", "Put the cursor there; all views follow")),
    _row(N("Gestures", "Double click"), N("Gestures", "Go there, close enough to see it")),
    _row(N("Gestures", "Drag"), N("Gestures", "Move what is shown")),
    _row(N("Gestures", "Wheel, or two fingers apart"), N("Gestures", "Closer or wider, around the pointer")),
    _row(N("Gestures", "Shift and drag in the spectrogram"), N("Gestures", "Select a stretch and a band")),
    _row(N("Gestures", "Click on a candidate's mark"), N("Gestures", "Select that candidate")),
    _row(N("Gestures", "Drag a tie point"), N("Gestures", "Move it; the path follows at once")),
    _row(N("Gestures", "Drag a border between views"), N("Gestures", "Give one more room; it is remembered")),
    _row(N("Gestures", "Press a light"), N("Gestures", "Say what that step lacks, and lead there")),
    _row(N("Gestures", "Drop a folder or a map on the window"), N("Gestures", "Open the folder, or import the route")),
)


def translated(text: str) -> str:
    """Return a text of the table in the window's language."""
    return QCoreApplication.translate("Gestures", text)
