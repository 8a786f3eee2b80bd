"""The second reviewer: blind review by a name, then the differences, and the opinions of a colleague's copy."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog

from app.opinion_commands import TakeOpinions
from app.page_host import PageHost
from app.review_commands import Decide
from app.services import Services
from processing.agreement import FEW, Agreement, agreement, differences
from processing.errors import LeaklineError
from processing.storage.colleague import Colleague, matched, read_colleague, sums_of
from processing.storage.opinions import reviewer_name
from processing.storage.review import LogEntry
from processing.survey import Decision
from widgets.differences_panel import DifferenceRow, DifferencesPanel
from widgets.plot_theme import Theme
from widgets.reviewer_dialog import ReviewerDialog
from widgets.units import quantities
from widgets.vocabulary import half_width_m

if TYPE_CHECKING:
    from collections.abc import Mapping

    from PySide6.QtGui import QAction

    from app.main_window import MainWindow

PAGE = "differences"
# they show what the first said, or what a dig showed
BLIND_OFF = (
    "dig",
    "export",
    "preview_report",
    "page_report",
    "process",
    "route",
    "route_remove",
    "differences",
    "opinions_import",
)


class SecondReview(QObject):
    """Public methods without arguments are actions' handlers."""

    told = Signal(str)

    def __init__(self, window: "MainWindow", services: Services, host: PageHost, theme: Theme) -> None:
        super().__init__(window)
        self._window, self._session, self._jobs = window, services.session, services.jobs
        self._preferences, self._host, self._theme = services.preferences, host, theme
        self._chosen = ""  # whose differences are shown
        self.panel: DifferencesPanel | None = None
        host.openers[PAGE] = self.show_differences
        session = self._session
        for changed in (session.decision_changed, session.candidates_changed, session.opinions_changed):
            changed.connect(self._show)
        session.opened.connect(self._show)
        session.reviewer_changed.connect(lambda: window.notices.show_state(session))

    # --- actions ------------------------------------------------------------------------------------------------

    def toggle(self) -> None:
        """Ask for the second reviewer's name and begin; in a second review, end it and show the differences."""
        session = self._session
        if session.reviewer:
            self.end()
            return
        if session.folder is None or session.results is None:
            return
        if not session.writable:
            session.write(lambda: None)  # which tells that nothing can be written
            return
        if any(not job.quiet for job in self._jobs.running):  # a run that ends meanwhile would be the second one's
            self._window.boxes.tell(self.tr("Please wait until the work in progress has ended."))
            return
        known = session.folder.opinions.reviewers()
        proposed = self._preferences.values.reviewer
        if proposed.casefold() == session.operator.casefold():
            proposed = ""
        dialog = ReviewerDialog(session.operator, proposed, known, self._window)
        if dialog.exec() == ReviewerDialog.DialogCode.Accepted:
            self.begin(dialog.name)

    def begin(self, name: str) -> None:
        """Review blind as ``name``."""
        self._window.review_page.decision.flush()
        name = reviewer_name(name)
        self._preferences.change(reviewer=name)
        self._session.set_reviewer(name)
        self._window.show_page("leaks")
        text = self.tr("Second review by {name}: the first verdicts are hidden. Ctrl+J ends it.")
        self.told.emit(text.format(name=name))

    def end(self) -> None:
        """Go back to the first review, and show where both differ."""
        self._window.review_page.decision.flush()
        self._chosen = self._session.reviewer
        self._session.set_reviewer("")
        self.show_differences()
        found = 0 if self.panel is None else len(self.panel.shown)
        self.told.emit(self.tr("The second review has ended. Differences: {count}.").format(count=found))

    def show_differences(self) -> None:
        """Show where the reviewers differ, or the leaks page where that is in front already."""
        if self._session.reviewer or self._session.results is None:
            return
        if self._host.current() == PAGE:
            self._host.show("leaks")
            return
        panel = self.panel or self._build()
        self._host.show(PAGE)
        self._show()
        panel.focus()

    def ask_import(self) -> None:
        """Ask for a colleague's copy of this survey and take the second opinions in it."""
        if self._session.folder is None or self._session.reviewer:
            return
        start = str(self._session.folder.path.parent)
        chosen = QFileDialog.getExistingDirectory(self._window, self.tr("A colleague's copy of this survey"), start)
        if chosen:
            self.import_from(Path(chosen))

    def import_from(self, path: Path) -> None:
        """Take the second opinions of another copy of this survey."""
        self._jobs.start(
            lambda _progress: read_colleague(path), title=self.tr("Reading opinions"), on_success=self._take
        )

    def show_enabled(self, actions_by_id: "Mapping[str, QAction]") -> None:
        """Switch off, during a second review, what would show or change what the first said."""
        if self._session.results is None:
            for name in ("second_review", "differences", "opinions_import"):
                actions_by_id[name].setEnabled(False)
        if self._session.reviewer:
            for name in BLIND_OFF:
                actions_by_id[name].setEnabled(False)
            self._window.step_bar.set_enabled("report", enabled=False)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        if self.panel is not None:
            self.panel.apply_theme(theme)

    # --- inside -------------------------------------------------------------------------------------------------

    def _build(self) -> DifferencesPanel:
        panel = self.panel = DifferencesPanel(self._theme)
        self._host.add(PAGE, panel)
        panel.keep_asked.connect(self._keep)
        panel.take_asked.connect(self._take_second)
        panel.open_asked.connect(self._open)
        panel.reviewer_chosen.connect(self._choose)
        panel.import_asked.connect(self.ask_import)
        panel.back_asked.connect(self.show_differences)
        return panel

    def _take(self, colleague: Colleague) -> None:
        session = self._session
        if session.folder is None:
            return
        candidates = [row.candidate for row in session.rows()]
        try:
            found = matched(colleague, sums_of(session.folder), candidates)
        except LeaklineError as error:
            self._window.boxes.error(error)
            return
        names = ", ".join(found.opinions)
        session.push(TakeOpinions(session, self.tr("opinions of {name}").format(name=names), found.opinions))
        self._chosen = next(iter(found.opinions))
        count = sum(len(decisions) for decisions in found.opinions.values())
        text = self.tr("Opinions taken: {count} of {name}.").format(count=count, name=names)
        if found.left_out:
            left = self.tr("Left out, as their leak is not at its place here: {count}.").format(count=found.left_out)
            text = f"{text} {left}"
        self.told.emit(text)
        if self._host.current() == PAGE:
            self._show()
        else:
            self.show_differences()

    def _choose(self, reviewer: str) -> None:
        self._chosen = reviewer
        self._show()

    def _show(self) -> None:
        panel, session = self.panel, self._session
        if panel is None or self._host.current() != PAGE or session.folder is None or session.reviewer:
            return
        reviewers = session.folder.opinions.reviewers()
        if self._chosen not in reviewers:
            self._chosen = reviewers[0] if reviewers else ""
        panel.show_reviewers(session.operator, reviewers, self._chosen)
        panel.show_agreement(self._agreement_text(agreement(self._firsts(), self._seconds())))
        panel.show_rows(self._rows(), writable=session.writable)

    def _firsts(self) -> dict[int, Decision]:
        return {row.candidate.label: row.decision for row in self._session.rows() if row.decision != Decision()}

    def _seconds(self) -> dict[int, Decision]:
        folder = self._session.folder
        return folder.opinions.of(self._chosen) if folder is not None and self._chosen else {}

    def _rows(self) -> list[DifferenceRow]:
        session, words = self._session, quantities()
        folder = session.folder
        rows = {row.candidate.label: row for row in session.rows()}
        said_at = {} if folder is None else {o.number: o.at_utc for o in folder.opinions.opinions(self._chosen)}
        settled: frozenset[int] = frozenset()
        if folder is not None:
            numbers = {i: number for i, (_run, number) in folder.review.known_as().items()}
            settled = settled_numbers(folder.review.decision_log(), numbers, said_at)
        out = []
        for difference in differences(self._firsts(), self._seconds()):
            row = rows.get(difference.number)
            if row is None:
                continue  # another run did not find this leak again
            place = f"{words.place(row.candidate.chainage_m)} ± {words.length(half_width_m(row.candidate))}"
            candidate_id = row.candidate.id
            out.append(
                DifferenceRow(
                    candidate_id, row.name, place, difference.first, difference.second, difference.number in settled
                )
            )
        return out

    def _agreement_text(self, found: Agreement) -> str:
        if not self._chosen:
            return self.tr("Nobody has reviewed a second time yet. Ctrl+J begins.")
        words = quantities()
        text = self.tr("Judged by both: {count}, alike: {alike}.").format(count=found.count, alike=found.alike)
        if found.kappa is None or found.low95 is None or found.high95 is None:
            return text
        figures = [words.number(value, 2) for value in (found.kappa, found.low95, found.high95)]
        kappa = self.tr("Cohen's kappa (1: full agreement, 0: as by chance) {kappa}, 95 % interval {low} … {high}.")
        parts = [text, kappa.format(kappa=figures[0], low=figures[1], high=figures[2])]
        if found.count < FEW:
            parts.append(self.tr("With so few leaks this figure says little."))
        return " ".join(parts)

    def _keep(self, candidate_id: int) -> None:
        """Decide anew what was decided: a line in the log says that the second opinion was weighed."""
        row = self._session.row(candidate_id)
        if row is not None:
            text = self.tr("{name}: first verdict kept").format(name=row.name)
            self._session.push(Decide(self._session, text, candidate_id, row.decision))

    def _take_second(self, candidate_id: int) -> None:
        row = self._session.row(candidate_id)
        second = None if row is None else self._seconds().get(row.candidate.label)
        if row is not None and second is not None:
            text = self.tr("{name}: second verdict taken").format(name=row.name)
            after = replace(second, note=both_notes(row.decision.note, second.note, self._chosen))
            self._session.push(Decide(self._session, text, candidate_id, after))

    def _open(self, candidate_id: int) -> None:
        self._session.select(candidate_id)
        self._host.show("leaks")
        self._window.review.go_to_candidate()


def both_notes(first: str, second: str, name: str) -> str:
    """Return the notes of both, so that taking a verdict loses no word; the second one's under its author's name."""
    if not first.strip() or first.strip() == second.strip():
        return second
    return f"{first}\n{name}: {second}" if second.strip() else first


def settled_numbers(
    log: "tuple[LogEntry, ...]", numbers: "Mapping[int, int]", said_at: "Mapping[int, str]"
) -> frozenset[int]:
    """Return the leaks (by number) decided since the second opinion (UTC) was given, unless that was undone.

    ``numbers`` is candidate id → number: another run gives a leak another id, and settles nothing anew.
    """
    out: dict[int, bool] = {}
    for entry in log:
        number = numbers[entry.candidate_id]
        said = said_at.get(number)
        if said is not None and entry.at_utc > said and entry.reason in ("decide", "undo", "redo"):
            out[number] = entry.reason != "undo"
    return frozenset(number for number, settled in out.items() if settled)
