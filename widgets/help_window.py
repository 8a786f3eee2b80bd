"""The sheet of all keys, made from the action table, and the page that leads from folder to report."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QTextBrowser, QVBoxLayout, QWidget


@dataclass(frozen=True)
class KeyRow:
    """A line of the sheet: ``group`` is the heading it stands under."""

    group: str
    keys: str
    text: str
    tip: str


def key_sheet(rows: Sequence[KeyRow]) -> str:
    """Return the rows that have keys as HTML, grouped in the order they come."""
    parts: list[str] = []
    group = ""
    for row in rows:
        if not row.keys:
            continue
        if row.group != group:
            parts.append(f"{'</table>' if group else ''}<h3>{escape(row.group)}</h3><table cellpadding='4'>")
            group = row.group
        parts.append(
            f"<tr><td width='150'><b>{escape(row.keys)}</b></td><td width='190'>{escape(row.text)}</td>"
            f"<td>{escape(row.tip)}</td></tr>"
        )
    return "".join(parts) + ("</table>" if group else "")


class HelpWindow(QDialog):
    """Shows one page of text; stays open beside the window."""

    def __init__(self, title: str, html: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.resize(860, 620)
        browser = QTextBrowser()
        browser.setHtml(html)
        browser.setOpenExternalLinks(False)
        browser.setOpenLinks(False)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        close = buttons.button(QDialogButtonBox.StandardButton.Close)
        close.setText(self.tr("Close"))
        close.setMinimumHeight(44)
        buttons.rejected.connect(self.close)
        layout = QVBoxLayout(self)
        layout.addWidget(browser)
        layout.addWidget(buttons)

    def guide(self) -> str:
        """Return the short guide; the manual of issue 6 takes its place."""
        steps = (
            self.tr("Copy the folder off the device and drop it on this window, or open it with Ctrl+O."),
            self.tr(
                "Or record here: Ctrl+N shows the devices, F5 begins, M marks what is passed, F5 pressed twice stops."
            ),
            self.tr("Look at the findings, fill in the form and the tie points, and press Process."),
            self.tr("Go through the candidates: Space plays, 1 confirms, 2 rejects, 3 leaves it open."),
            self.tr("Press Enter for a note. Ctrl+Z takes back whatever you did."),
            self.tr("Export with Ctrl+E: the report, the tables and the map file are written into the survey folder."),
        )
        items = "".join(f"<li>{escape(step)}</li>" for step in steps)
        saved = self.tr("Everything is saved at once. You may close the laptop at any moment.")
        fixed = self.tr(
            "Two fixed sensors either side of a leak: Ctrl+K opens the correlator. Drop both recordings on it, say "
            "what pipe lies between them, and read the leak's place; tap on the pipe beyond a sensor to measure the "
            "speed."
        )
        return (
            f"<h2>{escape(self.tr('From folder to report'))}</h2><ol>{items}</ol><p>{escape(saved)}</p>"
            f"<p>{escape(fixed)}</p>"
        )

    def show_guide(self, keys_html: str) -> None:
        """Show the guide with the key sheet below it."""
        self.findChildren(QTextBrowser)[0].setHtml(self.guide() + keys_html)
