"""The picture of sound over time or metres and frequency, on an absolute scale of decibels, without anything over it.

The tiles are read by a worker; until it answers, what is at hand is drawn stretched. The picture has exactly the size
of the plot in device pixels; decibel range and colours act on it without reading anything.
"""

import math
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Signal
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

from processing.survey import Channel
from widgets.color_maps import COLOR_MAPS, DARK_EXCESS_MAP, EXCESS_MAP
from widgets.colour_bar import ColourBar
from widgets.contrast import MOST_HIDDEN, USUAL_DB, Contrast, Counts
from widgets.latest_loader import LatestLoader
from widgets.linked_plot import LinkedPlot
from widgets.plot_axes import ValueAxis
from widgets.plot_canvas import Keep, PaintedItem, PictureItem
from widgets.plot_paint import paint_tag
from widgets.plot_scale import Scale, ScaleKind, hertz_text
from widgets.plot_theme import LIGHT, Theme
from widgets.spectrogram_picture import EXCESS_LOW_DB, EXCESS_STEP_DB, Picture, PictureKey, PictureWish, Plane
from widgets.tile_source import TileSource
from widgets.time_cursor import TimeCursor

OVERVIEW_COLUMNS = 2048
OVERVIEW_ROWS = 256
LOWEST_LOG_HZ = 50.0
MOST_EXCESS_DB, USUAL_EXCESS_DB = 30.0, 10.0


class SoundPicture(LinkedPlot):
    """The levels of one channel with a decibel bar; subclasses add what lies over them."""

    db_range_changed = Signal(float, float)
    fixed_range_chosen = Signal()  # by a drag of its ends that has been let go
    looks_changed = Signal()  # scale of frequencies, plane, or colours
    read_failed = Signal(object)  # LeaklineError or OSError

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self._channel = Channel.SOUND
        self._source: TileSource | None = None
        self._kind = ScaleKind.LOG
        self._plane = Plane.SHORT
        self._frequency = Scale(LOWEST_LOG_HZ, 1000.0, self._kind)
        self._levels = Contrast(ColourBar(Scale(-120.0, 0.0), *USUAL_DB, "viridis"), USUAL_DB)
        span, usual = Scale(-MOST_EXCESS_DB, MOST_EXCESS_DB), (-USUAL_EXCESS_DB, USUAL_EXCESS_DB)
        name = DARK_EXCESS_MAP if theme.name == "dark" else EXCESS_MAP
        self._excess = Contrast(ColourBar(span, *usual, name, symmetric=True), usual)
        self._counts: Counts | None = None  # of the numbers in the picture
        self._overview_item, self._picture_item = PictureItem(), PictureItem()
        for item in (self._overview_item, self._picture_item):
            self._plot.addItem(item, ignoreBounds=True)
        self._bar_item = PaintedItem(self._plot, self._paint_bar, 9.0, Keep.PIXELS)
        self._bar_shown: tuple[Contrast, Theme, QRectF] | None = None
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

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters; what is as loud as the background looks like the canvas."""
        name = DARK_EXCESS_MAP if theme.name == "dark" else EXCESS_MAP
        self._excess = replace(self._excess, bar=replace(self._excess.bar, color_map=name))
        super().apply_theme(theme)

    # --- what it is told ----------------------------------------------------------------------------------------

    def set_source(self, source: TileSource | None) -> None:
        """Show this sound; None shows none. Waits for a read in work, so that the old source may be closed after."""
        self._loader.stop()
        self._overview_loader.stop()
        self._picture = self._overview = self._asked = self._overview_asked = self._counts = None
        self._source = source
        if source is not None:
            self._frequency = self.whole_frequency()
            self._levels = self._levels.back().over(Scale(*self._ends_db(source)))
        self.invalidate()

    def reload(self) -> None:
        """Read again what is shown: the source tells something else now. Until then the old picture stays."""
        if self._picture is not None:
            # no key that is ever wanted: good for the meantime only
            self._picture = replace(self._picture, key=replace(self._picture.key, rows=0))
        self._asked = self._overview_asked = None
        self.invalidate()

    def set_color_map(self, name: str) -> None:
        """Use another colour table for levels: one of :data:`widgets.color_maps.COLOR_MAPS`."""
        if name in COLOR_MAPS and name != self._levels.bar.color_map:
            self._levels = replace(self._levels, bar=replace(self._levels.bar, color_map=name))
            self.invalidate()
            self.looks_changed.emit()

    def set_plane(self, plane: Plane | str) -> None:
        """Show short events, steady sounds, or what is over the local background."""
        if Plane(plane) is not self._plane:
            self._plane = Plane(plane)
            self.invalidate()
            self.db_range_changed.emit(*self.db_range)
            self.looks_changed.emit()

    def set_db_range(self, low_db: float, high_db: float) -> None:
        """Let the colours run from ``low_db`` to ``high_db``; stays until changed, in whatever is shown."""
        if math.isfinite(low_db) and math.isfinite(high_db):
            self._set_contrast(self._contrast.with_fixed(low_db, high_db))

    def move_db_range(self, end: str, by_db: float) -> None:
        """Move the ``low`` or ``high`` end of the range (or ``both``) by decibels, within what there is."""
        self.set_db_range(*self._bar.dragged(end, by_db))

    def auto_db_range(self) -> bool:
        """Choose the decibel range by what is visible now, once; False where nothing has been read yet."""
        picture = self._picture
        if picture is None or picture.key.plane is not self._plane or self._counts is None:
            return False
        fitted = self._contrast.fitted(self._counts, (self._level_of(0), self._level_of(255)))
        if fitted is not None:
            self._set_contrast(fitted)
        return fitted is not None

    def fixed_db_range(self) -> None:
        """Go back to the range that was chosen, the same in whatever is shown."""
        self._set_contrast(self._contrast.back())

    def _set_contrast(self, contrast: Contrast) -> None:
        before = self._contrast
        if self._plane is Plane.EXCESS:
            self._excess = contrast
        else:
            self._levels = contrast
        if contrast != before:
            self.db_range_changed.emit(*self.db_range)
            self.invalidate()

    def set_frequency_scale(self, kind: ScaleKind | str) -> None:
        """Spread frequencies evenly, by the logarithm, or as the ear does (mel); shows them all."""
        if ScaleKind(kind) is not self._kind:
            self._kind = ScaleKind(kind)
            self._frequency = self.whole_frequency()
            self._picture = self._overview = None
            self.invalidate()
            self.looks_changed.emit()

    def set_frequency_range(self, low_hz: float, high_hz: float) -> None:
        """Show these frequencies, as far as there are any."""
        whole = self.whole_frequency()
        low, high = max(low_hz, whole.low), min(high_hz, whole.high)
        if high > low:
            self._frequency = Scale(low, high, self._kind)
            self.invalidate()

    @property
    def db_range(self) -> tuple[float, float]:
        """From where to where the colours run, in dB."""
        return self._bar.low_db, self._bar.high_db

    @property
    def colours(self) -> tuple[int, ...]:
        """The colours (0xffrrggbb) of the 256 numbers of a picture."""
        return tuple(self._bar.table(self._level_of(0), self._level_of(255)))

    @property
    def fixed_range(self) -> tuple[float, float]:
        """The decibels that the colours span unless one asks otherwise."""
        return self._contrast.fixed_db

    @property
    def contrast_is_auto(self) -> bool:
        """Whether the range was taken from what was visible."""
        return self._contrast.auto

    @property
    def hidden_share(self) -> float:
        """Which part of what is visible lies below the colours, 0 to 1."""
        if self._counts is None:
            return 0.0
        return self._contrast.hidden_share(self._counts, (self._level_of(0), self._level_of(255)))

    @property
    def color_map(self) -> str:
        """The colour table of levels."""
        return self._levels.bar.color_map

    @property
    def plane(self) -> Plane:
        """What of the sound is shown."""
        return self._plane

    @property
    def frequency_scale(self) -> ScaleKind:
        """How frequencies are spread."""
        return self._kind

    @property
    def frequency_range(self) -> tuple[float, float]:
        """The visible frequencies in Hz."""
        return self._frequency.low, self._frequency.high

    @property
    def is_sharp(self) -> bool:
        """Whether the picture of what is visible now has been read."""
        return self._picture is not None and self._picture.key == self._key()

    def whole_frequency(self) -> Scale:
        """Return all frequencies there are; the lowest that a logarithmic axis shows is 50 Hz."""
        if self._source is None:
            return Scale(LOWEST_LOG_HZ, 1000.0, self._kind)
        frequencies = self._source.frequencies_hz
        lowest, highest = float(frequencies[0]), float(frequencies[-1])
        if self._kind is ScaleKind.LOG:
            second = float(frequencies[min(1, len(frequencies) - 1)])
            lowest = max(min(LOWEST_LOG_HZ, 0.1 * highest), 0.5 * second)
        return Scale(lowest, max(highest, lowest + 1.0), self._kind)

    # --- reading ------------------------------------------------------------------------------------------------

    def _key(self) -> PictureKey:
        rect, (low, high) = self.plot_rect(), self.x_span()
        rows = max(1, round(rect.height() * self.devicePixelRatioF()))
        mode, version = self._cursor.axis_mode, self._map_version
        return PictureKey(low, high, mode, self._frequency, self.columns(), rows, version, self._plane)

    def _overview_key(self) -> PictureKey:
        low, high = self._cursor.x_extent
        mode, version, whole = self._cursor.axis_mode, self._map_version, self.whole_frequency()
        return PictureKey(low, high, mode, whole, OVERVIEW_COLUMNS, OVERVIEW_ROWS, version, self._plane)

    def _ask(self) -> None:
        source, key, whole = self._source, self._key(), self._overview_key()
        if source is None:
            return
        if self._asked != key and not self.is_sharp:
            self._asked = key
            wish = PictureWish.of(key, self._cursor)
            self._loader.request(lambda: wish.read(source))
        if self._overview_asked != whole:
            self._overview_asked = whole
            wish_whole = PictureWish.of(whole, self._cursor)
            self._overview_loader.request(lambda: wish_whole.read(source))

    def _take_picture(self, picture: Picture) -> None:
        self._picture = picture
        self._counts = np.bincount(picture.levels.ravel(), minlength=256)
        self.invalidate_in_turn()

    def _take_overview(self, picture: Picture) -> None:
        self._overview = picture
        self.invalidate()

    def _forget_map(self) -> None:
        self._map_version += 1

    # --- levels and colours -------------------------------------------------------------------------------------

    @property
    def _contrast(self) -> Contrast:
        return self._excess if self._plane is Plane.EXCESS else self._levels

    @property
    def _bar(self) -> ColourBar:
        return self._contrast.bar

    @staticmethod
    def _ends_db(source: TileSource) -> tuple[float, float]:
        """Return what the lowest and the highest number of a sound's tiles stand for."""
        return source.low_db, source.low_db + 255.0 * source.step_db

    def _level_of(self, number: int) -> float:
        """Return the decibels that a number of the picture stands for."""
        if self._plane is Plane.EXCESS:
            return EXCESS_LOW_DB + EXCESS_STEP_DB * number
        low, high = self._ends_db(self._source) if self._source is not None else (0.0, 0.0)
        return low + (high - low) / 255.0 * number

    def level_at(self, place: QPointF) -> float | None:
        """Return the level in dB of the picture at one of the widget's pixels; None where none has been read."""
        picture, rect = self._picture, self.plot_rect()
        if picture is None or picture.key != self._key() or not rect.contains(place):
            return None
        rows, columns = picture.levels.shape
        row = min(int((place.y() - rect.top()) / rect.height() * rows), rows - 1)
        column = min(int((place.x() - rect.left()) / rect.width() * columns), columns - 1)
        number = int(picture.levels[row, column])
        return self._level_of(number) if number else None

    def frequency_of_pixel(self, y: float) -> float:
        """Return the frequency of one of the widget's pixels."""
        rect = self.plot_rect()
        return float(self._frequency.value((rect.bottom() - y) / rect.height()))

    def y_of_frequency(self, frequency_hz: float) -> float:
        """Return the widget's pixel of a frequency."""
        rect = self.plot_rect()
        return rect.bottom() - float(self._frequency.fraction(frequency_hz)) * rect.height()

    # --- painting -----------------------------------------------------------------------------------------------

    def _show_data(self) -> None:
        scale, known = self._frequency, self._source is not None
        self._plot.vb.setRange(
            yRange=(scale.spread(scale.low), scale.spread(scale.high)), padding=0.0, disableAutoRange=False
        )
        self._value_axis.show_scale(scale if known else None, self.tr("Hz"), self._hertz_text, self._axis_left())
        if known:
            self._ask()
        # the overview lies below what was seen last, where that does not cover everything
        wanted, picture = self._key(), self._picture
        covered = picture is not None and picture.key.covers(wanted)
        self._show_picture(self._overview_item, None if covered else self._overview, wanted)
        self._show_picture(self._picture_item, picture, wanted)
        self._bar_item.setVisible(known)
        bar = (self._contrast, self._theme, self._value_rect())
        if self._bar_shown != bar:
            self._bar_shown = bar
            self._bar_item.renew(self._value_rect().adjusted(-4, -8, 4, 8))

    def _value_axes(self, rect: QRectF) -> list[tuple[QRectF, ValueAxis]]:
        """Return none: lines of frequency would cover the sound."""
        del rect
        return []

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        if self._source is None:
            self._paint_hint(painter, rect, self.tr("No sound: the data page says why"))
        elif self.hidden_share > MOST_HIDDEN:
            self._paint_hidden(painter, rect)

    def _paint_bar(self, painter: QPainter) -> None:
        painter.setFont(self._theme.font())
        mode = self.tr("auto") if self._contrast.auto else self.tr("fixed")
        self._bar.paint(painter, self._value_rect(), self._theme, mode)

    def _paint_hidden(self, painter: QPainter, rect: QRectF) -> None:
        """Say that the colours hide what is weak, and what to do."""
        metrics = self._theme.metrics()
        text = self.tr("{percent} % is too quiet for these colours: K fits them")
        text = text.format(percent=round(100.0 * self.hidden_share))
        width, height = metrics.horizontalAdvance(text) + 14.0, metrics.height() + 6.0
        if width <= rect.width() and height <= rect.height():
            place = QRectF(rect.center().x() - 0.5 * width, rect.bottom() - height - 4.0, width, height)
            paint_tag(painter, self._theme, text, place, strong=True)

    def _hertz_text(self, value: float, step: float) -> str:
        del step
        return hertz_text(value, self.locale())

    def _show_picture(self, item: PictureItem, picture: Picture | None, wanted: PictureKey) -> None:
        """Show a picture where it belongs, stretched if it is of another place or zoom, if it is of the same axes."""
        if picture is None or not picture.key.is_of_same_axes(wanted):
            item.hide()
            return
        part, (left, right), (high, low) = picture.visible_part(wanted)
        first, last = self._level_of(0), self._level_of(255)
        item.show_picture(part, self._bar.table(first, last), QRectF(left, high, right - left, low - high))
