"""How the ball lies now: a sphere with its equator, its meridian and its three axes, seen from the side and above."""

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPixmap, QPolygonF, QRadialGradient
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.painted_widget import PaintedWidget
from widgets.plot_theme import LIGHT, Theme

_AROUND = np.linspace(0.0, 2.0 * np.pi, 37)
_ELEVATION = np.radians(25.0)  # the eye looks this much down
_AZIMUTH = np.radians(-60.0)
_SAME = np.cos(0.5 * np.radians(0.4))  # attitudes closer than this look the same


def rotation_matrix(q_ws: FloatArray) -> FloatArray:
    """Return the (3, 3) matrix of a unit quaternion (w, x, y, z), sensor to world."""
    w, x, y, z = (float(part) for part in q_ws)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def seen(points_w: FloatArray) -> FloatArray:
    """Return points (n, 3) of the world (z up) as right, up and towards the eye (n, 3)."""
    right = np.array([-np.sin(_AZIMUTH), np.cos(_AZIMUTH), 0.0])
    toward = np.array(
        [np.cos(_ELEVATION) * np.cos(_AZIMUTH), np.cos(_ELEVATION) * np.sin(_AZIMUTH), np.sin(_ELEVATION)]
    )
    return np.asarray(points_w @ np.column_stack([right, np.cross(toward, right), toward]))


class AttitudeBall(PaintedWidget):
    """Draws the attitude last given; grey while there is none."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._q_ws: FloatArray | None = None
        self._ground: tuple[object, QPixmap] | None = None
        self.setAccessibleName(self.tr("Attitude of the device"))
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(110, 110)

    def sizeHint(self) -> QSize:
        """Prefer a square."""
        return QSize(160, 160)

    def set_attitude(self, q_ws: FloatArray | None) -> None:
        """Show this attitude (4,), sensor to world; None where none is known."""
        before, self._q_ws = self._q_ws, q_ws
        same = before is not None and q_ws is not None and abs(float(before @ q_ws)) > _SAME
        if not same:
            self.update()
        else:
            self._q_ws = before  # so that a slow turn adds up

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.update()

    def _paint(self, painter: QPainter) -> None:
        theme = self._theme
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(theme.font())
        radius = 0.5 * min(self.width(), self.height()) - theme.metrics().height()
        centre = QPointF(0.5 * self.width(), 0.5 * self.height())
        key = (self.size().width(), self.size().height(), self.devicePixelRatioF(), theme.name)
        if self._ground is None or self._ground[0] != key:
            self._ground = key, self._painted_ground(centre, radius)
        painter.drawPixmap(QPointF(0.0, 0.0), self._ground[1])
        if self._q_ws is None:
            box = QRectF(self.rect())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "–")
            return
        turn = rotation_matrix(self._q_ws)
        circle = np.column_stack([np.cos(_AROUND), np.sin(_AROUND), 0.0 * _AROUND])
        for columns, colour in (((0, 1, 2), theme.curve), ((0, 2, 1), theme.curve_second)):
            self._paint_circle(painter, seen(circle[:, columns] @ turn.T), centre, radius, colour)
        for axis, (name, colour) in enumerate(
            (("x", theme.curve), ("y", theme.curve_second), ("z", theme.curve_third))
        ):
            self._paint_axis(painter, seen(turn[:, axis][None])[0], centre, radius, name, colour)

    def _painted_ground(self, centre: QPointF, radius: float) -> QPixmap:
        """Return the sphere without marks; its shading is the dearest part of it, and always the same."""
        ratio = self.devicePixelRatioF()
        ground = QPixmap(self.size() * ratio)
        ground.setDevicePixelRatio(ratio)
        ground.fill(Qt.GlobalColor.transparent)
        shade = QRadialGradient(centre + QPointF(-0.4 * radius, -0.5 * radius), 1.8 * radius)
        shade.setColorAt(0.0, QColor(self._theme.canvas))
        shade.setColorAt(1.0, QColor(self._theme.grid))
        painter = QPainter(ground)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setBrush(shade)
        painter.setPen(QPen(QColor(self._theme.text), 1.5))
        painter.drawEllipse(centre, radius, radius)
        painter.end()
        return ground

    def _paint_circle(self, painter: QPainter, points: FloatArray, centre: QPointF, radius: float, colour: str) -> None:
        """Draw the half of a circle that faces the eye thick, the other half faint."""
        front = points[:, 2] >= 0.0
        for near in (False, True):
            shown = QColor(colour)
            shown.setAlpha(255 if near else 70)
            painter.setPen(QPen(shown, self._theme.line_width + (1.0 if near else 0.0)))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            run: list[QPointF] = []
            for (right, up, _), is_front in zip(points, front):
                if bool(is_front) is near:
                    run.append(QPointF(centre.x() + radius * right, centre.y() - radius * up))
                    continue
                if run:
                    painter.drawPolyline(QPolygonF(run))
                    run = []
            if run:
                painter.drawPolyline(QPolygonF(run))

    def _paint_axis(
        self, painter: QPainter, tip: FloatArray, centre: QPointF, radius: float, name: str, colour: str
    ) -> None:
        shown = QColor(colour)
        shown.setAlpha(255 if tip[2] >= 0.0 else 90)
        end = QPointF(centre.x() + radius * tip[0], centre.y() - radius * tip[1])
        painter.setPen(QPen(shown, 2.0 + self._theme.line_width))
        painter.drawLine(centre, end)
        painter.setBrush(shown)
        painter.drawEllipse(end, 4, 4)
        line = self._theme.metrics().height()
        outward = QPointF(centre.x() + (radius + 0.5 * line) * tip[0], centre.y() - (radius + 0.5 * line) * tip[1])
        box = QRectF(outward.x() - line, outward.y() - line, 2 * line, 2 * line)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, name)
