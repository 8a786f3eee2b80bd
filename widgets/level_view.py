"""The level of the leak band along the pipe, with the local background and the threshold that candidates must pass."""

import math
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QWidget

from processing.survey import Candidate, Channel, FloatArray
from widgets.curve_plot import Curve, CurvePlot, padded
from widgets.envelope import EnvelopePyramid
from widgets.plot_marks import Readout
from widgets.plot_paint import legend_box, paint_legend
from widgets.plot_scale import hertz_span
from widgets.plot_theme import LIGHT, Theme
from widgets.time_cursor import TimeCursor


@dataclass(frozen=True)
class LevelCurves:
    """Levels in dB at n places: ``time_s`` never falling; ``chainage_m`` never falling, None without a track.

    ``threshold_db`` is what a peak must reach, as a level like the others; NaN is "not assessed".
    """

    time_s: FloatArray  # (n,)
    level_db: FloatArray  # (n,)
    chainage_m: FloatArray | None = None  # (n,)
    background_db: FloatArray | None = None  # (n,)
    threshold_db: FloatArray | None = None  # (n,)
    band_hz: tuple[float, float] | None = None  # which the levels are of


class LevelView(CurvePlot):
    """Level, background and threshold; candidates sit on the curve."""

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self.setAccessibleName(self.tr("Level along the pipe"))
        self._channel = Channel.SOUND
        self._band_hz: tuple[float, float] | None = None
        self._level: Curve | None = None
        self._background: Curve | None = None
        self._threshold: Curve | None = None
        self._background_item, self._threshold_item, self._level_item = (self._new_curve() for _ in range(3))

    def set_levels(self, curves: LevelCurves | None) -> None:
        """Show these levels; None shows none."""
        self._level = self._background = self._threshold = self._band_hz = None
        if curves is not None and len(curves.time_s):
            self._band_hz = curves.band_hz
            self._level = _curve(curves, curves.level_db)
            self._background = _curve(curves, curves.background_db)
            self._threshold = _curve(curves, curves.threshold_db)
            spans = [c.by_time.span() for c in (self._level, self._background, self._threshold) if c is not None]
            known = [s for s in spans if s is not None]
            whole = (min(s[0] for s in known), max(s[1] for s in known)) if known else None
            # room on top for the marks
            low, high = padded(whole, 6.0)
            self._set_whole(low, high + 0.12 * (high - low))
        self.invalidate()

    def level_at(self, time_s: float) -> float | None:
        """Return the level in dB at a moment; None where there is none."""
        if self._level is None:
            return None
        chainage_m = self._cursor.chainage_at(time_s)
        along = self._level.by_chainage
        if along is not None and chainage_m is not None:
            level = along.value_at(chainage_m)
        else:
            level = self._level.by_time.value_at(time_s)
        return level if math.isfinite(level) else None

    def _show_data(self) -> None:
        self._show_scale(self._scale if self._level is not None else None, self.tr("dB"))
        self._show_curve(self._background_item, self._background, self._theme.curve_third)
        self._show_curve(self._threshold_item, self._threshold, self._theme.curve_second)
        self._show_curve(self._level_item, self._level, self._theme.curve)

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        if self._level is None:
            self._paint_hint(painter, rect, self.tr("No level yet: process the recording first"))
            return
        self._paint_stems(painter, rect)
        names = (
            (self._level, self._level_name(), self._theme.curve),
            (self._threshold, self.tr("threshold"), self._theme.curve_second),
            (self._background, self.tr("background"), self._theme.curve_third),
        )
        known = [(name, colour) for curve, name, colour in names if curve is not None]
        box, away = legend_box(rect, self._theme, known), 1.4 * self.mark_radius()
        hidden = any(box.adjusted(-away, -away, away, away).contains(centre) for _, centre in self._mark_places)
        below = rect.height() - box.height() - 8 if hidden else 0.0  # a mark would stand on the names
        paint_legend(painter, rect, self._theme, known, below)

    def _level_name(self) -> str:
        """Return what the level is of."""
        if self._band_hz is None:
            return self.tr("level")
        return self.tr("level {band}").format(band=hertz_span(*self._band_hz, self.locale()))

    def _paint_stems(self, painter: QPainter, rect: QRectF) -> None:
        """Show with a bar at the foot the stretch within which each candidate lies in 95 of 100 cases."""
        for candidate, centre in self._mark_places:
            painter.setPen(QPen(QColor(self._theme.text), 1, Qt.PenStyle.DotLine))
            painter.drawLine(centre, QPointF(centre.x(), rect.bottom()))
            ends = self._cursor.x_of_chainage(np.array([candidate.chainage_low95_m, candidate.chainage_high95_m]))
            if np.all(np.isfinite(ends)):
                left, right = (min(max(self.pixel_of_x(float(x)), rect.left()), rect.right()) for x in ends)
                painter.fillRect(
                    QRectF(left, rect.bottom() - 4, max(right - left, 2.0), 4),
                    self._theme.verdict_colour(self._marks.verdict(candidate)),
                )

    def _mark_centre(self, candidate: Candidate) -> QPointF | None:
        at_top = super()._mark_centre(candidate)
        if at_top is None or self._level is None:
            return at_top
        pyramid, place = self._level.by_time, candidate.time_s
        if self._level.by_chainage is not None and math.isfinite(candidate.chainage_m):
            pyramid, place = self._level.by_chainage, candidate.chainage_m
        value = pyramid.value_at(place) if math.isfinite(place) else math.nan
        if not math.isfinite(value):
            return at_top
        y = self.y_of(value) - 1.8 * self.mark_radius()
        rect = self.plot_rect()
        return QPointF(at_top.x(), min(max(y, at_top.y()), rect.bottom() - self.mark_radius()))

    def _paint_values(self, painter: QPainter, rect: QRectF) -> None:
        rows = (
            (self._level, self._theme.curve),
            (self._threshold, self._theme.curve_second),
            (self._background, self._theme.curve_third),
        )
        for row, (curve, colour) in enumerate(rows):
            if curve is not None:
                text = self._value_text(curve.value_at_cursor(self._cursor), 1, self.tr("dB"))
                self._paint_value(painter, rect, row, text, colour)

    def _readout(self, place: QPointF) -> Readout:
        base = super()._readout(place)
        time_s = self.time_of_pixel(place.x())
        level = self._level.by_time.value_at(time_s) if self._level is not None else math.nan
        return Readout(time_s, base.chainage_m, base.position_w_m, level_db=level if math.isfinite(level) else None)


def _curve(curves: LevelCurves, values: FloatArray | None) -> Curve | None:
    if values is None:
        return None
    by_time = EnvelopePyramid.build(curves.time_s, values, gap=math.inf)
    metres = curves.chainage_m
    by_chainage = EnvelopePyramid.build(metres, values, gap=math.inf) if metres is not None else None
    return Curve(by_time, by_chainage)
