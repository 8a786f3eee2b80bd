"""The lines of a map file from above: the sections to choose from, the way that they give, and where the run begins.

Mouse: click on a line chooses it or leaves it out, drag pans, wheel zooms about the mouse, double click shows all.
"""

import math
from collections.abc import Sequence

import numpy as np
from pyqtgraph.functions import arrayToQPath
from PySide6.QtCore import QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
    QPixmap,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.survey import FloatArray
from widgets.linked_plot import DRAG_PIXELS, ZOOM_STEP
from widgets.path_paint import paint_north, paint_pin, paint_scale_bar
from widgets.plan_geometry import PlanScale, fitting, visible_runs
from widgets.plot_theme import LIGHT, Theme

REACH_PIXELS = 24.0
ARROW_EVERY = 120.0  # pixels
MARGIN = 40.0


class RouteMap(QWidget):
    """Everything is in metres from the middle of the file, east to the right."""

    section_clicked = Signal(int)

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("Lines of the file from above"))
        self._theme = theme
        self._planes: tuple[FloatArray, ...] = ()
        self._corners = np.empty((0, 4))  # west, south, east, north of each section
        self._rows = np.empty((0, 2))  # the points of all sections, and whose each is
        self._owner = np.empty(0, dtype=np.intp)
        self._chosen: frozenset[int] = frozenset()
        self._way = np.empty((0, 2))
        self._launch: tuple[float, float] | None = None
        self._scale = PlanScale((0.0, 0.0), 1.0, (1.0, 1.0))
        self._fitted = True
        self._ground: QPixmap | None = None
        self._pressed: QPoint | None = None
        self._scale_pressed = self._scale
        self._dragged = False
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def set_lines(self, planes: Sequence[FloatArray], *, keep_view: bool = False) -> None:
        """Show these sections, each (n, 2)."""
        self._planes = tuple(planes)
        counts = [len(plane) for plane in planes]
        self._owner = np.repeat(np.arange(len(counts)), counts)
        self._rows, self._corners = np.empty((0, 2)), np.empty((0, 4))
        if counts:
            self._rows = np.concatenate(planes)
            starts = np.concatenate([[0], np.cumsum(counts[:-1])]).astype(np.intp)
            low, high = np.minimum.reduceat(self._rows, starts), np.maximum.reduceat(self._rows, starts)
            self._corners = np.hstack([low, high])
        if not keep_view:
            self.fit()
        self._repaint()

    def set_route(self, chosen: frozenset[int], way: FloatArray, launch: tuple[float, float] | None) -> None:
        """Show what is chosen, and the route (n, 2) with its direction; empty where there is none yet."""
        changed = chosen != self._chosen
        self._chosen, self._way, self._launch = chosen, way, launch
        if changed:
            self._ground = None
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        self._theme = theme
        self._repaint()

    def fit(self) -> None:
        """Show everything."""
        self._fitted = True
        size = (float(max(self.width(), 1)), float(max(self.height(), 1)))
        places = np.concatenate(self._planes) if self._planes else np.empty((0, 2))
        self._set_scale(fitting(places, size, min(MARGIN, 0.2 * min(size))))

    def section_at(self, place: QPointF) -> int | None:
        """Return which section passes nearest to a pixel, None where none is near."""
        best, least = None, REACH_PIXELS
        for k in self._near(place.x(), place.y(), place.x(), place.y(), REACH_PIXELS):
            pixels = self._scale.pixels(self._planes[k])
            start, step = pixels[:-1], np.diff(pixels, axis=0)
            length2 = np.maximum(np.sum(step**2, axis=1), 1e-12)
            here = np.array([place.x(), place.y()])
            part = np.clip(np.sum((here - start) * step, axis=1) / length2, 0.0, 1.0)
            away = float(np.hypot(*(start + part[:, None] * step - here).T).min())
            if away < least:
                best, least = k, away
        return best

    def _near(self, left: float, top: float, right: float, bottom: float, reach: float) -> list[int]:
        """Which sections may come within ``reach`` of a rectangle of pixels."""
        west, north = self._scale.metres(left - reach, top - reach)
        east, south = self._scale.metres(right + reach, bottom + reach)
        low_x, low_y, high_x, high_y = self._corners.T
        inside = (high_x >= west) & (low_x <= east) & (high_y >= south) & (low_y <= north)
        return [int(k) for k in np.flatnonzero(inside)]

    def sizeHint(self) -> QSize:
        """Prefer a square of some size."""
        return QSize(560, 480)

    def minimumSizeHint(self) -> QSize:
        """Need room for the scale bar and a little map."""
        return QSize(280, 220)

    def _set_scale(self, scale: PlanScale) -> None:
        self._scale = scale
        self._repaint()

    def _repaint(self) -> None:
        self._ground = None
        self.update()

    # --- painting ---

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Qt: the sections from their picture, the route anew."""
        if self._ground is None:
            self._ground = self._painted_ground()
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._ground)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        self._paint_way(painter)
        paint_scale_bar(painter, self._theme, self._scale)
        paint_north(painter, self._theme, self._scale, self.tr("N"))
        painter.end()

    def _painted_ground(self) -> QPixmap:
        ratio = self.devicePixelRatioF()
        picture = QPixmap(self.size() * ratio)
        picture.setDevicePixelRatio(ratio)
        picture.fill(QColor(self._theme.canvas))
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, len(self._planes) < 5000)
        pen = QPen(QColor(self._theme.route), 1.0 + self._theme.line_width)
        painter.setPen(pen)
        painter.drawPath(self._outline())
        for k in sorted(self._chosen):
            pen = QPen(QColor(self._theme.accent), 2.0 + 2.0 * self._theme.line_width)
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            self._paint_line(painter, self._planes[k], pen)
        painter.end()
        return picture

    def _outline(self) -> QPainterPath:
        """All sections that are in view and not chosen, as one path: a city has fifty thousand of them."""
        shown = np.zeros(len(self._planes), dtype=bool)
        shown[self._near(0.0, 0.0, self.width(), self.height(), 4.0)] = True
        shown[sorted(self._chosen)] = False
        rows = shown[self._owner]
        pixels, owner = self._scale.pixels(self._rows[rows]), self._owner[rows]
        if not len(pixels):
            return QPainterPath()
        ends = np.append(np.diff(owner) != 0, True)
        starts = np.append(True, ends[:-1])
        moved = np.append(True, np.abs(np.diff(np.round(pixels), axis=0)).sum(axis=1) > 0)
        keep = moved | starts | ends
        pixels = np.clip(pixels[keep], -1e5, 1e5)
        path: QPainterPath = arrayToQPath(pixels[:, 0], pixels[:, 1], connect=(~ends[keep]).astype(np.uint8))
        return path

    def _paint_line(self, painter: QPainter, plane: FloatArray, pen: QPen) -> None:
        pixels = self._scale.pixels(plane)
        pixels = pixels[np.append(True, np.abs(np.diff(np.round(pixels), axis=0)).sum(axis=1) > 0)]
        painter.setPen(pen)
        for start, end in visible_runs(pixels, self._scale.size, 20.0):
            points = [QPointF(x, y) for x, y in np.clip(pixels[start:end], -1e5, 1e5)]
            painter.drawPolyline(points)

    def _paint_way(self, painter: QPainter) -> None:
        if len(self._way) >= 2:
            colour = QColor(self._theme.text)
            self._paint_line(painter, self._way, QPen(colour, self._theme.line_width))
            painter.setBrush(colour)
            painter.setPen(QPen(QColor(self._theme.outline), 1.0))
            for place, turn in self._arrows():
                painter.save()
                painter.translate(place)
                painter.rotate(turn)
                painter.drawPolygon(QPolygonF([QPointF(-7, -7), QPointF(9, 0), QPointF(-7, 7), QPointF(-3, 0)]))
                painter.restore()
            self._name(painter, self._way[0], self.tr("Start"))
            self._name(painter, self._way[-1], self.tr("End"))
        if self._launch is not None:
            paint_pin(painter, self._theme, "launch", QPointF(*self._scale.pixel(*self._launch)), 8.0)

    def _arrows(self) -> list[tuple[QPointF, float]]:
        """Places and directions (degrees on the screen) of the arrow heads along the way."""
        pixels = self._scale.pixels(self._way)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(pixels, axis=0).T))])
        count = int(np.clip(along[-1] // ARROW_EVERY, 1, 400))
        out = []
        for at in (np.arange(count) + 0.5) * along[-1] / count:
            k = int(np.clip(np.searchsorted(along, at, side="right") - 1, 0, len(pixels) - 2))
            x, y = (float(np.interp(at, along, pixels[:, i])) for i in (0, 1))
            dx, dy = pixels[k + 1] - pixels[k]
            out.append((QPointF(x, y), math.degrees(math.atan2(dy, dx))))
        return out

    def _name(self, painter: QPainter, place: FloatArray, text: str) -> None:
        x, y = self._scale.pixel(float(place[0]), float(place[1]))
        metrics = self._theme.metrics()
        width, height = metrics.horizontalAdvance(text) + 10, metrics.height() + 4
        left = min(max(x + 12, 2), self._scale.size[0] - width - 2)
        box = QRectF(left, min(max(y - height - 6, 2), self._scale.size[1] - height - 2), width, height)
        painter.setPen(QPen(QColor(self._theme.text), 1.0))
        painter.setBrush(QColor(self._theme.canvas))
        painter.drawRoundedRect(box, 4, 4)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    # --- the mouse ---

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Qt: a click or the begin of a drag."""
        if event.button() is Qt.MouseButton.LeftButton:
            self._pressed, self._scale_pressed, self._dragged = event.position().toPoint(), self._scale, False

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Qt: pan."""
        if self._pressed is None:
            return
        moved = event.position().toPoint() - self._pressed
        if self._dragged or moved.manhattanLength() > DRAG_PIXELS:
            self._dragged, self._fitted = True, False
            self._set_scale(self._scale_pressed.moved(float(moved.x()), float(moved.y())))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Qt: a click without a drag chooses."""
        pressed, self._pressed = self._pressed, None
        if pressed is not None and not self._dragged:
            section = self.section_at(event.position())
            if section is not None:
                self.section_clicked.emit(section)

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:
        """Qt: show everything."""
        self._pressed = None
        self.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Qt: zoom about the mouse."""
        self._fitted = False
        place = event.position()
        self._set_scale(self._scale.zoomed(ZOOM_STEP ** (-event.angleDelta().y() / 120.0), place.x(), place.y()))
        event.accept()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: keep showing everything, or the middle where it was."""
        super().resizeEvent(event)
        if self._fitted:
            self.fit()
        else:
            size = (float(self.width()), float(self.height()))
            self._set_scale(PlanScale(self._scale.centre_m, self._scale.pixels_per_m, size))
