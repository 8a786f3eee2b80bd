"""``survey.lock``: one writer at a time, on sticks and network shares too, where system locks cannot be trusted.

The lock is a file that is created only where there is none, and says who holds it. A holder that died on this
computer is found by its process id and start time, never by the clock; one on another computer is believed.
"""

import getpass
import json
import os
import secrets
import socket
import time
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage.files import writing
from processing.storage.processes import own_start, process_start

LOCK_NAME = "survey.lock"
_PATIENCE_S = 1.0  # another process may be between creating the file and writing its name into it
_TRIES = 100
_LARGEST = 4096  # bytes; a lock is two hundred


@dataclass(frozen=True)
class Holder:
    """Who holds a lock: ``process_start`` tells this life of ``pid`` from a later one; ``token`` is its own."""

    pid: int
    host: str
    user: str
    since_utc: str
    process_start: str
    token: str

    def __str__(self) -> str:
        return f"{self.user}@{self.host}, {self.since_utc}" if self.pid else "?"


NOBODY = Holder(0, "", "", "", "", "")  # holds a lock that cannot be understood


@dataclass(frozen=True)
class Lock:
    """A lock that this process holds; ``taken_from`` names the dead holder it was taken over from, if any."""

    path: Path
    holder: Holder
    taken_from: str | None = None

    def release(self) -> None:
        """Give the lock back, if it is still ours; calling it twice does no harm."""
        with suppress(OSError):  # the stick is pulled: its lock will be found dead
            found = read_holder(self.path)
            if found is not None and found.token == self.holder.token:
                self.path.unlink(missing_ok=True)


def acquire(folder: Path, *, take_over: bool = False) -> Lock:
    """Lock ``folder`` for writing.

    A dead holder's lock is taken over. ``take_over`` also takes it from a holder on *another* computer, which the
    operator knows to be dead or away; a live one on this computer is never robbed.

    Raises:
        LeaklineError: SURVEY_LOCKED with its owner; DISC_FULL; CANNOT_WRITE where the medium is read-only.
    """
    path = folder / LOCK_NAME
    mine = _myself()
    for _ in range(_TRIES):
        if _create(path, mine):
            return Lock(path, mine)
        found = _wait_for_holder(path)
        if found is not None and _alive(found, take_over=take_over):
            raise LeaklineError(ErrorCode.SURVEY_LOCKED, Place(folder), owner=str(found))
        if found is not None and _take_over(path, found, mine):
            return Lock(path, mine, taken_from=str(found))
        time.sleep(0.02)
    raise LeaklineError(ErrorCode.SURVEY_LOCKED, Place(folder), owner="?")


def is_abandoned(folder: Path) -> bool:
    """Return whether ``folder`` has a lock whose holder died on this computer."""
    try:
        found = read_holder(folder / LOCK_NAME)
    except OSError:
        return False
    return found is not None and not _alive(found, take_over=False)


def read_holder(path: Path) -> Holder | None:
    """Return who holds the lock, None if there is none or it cannot be understood; raises OSError if unreadable."""
    try:
        with path.open("rb") as file:
            plain = json.loads(file.read(_LARGEST))
        texts = {key: str(plain[key]) for key in ("host", "user", "since_utc", "process_start", "token")}
        return Holder(pid=int(plain["pid"]), **texts)
    except (FileNotFoundError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _myself() -> Holder:
    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):  # no such user in this container
        user = "?"
    now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    return Holder(os.getpid(), socket.gethostname(), user, now, own_start(), secrets.token_hex(8))


def _create(path: Path, holder: Holder) -> bool:
    text = json.dumps(asdict(holder)).encode()
    with writing(path):
        try:
            handle = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0), 0o644)
        except FileExistsError:
            return False
        except PermissionError:
            if path.exists():  # Windows says so while the old lock is being deleted
                return False
            raise
        try:
            os.write(handle, text)
            os.fsync(handle)
        except BaseException:
            os.close(handle)
            path.unlink(missing_ok=True)
            raise
        os.close(handle)
    return True


def _wait_for_holder(path: Path) -> Holder | None:
    """Return the holder, None if the file is gone; NOBODY if it stays garbled: its writer died at once."""
    deadline = time.monotonic() + _PATIENCE_S
    while path.exists():
        unreadable = None
        try:
            found = read_holder(path)
        except OSError as error:  # another user's, or for a moment in the hands of a virus scanner
            found, unreadable = None, error
        if found is not None:
            return found
        if time.monotonic() > deadline:
            if unreadable is not None:
                raise LeaklineError(ErrorCode.SURVEY_LOCKED, Place(path), owner=str(unreadable.strerror))
            return NOBODY
        time.sleep(0.02)
    return None


def _alive(holder: Holder, *, take_over: bool) -> bool:
    if holder == NOBODY:
        return False
    if holder.host != socket.gethostname():
        return not take_over
    start = process_start(holder.pid)
    return start is not None and (start == holder.process_start or "unknown" in (start, holder.process_start))


def _take_over(path: Path, seen: Holder, mine: Holder) -> bool:
    """Put ``mine`` in the place of the dead lock ``seen``; False if somebody else is about it or has done it.

    Only who holds the guard may do so, and the lock never goes away meanwhile: nobody else can create it.
    """
    guard = path.with_name(f"{path.name}.guard")
    if not _create(guard, mine):
        left = _wait_for_holder(guard)
        if left is not None and not _alive(left, take_over=False):
            guard.unlink(missing_ok=True)  # its holder died within these few milliseconds
        return False
    try:
        if _wait_for_holder(path) != seen:
            return False
        aside = path.with_name(f"{path.name}.{mine.token}")
        with writing(path):
            _create(aside, mine)
            aside.replace(path)
        return True
    finally:
        guard.unlink(missing_ok=True)
