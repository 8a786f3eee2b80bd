"""The photos of the selected leak: the chosen one large, all as a strip, caption, what the photo itself tells."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QObject, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QImage, QKeyEvent, QMouseEvent, QPainter, QPixmap
from PySide6.QtWidgets import (
    QDialog,
    QLabel,
    QLineEdit,
    QListView,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from widgets.flow_layout import FlowLayout
from widgets.painted_widget import PaintedWidget

STRIP_PX = 88
BUTTON_HEIGHT = 44
_ID = Qt.ItemDataRole.UserRole


@dataclass(frozen=True)
class ShownPhoto:
    """A photo as it is shown; ``image`` is None while it is being read, ``told`` what the photo says of itself."""

    id: int
    caption: str
    image: QImage | None = None
    told: str = ""


class PictureWidget(PaintedWidget):
    """One picture, as large as there is room, never larger than it is."""

    clicked = Signal()

    def __init__(self, hint: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._hint = hint
        self._image: QImage | None = None
        self.setMinimumHeight(120)

    def show_image(self, image: QImage | None, hint: str) -> None:
        """Show a picture, or without one the hint."""
        self._image, self._hint = image, hint
        self.update()

    def _paint(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        if self._image is None or self._image.isNull():
            painter.setPen(QColor(self.palette().text().color()))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.rect().adjusted(12, 12, -12, -12), flags, self._hint)
            return
        size = self._image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
        if size.width() > self._image.width():
            size = self._image.size()
        left, top = (self.width() - size.width()) / 2.0, (self.height() - size.height()) / 2.0
        painter.drawImage(QRectF(left, top, size.width(), size.height()), self._image)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Qt: it was touched."""
        del event
        self.clicked.emit()


class PhotoPanel(QWidget):
    """Signals out; it writes nothing."""

    attach_asked = Signal()
    paste_asked = Signal()
    remove_asked = Signal(int)
    caption_changed = Signal(int, str)
    caption_left = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._photos: tuple[ShownPhoto, ...] = ()
        self._captioned: ShownPhoto | None = None  # whose caption is in the field
        self._writable = False
        self._title = QLabel()
        self._title.setObjectName("photo_title")
        self._picture = PictureWidget("")
        self._picture.clicked.connect(self.show_large)
        self._told = QLabel()
        self._told.setObjectName("photo_told")
        self._told.setWordWrap(True)
        self._told.setTextFormat(Qt.TextFormat.PlainText)
        self._strip = self._make_strip()
        self._caption = QLineEdit()
        self._caption.setObjectName("photo_caption")
        self._caption.setMinimumHeight(BUTTON_HEIGHT)
        self._caption.setMaxLength(1000)
        self._caption.setPlaceholderText(self.tr("Caption"))
        self._caption.setAccessibleName(self.tr("Caption of the photo"))
        self._caption.editingFinished.connect(self._on_caption)
        self._caption.returnPressed.connect(self.caption_left)
        self._attach = self._button("photo_attach", self.tr("⇧P  Attach…"))
        self._paste = self._button("photo_paste", self.tr("Ctrl+V  Paste"))
        self._large = self._button("photo_large", self.tr("Show large"))
        self._remove = self._button("photo_remove", self.tr("Remove photo"))
        self._attach.clicked.connect(self.attach_asked)
        self._paste.clicked.connect(self.paste_asked)
        self._large.clicked.connect(self.show_large)
        self._remove.clicked.connect(self._on_remove)
        buttons = FlowLayout()
        for button in (self._attach, self._paste, self._large, self._remove):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(6)
        layout.addWidget(self._title)
        layout.addWidget(self._picture, 1)
        layout.addWidget(self._told)
        layout.addWidget(self._strip)
        layout.addWidget(self._caption)
        layout.addLayout(buttons)
        self.show_photos("", (), writable=False)

    def _make_strip(self) -> QListWidget:
        strip = QListWidget()
        strip.setObjectName("photo_strip")
        strip.setViewMode(QListView.ViewMode.IconMode)
        strip.setFlow(QListView.Flow.LeftToRight)
        strip.setWrapping(False)
        strip.setMovement(QListView.Movement.Static)
        strip.setIconSize(QSize(STRIP_PX, STRIP_PX))
        strip.setGridSize(QSize(STRIP_PX + 10, STRIP_PX + 8))
        strip.setFixedHeight(STRIP_PX + 30)
        strip.setHorizontalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        strip.setAccessibleName(self.tr("Photos of this leak"))
        strip.currentRowChanged.connect(lambda _row: self._choose())
        strip.itemActivated.connect(lambda _item: self.show_large())
        strip.installEventFilter(self)
        return strip

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(BUTTON_HEIGHT)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    # --- what it is told ----------------------------------------------------------------------------------------

    def show_photos(self, name: str, photos: Sequence[ShownPhoto], *, writable: bool) -> None:
        """Show the photos of the leak ``name``, empty where none is selected; the chosen one stays chosen."""
        before, ids = self.current_id, [photo.id for photo in self._photos]
        if self._captioned is not None and all(photo.id != self._captioned.id for photo in photos):
            self.flush()  # its leak is left while the caption is still being typed
            self._captioned = None
        self._photos, self._writable = tuple(photos), writable and bool(name)
        same = ids == [photo.id for photo in self._photos]
        fresh = [photo.id for photo in self._photos if photo.id not in ids]
        self._strip.blockSignals(True)
        if not same:
            self._strip.clear()
            for photo in self._photos:
                item = QListWidgetItem()
                item.setData(_ID, photo.id)
                self._strip.addItem(item)
        for row, photo in enumerate(self._photos):
            self._show_item(self._strip.item(row), row, photo)
        if not same and self._photos:
            wanted = fresh[-1] if fresh and ids else before
            rows = [row for row, photo in enumerate(self._photos) if photo.id == wanted]
            self._strip.setCurrentRow(rows[0] if rows else 0)
        self._strip.blockSignals(False)
        self._strip.setVisible(len(self._photos) > 1)
        if not name:
            self._title.setText(self.tr("No candidate selected"))
        else:
            self._title.setText(self.tr("{name}: photos: {count}").format(name=name, count=len(self._photos)))
        self._attach.setEnabled(self._writable)
        self._paste.setEnabled(self._writable)
        self._show_current()

    def _show_item(self, item: QListWidgetItem, row: int, photo: ShownPhoto) -> None:
        words = photo.caption or self.tr("photo {number}").format(number=row + 1)
        item.setToolTip(words)
        item.setData(Qt.ItemDataRole.AccessibleTextRole, words)
        if photo.image is not None and not photo.image.isNull() and item.icon().isNull():
            small = photo.image.scaled(
                STRIP_PX, STRIP_PX, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
            )
            item.setIcon(QIcon(QPixmap.fromImage(small)))

    @property
    def current_id(self) -> int | None:
        """The id of the chosen photo."""
        item = self._strip.currentItem()
        return None if item is None else int(item.data(_ID))

    def _current(self) -> ShownPhoto | None:
        return next((photo for photo in self._photos if photo.id == self.current_id), None)

    def _show_current(self) -> None:
        photo = self._current()
        reading = self.tr("The photo is being read…")
        none = (
            self.tr("No photo yet. Attach one, paste it, or drop it here.") if self._writable else self.tr("No photo.")
        )
        failed = photo is not None and photo.image is not None and photo.image.isNull()
        hint = none if photo is None else photo.told if failed else reading
        self._picture.show_image(photo.image if photo is not None else None, hint)
        self._told.setText(photo.told if photo is not None and not failed else "")
        self._told.setVisible(bool(self._told.text()))
        before, self._captioned = self._captioned, photo
        same = before is not None and photo is not None and before.id == photo.id
        if not (same and self._caption.hasFocus()):
            self._caption.setText(photo.caption if photo is not None else "")
        self._caption.setEnabled(photo is not None)
        self._caption.setReadOnly(not self._writable)
        self._large.setEnabled(photo is not None)
        self._remove.setEnabled(photo is not None and self._writable)

    # --- what the operator does ---------------------------------------------------------------------------------

    def flush(self) -> None:
        """Announce a caption that is still being typed."""
        self._on_caption()

    def _choose(self) -> None:
        """Go to another photo of the leak; what was typed belongs to the one before."""
        self.flush()
        self._show_current()

    def show_large(self) -> None:
        """Show the chosen photo in a window of its own; arrows go on, any other key or a touch closes it."""
        photo = self._current()
        if photo is None or photo.image is None or photo.image.isNull():
            return
        PhotoDialog(self._photos, self._photos.index(photo), self.window()).exec()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: arrows and Enter belong to the strip while it has the focus, not to the views."""
        if event.type() is QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            keys = (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Return, Qt.Key.Key_Enter)
            if event.key() in keys and event.modifiers() == Qt.KeyboardModifier.NoModifier:
                event.accept()
                return True
        return super().eventFilter(watched, event)

    def _on_caption(self) -> None:
        photo = self._captioned
        if photo is not None and self._writable and self._caption.text().strip() != photo.caption:
            self.caption_changed.emit(photo.id, self._caption.text().strip())

    def _on_remove(self) -> None:
        if self.current_id is not None:
            self.remove_asked.emit(self.current_id)


class PhotoDialog(QDialog):
    """One photo over the whole screen."""

    def __init__(self, photos: Sequence[ShownPhoto], row: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._photos, self._row = tuple(photos), row
        self.setWindowTitle(self.tr("Photo"))
        self.setModal(True)  # the keys are not those of the views behind it
        self._picture = PictureWidget("")
        self._picture.clicked.connect(self.accept)
        self._caption = QLabel()
        self._caption.setTextFormat(Qt.TextFormat.PlainText)
        self._caption.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._caption.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.addWidget(self._picture, 1)
        layout.addWidget(self._caption)
        if parent is not None:
            self.resize(parent.size() * 0.95)
        self._show()

    @property
    def shown(self) -> ShownPhoto:
        """The photo that is shown."""
        return self._photos[self._row]

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Qt: left and right, else close."""
        step = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(Qt.Key(event.key()))
        if step is None:
            self.accept()
            return
        self._row = min(max(self._row + step, 0), len(self._photos) - 1)
        self._show()

    def _show(self) -> None:
        self._picture.show_image(self.shown.image, self.tr("The photo is being read…"))
        parts = [part for part in (self.shown.caption, self.shown.told) if part]
        self._caption.setText("\n".join(parts))
