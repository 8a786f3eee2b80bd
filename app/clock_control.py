"""Feeds the panel of the clocks with what the present results rest on."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.survey_session import SurveySession
from processing import messages
from widgets.clock_panel import ClockPanel
from widgets.units import quantities

if TYPE_CHECKING:
    from app.page_tools import PageTools

NAME = "clock"


class ClockControl(QObject):
    """Works only while the panel is in front."""

    def __init__(
        self,
        session: SurveySession,
        tools: "PageTools",
        panel: ClockPanel,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._tools, self._panel, self._language = session, tools, panel, language
        session.results_changed.connect(self._show)
        tools.chosen.connect(lambda _name: self._show())

    def _show(self) -> None:
        if not self._tools.is_in_front(NAME):
            return
        results = self._session.results
        fit = results.clock_fit if results is not None else None
        if fit is None:
            self._panel.show_clock("", None)
            return
        from processing.clock_picture import clock_picture

        sentences = [messages.finding_sentence(finding, self._language, quantities().units) for finding in fit.findings]
        if fit.clock.basis == "given":
            sentences.insert(0, messages.text("report", "accuracy_clock_given", self._language))
        self._panel.show_clock(" ".join(sentences), clock_picture(fit))
