"""The path from above: track with its 95 % interval, known places, leaks, scale and north; a click moves the cursor.

Mouse: click on the path moves the cursor, drag pans (with the ruler's tool: measures along the path), wheel and two
fingers zoom, double click shows everything, or what lies there.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QResizeEvent
from PySide6.QtWidgets import QWidget

from processing.survey import Candidate, Decision, FloatArray, Stretch, TiePoint, Track
from widgets.compared_paths import ComparedLines, ComparedPath
from widgets.path_items import BAND_Z, PathLines
from widgets.path_paint import (
    Labels,
    keep_furniture_free,
    paint_band,
    paint_cursor,
    paint_grid,
    paint_north,
    paint_scale_bar,
)
from widgets.plan_geometry import PlanScale, ThinnedPath, fitting, nearest_moment, way_between
from widgets.plan_hand import REACH_PIXELS, PlanHand
from widgets.plan_pins import Pin, PlanPins, ToLocal
from widgets.plan_places import PlanPlaces, paint_places
from widgets.plot_canvas import Keep, PaintedItem, PlotCanvas, plot_item
from widgets.plot_marks import Marks
from widgets.plot_theme import LIGHT, Theme, VerdictMarks
from widgets.ruler import paint_ruler_label_on_plan, paint_ruler_on_plan
from widgets.throttle import Throttle
from widgets.time_cursor import TimeCursor

MARGIN = 48.0


class PathView(PlanHand):
    """Plan view with equal scales of east and north; ``cursor`` is shared with the other views."""

    def __init__(self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(cursor, parent)
        self.setAccessibleName(self.tr("Path from above"))
        self._theme = theme
        self._track: Track | None = None
        self._path: ThinnedPath | None = None
        self._route = np.empty((0, 2))
        self._pins = PlanPins()
        self.ties_movable = False
        self._marks = Marks()
        self._stretches: tuple[Stretch, ...] = ()
        self._show_interval = True
        self._stale, self._range_stale = True, False
        self._build()
        self._mark_pixmaps: VerdictMarks | None = None
        self._painted_cursor: QPointF | None = None
        # while others pan, the highlighted part follows ten times a second
        self._follow_range = Throttle(lambda *_: self._invalidate_range(), 100, self)
        cursor.moved.connect(self._follow_cursor)
        cursor.ruler.changed.connect(self.refresh)
        cursor.range_changed.connect(self._follow_range.__call__)  # a bound method goes with its object

    def _build(self) -> None:
        """Put the items into a plot item without axes; its view box counts metres, equally east and north."""
        self._canvas = PlotCanvas(self, self._prepare)
        self._plot = plot_item()
        self._plot.vb.setAspectLocked()
        self._plot.layout.setContentsMargins(0.0, 0.0, 0.0, 0.0)
        self._canvas.setCentralItem(self._plot)
        self._ground = PaintedItem(self._plot, self._paint_ground, -200.0, Keep.STROKES)
        self._lines, self._compared = PathLines(self._plot.vb), ComparedLines(self._plot.vb)
        self._band_item = PaintedItem(None, self._paint_interval, BAND_Z, Keep.PIXELS)
        self._plot.vb.addItem(self._band_item, ignoreBounds=True)
        self._places = PaintedItem(self._plot, self._paint_places, 10.0, Keep.PIXELS)
        self._device = PaintedItem(self._plot, self._paint_device, 20.0, Keep.NOTHING)
        self._ruler_item = PaintedItem(self._plot, self._paint_ruler, 9.0, Keep.NOTHING)  # below marks and pins

    # --- what it is told ----------------------------------------------------------------------------------------

    def set_track(self, track: Track | None) -> None:
        """Show this path; None shows none. What was in view stays, unless everything was."""
        self._track, self._path = track, ThinnedPath.from_track(track)
        self._pins.place(self._cursor.position_at)
        self._refit()

    def set_route(self, route_w_m: FloatArray | None) -> None:
        """Show the pipe as the map has it: (n, 2 or 3), local east and north."""
        self._route = np.empty((0, 2)) if route_w_m is None else np.asarray(route_w_m, dtype=np.float64)[:, :2]
        self._refit()

    def set_compared(self, paths: Sequence[ComparedPath]) -> None:
        """Show the paths that other methods found."""
        self._compared.set_paths(paths)
        self._refit()

    def set_compared_visible(self, visible: bool) -> None:
        """Show or hide them: they are of use only where methods are compared."""
        self._compared.set_visible(visible)
        self._refit()

    def lift_compared(self, style: int) -> None:
        """Draw the compared path of this style thick and on top; -1 lifts none."""
        self._compared.lift(style)
        self.invalidate()

    def set_tie_points(self, tie_points: Sequence[TiePoint], to_local: ToLocal | None = None) -> None:
        """Show the known places: where ``to_local`` puts them, else where the device was at their moment."""
        self._pins.set_tie_points(tie_points, to_local, self._cursor.position_at)
        self._refit()

    def set_tie_state(self, doubted: frozenset[int], selected: int | None) -> None:
        """Mark the tie points that the others contradict, and ring one."""
        self._pins.set_doubted(doubted)
        self._pins.selected = selected
        self.invalidate()

    def set_candidates(self, candidates: Sequence[Candidate], decisions: Mapping[int, Decision] | None = None) -> None:
        """Show these candidates, each with its number and the mark of its verdict."""
        self._marks = Marks(tuple(candidates), dict(decisions or {}), self._marks.selected, self._marks.dug)
        self.invalidate()

    def set_selected(self, candidate_id: int | None) -> None:
        """Ring one candidate; None rings none."""
        self._marks = replace(self._marks, selected=candidate_id)
        self.invalidate()

    def set_dug(self, signs: Mapping[int, str]) -> None:
        """Mark the leaks, by number, that were dug up, each with the sign of what that showed."""
        self._marks = replace(self._marks, dug=dict(signs))
        self.invalidate()

    def set_not_assessed(self, stretches: Sequence[Stretch]) -> None:
        """Draw dashed where sound or path cannot be assessed."""
        self._stretches = tuple(stretches)
        self.invalidate()

    def set_interval_visible(self, visible: bool) -> None:
        """Show or hide the 95 % interval."""
        self._show_interval = visible
        self.invalidate()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.invalidate()

    # --- what is in view ----------------------------------------------------------------------------------------

    def fit(self) -> None:
        """Show everything."""
        size = (float(max(self.width(), 1)), float(max(self.height(), 1)))
        places = [self._route, self._compared.places, self._pins.places]
        if self._path is not None:
            places.append(self._path.plane_m[self._path.levels[-1]])
        self._fitted = True
        self._set_scale(fitting(np.concatenate(places), size, min(MARGIN, 0.2 * min(size))))

    def zoom(self, factor: float) -> None:
        """Make metres ``factor`` times as large, about the cursor if it is in view."""
        place = self._cursor_pixel()
        inside = place is not None and QRectF(self.rect()).contains(place)
        about = place if place is not None and inside else QRectF(self.rect()).center()
        self._fitted = False
        self._set_scale(self._scale.zoomed(factor, about.x(), about.y()))

    def centre_on(self, east_m: float, north_m: float) -> None:
        """Bring a place into the middle."""
        if math.isfinite(east_m) and math.isfinite(north_m):
            self._fitted = False
            self._set_scale(PlanScale((east_m, north_m), self._scale.pixels_per_m, self._scale.size))

    def candidate_at(self, place: QPointF) -> int | None:
        """Return the id of the candidate whose mark lies under a pixel."""
        for candidate in reversed(self._marks.in_drawing_order):
            centre = self._mark_centre(candidate)
            if centre is not None and math.dist(centre.toTuple(), place.toTuple()) <= self._mark_radius() + 4:
                return candidate.id
        return None

    def sizeHint(self) -> QSize:
        """Prefer a square of some size."""
        return QSize(480, 420)

    def minimumSizeHint(self) -> QSize:
        """Need room for the scale bar and a little path."""
        return QSize(200, 140)

    def _set_scale(self, scale: PlanScale) -> None:
        self._scale = scale
        self.invalidate()

    def _refit(self) -> None:
        if self._fitted and not self._mouse.carries:  # the map stays still under a hand that drags a tie point
            self.fit()
        self.invalidate()

    def _mark_radius(self) -> float:
        return 0.45 * self._theme.metrics().height()

    def _mark_centre(self, candidate: Candidate) -> QPointF | None:
        east, north, _ = candidate.position_w_m
        if not (math.isfinite(east) and math.isfinite(north)):
            return None
        return QPointF(*self._scale.pixel(east, north))

    def _cursor_pixel(self, time_s: float | None = None) -> QPointF | None:
        return self.pixel_of_moment(self._cursor.time_s if time_s is None else time_s)

    def pixel_of_moment(self, time_s: float) -> QPointF | None:
        """Return the pixel of where the device was at a moment; None without a path."""
        place = self._cursor.position_at(time_s)
        if place is None or not (math.isfinite(place[0]) and math.isfinite(place[1])):
            return None
        return QPointF(*self._scale.pixel(place[0], place[1]))

    def _follow_cursor(self) -> None:
        place = self._cursor_pixel()
        if (
            place is not None
            and not self._fitted  # then all is in view, however small the plan is before it has been laid out
            and not self._mouse.holds
            and not QRectF(self.rect()).adjusted(8, 8, -8, -8).contains(place)
        ):
            self.centre_on(*self._scale.metres(place.x(), place.y()))
        # only what the mark covers is laid down again
        for centre in (self._painted_cursor, self._cursor_pixel()):
            if centre is not None:
                self._canvas.viewport().update(QRectF(centre.x() - 26, centre.y() - 26, 52, 52).toAlignedRect())

    # --- bringing up to date, and painting ----------------------------------------------------------------------

    def invalidate(self) -> None:
        """Have everything brought up to date and painted anew."""
        self._stale = True
        self._canvas.viewport().update()

    def _invalidate_range(self) -> None:
        self._range_stale = True
        self.refresh()

    def refresh(self) -> None:
        """Lay down again what is there, and the cursor over it."""
        self._canvas.viewport().update()

    def _prepare(self) -> None:
        if self._range_stale and not self._stale:
            self._lines.show_range(self._cursor.range_s, self._theme)
        self._range_stale = False
        if not self._stale:
            return
        self._stale = False
        (west, north), (east, south) = self._scale.metres(0.0, 0.0), self._scale.metres(*self._scale.size)
        self._plot.layout.activate()
        self._plot.vb.setRange(xRange=(west, east), yRange=(south, north), padding=0.0, disableAutoRange=False)
        self._lines.show_route(self._route, self._scale, self._theme)
        self._lines.show_path(self._path, self._scale, self._theme, self._cursor.range_s, self._stretches)
        self._compared.show(self._scale, self._theme)
        self._band_item.renew(QRectF(west, south, east - west, north - south), QRectF(self.rect()))
        for item in (self._ground, self._places, self._device, self._ruler_item):
            item.renew(QRectF(self.rect()))

    def _paint_ground(self, painter: QPainter) -> None:
        painter.fillRect(self.rect(), QColor(self._theme.canvas))
        paint_grid(painter, self._theme, self._scale)

    def _paint_interval(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._show_interval and self._track is not None:
            for times in self._lines.shown_times:
                paint_band(painter, self._theme, self._scale, self._track, times)

    def _measured_way(self) -> list[QPointF]:
        ends_s = self._cursor.ruler.ends_s
        if ends_s is None or self._path is None:
            return []
        return [QPointF(*pixel) for pixel in way_between(self._path, self._scale, ends_s)]

    def _paint_ruler(self, painter: QPainter) -> None:
        paint_ruler_on_plan(painter, self._theme, self._measured_way())

    def _paint_device(self, painter: QPainter) -> None:
        place, ahead = self._cursor_pixel(), self.pixel_of_moment(self._cursor.time_s + 1.0)
        self._painted_cursor = place
        painter.setFont(self._theme.font())
        label = self._cursor.ruler.label
        paint_ruler_label_on_plan(painter, self._theme, self._measured_way(), label, QRectF(self.rect()))
        if place is not None:
            paint_cursor(painter, self._theme, place, ahead)
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.accent), 2))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self.rect()).adjusted(1, 1, -1, -1))

    def _paint_places(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        if self._path is None:
            painter.setPen(QColor(self._theme.text))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.rect(), flags, self.tr("No path yet: process the recording first"))
        self._paint_pins_and_marks(painter)
        paint_scale_bar(painter, self._theme, self._scale)
        paint_north(painter, self._theme, self._scale, self.tr("N"))

    def _paint_pins_and_marks(self, painter: QPainter) -> None:
        labels = Labels(painter, self._theme, QRectF(self.rect()))
        radius = self._mark_radius()
        pins = [
            (pin, QPointF(*self._scale.pixel(pin.east_m, pin.north_m))) for pin in (*self._end_pins(), *self._pins.pins)
        ]
        marks = [(c, centre) for c in self._marks.in_drawing_order if (centre := self._mark_centre(c)) is not None]
        for _, centre in (*pins, *marks):
            labels.keep_free(centre, radius)
        keep_furniture_free(labels, self._theme, self._scale)
        pixmaps, ratio = self._mark_pixmaps, self.devicePixelRatioF()
        if pixmaps is None or not pixmaps.fits(self._theme, radius, ratio):
            pixmaps = self._mark_pixmaps = VerdictMarks(self._theme, radius, ratio)
        places = PlanPlaces(pins, self._pins.selected, marks, self._marks, radius)
        # a carried tie point must follow the hand
        paint_places(painter, labels, self._theme, places, pixmaps, names=not self._mouse.carries)
        self._compared.paint_names(painter, labels, self._scale, self._theme)

    def _end_pins(self) -> tuple[Pin, ...]:
        if self._path is None:
            return ()
        return self._pins.ends(self._path.plane_m, self.tr("launch"), self.tr("retrieval"))

    # --- the mouse ----------------------------------------------------------------------------------------------

    def moment_at(self, place: QPointF, reach: float = REACH_PIXELS) -> float | None:
        """Return the moment at which the path passes nearest to a pixel; None where it is farther than ``reach``."""
        if self._path is None:
            return None
        rows = self._path.rows_for(0.5 / self._scale.pixels_per_m)
        pixels = self._scale.pixels(self._path.plane_m[rows])
        now = self._cursor.time_s
        return nearest_moment(self._path.time_s[rows], pixels, (place.x(), place.y()), now, reach)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the middle where it is, or everything in view."""
        super().resizeEvent(event)
        self._canvas.setGeometry(self.rect())
        size = (float(max(self.width(), 1)), float(max(self.height(), 1)))
        self._scale = PlanScale(self._scale.centre_m, self._scale.pixels_per_m, size)
        self._refit()

    def tie_at(self, place: QPointF) -> int | None:
        """Return the tie point whose pin lies under a pixel."""
        return self._pins.at(place, self._scale)

    def movable_tie_at(self, place: QPointF) -> int | None:
        """Return the tie point that a press takes up; under a leak's mark only the selected one: else that is meant."""
        tie = self._pins.at(place, self._scale) if self.ties_movable else None
        return tie if tie == self._pins.selected or self.candidate_at(place) is None else None
