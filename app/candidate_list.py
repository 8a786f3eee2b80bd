"""The candidates of the present run with their decisions, in the order and through the filter of the list.

Plain state without signals: the session owns it, changes it and tells of it. Rows are made once and changed one by
one, so that a verdict among hundreds of candidates costs what it costs among three.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from processing.sound.sizes import LeakSize
from processing.survey import Candidate, Decision, Verdict
from widgets.candidate_row import CandidateFilter, CandidateRow, sort_rows

SizeOf = Callable[[Candidate], LeakSize | None]


class CandidateList:
    """Ids are the database's. The selected candidate is always shown, whatever the filter says.

    So the one that is being decided leaves a list of undecided ones only when the operator has moved on: nothing
    jumps under the finger, and what an undo brings back is there to be seen.
    """

    def __init__(self, size_of: SizeOf) -> None:
        self._size_of = size_of
        self._rows: dict[int, CandidateRow] = {}
        self._sorted: list[int] = []
        self._order = "score"
        self.filter = CandidateFilter()
        self.selected: int | None = None

    # --- content ---

    def set_candidates(
        self, candidates: Iterable[Candidate], decisions: Mapping[int, Decision], manual: frozenset[int]
    ) -> None:
        """Take the candidates of a run."""
        self._rows = {
            c.id: CandidateRow(c, decisions.get(c.id, Decision()), c.id in manual, self._size_of(c)) for c in candidates
        }
        self._sort()

    def add_mark(self, candidate: Candidate, decision: Decision) -> None:
        """Take a mark of the operator's."""
        self._rows[candidate.id] = CandidateRow(candidate, decision, manual=True, size=self._size_of(candidate))
        self._sort()

    def remove(self, candidate_id: int) -> None:
        """Forget a candidate; one that is not there does no harm."""
        self._rows.pop(candidate_id, None)
        if self.selected == candidate_id:
            self.selected = None
        self._sort()

    def set_decision(self, candidate_id: int, decision: Decision) -> None:
        """Take a decision."""
        self._rows[candidate_id] = replace(self._rows[candidate_id], decision=decision)

    def measure_sizes(self) -> None:
        """Tell the sizes anew: they rest on the pressure and on a known leak, which the form may have changed."""
        self._rows = {i: replace(row, size=self._size_of(row.candidate)) for i, row in self._rows.items()}

    @property
    def order(self) -> str:
        """``score`` or ``chainage``."""
        return self._order

    @order.setter
    def order(self, order: str) -> None:
        self._order = order
        self._sort()

    def _sort(self) -> None:
        self._sorted = [row.candidate.id for row in sort_rows(list(self._rows.values()), self._order)]

    # --- what is there ---

    def row(self, candidate_id: int | None) -> CandidateRow | None:
        """Return one candidate with its decision; None for none, or one that is not there."""
        return None if candidate_id is None else self._rows.get(candidate_id)

    def rows(self) -> list[CandidateRow]:
        """Return all candidates in the order of the list, whatever the filter says."""
        return [self._rows[i] for i in self._sorted]

    def ids(self) -> list[int]:
        """Return all ids in the order of the list."""
        return list(self._sorted)

    def shown(self) -> list[CandidateRow]:
        """Return the rows that the filter lets through, and the selected one."""
        return [row for row in self.rows() if row.candidate.id == self.selected or self.filter.accepts(row)]

    def shown_ids(self) -> list[int]:
        """Return the ids of :meth:`shown`."""
        return [row.candidate.id for row in self.shown()]

    def decisions(self) -> dict[int, Decision]:
        """Return the decisions that say something, by candidate id."""
        return {i: row.decision for i, row in self._rows.items() if row.decision != Decision()}

    def manual_ids(self) -> frozenset[int]:
        """Return which of them the operator marked."""
        return frozenset(i for i, row in self._rows.items() if row.manual)

    # --- moving ---

    def neighbour(self, step: int) -> int | None:
        """Return the id ``step`` places down the shown list, the ends being the ends."""
        ids = self.shown_ids()
        if not ids:
            return None
        at = ids.index(self.selected) if self.selected in ids else -1 if step > 0 else len(ids)
        return ids[min(max(at + step, 0), len(ids) - 1)]

    def next_undecided(self, after: int | None, *, upwards: bool = False) -> int | None:
        """Return the next shown candidate without a verdict, below ``after``, then from the top; None for none.

        ``upwards`` looks above ``after``, then from the bottom.
        """
        return self._next(after, lambda row: row.decision.verdict is Verdict.NONE, upwards=upwards)

    def next_to_judge(self, after: int | None) -> int | None:
        """Return where a verdict on ``after`` leads: to the next undecided one.

        In a list of what is unsure, confirmed or rejected, which has none, to the next of those.
        """
        wanted = Verdict.NONE if self.filter.verdict is None else self.filter.verdict
        return self._next(after, lambda row: row.decision.verdict is wanted)

    def _next(self, after: int | None, wanted: Callable[[CandidateRow], bool], *, upwards: bool = False) -> int | None:
        ids = [row.candidate.id for row in self.rows() if row.candidate.id == after or self.filter.accepts(row)]
        if upwards:
            ids.reverse()
        start = ids.index(after) + 1 if after in ids else 0
        return next((i for i in ids[start:] + ids[:start] if i != after and wanted(self._rows[i])), None)
