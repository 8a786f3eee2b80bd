"""Shows the manual beside the window: contents, full-text search, back and forward; it needs no network."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PySide6.QtCore import QByteArray, QSize, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import (
    QImage,
    QKeySequence,
    QResizeEvent,
    QShortcut,
    QTextCharFormat,
    QTextCursor,
    QTextDocument,
)
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSplitter,
    QTextBrowser,
    QTextEdit,
    QVBoxLayout,
    QWidget,
)

from widgets.folding import folded, has_all_words

NAME = Qt.ItemDataRole.UserRole
MARK_ALPHA = 110
LEAST_PICTURE = 200  # pixels: with less room nothing would be seen on it


@dataclass(frozen=True)
class ShownPage:
    """A page: ``name`` is what links call it by, ``text`` what a search looks through."""

    name: str
    title: str
    markdown: str
    text: str


class _PageBrowser(QTextBrowser):
    """Shows pictures no wider than there is room, so that nobody scrolls sideways."""

    def loadResource(self, kind: int, name: QUrl | str) -> Any:  # noqa: ANN401  # what Qt's own returns
        """Qt: the picture, made to fit."""
        found = super().loadResource(kind, name)
        if kind != QTextDocument.ResourceType.ImageResource.value or not isinstance(found, QByteArray):
            return found
        picture = QImage.fromData(found)
        room = self.viewport().width() - 2 * round(self.document().documentMargin()) - 2
        if picture.width() <= room or room < LEAST_PICTURE:
            return picture
        sharp = self.devicePixelRatioF()
        small = picture.scaledToWidth(round(room * sharp), Qt.TransformationMode.SmoothTransformation)
        small.setDevicePixelRatio(sharp)
        return small

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: let pictures fit again."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self.resized.emit()

    resized = Signal()


class ManualWindow(QDialog):
    """Stays open beside the window; pictures come from ``folder``."""

    def __init__(self, pages: Sequence[ShownPage], folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Manual"))
        self.resize(1120, 720)
        self._pages = {page.name: page for page in pages}
        self._history: list[str] = []
        self._at = -1
        self._browser = _PageBrowser()
        self._browser.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)  # pictures fit beside it
        self._fitting = QTimer(self)
        self._fitting.setSingleShot(True)
        self._fitting.setInterval(0)
        self._fitting.timeout.connect(self._fit)
        self._browser.resized.connect(self._fitting.start)
        self._browser.setSearchPaths([str(folder)])
        self._browser.setOpenLinks(False)
        self._browser.setAccessibleName(self.tr("Page of the manual"))
        self._browser.anchorClicked.connect(self._follow)
        self._contents = QListWidget()
        self._contents.setObjectName("manual_contents")
        self._contents.setAccessibleName(self.tr("Contents"))
        self._contents.setWordWrap(True)
        self._contents.itemClicked.connect(self._choose)
        self._contents.itemActivated.connect(self._choose)
        self._search = QLineEdit()
        self._search.setObjectName("manual_search")
        self._search.setPlaceholderText(self.tr("Search the manual"))
        self._search.setAccessibleName(self._search.placeholderText())
        self._search.setClearButtonEnabled(True)
        self._search.setMinimumHeight(44)
        self._search.textChanged.connect(self._look)
        self._search.returnPressed.connect(self._first_found)
        self._nothing = QLabel(self.tr("No page has all of these words. Search for fewer of them."))
        self._nothing.setWordWrap(True)
        self._nothing.hide()
        self._back = self._button(self.tr("← Back"), "manual_back", self.back)
        self._forward = self._button(self.tr("Forward →"), "manual_forward", self.forward)
        close = self._button(self.tr("Close"), "manual_close", self.close)
        self._lay_out(close)
        for key, call in (
            ("Backspace", self.back),  # in the field it takes a letter away, as everywhere
            ("Alt+Left", self.back),
            ("Alt+Right", self.forward),
            ("Ctrl+F", self._search.setFocus),
            ("F1", self.close),
        ):
            QShortcut(QKeySequence(key), self).activated.connect(call)
        self._look()
        self._browser.setFocus()  # arrows and page keys scroll at once

    def _button(self, text: str, name: str, call: object) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        button.setAutoDefault(False)
        button.clicked.connect(call)
        return button

    def _lay_out(self, close: QPushButton) -> None:
        side = QWidget()
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._search)
        column.addWidget(self._nothing)
        column.addWidget(self._contents, 1)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.setChildrenCollapsible(False)
        split.addWidget(side)
        split.addWidget(self._browser)
        split.setSizes([280, 840])
        foot = QHBoxLayout()
        foot.addWidget(self._back)
        foot.addWidget(self._forward)
        foot.addStretch(1)
        foot.addWidget(close)
        layout = QVBoxLayout(self)
        layout.addWidget(split, 1)
        layout.addLayout(foot)

    # --- pages ---

    @property
    def page(self) -> str:
        """The page that is shown."""
        return self._history[self._at]

    def show_page(self, name: str) -> None:
        """Show a page and remember the one before; raises KeyError for one that does not exist."""
        if name not in self._pages:
            raise KeyError(name)
        if self._history and self.page == name:
            return
        self._history = [*self._history[: self._at + 1], name]
        self._at = len(self._history) - 1
        self._show()

    def back(self) -> None:
        """Show the page before."""
        if self._at > 0:
            self._at -= 1
            self._show()

    def forward(self) -> None:
        """Show the page that was gone back from."""
        if self._at + 1 < len(self._history):
            self._at += 1
            self._show()

    def _show(self) -> None:
        self._browser.setMarkdown(self._pages[self.page].markdown)
        self._browser.moveCursor(QTextCursor.MoveOperation.Start)
        self._back.setEnabled(self._at > 0)
        self._forward.setEnabled(self._at + 1 < len(self._history))
        for row in range(self._contents.count()):
            item = self._contents.item(row)
            if item.data(NAME) == self.page:
                self._contents.setCurrentItem(item)
        self._mark()

    def _fit(self) -> None:
        """Show the page again for another width, at the same place in it."""
        if self._history:
            bar = self._browser.verticalScrollBar()
            share = bar.value() / max(bar.maximum(), 1)
            self._browser.setMarkdown(self._pages[self.page].markdown)
            self._mark()
            bar.setValue(round(share * bar.maximum()))

    def _follow(self, url: QUrl) -> None:
        name = url.path().removesuffix(".md")
        if name in self._pages:
            self.show_page(name)

    # --- contents and search ---

    def found(self) -> list[str]:
        """Return the pages that the search leaves, in the order shown."""
        return [self._contents.item(row).data(NAME) for row in range(self._contents.count())]

    def _look(self) -> None:
        query = self._search.text()
        left = [page for page in self._pages.values() if has_all_words(query, f"{page.title} {page.text}")]
        if query.strip():  # pages that have it in their title come first
            left.sort(key=lambda page: not has_all_words(query, page.title))
        self._contents.clear()
        for page in left:
            item = QListWidgetItem(page.title)
            item.setData(NAME, page.name)
            item.setSizeHint(QSize(0, 44))
            self._contents.addItem(item)
            if self._history and page.name == self.page:
                self._contents.setCurrentItem(item)
        self._nothing.setVisible(not left)
        if self._history:
            self._mark()

    def _first_found(self) -> None:
        names = self.found()
        if names:
            self.show_page(names[0])

    def _choose(self, item: QListWidgetItem) -> None:
        self.show_page(item.data(NAME))

    def _mark(self) -> None:
        """Mark the words that are searched for on the page, and go to the first of them."""
        words = folded(self._search.text()).split()
        text = "".join(folded(letter)[:1] or letter for letter in self._browser.toPlainText())
        shade = self.palette().highlight().color()
        shade.setAlpha(MARK_ALPHA)
        look = QTextCharFormat()
        look.setBackground(shade)
        marks = []
        for word in words:
            at = text.find(word)
            while at >= 0:
                mark = QTextEdit.ExtraSelection()
                mark.cursor = QTextCursor(self._browser.document())
                mark.cursor.setPosition(at)
                mark.cursor.setPosition(at + len(word), QTextCursor.MoveMode.KeepAnchor)
                mark.format = look
                marks.append(mark)
                at = text.find(word, at + 1)
        self._browser.setExtraSelections(marks)
        if marks:
            first = min(marks, key=lambda mark: mark.cursor.selectionStart()).cursor
            first.clearSelection()
            self._browser.setTextCursor(first)
            self._browser.ensureCursorVisible()
