"""What the report page says: the preview before an export, and what became of one."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from PySide6.QtCore import QObject

from processing.reporting.options import FileKind, HandoverOptions
from widgets.candidate_row import CandidateRow
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


@dataclass(frozen=True)
class ExportOutcome:
    """What an export wrote: how many files, where, and sentences on what was left out, cut or failed."""

    folder: str
    files: int
    sentences: tuple[str, ...]


class ReportWords(QObject):
    """Writes HTML; a QObject for its translations."""

    def preview_html(self, preview: ReportPreview | None, options: HandoverOptions) -> str:
        """Return what would be written, as HTML."""
        if preview is None:
            return f"<p>{escape(self.tr('There is nothing to report yet. Open and process a survey.'))}</p>"
        parts = [f"<h2>{escape(preview.title)}</h2>"]
        if preview.length_m is not None:
            parts.append(f"<p>{escape(self.tr('Length of the path'))}: {quantities().length(preview.length_m)}</p>")
        if preview.not_assessed_count:
            text = self.tr("Stretches not assessed, listed in the report: {count}")
            parts.append(f"<p>{escape(text.format(count=preview.not_assessed_count))}</p>")
        parts.append(self._table(preview.rows))
        parts.append(f"<h3>{escape(self.tr('These files will be written'))}</h3><table cellpadding='3'>")
        parts += [f"<tr><td><b>{name}</b></td><td>{escape(what)}</td></tr>" for name, what in self._files(options)]
        parts.append(f"</table><p>{escape(self.tr('to'))} {escape(preview.folder)}</p>")
        return "".join(parts)

    def outcome_html(self, outcome: ExportOutcome) -> str:
        """Return what was written last, as HTML."""
        text = self.tr("{count} files written to {folder}").format(count=outcome.files, folder=outcome.folder)
        parts = [f"<h3>{escape(text)}</h3>"]
        if outcome.sentences:
            parts.append(f"<p><b>{escape(self.tr('Left out or cut:'))}</b></p><ul>")
            parts += [f"<li>{escape(sentence)}</li>" for sentence in outcome.sentences]
            parts.append("</ul>")
        return "".join(parts) + "<hr>"

    def _files(self, options: HandoverOptions) -> list[tuple[str, str]]:
        always = [
            ("report.pdf", self.tr("the report with map, accuracy and one section a leak")),
            ("leaks.csv", self.tr("one row a candidate")),
            ("track.csv", self.tr("the path with its accuracy")),
            ("leaks.geojson", self.tr("the same for a map program")),
            ("summary.json", self.tr("settings, versions and file hashes")),
        ]
        chosen = {
            FileKind.EXCEL_CSV: (
                "leaks-excel.csv",
                self.tr("the same for Excel, and the stretches, headings in words"),
            ),
            FileKind.DECISIONS_CSV: ("decisions.csv", self.tr("who decided what when")),
            FileKind.GEOPACKAGE: ("survey.gpkg", self.tr("leaks, pipe by status and track for QGIS and others")),
            FileKind.SHAPEFILE: ("shapefile/", self.tr("the same as Shapefiles")),
            FileKind.KML: ("survey.kml", self.tr("for Google Earth and phones")),
            FileKind.GPX: ("survey.gpx", self.tr("points and path for GPS receivers")),
            FileKind.DXF: ("survey.dxf", self.tr("the drawing, leaks as blocks")),
            FileKind.RAVEN: ("raven/", self.tr("selection tables for each sound file")),
        }
        files = always + [entry for kind, entry in chosen.items() if kind in options.files]
        files.append(("README.txt", self.tr("all files, columns and units explained")))
        if options.as_zip:
            files.append(("….zip", self.tr("all of it in one file")))
        return files

    def _table(self, rows: Sequence[CandidateRow]) -> str:
        head = (self.tr("No."), self.tr("Verdict"), self.tr("Class"), place_title(), width_title(), self.tr("Note"))
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
