"""The sheet of all keys and gestures, made from tables: grouped, searched, in letters of any size, printed."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from PySide6.QtCore import QMarginsF, Signal
from PySide6.QtGui import QPageLayout, QPageSize, QPdfWriter, QTextDocument
from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QLineEdit, QPushButton, QTextBrowser, QVBoxLayout, QWidget

from widgets.folding import has_all_words

SMALLEST, LARGEST, USUAL = 9, 28, 13  # points
STEP = 2
PRINT_PT = 10


@dataclass(frozen=True)
class KeyRow:
    """A line of the sheet: ``group`` is the heading it stands under."""

    group: str
    keys: str
    text: str
    tip: str


def key_sheet(rows: Sequence[KeyRow], points: int = USUAL) -> str:
    """Return the rows that have keys as HTML, grouped in the order they come."""
    parts: list[str] = [f"<div style='font-size: {points}pt'>"]
    group = ""
    for row in rows:
        if not row.keys:
            continue
        if row.group != group:
            close = "</table>" if group else ""
            parts.append(f"{close}<h3>{escape(row.group)}</h3><table cellpadding='5' cellspacing='0' width='100%'>")
            group = row.group
        parts.append(
            f"<tr><td width='26%'><b>{escape(row.keys)}</b></td><td width='28%'>{escape(row.text)}</td>"
            f"<td>{escape(row.tip)}</td></tr>"
        )
    return "".join(parts) + ("</table>" if group else "") + "</div>"


def write_pdf(rows: Sequence[KeyRow], title: str, file: Path) -> None:
    """Write the whole sheet as a PDF of A4 pages, for the van's sun visor; raises OSError where it cannot."""
    with file.open("wb"):  # QPdfWriter says nothing of a disc that refuses
        pass
    writer = QPdfWriter(str(file))
    writer.setTitle(title)
    writer.setPageSize(QPageSize(QPageSize.PageSizeId.A4))
    writer.setPageMargins(QMarginsF(14, 12, 14, 12), QPageLayout.Unit.Millimeter)
    writer.setResolution(96)
    document = QTextDocument()
    document.setHtml(f"<h2>{escape(title)}</h2>{key_sheet(rows, PRINT_PT)}")
    document.print_(writer)


class KeySheetWindow(QDialog):
    """Stays open beside the window; ``points`` is the size of its letters."""

    points_changed = Signal(int)
    print_asked = Signal()

    def __init__(self, rows: Sequence[KeyRow], points: int = USUAL, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Keys"))
        self.resize(940, 680)
        self._rows = tuple(rows)
        self.points = min(max(points, SMALLEST), LARGEST)
        self._browser = QTextBrowser()
        self._browser.setOpenLinks(False)
        self._browser.setAccessibleName(self.tr("Keys and gestures"))
        self._search = QLineEdit()
        self._search.setObjectName("keys_search")
        self._search.setMinimumHeight(44)
        self._search.setClearButtonEnabled(True)
        self._search.setPlaceholderText(self.tr("Search: what it does, or a key"))
        self._search.setAccessibleName(self._search.placeholderText())
        self._search.textChanged.connect(self._show)
        self._nothing = QLabel(self.tr("No key does that. Search for fewer words, or look into the menus."))
        self._nothing.setWordWrap(True)
        self._smaller = self._button("A −", "keys_smaller", self.tr("Smaller letters"))
        self._smaller.clicked.connect(lambda: self._resize(-STEP))
        self._larger = self._button("A +", "keys_larger", self.tr("Larger letters"))
        self._larger.clicked.connect(lambda: self._resize(STEP))
        save = self._button(self.tr("Print (PDF)…"), "keys_print", self.tr("Write the sheet as a PDF to print"))
        save.clicked.connect(self.print_asked)
        close = self._button(self.tr("Close"), "keys_close", self.tr("Close"))
        close.clicked.connect(self.close)
        head = QHBoxLayout()
        head.addWidget(self._search, 1)
        for button in (self._smaller, self._larger, save, close):
            head.addWidget(button)
        layout = QVBoxLayout(self)
        layout.addLayout(head)
        layout.addWidget(self._nothing)
        layout.addWidget(self._browser, 1)
        self._show()

    def _button(self, text: str, name: str, tip: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumSize(52, 44)
        button.setAutoDefault(False)
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        return button

    def shown(self) -> list[KeyRow]:
        """Return the rows that the search leaves."""
        query = self._search.text()
        return [row for row in self._rows if row.keys and has_all_words(query, f"{row.keys} {row.text} {row.tip}")]

    def _resize(self, by: int) -> None:
        self.points = min(max(self.points + by, SMALLEST), LARGEST)
        self.points_changed.emit(self.points)
        self._show()

    def _show(self) -> None:
        rows = self.shown()
        at = self._browser.verticalScrollBar().value()
        self._browser.setHtml(key_sheet(rows, self.points))
        self._browser.verticalScrollBar().setValue(at)
        self._nothing.setVisible(not rows)
        self._smaller.setEnabled(self.points > SMALLEST)
        self._larger.setEnabled(self.points < LARGEST)
