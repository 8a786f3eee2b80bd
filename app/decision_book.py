"""Whose decisions the review reads and writes: the first reviewer's, or blind beside them a second one's opinions.

Plain functions over an open folder; ``reviewer`` is empty for the first.
"""

from collections.abc import Iterable, Mapping

from processing.storage.folder import SurveyFolder
from processing.survey import Candidate, Decision, Run


def read(folder: SurveyFolder, run: Run | None, candidates: Iterable[Candidate], reviewer: str) -> dict[int, Decision]:
    """Return candidate id → decision of those that have one."""
    if not reviewer:
        return folder.review.decisions(run) if run is not None else {}
    opinions = folder.opinions.of(reviewer)
    return {c.id: opinions[c.label] for c in candidates if c.label in opinions}


def read_one(folder: SurveyFolder, candidate: Candidate, reviewer: str) -> Decision:
    """Return the decision on one candidate; an empty one where there is none."""
    if not reviewer:
        return folder.review.decision(candidate.id)
    return folder.opinions.of(reviewer).get(candidate.label, Decision())


def write(
    folder: SurveyFolder,
    decisions: Mapping[int, Decision],
    labels: Mapping[int, int],
    operator: str,
    reason: str,
    reviewer: str,
) -> None:
    """Put decisions (candidate id → decision) on disk, all of them or none; ``labels`` are the candidates' numbers.

    Raises:
        LeaklineError: SURVEY_READ_ONLY, DISC_FULL, CANNOT_WRITE.
    """
    if reviewer:
        folder.opinions.give_all({labels[i]: decision for i, decision in decisions.items()}, reviewer)
    elif len(decisions) == 1:
        folder.review.decide(*next(iter(decisions.items())), operator, reason)
    else:
        folder.review.decide_many(decisions, operator, reason)
