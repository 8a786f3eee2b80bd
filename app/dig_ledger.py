"""The digs of the open survey, the history of all surveys on this computer, and the one way to write either."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import platformdirs
from PySide6.QtCore import QObject, Signal

from app.jobs import Job, Jobs
from app.survey_session import SurveySession
from processing import messages
from processing.errors import LeaklineError
from processing.review_facts import DigHistory, DigResult

if TYPE_CHECKING:
    from processing.dig_history import HistoryFile
    from processing.storage.digs import DigEntry
    from processing.survey import Survey

log = logging.getLogger(__name__)


def history_file() -> Path:
    """Return where this computer remembers the digs of all surveys."""
    return Path(platformdirs.user_data_dir("Leakline", appauthor=False)) / "dig-history.jsonl"


@dataclass(frozen=True)
class Remembered:
    """What the history says of the open survey's kind, how many digs it has in all, and how many damaged lines."""

    history: DigHistory | None = None
    digs: int = 0
    damaged: int = 0


class DigLedger(QObject):
    """Each write is on disc before it returns; the history follows in a worker, and from the survey's own log only."""

    changed = Signal()  # the digs of the survey
    history_changed = Signal()
    told = Signal(str)

    def __init__(self, session: SurveySession, jobs: Jobs, language: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session, self._jobs, self._language = session, jobs, language
        self.results: dict[int, DigResult] = {}
        self.remembered = Remembered()
        self._entered: set[int] = set()  # by number, what the history has not heard of yet
        self._telling: set[int] = set()  # and what it is being told: none of it where that fails
        self._kind_of: Survey | None = None  # that the history was last asked for
        self._working = self._again = False
        self._running: list[Job] = []
        session.opened.connect(self._on_opened)
        session.survey_changed.connect(self._on_survey)
        session.annexes_changed.connect(self._on_annexes)
        self._on_opened()

    @property
    def history(self) -> DigHistory | None:
        """What digs on pipes and runs like this one showed; None where nothing is known."""
        return self.remembered.history

    def write(self, number: int, result: DigResult | None) -> bool:
        """Put what a dig showed on disc, None takes it back; False, having told why, where it could not be written."""
        return write_dig(self.session, number, result)

    def refresh(self) -> None:
        """Let the history follow the survey's log, and ask it anew."""
        folder = self.session.folder
        if folder is None:
            return
        if self._working:
            self._again = True
            return
        try:
            entries = folder.digs.log()
        except LeaklineError as error:
            self._tell(error)
            return
        self._kind_of = self.session.survey
        self._telling, self._entered = self._entered, set()
        entered = frozenset(self._telling)
        step = partial(_follow, history_file(), folder.identity, self.session.survey, entries, entered)
        self._working = True
        self._start(step, self.tr("History of digs"), self._take, quiet=True).finished.connect(self._ended)

    def write_out(self, path: Path) -> None:
        """Write the history to a file, for another computer."""

        def done(count: object) -> None:
            self.told.emit(self.tr("{count} digs written to {file}").format(count=count, file=path))

        self._start(lambda: _file().write_out(path), self.tr("Writing the history of digs"), done)

    def take_in(self, path: Path) -> None:
        """Take in what another computer wrote out."""

        def done(found: object) -> None:
            count, damaged = found if isinstance(found, tuple) else (0, 0)
            text = self.tr("{count} digs of other surveys taken in").format(count=count)
            if damaged:
                text += self.tr("; {damaged} damaged lines left out").format(damaged=damaged)
            self.told.emit(text)
            self.refresh()

        self._start(lambda: _taken_in(path), self.tr("Taking in the history of digs"), done)

    def _on_annexes(self) -> None:
        """Take what was written, by whichever window's hand; photos change nothing here."""
        folder = self.session.folder
        try:
            found = {} if folder is None else folder.digs.results()
        except LeaklineError as error:
            self._tell(error)
            return
        if found != self.results:
            self._entered |= {n for n in found.keys() | self.results.keys() if found.get(n) != self.results.get(n)}
            self.results = found
            self.changed.emit()
            self.refresh()

    def _on_opened(self) -> None:
        folder = self.session.folder
        self.results, self.remembered = {}, Remembered()
        self._entered, self._telling = set(), set()
        if folder is not None:
            try:
                self.results = folder.digs.results()
            except LeaklineError as error:
                self._tell(error)
        self.changed.emit()
        self.history_changed.emit()
        if folder is not None and (self.results or history_file().exists()):
            self.refresh()

    def _on_survey(self) -> None:
        known = self.results or self.remembered.digs  # another kind of pipe has another history
        if known and self._kind_of is not None and self.session.survey != self._kind_of:
            self.refresh()

    def stop(self) -> None:
        """Hear nothing more of the work in progress, which goes on: the window closes."""
        self._again = False
        for job in self._running:
            job.forget_callbacks()

    def _start(
        self, step: Callable[[], object], title: str, done: Callable[[object], None], *, quiet: bool = False
    ) -> Job:
        job = self._jobs.start(
            lambda _progress: step(), title=title, on_success=done, on_failure=self._tell, quiet=quiet
        )
        self._running.append(job)
        job.finished.connect(lambda: self._running.remove(job))
        return job

    def _ended(self) -> None:
        self._working = False
        self._entered |= self._telling
        if self._again:
            self._again = False
            self.refresh()

    def _take(self, remembered: object) -> None:
        assert isinstance(remembered, Remembered)
        self._telling = set()
        if self.session.folder is not None:
            self.remembered = remembered
            self.history_changed.emit()

    def _tell(self, error: Exception) -> None:
        """Say what went wrong with the history: the survey itself holds what was entered."""
        if not isinstance(error, LeaklineError):
            raise error
        log.warning("the history of digs: %s", error)
        self.told.emit(messages.error_sentence(error, self._language))


def write_dig(session: SurveySession, number: int, result: DigResult | None) -> bool:
    """Put what a dig showed on disc, None takes it back; False, having told why, where it could not be written."""

    def write() -> None:
        folder = session.folder
        assert folder is not None  # else the session refuses before
        if result is None:
            folder.digs.clear(number, session.operator)
        else:
            folder.digs.record(replace(result, number=number), session.operator)

    if not session.write(write):
        return False
    session.annexes_changed.emit(number)
    return True


def _file() -> "HistoryFile":
    from processing.dig_history import HistoryFile

    return HistoryFile(history_file())


def _follow(
    path: Path, identity: str, survey: "Survey", entries: "tuple[DigEntry, ...]", entered: frozenset[int]
) -> Remembered:
    from processing.dig_history import HistoryFile, kind_of
    from processing.dig_statistics import history_of

    file = HistoryFile(path)
    file.take(identity, survey, entries, entered)
    read = file.read()
    return Remembered(history_of(read.digs, kind_of(survey)), len(read.digs), read.damaged)


def _taken_in(path: Path) -> tuple[int, int]:
    found = _file().take_in(path)
    return len(found.digs), found.damaged
