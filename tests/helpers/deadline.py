"""A child process that hangs must not hang the tests: it is ended when its time is over."""

import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def ended_after(child: subprocess.Popen, seconds: float) -> Iterator[None]:
    """Kill ``child`` after so many seconds, and in any case at the end; what reads its pipes then gets their end."""
    timer = threading.Timer(seconds, child.kill)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        child.kill()
        child.wait(timeout=30)
