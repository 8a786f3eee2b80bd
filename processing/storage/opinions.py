"""What second reviewers say of the leaks: append-only, on disc before the call returns, taken back by a newer row."""

from processing.errors import ErrorCode, LeaklineError, Place
from processing.review_facts import Opinion
from processing.storage.database import Database, Row
from processing.storage.plain import from_json, storable, to_json
from processing.storage.times import now_utc
from processing.survey import Decision

_ALL = "SELECT number, reviewer, value, at_utc FROM opinions ORDER BY id"
_STANDING = (
    "SELECT number, reviewer, value, at_utc FROM opinions WHERE id IN "
    "(SELECT max(id) FROM opinions GROUP BY number, reviewer) AND value IS NOT NULL ORDER BY number, id"
)


class OpinionStore:
    """The opinions of a survey; the state is always what the newest row of each leak and reviewer says."""

    def __init__(self, database: Database) -> None:
        self._db = database

    def give(self, number: int, reviewer: str, decision: Decision) -> Opinion:
        """Store what ``reviewer`` says of leak ``number``, on disc when this returns; ``Decision()`` takes it back.

        Raises:
            LeaklineError: SURVEY_READ_ONLY, DISC_FULL, CANNOT_WRITE.
        """
        return self.give_all({number: decision}, reviewer)[0]

    def give_all(self, decisions: dict[int, Decision], reviewer: str) -> tuple[Opinion, ...]:
        """Store many at once, by the leak's number: all of them or, where it cannot be written, none."""
        reviewer = reviewer_name(reviewer)
        if not reviewer:
            raise ValueError("an opinion is somebody's")
        at_utc = now_utc()
        given = tuple(Opinion(number, reviewer, decision, at_utc) for number, decision in decisions.items())
        sql = "INSERT INTO opinions (number, at_utc, reviewer, value) VALUES (?, ?, ?, ?)"
        rows = [(o.number, at_utc, reviewer, None if o.decision == Decision() else to_json(o.decision)) for o in given]
        with self._db.transaction() as db:
            db.executemany(sql, rows)
        return given

    def opinions(self, reviewer: str | None = None) -> tuple[Opinion, ...]:
        """Return what holds now, of one reviewer or of all: by leak, then by who spoke first."""
        found = tuple(self._opinion(row) for row in self._db.rows(_STANDING))
        return found if reviewer is None else tuple(o for o in found if o.reviewer == reviewer)

    def of(self, reviewer: str) -> dict[int, Decision]:
        """Return leak number → decision of one reviewer."""
        return {opinion.number: opinion.decision for opinion in self.opinions(reviewer)}

    def reviewers(self) -> tuple[str, ...]:
        """Return who has an opinion on any leak, in the order in which they first spoke."""
        holding = {opinion.reviewer for opinion in self.opinions()}
        rows = self._db.rows("SELECT reviewer FROM opinions GROUP BY reviewer ORDER BY min(id)")
        return tuple(row[0] for row in rows if row[0] in holding)

    def log(self) -> tuple[Opinion, ...]:
        """Return everything that was ever said, oldest first; what was taken back has an empty decision."""
        return tuple(self._opinion(row) for row in self._db.rows(_ALL))

    def _opinion(self, row: Row) -> Opinion:
        try:
            decision = Decision() if row[2] is None else from_json(Decision, row[2])
        except ValueError as error:
            raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(self._db.path), reason=str(error)) from error
        return Opinion(row[0], row[1], decision, row[3])


def reviewer_name(text: str) -> str:
    """Return a name as it is stored: one line, single spaces, at most 80 characters."""
    return storable(" ".join(text.split()))[:80].strip()
