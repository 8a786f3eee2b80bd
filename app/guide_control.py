"""Keeps the lights of the step bar true, tells what is missing when one is pressed, and leads to where it is mended."""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QPushButton

from app import actions, readiness_facts
from app.actions import ACTIONS
from app.survey_session import SurveySession
from processing import messages
from processing.readiness import Facts, Lead, Note, Step, StepState, next_thing, readiness, sentence
from widgets.plot_theme import Theme
from widgets.readiness_bubble import ReadinessBubble, ReadinessRow
from widgets.units import quantities

if TYPE_CHECKING:
    from app.main_window import MainWindow

# the action whose key and text stand on the button that leads there; the others have words of their own
ACTION_OF_LEAD = {
    Lead.OPEN: "open",
    Lead.DATA: "page_data",
    Lead.PATH: "page_path",
    Lead.SOUND: "page_sound",
    Lead.LEAKS: "page_leaks",
    Lead.UNDECIDED: "undecided",
    Lead.REPORT: "page_report",
    Lead.EXPORT: "export",
}


class GuideControl(QObject):
    """Connects what the session tells with the step bar; nothing here changes a survey."""

    changed = Signal()  # the lights

    def __init__(self, window: "MainWindow", session: SurveySession, language: str, theme: Theme) -> None:
        super().__init__(window)
        self._window, self._session, self._language, self._theme = window, session, language, theme
        self.states: tuple[StepState, ...] = ()
        self._exported_s: float | None = None
        self._changed_s: float | None = None
        self._bubble: ReadinessBubble | None = None
        self._later = QTimer(self)
        self._later.setSingleShot(True)
        self._later.setInterval(0)
        self._later.timeout.connect(self.refresh)
        session.opened.connect(self._on_opened)
        session.results_changed.connect(self._on_opened)
        session.decision_changed.connect(self._on_decision)
        for changed in (session.candidates_changed, session.survey_changed, window.data_page.survey_edited):
            changed.connect(self._soon)
        window.data_page.state_changed.connect(self._soon)
        window.report.told.connect(self._on_exported)
        window.step_bar.light_pressed.connect(self.show_step)
        window.step_bar.ties_chosen.connect(self.show_ties)
        window.step_bar.apply_theme(theme)
        self._on_opened()

    def facts(self) -> Facts:
        """Return what is known now of what is open or looked at."""
        window, session = self._window, self._session
        if session.folder is None and window.files.previewing:
            return readiness_facts.facts_of_preview(window.data_page.survey, readable=window.files.ready)
        length = self.tr("the pipe's length")
        return readiness_facts.facts_of_session(session, self._exported_s, self._changed_s, length)

    def refresh(self) -> None:
        """Set all lights."""
        self._later.stop()
        self.states = readiness(self.facts())
        bar, words = self._window.step_bar, messages.table("lights", self._language)
        for state in self.states:
            text = " ".join(sentence(note, quantities()) for note in state.notes)
            bar.set_light(state.step.value, state.light, words[state.light.value], text)
        if self._bubble is not None and self._bubble.isVisible():
            self._bubble.close_bubble()  # what it says may not be true any more
        self.changed.emit()

    # --- telling ---

    def show_step(self, step: str) -> None:
        """Tell everything that is to be known about a step, beside its light."""
        self.refresh()
        state = next(state for state in self.states if state.step.value == step)
        rows = [self._row(note, "") for note in state.notes]
        self._show(rows, step)

    def show_all(self) -> None:
        """Tell what is missing in every step, the gravest of each; pressed again, take it away."""
        if self._bubble is not None and self._bubble.isVisible():
            self._bubble.close_bubble()
            return
        self.refresh()
        titles = self._titles()
        rows = [self._row(state.notes[0], titles[state.step]) for state in self.states]
        first = next_thing(self.states)
        step = next((state.step for state in self.states if first in state.notes), Step.DATA)
        self._show(rows, step.value)

    def apply_theme(self, theme: Theme) -> None:
        """Draw the lights in these colours."""
        self._theme = theme
        self._window.step_bar.apply_theme(theme)
        if self._bubble is not None:
            self._bubble.apply_theme(theme)

    def stop(self) -> None:
        """Leave nothing behind: the window closes."""
        self._later.stop()

    def _show(self, rows: list[ReadinessRow], step: str) -> None:
        if self._bubble is None:
            self._bubble = ReadinessBubble(self._window)
            self._bubble.lead_chosen.connect(self.go)
            self._bubble.manual_asked.connect(lambda: self._window.help.show_page("lights"))
            self._bubble.apply_theme(self._theme)
        self._bubble.set_rows(rows)
        self._bubble.stand_beside(self._window.step_bar.light_button(step))
        self._bubble.focus_first()

    def _row(self, note: Note, title: str) -> ReadinessRow:
        lead = "" if note.lead is None else note.lead.value
        text = "" if note.lead is None else self._lead_text(note.lead)
        return ReadinessRow(note.light, title, sentence(note, quantities()), lead, text)

    def _titles(self) -> dict[Step, str]:
        return {
            Step.DATA: self.tr("Data"),
            Step.TIES: self.tr("Tie points"),
            Step.PATH: self.tr("Path"),
            Step.SOUND: self.tr("Sound"),
            Step.LEAKS: self.tr("Leaks"),
            Step.REPORT: self.tr("Report"),
        }

    def _lead_text(self, lead: Lead) -> str:
        own = {
            Lead.FORM: self.tr("To the form"),
            Lead.TIES: self.tr("To the tie points"),
            Lead.PROCESS: self.tr("Process"),
        }
        if lead in own:
            return own[lead]
        row = next(row for row in ACTIONS if row.id == ACTION_OF_LEAD[lead])
        return f"{actions.translated(row.short or row.text)}  {actions.shown_keys(row)}"

    # --- leading ---

    def go(self, lead: str) -> None:
        """Go to where a thing is mended."""
        if self._bubble is not None:
            self._bubble.close_bubble()
        window = self._window
        ways: dict[Lead, Callable[[], object]] = {
            Lead.OPEN: window.files.ask_open,
            Lead.DATA: lambda: window.show_page("data"),
            Lead.FORM: self._show_form,
            Lead.TIES: self.show_ties,
            Lead.PROCESS: window.files.process,
            Lead.PATH: lambda: window.show_page("path"),
            Lead.SOUND: lambda: window.show_page("sound"),
            Lead.LEAKS: lambda: window.show_page("leaks"),
            Lead.UNDECIDED: self._show_undecided,
            Lead.REPORT: lambda: window.show_page("report"),
            Lead.EXPORT: self._show_export,
        }
        ways[Lead(lead)]()

    def show_ties(self) -> None:
        """Show the tie points: beside the plan where there is a path, else beside the form."""
        results = self._session.results
        if results is not None and results.track is not None:
            self._window.show_page("path")
            self._window.review_page.tools.choose("markers")
            return
        self._window.show_page("data")
        self._window.data_page.show_tie_points()

    def _show_form(self) -> None:
        self._window.show_page("data")
        self._window.data_page.show_form()

    def _show_undecided(self) -> None:
        self._window.show_page("leaks")
        self._window.review.next_undecided()

    def _show_export(self) -> None:
        self._window.show_page("report")
        button = self._window.report_panel.findChild(QPushButton, "export")
        if button is not None:
            button.setFocus()

    # --- hearing ---

    def _on_opened(self) -> None:
        folder = self._session.folder
        self._exported_s = None if folder is None else readiness_facts.newest_export_s(folder.exports_dir)
        self._changed_s = readiness_facts.last_decision_s(self._session)
        self._soon()

    def _on_decision(self, _candidate_id: int) -> None:
        self._changed_s = time.time()
        self._soon()

    def _on_exported(self) -> None:
        folder = self._session.folder
        self._exported_s = None if folder is None else readiness_facts.newest_export_s(folder.exports_dir)
        self._soon()

    def _soon(self) -> None:
        """Set the lights once for all that is told in one go."""
        self._later.start()
