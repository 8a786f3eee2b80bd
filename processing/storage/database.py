"""One connection to a ``survey.db``: durable transactions, and SQLite's errors told as sentences.

Rollback journal, not WAL: folders live on sticks and network shares. ``synchronous=EXTRA`` is FULL plus a sync of the
directory after the journal is gone; without it a power cut right after a commit could bring the journal back and
undo a decision (sqlite.org/pragma.html#pragma_synchronous). A connection belongs to the thread that opened it.
"""

import shutil
import sqlite3
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage import schema

Row = tuple[Any, ...]
BUSY_TIMEOUT_S = 10.0
_HEADER = b"SQLite format 3\x00"
_LARGEST_VALUE = 64 * 1024 * 1024  # bytes: a hostile database shall not fill the memory with one cell


class Database:
    """An open survey database; every write goes through :meth:`transaction`."""

    def __init__(
        self,
        connection: sqlite3.Connection,
        path: Path,
        *,
        read_only: bool,
        copy: tempfile.TemporaryDirectory[str] | None = None,
    ) -> None:
        self.connection = connection
        self.path = path
        self.read_only = read_only
        self._copy = copy  # holds the file that is really open, deleted with it

    def close(self) -> None:
        """Close the connection; calling it twice does no harm."""
        self.connection.close()
        if self._copy is not None:
            self._copy.cleanup()

    def set_patience(self, seconds: float) -> None:
        """Wait so long for another process that reads or writes before SURVEY_LOCKED is raised."""
        self.rows(f"PRAGMA busy_timeout = {round(1000 * seconds)}")

    def rows(self, sql: str, values: Sequence[object] = ()) -> list[Row]:
        """Return all rows of a query; raises LeaklineError where the disc or the file fails."""
        with told(self.path):
            return self.connection.execute(sql, values).fetchall()

    def one(self, sql: str, values: Sequence[object] = ()) -> Row | None:
        """Return the first row of a query, or None."""
        found = self.rows(sql, values)
        return found[0] if found else None

    @contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """Run the block as one transaction: on disc when the block ends, or nothing of it.

        Raises:
            LeaklineError: SURVEY_READ_ONLY, DISC_FULL, CANNOT_WRITE, SURVEY_LOCKED, SURVEY_DAMAGED.
        """
        if self.read_only:
            raise LeaklineError(ErrorCode.SURVEY_READ_ONLY, Place(self.path))
        with told(self.path):
            self.connection.execute("BEGIN IMMEDIATE")
            try:
                yield self.connection
                self.connection.execute("COMMIT")
            except BaseException:
                if self.connection.in_transaction:  # SQLite itself rolls back after some failures
                    self.connection.execute("ROLLBACK")
                raise

    @property
    def version(self) -> int:
        """The packed schema version."""
        return int(self.rows("PRAGMA user_version")[0][0])


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Turn what SQLite raises about disc and file into a LeaklineError; misuse (our bug) passes through."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        code = (getattr(error, "sqlite_errorcode", None) or 0) & 0xFF
        place = Place(path)
        if code == sqlite3.SQLITE_FULL:
            raise LeaklineError(ErrorCode.DISC_FULL, place) from error
        if code in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_FORMAT):
            raise LeaklineError(ErrorCode.SURVEY_DAMAGED, place, reason=str(error)) from error
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise LeaklineError(ErrorCode.SURVEY_LOCKED, place, owner=str(error)) from error
        if code in (sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM, sqlite3.SQLITE_READONLY):
            raise LeaklineError(ErrorCode.CANNOT_WRITE, place, reason=str(error)) from error
        raise


def create(path: Path) -> None:
    """Make an empty survey database at ``path``, which must not exist yet."""
    with told(path):
        connection = _connect(path, "mode=rwc")
        try:
            connection.execute(f"PRAGMA application_id = {schema.APPLICATION_ID}")
            connection.execute("BEGIN IMMEDIATE")
            for statement in schema.statements():
                connection.execute(statement)
            connection.execute(f"PRAGMA user_version = {schema.VERSION}")
            connection.execute("COMMIT")
        finally:
            connection.close()


def open_writable(path: Path) -> Database:
    """Open for reading and writing; a journal left by a crash is played back here, by SQLite."""
    check_header(path)
    with told(path):
        return _checked(Database(_connect(path, "mode=rw"), path, read_only=False))


def open_read_only(path: Path) -> Database:
    """Open without writing a byte beside the database, be it on a read-only medium or open elsewhere.

    A journal left by a crash cannot be played back without writing: then a copy in a temporary folder is opened.
    """
    check_header(path)
    with told(path):
        try:
            return _checked(Database(_connect(path, "mode=ro"), path, read_only=True))
        except (sqlite3.OperationalError, LeaklineError):
            journal = path.with_name(path.name + "-journal")
            if journal.exists() and journal.stat().st_size > 0:
                return _checked(_open_copy(path, journal))
            return _checked(Database(_connect(path, "mode=ro&immutable=1"), path, read_only=True))


def check_header(path: Path) -> None:
    """Raise NOT_A_SURVEY, FILE_UNREADABLE or SURVEY_DAMAGED unless ``path`` begins like an SQLite database."""
    if not path.is_file():
        raise LeaklineError(ErrorCode.NOT_A_SURVEY, Place(path.parent))
    try:
        with path.open("rb") as file:
            head = file.read(len(_HEADER))
    except OSError as error:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=error.strerror or str(error)) from error
    if head != _HEADER:
        reason = "empty" if not head else "no SQLite header"
        raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(path), reason=reason)


def damage(database: Database) -> str | None:
    """Return what SQLite's quick check and the check of foreign keys find wrong, None if nothing."""
    found = database.rows("PRAGMA quick_check(1)")
    if found != [("ok",)]:
        return str(found[0][0]) if found else "quick_check"
    broken = database.rows("PRAGMA foreign_key_check")
    return f"{len(broken)} rows of {broken[0][0]} point nowhere" if broken else None


def _connect(path: Path, query: str) -> sqlite3.Connection:
    # not Path.as_uri(): SQLite wants a network path with four slashes and no host part
    place = path.absolute().as_posix()
    uri = f"file://{'' if place.startswith('/') else '/'}{quote(place)}?{query}"
    connection = sqlite3.connect(uri, uri=True, timeout=BUSY_TIMEOUT_S, isolation_level=None)
    try:
        connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LARGEST_VALUE)
        # REPLACE deletes silently, past the append-only triggers, unless recursive triggers are on
        for pragma in ("foreign_keys = ON", "recursive_triggers = ON", "trusted_schema = OFF", "synchronous = EXTRA"):
            connection.execute(f"PRAGMA {pragma}")
        if not query.startswith("mode=ro"):
            connection.execute("PRAGMA journal_mode = DELETE")
    except BaseException:
        connection.close()
        raise
    return connection


def _checked(database: Database) -> Database:
    """Return ``database`` if it is a survey of ours, undamaged; else close it and raise."""
    try:
        _check(database)
    except BaseException:
        database.close()
        raise
    return database


def _check(database: Database) -> None:
    (application,) = database.rows("PRAGMA application_id")[0]
    if application != schema.APPLICATION_ID:
        raise LeaklineError(ErrorCode.NOT_A_SURVEY, Place(database.path))
    reason = damage(database)
    if reason is not None:
        raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(database.path), reason=reason)


def _open_copy(path: Path, journal: Path) -> Database:
    copy = tempfile.TemporaryDirectory(prefix="leakline-")
    for file in (path, journal):
        shutil.copyfile(file, Path(copy.name) / file.name)
    return Database(_connect(Path(copy.name) / path.name, "mode=rw"), path, read_only=True, copy=copy)
