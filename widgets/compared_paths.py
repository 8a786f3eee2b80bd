"""Free paths of several methods on the plan, each in its own colour and dash, named at its end."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap

from processing.survey import FloatArray
from widgets.path_items import BAND_Z, PathItem
from widgets.path_paint import Labels
from widgets.plan_geometry import PlanScale, visible_runs
from widgets.plot_theme import Theme

# told apart by the colour-blind (after Okabe and Ito 2008); what comes round again has another dash
COLOURS = ("#d55e00", "#007a5a", "#a0469b", "#b08900", "#3b6fd4", "#7a4a1e")
DASHES = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine)
WIDTH, LIFTED_WIDTH = 1.3, 3.0
LIFTED_Z = 5.0  # over the path, under the marks


@dataclass(frozen=True)
class ComparedPath:
    """A named path (n, 2), local east and north; ``style`` numbers its colour and dash."""

    name: str
    plane_m: FloatArray
    style: int


def colour_of(style: int) -> str:
    """Return the colour of a style."""
    return COLOURS[style % len(COLOURS)]


def dash_of(style: int) -> Qt.PenStyle:
    """Return the dash of a style."""
    return DASHES[style // len(COLOURS) % len(DASHES)]


def swatch(style: int, width: int = 28, height: int = 16) -> QIcon:
    """Return a short piece of the line, for a list."""
    pixmap = QPixmap(width, height)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setPen(QPen(QColor(colour_of(style)), 3.5, dash_of(style)))
    painter.drawLine(1, height // 2, width - 1, height // 2)
    painter.end()
    return QIcon(pixmap)


class _ComparedItem(PathItem):
    def __init__(self, style: int) -> None:
        super().__init__()
        self._dash = dash_of(style)

    def _style(self) -> Qt.PenStyle:
        return self._dash


class ComparedLines:
    """The lines of compared paths in a view box that counts metres, below the path itself."""

    def __init__(self, box: pg.ViewBox) -> None:
        self._box = box
        self._paths: tuple[ComparedPath, ...] = ()
        self._items: list[_ComparedItem] = []
        self._visible, self._lifted = True, -1

    def set_paths(self, paths: Sequence[ComparedPath]) -> None:
        """Show these from the next :meth:`show` on."""
        for item in self._items:
            self._box.removeItem(item)
        self._paths = tuple(paths)
        self._items = [_ComparedItem(path.style) for path in paths]
        for item in self._items:
            self._box.addItem(item, ignoreBounds=True)
        self._arrange()

    def set_visible(self, visible: bool) -> None:
        """Show or hide all of them."""
        self._visible = visible
        self._arrange()

    def lift(self, style: int) -> None:
        """Draw the path of this style thick, above all others and above the path itself; -1 lifts none."""
        self._lifted = style
        self._arrange()

    def _arrange(self) -> None:
        for path, item in zip(self._paths, self._items, strict=True):
            item.setVisible(self._visible)
            item.setZValue(LIFTED_Z if path.style == self._lifted else BAND_Z + 0.5)

    @property
    def _shown(self) -> tuple[ComparedPath, ...]:
        """The paths in view, the lifted one first: it is named while there is room."""
        return tuple(sorted(self._paths, key=lambda p: p.style != self._lifted)) if self._visible else ()

    def show(self, scale: PlanScale, theme: Theme) -> None:
        """Lay the lines down for this scale."""
        for path, item in zip(self._paths, self._items, strict=True):
            if not self._visible:
                continue
            reaches = np.zeros(len(path.plane_m), dtype=bool)
            for first, last in visible_runs(scale.pixels(path.plane_m), scale.size, 20.0):
                reaches[first : last - 1] = True
            width = LIFTED_WIDTH if path.style == self._lifted else WIDTH
            item.show_line(path.plane_m, reaches, colour_of(path.style), width * theme.line_width)

    def paint_names(self, painter: QPainter, labels: Labels, scale: PlanScale, theme: Theme) -> None:
        """Mark each path's end, and write its name there."""
        for path in self._shown:
            if len(path.plane_m) == 0:
                continue
            end = QPointF(*scale.pixel(float(path.plane_m[-1, 0]), float(path.plane_m[-1, 1])))
            painter.setPen(QPen(QColor(theme.outline), 1.0))
            painter.setBrush(QColor(colour_of(path.style)))
            painter.drawEllipse(end, 5.0, 5.0)
            labels.write(path.name, end, 8.0, strong=path.style == self._lifted)

    @property
    def places(self) -> FloatArray:
        """All points (n, 2), for a view that shall hold everything."""
        return np.concatenate([*(path.plane_m[:, :2] for path in self._shown), np.empty((0, 2))])
