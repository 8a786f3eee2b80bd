"""What the plots are made of with pyqtgraph: the canvas they stand on, curves as exact pictures, and painted items.

Qt strokes thick noisy lines slowly (most of a second for an hour of noise); a curve is therefore an image item with the
part of each pixel that it covers. Images are turned into the screen's own format once: Qt would do it at each painting,
in a pool of threads that it waits for. Mouse and keys pass through the canvas to the widget that owns it.
"""

from collections.abc import Callable
from enum import Enum
from functools import lru_cache

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPicture, QPixmap
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
        for action in self.scene().contextMenu:  # pyqtgraph's own export, in English and never shown
            action.setText("")

    def paintEvent(self, event: QPaintEvent) -> None:
        """Bring the items up to date and paint them."""
        try:
            self._prepare()
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()
        super().paintEvent(event)


class KeptCanvas(PlotCanvas):
    """A canvas whose scene is painted into a picture of its own; the owner lays it down, and paints over it."""

    def __init__(self, parent: QWidget, prepare: Callable[[], None], lay_down: Callable[[QPainter], None]) -> None:
        super().__init__(parent, prepare)
        self._lay_down = lay_down

    def picture(self) -> QPixmap:
        """Return the scene as it is now, in device pixels."""
        ratio = self.viewport().devicePixelRatioF()
        size = (QSizeF(self.viewport().size()) * ratio).toSize()
        kept = QPixmap(max(1, size.width()), max(1, size.height()))
        kept.setDevicePixelRatio(ratio)
        painter = QPainter(kept)
        try:
            self.render(painter, QRectF(self.viewport().rect()), self.viewport().rect())
        finally:
            painter.end()
        return kept

    def paintEvent(self, event: QPaintEvent) -> None:
        """Let the owner paint."""
        del event
        painter = QPainter(self.viewport())
        try:
            self._lay_down(painter)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()
        finally:
            painter.end()


class Keep(Enum):
    """What of a painting is kept until it is to be renewed."""

    NOTHING = 0
    STROKES = 1  # replayed; dear for pictures, which Qt packs when it records them
    PIXELS = 2  # laid down


class PaintedItem(pg.GraphicsObject):  # type: ignore[misc]  # pyqtgraph has no types
    """An item that a function paints in the widget's pixels, in whatever units its parent counts."""

    def __init__(self, parent: QGraphicsItem | None, paint: Callable[[QPainter], None], z: float, keep: Keep) -> None:
        super().__init__(parent)
        self._paint, self._keep = paint, keep
        self._kept: QPicture | QPixmap | None = None
        self._area = self._pixels = QRectF()
        self.setZValue(z)

    def renew(self, area: QRectF, pixels: QRectF | None = None) -> None:
        """Have it painted anew, within an area (in the parent's units), which is that of ``pixels`` of the widget."""
        if area != self._area:
            self.prepareGeometryChange()
            self._area = area
        self._pixels = area if pixels is None else pixels
        self._kept = None
        self.update()

    def boundingRect(self) -> QRectF:
        """Return the area within which it paints."""
        return self._area

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        """Paint, or show what was painted."""
        del option, widget
        try:
            painter.resetTransform()
            if self._keep is Keep.NOTHING:
                self._paint(painter)
                return
            if self._kept is None:
                self._kept = self._recorded(painter.device().devicePixelRatioF())
            if isinstance(self._kept, QPixmap):
                painter.drawPixmap(self._pixels.topLeft(), self._kept)
            else:
                self._kept.play(painter)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()

    def _recorded(self, pixel_ratio: float) -> QPicture | QPixmap:
        if self._keep is Keep.STROKES:
            kept: QPicture | QPixmap = QPicture()
        else:
            size = (self._pixels.size() * pixel_ratio).toSize()
            kept = QPixmap(max(1, size.width()), max(1, size.height()))
            kept.setDevicePixelRatio(pixel_ratio)
            kept.fill(Qt.GlobalColor.transparent)
        painter = QPainter(kept)
        try:
            if self._keep is Keep.PIXELS:
                painter.translate(-self._pixels.topLeft())
            self._paint(painter)
        finally:
            painter.end()
        return kept


class PictureItem(pg.ImageItem):  # type: ignore[misc]  # pyqtgraph has no types
    """An image of numbers 0..255 with rows from the top, each number with its colour, between two corners."""

    def __init__(self) -> None:
        super().__init__(axisOrder="row-major", autoDownsample=False)
        self._colours: list[int] = []

    def show_picture(self, numbers: np.ndarray, colours: list[int], area: QRectF) -> None:
        """Show numbers (rows, columns) in 256 ``colours`` (0xaarrggbb); ``area`` begins at the upper left corner.

        Values grow upwards in a view box, so the height of ``area`` is negative.
        """
        self.setVisible(numbers.size > 0)
        if numbers.size:
            # what pyqtgraph's setImage would do, without telling the view box and everyone who might listen
            self.prepareGeometryChange()
            self._colours, self.image = colours, np.ascontiguousarray(numbers)
            self._renderRequired = True
            self.setRect(area)
            self.update()

    def render(self) -> None:
        """Make the image that is laid down; pyqtgraph would walk through the colours one by one."""
        rows, columns = self.image.shape
        numbers = QImage(self.image.data, columns, rows, columns, QImage.Format.Format_Indexed8)
        numbers.setColorTable(self._colours)
        self.qimage = numbers.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)
        self._renderRequired = self._unrenderable = False

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        """Lay the picture down; in the widget's pixels, where Qt need not stretch what has the right size already."""
        del option, widget
        try:
            place = painter.worldTransform().mapRect(self.boundingRect())
            # to a part of a pixel that nobody sees, so that rounding does not ask for stretching
            left, top, width, height = (round(v, 3) for v in (place.left(), place.top(), place.width(), place.height()))
            if self._renderRequired:
                self.render()
            painter.resetTransform()
            if (width, height) == (self.qimage.width(), self.qimage.height()):
                painter.drawImage(QPointF(left, top), self.qimage)
            else:
                painter.drawImage(QRectF(left, top, width, height), self.qimage)
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


def shades(colour: QColor) -> list[int]:
    """Return a colour in 256 steps of opacity, 0xaarrggbb."""
    return _shades(colour.rgba())


@lru_cache(maxsize=32)
def _shades(rgba: int) -> list[int]:
    opacity = np.arange(256, dtype=np.uint32) * np.uint32(rgba >> 24) // np.uint32(255)
    table: list[int] = ((opacity << np.uint32(24)) | np.uint32(rgba & 0xFFFFFF)).tolist()
    return table


def view_box() -> pg.ViewBox:
    """Return a view box that shows just the range it is told and leaves the mouse to the widget."""
    box = pg.ViewBox(enableMouse=False, enableMenu=False, defaultPadding=0.0)
    box.disableAutoRange()
    box.setMinimumSize(1.0, 1.0)
    return box


def plot_item(**axes: pg.AxisItem) -> pg.PlotItem:
    """Return a plot item with just these axes (``left``, ``bottom``), without menu and buttons."""
    plot = pg.PlotItem(viewBox=view_box(), axisItems=axes, enableMenu=False)
    plot.hideButtons()
    for side in {"left", "bottom", "top", "right"} - axes.keys():
        plot.hideAxis(side)
        plot.getAxis(side).unlinkFromView()  # else it follows every range, unseen
    return plot
