"""Writes rows of the review into a survey database, within a transaction of the caller's."""

from dataclasses import replace
from datetime import UTC, datetime
from sqlite3 import Connection

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage.database import Database
from processing.storage.plain import storable, to_json
from processing.survey import Candidate, Decision


class Understood:
    """Turns a ValueError about stored text into SURVEY_DAMAGED; a class, as it runs once a row."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _trace: object) -> None:
        if isinstance(error, ValueError):
            raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(self._database.path), reason=str(error)) from error


def now() -> str:
    """Return the present moment as the tables keep it: ISO 8601, UTC, milliseconds."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def inserted(db: Connection, sql: str, values: tuple[object, ...]) -> int:
    """Run an INSERT and return the id of its row."""
    row_id = db.execute(sql, values).lastrowid
    assert row_id is not None  # it is set by every INSERT
    return row_id


def insert_candidate(db: Connection, run_id: int, candidate: Candidate) -> Candidate:
    """Store a candidate of a run; return it with its id."""
    sql = "INSERT INTO candidates (run_id, time_s, chainage_m, value) VALUES (?, ?, ?, ?)"
    values = (run_id, candidate.time_s, candidate.chainage_m, to_json(candidate))
    return replace(candidate, id=inserted(db, sql, values))


def log(db: Connection, operator: str, reason: str, candidate_id: int, before: Decision, after: Decision) -> int:
    """Write a row of the decision log; return its id."""
    sql = "INSERT INTO decision_log (at_utc, operator, reason, candidate_id, before, after) VALUES (?, ?, ?, ?, ?, ?)"
    return inserted(db, sql, (now(), storable(operator), reason, candidate_id, to_json(before), to_json(after)))
