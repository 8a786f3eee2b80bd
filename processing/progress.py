"""How a long step says how far it is, and learns that it shall stop."""

from collections.abc import Callable

from processing.errors import Cancelled

Report = Callable[[float, str], None]


class Progress:
    """Carries a fraction and a phrase to whoever waits, and raises :class:`Cancelled` when asked to stop.

    A step knows nothing of threads: it calls :meth:`update` at least every few tens of milliseconds of work.
    ``phrase`` is a key of the ``[progress]`` table in ``resources/messages``; the caller translates it.
    """

    def __init__(self, report: Report | None = None, is_cancelled: Callable[[], bool] | None = None) -> None:
        self._report = report
        self._is_cancelled = is_cancelled
        self._start, self._span = 0.0, 1.0
        self._phrase = ""

    def update(self, fraction: float, phrase: str = "") -> None:
        """Report ``fraction`` (0..1 of this step); raises :class:`Cancelled` when the operator asked to stop."""
        if self._is_cancelled is not None and self._is_cancelled():
            raise Cancelled
        self._phrase = phrase or self._phrase
        if self._report is not None:
            self._report(self._start + self._span * min(max(fraction, 0.0), 1.0), self._phrase)

    def part(self, start: float, end: float, phrase: str = "") -> "Progress":
        """Return the progress of a sub-step that fills ``start``..``end`` (fractions) of this one."""
        child = Progress(self._report, self._is_cancelled)
        child._start = self._start + self._span * start
        child._span = self._span * (end - start)
        child._phrase = phrase or self._phrase
        if phrase:
            child.update(0.0)
        return child


def silent() -> Progress:
    """Return a progress that nobody watches."""
    return Progress()
