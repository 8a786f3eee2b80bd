"""Fills the start page: recent surveys from what is remembered of them, then whether their folders are there.

The list shows at once, whatever discs and network shares are slow; a quiet job asks for the folders behind it.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.jobs import Job, Jobs
from app.readiness_facts import newest_export_day
from app.settings import PreferencesStore
from app.survey_cards import CardStore, SurveyCard, card_of, is_there, peeked
from app.survey_session import SurveySession
from processing import messages
from processing.progress import Progress
from widgets.recent_surveys import Presence, RecentRow
from widgets.units import quantities

if TYPE_CHECKING:
    from app.main_window import MainWindow

Answer = dict[str, tuple[bool, SurveyCard | None]]  # path -> its folder is there; what it says, where nothing was known


class StartControl(QObject):
    """Connects the start page with preferences, cards and the open survey."""

    def __init__(self, window: "MainWindow", session: SurveySession, jobs: Jobs, preferences: PreferencesStore) -> None:
        super().__init__(window)
        self._window, self._session, self._jobs, self._preferences = window, session, jobs, preferences
        self._page = window.start_page
        self._cards = CardStore(preferences.file.with_name("surveys"))
        self._presence: dict[str, Presence] = {}
        self._written: tuple[str, SurveyCard] | None = None
        self._exported: str | None = None
        self._job: Job | None = None
        self._stopped = False
        self._page.recent.pin_asked.connect(self._pin)
        self._page.recent.removal_asked.connect(self._forget)
        session.opened.connect(self._on_opened)
        session.results_changed.connect(self._on_results)
        for changed in (session.decision_changed, session.candidates_changed, session.survey_changed):
            changed.connect(self._keep)
        window.report.told.connect(self._on_results)
        self._on_opened()

    def show(self) -> None:
        """Show the start page; what is open stays open."""
        self.refresh()
        self._window.show_page("start")

    def refresh(self) -> None:
        """Show the list as it is remembered, and ask behind it which folders are there."""
        if self._stopped:
            return
        self._show()
        paths = self._paths()
        unknown = tuple(path for path in paths if self._cards.read(path) is None)
        if not paths:
            return
        self._leave_job()
        self._job = self._jobs.start(
            lambda progress: _look(paths, unknown, progress),
            title=self.tr("Looking for the recent surveys"),
            on_success=self._take,
            quiet=True,
        )

    def stop(self) -> None:
        """Ask nothing more: the window closes."""
        self._stopped = True
        self._leave_job()

    def _leave_job(self) -> None:
        if self._job is not None:
            self._job.cancel()
            self._job.forget_callbacks()
            self._job = None

    def _paths(self) -> list[str]:
        values = self._preferences.values
        return [*values.pinned, *(path for path in values.recent if path not in values.pinned)]

    def _show(self) -> None:
        pinned = self._preferences.values.pinned
        rows = []
        for path in self._paths():
            card = self._cards.read(path) or SurveyCard(name=Path(path).stem)
            if self._session.reviewer and self._session.folder is not None and path == str(self._session.folder.path):
                card = card_of(self._session, None) or card  # their own verdicts: the first one's stay hidden
            row = row_of(path, card)
            presence = self._presence.get(path, Presence.ASKED)
            rows.append(replace(row, pinned=path in pinned, presence=presence))
        self._page.set_recent(rows)

    def _take(self, answer: Answer) -> None:
        self._job = None
        for path, (there, card) in answer.items():
            self._presence[path] = Presence.THERE if there else Presence.MISSING
            if card is not None:
                self._cards.write(path, card)
        self._show()

    def _pin(self, path: str) -> None:
        pinned = self._preferences.values.pinned
        kept = [other for other in pinned if other != path]
        self._preferences.change(pinned=kept if path in pinned else [path, *kept])
        self._show()

    def _forget(self, path: str) -> None:
        pinned = [other for other in self._preferences.values.pinned if other != path]
        self._preferences.change(pinned=pinned)
        self._preferences.forget_recent(Path(path))
        self._cards.forget(path)
        self._show()

    # --- the open survey ---

    def _on_opened(self) -> None:
        self._written = None
        self._exported = None
        if self._session.folder is None:
            self.refresh()
        else:
            self._keep()

    def _on_results(self) -> None:
        folder = self._session.folder
        self._exported = None if folder is None else newest_export_day(folder.exports_dir)
        self._keep()

    def _keep(self) -> None:
        """Write down what is known of the open survey, where that has changed."""
        folder = self._session.folder
        card = card_of(self._session, self._exported)
        if folder is None or card is None or self._session.reviewer:
            return  # what a second reviewer says is not how far the survey is
        if self._session.results is None and self._cards.read(str(folder.path)) is not None:
            return  # it is being loaded: what is remembered says more
        if self._written != (str(folder.path), card):
            self._written = (str(folder.path), card)
            self._cards.write(*self._written)


def row_of(path: str, card: SurveyCard) -> RecentRow:
    """Return the line of a card, with the pipe in words."""
    known = messages.table("materials", quantities().language)
    pipe = [known.get(card.material.lower().replace(" ", "_"), card.material)]
    if card.diameter_m is not None:
        pipe.append(quantities().small_length(card.diameter_m))
    return RecentRow(
        path=path,
        name=card.name or Path(path).stem,
        folder=str(Path(path).parent),
        date=card.date,
        client=card.client,
        pipe=" ".join(part for part in pipe if part),
        length_m=card.length_m,
        candidates=card.candidates,
        decided=card.decided,
        confirmed=card.confirmed,
        exported=card.exported,
        simulated=card.simulated,
        outline=card.outline,
    )


def _look(paths: Sequence[str], unknown: Sequence[str], progress: Progress) -> Answer:
    found: Answer = {}
    for number, path in enumerate(paths):
        progress.update(number / len(paths), "import_looking")
        there = is_there(Path(path))
        found[path] = (there, peeked(Path(path)) if there and path in unknown else None)
    return found
