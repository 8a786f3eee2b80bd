"""Brings a database of an older version to today's: after a backup, in one transaction, or not at all."""

import sqlite3
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage import schema
from processing.storage.backup import make_backup
from processing.storage.database import Database, damage


def migrate(
    database: Database,
    backups: Path,
    steps: schema.Migrations = schema.MIGRATIONS,
    target: int = schema.VERSION,
) -> None:
    """Bring ``database`` to version ``target``; a copy of the old one is in ``backups`` before anything changes.

    Raises:
        LeaklineError: SURVEY_DAMAGED where no way leads there or the result is not sound; DISC_FULL; CANNOT_WRITE.
    """
    make_backup(database, backups)
    _run_steps(database, steps, target)


def migrated_copy(
    database: Database, steps: schema.Migrations = schema.MIGRATIONS, target: int = schema.VERSION
) -> Database:
    """Return a read-only copy of ``database`` in memory in version ``target``; the original is closed, unchanged."""
    memory = sqlite3.connect(":memory:", isolation_level=None)
    database.connection.backup(memory)
    database.close()
    copy = Database(memory, database.path, read_only=False)
    try:
        _run_steps(copy, steps, target)
    except BaseException:
        copy.close()
        raise
    copy.read_only = True
    return copy


def _run_steps(database: Database, steps: schema.Migrations, target: int) -> None:
    version = database.version
    with database.transaction() as db:
        while version < target:
            if version not in steps:
                raise _unusable(database, f"version {schema.version_text(version)}")
            version, statements = steps[version]
            for statement in statements:
                db.execute(statement)
        db.execute(f"PRAGMA user_version = {version}")
        reason = damage(database)
        if reason is not None:
            raise _unusable(database, reason)


def _unusable(database: Database, reason: str) -> LeaklineError:
    return LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(database.path), reason=reason)
