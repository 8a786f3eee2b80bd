"""Keeps the laptop from falling asleep while it records; what the system does not offer is left alone."""

import logging
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress

log = logging.getLogger(__name__)

_ES_CONTINUOUS, _ES_SYSTEM_REQUIRED = 0x8000_0000, 0x0000_0001


def keep_awake() -> Callable[[], None]:
    """Keep the computer awake from now on, and return what ends that; call both from the same thread."""
    if sys.platform == "win32":
        return _on_windows()
    command = _command()
    if command is None:
        return _nothing
    try:
        # it lasts as long as its standard input: our death, by whatever cause, ends it
        child = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, close_fds=True
        )
    except OSError as error:
        log.info("the computer may fall asleep while it records: %s", error)
        return _nothing

    def end() -> None:
        if child.stdin is not None:
            with suppress(OSError):
                child.stdin.close()
        try:
            child.wait(2.0)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait(2.0)

    return end


def _command() -> list[str] | None:
    if sys.platform == "darwin" and (caffeinate := shutil.which("caffeinate")):
        return [caffeinate, "-i", "-s", "cat"]
    if (inhibit := shutil.which("systemd-inhibit")) and os.path.isdir("/run/systemd/system"):  # noqa: PTH112
        why = ["--who=Leakline", "--why=A pipe is being recorded", "--mode=block"]
        return [inhibit, "--what=sleep:idle:handle-lid-switch", *why, "cat"]
    return None


def _on_windows() -> Callable[[], None]:
    import ctypes

    kernel = getattr(ctypes, "windll").kernel32  # noqa: B009  # unknown to the type checker elsewhere
    kernel.SetThreadExecutionState(_ES_CONTINUOUS | _ES_SYSTEM_REQUIRED)
    return lambda: kernel.SetThreadExecutionState(_ES_CONTINUOUS)


def _nothing() -> None:
    """End nothing."""
