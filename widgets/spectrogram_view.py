"""The spectrogram with what one works with: the detector's band to be dragged, and a selection that tells its figures.

Shift+drag selects a rectangle, as does a plain drag with the select tool; its edges can be dragged. Its time is the
common cursor's selection, which all plots show.
"""

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen
from PySide6.QtWidgets import QWidget

from widgets.band_handles import BandHandles
from widgets.latest_loader import LatestLoader
from widgets.linked_plot import Drag
from widgets.plot_marks import Readout
from widgets.plot_paint import paint_tag
from widgets.plot_scale import hertz_name, number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.sound_picture import SoundPicture
from widgets.sound_selection import SelectionFigures, SoundSelection, grabbed_edge, measure, with_edge
from widgets.tile_source import TileSource
from widgets.time_axis import time_text
from widgets.time_cursor import TimeCursor
from widgets.units import quantities

LEAST_BAND = 1.05  # the upper edge of a band over its lower one
LEAST_SELECTION_PIXELS = 3.0


class SpectrogramView(SoundPicture):
    """The spectrogram of one channel, with the detector's band and a selection."""

    band_changed = Signal(float, float)  # Hz, when the operator has let go of a handle
    band_shown = Signal(float, float)  # Hz, whenever it is another one, and while it is dragged
    selection_changed = Signal(float, float, float, float)  # start_s, end_s, low_hz, high_hz: when it has been let go
    selection_cleared = Signal()

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self.setAccessibleName(self.tr("Spectrogram"))
        self.select_tool = False  # a plain drag selects
        self._names_ruler = True
        self._band_hz: tuple[float, float] | None = None
        self._dragged_band_hz: tuple[float, float] | None = None
        self._band_before_hz = (0.0, 0.0)  # what a drag began with
        self._selected_hz: tuple[float, float] | None = None  # None: all
        self._selecting_now = self._range_dragged = False
        self._figures: SelectionFigures | None = None
        self._measurer = LatestLoader(self)
        self._measurer.loaded.connect(self._take_figures)
        self._measurer.failed.connect(self.read_failed)
        cursor.selection_changed.connect(self._on_selection)

    # --- what it is told ----------------------------------------------------------------------------------------

    def set_source(self, source: TileSource | None) -> None:
        """Show this sound; None shows none. Waits for a read in work, so that the old source may be closed after."""
        self._measurer.stop()
        self._figures = None
        super().set_source(source)

    def set_band(self, low_hz: float, high_hz: float) -> None:
        """Show the detector's band with handles; asks nobody to look for leaks in it."""
        self._band_hz = (low_hz, high_hz)
        self.band_shown.emit(low_hz, high_hz)
        self.invalidate()

    def select(self, selection: SoundSelection | None) -> None:
        """Select a rectangle, or nothing; emits as if the operator had dragged it."""
        if selection is None:
            self._cursor.clear_selection()
            return
        self._show_selection(selection)
        self._end_selecting()

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """The detector's band in Hz."""
        return self._band_hz

    @property
    def selection(self) -> SoundSelection | None:
        """What is selected; a span chosen in another plot holds all frequencies."""
        if self._cursor.selection_s is None:
            return None
        whole = self.whole_frequency()
        low, high = self._selected_hz or (whole.low, whole.high)
        return SoundSelection(*self._cursor.selection_s, low, high)

    @property
    def figures(self) -> SelectionFigures | None:
        """What has been measured of the present selection; None until it has been."""
        return self._figures if self._figures is not None and self._figures.of == self.selection else None

    # --- the selection ------------------------------------------------------------------------------------------

    def selection_text(self) -> str:
        """Return Δt, Δm, Δf and the levels of the selection, in two lines; empty without one."""
        of, figures, locale = self.selection, self.figures, self.locale()
        if of is None:
            return ""
        span_s = of.end_s - of.start_s
        parts = [f"Δt {time_text(span_s, 0.1, locale)}" if span_s >= 60 else f"Δt {number_text(span_s, 2, locale)} s"]
        ends_m = self._cursor.chainage_at(of.start_s), self._cursor.chainage_at(of.end_s)
        if ends_m[0] is not None and ends_m[1] is not None:
            parts.append(f"Δs {quantities().length(ends_m[1] - ends_m[0], 2)}")
        parts.append(f"Δf {number_text(of.high_hz - of.low_hz, 0, locale)} Hz")
        first = "   ".join(parts)
        if figures is None or figures.level_db is None:
            return first
        second = self.tr("{level} dB").format(level=number_text(figures.level_db, 1, locale))
        if figures.excess_db is not None:
            sign = "+" if figures.excess_db >= 0.0 else ""
            over = sign + number_text(figures.excess_db, 1, locale)
            second = self.tr("{level} dB, {over} dB against beside it").format(
                level=number_text(figures.level_db, 1, locale), over=over
            )
        return f"{first}\n{second}"

    def beside_s(self, of: SoundSelection) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the spans of time before and after a selection that are as long as it on the common axis."""
        low, high = (float(self._cursor.x_of_time(t)) for t in (of.start_s, of.end_s))
        width, (first, last) = max(high - low, 1e-9), self._cursor.x_extent
        before = float(self._cursor.time_of_x(max(low - width, first)))
        after = float(self._cursor.time_of_x(min(high + width, last)))
        return (min(before, of.start_s), of.start_s), (of.end_s, max(after, of.end_s))

    def _selecting(self, start: QPointF) -> Drag:
        time_s, hz = self.time_of_pixel(start.x()), self._clamped(self.frequency_of_pixel(start.y()))

        def select(place: QPointF) -> None:
            other_s, other_hz = self.time_of_pixel(place.x()), self._clamped(self.frequency_of_pixel(place.y()))
            if abs(place.y() - start.y()) < LEAST_SELECTION_PIXELS:
                return
            times, frequencies = sorted((time_s, other_s)), sorted((hz, other_hz))
            self._show_selection(SoundSelection(times[0], times[1], frequencies[0], frequencies[1]))

        return select

    def _drag_edge(self, of: SoundSelection, edge: str) -> Drag:
        def drag(place: QPointF) -> None:
            hz = self._clamped(self.frequency_of_pixel(place.y()))
            self._show_selection(with_edge(of, edge, self.time_of_pixel(place.x()), hz))

        return drag

    def _show_selection(self, of: SoundSelection) -> None:
        self._selecting_now = True
        self._selected_hz = (of.low_hz, of.high_hz)
        self._cursor.set_selection(of.start_s, of.end_s)
        self.refresh()

    def _end_selecting(self) -> None:
        self._selecting_now = False
        of, source = self.selection, self._source
        if of is None:
            return
        if source is not None:
            beside = self.beside_s(of)
            self._measurer.request(lambda: measure(source, of, beside))
        self.selection_changed.emit(of.start_s, of.end_s, of.low_hz, of.high_hz)

    def _on_selection(self) -> None:
        if self._selecting_now:
            return
        self._selected_hz = None
        if self._cursor.selection_s is None:
            self._figures = None
            self._measurer.cancel()
            self.selection_cleared.emit()
        else:
            self._end_selecting()

    def _take_figures(self, figures: SelectionFigures) -> None:
        self._figures = figures
        self.refresh()

    def _clamped(self, frequency_hz: float) -> float:
        whole = self.whole_frequency()
        return min(max(frequency_hz, whole.low), whole.high)

    # --- painting -----------------------------------------------------------------------------------------------

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        super()._paint_data(painter, rect)
        handles = self._handles()
        if handles is not None and self._band_hz is not None:
            low, high = (hertz_name(round(f), self.locale()) for f in self._band_hz)
            handles.paint(painter, self._theme, (low, high), name=self.tr("leak band"))

    def _handles(self) -> BandHandles | None:
        if self._source is None or self._band_hz is None:
            return None
        low, high = (self.y_of_frequency(frequency) for frequency in self._band_hz)
        return BandHandles(self.plot_rect(), low, high)

    def _selection_area(self, of: SoundSelection) -> QRectF:
        left, right = self.pixel_of_time(of.start_s), self.pixel_of_time(of.end_s)
        top, bottom = self.y_of_frequency(of.high_hz), self.y_of_frequency(of.low_hz)
        return QRectF(left, top, max(right - left, 1.0), max(bottom - top, 1.0))

    def _paint_selection(self, painter: QPainter, rect: QRectF) -> None:
        of = self.selection
        if of is None:
            return
        area = self._selection_area(of)
        shown = area.intersected(rect)
        if shown.isEmpty():
            return
        painter.save()
        painter.setClipRect(rect)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for colour, width in ((self._theme.outline, 4.0), (self._theme.cursor, 2.0)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawRect(area)
        painter.restore()
        self._paint_figures(painter, rect, shown)

    def _paint_figures(self, painter: QPainter, rect: QRectF, shown: QRectF) -> None:
        metrics, lines = self._theme.metrics(), self.selection_text().split("\n")
        width = max(metrics.horizontalAdvance(line) for line in lines) + 14.0
        height = metrics.height() * len(lines) + 6.0
        left = min(max(shown.left(), rect.left() + 2), rect.right() - width - 2)
        above = shown.top() - height - 4
        top = above if above >= rect.top() else min(shown.bottom() + 4, rect.bottom() - height - 2)
        paint_tag(painter, self._theme, "\n".join(lines), QRectF(left, top, width, height), strong=True)

    # --- the mouse ----------------------------------------------------------------------------------------------

    def _readout(self, place: QPointF) -> Readout:
        base = super()._readout(place)
        frequency, level = self.frequency_of_pixel(place.y()), self.level_at(place)
        return Readout(base.time_s, base.chainage_m, base.position_w_m, frequency, level)

    def _grab(self, place: QPointF) -> Drag | None:
        bar_room = self._value_rect()
        end = self._bar.grabbed(bar_room, place) if self._source is not None else ""
        if end:
            bar, start_db = self._bar, self._bar.db_at(bar_room, place.y())

            def drag(place: QPointF) -> None:
                self._range_dragged = True
                self.set_db_range(*bar.dragged(end, bar.db_at(bar_room, place.y()) - start_db))

            return drag
        handles = self._handles()
        which = handles.grabbed(place) if handles is not None else None
        if which is not None:
            return self._drag_band(which)
        of, rect = self.selection, self.plot_rect()
        edge = grabbed_edge(self._selection_area(of), place) if of is not None and rect.contains(place) else ""
        if of is not None and edge:
            return self._drag_edge(of, edge)
        return self._selecting(place) if self.select_tool and rect.contains(place) else None

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Escape puts a band back that is being dragged, or else selects nothing."""
        if event.key() == Qt.Key.Key_Escape and self._dragged_band_hz is not None:
            self._pressed = self._drag = self._dragged_band_hz = None
            self.set_band(*self._band_before_hz)
        elif event.key() == Qt.Key.Key_Escape and self.selection is not None:
            self._pressed = self._drag = None
            self._selecting_now = False
            self._cursor.clear_selection()
        else:
            super().keyPressEvent(event)

    def _drag_band(self, which: int) -> Drag:
        self._band_before_hz = self._band_hz or self._band_before_hz

        def drag(place: QPointF) -> None:
            if self._band_hz is None:
                return
            frequency = self._clamped(self.frequency_of_pixel(place.y()))
            low, high = self._band_hz
            if which == 0:
                low = min(frequency, high / LEAST_BAND)
            else:
                high = max(frequency, low * LEAST_BAND)
            self._band_hz = self._dragged_band_hz = (low, high)
            self.band_shown.emit(low, high)
            self.invalidate()

        return drag

    def _drop(self) -> None:
        if self._selecting_now:
            self._end_selecting()
        if self._range_dragged:
            self._range_dragged = False
            self.fixed_range_chosen.emit()
        if self._dragged_band_hz is not None:
            self.band_changed.emit(*self._dragged_band_hz)
            self._dragged_band_hz = None

    def _zoom_vertical(self, factor: float, place: QPointF) -> None:
        rect, whole = self.plot_rect(), self.whole_frequency()
        part = (rect.bottom() - place.y()) / rect.height()
        self._frequency = self._frequency.zoomed(factor, part, (whole.low, whole.high), 10.0)
        self.invalidate()

    def _fit_vertical(self) -> None:
        self._frequency = self.whole_frequency()
        self.invalidate()
