"""What a plot knows of candidates, and what it tells of the place under the mouse."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from processing.survey import Candidate, Decision, Verdict


@dataclass(frozen=True)
class Readout:
    """What lies under the mouse; None for what a view does not know."""

    time_s: float | None
    chainage_m: float | None = None
    position_w_m: tuple[float, float, float] | None = None
    frequency_hz: float | None = None
    level_db: float | None = None
    value: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class Marks:
    """Candidates with the operator's word on them, and which one is selected."""

    candidates: Sequence[Candidate] = ()
    decisions: Mapping[int, Decision] | None = None
    selected: int | None = None
    dug: Mapping[int, str] | None = None  # by the leak's number: the sign of what a dig showed

    def verdict(self, candidate: Candidate) -> Verdict:
        """Return the verdict on a candidate."""
        decision = (self.decisions or {}).get(candidate.id)
        return decision.verdict if decision is not None else Verdict.NONE

    @cached_property
    def in_drawing_order(self) -> list[Candidate]:
        """The candidates so that the weighty ones, and last the selected one, come on top."""
        rank = {Verdict.REJECTED: 0, Verdict.NONE: 1, Verdict.UNSURE: 2, Verdict.CONFIRMED: 3}
        return sorted(self.candidates, key=lambda c: (c.id == self.selected, rank[self.verdict(c)], c.score))


def report_paint_error() -> None:
    """Hand the exception in work to the crash guard: PySide takes the process down when paint events raise."""
    sys.excepthook(*sys.exc_info())
