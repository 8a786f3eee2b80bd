"""Help: the guide, the key sheet from the action table, and the zip for support."""

from pathlib import Path

from PySide6.QtCore import QObject, QStandardPaths, Qt
from PySide6.QtWidgets import QFileDialog, QWidget

from app import actions, diagnostics
from app.actions import ACTIONS, PAGE_TITLES, Page
from widgets.help_window import HelpWindow, KeyRow, key_sheet

# what is used most stands on top
SHEET_ORDER = (Page.REVIEW, Page.PLAY, Page.VIEW, Page.EDIT, Page.FILE, Page.HELP)


class HelpControl(QObject):
    """Opens one help window at a time beside ``window``."""

    def __init__(self, window: QWidget, log_file: Path | None) -> None:
        super().__init__(window)
        self._window, self._log_file = window, log_file
        self.shown: HelpWindow | None = None

    def show_guide(self) -> None:
        """Show the guide."""
        window = HelpWindow(self.tr("Help"), "", self._window)
        window.show_guide(key_sheet(key_rows()))
        self._show(window)

    def show_keys(self) -> None:
        """Show all keys."""
        self._show(HelpWindow(self.tr("Keys"), key_sheet(key_rows()), self._window))

    def save_diagnostics(self) -> str:
        """Ask where, and write the zip; returns why it could not be written, empty where all is well."""
        folder = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)
        proposal = f"{folder}/leakline-diagnostics.zip"
        name, _ = QFileDialog.getSaveFileName(self._window, self.tr("Save diagnostics"), proposal, "ZIP (*.zip)")
        try:
            if name:
                diagnostics.write_zip(Path(name), self._log_file)
        except OSError as error:
            return self.tr("The file could not be written: {reason}").format(reason=error.strerror)
        return ""

    def _show(self, window: HelpWindow) -> None:
        if self.shown is not None:
            self.shown.close()
        window.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        window.destroyed.connect(self._forget)
        self.shown = window
        window.show()

    def _forget(self, gone: QObject) -> None:
        if gone is self.shown:
            self.shown = None


def key_rows() -> list[KeyRow]:
    """Return a line of the key sheet for each action."""
    return [
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
