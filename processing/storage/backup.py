"""Copies of ``survey.db`` in ``backups/``, made by SQLite's backup call, and the way back from one.

Names count up (``survey-000007-<hash>.db``), so that their order does not hang on the computer's clock; the hash is
that of the database they were made from: a survey that did not change gets no second copy.
"""

import contextlib
import hashlib
import os
import re
import shutil
import sqlite3
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage.database import Database, open_read_only, told
from processing.storage.files import sync_folder, writing

KEEP = 10
_NAME = re.compile(r"survey-(\d{6,})-([0-9a-f]{16})\.db")


def backups(folder: Path) -> tuple[Path, ...]:
    """Return the backups in ``folder``, newest first."""
    if not folder.is_dir():
        return ()
    numbered = [(int(match[1]), path) for path in folder.iterdir() if (match := _NAME.fullmatch(path.name))]
    return tuple(path for _, path in sorted(numbered, reverse=True))


def make_backup(database: Database, folder: Path) -> Path | None:
    """Copy the database into ``folder`` if it changed since the newest copy; keep the newest :data:`KEEP`.

    Returns the new file, None if none was needed.

    Raises:
        LeaklineError: DISC_FULL, CANNOT_WRITE; nothing half-made is left.
    """
    existing = backups(folder)
    digest = _digest(database.path)
    if existing and existing[0].stem.endswith(digest):
        return None
    number = _number(existing[0]) + 1 if existing else 1
    target = folder / f"survey-{number:06d}-{digest}.db"
    aside = target.with_suffix(".new")
    with writing(folder):
        folder.mkdir(exist_ok=True)
    try:
        with told(aside):
            _copy(database.connection, aside)
        with writing(target):
            _sync(aside)
            aside.replace(target)
            sync_folder(folder)
    except BaseException:
        with contextlib.suppress(OSError):
            aside.unlink(missing_ok=True)
        raise
    for old in backups(folder)[KEEP:]:
        with contextlib.suppress(OSError):  # one copy too many does no harm
            old.unlink()
    return target


def restore(path: Path, folder: Path, backup: Path | None = None) -> Path:
    """Put ``backup`` (or the newest sound one in ``folder``) in the place of the database ``path``.

    What stood there is kept in ``folder`` as ``damaged-<n>.db``, with its journal, which must never be played into the
    restored file. The caller holds the lock. Returns the backup used.

    Raises:
        LeaklineError: SURVEY_DAMAGED if no sound backup is there; DISC_FULL; CANNOT_WRITE.
    """
    chosen = backup if backup is not None and _is_sound(backup) else None
    if backup is None:
        chosen = next((candidate for candidate in backups(folder) if _is_sound(candidate)), None)
    if chosen is None:
        raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(backup or folder), reason="no sound backup")
    aside = path.with_suffix(".restored")
    with writing(path):
        try:
            shutil.copyfile(chosen, aside)
            _sync(aside)
            _keep_damaged(path, folder)
            aside.replace(path)
        except BaseException:
            aside.unlink(missing_ok=True)
            raise
        sync_folder(path.parent)
    return chosen


def _keep_damaged(path: Path, folder: Path) -> None:
    taken = [int(p.stem.removeprefix("damaged-")) for p in folder.glob("damaged-*.db") if p.stem[8:].isdecimal()]
    kept = folder / f"damaged-{max(taken, default=0) + 1}.db"
    journal = path.with_name(path.name + "-journal")
    if path.exists():
        shutil.copyfile(path, kept)
    if journal.exists():
        shutil.copyfile(journal, kept.with_name(kept.name + "-journal"))
        journal.unlink()
        sync_folder(path.parent)


def _is_sound(backup: Path) -> bool:
    try:
        open_read_only(backup).close()
    except LeaklineError:
        return False
    return True


def _copy(connection: sqlite3.Connection, target: Path) -> None:
    target.unlink(missing_ok=True)
    copy = sqlite3.connect(target, isolation_level=None)
    try:
        connection.backup(copy)
    finally:
        copy.close()


def _sync(path: Path) -> None:
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:16]


def _number(path: Path) -> int:
    match = _NAME.fullmatch(path.name)
    assert match is not None  # backups() lists no others
    return int(match[1])
