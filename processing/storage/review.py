"""Runs, their candidates, and the operator's decisions: append-only, logged, on disc before the call returns.

The state of the decisions is always what replaying the log from its start gives (:func:`replay`).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from sqlite3 import Connection

from processing.storage.carrying import partners
from processing.storage.database import Database, Row
from processing.storage.plain import from_json, to_json
from processing.storage.review_rows import Understood, insert_candidate, inserted, log, now
from processing.survey import Candidate, Decision, Params, Run

UNDECIDED = Decision()


class Reason(StrEnum):
    """Why a row of the decision log was written."""

    DECIDE = "decide"
    UNDO = "undo"
    REDO = "redo"
    CARRY = "carry"  # a new run found the same candidate again
    ADD = "add"  # the operator marked a place himself
    WITHDRAW = "withdraw"  # … and took the mark back
    REINSTATE = "reinstate"  # … and put it there again


@dataclass(frozen=True)
class LogEntry:
    """One row of the decision log; ids grow, whatever the computer's clock does."""

    id: int
    at_utc: str
    operator: str
    reason: Reason
    candidate_id: int
    before: Decision
    after: Decision


@dataclass(frozen=True)
class StoredRun:
    """A run as stored: candidates with their database ids, and what became of the earlier decisions.

    ``carried`` is new id → old id; ``is_new`` is False where the latest run was the same and has been kept.
    """

    run: Run
    candidates: tuple[Candidate, ...]
    carried: dict[int, int]
    is_new: bool = True


@dataclass(frozen=True)
class Orphan:
    """A decision whose candidate the latest run did not find again."""

    candidate: Candidate
    run_id: int
    decision: Decision


class ReviewStore:
    """The review in a survey database. All ids are the database's own, unique over all runs."""

    def __init__(self, database: Database) -> None:
        self._db = database
        self._highest_number: int | None = None  # that a candidate was ever called by, once it was asked for

    # --- runs and candidates

    def runs(self) -> tuple[Run, ...]:
        """Return all runs, oldest first."""
        rows = self._db.rows("SELECT id, created_utc, settings_hash, versions FROM runs ORDER BY id")
        return tuple(self._run(row) for row in rows)

    def latest_run(self) -> Run | None:
        """Return the newest run, None before the first."""
        row = self._db.one("SELECT id, created_utc, settings_hash, versions FROM runs ORDER BY id DESC LIMIT 1")
        return None if row is None else self._run(row)

    def add_run(
        self,
        run: Run,
        candidates: Sequence[Candidate],
        operator: str = "",
        relocate: Callable[[Candidate], Candidate] | None = None,
    ) -> StoredRun:
        """Store a run and its candidates, which get database ids, and carry all earlier decisions over.

        Candidates that the operator marked himself come along, moved by ``relocate`` to where the new track puts
        their moment, unless the run found them on its own. What finds no partner: :meth:`orphaned_decisions`.
        A run that equals the latest one in ``settings_hash`` and candidates is not stored again.
        """
        latest = self.latest_run()
        if latest is not None and latest.settings_hash == run.settings_hash:
            stored = self._same_run(latest, candidates)
            if stored is not None:
                return stored
        with self._db.transaction() as db:
            created = run.created_utc or now()
            values = (created, run.settings_hash, to_json(run.versions))
            run_id = inserted(db, "INSERT INTO runs (created_utc, settings_hash, versions) VALUES (?, ?, ?)", values)
            known = self.candidates(latest) if latest is not None else ()
            waiting = {o.candidate.id: o for o in self._open_decisions(with_marks=True)}
            # the undecided ones too: one that is plainly found again takes no decision from its neighbour
            earlier = {c.id: c for c in known} | {i: orphan.candidate for i, orphan in waiting.items()}
            named = [replace(candidate, id=place) for place, candidate in enumerate(candidates)]
            found = partners(list(earlier.values()), named)
            numbered = self._numbered(named, {place: earlier[old].label for old, place in found.items()})
            fresh = [insert_candidate(db, run_id, candidate) for candidate in numbered]
            again = {old: fresh[place].id for old, place in found.items() if old in waiting}
            carried = self._carry(db, run_id, waiting, again, operator, relocate)
        return StoredRun(replace(run, id=run_id, created_utc=created), self.candidates(run_id), carried)

    def candidates(self, run: Run | int) -> tuple[Candidate, ...]:
        """Return the candidates of a run in the order they were stored, the operator's own marks last."""
        rows = self._db.rows(
            "SELECT c.id, c.value FROM candidates c LEFT JOIN manual_candidates m ON m.candidate_id = c.id "
            "WHERE c.run_id = ? AND coalesce(m.withdrawn, 0) = 0 ORDER BY m.candidate_id IS NOT NULL, c.id",
            (_id(run),),
        )
        return tuple(self._candidate(row) for row in rows)

    def manual_ids(self, run: Run | int) -> frozenset[int]:
        """Return which candidates of a run the operator marked himself."""
        rows = self._db.rows(
            "SELECT m.candidate_id FROM manual_candidates m JOIN candidates c ON c.id = m.candidate_id "
            "WHERE c.run_id = ? AND NOT m.withdrawn",
            (_id(run),),
        )
        return frozenset(row[0] for row in rows)

    def carried(self, run: Run | int) -> dict[int, int]:
        """Return new id → old id of those candidates of a run whose decision came from an earlier run."""
        sql = "SELECT k.to_id, k.from_id FROM carried k JOIN candidates c ON c.id = k.to_id WHERE c.run_id = ?"
        return dict(self._db.rows(sql, (_id(run),)))

    # --- decisions

    def decisions(self, run: Run | int) -> dict[int, Decision]:
        """Return candidate id → decision for all candidates of a run that have one."""
        rows = self._db.rows(
            "SELECT c.id, d.value FROM decisions d JOIN candidates c ON c.id = d.candidate_id "
            "LEFT JOIN manual_candidates m ON m.candidate_id = c.id "
            "WHERE c.run_id = ? AND coalesce(m.withdrawn, 0) = 0",
            (_id(run),),
        )
        return {row[0]: self._decision(row[1]) for row in rows}

    def decision(self, candidate_id: int) -> Decision:
        """Return the decision on one candidate; ``Decision()`` if there is none."""
        row = self._db.one("SELECT value FROM decisions WHERE candidate_id = ?", (candidate_id,))
        return UNDECIDED if row is None else self._decision(row[0])

    def decide(self, candidate_id: int, decision: Decision, operator: str, reason: str = Reason.DECIDE) -> int:
        """Store a decision and its log row in one transaction, on disc when this returns; return the log's id.

        ``reason`` is ``decide``, ``undo`` or ``redo``; ``Decision()`` clears. Raises KeyError for an unknown candidate.
        """
        with self._db.transaction() as db:
            return self._write(db, candidate_id, decision, operator, Reason(reason))

    def decide_many(
        self, decisions: Mapping[int, Decision], operator: str, reason: str = Reason.DECIDE
    ) -> tuple[int, ...]:
        """Store decisions on many candidates, each with its log row: all of them on disc when this returns, or none.

        Returns the log's ids. Raises KeyError for an unknown candidate; then nothing is stored.
        """
        with self._db.transaction() as db:
            return tuple(self._write(db, i, decision, operator, Reason(reason)) for i, decision in decisions.items())

    def decision_log(self) -> tuple[LogEntry, ...]:
        """Return the whole log, oldest first."""
        rows = self._db.rows(
            "SELECT id, at_utc, operator, reason, candidate_id, before, after FROM decision_log ORDER BY id"
        )
        return tuple(self._log_entry(row) for row in rows)

    def known_as(self) -> dict[int, tuple[int, int]]:
        """Return candidate id → its run's id and the number that people call it by, withdrawn marks too."""
        rows = self._db.rows("SELECT id, value, run_id FROM candidates")
        return {row[0]: (row[2], self._candidate(row).label) for row in rows}

    def orphaned_decisions(self) -> tuple[Orphan, ...]:
        """Return the decisions of earlier runs that no later run's candidate has taken over.

        Clearing one (``decide(orphan.candidate.id, Decision(), …)``) takes it off this list, the log keeps it.
        """
        latest = self.latest_run()
        return () if latest is None else tuple(o for o in self._open_decisions() if o.run_id != latest.id)

    def keep_orphan(self, candidate_id: int, operator: str) -> Candidate:
        """Put an orphaned decision's candidate into the latest run as the operator's own mark, decision and all.

        Undone by :meth:`withdraw_manual_candidate`, which lists the orphan again.
        """
        orphan = next(o for o in self.orphaned_decisions() if o.candidate.id == candidate_id)
        latest = self.latest_run()
        assert latest is not None  # there are no orphans without a run
        with self._db.transaction() as db:
            return self._continue_manually(db, latest.id, orphan, orphan.candidate, operator, by_hand=True)

    # --- the operator's own marks

    def add_manual_candidate(
        self, run: Run | int, candidate: Candidate, operator: str, decision: Decision = UNDECIDED
    ) -> Candidate:
        """Store a place that the operator marked himself, logged, with its decision; return it with its id."""
        with self._db.transaction() as db:
            stored = self._insert_manual(db, _id(run), candidate)
            log(db, operator, Reason.ADD, stored.id, UNDECIDED, UNDECIDED)
            if decision != UNDECIDED:
                self._write(db, stored.id, decision, operator, Reason.DECIDE)
        return stored

    def withdraw_manual_candidate(self, candidate_id: int, operator: str) -> int:
        """Take back the operator's own mark: it is hidden with its decision, never deleted; return the log's id."""
        return self._set_withdrawn(candidate_id, operator, withdrawn=True)

    def reinstate_manual_candidate(self, candidate_id: int, operator: str) -> int:
        """Undo :meth:`withdraw_manual_candidate`; return the log's id."""
        return self._set_withdrawn(candidate_id, operator, withdrawn=False)

    def move_manual_candidate(self, candidate_id: int, moved: Candidate, operator: str) -> Candidate:
        """Put the operator's own mark to another place, with its number and decision; return it with its new id.

        The mark before is withdrawn, never changed. Raises KeyError if ``candidate_id`` is no mark that is there.
        """
        with self._db.transaction() as db:
            sql = (
                "SELECT c.run_id, c.value FROM candidates c JOIN manual_candidates m ON m.candidate_id = c.id "
                "WHERE c.id = ? AND NOT m.withdrawn"
            )
            row = self._db.one(sql, (candidate_id,))
            if row is None:
                raise KeyError(candidate_id)
            before, decision = self._candidate((candidate_id, row[1])), self.decision(candidate_id)
            # first: told by numbers, the log must not end with a mark taken back that is there
            self._withdraw(db, candidate_id, operator, withdrawn=True)
            stored = self._insert_manual(db, row[0], replace(moved, number=before.label))
            log(db, operator, Reason.ADD, stored.id, UNDECIDED, UNDECIDED)
            if decision != UNDECIDED:
                self._write(db, stored.id, decision, operator, Reason.CARRY)
            # a verdict without a candidate that was kept as this mark stays kept
            sql = (
                "INSERT INTO carried (from_id, to_id, by_hand) SELECT from_id, ?, by_hand FROM carried WHERE to_id = ?"
            )
            db.execute(sql, (stored.id, candidate_id))
        return stored

    def swap_manual_candidates(self, present_id: int, withdrawn_id: int, operator: str) -> None:
        """Undo :meth:`move_manual_candidate`: withdraw one place of a mark and put the other there again, in one."""
        with self._db.transaction() as db:
            self._withdraw(db, present_id, operator, withdrawn=True)
            self._withdraw(db, withdrawn_id, operator, withdrawn=False)

    # --- inner workings

    def _write(self, db: Connection, candidate_id: int, decision: Decision, operator: str, reason: Reason) -> int:
        if db.execute("SELECT 1 FROM candidates WHERE id = ?", (candidate_id,)).fetchone() is None:
            raise KeyError(candidate_id)
        log_id = log(db, operator, reason, candidate_id, self.decision(candidate_id), decision)
        if decision == UNDECIDED:
            db.execute("DELETE FROM decisions WHERE candidate_id = ?", (candidate_id,))
        else:
            values = (candidate_id, to_json(decision), log_id)
            db.execute("INSERT OR REPLACE INTO decisions (candidate_id, value, log_id) VALUES (?, ?, ?)", values)
        return log_id

    def _set_withdrawn(self, candidate_id: int, operator: str, *, withdrawn: bool) -> int:
        with self._db.transaction() as db:
            return self._withdraw(db, candidate_id, operator, withdrawn=withdrawn)

    def _withdraw(self, db: Connection, candidate_id: int, operator: str, *, withdrawn: bool) -> int:
        sql = "UPDATE manual_candidates SET withdrawn = ? WHERE candidate_id = ?"
        if db.execute(sql, (int(withdrawn), candidate_id)).rowcount != 1:
            raise KeyError(candidate_id)
        decision = self.decision(candidate_id)
        reason = Reason.WITHDRAW if withdrawn else Reason.REINSTATE
        return log(db, operator, reason, candidate_id, decision, decision)

    def _carry(
        self,
        db: Connection,
        run_id: int,
        waiting: Mapping[int, Orphan],
        found: dict[int, int],
        operator: str,
        relocate: Callable[[Candidate], Candidate] | None,
    ) -> dict[int, int]:
        """Let what was found again (old id → new id) have its decision, and the other marks come along."""
        manual = {row[0] for row in db.execute("SELECT candidate_id FROM manual_candidates")}
        for old_id, new_id in found.items():
            db.execute("INSERT INTO carried (from_id, to_id) VALUES (?, ?)", (old_id, new_id))
            if waiting[old_id].decision != UNDECIDED:
                self._write(db, new_id, waiting[old_id].decision, operator, Reason.CARRY)
        for old_id in sorted(manual & waiting.keys() - found.keys()):
            orphan = waiting[old_id]
            moved = relocate(orphan.candidate) if relocate is not None else orphan.candidate
            found[old_id] = self._continue_manually(db, run_id, orphan, moved, operator, by_hand=False).id
        return {new_id: old_id for old_id, new_id in found.items()}

    def _continue_manually(
        self, db: Connection, run_id: int, orphan: Orphan, moved: Candidate, operator: str, *, by_hand: bool
    ) -> Candidate:
        # photos, digs and second opinions are kept by the number
        stored = self._insert_manual(db, run_id, replace(moved, number=orphan.candidate.label))
        values = (orphan.candidate.id, stored.id, int(by_hand))
        db.execute("INSERT INTO carried (from_id, to_id, by_hand) VALUES (?, ?, ?)", values)
        if orphan.decision != UNDECIDED:
            self._write(db, stored.id, orphan.decision, operator, Reason.CARRY)
        return stored

    def _numbered(self, named: Sequence[Candidate], numbers: Mapping[int, int]) -> list[Candidate]:
        """Return the candidates under the numbers (by id) that people know them by; what is new gets the next ones."""
        free = self._next_number()
        out, taken = [], set[int]()
        for candidate in named:
            number = numbers.get(candidate.id, free)
            if number in taken:  # never two leaks of one name, whatever an older version stored
                number = free
            free += number == free
            taken.add(number)
            out.append(replace(candidate, number=number))
        self._highest_number = free - 1
        return out

    def _next_number(self) -> int:
        """Return the first number that nothing in this survey was ever called by; all are read but once."""
        if self._highest_number is None:
            rows = self._db.rows("SELECT id, value FROM candidates")
            self._highest_number = max((self._candidate(row).label for row in rows), default=0)
        return self._highest_number + 1

    def _insert_manual(self, db: Connection, run_id: int, candidate: Candidate) -> Candidate:
        candidate = candidate if candidate.number else replace(candidate, number=self._next_number())
        if self._highest_number is not None:
            self._highest_number = max(self._highest_number, candidate.number)
        stored = insert_candidate(db, run_id, candidate)
        db.execute("INSERT INTO manual_candidates (candidate_id) VALUES (?)", (stored.id,))
        return stored

    def _open_decisions(self, *, with_marks: bool = False) -> Iterable[Orphan]:
        """Yield what no later candidate has taken over: decisions, and on demand the operator's undecided marks."""
        rows = self._db.rows(
            "SELECT c.id, c.value, c.run_id, d.value, m.candidate_id FROM candidates c "
            "LEFT JOIN decisions d ON d.candidate_id = c.id LEFT JOIN manual_candidates m ON m.candidate_id = c.id "
            "WHERE (d.value IS NOT NULL OR m.candidate_id IS NOT NULL) AND coalesce(m.withdrawn, 0) = 0 "
            "AND NOT EXISTS (SELECT 1 FROM carried k LEFT JOIN manual_candidates w ON w.candidate_id = k.to_id "
            "WHERE k.from_id = c.id AND NOT (k.by_hand AND coalesce(w.withdrawn, 0))) ORDER BY c.id"
        )
        for row in rows:
            if row[3] is not None or with_marks:
                decision = UNDECIDED if row[3] is None else self._decision(row[3])
                yield Orphan(self._candidate(row), row[2], decision)

    def _same_run(self, latest: Run, candidates: Sequence[Candidate]) -> StoredRun | None:
        stored, manual = self.candidates(latest), self.manual_ids(latest)
        found = [to_json(replace(c, id=0, number=0)) for c in stored if c.id not in manual]  # as text: NaN equals NaN
        if found != [to_json(replace(c, id=0, number=0)) for c in candidates]:
            return None
        return StoredRun(latest, stored, self.carried(latest), is_new=False)

    def _log_entry(self, row: Row) -> LogEntry:
        with self._understood():
            before, after = from_json(Decision, row[5]), from_json(Decision, row[6])
            return LogEntry(row[0], row[1], row[2], Reason(row[3]), row[4], before, after)

    def _run(self, row: Row) -> Run:
        with self._understood():
            return Run(row[0], row[1], row[2], from_json(Params, row[3]))  # type: ignore[type-abstract]

    def _candidate(self, row: Row) -> Candidate:
        with self._understood():
            return replace(from_json(Candidate, row[1]), id=row[0])

    def _decision(self, text: str) -> Decision:
        with self._understood():
            return from_json(Decision, text)

    def _understood(self) -> Understood:
        return Understood(self._db)


def replay(entries: Iterable[LogEntry]) -> dict[int, Decision]:
    """Return candidate id → decision as the log's entries tell it: what the table of decisions must hold."""
    state: dict[int, Decision] = {}
    for entry in entries:
        state[entry.candidate_id] = entry.after
    return {candidate_id: decision for candidate_id, decision in state.items() if decision != UNDECIDED}


def _id(run: Run | int) -> int:
    return run if isinstance(run, int) else run.id
