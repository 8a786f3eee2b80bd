"""A ball on a real pseudo-terminal, which can be pulled out and plugged in again, with a record of what it sent."""

import errno
import os
import pty
import threading
import time
import tty
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Self

import numpy as np
from fake_devices import motion

from processing.importing.frames import Frames, encode

_STEP_S = 0.004


class WiredBall:
    """Sends frames at ``rate_hz`` from :meth:`plug` on, by a thread; its clock and counter run on while unplugged."""

    def __init__(self, link: Path, rate_hz: float = 400.0, seconds: float = 60.0) -> None:
        self.link, self.rate_hz = link, rate_hz
        self.frames = motion(round(seconds * rate_hz), rate_hz=rate_hz)
        self.sent = np.zeros(len(self.frames), np.bool_)  # that the system took
        self.is_stalled = False
        self._lock = threading.Lock()
        self._ends: tuple[int, int] | None = None
        self._ending = threading.Event()
        self._begun_s = 0.0
        self._thread = threading.Thread(target=self._run, name="ball", daemon=True)

    def __enter__(self) -> Self:
        self.plug()
        self._begun_s = time.monotonic()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self._thread.join(5.0)
        self.unplug()

    def plug(self) -> None:
        """Be there, under the same name as ever."""
        with self._lock:
            master, slave = pty.openpty()
            tty.setraw(slave)
            os.set_blocking(master, False)
            aside = self.link.with_name(self.link.name + ".new")
            aside.symlink_to(os.ttyname(slave))
            aside.replace(self.link)
            self._ends = master, slave

    def unplug(self) -> None:
        """Be gone."""
        with self._lock:
            self.link.unlink(missing_ok=True)
            if self._ends is not None:
                for end in self._ends:
                    os.close(end)
                self._ends = None

    def say(self, data: bytes) -> None:
        """Send anything, between two samples."""
        with self._lock:
            assert self._ends is not None
            os.write(self._ends[0], data)

    def rows(self, which: np.ndarray) -> Frames:
        """Return the samples of these numbers."""
        return Frames(**{field.name: getattr(self.frames, field.name)[which] for field in fields(Frames)})

    def _run(self) -> None:
        done = 0
        while not self._ending.wait(_STEP_S):
            due = min(int((time.monotonic() - self._begun_s) * self.rate_hz), len(self.frames))
            # as devices do: a sample at a time, so that a full buffer costs whole samples
            for number in range(done, due):
                with self._lock:
                    if self._ends is not None and not self.is_stalled:
                        self.sent[number] = self._wrote(encode(self.rows(np.array([number]))))
            done = due

    def _wrote(self, data: bytes) -> bool:
        assert self._ends is not None
        with suppress(BlockingIOError):
            try:
                return os.write(self._ends[0], data) == len(data)
            except OSError as error:
                if error.errno != errno.EIO:
                    raise
        return False
