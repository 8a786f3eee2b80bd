"""Strokes that several plots share: how much of each pixel a curve covers, hatching, boxed labels, number tags."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen, QPixmap

from processing.survey import FloatArray
from widgets.plot_theme import Theme

Edges = tuple[float, float, float, float]  # left, top, right, bottom


def coverage(top: FloatArray, bottom: FloatArray, rows: int) -> tuple[npt.NDArray[np.uint8], int]:
    """Return how much of each pixel lies between ``top`` and ``bottom`` (pixels, top < bottom), 0..255, and where.

    The picture (at most ``rows``, columns) holds only the rows that are touched, from the second result on. This draws
    a curve of any roughness in the same small time, where Qt's stroker takes most of a second for thick noise.
    """
    good = np.isfinite(top) & np.isfinite(bottom)
    if rows < 1 or not np.any(good):
        return np.zeros((0, len(top)), dtype=np.uint8), 0
    first = int(np.clip(np.floor(np.min(top[good])), 0, rows))
    last = int(np.clip(np.ceil(np.max(bottom[good])), first, rows))
    grid = np.arange(first, last, dtype=np.float32)[:, None]
    upper = np.where(good, top, rows + 1.0).astype(np.float32)
    lower = np.where(good, bottom, -1.0).astype(np.float32)
    part = np.minimum(grid + np.float32(1.0), lower)
    part -= np.maximum(grid, upper)
    np.clip(part, 0.0, 1.0, out=part)
    part *= 255.0
    return part.astype(np.uint8), first


def paint_hatch(painter: QPainter, rect: QRectF, theme: Theme) -> None:
    """Hatch what is not assessed: a veil of the canvas, and strokes that show on any ground."""
    veil = QColor(theme.canvas)
    veil.setAlpha(150)
    painter.fillRect(rect, veil)
    strokes = QColor(theme.not_assessed)
    strokes.setAlpha(200)
    painter.fillRect(rect, QBrush(strokes, Qt.BrushStyle.BDiagPattern))


def paint_tag(painter: QPainter, theme: Theme, text: str, box: QRectF, *, strong: bool = False) -> None:
    """Write ``text`` into ``box`` on a ground that keeps it readable over anything."""
    ground = QColor(theme.canvas)
    ground.setAlpha(225)
    painter.setPen(QPen(QColor(theme.cursor if strong else theme.grid), 1))
    painter.setBrush(ground)
    painter.drawRoundedRect(box, 3, 3)
    painter.setPen(QColor(theme.text))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def lay_elsewhere(painter: QPainter, picture: QPixmap, rect: QRectF, ends: tuple[float, float], theme: Theme) -> None:
    """Lay down the picture of a whole plot whose data, drawn in ``rect``, now reach between the pixels ``ends``.

    The axes up and down stay where they are; what the picture does not hold is left empty.
    """
    ratio, end = picture.devicePixelRatio(), rect.right() + 1
    width, height = picture.width() / ratio, picture.height() / ratio
    painter.drawPixmap(QPointF(0.0, 0.0), picture, QRectF(0.0, 0.0, rect.left() * ratio, height * ratio))
    values = QRectF(end * ratio, 0.0, (width - end) * ratio, height * ratio)
    painter.drawPixmap(QPointF(end, 0.0), picture, values)
    left, right = ends
    if abs((right - left) - rect.width()) < 0.5 / ratio:  # only shifted: no pixel need be stretched
        left = rect.left() + round((left - rect.left()) * ratio) / ratio
        right = left + rect.width()
    scale = (right - left) / rect.width()
    first, last = max(left, rect.left()), min(right, rect.right())
    ground, canvas = QColor(theme.background), QColor(theme.canvas)
    painter.fillRect(QRectF(0.0, rect.bottom() + 1, rect.left(), height), ground)
    for start, stop in ((rect.left(), min(first, end)), (max(last, rect.left()), end)):
        painter.fillRect(QRectF(start, 0.0, stop - start, height), ground)
        painter.fillRect(QRectF(start, rect.top(), stop - start, rect.height()), canvas)
    if last - first >= 1.0:
        source = QRectF(rect.left() + (first - left) / scale, 0.0, (last - first) / scale, height)
        source = QRectF(source.topLeft() * ratio, source.size() * ratio)
        painter.drawPixmap(QRectF(first, 0.0, last - first, height), picture, source)


def free_box(
    width: float, height: float, about: QPointF, away: float, taken: Sequence[Edges], within: QRectF
) -> QRectF | None:
    """Return a box of this size beside ``about`` that overlaps nothing ``taken`` and stays ``within``, or None.

    Plain numbers: it is called for each name of a moving map, and most of what is taken is far away.
    """
    x, y, part = about.x(), about.y(), 0.7 * away
    reach_x, reach_y = width + away, height + away
    near = [
        box
        for box in taken
        if box[0] < x + reach_x and box[2] > x - reach_x and box[1] < y + reach_y and box[3] > y - reach_y
    ]
    corners = (
        (x + away, y - height / 2),
        (x - width / 2, y - away - height),
        (x - width / 2, y + away),
        (x - away - width, y - height / 2),
        (x + part, y - part - height),
        (x + part, y + part),
        (x - part - width, y - part - height),
        (x - part - width, y + part),
    )
    room = edges_of(within)
    for left, top in corners:
        right, bottom = left + width, top + height
        inside = left >= room[0] and top >= room[1] and right <= room[2] and bottom <= room[3]
        if inside and all(b[0] >= right or b[2] <= left or b[1] >= bottom or b[3] <= top for b in near):
            return QRectF(left, top, width, height)
    return None


def edges_of(box: QRectF) -> Edges:
    """Return left, top, right and bottom, as :func:`free_box` takes them."""
    return box.left(), box.top(), box.right(), box.bottom()


def legend_box(rect: QRectF, theme: Theme, entries: Sequence[tuple[str, str]]) -> QRectF:
    """Return where a legend stands in a plot: in its upper left corner."""
    metrics = theme.metrics()
    gap = metrics.horizontalAdvance("  ")
    width = sum(metrics.horizontalAdvance(name) + gap for name, _ in entries) + gap
    return QRectF(rect.left() + 2, rect.top() + 2, width, metrics.height() + 2)


def paint_legend(
    painter: QPainter, rect: QRectF, theme: Theme, entries: Sequence[tuple[str, str]], below: float = 0.0
) -> None:
    """Write names, each in its colour, side by side into the upper left corner of a plot, or so much ``below`` it."""
    metrics = theme.metrics()
    gap, box = metrics.horizontalAdvance("  "), legend_box(rect, theme, entries).translated(0.0, below)
    if box.width() > rect.width() or rect.height() < 2.5 * metrics.height():
        return
    ground = QColor(theme.canvas)
    ground.setAlpha(215)
    painter.fillRect(box, ground)
    x = box.left() + gap
    for name, colour in entries:
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x, box.top() + metrics.ascent()), name)
        x += metrics.horizontalAdvance(name) + gap
