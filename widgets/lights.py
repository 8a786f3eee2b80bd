"""The lights of the step bar: a shape, a sign and a colour each, so that none alone carries the meaning."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QIcon, QPainter, QPixmap

from processing.readiness import Light
from processing.survey import Verdict
from widgets.plot_theme import Theme
from widgets.recording_words import Mark, paint_mark

# signs that need no translating
LIGHT_SIGNS: dict[Light, str] = {Light.GREEN: "✓", Light.YELLOW: "!", Light.RED: "×", Light.GREY: "–"}
_SCALE = 2  # crisp on displays with two pixels a point


def light_mark(light: Light, theme: Theme) -> Mark:
    """Return shape and colour of a light; no two share a shape."""
    return {
        Light.GREEN: Mark("circle", theme.verdicts[Verdict.CONFIRMED]),
        Light.YELLOW: Mark("triangle", theme.verdicts[Verdict.UNSURE]),
        Light.RED: Mark("diamond", theme.cursor),
        Light.GREY: Mark("ring", theme.verdicts[Verdict.REJECTED]),
    }[light]


def light_icon(light: Light, theme: Theme, size: int) -> QIcon:
    """Return the light as an icon of ``size`` pixels."""
    pixmap = QPixmap(size * _SCALE, size * _SCALE)
    pixmap.setDevicePixelRatio(_SCALE)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    paint_mark(painter, light_mark(light, theme), LIGHT_SIGNS[light], QRectF(0, 0, size, size), theme)
    painter.end()
    icon = QIcon(pixmap)
    icon.addPixmap(pixmap, QIcon.Mode.Disabled)  # a step that cannot be opened yet says all the more why
    return icon
