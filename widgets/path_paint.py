"""Strokes of the plan view: grid, interval, pins, names that keep off each other, scale bar and north arrow."""

import math
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from processing.survey import FloatArray, Track
from widgets.plan_geometry import PlanScale, band_outline
from widgets.plot_paint import edges_of, free_box, paint_tag
from widgets.plot_scale import multiples, nice_step, tick_digits
from widgets.plot_theme import Theme
from widgets.units import quantities

SIGMAS_95 = 1.96
ELLIPSE_95 = 2.4477  # of two coordinates together: the root of chi-square's 95 % with two degrees of freedom
BAND_STEP_PIXELS = 6.0
ELLIPSE_STEP_PIXELS = 110.0
SMALLEST_ELLIPSE_PIXELS = 3.0


def polygon(pixels: FloatArray) -> QPolygonF:
    """Return a polygon of pixels (n, 2)."""
    return QPolygonF([QPointF(x, y) for x, y in pixels.tolist()])


def paint_grid(painter: QPainter, theme: Theme, scale: PlanScale) -> None:
    """Draw lines of round east and north."""
    factor = quantities().length_factor
    step = nice_step(scale.size[0] / scale.pixels_per_m * factor, max(2, int(scale.size[0] / 90))) / factor
    west, north = scale.metres(0.0, 0.0)
    east, south = scale.metres(*scale.size)
    painter.setPen(QPen(QColor(theme.grid), 1))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    for value in multiples(west, east, step):
        x = scale.pixel(value, 0.0)[0]
        painter.drawLine(QPointF(x, 0.0), QPointF(x, scale.size[1]))
    for value in multiples(south, north, step):
        y = scale.pixel(0.0, value)[1]
        painter.drawLine(QPointF(0.0, y), QPointF(scale.size[0], y))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)


def paint_band(painter: QPainter, theme: Theme, scale: PlanScale, track: Track, time_s: FloatArray) -> None:
    """Draw the 95 % interval of a stretch of the path: a band across, and ellipses every so often."""
    sparse = _spaced(track, time_s, scale, BAND_STEP_PIXELS)
    if len(sparse) < 2:
        return
    plane, along, across = _interval(track, sparse)
    if float(np.max(across)) * scale.pixels_per_m < 1.0 and float(np.max(along)) * scale.pixels_per_m < 1.0:
        return
    fill = QColor(theme.band)
    fill.setAlpha(90)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(fill)
    painter.drawPolygon(polygon(scale.pixels(band_outline(plane, across))), Qt.FillRule.WindingFill)
    painter.setPen(QPen(QColor(theme.band), 0.8 * theme.line_width))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    every = max(1, round(ELLIPSE_STEP_PIXELS / BAND_STEP_PIXELS))
    for place, ellipse in zip(plane[every // 2 :: every], _ellipses(track, sparse[every // 2 :: every])):
        size = [axis * scale.pixels_per_m for axis in ellipse.half_axes_m]
        if max(size) >= SMALLEST_ELLIPSE_PIXELS:
            painter.save()
            painter.translate(*scale.pixel(*place))
            painter.rotate(-math.degrees(ellipse.angle_rad))
            painter.drawEllipse(QPointF(0.0, 0.0), size[0], size[1])
            painter.restore()


@dataclass(frozen=True)
class Ellipse:
    """A place's 95 % ellipse: half axes, and the angle of the first one from east, counter-clockwise."""

    half_axes_m: tuple[float, float]
    angle_rad: float


def ellipse_95(east_m2: float, east_north_m2: float, north_m2: float) -> Ellipse:
    """Return the ellipse that holds a place in 95 of 100 cases, of its variances and covariance."""
    values, axes = np.linalg.eigh(np.array([[east_m2, east_north_m2], [east_north_m2, north_m2]]))
    small, large = (ELLIPSE_95 * math.sqrt(max(float(v), 0.0)) for v in values)
    return Ellipse((large, small), math.atan2(axes[1, 1], axes[0, 1]))


def _spaced(track: Track, time_s: FloatArray, scale: PlanScale, pixels: float) -> FloatArray:
    """Return moments so far apart that the path between them is about so many pixels long."""
    plane = _plane(track, time_s)
    travelled = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(plane, axis=0).T)))) * scale.pixels_per_m
    keep = np.flatnonzero(np.diff(np.floor(travelled / pixels), prepend=-1.0) > 0)
    return np.asarray(time_s[keep])


def _plane(track: Track, time_s: FloatArray) -> FloatArray:
    return np.stack([np.interp(time_s, track.time_s, track.position_w_m[:, k]) for k in (0, 1)], axis=1)


def _ellipses(track: Track, time_s: FloatArray) -> list[Ellipse]:
    """Return the ellipses at moments; a track without covariances says them along and across its way."""
    if track.cov_level_m2 is not None:
        columns = [np.nan_to_num(np.interp(time_s, track.time_s, column)) for column in track.cov_level_m2.T]
        return [ellipse_95(*(float(v) for v in row)) for row in zip(*columns, strict=True)]
    _, along, across = _interval(track, time_s)
    ahead = _plane(track, time_s + 0.5) - _plane(track, time_s - 0.5)
    factor = ELLIPSE_95 / SIGMAS_95
    return [
        Ellipse((factor * float(a), factor * float(c)), math.atan2(h[1], h[0])) for a, c, h in zip(along, across, ahead)
    ]


def _interval(track: Track, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    along, across = (
        SIGMAS_95 * np.nan_to_num(np.interp(time_s, track.time_s, sigma))
        for sigma in (track.sigma_along_m, track.sigma_cross_m)
    )
    return _plane(track, time_s), along, across


def paint_cursor(painter: QPainter, theme: Theme, place: QPointF, ahead: QPointF | None) -> None:
    """Draw where the device is at the cursor, with a stroke towards where it is going."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for colour, extra in ((theme.outline, 3.0), (theme.cursor, 0.0)):
        painter.setPen(QPen(QColor(colour), theme.line_width + 0.5 + extra))
        painter.drawEllipse(place, 7.0, 7.0)
        painter.drawLine(place + QPointF(0, -13), place + QPointF(0, -7))
        painter.drawLine(place + QPointF(0, 7), place + QPointF(0, 13))
        painter.drawLine(place + QPointF(-13, 0), place + QPointF(-7, 0))
        painter.drawLine(place + QPointF(7, 0), place + QPointF(13, 0))
        if ahead is not None and (length := math.dist(place.toTuple(), ahead.toTuple())) > 1e-6:
            painter.drawLine(place, place + QPointF(ahead.x() - place.x(), ahead.y() - place.y()) * (20.0 / length))


def paint_pin(painter: QPainter, theme: Theme, kind: str, centre: QPointF, radius: float) -> None:
    """Draw a known place: launch a triangle, retrieval and tie points squares, hollow where they do not pull.

    One that the others contradict is crossed out.
    """
    colour = QColor(theme.tie_point)
    painter.setPen(QPen(QColor(theme.outline) if kind != "unused" else colour, 1.5))
    painter.setBrush(QColor(theme.canvas) if kind == "unused" else colour)
    x, y, r = centre.x(), centre.y(), radius
    if kind == "launch":
        painter.drawPolygon(
            QPolygonF([QPointF(x - r, y - 1.2 * r), QPointF(x + 1.3 * r, y), QPointF(x - r, y + 1.2 * r)])
        )
    else:
        painter.drawRect(QRectF(x - r, y - r, 2 * r, 2 * r))
    if kind == "doubted":
        painter.setPen(QPen(QColor(theme.cursor), 2.5))
        painter.drawLine(QPointF(x - 1.6 * r, y - 1.6 * r), QPointF(x + 1.6 * r, y + 1.6 * r))
        painter.drawLine(QPointF(x - 1.6 * r, y + 1.6 * r), QPointF(x + 1.6 * r, y - 1.6 * r))


class Labels:
    """Writes names beside places so that they cover neither each other nor the marks; else they are left out."""

    def __init__(self, painter: QPainter, theme: Theme, within: QRectF) -> None:
        self._painter, self._theme, self._within = painter, theme, within
        self._taken: list[tuple[float, float, float, float]] = []

    def keep_free(self, centre: QPointF, radius: float) -> None:
        """Let no name cover this mark."""
        x, y = centre.x(), centre.y()
        if self._within.adjusted(-radius, -radius, radius, radius).contains(centre):
            self._taken.append((x - radius, y - radius, x + radius, y + radius))

    def keep_box_free(self, box: QRectF) -> None:
        """Let no name cover this box."""
        self._taken.append(edges_of(box))

    def write(self, text: str, about: QPointF, away: float, *, strong: bool = False) -> bool:
        """Write a name; False where there was no room."""
        if not text or not self._within.contains(about):
            return False
        metrics = self._theme.metrics()
        width = metrics.horizontalAdvance(text) + 8
        box = free_box(width, metrics.height(), about, away, self._taken, self._within)
        if box is None:
            return False
        self._taken.append(edges_of(box))
        paint_tag(self._painter, self._theme, text, box, strong=strong)
        return True


def keep_furniture_free(labels: Labels, theme: Theme, scale: PlanScale) -> None:
    """Let no name cover the scale bar or the north arrow."""
    height = theme.metrics().height()
    bar = _bar_length_m(scale) * scale.pixels_per_m + 28.0
    labels.keep_box_free(QRectF(0.0, scale.size[1] - height - 26.0, bar, height + 26.0))
    labels.keep_box_free(QRectF(scale.size[0] - 34.0, 8.0, 34.0, height + 34.0))


def paint_scale_bar(painter: QPainter, theme: Theme, scale: PlanScale) -> None:
    """Draw a bar of round metres, or feet, into the lower left corner."""
    metrics = theme.metrics()
    length_m = _bar_length_m(scale)
    pixels = length_m * scale.pixels_per_m
    left, bottom = 14.0, scale.size[1] - 14.0
    write = quantities()
    text = write.length(length_m, tick_digits(length_m * write.length_factor * (1.0 + 1e-9)))
    width = max(pixels, metrics.horizontalAdvance(text)) + 16
    ground = QColor(theme.canvas)
    ground.setAlpha(215)
    painter.fillRect(QRectF(left - 8, bottom - metrics.height() - 12, width, metrics.height() + 20), ground)
    painter.setPen(QPen(QColor(theme.text), 1.0 + theme.line_width))
    painter.drawLine(QPointF(left, bottom), QPointF(left + pixels, bottom))
    for x in (left, left + pixels):
        painter.drawLine(QPointF(x, bottom - 5), QPointF(x, bottom + 5))
    painter.drawText(QPointF(left + 2, bottom - 7), text)


def _bar_length_m(scale: PlanScale) -> float:
    factor = quantities().length_factor
    return _round_down(min(160.0, 0.4 * scale.size[0]) / scale.pixels_per_m * factor) / factor


def _round_down(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    return max(m * power for m in (1.0, 2.0, 5.0) if m * power <= value * (1 + 1e-9))


def paint_north(painter: QPainter, theme: Theme, scale: PlanScale, letter: str) -> None:
    """Draw the north arrow into the upper right corner; north is always up."""
    metrics = theme.metrics()
    x, top = scale.size[0] - 22.0, 10.0
    height = 30.0
    painter.setPen(QPen(QColor(theme.text), 1))
    painter.setBrush(QColor(theme.text))
    painter.drawPolygon(
        QPolygonF([QPointF(x, top), QPointF(x + 8, top + height), QPointF(x, top + 0.75 * height), QPointF(x, top)])
    )
    painter.setBrush(QColor(theme.canvas))
    painter.drawPolygon(
        QPolygonF([QPointF(x, top), QPointF(x - 8, top + height), QPointF(x, top + 0.75 * height), QPointF(x, top)])
    )
    box = QRectF(x - 20, top + height, 40, metrics.height() + 2)
    painter.setPen(QColor(theme.text))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, letter)
