"""The report page: what an export says and writes, the choices about it, its progress, and the exports made so far."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Verdict
from widgets.handover_form import HandoverForm
from widgets.page_pictures import PagePictures
from widgets.quiet_combo import QuietCombo
from widgets.report_words import ExportOutcome, ReportPreview, ReportWords

ROW_HEIGHT = 44
LIST_ROWS = 3
NARROW = 820  # pixels: less than both columns need


@dataclass(frozen=True)
class PastExport:
    """An export that lies in the survey's folder: its name there, and what is shown of it."""

    name: str
    text: str
    has_report: bool


class _Choices(QScrollArea):
    """Scrolls up and down; or is as high as what is in it, where the whole page scrolls."""

    def __init__(self) -> None:
        super().__init__()
        self._whole = False
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        self.setSizeAdjustPolicy(QScrollArea.SizeAdjustPolicy.AdjustToContents)

    def set_whole(self, *, whole: bool) -> None:
        if whole != self._whole:
            self._whole = whole
            bar = Qt.ScrollBarPolicy.ScrollBarAlwaysOff if whole else Qt.ScrollBarPolicy.ScrollBarAsNeeded
            self.setVerticalScrollBarPolicy(bar)
            self.updateGeometry()

    def minimumSizeHint(self) -> QSize:
        """Qt: the smallest size."""
        inside = self.widget()
        if not self._whole or inside is None:
            return super().minimumSizeHint()
        return QSize(super().minimumSizeHint().width(), inside.sizeHint().height())


class ReportPanel(QWidget):
    """Signals out; it writes nothing itself."""

    export_asked = Signal(str)  # language of the report
    cancel_asked = Signal()
    open_folder_asked = Signal(str)  # the chosen export, or empty for the latest
    open_report_asked = Signal(str)  # likewise
    pages_asked = Signal(str)  # language of the report
    undecided_asked = Signal()
    language_changed = Signal(str)

    def __init__(self, language: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.form = HandoverForm()
        self.pages = PagePictures()
        self._words = ReportWords(self)
        self._told = QTextBrowser()
        self._told.setFrameShape(QFrame.Shape.NoFrame)
        self._told.setOpenLinks(False)
        self._told.setAccessibleName(self.tr("What will be written"))
        self._shown = QStackedWidget()
        for widget in (self._told, self.pages):
            self._shown.addWidget(widget)
        self._language = QuietCombo()
        self._language.setMinimumHeight(ROW_HEIGHT)
        self._language.addItem("English", "en")
        self._language.addItem("Türkçe", "tr")
        self._language.setAccessibleName(self.tr("Language of the report"))
        self._language.activated.connect(lambda _row: self.language_changed.emit(self.language))
        self.set_language(language)
        self._see = self._button("see_pages", self.tr("See the pages"), ROW_HEIGHT, self._on_pages)
        self._export = self._button("export", self.tr("Export report and files"), 52, self._on_export)
        self._open = self._button("open_exports", self.tr("Open folder"), ROW_HEIGHT, self._on_open)
        self._read = self._button("open_report", self.tr("Open report"), ROW_HEIGHT, self._on_read)
        self._cancel = self._button("cancel_export", self.tr("Cancel"), ROW_HEIGHT, self.cancel_asked.emit)
        self._progress = QProgressBar()
        self._progress.setRange(0, 1000)
        self._progress.setMinimumHeight(ROW_HEIGHT)
        self._exports = QListWidget()
        self._exports.setObjectName("exports_so_far")
        self._exports.setAccessibleName(self.tr("Exports so far"))
        self._exports.setMinimumHeight(LIST_ROWS * ROW_HEIGHT)
        self._exports.itemActivated.connect(lambda _item: self._on_open())
        self._exports.currentRowChanged.connect(lambda _row: self._show_openable())
        self._draft = QLabel()
        self._draft.setWordWrap(True)
        self._draft.setObjectName("draft_warning")
        self._undecided = self._button(
            "next_undecided", self.tr("Go to the next undecided"), ROW_HEIGHT, self.undecided_asked.emit
        )
        self._scroll = _Choices()
        self._preview: ReportPreview | None = None
        self._past: tuple[PastExport, ...] = ()
        self._outcome: ExportOutcome | None = None
        self._lay_out()
        self.form.changed.connect(self._tell)
        self.set_exports(())
        self.set_progress(None)
        self.set_preview(None)

    # --- what is chosen ---

    @property
    def language(self) -> str:
        """The language chosen for the report."""
        return str(self._language.currentData())

    def set_language(self, language: str) -> None:
        """Show the report's language, without telling of it."""
        self._language.setCurrentIndex(max(0, self._language.findData(language)))

    # --- what is shown ---

    def set_preview(self, preview: ReportPreview | None) -> None:
        """Show what would be written; None while there is nothing to report."""
        self._preview = preview
        for button in (self._export, self._see):
            button.setEnabled(preview is not None)
        undecided = 0 if preview is None else sum(_is_open(row.decision.verdict) for row in preview.rows)
        text = self.tr("Draft: places undecided or unsure: {count}. Each page of the report says so.")
        self._draft.setText(text.format(count=undecided))
        for widget in (self._draft, self._undecided):
            widget.setVisible(undecided > 0)
        self.show_words()
        self._tell()

    def set_outcome(self, outcome: ExportOutcome | None) -> None:
        """Show what was written last, what was left out and why; None forgets it."""
        self._outcome = outcome
        self.show_words()
        self._tell()

    def set_pages(self, pictures: Sequence[bytes]) -> None:
        """Show the pages of the report as pictures."""
        self.pages.set_pictures(pictures)
        self._shown.setCurrentWidget(self.pages)
        self._see.setText(self.tr("Back to the list"))
        self.pages.setFocus()

    def toggle_pages(self) -> None:
        """Go from the list to the pages, which are then asked for, or back."""
        if self._see.isEnabled():
            self._on_pages()

    def show_words(self) -> None:
        """Show the list in place of the pages."""
        self._shown.setCurrentWidget(self._told)
        self._see.setText(self.tr("See the pages"))

    def set_progress(self, fraction: float | None, text: str = "") -> None:
        """Show how far an export or the pages are; None when nothing is being made."""
        for widget in (self._progress, self._cancel):
            widget.setVisible(fraction is not None)
        for button in (self._export, self._see):
            button.setVisible(fraction is None)
        if fraction is not None:
            self._progress.setValue(round(1000 * fraction))
            self._progress.setFormat(text)

    def set_exports(self, exports: Sequence[PastExport]) -> None:
        """Show the exports made so far, newest first."""
        self._exports.clear()  # it tells of rows while they go
        self._past = tuple(exports)
        for export in exports:
            item = QListWidgetItem(export.text)
            item.setSizeHint(QSize(0, ROW_HEIGHT))
            item.setToolTip(export.name)
            self._exports.addItem(item)
        if exports:
            self._exports.setCurrentRow(0)
        self._show_openable()

    def plain_text(self) -> str:
        """Return the preview as plain text."""
        return self._told.toPlainText()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: another size; in little room the choices stand above what they do, without a bar of their own."""
        super().resizeEvent(event)
        narrow = event.size().width() < NARROW
        across, down = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.BottomToTop
        self._row.setDirection(down if narrow else across)
        self._scroll.set_whole(whole=narrow)
        self.form.set_narrow(narrow=narrow)

    # --- inside ---

    def _button(self, name: str, text: str, height: int, slot: Callable[[], None]) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(height)
        button.clicked.connect(lambda _checked=False: slot())
        return button

    def _lay_out(self) -> None:
        left = QVBoxLayout()
        warning = QHBoxLayout()
        warning.addWidget(self._draft, 1)
        warning.addWidget(self._undecided)
        left.addLayout(warning)
        left.addWidget(self._shown, 1)
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(0, 0, 6, 0)
        label = QLabel(self.tr("Language of the report"))
        label.setBuddy(self._language)
        column.addWidget(label)
        column.addWidget(self._language)
        column.addWidget(self.form)
        column.addWidget(QLabel(self.tr("Exports so far")))
        column.addWidget(self._exports)
        column.addStretch(1)
        self._scroll.setWidget(inside)
        side = QVBoxLayout()
        side.addWidget(self._scroll, 1)
        for widget in (self._see, self._export, self._progress, self._cancel):
            side.addWidget(widget)
        opening = QHBoxLayout()
        for button in (self._read, self._open):
            opening.addWidget(button, 1)
        side.addLayout(opening)
        self._row = QHBoxLayout(self)
        self._row.addLayout(left, 3)
        self._row.addLayout(side, 2)

    def _tell(self) -> None:
        """Fill the list: what is chosen has changed, or what became of it is known."""
        told = "" if self._outcome is None else self._words.outcome_html(self._outcome)
        self._told.setHtml(told + self._words.preview_html(self._preview, self.form.options))

    def _on_export(self) -> None:
        self.export_asked.emit(self.language)

    def _on_pages(self) -> None:
        if self._shown.currentWidget() is self.pages:
            self.show_words()
        else:
            self.pages_asked.emit(self.language)

    def _on_open(self) -> None:
        chosen = self._chosen()
        self.open_folder_asked.emit("" if chosen is None else chosen.name)

    def _on_read(self) -> None:
        chosen = self._chosen()
        self.open_report_asked.emit("" if chosen is None else chosen.name)

    def _chosen(self) -> PastExport | None:
        row = self._exports.currentRow()
        return self._past[row] if 0 <= row < len(self._past) else None

    def _show_openable(self) -> None:
        chosen = self._chosen()
        for button in (self._open, self._read):
            button.setVisible(self._exports.count() > 0)
        self._read.setEnabled(chosen is not None and chosen.has_report)


def _is_open(verdict: Verdict) -> bool:
    return verdict in (Verdict.NONE, Verdict.UNSURE)
