"""Words and marks of a recording that several widgets share: states as shape + letter + word, times, amounts."""

from dataclasses import dataclass

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QLocale, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from processing.live.stream import LinkState
from processing.survey import Verdict
from widgets.plot_theme import Theme

_STATES: dict[LinkState, str] = {
    LinkState.OFF: str(QT_TRANSLATE_NOOP("RecordingWords", "not chosen")),
    LinkState.WAITING: str(QT_TRANSLATE_NOOP("RecordingWords", "waiting for it")),
    LinkState.LIVE: str(QT_TRANSLATE_NOOP("RecordingWords", "alive")),
    LinkState.SILENT: str(QT_TRANSLATE_NOOP("RecordingWords", "no signal")),
    LinkState.LOST: str(QT_TRANSLATE_NOOP("RecordingWords", "input lost")),
    LinkState.ENDED: str(QT_TRANSLATE_NOOP("RecordingWords", "closed")),
}
# a letter for those who see neither colour nor shape well: it must not need translating
STATE_SIGNS: dict[LinkState, str] = {
    LinkState.OFF: "–",
    LinkState.WAITING: "?",
    LinkState.LIVE: "✓",
    LinkState.SILENT: "0",
    LinkState.LOST: "!",
    LinkState.ENDED: "■",
}


@dataclass(frozen=True)
class Mark:
    """How a state is drawn: ``shape`` is ``circle``, ``ring``, ``triangle``, ``square`` or ``diamond``."""

    shape: str
    colour: str


def state_text(state: LinkState) -> str:
    """Return the state of a device in words of the window's language."""
    return QCoreApplication.translate("RecordingWords", _STATES[state])


def state_mark(state: LinkState, theme: Theme) -> Mark:
    """Return shape and colour of a state; no two states that matter share a shape."""
    good, bad = theme.verdicts[Verdict.CONFIRMED], theme.cursor
    unsure, faint = theme.verdicts[Verdict.UNSURE], theme.verdicts[Verdict.REJECTED]
    return {
        LinkState.OFF: Mark("ring", faint),
        LinkState.WAITING: Mark("triangle", unsure),
        LinkState.LIVE: Mark("circle", good),
        LinkState.SILENT: Mark("square", unsure),
        LinkState.LOST: Mark("diamond", bad),
        LinkState.ENDED: Mark("ring", faint),
    }[state]


def paint_mark(painter: QPainter, mark: Mark, sign: str, box: QRectF, theme: Theme) -> None:
    """Draw a state's shape with its letter into a square box."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    colour = QColor(mark.colour)
    hollow = mark.shape == "ring"
    painter.setPen(QPen(colour, 2.5))
    painter.setBrush(Qt.BrushStyle.NoBrush if hollow else colour)
    box = box.adjusted(2, 2, -2, -2)
    x, y, r = box.center().x(), box.center().y(), box.width() / 2
    if mark.shape == "triangle":
        painter.drawPolygon(QPolygonF([QPointF(x, y - r), QPointF(x + r, y + r), QPointF(x - r, y + r)]))
    elif mark.shape == "diamond":
        painter.drawPolygon(QPolygonF([QPointF(x, y - r), QPointF(x + r, y), QPointF(x, y + r), QPointF(x - r, y)]))
    elif mark.shape == "square":
        painter.drawRect(box.adjusted(1, 1, -1, -1))
    else:
        painter.drawEllipse(box)
    font = theme.font()
    font.setBold(True)
    painter.setFont(font)
    painter.setPen(colour if hollow else QColor(theme.canvas))
    lower = 0.25 * r if mark.shape == "triangle" else 0.0
    painter.drawText(box.translated(0.0, lower), Qt.AlignmentFlag.AlignCenter, sign)
    painter.restore()


def paint_hint(painter: QPainter, text: str, within: QRectF, theme: Theme) -> None:
    """Write over the middle of a picture why nothing is seen in it, in a box that stands out on any ground."""
    painter.setFont(theme.font())
    metrics = theme.metrics()
    flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    most = QRectF(0.0, 0.0, 0.85 * within.width(), within.height())
    line = metrics.height()
    box = metrics.boundingRect(most, flags, text).adjusted(-line, -0.4 * line, line, 0.4 * line)
    box.moveCenter(within.center())
    painter.setPen(QPen(QColor(theme.text), 2))
    painter.setBrush(QColor(theme.canvas))
    painter.drawRect(box)
    painter.drawText(box, flags, text)


def clock_text(seconds: float) -> str:
    """Return a duration as h:mm:ss."""
    whole = max(0, int(seconds))
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def count_text(number: int) -> str:
    """Return a count as the window writes it."""
    return QLocale().toString(number)


def rate_text(rate_hz: float) -> str:
    """Return a sample rate: ``48 kHz``, ``44.1 kHz``, ``400 Hz``."""
    locale = QLocale()
    if rate_hz >= 1000.0:
        kilo = round(rate_hz / 1000.0, 2)
        return locale.toString(kilo, "f", 0 if kilo == int(kilo) else len(f"{kilo:g}".partition(".")[2])) + " kHz"
    return locale.toString(round(rate_hz)) + " Hz"
