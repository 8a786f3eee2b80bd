"""A row of the list of candidates, its order, and the filter that says which rows are shown."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

from processing.sound.sizes import LeakSize
from processing.survey import Candidate, Decision, LeakClass, Verdict

ORDERS = ("score", "chainage")
# in the order in which the key goes round; None: all
FILTER_ROUND: tuple[Verdict | None, ...] = (None, Verdict.NONE, Verdict.UNSURE, Verdict.CONFIRMED, Verdict.REJECTED)


@dataclass(frozen=True)
class CandidateRow:
    """A candidate with what a human said of it; ``manual`` ones were marked by hand."""

    candidate: Candidate
    decision: Decision
    manual: bool = False
    size: LeakSize | None = None  # that it would have as a leak

    @property
    def kind(self) -> LeakClass:
        """What it is taken for: by the operator, else by the machine."""
        return self.decision.leak_class or self.candidate.leak_class

    @property
    def leak_size(self) -> LeakSize | None:
        """The size, None for what is no leak."""
        return self.size if self.kind in (LeakClass.LEAK, LeakClass.UNKNOWN) else None

    @property
    def name(self) -> str:
        """The name on the list and in the views: L3, or M4 for a manual mark."""
        return f"{'M' if self.manual else 'L'}{self.candidate.label}"


def sort_rows(rows: Sequence[CandidateRow], order: str) -> list[CandidateRow]:
    """Return the rows best score first (``score``) or from the launch on (``chainage``), unknown ones last."""
    if order == "chainage":
        return sorted(rows, key=lambda r: (_known_first(r.candidate.chainage_m), r.candidate.id))
    return sorted(rows, key=lambda r: (_known_first(-r.candidate.score), r.candidate.id))


def _known_first(value: float) -> float:
    return math.inf if math.isnan(value) else value


@dataclass(frozen=True)
class CandidateFilter:
    """Which candidates the list shows: those of a verdict and a class with at least a score.

    None means any. A mark of the operator's has no score: the least score never hides it.
    """

    verdict: Verdict | None = None
    leak_class: LeakClass | None = None
    least_score: float = 0.0

    @property
    def is_on(self) -> bool:
        """Whether it could hide anything."""
        return self != CandidateFilter()

    def accepts(self, row: CandidateRow) -> bool:
        """Tell whether a row is shown."""
        return (
            (self.verdict is None or row.decision.verdict is self.verdict)
            and (self.leak_class is None or row.kind is self.leak_class)
            and not row.candidate.score < self.least_score  # NaN is not below anything
        )

    def next_verdict(self) -> Self:
        """Return the filter with the next verdict of the round, all else as it is."""
        at = FILTER_ROUND.index(self.verdict)
        return replace(self, verdict=FILTER_ROUND[(at + 1) % len(FILTER_ROUND)])

    def as_texts(self) -> dict[str, str]:
        """Return it as texts to be remembered; :meth:`from_texts` reads them."""
        return {
            "list.verdict": "" if self.verdict is None else self.verdict.value,
            "list.class": "" if self.leak_class is None else self.leak_class.value,
            "list.least_score": f"{self.least_score:.2f}",
        }

    @classmethod
    def from_texts(cls, texts: Mapping[str, str]) -> Self:
        """Return what was remembered; what cannot be understood hides nothing."""
        verdict, kind = texts.get("list.verdict", ""), texts.get("list.class", "")
        try:
            least = float(texts.get("list.least_score", "0"))
        except ValueError:
            least = 0.0
        return cls(
            Verdict(verdict) if verdict in set(Verdict) else None,
            LeakClass(kind) if kind in set(LeakClass) else None,
            least if 0.0 <= least <= 1.0 else 0.0,
        )
