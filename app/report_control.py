"""The report page: what would be written, the export and its pages as jobs, and the exports made so far."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog

from app.handover_choices import handover_options, remember_handover
from app.jobs import Job
from app.report_choices import report_options
from app.services import Services
from app.settings import surveys_folder
from processing import messages
from processing.progress import Progress
from processing.storage.record import review_record
from processing.survey import Verdict
from widgets.report_panel import PastExport
from widgets.report_words import ExportOutcome, ReportPreview
from widgets.units import quantities

if TYPE_CHECKING:
    from app.main_window import MainWindow
    from processing.importing.route_files.crs import CrsEntry
    from processing.reporting.handover.outcome import Written
    from processing.reporting.options import HandoverOptions, ReportOptions
    from processing.results import Results
    from processing.review_facts import ReviewRecord
    from processing.survey import Decision

PREVIEW_PPI = 100.0  # a page is then some 830 pixels wide


class ReportControl(QObject):
    """Connects session, preferences and jobs with the report panel."""

    told = Signal(str)

    def __init__(self, window: "MainWindow", services: Services, language: str) -> None:
        super().__init__(window)
        self._window, self._language = window, language
        self._session, self._jobs, self._preferences = services.session, services.jobs, services.preferences
        self._panel = panel = window.report_panel
        self._job: Job | None = None
        self._systems: tuple[CrsEntry, ...] = ()
        self._asked = False  # for the systems: only once
        self.last_export: Path | None = None
        panel.set_language(report_options(self._preferences.values, language).language)
        panel.form.set_options(handover_options(self._preferences.values))
        panel.export_asked.connect(self._export)
        panel.cancel_asked.connect(self._cancel)
        panel.pages_asked.connect(self._make_pages)
        panel.open_folder_asked.connect(self._open_folder)
        panel.open_report_asked.connect(self._open_report)
        panel.undecided_asked.connect(self.go_to_undecided)
        panel.language_changed.connect(self._keep_language)
        panel.form.changed.connect(self._keep_choices)
        self._session.opened.connect(self._on_opened)

    # --- showing ---

    def refresh(self) -> None:
        """Show what an export would say now."""
        session, panel = self._session, self._panel
        panel.set_language(report_options(self._preferences.values, self._language).language)
        folder, results = session.folder, session.results
        if folder is None or results is None:
            panel.set_preview(None)
            panel.set_exports(())
            return
        track = results.track
        length_m = float(track.chainage_m[-1]) if track is not None and len(track.chainage_m) else None
        title = session.survey.info.name or folder.path.stem
        rows = tuple(session.rows())
        place = str(folder.exports_dir) if session.writable else self.tr("a folder that you choose")
        panel.set_preview(ReportPreview(title, length_m, rows, len(results.not_assessed), place))
        panel.set_exports([_past(path) for path in self._exports()])
        if self._window.page == "report":
            self._offer_systems(results)

    def go_to_undecided(self) -> None:
        """Show the next place without a verdict, else the next unsure one, on the page of the leaks."""
        session = self._session
        target = session.next_undecided(after=session.selected)
        if target is None and session.selected is not None:
            target = session.selected if session.decision(session.selected).verdict is Verdict.NONE else None
        if target is None:
            unsure = (i for i in session.ordered_ids() if session.decision(i).verdict is Verdict.UNSURE)
            target = next(unsure, None)
        if target is not None:
            self._window.show_page("leaks")
            session.select(target)

    def _on_opened(self) -> None:
        self._panel.set_outcome(None)
        self.refresh()

    def _offer_systems(self, results: "Results") -> None:
        """Fill the list of coordinate systems; the register is read once, beside the window."""
        from processing.coordinates import frame_of
        from processing.importing.route_files.crs import crs_label
        from processing.reporting.handover.system import proposed

        frame = frame_of(results.survey)
        if not frame.is_geographic:
            self._panel.form.set_systems((), (), None, "")
            return
        if not self._systems and not self._asked:
            self._asked = True
            self._jobs.start(
                _all_systems, title=self.tr("Coordinate systems"), on_success=self._take_systems, quiet=True
            )
        near = (frame.longitude, frame.latitude) if frame.longitude is not None and frame.latitude is not None else None
        recent = self._preferences.values.recent_crs
        self._panel.form.set_systems(self._systems, recent, near, crs_label(proposed(frame)))

    def _take_systems(self, systems: "tuple[CrsEntry, ...]") -> None:
        self._systems = systems
        if self._session.results is not None and systems:
            self._offer_systems(self._session.results)

    # --- choices ---

    def _keep_choices(self) -> None:
        remember_handover(self._preferences, self._panel.form.options)

    def _keep_language(self, language: str) -> None:
        self._preferences.change(report_language=language)
        self._panel.show_words()

    def _options(self, language: str) -> "ReportOptions":
        return replace(report_options(self._preferences.values, self._language), language=language)

    # --- making ---

    def export(self) -> None:
        """Write everything, in the language that the page shows."""
        self._export(self._panel.language)

    def preview(self) -> None:
        """Show the pages of the report as pictures, or the list again."""
        self._window.show_page("report")
        self._panel.toggle_pages()

    def _export(self, language: str) -> None:
        results = self._session.results
        if results is None or self._job is not None or self.told_blind():
            return
        self._keep_choices()
        fresh = self._session.writable and self._session.run is not None
        target = self._target()
        if target is None:
            return
        told, record, options = self._told(results), self._record(), self._options(language)
        decisions, handover = self._session.decisions, handover_options(self._preferences.values)

        def write(progress: Progress) -> "Written":
            return _write(told, decisions, record, options, handover, target, progress, fresh=fresh)

        self._start(write, self.tr("Export"), lambda written: self._exported(target, written))

    def told_blind(self) -> bool:
        """Tell that there is no report during a second review: it would take the second one's verdicts for decided."""
        if self._session.reviewer:
            self.told.emit(self.tr("End the second review first (Ctrl+J): a report tells what was decided in the end."))
        return bool(self._session.reviewer)

    def _make_pages(self, language: str) -> None:
        results = self._session.results
        if results is None or self._job is not None or self.told_blind():
            return
        told, record, options = self._told(results), self._record(), self._options(language)
        decisions = self._session.decisions

        def draw(progress: Progress) -> tuple[bytes, ...]:
            return _pages(told, decisions, record, options, progress)

        self._start(draw, self.tr("Pages of the report"), self._panel.set_pages)

    def _start(self, step: Callable[[Progress], Any], title: str, done: Callable[[Any], None]) -> None:
        self._job = job = self._jobs.start(step, title=title, on_success=done)
        self._panel.set_progress(0.0, title)
        job.reported.connect(lambda fraction, phrase: self._panel.set_progress(fraction, self._phrase(phrase, title)))
        job.finished.connect(self._ended)

    def _phrase(self, phrase: str, title: str) -> str:
        return messages.table("progress", self._language).get(phrase, title)

    def _ended(self) -> None:
        self._job = None
        self._panel.set_progress(None)

    def _cancel(self) -> None:
        if self._job is not None:
            self._job.cancel()

    def _told(self, results: "Results") -> "Results":
        """The results with what was told since: a known leak, wider intervals; neither computes anything anew."""
        told = self._session.survey
        pipe = replace(results.survey.pipe, pressure_bar=told.pipe.pressure_bar)
        survey = replace(results.survey, calibration_leak=told.calibration_leak, pipe=pipe, stated=told.stated)
        return replace(results, survey=survey)

    def _record(self) -> "ReviewRecord | None":
        folder = self._session.folder
        history = self._window.work.digs.ledger.history
        if folder is None:
            return None
        record = review_record(folder, self._session.run, history)
        return replace(record, changes=self._window.work.repeat.for_report())

    def _target(self) -> Path | None:
        session = self._session
        if session.folder is None:
            return None
        if session.writable and session.run is not None:
            return session.folder.new_export("leakline", "", session.run)
        chosen = QFileDialog.getExistingDirectory(self._window, self.tr("Export into"), str(surveys_folder().parent))
        return Path(chosen) if chosen else None

    def _exported(self, target: Path, written: "Written") -> None:
        self.last_export = target
        sentences = tuple(messages.finding_sentence(finding, self._language) for finding in written.findings)
        self.refresh()
        self._panel.set_outcome(ExportOutcome(str(target), len(written.files), sentences))
        self.told.emit(self.tr("Written to {folder}").format(folder=target))

    # --- what was made ---

    def _exports(self) -> list[Path]:
        folder = self._session.folder
        if folder is None or not folder.exports_dir.is_dir():
            return []
        found = [path for path in folder.exports_dir.iterdir() if path.is_dir()]
        return sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)

    def _made(self, name: str) -> Path | None:
        """The folder of an export, the latest for no name: where a read-only survey was exported to, too."""
        folder = self._session.folder
        if folder is None:
            return None
        return (
            folder.exports_dir / name if name else next(iter(self._exports()), self.last_export or folder.exports_dir)
        )

    def _open_folder(self, name: str) -> None:
        chosen = self._made(name)
        if chosen is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(chosen)))

    def _open_report(self, name: str) -> None:
        chosen = self._made(name)
        if chosen is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(chosen / "report.pdf")))


def _past(path: Path) -> PastExport:
    """What is shown of an export: its name, and when it was made."""
    made = datetime.fromtimestamp(path.stat().st_mtime, UTC).astimezone()  # as the clock on the wall shows it
    when = f"{quantities().day(made.date().isoformat())} {made:%H:%M}"
    return PastExport(path.name, f"{path.name}  ({when})", (path / "report.pdf").is_file())


def _all_systems(_progress: Progress) -> "tuple[CrsEntry, ...]":
    from processing.importing.route_files.crs import all_systems

    return all_systems()


def _write(
    results: "Results",
    decisions: "dict[int, Decision]",
    record: "ReviewRecord | None",
    options: "ReportOptions",
    handover: "HandoverOptions",
    target: Path,
    progress: Progress,
    *,
    fresh: bool,
) -> "Written":
    """Write everything into ``target``; a ``fresh`` folder is gone again where it was cancelled or failed."""
    from processing.reporting.exports import write_exports

    try:
        return write_exports(results, decisions, target, progress, None, record, options, handover)
    except BaseException:
        if fresh:
            shutil.rmtree(target, ignore_errors=True)
        raise


def _pages(
    results: "Results",
    decisions: "dict[int, Decision]",
    record: "ReviewRecord | None",
    options: "ReportOptions",
    progress: Progress,
) -> tuple[bytes, ...]:
    from processing.reporting.content import make_content
    from processing.reporting.pdf import page_pictures

    return page_pictures(make_content(results, decisions, record, options), PREVIEW_PPI, progress)
