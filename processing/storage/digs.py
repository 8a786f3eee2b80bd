"""What the digs showed, in the survey's database: append-only, on disc before the call returns; the newest counts.

A dig belongs to a leak by its number. What had been stated is frozen with its first entry: a correction of what was
found keeps it, and no later run makes an old statement look better.
"""

import math
from dataclasses import dataclass, replace
from datetime import UTC, datetime

from processing.errors import ErrorCode, LeaklineError, Place
from processing.review_facts import DigResult
from processing.stated import widened
from processing.storage.database import Database, Row
from processing.storage.plain import from_json, storable, to_json
from processing.survey import Candidate


@dataclass(frozen=True)
class DigEntry:
    """One row of the log of digs; ``result`` None took back what had been entered of this number."""

    id: int
    at_utc: str
    operator: str
    number: int
    result: DigResult | None


@dataclass(frozen=True)
class Statement:
    """What a run stated of a leak: its candidate as it stood in the report that a crew may have dug by."""

    run_id: int
    run_utc: str
    candidate: Candidate


class DigStore:
    """The digs in a survey database."""

    def __init__(self, database: Database) -> None:
        self._db = database

    def record(self, result: DigResult, operator: str) -> DigResult:
        """Store what a dig showed; return it with its moment, operator and statement.

        Where ``result`` states no place, that of the entry before is kept; ``missed`` leaks have none.

        Raises:
            LeaklineError: SURVEY_READ_ONLY, DISC_FULL, CANNOT_WRITE, SURVEY_LOCKED.
        """
        before = self.results().get(result.number)
        if before is not None and result.stated_chainage_m is None and not result.missed:
            result = stated_as(before, result)
        stored = replace(_without_nan(result), at_utc=_now(), operator=storable(operator))
        self._append(stored.number, stored.at_utc, stored.operator, to_json(stored))
        return stored

    def clear(self, number: int, operator: str) -> None:
        """Take back what was entered of a dig; the log keeps it. Raises as :meth:`record`."""
        self._append(number, _now(), storable(operator), None)

    def results(self) -> dict[int, DigResult]:
        """Return number → what its dig showed, the newest entry of each that was not taken back."""
        rows = self._db.rows(
            "SELECT id, at_utc, operator, number, value FROM dig_results "
            "WHERE id IN (SELECT max(id) FROM dig_results GROUP BY number) ORDER BY number"
        )
        entries = [self._entry(row) for row in rows]
        return {entry.number: entry.result for entry in entries if entry.result is not None}

    def log(self) -> tuple[DigEntry, ...]:
        """Return all entries, oldest first."""
        rows = self._db.rows("SELECT id, at_utc, operator, number, value FROM dig_results ORDER BY id")
        return tuple(self._entry(row) for row in rows)

    def statements(self, number: int) -> tuple[Statement, ...]:
        """Return what each run stated of the leak of this number, newest run first."""
        rows = self._db.rows(
            "SELECT c.run_id, r.created_utc, c.id, c.value FROM candidates c JOIN runs r ON r.id = c.run_id "
            "LEFT JOIN manual_candidates m ON m.candidate_id = c.id "
            "WHERE coalesce(m.withdrawn, 0) = 0 AND (instr(c.value, ?) OR c.id = ?) "
            "ORDER BY c.run_id DESC, c.id DESC",
            (f'"number":{number}', number),  # SQLite's own JSON functions refuse the NaN of a mark's score
        )
        found = (Statement(row[0], row[1], self._candidate(row)) for row in rows)
        return tuple(statement for statement in found if statement.candidate.label == number)

    def _append(self, number: int, at_utc: str, operator: str, value: str | None) -> None:
        with self._db.transaction() as db:
            sql = "INSERT INTO dig_results (number, at_utc, operator, value) VALUES (?, ?, ?, ?)"
            db.execute(sql, (number, at_utc, operator, value))

    def _entry(self, row: Row) -> DigEntry:
        if row[4] is None:
            return DigEntry(row[0], row[1], row[2], row[3], None)
        try:
            result = from_json(DigResult, row[4])
        except ValueError as error:
            raise self._damaged(error) from error
        return DigEntry(row[0], row[1], row[2], row[3], replace(result, number=row[3], at_utc=row[1], operator=row[2]))

    def _candidate(self, row: Row) -> Candidate:
        try:
            return replace(from_json(Candidate, row[3]), id=row[2])
        except ValueError as error:
            raise self._damaged(error) from error

    def _damaged(self, error: ValueError) -> LeaklineError:
        return LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(self._db.path), reason=str(error))


def stated_as(other: DigResult, result: DigResult) -> DigResult:
    """Return ``result`` with the statement of another entry."""
    return replace(
        result,
        stated_chainage_m=other.stated_chainage_m,
        stated_low95_m=other.stated_low95_m,
        stated_high95_m=other.stated_high95_m,
        stated_score=other.stated_score,
        stated_widen=other.stated_widen,
        run_id=other.run_id,
    )


def stated_by(candidate: Candidate, run_id: int, result: DigResult, widen: float = 1.0) -> DigResult:
    """Return ``result`` with what a run's report states of a candidate, its interval widened by ``widen``.

    A place or score that is not known becomes None.
    """
    told = widened(candidate, widen)
    return replace(
        result,
        stated_chainage_m=_known(told.chainage_m),
        stated_low95_m=_known(told.chainage_low95_m),
        stated_high95_m=_known(told.chainage_high95_m),
        stated_widen=max(widen, 1.0),
        stated_score=_known(candidate.score),
        run_id=run_id,
    )


def _known(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _without_nan(result: DigResult) -> DigResult:
    """Return the result with None for what is no number: JSON has no NaN that others could read."""
    return replace(
        result,
        off_along_m=_known(result.off_along_m),
        off_across_m=_known(result.off_across_m),
        depth_m=_known(result.depth_m),
        flow_lpm=_known(result.flow_lpm),
        stated_chainage_m=_known(result.stated_chainage_m),
        stated_low95_m=_known(result.stated_low95_m),
        stated_high95_m=_known(result.stated_high95_m),
        stated_score=_known(result.stated_score),
        sigma_m=_known(result.sigma_m),
    )


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
