"""Help: the manual, opened where one is, the key sheet from the action table, and the zip for support."""

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, QStandardPaths, Qt
from PySide6.QtWidgets import QDialog, QFileDialog, QWidget

from app import actions, diagnostics, gestures, manual
from app.actions import ACTIONS, PAGE_TITLES, Page
from app.gestures import GESTURES
from app.settings import PreferencesStore
from widgets.key_sheet import USUAL, KeyRow, KeySheetWindow, write_pdf
from widgets.manual_window import ManualWindow, ShownPage

# what is used most stands on top
SHEET_ORDER = (Page.REVIEW, Page.PLAY, Page.VIEW, Page.EDIT, Page.FILE, Page.HELP)
SIZE = "keys.size"  # of the key sheet's letters, among the remembered layouts


class HelpControl(QObject):
    """Opens one help window at a time beside ``window``; ``where`` tells which page is in front."""

    def __init__(
        self,
        window: QWidget,
        log_file: Path | None,
        preferences: PreferencesStore,
        language: str,
        where: Callable[[], str],
        tell: Callable[[str], None],
    ) -> None:
        super().__init__(window)
        self._window, self._log_file, self._preferences = window, log_file, preferences
        self._language, self._where, self._tell = language, where, tell
        self.shown: QDialog | None = None

    def show_guide(self) -> None:
        """Show the manual's page for what is in front."""
        self.show_page(manual.context(self._where()))

    def show_page(self, name: str) -> None:
        """Show a page of the manual."""
        if not isinstance(self.shown, ManualWindow):
            pages = [ShownPage(p.name, p.title, p.markdown, p.text) for p in manual.pages(self._language)]
            self._show(ManualWindow(pages, manual.folder(self._language), self._window))
        assert isinstance(self.shown, ManualWindow)
        self.shown.show_page(name)
        self.shown.raise_()

    def show_keys(self) -> None:
        """Show all keys and gestures."""
        size = self._preferences.values.layout.get(SIZE, "")
        sheet = KeySheetWindow(key_rows(), int(size) if size.isdecimal() else USUAL, self._window)
        sheet.points_changed.connect(self._remember_size)
        sheet.print_asked.connect(self._print_keys)
        self._show(sheet)

    def _remember_size(self, points: int) -> None:
        layout = self._preferences.values.layout | {SIZE: str(points)}
        self._preferences.change(layout=layout)

    def _print_keys(self) -> None:
        name, _ = QFileDialog.getSaveFileName(
            self._window, self.tr("Print (PDF)"), f"{_documents()}/leakline-keys.pdf", "PDF (*.pdf)"
        )
        if not name:
            return
        try:
            write_pdf(key_rows(), self.tr("Leakline: keys and gestures"), Path(name))
        except OSError as error:
            text = self.tr("The file could not be written: {reason}. Choose another folder.")
            self._tell(text.format(reason=error.strerror))
            return
        self._tell(self.tr("Written to {folder}").format(folder=name))

    def save_diagnostics(self) -> str:
        """Ask where, and write the zip; returns why it could not be written, empty where all is well."""
        proposal = f"{_documents()}/leakline-diagnostics.zip"
        name, _ = QFileDialog.getSaveFileName(self._window, self.tr("Save diagnostics"), proposal, "ZIP (*.zip)")
        try:
            if name:
                diagnostics.write_zip(Path(name), self._log_file)
        except OSError as error:
            text = self.tr("The file could not be written: {reason}. Choose another folder.")
            return text.format(reason=error.strerror)
        return ""

    def _show(self, window: QDialog) -> None:
        if self.shown is not None:
            self.shown.close()
        window.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        window.finished.connect(lambda _result: self._forget(window))
        self.shown = window
        window.show()

    def _forget(self, gone: QDialog) -> None:
        if gone is self.shown:
            self.shown = None


def _documents() -> str:
    return QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)


def key_rows() -> list[KeyRow]:
    """Return a line of the key sheet for each action, then for each gesture."""
    rows = [
        KeyRow(
            actions.translated(PAGE_TITLES[page]).replace("&", ""),
            actions.shown_keys(row),
            actions.translated(row.text),
            actions.translated(row.tip),
        )
        for page in SHEET_ORDER
        for row in ACTIONS
        if row.page is page
    ]
    group = gestures.translated(gestures.TITLE)
    return rows + [KeyRow(group, gestures.translated(g.how), "", gestures.translated(g.what)) for g in GESTURES]
