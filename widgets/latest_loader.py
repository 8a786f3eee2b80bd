"""Runs slow reads away from the window's thread; only the newest request counts, older ones are dropped."""

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QRunnable, Qt, QThreadPool, Signal

from processing.errors import LeaklineError
from widgets.own_thread import in_own_thread


class _Outbox(QObject):
    """Lives on the window's thread; the worker speaks through it."""

    done = Signal(int, object, object)  # generation, result, error


class _Read(QRunnable):
    """Calls a function of no arguments; gets plain data and knows no widget."""

    def __init__(self, generation: int, read: Callable[[], Any], outbox: _Outbox) -> None:
        super().__init__()
        self.setAutoDelete(False)
        self._generation, self._read, self._outbox = generation, read, outbox

    def run(self) -> None:
        """Read, and hand over the result or the error: a worker thread has nobody else to tell."""
        result, error = in_own_thread(self._read)
        self._outbox.done.emit(self._generation, result, error)


class LatestLoader(QObject):
    """One worker, one request in work, one waiting. ``loaded`` and ``failed`` come on the window's thread.

    With ``overtaken`` the result of a request comes even if a newer one was made meanwhile: what follows a hand that
    never rests would else show nothing before it rests.
    """

    loaded = Signal(object)
    failed = Signal(object)  # LeaklineError or OSError

    def __init__(self, parent: QObject | None = None, *, overtaken: bool = False) -> None:
        super().__init__(parent)
        self._overtaken = overtaken
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(1)
        self._outbox = _Outbox()
        self._outbox.done.connect(self._finish, Qt.ConnectionType.QueuedConnection)
        self._generation = 0
        self._cancelled = 0  # what was asked for up to this one is of no interest any more
        self._running: _Read | None = None
        self._next: tuple[int, Callable[[], Any]] | None = None

    @property
    def busy(self) -> bool:
        """Whether a result is still to come."""
        return self._running is not None

    def request(self, read: Callable[[], Any]) -> None:
        """Ask for ``read()``; the results of all earlier requests are dropped."""
        self._generation += 1
        self._next = (self._generation, read)
        self._start()

    def cancel(self) -> None:
        """Drop everything that was asked for."""
        self._generation += 1
        self._cancelled = self._generation
        self._next = None

    def stop(self) -> None:
        """Drop everything and wait for the read in work: call before what it reads from is closed."""
        self.cancel()
        self._pool.waitForDone()

    def _start(self) -> None:
        if self._running is None and self._next is not None:
            generation, read = self._next
            self._next = None
            self._running = _Read(generation, read, self._outbox)
            self._pool.start(self._running)

    def _finish(self, generation: int, result: object, error: object) -> None:
        self._running = None
        self._start()
        wanted = generation > self._cancelled if self._overtaken else generation == self._generation
        if not wanted:
            return
        if isinstance(error, LeaklineError | OSError):
            self.failed.emit(error)
        elif isinstance(error, BaseException):
            raise error
        else:
            self.loaded.emit(result)
