"""How plots look: colours, line widths and letters of the three themes, and the mark of each verdict.

Colours are told apart by the colour-blind (after Okabe and Ito 2008), and no meaning rests on colour alone: each
verdict has its own shape and sign, and what is not assessed is hatched.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontMetricsF, QGuiApplication, QPainter, QPen, QPixmap, QPolygonF

from processing.survey import Verdict


@dataclass(frozen=True)
class Theme:
    """Colours as ``#rrggbb``, widths in pixels; ``font_scale`` multiplies the size of the application's letters."""

    name: str
    background: str
    canvas: str
    text: str
    grid: str
    cursor: str
    curve: str
    curve_second: str
    curve_third: str
    band: str
    accent: str
    not_assessed: str
    route: str
    tie_point: str
    outline: str
    line_width: float = 1.5
    font_scale: float = 1.0
    verdicts: Mapping[Verdict, str] = field(default_factory=dict)

    def scaled(self, font_scale: float) -> "Theme":
        """Return this theme with larger or smaller letters."""
        return replace(self, font_scale=font_scale)

    def font(self) -> QFont:
        """Return a font of plots to keep; the first call fixes it: make a new theme when the application's changes."""
        return QFont(self._font)

    def metrics(self) -> QFontMetricsF:
        """Return the metrics of :meth:`font`."""
        return self._metrics

    @cached_property
    def _font(self) -> QFont:
        font = QFont(QGuiApplication.font())
        size = font.pointSizeF() if font.pointSizeF() > 0 else 9.0
        font.setPointSizeF(size * self.font_scale)
        font.setBold(self.name == "sun")
        return font

    @cached_property
    def _metrics(self) -> QFontMetricsF:
        return QFontMetricsF(self._font)

    def verdict_colour(self, verdict: Verdict) -> QColor:
        """Return the colour of a verdict."""
        return QColor(self.verdicts[verdict])


LIGHT = Theme(
    name="light",
    background="#f6f7f9",
    canvas="#ffffff",
    text="#1d2733",
    grid="#e1e5ea",
    cursor="#c3124b",
    curve="#0072b2",
    curve_second="#b84f00",
    curve_third="#007a5a",
    band="#7fb8d8",
    accent="#0072b2",
    not_assessed="#8a6d3b",
    route="#8793a0",
    tie_point="#1d2733",
    outline="#ffffff",
    verdicts={
        Verdict.NONE: "#0072b2",
        Verdict.CONFIRMED: "#00805c",
        Verdict.REJECTED: "#6b7480",
        Verdict.UNSURE: "#d07b00",
    },
)
DARK = replace(
    LIGHT,
    name="dark",
    background="#1b2027",
    canvas="#12161b",
    text="#e6e9ed",
    grid="#2c343d",
    cursor="#ff5c8a",
    curve="#56b4e9",
    curve_second="#f0a04b",
    curve_third="#3fd0a4",
    band="#2f6d94",
    accent="#56b4e9",
    not_assessed="#c9a869",
    route="#8793a0",
    tie_point="#e6e9ed",
    outline="#12161b",
    verdicts={
        Verdict.NONE: "#56b4e9",
        Verdict.CONFIRMED: "#2ed3a2",
        Verdict.REJECTED: "#98a2ad",
        Verdict.UNSURE: "#f0b03f",
    },
)
SUN = replace(
    LIGHT,
    name="sun",
    background="#ffffff",
    canvas="#ffffff",
    text="#000000",
    grid="#b8b8b8",
    cursor="#b00000",
    curve="#000000",
    curve_second="#8f3000",
    curve_third="#004d99",
    band="#9dc3dd",
    accent="#003a8c",
    not_assessed="#000000",
    route="#555555",
    tie_point="#000000",
    outline="#ffffff",
    line_width=3.0,
    font_scale=1.2,
    verdicts={
        Verdict.NONE: "#003a8c",
        Verdict.CONFIRMED: "#005c3c",
        Verdict.REJECTED: "#3a3a3a",
        Verdict.UNSURE: "#a34700",
    },
)
THEMES: Mapping[str, Theme] = {theme.name: theme for theme in (LIGHT, DARK, SUN)}

VERDICT_SIGNS: Mapping[Verdict, str] = {
    Verdict.NONE: "",
    Verdict.CONFIRMED: "✓",
    Verdict.REJECTED: "✕",
    Verdict.UNSURE: "?",
}


def verdict_outline(verdict: Verdict, centre: QPointF, radius: float) -> QPolygonF | None:
    """Return the corners of a verdict's shape: diamond, triangle, or for rejected a square; None is a circle."""
    x, y, r = centre.x(), centre.y(), radius
    if verdict is Verdict.NONE:
        return QPolygonF([QPointF(x, y - 1.2 * r), QPointF(x + r, y), QPointF(x, y + 1.2 * r), QPointF(x - r, y)])
    if verdict is Verdict.UNSURE:
        return QPolygonF([QPointF(x, y - 1.25 * r), QPointF(x + 1.2 * r, y + r), QPointF(x - 1.2 * r, y + r)])
    if verdict is Verdict.REJECTED:
        return QPolygonF(QRectF(x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r))
    return None


def paint_verdict(
    painter: QPainter, theme: Theme, verdict: Verdict, centre: QPointF, radius: float, *, selected: bool = False
) -> None:
    """Draw the mark of a verdict: confirmed a filled circle ✓, rejected a hollow square ✕, unsure a triangle ?.

    A candidate without a verdict is a diamond. Each has an outline of the ground's colour, so that it stands out on
    any spectrogram; the selected one has a ring.
    """
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    colour = theme.verdict_colour(verdict)
    hollow = verdict is Verdict.REJECTED
    if selected:
        painter.setPen(QPen(QColor(theme.outline), 2.0 + 2.0 * theme.line_width))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(centre, 1.75 * radius, 1.75 * radius)
        painter.setPen(QPen(QColor(theme.cursor), 1.0 + theme.line_width))
        painter.drawEllipse(centre, 1.75 * radius, 1.75 * radius)
    shape = verdict_outline(verdict, centre, radius)
    for pen, brush in (
        (QPen(QColor(theme.outline), 3.0 + theme.line_width), QBrush(Qt.BrushStyle.NoBrush)),
        (QPen(colour, theme.line_width), QBrush(QColor(theme.canvas) if hollow else colour)),
    ):
        painter.setPen(pen)
        painter.setBrush(brush)
        if shape is None:
            painter.drawEllipse(centre, radius, radius)
        else:
            painter.drawPolygon(shape)
    _paint_sign(painter, theme, verdict, centre, radius)
    painter.restore()


def _paint_sign(painter: QPainter, theme: Theme, verdict: Verdict, centre: QPointF, radius: float) -> None:
    """Draw ✓, ✕ and ? as strokes: not every font has them."""
    x, y, r = centre.x(), centre.y(), 0.5 * radius
    width = max(1.6, radius / 4.0)
    if verdict is Verdict.CONFIRMED:
        painter.setPen(QPen(QColor(theme.canvas), width))
        painter.drawPolyline(
            QPolygonF([QPointF(x - r, y), QPointF(x - 0.3 * r, y + 0.8 * r), QPointF(x + r, y - 0.8 * r)])
        )
    elif verdict is Verdict.REJECTED:
        painter.setPen(QPen(theme.verdict_colour(verdict), width))
        painter.drawLine(QPointF(x - r, y - r), QPointF(x + r, y + r))
        painter.drawLine(QPointF(x - r, y + r), QPointF(x + r, y - r))
    elif verdict is Verdict.UNSURE:
        font = QFont(theme.font())
        font.setBold(True)
        font.setPixelSize(max(7, round(1.5 * radius)))
        painter.setFont(font)
        painter.setPen(QColor(theme.canvas))
        painter.drawText(QRectF(x - 2 * r, y - 1.4 * r, 4 * r, 3.6 * r), Qt.AlignmentFlag.AlignCenter, "?")


class VerdictMarks:
    """The marks of one theme and size, painted once and laid down often."""

    def __init__(self, theme: Theme, radius: float, pixel_ratio: float) -> None:
        self._theme, self._radius, self._ratio = theme, radius, pixel_ratio
        self._pixmaps: dict[tuple[Verdict, bool], QPixmap] = {}

    def fits(self, theme: Theme, radius: float, pixel_ratio: float) -> bool:
        """Return whether these are the marks of that theme, size and screen."""
        return self._theme is theme and (self._radius, self._ratio) == (radius, pixel_ratio)

    def paint(self, painter: QPainter, verdict: Verdict, centre: QPointF, *, selected: bool = False) -> None:
        """Lay down the mark of a verdict."""
        half = 2.0 * self._radius + 2.0 * self._theme.line_width + 4.0
        pixmap = self._pixmaps.get((verdict, selected))
        if pixmap is None:
            size = round(2.0 * half * self._ratio)
            pixmap = QPixmap(size, size)
            pixmap.setDevicePixelRatio(self._ratio)
            pixmap.fill(Qt.GlobalColor.transparent)
            inner = QPainter(pixmap)
            try:
                paint_verdict(inner, self._theme, verdict, QPointF(half, half), self._radius, selected=selected)
            finally:
                inner.end()
            self._pixmaps[verdict, selected] = pixmap
        painter.drawPixmap(QPointF(round(centre.x() - half), round(centre.y() - half)), pixmap)
