"""Shows the pages of a report one at a time, as large as fits, with wide buttons to turn them."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QKeyEvent, QPainter, QPixmap, QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from widgets.painted_widget import PaintedWidget

HEIGHT = 48
MARGIN = 6
SCROLL_STEP = 80


class _Page(PaintedWidget):
    """One picture, fitted; only the page in view is unpacked."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._picture = QPixmap()
        self.setMinimumSize(200, 200)
        self._whole = True

    def set_picture(self, data: bytes) -> None:
        self._picture = QPixmap()
        self._picture.loadFromData(data)
        self._fit()

    def show_whole(self, *, whole: bool) -> None:
        """Fit the whole page, or its width: then it is higher than its room."""
        self._whole = whole
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: another size."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._fit()

    def _fit(self) -> None:
        height = 200
        if not self._whole and not self._picture.isNull():
            height = round(self.width() * self._picture.height() / self._picture.width())
        self.setMinimumHeight(height)
        self.update()

    def _paint(self, painter: QPainter) -> None:
        if self._picture.isNull():
            return
        room = self.size() - QSize(2 * MARGIN, 2 * MARGIN)
        size = self._picture.size().scaled(room, Qt.AspectRatioMode.KeepAspectRatio)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        left, top = (self.width() - size.width()) // 2, (self.height() - size.height()) // 2
        painter.drawPixmap(left, top, size.width(), size.height(), self._picture)
        painter.setPen(self.palette().mid().color())  # a white page on a white window would have no end
        painter.drawRect(left, top, size.width() - 1, size.height() - 1)


class PagePictures(QWidget):
    """Page Up and Page Down turn, Home and End go to the first and last page; Space makes it larger, arrows scroll."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._pictures: tuple[bytes, ...] = ()
        self._at = 0
        self._page = _Page()
        self._where = QLabel()
        self._where.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._back = self._button("page_back", self.tr("◀ Back"), lambda: self.turn(-1))
        self._next = self._button("page_next", self.tr("Next ▶"), lambda: self.turn(1))
        self._larger = self._button("page_larger", "", self.toggle_size)
        self._scroll = QScrollArea()
        self._scroll.setWidget(self._page)
        self._scroll.setWidgetResizable(True)
        self._scroll.setFrameShape(QFrame.Shape.NoFrame)
        self._scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        row = QHBoxLayout()
        for widget in (self._back, self._where, self._larger, self._next):
            row.addWidget(widget, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._scroll, 1)
        layout.addLayout(row)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(self.tr("Pages of the report"))
        self._whole = True
        self._name_size()
        self.set_pictures(())

    @property
    def current(self) -> int:
        """Which page is in view, from 1; 0 for none."""
        return self._at + 1 if self._pictures else 0

    def set_pictures(self, pictures: Sequence[bytes]) -> None:
        """Show these PNG pictures, the first in front; where one was in view before, the same page."""
        self._pictures = tuple(pictures)
        self._show(min(self._at, max(len(pictures) - 1, 0)))

    def turn(self, step: int) -> None:
        """Turn some pages on or back; the ends are the ends."""
        self._show(min(max(self._at + step, 0), max(len(self._pictures) - 1, 0)))

    def toggle_size(self) -> None:
        """Go from the whole page to its full width, or back."""
        self._whole = not self._whole
        self._page.show_whole(whole=self._whole)
        self._name_size()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: a key."""
        if event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            bar = self._scroll.verticalScrollBar()
            bar.setValue(bar.value() + (1 if event.key() == Qt.Key.Key_Down else -1) * SCROLL_STEP)
            return
        if event.key() == Qt.Key.Key_Space:
            self.toggle_size()
            return
        count = len(self._pictures)
        steps = {Qt.Key.Key_PageDown: 1, Qt.Key.Key_PageUp: -1, Qt.Key.Key_Home: -count, Qt.Key.Key_End: count}
        step = steps.get(Qt.Key(event.key()))
        if step is None:
            super().keyPressEvent(event)
        else:
            self.turn(step)

    def _name_size(self) -> None:
        self._larger.setText(self.tr("Larger") if self._whole else self.tr("Whole page"))

    def _button(self, name: str, text: str, slot: Callable[[], None]) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(HEIGHT)
        button.clicked.connect(lambda _checked=False: slot())
        return button

    def _show(self, at: int) -> None:
        self._at = at
        if self._pictures:
            self._page.set_picture(self._pictures[at])
            self._scroll.verticalScrollBar().setValue(0)
            self._where.setText(self.tr("Page {page} of {count}").format(page=at + 1, count=len(self._pictures)))
        self._back.setEnabled(at > 0)
        self._next.setEnabled(at + 1 < len(self._pictures))
