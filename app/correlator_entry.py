"""The door to the correlator: its page is built when it is first asked for, so that nobody else waits for it."""

import logging
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QStackedWidget, QWidget

from app.appearance import theme_named
from app.jobs import Jobs
from app.settings import PreferencesStore
from processing.errors import LeaklineError
from widgets.plot_theme import Theme

if TYPE_CHECKING:
    from app.correlator_control import CorrelatorControl
    from app.correlator_page import CorrelatorPage

log = logging.getLogger(__name__)

PAGE = "correlator"


class CorrelatorEntry(QObject):
    """Puts the page into the window's ``pages`` and ``stack``, and remembers what was open for the next time."""

    page_asked = Signal(str)
    told = Signal(str)

    def __init__(
        self,
        jobs: Jobs,
        preferences: PreferencesStore,
        language: str,
        pages: dict[str, QWidget],
        stack: QStackedWidget,
        window: QWidget,
        where: Callable[[], str] = lambda: "start",
    ) -> None:
        super().__init__(window)
        self._jobs, self._preferences, self._language = jobs, preferences, language
        self._pages, self._stack, self._window = pages, stack, window
        self._where, self._before = where, "start"
        self.control: CorrelatorControl | None = None
        self.page: CorrelatorPage | None = None
        stack.currentChanged.connect(self._on_page)

    @property
    def memory(self) -> Path:
        """The file that holds what was open last."""
        return self._preferences.file.with_name("correlator-last.leakcorr")

    def show(self) -> None:
        """Show the correlator's page; where it is in front already, go back to what was there before."""
        if self.control is None:
            self._build()
        if self._where() == PAGE:
            self.page_asked.emit(self._before)
            return
        self._before = self._where()
        self.page_asked.emit(PAGE)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        if self.page is not None:
            self.page.apply_theme(theme)

    def stop(self) -> None:
        """Be silent, and keep what is open for the next time."""
        if self.control is None:
            return
        self.control.stop()
        session = self.control.session()
        if session.a.paths or session.b.paths:
            from processing.correlation.session import write_session

            try:
                self.memory.parent.mkdir(parents=True, exist_ok=True)
                write_session(self.memory, session)
            except (LeaklineError, OSError) as error:  # it costs the habit, not the work
                log.warning("the correlator's last session was not kept: %s", error)

    def _build(self) -> None:
        from app.correlator_control import CorrelatorControl
        from app.correlator_page import CorrelatorPage

        self.page = CorrelatorPage(theme_named(self._preferences.values.theme), self._language)
        self._pages[PAGE] = self.page
        self._stack.addWidget(self.page)
        self.control = CorrelatorControl(self._jobs, self._preferences, self.page, self._language, self._window)
        self.control.told.connect(self.told)
        if self.memory.is_file():
            self.control.files.reopen(self.memory)

    def _on_page(self) -> None:
        if self.control is not None and self._stack.currentWidget() is not self.page:
            self.control.leave()
