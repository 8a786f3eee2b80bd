"""Where two reviewers differ, and how well they agree beyond chance: Cohen's kappa with its interval.

Cohen (1960), Educational and Psychological Measurement 20, 37–46. The interval is Wilson's (1927) for the observed
agreement, chance agreement taken as known as in Cohen's own standard error: it stays honest where all agree, where the
usual formula claims to know the agreement exactly.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from processing.survey import Decision, Verdict

_Z95 = 1.959964
FEW = 10  # leaks judged by both; with fewer the figure says next to nothing


@dataclass(frozen=True)
class Agreement:
    """How many leaks both judged, how many alike, and kappa with its 95 % interval.

    ``kappa`` and its ends are None where there is none: nothing judged by both, or each gave but one same verdict.
    """

    count: int
    alike: int
    kappa: float | None = None
    low95: float | None = None
    high95: float | None = None


@dataclass(frozen=True)
class Difference:
    """A leak on which two reviewers differ; ``first`` is empty where the first has not judged it."""

    number: int
    first: Decision
    second: Decision

    @property
    def in_verdict(self) -> bool:
        """Whether the verdicts differ; else it is the class, or the note alone."""
        return self.first.verdict is not self.second.verdict

    @property
    def in_class(self) -> bool:
        """Whether the classes differ."""
        return self.first.leak_class is not self.second.leak_class


def differences(first: Mapping[int, Decision], second: Mapping[int, Decision]) -> tuple[Difference, ...]:
    """Return by leak number where the second says something else than the first; notes that are empty say nothing.

    What the second has not judged is no difference.
    """
    out = []
    for number in sorted(second):
        mine, theirs = first.get(number, Decision()), second[number]
        judged = theirs.verdict is not Verdict.NONE or theirs.leak_class is not None
        other_note = bool(theirs.note.strip()) and theirs.note.strip() != mine.note.strip()
        if (judged and (mine.verdict, mine.leak_class) != (theirs.verdict, theirs.leak_class)) or other_note:
            out.append(Difference(number, mine, theirs))
    return tuple(out)


def agreement(first: Mapping[int, Decision], second: Mapping[int, Decision]) -> Agreement:
    """Return how well the verdicts of two reviewers agree on the leaks that both judged."""
    both = [(first[n].verdict, second[n].verdict) for n in second if n in first]
    return kappa_of((a, b) for a, b in both if Verdict.NONE not in (a, b))


def kappa_of(pairs: Iterable[tuple[object, object]]) -> Agreement:
    """Return the agreement of pairs of words."""
    judged = list(pairs)
    count, alike = len(judged), sum(a == b for a, b in judged)
    if count == 0:
        return Agreement(0, 0)
    words = {word for pair in judged for word in pair}
    by_chance = sum(
        sum(a == word for a, _ in judged) / count * sum(b == word for _, b in judged) / count for word in words
    )
    if by_chance >= 1.0:
        return Agreement(count, alike)
    observed = alike / count
    low, high = _wilson(observed, count)
    kappa, low95, high95 = ((share - by_chance) / (1.0 - by_chance) for share in (observed, low, high))
    return Agreement(count, alike, kappa, max(low95, -1.0), min(high95, 1.0))


def _wilson(share: float, count: int) -> tuple[float, float]:
    z2 = _Z95 * _Z95
    middle = (share + z2 / (2.0 * count)) / (1.0 + z2 / count)
    half = _Z95 / (1.0 + z2 / count) * math.sqrt(share * (1.0 - share) / count + z2 / (4.0 * count * count))
    return max(middle - half, 0.0), min(middle + half, 1.0)
