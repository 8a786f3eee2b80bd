"""A ball on a real pseudo-terminal, which can be pulled out and plugged in again, with a record of what it sent."""

import errno
import os
import pty
import threading
import time
import tty
from collections import deque
from dataclasses import fields
from pathlib import Path
from typing import Self

import numpy as np
from fake_devices import motion

from processing.importing.frames import Frames, encode

STEP_S = 0.004
BUFFER_BYTES = 1 << 16  # that the device itself holds while its host is busy; a pseudo-terminal takes 4 KB


class WiredBall:
    """Sends frames at ``rate_hz`` once it is entered, by a thread; its clock and counter run on while unplugged."""

    def __init__(self, link: Path, rate_hz: float = 400.0, seconds: float = 60.0) -> None:
        self.link, self.rate_hz = link, rate_hz
        self.frames = motion(round(seconds * rate_hz), rate_hz=rate_hz)
        self.sent = np.zeros(len(self.frames), np.bool_)  # that the system took
        self.refused = 0  # for which there was no room
        self.is_stalled = False
        self._lock = threading.Lock()
        self._ends: tuple[int, int] | None = None
        self._waiting: deque[tuple[int, bytes]] = deque()  # sample's number (-1: none), what of it is not sent yet
        self._waiting_bytes = 0
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
        """Be gone, with what is not sent yet."""
        with self._lock:
            self.link.unlink(missing_ok=True)
            self._waiting.clear()
            self._waiting_bytes = 0
            if self._ends is not None:
                for end in self._ends:
                    os.close(end)
                self._ends = None

    def say(self, data: bytes) -> None:
        """Send anything, between two samples."""
        with self._lock:
            self._put(-1, data)

    def rows(self, which: np.ndarray) -> Frames:
        """Return the samples of these numbers."""
        return Frames(**{field.name: getattr(self.frames, field.name)[which] for field in fields(Frames)})

    def _run(self) -> None:
        done = 0
        while not self._ending.wait(STEP_S):
            due = min(int((time.monotonic() - self._begun_s) * self.rate_hz), len(self.frames))
            with self._lock:
                if self._ends is not None and not self.is_stalled and due > done:
                    data = encode(self.rows(np.arange(done, due)))
                    each = len(data) // (due - done)
                    for nth in range(due - done):
                        self._put(done + nth, data[nth * each : (nth + 1) * each])
                self._send()
            done = due

    def _put(self, number: int, data: bytes) -> None:
        if self._waiting_bytes + len(data) > BUFFER_BYTES:
            self.refused += 1
            return
        self._waiting.append((number, data))
        self._waiting_bytes += len(data)

    def _send(self) -> None:
        while self._ends is not None and self._waiting:
            number, data = self._waiting.popleft()
            try:
                count = os.write(self._ends[0], data)
            except OSError as error:
                if error.errno not in (errno.EAGAIN, errno.EIO):
                    raise
                count = 0
            self._waiting_bytes -= count
            if count < len(data):
                self._waiting.appendleft((number, data[count:]))
                return
            if number >= 0:
                self.sent[number] = True
