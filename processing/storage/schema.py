"""The tables of ``survey.db``, their version, and the steps from older versions.

``user_version`` is ``major * 1000 + minor``: a minor step only adds (older programs may still write), a major step
does not. ``candidates``, ``runs`` and the logs are append-only, enforced here and not merely by good manners.
"""

from collections.abc import Mapping

APPLICATION_ID = 0x4C4B4C4E  # "LKLN"
VERSION = 1001

_DDL = """
CREATE TABLE survey (part TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
CREATE TABLE survey_log (
    id INTEGER PRIMARY KEY AUTOINCREMENT, at_utc TEXT NOT NULL, operator TEXT NOT NULL,
    part TEXT NOT NULL, before TEXT, after TEXT) STRICT;
CREATE TABLE tie_points (
    position INTEGER PRIMARY KEY, name TEXT NOT NULL, time_s REAL NOT NULL, value TEXT NOT NULL) STRICT;
CREATE TABLE settings (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
CREATE TABLE state (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
CREATE TABLE recordings (id INTEGER PRIMARY KEY, created_utc TEXT NOT NULL, import_options TEXT) STRICT;
CREATE TABLE recording_files (
    recording_id INTEGER NOT NULL REFERENCES recordings(id), name TEXT NOT NULL, role TEXT NOT NULL,
    size INTEGER NOT NULL CHECK (size >= 0), sha256 TEXT NOT NULL CHECK (length(sha256) = 64),
    PRIMARY KEY (recording_id, name)) STRICT;
CREATE TABLE runs (
    id INTEGER PRIMARY KEY AUTOINCREMENT, created_utc TEXT NOT NULL, settings_hash TEXT NOT NULL,
    versions TEXT NOT NULL) STRICT;
CREATE TABLE candidates (
    id INTEGER PRIMARY KEY AUTOINCREMENT, run_id INTEGER NOT NULL REFERENCES runs(id),
    time_s REAL, chainage_m REAL, value TEXT NOT NULL) STRICT;
CREATE INDEX candidates_of_run ON candidates (run_id);
CREATE TABLE manual_candidates (
    candidate_id INTEGER PRIMARY KEY REFERENCES candidates(id), withdrawn INTEGER NOT NULL DEFAULT 0) STRICT;
CREATE TABLE carried (
    from_id INTEGER NOT NULL REFERENCES candidates(id), to_id INTEGER NOT NULL REFERENCES candidates(id),
    by_hand INTEGER NOT NULL DEFAULT 0, PRIMARY KEY (from_id, to_id)) STRICT;
CREATE TABLE decision_log (
    id INTEGER PRIMARY KEY AUTOINCREMENT, at_utc TEXT NOT NULL, operator TEXT NOT NULL, reason TEXT NOT NULL,
    candidate_id INTEGER NOT NULL REFERENCES candidates(id), before TEXT NOT NULL, after TEXT NOT NULL) STRICT;
CREATE TABLE decisions (
    candidate_id INTEGER PRIMARY KEY REFERENCES candidates(id), value TEXT NOT NULL,
    log_id INTEGER NOT NULL REFERENCES decision_log(id)) STRICT;
"""

# 1.1: what else people say of a leak, which they know by its number, the same from run to run
_REVIEW_FACTS = """
CREATE TABLE photos (
    id INTEGER PRIMARY KEY AUTOINCREMENT, number INTEGER NOT NULL, at_utc TEXT NOT NULL, operator TEXT NOT NULL,
    value TEXT NOT NULL, withdrawn INTEGER NOT NULL DEFAULT 0) STRICT;
CREATE TABLE dig_results (
    id INTEGER PRIMARY KEY AUTOINCREMENT, number INTEGER NOT NULL, at_utc TEXT NOT NULL, operator TEXT NOT NULL,
    value TEXT) STRICT;
CREATE TABLE opinions (
    id INTEGER PRIMARY KEY AUTOINCREMENT, number INTEGER NOT NULL, at_utc TEXT NOT NULL, reviewer TEXT NOT NULL,
    value TEXT) STRICT;
"""

_APPEND_ONLY = ("survey_log", "runs", "candidates", "decision_log", "carried", "recording_files")
_APPEND_ONLY_1_1 = ("dig_results", "opinions")


def _parts(ddl: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in ddl.split(";") if part.strip())


def _guards(tables: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(
        f"CREATE TRIGGER {table}_no_{verb.lower()} BEFORE {verb} ON {table} "
        f"BEGIN SELECT RAISE(ABORT, '{table} is append-only'); END"
        for table in tables
        for verb in ("UPDATE", "DELETE")
    )


# from version → the statements that lead to the next one, which is stated first
Migrations = Mapping[int, tuple[int, tuple[str, ...]]]
MIGRATIONS: Migrations = {1000: (1001, _parts(_REVIEW_FACTS) + _guards(_APPEND_ONLY_1_1))}


def statements() -> tuple[str, ...]:
    """Return all statements that make an empty database a survey of version :data:`VERSION`."""
    return _parts(_DDL) + _guards(_APPEND_ONLY) + _parts(_REVIEW_FACTS) + _guards(_APPEND_ONLY_1_1)


def major(version: int) -> int:
    """Return the major part of a packed version."""
    return version // 1000


def version_text(version: int) -> str:
    """Return a packed version as people write it: ``1.0``."""
    return f"{version // 1000}.{version % 1000}"
