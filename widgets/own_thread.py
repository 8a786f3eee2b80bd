"""Runs a function for a worker of Qt's pool in a thread of Python's own.

pyproj keeps, for each native thread, a pointer to what dies with Python's state of that thread (its issue 1509). A
thread of Qt's pool outlives that state, so the second function there that asks for a coordinate system would crash the
program.
"""

import threading
from collections.abc import Callable
from typing import Any


def in_own_thread(function: Callable[[], Any], name: str = "work") -> tuple[Any, Exception | None]:
    """Return what the function returns and None, or None and what it raised; waits for it."""
    value: Any = None
    error: Exception | None = None

    def call() -> None:
        nonlocal value, error
        try:
            value = function()
        except Exception as fault:  # noqa: BLE001  # handed on to whoever asked
            error = fault

    thread = threading.Thread(target=call, name=name)
    thread.start()
    thread.join()
    return value, error
