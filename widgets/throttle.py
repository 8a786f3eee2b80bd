"""Calls a slow listener at most once in a while: at once when it has rested, else once at the end of its rest."""

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QElapsedTimer, QObject, QTimer


class Throttle(QObject):
    """Wraps ``listener``: calls within ``rest_ms`` of the last one are gathered into one, with the last arguments.

    The first call goes through directly, so that a single click feels immediate; the last one is never lost.
    """

    def __init__(self, listener: Callable[..., None], rest_ms: int, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._listener = listener
        self._rest_ms = rest_ms
        self._waiting: tuple[Any, ...] | None = None
        self._since = QElapsedTimer()
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self.flush)

    def __call__(self, *arguments: Any) -> None:  # noqa: ANN401  # whatever the listener takes
        """Call the listener now, or remember the arguments for the end of its rest."""
        if self._timer.isActive():
            self._waiting = arguments
            return
        left = self._rest_ms - self._since.elapsed() if self._since.isValid() else 0
        if left <= 0:
            self._call(arguments)
        else:
            self._waiting = arguments
            self._timer.start(left)

    def flush(self) -> None:
        """Make the remembered call now, if there is one."""
        self._timer.stop()
        if self._waiting is not None:
            self._call(self._waiting)

    def cancel(self) -> None:
        """Forget the remembered call."""
        self._timer.stop()
        self._waiting = None

    def _call(self, arguments: tuple[Any, ...]) -> None:
        self._waiting = None
        self._listener(*arguments)
        # the rest begins when the listener is done: a slow one must leave time to others
        self._since.start()
