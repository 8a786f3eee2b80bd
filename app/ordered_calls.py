"""Calls that may take a while, one after the other in a thread of their own; each answers on the GUI's thread."""

import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Signal

log = logging.getLogger(__name__)

Answer = Callable[[Any], None]


class OrderedCalls(QObject):
    """What was asked first is done first: a device is not closed before it was opened. The thread ends when idle."""

    failed = Signal(object)  # Exception that no on_failure took
    _ended = Signal(object, object, object)  # answer, error answer, (value, error)

    def __init__(self, name: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._name = name
        self._lock = threading.Lock()
        self._waiting: deque[tuple[Callable[[], Any], Answer | None, Answer | None]] = deque()
        self._thread: threading.Thread | None = None
        self._silent = False
        self._ended.connect(self._answer)

    def run(self, call: Callable[[], Any], on_success: Answer | None = None, on_failure: Answer | None = None) -> None:
        """Do it after all that was asked before; exactly one of the answers is given, on the GUI thread."""
        with self._lock:
            self._waiting.append((call, on_success, on_failure))
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name=self._name, daemon=True)
                self._thread.start()

    @property
    def idle(self) -> bool:
        """Whether nothing is being done."""
        return self._thread is None

    def finish(self, timeout_s: float) -> bool:
        """Wait until all is done, and answer nobody any more; returns False if it takes longer."""
        self._silent = True
        thread = self._thread
        if thread is not None:
            thread.join(timeout_s)
        return thread is None or not thread.is_alive()

    def _work(self) -> None:
        while True:
            with self._lock:
                if not self._waiting:
                    self._thread = None
                    return
                call, on_success, on_failure = self._waiting.popleft()
            value: Any = None
            error: Exception | None = None
            try:
                value = call()
            except Exception as fault:  # noqa: BLE001  # handed on to whoever asked
                log.info("%s: %s", self._name, fault)
                error = fault
            if not self._silent:
                self._ended.emit(on_success, on_failure, (value, error))

    def _answer(self, on_success: Answer | None, on_failure: Answer | None, outcome: tuple[Any, Any]) -> None:
        value, error = outcome
        if self._silent:
            return
        if error is not None:
            (on_failure or self.failed.emit)(error)
        elif on_success is not None:
            on_success(value)
