"""A slow channel over the common axis: raw and filtered, what was taken off, and how sure the filtered value is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from processing.survey import FloatArray
from widgets.curve_plot import Curve
from widgets.envelope import EnvelopePyramid
from widgets.latest_loader import LatestLoader
from widgets.plot_theme import LIGHT, Theme
from widgets.strips_view import Strip, StripsView, strip_of
from widgets.time_cursor import TimeCursor


@dataclass(frozen=True)
class ChannelLine:
    """One curve with its label in the window's language; NaN is no value."""

    label: str
    time_s: FloatArray
    values: FloatArray


@dataclass(frozen=True)
class ChannelStrip:
    """One strip: name, unit, up to three curves, the least height of its axis, and whether it holds zero."""

    name: str
    unit: str
    lines: tuple[ChannelLine, ...]
    least: float
    from_zero: bool = False


@dataclass(frozen=True)
class ChannelPicture:
    """What the panel shows of a channel: strips, top first, and a sentence of the figures behind them."""

    strips: tuple[ChannelStrip, ...]
    figures: str


@dataclass(frozen=True)
class _Built:
    picture: ChannelPicture
    curves: tuple[tuple[Curve, ...], ...]


Load = Callable[[], ChannelPicture]


class ChannelView(StripsView):
    """The strips of one channel; they are worked out away from the window's thread."""

    ready = Signal(str)  # the figures
    failed = Signal(object)  # LeaklineError or OSError

    def __init__(self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(cursor, theme, parent)
        self.setAccessibleName(self.tr("Channel, raw and filtered"))
        self._built: _Built | None = None
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)
        self._loader.failed.connect(self._fail)

    @property
    def busy(self) -> bool:
        """Whether a picture is still to come."""
        return self._loader.busy

    def load(self, load: Load | None) -> None:
        """Show what ``load`` returns, once it has; None shows nothing. What is shown stays until then."""
        if load is None:
            self._loader.cancel()
            self._built = None
            self._set_strips(())
        else:
            self._loader.request(lambda: _build(load()))

    def stop(self) -> None:
        """Wait for the work in progress and drop it."""
        self._loader.stop()

    def _hint(self) -> str:
        return self.tr("Reading …") if self._loader.busy else self.tr("Nothing to show here: choose another channel")

    def _value_lines(self, strip: Strip) -> list[tuple[str, str]]:
        """Return each curve's label above its value: beside the narrow panel there is no room for both in one line."""
        plain = replace(strip, labels=())
        values = super()._value_lines(plain)
        lines = []
        for label, line in zip(strip.labels or ("",) * len(values), values, strict=True):
            lines += [(label, line[1]), line] if label else [line]
        return lines

    def _take(self, built: _Built) -> None:
        self._built = built
        self._arrange()
        self.ready.emit(built.picture.figures)

    def _fail(self, error: Exception) -> None:
        self._built = None
        self._set_strips(())
        self.failed.emit(error)

    def _arrange(self) -> None:
        if self._built is None:
            return
        theme = self._theme
        colours: Sequence[str] = (theme.curve, theme.curve_second, theme.curve_third)
        strips = []
        for of, curves in zip(self._built.picture.strips, self._built.curves, strict=True):
            pairs = tuple(zip(curves, colours, strict=False))
            labels = tuple(line.label for line in of.lines)
            strips.append(strip_of(of.name, of.unit, pairs, of.least, labels, from_zero=of.from_zero))
        self._set_strips(strips)


def _build(picture: ChannelPicture) -> _Built:
    return _Built(
        picture,
        tuple(
            tuple(Curve(EnvelopePyramid.build(line.time_s, line.values)) for line in strip.lines)
            for strip in picture.strips
        ),
    )
