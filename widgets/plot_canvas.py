"""What the plots are made of with pyqtgraph: the canvas they stand on, curves as exact pictures, and painted items.

Qt strokes thick noisy lines slowly (most of a second for an hour of noise); a curve is therefore an image item with the
part of each pixel that it covers. Mouse and keys pass through the canvas to the widget that owns it.
"""

from collections.abc import Callable

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPicture
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene, QStyleOptionGraphicsItem, QWidget

from processing.survey import FloatArray
from widgets.plot_marks import report_paint_error
from widgets.plot_paint import coverage
from widgets.plot_scale import Scale


class PlotCanvas(pg.GraphicsView):  # type: ignore[misc]  # pyqtgraph has no types
    """A scene that fills its parent; ``prepare`` is called before each painting and brings the items up to date.

    Items may therefore be as lazy as the widget wishes: what is seen is painted again only when the widget asks for it.
    """

    def __init__(self, parent: QWidget, prepare: Callable[[], None]) -> None:
        super().__init__(parent, background=None)
        self._prepare = prepare
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.viewport().setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setCacheMode(self.CacheModeFlag.CacheNone)
        self.setViewportUpdateMode(self.ViewportUpdateMode.NoViewportUpdate)
        self.scene().setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Bring the items up to date and paint them."""
        try:
            self._prepare()
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()
        super().paintEvent(event)


class PaintedItem(pg.GraphicsObject):  # type: ignore[misc]  # pyqtgraph has no types
    """An item in the widget's pixels that a function paints; a kept one is painted once and replayed until renewed."""

    def __init__(self, parent: QGraphicsItem, paint: Callable[[QPainter], None], z: float, *, kept: bool) -> None:
        super().__init__(parent)
        self._paint, self._kept = paint, kept
        self._picture: QPicture | None = None
        self._area = QRectF()
        self.setZValue(z)

    def renew(self, area: QRectF) -> None:
        """Have it painted anew, within an area."""
        if area != self._area:
            self.prepareGeometryChange()
            self._area = area
        self._picture = None
        self.update()

    def boundingRect(self) -> QRectF:
        """Return the area within which it paints."""
        return self._area

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        """Paint, or replay what was painted."""
        del option, widget
        try:
            if not self._kept:
                self._paint(painter)
                return
            if self._picture is None:
                self._picture = self._recorded()
            self._picture.play(painter)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()

    def _recorded(self) -> QPicture:
        picture = QPicture()
        painter = QPainter(picture)
        try:
            self._paint(painter)
        finally:
            painter.end()
        return picture


class PictureItem(pg.ImageItem):  # type: ignore[misc]  # pyqtgraph has no types
    """An image of numbers 0..255 with rows from the top, each number with its colour, between two corners."""

    def __init__(self) -> None:
        super().__init__(axisOrder="row-major", autoDownsample=False)

    def show_picture(self, numbers: np.ndarray, colours: np.ndarray, area: QRectF) -> None:
        """Show numbers (rows, columns) in ``colours`` (256, 3 or 4); ``area`` begins at the upper left corner.

        Values grow upwards in a view box, so the height of ``area`` is negative.
        """
        self.setVisible(numbers.size > 0)
        if numbers.size:
            self.setImage(np.ascontiguousarray(numbers), autoLevels=False, levels=None, lut=colours)
            self.setRect(area)

    def paint(self, painter: QPainter, *arguments: object) -> None:
        """Lay the picture down."""
        try:
            super().paint(painter, *arguments)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()


class ColumnsItem(PictureItem):
    """A curve or a band as one pair of values a device pixel column; any roughness costs the same small time."""

    def show_columns(
        self,
        low: FloatArray,
        high: FloatArray,
        x_span: tuple[float, float],
        scale: Scale,
        rows: int,
        colour: QColor,
        thickness: float = 0.0,
    ) -> None:
        """Fill between ``low`` and ``high`` (n values of ``scale``, which is linear) over ``rows`` device pixels.

        ``thickness`` device pixels are added for a curve; 0 is for bands. NaN leaves a hole.
        """
        top = (1.0 - scale.fraction(high)) * rows - 0.5 * thickness
        bottom = (1.0 - scale.fraction(low)) * rows + 0.5 * thickness
        picture, first = coverage(np.clip(top, -10.0, rows + 10.0), np.clip(bottom, -10.0, rows + 10.0), rows)
        per_row = (scale.high - scale.low) / max(rows, 1)
        upper, width = scale.high - first * per_row, x_span[1] - x_span[0]
        self.show_picture(picture, shades(colour), QRectF(x_span[0], upper, width, -len(picture) * per_row))


def shades(colour: QColor) -> np.ndarray:
    """Return a colour (256, 4) in steps of opacity."""
    table = np.empty((256, 4), dtype=np.uint8)
    table[:, :3] = colour.red(), colour.green(), colour.blue()
    table[:, 3] = np.arange(256) * colour.alpha() // 255
    return table
