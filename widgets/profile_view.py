"""The elevation of the pipe along the common axis, with its 95 % interval and the known places."""

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QWidget

from processing.survey import Candidate, Channel, TiePoint, Track
from widgets.curve_plot import Curve, CurvePlot, padded
from widgets.envelope import EnvelopePyramid
from widgets.plot_marks import Readout
from widgets.plot_theme import LIGHT, Theme
from widgets.time_cursor import TimeCursor
from widgets.units import quantities

SIGMAS_95 = 1.96
NARROW_LETTERS = 36  # beside the leaks' plan: with the values beside it half of the profile's width was theirs


class ProfileView(CurvePlot):
    """Elevation against metres (or time); the band holds the true elevation in 95 of 100 cases."""

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self.setAccessibleName(self.tr("Elevation profile"))
        self._channel = Channel.PATH
        self._names_ruler = True
        self._factor = 1.0  # of metres, as elevations are shown
        self._up: Curve | None = None
        self._low: Curve | None = None
        self._high: Curve | None = None
        self._band_item, self._up_item = self._new_curve(), self._new_curve()

    def set_track(self, track: Track | None) -> None:
        """Show the elevation of a track; None shows none."""
        self._up = self._low = self._high = None
        if track is not None and len(track.time_s):
            self._factor = quantities().length_factor
            up, half = self._factor * track.position_w_m[:, 2], self._factor * SIGMAS_95 * track.sigma_up_m
            self._up, self._low, self._high = (
                Curve(EnvelopePyramid.build(track.time_s, values, gap=math.inf))
                for values in (up, up - half, up + half)
            )
            span = self._up.by_time.span()
            # the curve rules the axis: an interval of a hundred metres must not flatten it to a line
            if span is not None:
                room = min(float(np.nanmax(half, initial=0.0)), 2.0 * max(span[1] - span[0], 1.0))
                span = (span[0] - room, span[1] + room)
            self._set_whole(*padded(span, 1.0))
        self.invalidate()

    def _show_data(self) -> None:
        self._show_scale(self._scale if self._up is not None else None, self._axis_name())
        if self._low is None or self._high is None:
            self._band_item.hide()
        else:
            count = self.columns()
            low, high = self._low.columns(self._cursor, count)[0], self._high.columns(self._cursor, count)[1]
            band = QColor(self._theme.band)
            band.setAlpha(130)
            self._show_columns(self._band_item, low, high, band)
        self._show_curve(self._up_item, self._up, self._theme.curve, 1.3)

    def plot_rect(self) -> QRectF:
        """Return where data are drawn: nearly all of a narrow view, with the values over the curve if they fit."""
        rect = QRectF(super().plot_rect())
        if self._is_narrow():
            rect.setRight(max(rect.left() + 1.0, self.width() - self._theme.metrics().horizontalAdvance("0 m") - 8))
        return rect

    def _value_rect(self) -> QRectF:
        return self.plot_rect().adjusted(2.0, 0.0, 0.0, 0.0) if self._is_narrow() else super()._value_rect()

    def _is_narrow(self) -> bool:
        return self.width() < NARROW_LETTERS * self._theme.metrics().horizontalAdvance("0")

    def _axis_name(self) -> str:
        return self.tr("elevation ({unit})").format(unit=quantities().length_unit)

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        if self._up is None:
            self._paint_hint(painter, rect, self.tr("No path yet: process the recording first"))

    def _tie_height(self, tie: TiePoint, rect: QRectF) -> float | None:
        return None if tie.up_m is None else min(max(self.y_of(self._factor * tie.up_m), rect.top()), rect.bottom())

    def _mark_centre(self, candidate: Candidate) -> QPointF | None:
        at_top = super()._mark_centre(candidate)
        up = candidate.position_w_m[2]
        if at_top is None or self._up is None or not math.isfinite(up):
            return at_top
        rect = self.plot_rect()
        return QPointF(at_top.x(), min(max(self.y_of(self._factor * up), rect.top()), rect.bottom()))

    def _paint_values(self, painter: QPainter, rect: QRectF) -> None:
        if self._up is None or self._high is None:
            return
        unit = quantities().length_unit
        up, high = self._up.value_at_cursor(self._cursor), self._high.value_at_cursor(self._cursor)
        height, interval = self._value_text(up, 2, unit), "± " + self._value_text(high - up, 2, unit)
        if self._is_narrow() and self._theme.metrics().horizontalAdvance(interval) > rect.width() - 4.0:
            return  # half a number would be worse than none
        self._paint_value(painter, rect, 0, height, self._theme.curve)
        self._paint_value(painter, rect, 1, interval, self._theme.text)

    def _readout(self, place: QPointF) -> Readout:
        base = super()._readout(place)
        if self._up is None:
            return base
        return Readout(
            base.time_s,
            base.chainage_m,
            base.position_w_m,
            value=self.value_of_pixel(place.y()),
            unit=quantities().length_unit,
        )
