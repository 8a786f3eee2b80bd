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
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage.files import writing
from processing.storage.processes import own_start, process_start

LOCK_NAME = "survey.lock"
_PATIENCE_S = 1.0  # another process may be between creating the file and writing its name into it
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
        return f"{self.user}@{self.host}, {self.since_utc}"


@dataclass(frozen=True)
class Lock:
    """A lock that this process holds; ``taken_from`` names the dead holder it was taken over from, if any."""

    path: Path
    holder: Holder
    taken_from: str | None = None

    def release(self) -> None:
        """Give the lock back, if it is still ours; calling it twice does no harm."""
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
    taken_from: str | None = None
    for _ in range(20):
        if _create(path, mine):
            return Lock(path, mine, taken_from)
        found = _wait_for_holder(path)
        if found is not None and _alive(found, take_over=take_over):
            raise LeaklineError(ErrorCode.SURVEY_LOCKED, Place(folder), owner=str(found))
        if _remove(path, found):
            taken_from = str(found) if found is not None else "?"
    raise LeaklineError(ErrorCode.SURVEY_LOCKED, Place(folder), owner="?")


def is_abandoned(folder: Path) -> bool:
    """Return whether ``folder`` has a lock whose holder died on this computer."""
    found = read_holder(folder / LOCK_NAME)
    return found is not None and not _alive(found, take_over=False)


def read_holder(path: Path) -> Holder | None:
    """Return who holds the lock, None if there is none or it cannot be understood."""
    try:
        with path.open("rb") as file:
            plain = json.loads(file.read(_LARGEST))
        texts = {key: str(plain[key]) for key in ("host", "user", "since_utc", "process_start", "token")}
        return Holder(pid=int(plain["pid"]), **texts)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _myself() -> Holder:
    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):  # no such user in this container
        user = "?"
    now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    return Holder(os.getpid(), socket.gethostname(), user, now, own_start(), secrets.token_hex(8))


def _create(path: Path, holder: Holder) -> bool:
    text = json.dumps(asdict(holder), ensure_ascii=False).encode()
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
    """Return the holder; None if the file is gone, or stays empty or garbled: its writer died at once."""
    deadline = time.monotonic() + _PATIENCE_S
    while (found := read_holder(path)) is None and path.exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    return found


def _alive(holder: Holder, *, take_over: bool) -> bool:
    if holder.host != socket.gethostname():
        return not take_over
    start = process_start(holder.pid)
    return start is not None and (start == holder.process_start or "unknown" in (start, holder.process_start))


def _remove(path: Path, seen: Holder | None) -> bool:
    """Take a dead lock away by renaming: of several that try only one succeeds, and it looks what it has got."""
    aside = path.with_name(f"{path.name}.{secrets.token_hex(4)}")
    try:
        path.rename(aside)
    except FileNotFoundError:
        return False
    except OSError as error:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=error.strerror or str(error)) from error
    got = read_holder(aside)
    if got != seen and not path.exists():
        aside.rename(path)  # somebody else took over in between: it is theirs
        return False
    aside.unlink(missing_ok=True)
    return True
