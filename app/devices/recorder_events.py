"""What happens in a recording, told twice: as a line of its journal, and as a finding for whoever looks on."""

import logging
import threading
from collections.abc import Callable
from datetime import datetime
from typing import Any, Protocol

from processing.errors import LeaklineError
from processing.survey import Finding, Severity

log = logging.getLogger(__name__)

MOST = 500  # findings kept for the eye; the journal has them all
TOGETHER_S = 30.0  # what comes again within this time is added up in one finding


class Journal(Protocol):
    """Where lines are kept."""

    def note(self, event: str, **values: Any) -> None:  # noqa: ANN401  # whatever JSON holds
        """Keep one line."""


class Happenings:
    """Collects findings from all threads of a recorder, and hands lines to the journal while there is one."""

    def __init__(self, monotonic: Callable[[], float], wall: Callable[[], datetime] | None = None) -> None:
        self._monotonic = monotonic
        self._wall = wall or (lambda: datetime.now().astimezone())
        self._lock = threading.Lock()
        self._findings: tuple[Finding, ...] = ()
        self._begun: dict[tuple[str, str], tuple[float, int]] = {}  # when a finding was first told, and where it stands
        self._forgotten = 0
        self._journal: Journal | None = None

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was told, in order, the newest :data:`MOST` of it."""
        return self._findings

    def attach(self, journal: Journal | None) -> None:
        """Hand lines to this journal from now on, to none if None."""
        self._journal = journal

    def clear(self) -> None:
        """Forget the findings: another recording begins."""
        with self._lock:
            self._findings, self._forgotten = (), 0
            self._begun.clear()

    def note(self, event: str, **values: Any) -> None:  # noqa: ANN401  # whatever JSON holds
        """Keep a line in the journal, if there is one; a journal that cannot be written never stops a stream."""
        journal = self._journal
        if journal is None:
            return
        try:
            journal.note(event, **values)
        except LeaklineError as error:  # the writer keeps it as its fault, and the recording ends by that
            log.warning("the journal could not take %s: %s", event, error)

    def tell(self, code: str, severity: Severity, **params: str | float) -> None:
        """Add a finding; ``at``, the local time of day, is filled in."""
        at = f"{self._wall():%H:%M:%S}"
        with self._lock:
            self._append(Finding(code, severity, {"at": at, **params}))

    def add_up(self, code: str, severity: Severity, key: str = "", **amounts: float) -> None:
        """As :meth:`tell`, but what was told in the last half minute under the same ``key`` grows by ``amounts``."""
        now, at = self._monotonic(), f"{self._wall():%H:%M:%S}"
        with self._lock:
            since, place = self._begun.get((code, key), (-TOGETHER_S, -1))
            place -= self._forgotten
            if now - since < TOGETHER_S and 0 <= place < len(self._findings):
                old = self._findings[place].params
                grown: dict[str, str | float] = {**old}
                for name, amount in amounts.items():
                    grown[name] = float(old[name]) + amount
                told = list(self._findings)
                told[place] = Finding(code, severity, grown)
                self._findings = tuple(told)
                return
            self._append(Finding(code, severity, {"at": at, **amounts}))
            self._begun[code, key] = (now, self._forgotten + len(self._findings) - 1)

    def _append(self, finding: Finding) -> None:
        self._findings = (*self._findings, finding)
        excess = len(self._findings) - MOST
        if excess > 0:
            self._findings = self._findings[excess:]
            self._forgotten += excess
