"""The sound picture: level over time or metres and frequency, on an absolute scale of decibels.

The tiles are read by a worker; until it answers, what is at hand is drawn stretched. The picture has exactly the size
of the plot in device pixels; decibel range and colours act on it without reading anything.
"""

import math
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QWidget

from processing.survey import Channel
from widgets.color_maps import COLOR_MAPS
from widgets.colour_bar import LEAST_RANGE_DB, ColourBar
from widgets.latest_loader import LatestLoader
from widgets.linked_plot import Drag, LinkedPlot
from widgets.plot_axes import ValueAxis
from widgets.plot_canvas import Keep, PaintedItem, PictureItem
from widgets.plot_marks import Readout
from widgets.plot_scale import Scale, ScaleKind, hertz_text
from widgets.plot_theme import LIGHT, Theme
from widgets.tile_source import Levels, TileSource, pixel_levels
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor

OVERVIEW_COLUMNS = 2048
OVERVIEW_ROWS = 256
LOWEST_LOG_HZ = 20.0
HANDLE_PIXELS = 6.0


@dataclass(frozen=True)
class PictureKey:
    """What a picture shows; two pictures with the same key are the same."""

    x_low: float
    x_high: float
    mode: AxisMode
    frequency: Scale
    columns: int
    rows: int
    map_version: int

    def is_of_same_axes(self, other: "PictureKey") -> bool:
        """Return whether one can be drawn stretched in the place of the other."""
        mine = (self.mode, self.map_version, self.frequency.kind)
        return mine == (other.mode, other.map_version, other.frequency.kind)


@dataclass(frozen=True)
class Picture:
    """Levels (rows, columns), highest frequency first, and what they show."""

    key: PictureKey
    levels: Levels

    def visible_part(self, wanted: PictureKey) -> tuple[Levels, tuple[float, float], tuple[float, float]]:
        """Return the levels that ``wanted`` shows, and from where to where they reach: along x, and down the axis.

        Qt counts in 1/65536 of a pixel when it stretches: what is far outside must not be part of the image.
        """
        has, (rows, columns) = self.key, self.levels.shape
        top, bottom = has.frequency.spread(has.frequency.high), has.frequency.spread(has.frequency.low)
        upper, lower = wanted.frequency.spread(wanted.frequency.high), wanted.frequency.spread(wanted.frequency.low)
        across, xs = _cut(has.x_low, has.x_high, columns, wanted.x_low, wanted.x_high)
        down, ys = _cut(top, bottom, rows, upper, lower)
        return self.levels[down, across], xs, ys


def _cut(first: float, last: float, count: int, start: float, end: float) -> tuple[slice, tuple[float, float]]:
    """Return which of ``count`` cells from ``first`` to ``last`` touch ``start`` to ``end``, and where those reach."""
    cell = (last - first) / count
    begin = min(max(math.floor((start - first) / cell + 1e-6), 0), count)
    stop = min(max(math.ceil((end - first) / cell - 1e-6), begin), count)
    return slice(begin, stop), (first + begin * cell, last if stop == count else first + stop * cell)


class SpectrogramView(LinkedPlot):
    """The spectrogram of one channel, with the detector's band and a decibel bar that can be dragged."""

    band_changed = Signal(float, float)  # Hz, when the operator has let go of a handle
    db_range_changed = Signal(float, float)
    read_failed = Signal(object)  # LeaklineError or OSError

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self.setAccessibleName(self.tr("Spectrogram"))
        self._channel = Channel.SOUND
        self._source: TileSource | None = None
        self._frequency = Scale(0.0, 1.0)
        self._kind = ScaleKind.LINEAR
        self._bar = ColourBar(Scale(-120.0, 0.0), -90.0, -30.0, "viridis")
        self._overview_item, self._picture_item = PictureItem(), PictureItem()
        for item in (self._overview_item, self._picture_item):
            self._plot.addItem(item, ignoreBounds=True)
        self._bar_item = PaintedItem(self._plot, self._paint_bar, 9.0, Keep.PIXELS)
        self._range_is_chosen = False
        self._band_hz: tuple[float, float] | None = None
        self._dragged_band_hz: tuple[float, float] | None = None
        self._picture: Picture | None = None
        self._overview: Picture | None = None
        self._asked: PictureKey | None = None
        self._overview_asked: PictureKey | None = None
        self._map_version = 0
        self._loader, self._overview_loader = LatestLoader(self), LatestLoader(self)
        self._loader.loaded.connect(self._take_picture)
        self._overview_loader.loaded.connect(self._take_overview)
        for loader in (self._loader, self._overview_loader):
            loader.failed.connect(self.read_failed)
        cursor.axis_changed.connect(self._forget_map)

    # --- what it is told ----------------------------------------------------------------------------------------

    def set_source(self, source: TileSource | None) -> None:
        """Show this sound; None shows none. Waits for a read in work, so that the old source may be closed after."""
        self._loader.stop()
        self._overview_loader.stop()
        self._picture = self._overview = self._asked = self._overview_asked = None
        self._source = source
        if source is not None:
            self._frequency = self._whole_frequency()
            top = source.low_db + 255.0 * source.step_db
            self._bar = ColourBar(Scale(source.low_db, top), *self._within(source, top), self._bar.color_map)
        self.invalidate()

    def set_color_map(self, name: str) -> None:
        """Use another colour table: one of :data:`widgets.color_maps.COLOR_MAPS`."""
        if name in COLOR_MAPS:
            self._bar = ColourBar(self._bar.scale, self._bar.low_db, self._bar.high_db, name)
            self.invalidate()

    def set_db_range(self, low_db: float, high_db: float) -> None:
        """Let the colours run from ``low_db`` to ``high_db``; stays until changed, wherever one pans."""
        if not (math.isfinite(low_db) and math.isfinite(high_db)):
            return
        high_db = max(high_db, low_db + LEAST_RANGE_DB)
        self._range_is_chosen = True
        if (low_db, high_db) != self.db_range:
            self._bar = ColourBar(self._bar.scale, low_db, high_db, self._bar.color_map)
            self.db_range_changed.emit(low_db, high_db)
            self.invalidate()

    def auto_db_range(self) -> bool:
        """Choose the decibel range by what is visible now, once; False where nothing has been read yet."""
        return self._picture is not None and self._choose_range(self._picture.levels)

    def set_frequency_scale(self, kind: ScaleKind | str) -> None:
        """Spread frequencies evenly, by the logarithm, or as the ear does (mel); shows them all."""
        self._kind = ScaleKind(kind)
        self._frequency = self._whole_frequency()
        self._picture = self._overview = None
        self.invalidate()

    def set_frequency_range(self, low_hz: float, high_hz: float) -> None:
        """Show these frequencies, as far as there are any."""
        whole = self._whole_frequency()
        low, high = max(low_hz, whole.low), min(high_hz, whole.high)
        if high > low:
            self._frequency = Scale(low, high, self._kind)
            self.invalidate()

    def set_band(self, low_hz: float, high_hz: float) -> None:
        """Show the detector's band with handles; emits nothing."""
        self._band_hz = (low_hz, high_hz)
        self.invalidate()

    @property
    def db_range(self) -> tuple[float, float]:
        """From where to where the colours run, in dB."""
        return self._bar.low_db, self._bar.high_db

    @property
    def frequency_range(self) -> tuple[float, float]:
        """The visible frequencies in Hz."""
        return self._frequency.low, self._frequency.high

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """The detector's band in Hz."""
        return self._band_hz

    @property
    def is_sharp(self) -> bool:
        """Whether the picture of what is visible now has been read."""
        return self._picture is not None and self._picture.key == self._key()

    # --- reading ------------------------------------------------------------------------------------------------

    def _key(self) -> PictureKey:
        rect, (low, high) = self.plot_rect(), self.x_span()
        rows = max(1, round(rect.height() * self.devicePixelRatioF()))
        return PictureKey(low, high, self._cursor.axis_mode, self._frequency, self.columns(), rows, self._map_version)

    def _overview_key(self) -> PictureKey:
        low, high = self._cursor.x_extent
        mode, version = self._cursor.axis_mode, self._map_version
        return PictureKey(low, high, mode, self._whole_frequency(), OVERVIEW_COLUMNS, OVERVIEW_ROWS, version)

    def _ask(self) -> None:
        source, key, whole = self._source, self._key(), self._overview_key()
        if source is None:
            return
        if self._asked != key and not self.is_sharp:
            self._asked = key
            edges = self._cursor.column_edges_s(key.columns)
            self._loader.request(lambda: Picture(key, pixel_levels(source, edges, key.frequency, key.rows)))
        if self._overview_asked != whole:
            self._overview_asked = whole
            edges_whole = self._cursor.column_edges_s(whole.columns, whole=True)
            self._overview_loader.request(
                lambda: Picture(whole, pixel_levels(source, edges_whole, whole.frequency, whole.rows))
            )

    def _take_picture(self, picture: Picture) -> None:
        self._picture = picture
        self.invalidate()

    def _take_overview(self, picture: Picture) -> None:
        self._overview = picture
        if not self._range_is_chosen:
            self._choose_range(picture.levels)
        self.invalidate()

    def _forget_map(self) -> None:
        self._map_version += 1

    def _choose_range(self, levels: Levels) -> bool:
        """Take the range by percentiles (acoustics §4.3): never by extremes, which one click would set."""
        counts = np.bincount(levels.ravel(), minlength=256)
        counts[0] = 0  # 0 is "nothing there"
        if not counts.any():
            return False
        share = np.cumsum(counts) / counts.sum()
        scale = self._bar.scale
        step = (scale.high - scale.low) / 255.0
        low = scale.low + step * int(np.searchsorted(share, 0.05)) - 3.0
        high = max(scale.low + step * int(np.searchsorted(share, 0.998)), low + 30.0)
        self.set_db_range(round(max(low, scale.low)), round(min(max(high, low + LEAST_RANGE_DB), scale.high)))
        return True

    def _within(self, source: TileSource, top_db: float) -> tuple[float, float]:
        low, high = self.db_range
        if self._range_is_chosen and low < top_db and high > source.low_db:
            return low, high
        self._range_is_chosen = False
        return source.low_db + 0.25 * (top_db - source.low_db), source.low_db + 0.75 * (top_db - source.low_db)

    def _whole_frequency(self) -> Scale:
        if self._source is None:
            return Scale(LOWEST_LOG_HZ, 1000.0, self._kind)
        frequencies = self._source.frequencies_hz
        lowest = float(frequencies[0])
        if self._kind is ScaleKind.LOG:
            lowest = max(LOWEST_LOG_HZ, float(frequencies[min(1, len(frequencies) - 1)]))
        return Scale(lowest, max(float(frequencies[-1]), lowest + 1.0), self._kind)

    # --- painting -----------------------------------------------------------------------------------------------

    def _show_data(self) -> None:
        scale, known = self._frequency, self._source is not None
        self._plot.vb.setRange(
            yRange=(scale.spread(scale.low), scale.spread(scale.high)), padding=0.0, disableAutoRange=False
        )
        self._value_axis.show_scale(scale if known else None, self.tr("Hz"), self._hertz_text, self._axis_left())
        if known:
            self._ask()
        # the overview lies below what was seen last, which rarely covers everything
        self._show_picture(self._overview_item, None if self.is_sharp else self._overview)
        self._show_picture(self._picture_item, self._picture)
        self._bar_item.setVisible(known)
        self._bar_item.renew(self._value_rect().adjusted(-4, -8, 4, 8))

    def _value_axes(self, rect: QRectF) -> list[tuple[QRectF, ValueAxis]]:
        """Return none: lines of frequency would cover the sound."""
        del rect
        return []

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        if self._source is None:
            self._paint_hint(painter, rect, self.tr("No sound"))
            return
        self._paint_band(painter, rect)

    def _paint_bar(self, painter: QPainter) -> None:
        painter.setFont(self._theme.font())
        self._bar.paint(painter, self._value_rect(), self._theme)

    def _hertz_text(self, value: float, step: float) -> str:
        del step
        return hertz_text(value, self.locale())

    def _show_picture(self, item: PictureItem, picture: Picture | None) -> None:
        """Show a picture where it belongs, stretched if it is of another place or zoom, if it is of the same axes."""
        wanted = self._key()
        if picture is None or not picture.key.is_of_same_axes(wanted):
            item.hide()
            return
        part, (left, right), (high, low) = picture.visible_part(wanted)
        scale = self._bar.scale
        colours = self._bar.colours(np.linspace(scale.low, scale.high, 256))
        item.show_picture(part, colours, QRectF(left, high, right - left, low - high))

    def _paint_band(self, painter: QPainter, rect: QRectF) -> None:
        if self._band_hz is None:
            return
        for frequency in self._band_hz:
            y = self._y_of(frequency)
            if not rect.top() <= y <= rect.bottom():
                continue
            for colour, width in ((self._theme.outline, 3.0), (self._theme.text, 1.0)):
                painter.setPen(
                    QPen(QColor(colour), width, Qt.PenStyle.SolidLine if width > 1 else Qt.PenStyle.DashLine)
                )
                painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
            painter.fillRect(QRectF(rect.left(), y - 5, 5, 10), QColor(self._theme.cursor))
            painter.fillRect(QRectF(rect.right() - 5, y - 5, 5, 10), QColor(self._theme.cursor))

    # --- the mouse ----------------------------------------------------------------------------------------------

    def level_at(self, place: QPointF) -> float | None:
        """Return the level in dB of the picture at one of the widget's pixels; None where none has been read."""
        picture, rect = self._picture, self.plot_rect()
        if picture is None or picture.key != self._key() or not rect.contains(place):
            return None
        rows, columns = picture.levels.shape
        row = min(int((place.y() - rect.top()) / rect.height() * rows), rows - 1)
        column = min(int((place.x() - rect.left()) / rect.width() * columns), columns - 1)
        number = int(picture.levels[row, column])
        scale = self._bar.scale
        return scale.low + number * (scale.high - scale.low) / 255.0 if number else None

    def frequency_of_pixel(self, y: float) -> float:
        """Return the frequency of one of the widget's pixels."""
        rect = self.plot_rect()
        return float(self._frequency.value((rect.bottom() - y) / rect.height()))

    def _y_of(self, frequency_hz: float) -> float:
        rect = self.plot_rect()
        return rect.bottom() - float(self._frequency.fraction(frequency_hz)) * rect.height()

    def _readout(self, place: QPointF) -> Readout:
        base = super()._readout(place)
        frequency, level = self.frequency_of_pixel(place.y()), self.level_at(place)
        return Readout(base.time_s, base.chainage_m, base.position_w_m, frequency, level)

    def _grab(self, place: QPointF) -> Drag | None:
        bar_room = self._value_rect()
        end = self._bar.grabbed(bar_room, place) if self._source is not None else ""
        if end:
            bar, start_db = self._bar, self._bar.db_at(bar_room, place.y())
            return lambda p: self.set_db_range(*bar.dragged(end, bar.db_at(bar_room, p.y()) - start_db))
        if self._band_hz is None or not self.plot_rect().contains(place):
            return None
        away = [abs(self._y_of(f) - place.y()) for f in self._band_hz]
        if min(away) > HANDLE_PIXELS:
            return None
        return self._drag_band(away.index(min(away)))

    def _drag_band(self, which: int) -> Drag:
        def drag(place: QPointF) -> None:
            if self._band_hz is None:
                return
            whole = self._whole_frequency()
            frequency = min(max(self.frequency_of_pixel(place.y()), whole.low), whole.high)
            low, high = self._band_hz
            low, high = (min(frequency, high - 1.0), high) if which == 0 else (low, max(frequency, low + 1.0))
            self._band_hz = self._dragged_band_hz = (low, high)
            self.invalidate()

        return drag

    def _drop(self) -> None:
        if self._dragged_band_hz is not None:
            self.band_changed.emit(*self._dragged_band_hz)
            self._dragged_band_hz = None

    def _zoom_vertical(self, factor: float, place: QPointF) -> None:
        rect, whole = self.plot_rect(), self._whole_frequency()
        part = (rect.bottom() - place.y()) / rect.height()
        self._frequency = self._frequency.zoomed(factor, part, (whole.low, whole.high), 10.0)
        self.invalidate()

    def _fit_vertical(self) -> None:
        self._frequency = self._whole_frequency()
        self.invalidate()
