"""The grid of the gallery: candidates as little pictures, chosen by arrows or touch, read when they come into view.

Each cell is painted once and laid down often, so that a grid of hundreds scrolls as one of ten does.
"""

from collections import OrderedDict
from collections.abc import Sequence

from PySide6.QtCore import QEvent, QPoint, QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPixmap, QResizeEvent
from PySide6.QtWidgets import QWidget

from widgets.candidate_row import CandidateRow
from widgets.gallery_cells import WIDTHS, CellShape, cell_text, paint_cell
from widgets.gallery_pictures import GallerySound, KeptPictures, curve_top_db
from widgets.latest_loader import LatestLoader
from widgets.painted_widget import PaintedWidget
from widgets.plot_theme import Theme
from widgets.spectrogram_picture import PictureKey
from widgets.tile_source import Levels

GAP = 10
READ_AT_ONCE = 6
KEPT_CELLS = 96
_KEYS = Qt.Key
OWN_KEYS = frozenset({
    _KEYS.Key_Left, _KEYS.Key_Right, _KEYS.Key_Up, _KEYS.Key_Down, _KEYS.Key_Return, _KEYS.Key_Enter, _KEYS.Key_Z,
    _KEYS.Key_X, _KEYS.Key_Home, _KEYS.Key_End, _KEYS.Key_PageUp, _KEYS.Key_PageDown,
})  # fmt: skip


class GalleryGrid(PaintedWidget):
    """Signals out; it decides nothing. The pictures are read by a worker, those in view first."""

    candidate_chosen = Signal(int)
    candidate_opened = Signal(int)
    width_changed = Signal(int)  # of the cells: an index of WIDTHS
    reveal_asked = Signal(QRect)
    read_failed = Signal(object)  # LeaklineError or OSError

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Gallery of the candidates"))
        self._theme = theme
        self._rows: tuple[CandidateRow, ...] = ()
        self._places: dict[int, int] = {}
        self._selected: int | None = None
        self._sound: GallerySound | None = None
        self._top_db = 12.0
        self._width_index = 1
        self._shape = CellShape.of(WIDTHS[1], theme)
        self._pictures = KeptPictures()
        self._cells: OrderedDict[int, tuple[CandidateRow, QPixmap]] = OrderedDict()
        self._exposed = QRect()
        self._failed = False
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)
        self._loader.failed.connect(self._on_failed)
        self._asking = QTimer(self)
        self._asking.setSingleShot(True)
        self._asking.timeout.connect(self._ask)

    # --- what it is told ----------------------------------------------------------------------------------------

    def set_rows(self, rows: Sequence[CandidateRow]) -> None:
        """Show these candidates, in this order."""
        rows = tuple(rows)
        if rows == self._rows:
            return
        moved = [r.candidate.id for r in rows] != [r.candidate.id for r in self._rows]
        self._rows = rows
        self._places = {row.candidate.id: place for place, row in enumerate(rows)}
        if moved:
            self._measure()
            self._lay_out()
        self._describe()
        self.update()

    def set_sound(self, sound: GallerySound | None) -> None:
        """Read the pictures from this sound; None shows none. Waits for a read in work."""
        if sound is None or self._sound is None or sound.version != self._sound.version:
            self.stop()
            self._pictures.clear()
        self._sound, self._failed = sound, False
        self._measure()
        self._forget_cells()

    def set_selected(self, candidate_id: int | None) -> None:
        """Put the frame around a candidate and bring it into view."""
        if candidate_id != self._selected:
            for one in (self._selected, candidate_id):
                self._update_cell(one)
            self._selected = candidate_id
        self._describe()
        self.reveal()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.set_width_index(self._width_index)

    def set_width_index(self, index: int) -> None:
        """Make the cells so large: an index of :data:`~widgets.gallery_cells.WIDTHS`, the ends being the ends."""
        index = min(max(index, 0), len(WIDTHS) - 1)
        changed = index != self._width_index
        self._width_index = index
        self._shape = CellShape.of(WIDTHS[index], self._theme)
        self._forget_cells()
        self._lay_out()
        self.reveal()
        if changed:
            self.width_changed.emit(index)

    def stop(self) -> None:
        """Read nothing more, and wait for the read in work: call before the survey's files are closed."""
        self._asking.stop()
        self._loader.stop()

    @property
    def width_index(self) -> int:
        """How large the cells are."""
        return self._width_index

    @property
    def cells_across(self) -> int:
        """How many cells stand side by side."""
        return self._across(self.width())

    def _across(self, width: int) -> int:
        return max(1, (width - GAP) // (self._shape.size.width() + GAP))

    def height_for(self, width: int) -> int:
        """Return how high all cells stand in so many pixels of width."""
        return GAP + -(-len(self._rows) // self._across(width)) * (self._shape.size.height() + GAP)

    @property
    def all_read(self) -> bool:
        """Whether the pictures of all candidates in view are there."""
        return not self._missing(self._in_view())

    @property
    def kept_bytes(self) -> int:
        """What the pictures and the painted cells take in memory."""
        cells = sum(pixmap.width() * pixmap.height() * 4 for _row, pixmap in self._cells.values())
        return self._pictures.size_bytes + cells

    def reveal(self) -> None:
        """Bring the selected candidate into view."""
        place = self._places.get(self._selected) if self._selected is not None else None
        if place is not None:
            self.reveal_asked.emit(self.cell_rect(place).adjusted(-GAP, -GAP, GAP, GAP))

    def step(self, across: int, down: int) -> None:
        """Choose a neighbour, the ends being the ends."""
        if not self._rows:
            return
        at = self._places.get(self._selected) if self._selected is not None else None
        if at is None:
            self._choose(0)
            return
        wanted = at + across + down * self.cells_across
        if down and not 0 <= wanted < len(self._rows):
            wanted = at if down < 0 or at // self.cells_across == (len(self._rows) - 1) // self.cells_across else (
                len(self._rows) - 1
            )  # fmt: skip
        self._choose(min(max(wanted, 0), len(self._rows) - 1))

    # --- geometry -----------------------------------------------------------------------------------------------

    def cell_rect(self, place: int) -> QRect:
        """Return where the cell of a place in the order stands."""
        down, across = divmod(place, self.cells_across)
        size = self._shape.size
        return QRect(QPoint(GAP + across * (size.width() + GAP), GAP + down * (size.height() + GAP)), size)

    def cell_at(self, point: QPoint) -> int | None:
        """Return the place in the order of the cell at a point; None between cells."""
        size = self._shape.size
        across, down = (point.x() - GAP) // (size.width() + GAP), (point.y() - GAP) // (size.height() + GAP)
        place = down * self.cells_across + across
        inside = 0 <= across < self.cells_across and 0 <= place < len(self._rows)
        return place if inside and self.cell_rect(place).contains(point) else None

    def sizeHint(self) -> QSize:
        """Qt: as high as all cells need at this width."""
        return QSize(self._shape.size.width() + 2 * GAP, self.height_for(self.width()))

    def _measure(self) -> None:
        """Let the level curves of all candidates have one scale."""
        sound, before = self._sound, self._top_db
        self._top_db = 12.0 if sound is None else curve_top_db(sound, [row.candidate for row in self._rows])
        if self._top_db != before:
            self._forget_cells()

    def _lay_out(self) -> None:
        self.setMinimumHeight(self.sizeHint().height())
        self.setMinimumWidth(self._shape.size.width() + 2 * GAP)
        self.updateGeometry()
        self.update()

    def _in_view(self, *, beside: bool = False) -> range:
        """Return the places in view; with ``beside`` also a screen above and below."""
        seen = self.visibleRegion().boundingRect()
        if seen.isEmpty():
            return range(0)
        if beside:
            seen = seen.adjusted(0, -seen.height(), 0, seen.height())
        return self._places_in(seen)

    def _places_in(self, area: QRect) -> range:
        step = self._shape.size.height() + GAP
        first = max(0, (area.top() - GAP) // step) * self.cells_across
        last = (max(0, area.bottom()) // step + 1) * self.cells_across
        return range(min(first, len(self._rows)), min(last, len(self._rows)))

    # --- pictures -----------------------------------------------------------------------------------------------

    def _key(self, row: CandidateRow) -> PictureKey | None:
        ratio, rect = self.devicePixelRatioF(), self._shape.picture
        if self._sound is None:
            return None
        return self._sound.key(row.candidate, round(rect.width() * ratio), round(rect.height() * ratio))

    def _missing(self, places: range) -> list[PictureKey]:
        keys = [self._key(self._rows[place]) for place in places]
        return [key for key in keys if key is not None and key not in self._pictures]

    def _ask(self) -> None:
        if self._sound is None or self._failed or self._loader.busy:
            return
        missing = self._missing(self._in_view()) or self._missing(self._in_view(beside=True))
        if missing:
            sound, keys = self._sound, missing[:READ_AT_ONCE]
            self._loader.request(lambda: sound.read(keys))

    def _take(self, pictures: dict[PictureKey, Levels]) -> None:
        self._pictures.take(pictures)
        for place in self._in_view(beside=True):
            row = self._rows[place]
            if self._key(row) in pictures:
                self._cells.pop(row.candidate.id, None)
                self._update_cell(row.candidate.id)
        self._asking.start(0)

    def _on_failed(self, error: Exception) -> None:
        self._failed = True  # told once, not once a cell
        self.read_failed.emit(error)

    # --- painting -----------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Qt: draw what was exposed."""
        self._exposed = event.rect()
        super().paintEvent(event)

    def _paint(self, painter: QPainter) -> None:
        painter.fillRect(self._exposed, QColor(self._theme.background))
        for place in self._places_in(self._exposed):
            row, rect = self._rows[place], self.cell_rect(place)
            if not rect.adjusted(-GAP, -GAP, GAP, GAP).intersects(self._exposed):
                continue
            painter.drawPixmap(rect.topLeft(), self._cell(row))
            if row.candidate.id == self._selected:
                painter.setPen(QPen(QColor(self._theme.cursor), 4))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.drawRect(rect.adjusted(-2, -2, 1, 1))
        if not self._asking.isActive():
            self._asking.start(0)

    def _cell(self, row: CandidateRow) -> QPixmap:
        candidate_id = row.candidate.id
        kept = self._cells.get(candidate_id)
        if kept is not None and kept[0] == row:
            self._cells.move_to_end(candidate_id)
            return kept[1]
        ratio = self.devicePixelRatioF()
        pixmap = QPixmap(self._shape.size * ratio)
        pixmap.setDevicePixelRatio(ratio)
        painter = QPainter(pixmap)
        try:
            levels = self._pictures.find(self._key(row))
            paint_cell(painter, self._theme, self._shape, row, self._sound, levels, self._top_db)
        finally:
            painter.end()
        self._cells[candidate_id] = (row, pixmap)
        while len(self._cells) > KEPT_CELLS:
            self._cells.popitem(last=False)
        return pixmap

    def _forget_cells(self) -> None:
        self._cells.clear()
        self.update()

    def _update_cell(self, candidate_id: int | None) -> None:
        place = self._places.get(candidate_id) if candidate_id is not None else None
        if place is not None:
            self.update(self.cell_rect(place).adjusted(-GAP, -GAP, GAP, GAP))

    def _describe(self) -> None:
        place = self._places.get(self._selected) if self._selected is not None else None
        self.setAccessibleDescription("" if place is None else cell_text(self._rows[place]))

    # --- keys and mouse -----------------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """Qt: keys that mean something among pictures are the grid's own, not those of the views."""
        if event.type() is QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and _is_own(event):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: arrows choose, Enter opens, Z and X change the size."""
        if not _is_own(event):
            super().keyPressEvent(event)
            return
        key = _KEYS(event.key())
        steps = {
            _KEYS.Key_Left: (-1, 0), _KEYS.Key_Right: (1, 0), _KEYS.Key_Up: (0, -1), _KEYS.Key_Down: (0, 1),
            _KEYS.Key_Home: (-len(self._rows), 0), _KEYS.Key_End: (len(self._rows), 0),
        }  # fmt: skip
        if key in steps:
            self.step(*steps[key])
        elif key in (_KEYS.Key_PageUp, _KEYS.Key_PageDown):
            down = max(1, self.visibleRegion().boundingRect().height() // (self._shape.size.height() + GAP))
            self.step(0, -down if key is _KEYS.Key_PageUp else down)
        elif key in (_KEYS.Key_Z, _KEYS.Key_X):
            self.set_width_index(self._width_index + (1 if key is _KEYS.Key_Z else -1))
        elif self._selected in self._places:
            self.candidate_opened.emit(self._selected)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Qt: choose."""
        place = self.cell_at(event.position().toPoint())
        if place is not None:
            self._choose(place)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Qt: open."""
        place = self.cell_at(event.position().toPoint())
        if place is not None:
            self.candidate_opened.emit(self._rows[place].candidate.id)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: more or fewer cells side by side."""
        super().resizeEvent(event)
        self._lay_out()

    def _choose(self, place: int) -> None:
        self.candidate_chosen.emit(self._rows[place].candidate.id)


def _is_own(event: QKeyEvent) -> bool:
    plain = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier == Qt.KeyboardModifier.NoModifier
    return plain and event.key() in OWN_KEYS
