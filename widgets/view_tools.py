"""Large buttons for what the linked views do together: measure, follow the playback, fill the screen."""

from collections.abc import Callable

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QHBoxLayout, QToolButton, QWidget

SIDE, ICON = 44, 24
_SCALE = 2  # crisp on screens with two pixels a point


class ViewTools(QWidget):
    """Signals out; the setters show how it is."""

    measure_toggled = Signal(bool)
    follow_asked = Signal()
    full_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._measure = self._button("measure_tool", self.tr("Measure: drag in any view (R at the cursor)"))
        self._measure.setCheckable(True)
        self._measure.toggled.connect(self.measure_toggled)
        self._follow = self._button("follow_mode", "")
        self._follow.clicked.connect(self.follow_asked)
        self._full = self._button("full_screen", self.tr("Full screen, and back (F11)"))
        self._full.clicked.connect(self.full_asked)
        self._mode, self._paused = "page", False
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        for button in (self._measure, self._follow, self._full):
            layout.addWidget(button)
        self.show_follow("page", paused=False)

    def set_measuring(self, *, on: bool) -> None:
        """Show whether a drag measures."""
        self._measure.setChecked(on)

    def show_follow(self, mode: str, *, paused: bool) -> None:
        """Show how the views follow the playback: ``page``, ``centre`` or ``none``; or that they wait."""
        self._mode, self._paused = mode, paused
        text = {
            "page": self.tr("The views follow the playback page by page (H)"),
            "centre": self.tr("The views follow the playback with the cursor in the middle (H)"),
            "none": self.tr("The views stay while it plays (H)"),
        }[mode]
        if paused:
            text = self.tr("You have moved the view: it waits until the playback comes by, or H")
        self._follow.setToolTip(text)
        self._follow.setAccessibleName(text)
        self._draw_icons()

    @property
    def follow_text(self) -> str:
        """What the button for following says."""
        return self._follow.toolTip()

    def redraw(self) -> None:
        """Draw the icons in the colours that the window has now."""
        self._draw_icons()

    def _button(self, name: str, tip: str) -> QToolButton:
        button = QToolButton()
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        button.setMinimumSize(SIDE, SIDE)
        button.setIconSize(QSize(ICON, ICON))
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _draw_icons(self) -> None:
        colour = self.palette().buttonText().color()
        self._measure.setIcon(_icon(colour, _paint_ruler_icon))
        paint = {"page": _paint_page, "centre": _paint_centre, "none": _paint_still}[self._mode]
        self._follow.setIcon(_icon(colour, paint, faint=self._paused))
        self._full.setIcon(_icon(colour, _paint_corners))


def _icon(colour: QColor, paint: Callable[[QPainter], None], *, faint: bool = False) -> QIcon:
    pixmap = QPixmap(ICON * _SCALE, ICON * _SCALE)
    pixmap.setDevicePixelRatio(_SCALE)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    try:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(0.4 if faint else 1.0)
        painter.setPen(QPen(colour, 2.0))
        paint(painter)
    finally:
        painter.end()
    return QIcon(pixmap)


def _paint_ruler_icon(painter: QPainter) -> None:
    """A span between two ends, with an arrow at each."""
    for x, ahead in ((2.0, 5.0), (22.0, -5.0)):
        painter.drawLine(QPointF(x, 4), QPointF(x, 20))
        painter.drawPolyline([QPointF(x + ahead, 8), QPointF(x + 0.2 * ahead, 12), QPointF(x + ahead, 16)])
    painter.drawLine(QPointF(3, 12), QPointF(21, 12))


def _paint_view(painter: QPainter, cursor_x: float) -> None:
    painter.drawRect(QRectF(2, 4, 20, 16))
    painter.drawLine(QPointF(cursor_x, 4), QPointF(cursor_x, 20))


def _paint_page(painter: QPainter) -> None:
    """A view that jumps on when the cursor has reached its end."""
    _paint_view(painter, 18)
    painter.drawPolyline([QPointF(8, 8), QPointF(12, 12), QPointF(8, 16)])


def _paint_centre(painter: QPainter) -> None:
    """A view with the cursor in the middle."""
    _paint_view(painter, 12)
    painter.drawPolyline([QPointF(8, 9), QPointF(5, 12), QPointF(8, 15)])
    painter.drawPolyline([QPointF(16, 9), QPointF(19, 12), QPointF(16, 15)])


def _paint_still(painter: QPainter) -> None:
    """A view that stays: a bar under it."""
    painter.drawRect(QRectF(2, 4, 20, 12))
    painter.drawLine(QPointF(2, 21), QPointF(22, 21))


def _paint_corners(painter: QPainter) -> None:
    """Four corners."""
    for x, dx in ((3.0, 6.0), (21.0, -6.0)):
        for y, dy in ((4.0, 6.0), (20.0, -6.0)):
            painter.drawPolyline([QPointF(x + dx, y), QPointF(x, y), QPointF(x, y + dy)])
