"""Tries several orientation methods on the open recording, shows their paths on the plan, and lets one be used."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.jobs import Job, Jobs
from app.methods import methods
from app.review_commands import EditSurvey
from app.survey_session import SurveySession
from processing import messages
from widgets.compared_paths import ComparedPath
from widgets.method_panel import MethodPanel, MethodRow, Outcome
from widgets.path_view import PathView
from widgets.units import quantities

if TYPE_CHECKING:
    from processing.comparison import Compared
    from processing.progress import Progress

UNTICKED = ("accmag", "gyro", "device")  # they need what few recorders have, or only show a drift


class ComparisonControl(QObject):
    """Connects the session with the table of methods and the plan; the paths live only as long as the results."""

    reprocess_asked = Signal()
    _found = Signal(object)  # Compared, from the worker

    def __init__(
        self,
        session: SurveySession,
        jobs: Jobs,
        panel: MethodPanel,
        plan: PathView,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._jobs, self._panel, self._plan, self._language = session, jobs, panel, plan, language
        self._rows = _ticked(methods(language)["orientation"], self.tr("automatic"))
        self._compared: dict[str, Compared] = {}
        self._job: Job | None = None
        panel.compare_asked.connect(self.compare)
        panel.use_asked.connect(self._use)
        panel.cleared.connect(self.clear)
        panel.selection_changed.connect(self._lift)
        self._found.connect(self._take)
        session.results_changed.connect(self._on_results)
        session.survey_changed.connect(self._show)
        self._on_results()

    def compare(self, names: tuple[str, ...]) -> None:
        """Try these methods, one after the other; each is shown as soon as it is there."""
        results = self._session.results
        if results is None or results.recording.imu is None or self._job is not None:
            return
        imu, survey, settings = results.recording.imu, self._session.survey, self._session.settings
        pairs = [(name, survey.processing.position) for name in names]
        found: Callable[[Compared], None] = self._found.emit

        def step(progress: "Progress") -> object:
            from processing.comparison import compare

            return compare(imu, survey, settings, pairs, progress, found)

        self._compared = {}
        self._panel.set_busy(True)
        job = self._jobs.start(step, title=self.tr("Trying the methods"), on_success=lambda _: None)
        self._job = job
        job.finished.connect(self._ended)
        self._show()

    def clear(self) -> None:
        """Take the paths from the plan, and stop trying."""
        if self._job is not None:
            self._job.cancel()
        self._compared = {}
        self._show()

    def _ended(self) -> None:
        self._job = None
        self._panel.set_busy(False)

    def _on_results(self) -> None:
        self.clear()

    def _take(self, compared: "Compared") -> None:
        if self._job is not None and not self._job.cancelled:
            self._compared[compared.orientation] = compared
            self._show()

    def _use(self, name: str) -> None:
        session = self._session
        survey = replace(session.survey, processing=replace(session.survey.processing, orientation=name))
        session.push(EditSurvey(session, self.tr("orientation method"), survey))
        if session.survey == survey:
            self.reprocess_asked.emit()

    # --- showing ---

    def _lift(self) -> None:
        """Bring the selected method's path out among the others."""
        names = [row.name for row in self._rows]
        selected = self._panel.selected
        self._plan.lift_compared(names.index(selected) if selected in names else -1)

    def _show(self) -> None:
        session = self._session
        self._panel.set_methods(self._rows, session.survey.processing.orientation, writable=session.writable)
        self._panel.set_basis(self._basis())
        styles = {row.name: number for number, row in enumerate(self._rows)}
        outcomes, paths = {}, []
        for name, compared in self._compared.items():
            trouble = "" if compared.trouble is None else messages.error_sentence(compared.trouble, self._language)
            outcomes[name] = Outcome(
                compared.end_error_m,
                compared.end_error_pct,
                compared.end_chainage_error_m,
                compared.length_m,
                trouble,
                styles[name],
            )
            if not trouble:
                title = next(row.title for row in self._rows if row.name == name)
                paths.append(ComparedPath(title, compared.position_w_m[:, :2], styles[name]))
        self._panel.set_outcomes(outcomes)
        self._plan.set_compared(paths)

    def _basis(self) -> str:
        """Say what the errors are measured against."""
        survey = self._session.survey
        ties = [t for t in survey.tie_points if t.enabled]
        placed = [t for t in ties if t.latitude is not None or t.east_m is not None]
        if placed:
            last = max(placed, key=lambda t: t.time_s)
            text = self.tr("'End off' is how far it ends from '{name}'.").format(name=last.name)
            if survey.launch.heading_deg is None and any(c.turned for c in self._compared.values()):
                text += " " + self.tr("No first heading is known, so each path was turned to fit first.")
            return text
        told = [t for t in ties if t.chainage_m is not None]
        if told:
            last = max(told, key=lambda t: t.time_s)
            return self.tr("'Length off' is measured at '{name}'; nothing tells where the end lies.").format(
                name=last.name
            )
        if survey.pipe.length_m is not None:
            return self.tr("'Length off' is measured against the pipe's length of {length}.").format(
                length=quantities().length(survey.pipe.length_m)
            )
        return self.tr("No tie point or length is known, so nothing tells which is right: compare the shapes.")


def _ticked(rows: tuple[MethodRow, ...], automatic: str) -> tuple[MethodRow, ...]:
    return tuple(replace(row, title=row.title or automatic, ticked=row.name not in UNTICKED) for row in rows)
