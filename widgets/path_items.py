"""The lines of the plan view as pyqtgraph items: the pipe of the map, the path, what is in view and in doubt."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pyqtgraph as pg
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from processing.survey import Channel, FloatArray, Stretch
from widgets.plan_geometry import PlanScale, ThinnedPath, visible_runs
from widgets.plot_marks import report_paint_error
from widgets.plot_theme import Theme

BAND_Z = 1.0


class PathItem(pg.PlotCurveItem):  # type: ignore[misc]  # pyqtgraph has no types
    """A smooth line through places in metres, as wide on the screen at any zoom; some of its points reach to the next.

    It is meant for lines that have been thinned; noise belongs into a :class:`ColumnsItem`.
    """

    def __init__(self) -> None:
        super().__init__(antialias=True)
        # a moving cursor would have Qt stroke the whole line for the few pixels under it
        self.setCacheMode(self.CacheMode.DeviceCoordinateCache)

    def show_line(
        self, plane_m: FloatArray, reaches: npt.NDArray[np.bool_], colour: str, width: float, *, alpha: int = 255
    ) -> None:
        """Draw from each point (n, 2) that ``reaches`` (n,) on to the next."""
        self.setVisible(bool(np.any(reaches)))
        shade = QColor(colour)
        shade.setAlpha(alpha)
        pen = QPen(shade, width, self._style(), Qt.PenCapStyle.FlatCap, Qt.PenJoinStyle.BevelJoin)
        pen.setCosmetic(True)
        self.setData(plane_m[:, 0], plane_m[:, 1], connect=reaches.astype(np.int32), pen=pen)

    def _style(self) -> Qt.PenStyle:
        return Qt.PenStyle.SolidLine

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        """Draw the line."""
        try:
            super().paint(painter, option, widget)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()


class DottedPathItem(PathItem):
    """The same, dotted."""

    def _style(self) -> Qt.PenStyle:
        return Qt.PenStyle.DotLine


class PathLines:
    """The lines in a view box that counts metres; between the map's pipe and the path is room for the interval."""

    def __init__(self, box: pg.ViewBox) -> None:
        self.shown_times: list[FloatArray] = []  # moments (n,) of each stretch of the path that is in view
        self._near = (np.empty((0, 2)), np.empty(0), np.empty(0, dtype=bool))  # places, moments, what reaches on
        self._route, self._range, self._line, self._doubtful = PathItem(), PathItem(), PathItem(), DottedPathItem()
        lines = ((BAND_Z - 1, self._route), (BAND_Z + 1, self._range), (BAND_Z + 2, self._line))
        for z, item in (*lines, (BAND_Z + 3, self._doubtful)):
            item.setZValue(z)
            box.addItem(item, ignoreBounds=True)

    def show_route(self, route_m: FloatArray, scale: PlanScale, theme: Theme) -> None:
        """Show the pipe as the map has it (n, 2)."""
        reaches, _ = _in_view(route_m, scale, 20.0)
        self._route.show_line(route_m, reaches, theme.route, 5.0 * theme.line_width, alpha=110)

    def show_path(
        self,
        path: ThinnedPath | None,
        scale: PlanScale,
        theme: Theme,
        range_s: tuple[float, float],
        stretches: Sequence[Stretch],
    ) -> None:
        """Show the path, dotted where it or the sound is not assessed, and broad between the moments ``range_s``."""
        plane, times = np.empty((0, 2)), np.empty(0)
        if path is not None:
            rows = path.rows_for(1.0 / scale.pixels_per_m)
            plane, times = path.plane_m[rows], path.time_s[rows]
        reaches, shown = _in_view(plane, scale, 40.0)
        self.shown_times = [times[part] for part in shown]
        # what is far outside is left out altogether
        near = np.concatenate([np.arange(len(times))[part] for part in shown] or [np.empty(0, dtype=np.intp)])
        plane, times, reaches = plane[near], times[near], reaches[near]
        self._near = (plane, times, reaches)
        assessed = np.ones(len(times), dtype=bool)
        for stretch in stretches:
            if stretch.channel in (Channel.PATH, Channel.SOUND):
                assessed &= ~((times >= stretch.start_s) & (times <= stretch.end_s))
        width = 1.6 * theme.line_width
        self.show_range(range_s, theme)
        self._line.show_line(plane, reaches & assessed, theme.curve, width)
        self._doubtful.show_line(plane, reaches & ~assessed, theme.not_assessed, width)

    def show_range(self, range_s: tuple[float, float], theme: Theme) -> None:
        """Show broad what of the path lies between two moments; all else stays as it was drawn."""
        plane, times, reaches = self._near
        in_range = (times >= range_s[0]) & (times <= range_s[1])
        width = 6.4 * theme.line_width
        self._range.show_line(plane, reaches & in_range & ~np.all(in_range), theme.accent, width, alpha=70)


def _in_view(plane_m: FloatArray, scale: PlanScale, margin: float) -> tuple[npt.NDArray[np.bool_], list[slice]]:
    """Return which points of a line (n, 2) reach to the next within the picture, and its stretches there."""
    reaches = np.zeros(len(plane_m), dtype=bool)
    shown = visible_runs(scale.pixels(plane_m), scale.size, margin)
    for first, last in shown:
        reaches[first : last - 1] = True
    return reaches, [slice(first, last) for first, last in shown]
