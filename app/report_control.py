"""The report page: what would be written, the export as a job, and the exports made so far."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog, QWidget

from app.jobs import Jobs
from app.settings import surveys_folder
from app.survey_session import SurveySession
from processing.progress import Progress
from widgets.report_panel import ReportPanel, ReportPreview

if TYPE_CHECKING:
    from processing.results import Results
    from processing.survey import Decision


class ReportControl(QObject):
    """Connects the session with the report panel."""

    told = Signal(str)

    def __init__(self, session: SurveySession, jobs: Jobs, panel: ReportPanel, parent: QWidget) -> None:
        super().__init__(parent)
        self._session, self._jobs, self._panel, self._window = session, jobs, panel, parent
        self.last_export: Path | None = None
        panel.export_asked.connect(self._export)
        panel.open_folder_asked.connect(self._open_folder)
        session.opened.connect(self.refresh)

    def refresh(self) -> None:
        """Show what an export would say now."""
        session = self._session
        folder, results = session.folder, session.results
        if folder is None or results is None:
            self._panel.set_preview(None)
            self._panel.set_exports(())
            return
        track = results.track
        length_m = float(track.chainage_m[-1]) if track is not None and len(track.chainage_m) else None
        title = session.survey.info.name or folder.path.stem
        rows = tuple(session.rows())
        place = str(folder.exports_dir) if session.writable else self.tr("a folder that you choose")
        self._panel.set_preview(ReportPreview(title, length_m, rows, len(results.not_assessed), place))
        self._panel.set_exports([path.name for path in self._exports()])

    def export(self) -> None:
        """Write everything, in the language that the page shows."""
        self._export(self._panel.language)

    def _export(self, language: str) -> None:
        results = self._session.results
        target = self._target() if results is not None else None
        if results is None or target is None:
            return
        decisions = self._session.decisions
        # a leak may have become a known one since: sizes are told beside it without computing anything anew
        told = self._session.survey
        pipe = replace(results.survey.pipe, pressure_bar=told.pipe.pressure_bar)
        survey = replace(results.survey, calibration_leak=told.calibration_leak, pipe=pipe)
        results = replace(results, survey=survey)
        self._jobs.start(
            lambda progress: _write(results, decisions, target, progress, language),
            title=self.tr("Export"),
            on_success=lambda _paths: self._exported(target),
        )

    def _target(self) -> Path | None:
        session = self._session
        if session.folder is None:
            return None
        if session.writable and session.run is not None:
            return session.folder.new_export("leakline", "", session.run)
        chosen = QFileDialog.getExistingDirectory(self._window, self.tr("Export into"), str(surveys_folder().parent))
        return Path(chosen) if chosen else None

    def _exported(self, target: Path) -> None:
        self.last_export = target
        self.refresh()
        self.told.emit(self.tr("Written to {folder}").format(folder=target))

    def _exports(self) -> list[Path]:
        folder = self._session.folder
        if folder is None or not folder.exports_dir.is_dir():
            return []
        found = [path for path in folder.exports_dir.iterdir() if path.is_dir()]
        return sorted(found, key=lambda path: path.stat().st_mtime, reverse=True)

    def _open_folder(self, name: str) -> None:
        folder = self._session.folder
        if folder is None:
            return
        chosen = folder.exports_dir / name if name else next(iter(self._exports()), folder.exports_dir)
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(chosen)))


def _write(
    results: "Results", decisions: "dict[int, Decision]", target: Path, progress: Progress, language: str
) -> tuple[Path, ...]:
    from processing.reporting.exports import write_exports

    return write_exports(results, decisions, target, progress, language)
