"""The gallery's page: order and size above, the grid of candidates, and below it the large buttons for the verdicts."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QRect, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QFrame,
    QLabel,
    QPushButton,
    QScrollArea,
    QScroller,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Verdict
from widgets.candidate_row import CandidateRow
from widgets.flow_layout import FlowLayout
from widgets.gallery_cells import WIDTHS
from widgets.gallery_grid import GalleryGrid
from widgets.gallery_pictures import GallerySound
from widgets.plot_theme import Theme
from widgets.quiet_combo import QuietCombo
from widgets.units import quantities
from widgets.vocabulary import verdict_icon

BUTTON_HEIGHT = 48
LOW_SCREEN = 420  # pixels: lower than this, the pictures need the room


class GalleryPanel(QWidget):
    """Signals out; it decides nothing."""

    verdict_chosen = Signal(object)  # Verdict
    order_chosen = Signal(str)
    filter_asked = Signal()  # the next one
    loop_asked = Signal()
    back_asked = Signal()
    open_asked = Signal(int)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.grid = GalleryGrid(theme)
        self._told = QLabel()
        self._told.setObjectName("gallery_count")
        self._told.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._legend = QLabel()
        self._legend.setWordWrap(True)
        self._legend.setTextFormat(Qt.TextFormat.PlainText)
        self._legend.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._empty = QLabel()
        self._empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._empty.setWordWrap(True)
        self._order = QuietCombo()
        self._order.setMinimumHeight(44)
        self._order.setAccessibleName(self.tr("Order of the gallery"))
        self._order.addItem(self.tr("Best score first"), "score")
        self._order.addItem(self.tr("From the launch on"), "chainage")
        self._order.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._order.activated.connect(lambda _row: self.order_chosen.emit(str(self._order.currentData())))
        self._filter = self._button("gallery_filter", self.tr("N  Filter"), self.filter_asked.emit)
        self._smaller = self._button("gallery_smaller", "−", lambda: self._resize_by(-1))
        self._larger = self._button("gallery_larger", "+", lambda: self._resize_by(1))
        for button, name in ((self._smaller, self.tr("Smaller pictures (X)")), (self._larger, self.tr("Larger (Z)"))):
            button.setToolTip(name)
            button.setAccessibleName(name)
            button.setFixedWidth(56)
        self._back = self._button("gallery_back", self.tr("O  Leaks page"), self.back_asked.emit)
        self._open = self._button("gallery_open", self.tr("Enter  Open"), self._on_open)
        self._loop = self._button("gallery_loop", self.tr("⇧Space  Listen"), self.loop_asked.emit)
        self._verdicts = {verdict: self._verdict_button(verdict) for verdict in Verdict}
        self._area = QScrollArea()
        self._lay_out()
        self.grid.reveal_asked.connect(self._reveal)
        self.grid.candidate_opened.connect(self.open_asked)
        self.grid.width_changed.connect(self._show_sizes)
        self._selected: CandidateRow | None = None
        self.apply_theme(theme)
        self._show_sizes()

    def _lay_out(self) -> None:
        self._area.setWidget(self.grid)
        self._area.setWidgetResizable(True)
        self._area.setFrameShape(QFrame.Shape.NoFrame)
        self._area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._area.verticalScrollBar().setSingleStep(40)
        QScroller.grabGesture(self._area.viewport(), QScroller.ScrollerGestureType.TouchGesture)
        top, foot = FlowLayout(), FlowLayout()
        for widget in (self._back, self._order, self._filter, self._told, self._smaller, self._larger):
            top.addWidget(widget)
        for verdict in (Verdict.CONFIRMED, Verdict.REJECTED, Verdict.UNSURE, Verdict.NONE):
            foot.addWidget(self._verdicts[verdict])
        for button in (self._loop, self._open):
            foot.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 4)
        layout.setSpacing(4)
        layout.addLayout(top)
        layout.addWidget(self._legend)
        layout.addWidget(self._empty, 1)
        layout.addWidget(self._area, 1)
        layout.addLayout(foot)

    def _button(self, name: str, text: str, call: Callable[[], object]) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setAccessibleName(text)
        button.setToolTip(text)
        button.setMinimumHeight(44)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # the keys stay with the grid
        button.clicked.connect(lambda _checked=False: call())
        return button

    def _verdict_button(self, verdict: Verdict) -> QPushButton:
        text = {
            Verdict.CONFIRMED: self.tr("1  Confirm"),
            Verdict.REJECTED: self.tr("2  Reject"),
            Verdict.UNSURE: self.tr("3  Unsure"),
            Verdict.NONE: self.tr("0  Clear"),
        }[verdict]
        button = self._button(f"gallery_{verdict.value}", text, lambda: self.verdict_chosen.emit(verdict))
        button.setMinimumHeight(BUTTON_HEIGHT)
        button.setIconSize(QSize(26, 26))
        return button

    # --- what it is told ----------------------------------------------------------------------------------------

    def show_rows(self, rows: Sequence[CandidateRow], all_count: int, decided: int, *, filtered: bool) -> None:
        """Show candidates; ``all_count`` and ``decided`` are of the whole run, ``filtered`` if a filter is on."""
        self.grid.set_rows(rows)
        self._area.setVisible(bool(rows))
        self._empty.setVisible(not rows)
        none = self.tr("No leak candidates were found. M marks one by hand on the leaks page.")
        self._empty.setText(self.tr("The filter hides all candidates. N shows the next filter.") if filtered else none)
        text = self.tr("{decided} of {all} decided").format(decided=decided, all=all_count)
        if filtered:
            shown = self.tr("{count} shown by the filter").format(count=len(rows))
            text = f"{text} · {shown}"
        self._told.setText(text)

    def show_selected(self, row: CandidateRow | None, *, writable: bool) -> None:
        """Frame a candidate."""
        self._selected = row
        self.grid.set_selected(None if row is None else row.candidate.id)
        for button in self._verdicts.values():
            button.setEnabled(row is not None and writable)
        self._open.setEnabled(row is not None)
        self._loop.setEnabled(row is not None)

    def fit_all(self) -> None:
        """Make the pictures as large as they can be with all of them in view."""
        room = self._area.viewport().size()
        for index in reversed(range(len(WIDTHS))):
            self.grid.set_width_index(index)
            if self.grid.height_for(room.width()) <= room.height():
                return

    def show_order(self, order: str) -> None:
        """Show which order it is."""
        self._order.setCurrentIndex(max(0, self._order.findData(order)))

    def show_sound(self, sound: GallerySound | None, db_range: tuple[float, float]) -> None:
        """Read the pictures from this sound, and say what all of them show alike."""
        self.grid.set_sound(sound)
        if sound is None:
            self._legend.clear()
            self._legend.hide()
            return
        words = quantities()
        low, high = (words.number(level, 0) for level in db_range)
        if sound.distances is None:
            half = f"{words.number(sound.half, 0)} s"
            text = self.tr(
                "Each picture: ± {half} around the moment, colours from {low} to {high} dB. There is no path, "
                "so nothing can be said in metres."
            )
        else:
            half = words.length(sound.half, 0)
            text = self.tr(
                "Each picture: ± {half} around the place, colours from {low} to {high} dB. Brackets: 95 % interval. "
                "Strokes at the sides: band. Curve: level over the background, dashed: threshold."
            )
        self._legend.setText(text.format(half=half, low=low, high=high))
        self._legend.setToolTip(self._legend.text())
        self._legend.setVisible(self.height() >= LOW_SCREEN)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.grid.apply_theme(theme)
        for verdict, button in self._verdicts.items():
            button.setIcon(verdict_icon(theme, verdict, 28))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: on a low screen the legend gives way to the pictures, and the buttons say their keys alone."""
        super().resizeEvent(event)
        low = self.height() < LOW_SCREEN
        self._legend.setVisible(bool(self._legend.text()) and not low)
        for button in (self._back, self._filter, self._loop, self._open, *self._verdicts.values()):
            text = button.accessibleName()
            button.setText(text.split("  ")[0] if low else text)

    def _show_sizes(self) -> None:
        self._smaller.setEnabled(self.grid.width_index > 0)
        self._larger.setEnabled(self.grid.width_index < len(WIDTHS) - 1)

    def _resize_by(self, step: int) -> None:
        self.grid.set_width_index(self.grid.width_index + step)

    def _on_open(self) -> None:
        if self._selected is not None:
            self.open_asked.emit(self._selected.candidate.id)

    def _reveal(self, rect: QRect) -> None:
        if rect.height() > self._area.viewport().height():  # its head and its picture first
            self._area.verticalScrollBar().setValue(rect.top())
        else:
            self._area.ensureVisible(rect.center().x(), rect.center().y(), 0, rect.height() // 2)
