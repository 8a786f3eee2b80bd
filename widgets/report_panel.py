"""What an export would say and write, the button that does it, and the exports made so far."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QPushButton,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Verdict
from widgets.candidate_row import CandidateRow
from widgets.quiet_combo import QuietCombo
from widgets.units import quantities
from widgets.vocabulary import class_text, half_width_m, length_cell, place_cell, place_title, verdict_text, width_title


@dataclass(frozen=True)
class ReportPreview:
    """The figures shown before anything is written."""

    title: str
    length_m: float | None
    rows: tuple[CandidateRow, ...]
    not_assessed_count: int
    folder: str  # where it will be written


class ReportPanel(QWidget):
    """Signals out; it writes nothing itself."""

    export_asked = Signal(str)  # language of the report
    open_folder_asked = Signal(str)  # the chosen export, or empty for the latest

    def __init__(self, language: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._preview = QTextBrowser()
        self._preview.setFrameShape(QFrame.Shape.NoFrame)
        self._preview.setOpenLinks(False)
        self._language = QuietCombo()
        self._language.setMinimumHeight(44)
        self._language.addItem("English", "en")
        self._language.addItem("Türkçe", "tr")
        self._language.setCurrentIndex(max(0, self._language.findData(language)))
        self._language.setAccessibleName(self.tr("Language of the report"))
        self._export = QPushButton(self.tr("Export report and files"))
        self._export.setObjectName("export")
        self._export.setMinimumHeight(52)
        self._export.clicked.connect(lambda: self.export_asked.emit(self._language.currentData()))
        self._open = QPushButton(self.tr("Open folder"))
        self._open.setObjectName("open_exports")
        self._open.setMinimumHeight(52)
        self._open.clicked.connect(self._on_open)
        self._exports = QListWidget()
        self._exports.setAccessibleName(self.tr("Exports so far"))
        self._exports.itemDoubleClicked.connect(lambda _item: self._on_open())
        self._lay_out()
        self.set_exports(())

    def _lay_out(self) -> None:
        side = QVBoxLayout()
        label = QLabel(self.tr("Language of the report"))
        label.setBuddy(self._language)
        side.addWidget(label)
        side.addWidget(self._language)
        side.addWidget(self._export)
        side.addSpacing(16)
        side.addWidget(QLabel(self.tr("Exports so far")))
        side.addWidget(self._exports, 1)
        side.addWidget(self._open)
        layout = QHBoxLayout(self)
        layout.addWidget(self._preview, 3)
        layout.addLayout(side, 2)

    @property
    def language(self) -> str:
        """The language chosen for the report."""
        return str(self._language.currentData())

    def set_preview(self, preview: ReportPreview | None) -> None:
        """Show what would be written; None while there is nothing to report."""
        self._export.setEnabled(preview is not None)
        if preview is None:
            text = self.tr("There is nothing to report yet. Open and process a survey.")
            self._preview.setHtml(f"<p>{escape(text)}</p>")
            return
        self._preview.setHtml(self._html(preview))

    def set_exports(self, names: Sequence[str]) -> None:
        """Show the exports made so far, newest first."""
        self._exports.clear()
        self._exports.addItems(list(names))
        self._open.setEnabled(bool(names))

    def plain_text(self) -> str:
        """Return the preview as plain text."""
        return self._preview.toPlainText()

    def _on_open(self) -> None:
        item = self._exports.currentItem()
        self.open_folder_asked.emit("" if item is None else item.text())

    def _html(self, preview: ReportPreview) -> str:
        counts = {v: sum(r.decision.verdict is v for r in preview.rows) for v in Verdict}
        open_ones = counts[Verdict.NONE] + counts[Verdict.UNSURE]
        parts = [f"<h2>{escape(preview.title)}</h2>"]
        if open_ones:
            text = self.tr("This is a draft: candidates undecided or unsure: {count}").format(count=open_ones)
            parts.append(f"<p><b>{escape(text)}</b></p>")
        if preview.length_m is not None:
            parts.append(f"<p>{escape(self.tr('Length of the path'))}: {quantities().length(preview.length_m)}</p>")
        if preview.not_assessed_count:
            text = self.tr("Stretches not assessed, listed in the report: {count}")
            parts.append(f"<p>{escape(text.format(count=preview.not_assessed_count))}</p>")
        parts.append(self._table(preview.rows))
        files = (
            ("report.pdf", self.tr("the report with map, accuracy and one section a leak")),
            ("leaks.csv", self.tr("one row a candidate")),
            ("track.csv", self.tr("the path with its accuracy")),
            ("leaks.geojson", self.tr("the same for a map program")),
            ("summary.json", self.tr("settings, versions and file hashes")),
        )
        parts.append(f"<h3>{escape(self.tr('These files will be written'))}</h3><table cellpadding='3'>")
        parts += [f"<tr><td><b>{name}</b></td><td>{escape(what)}</td></tr>" for name, what in files]
        parts.append(f"</table><p>{escape(self.tr('to'))} {escape(preview.folder)}</p>")
        return "".join(parts)

    def _table(self, rows: Sequence[CandidateRow]) -> str:
        head = (
            self.tr("No."),
            self.tr("Verdict"),
            self.tr("Class"),
            place_title(),
            width_title(),
            self.tr("Note"),
        )
        cells = "".join(f"<th align='left'>{escape(h)}</th>" for h in head)
        lines = [f"<table cellpadding='4'><tr>{cells}</tr>"]
        for row in rows:
            values = (
                row.name,
                verdict_text(row.decision.verdict),
                class_text(row.decision.leak_class or row.candidate.leak_class),
                place_cell(row.candidate.chainage_m),
                length_cell(half_width_m(row.candidate)),
                row.decision.note,
            )
            lines.append("<tr>" + "".join(f"<td>{escape(v)}</td>" for v in values) + "</tr>")
        return "".join(lines) + "</table>"
