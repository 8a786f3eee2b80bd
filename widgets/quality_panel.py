"""The quality plots beside the plan: one group of strips at a time over the common axis, or the sensors' own noise."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QLabel, QStackedWidget, QVBoxLayout, QWidget

from processing.survey import FloatArray
from widgets.allan_plot import AllanLines, AllanPlot
from widgets.curve_plot import Curve
from widgets.envelope import EnvelopePyramid
from widgets.latest_loader import LatestLoader
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.strips_view import Strip, StripsView, strip_of
from widgets.time_cursor import TimeCursor

NOISE = "noise"


@dataclass(frozen=True)
class QualityLine:
    """One curve of a strip with its label in the window's language."""

    label: str
    time_s: FloatArray
    values: FloatArray


@dataclass(frozen=True)
class QualityLines:
    """One strip: name, unit, up to three curves, the least height of its axis, and whether it holds zero.

    Of an ``interval`` the curves are the value, its lower and its upper end.
    """

    name: str
    unit: str
    lines: tuple[QualityLine, ...]
    least: float
    from_zero: bool = False
    interval: bool = False


@dataclass(frozen=True)
class _Built:
    """A strip's envelopes."""

    of: QualityLines
    curves: tuple[Curve, ...]


Load = Callable[[], Sequence[QualityLines]]
LoadNoise = Callable[[], tuple[Sequence[AllanLines], str]]


class QualityView(StripsView):
    """The strips of one group; they are worked out away from the window's thread."""

    ready = Signal()

    def __init__(self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(cursor, theme, parent)
        self.setAccessibleName(self.tr("Quality of the run"))
        self._built: tuple[_Built, ...] = ()
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)

    def load(self, load: Load | None) -> None:
        """Show what ``load`` returns, once it has; None shows nothing."""
        self._built = ()
        self._set_strips(())
        if load is None:
            self._loader.cancel()
        else:
            self._loader.request(lambda: tuple(_build(lines) for lines in load()))

    def stop(self) -> None:
        """Wait for the work in progress and drop it."""
        self._loader.stop()

    def _hint(self) -> str:
        return self.tr("Reading …") if self._loader.busy else self.tr("This run has nothing to show here")

    def _take(self, built: tuple[_Built, ...]) -> None:
        self._built = built
        self._arrange()
        self.ready.emit()

    def _arrange(self) -> None:
        theme = self._theme
        colours = (theme.curve, theme.curve_second, theme.curve_third)
        strips: list[Strip] = []
        for built in self._built:
            of, interval = built.of, built.of.interval
            order = (1, 2, 0) if interval else range(len(built.curves))  # the value lies over its interval's ends
            shades = (theme.curve, theme.band, theme.band) if interval else colours
            pairs = tuple((built.curves[k], shades[k]) for k in order)
            labels = tuple(of.lines[k].label for k in order)
            strips.append(
                strip_of(of.name, of.unit, pairs, of.least, labels, from_zero=of.from_zero, interval=interval)
            )
        self._set_strips(strips)


def _build(lines: QualityLines) -> _Built:
    return _Built(lines, tuple(Curve(EnvelopePyramid.build(line.time_s, line.values)) for line in lines.lines))


class QualityPanel(QWidget):
    """Choice of a group, its words, and its plot; ``group_chosen`` asks for the content."""

    group_chosen = Signal(str)

    def __init__(self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = QualityView(cursor, theme)
        self.noise = AllanPlot(theme)
        self._words: Mapping[str, str] = {}
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take_noise)
        self._choice = QuietCombo()
        self._choice.setObjectName("quality_group")
        self._choice.setAccessibleName(self.tr("What to show"))
        self._choice.setMinimumHeight(40)
        self._choice.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._choice.currentIndexChanged.connect(self._choose)
        self._hint = QLabel()
        self._hint.setWordWrap(True)
        self._hint.setTextFormat(Qt.TextFormat.PlainText)
        self._stack = QStackedWidget()
        self._stack.addWidget(self.view)
        self._stack.addWidget(self.noise)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._choice)
        layout.addWidget(self._hint)
        layout.addWidget(self._stack, 1)

    def set_groups(self, groups: Sequence[tuple[str, str, str]]) -> None:
        """Offer these: name, title, and what one sees there, in plain words."""
        self._words = {name: words for name, _, words in groups}
        self._choice.blockSignals(True)
        self._choice.clear()
        for name, title, _ in groups:
            self._choice.addItem(title, name)
        self._choice.blockSignals(False)
        self._choose()

    @property
    def group(self) -> str:
        """The chosen group."""
        return str(self._choice.currentData())

    def choose(self, group: str) -> None:
        """Choose a group."""
        self._choice.setCurrentIndex(max(0, self._choice.findData(group)))

    def show_strips(self, load: Load | None) -> None:
        """Show strips, worked out by ``load``."""
        self._stack.setCurrentWidget(self.view)
        self.view.load(load)

    def show_noise(self, load: LoadNoise | None) -> None:
        """Show the sensors' noise, worked out by ``load``."""
        self._stack.setCurrentWidget(self.noise)
        self.noise.set_lines((), self.tr("Reading …") if load is not None else "")
        if load is not None:
            self._loader.request(load)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.view.apply_theme(theme)
        self.noise.apply_theme(theme)

    def stop(self) -> None:
        """Wait for the work in progress and drop it."""
        self.view.stop()
        self._loader.stop()

    def _choose(self) -> None:
        self._hint.setText(self._words.get(self.group, ""))
        self.group_chosen.emit(self.group)

    def _take_noise(self, found: tuple[Sequence[AllanLines], str]) -> None:
        self.noise.set_lines(*found)
