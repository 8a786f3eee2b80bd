"""Opinions from a colleague's copy of the same survey: read without changing it, matched by number and place."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.review_facts import Opinion
from processing.storage.folder import SurveyFolder
from processing.survey import Candidate, Decision

SAME_TIME_S = 2.0  # of candidates without a place


@dataclass(frozen=True)
class Colleague:
    """What a copy holds: the sums of its originals, its leaks, and what was said of them."""

    path: Path
    sums: frozenset[str]
    candidates: tuple[Candidate, ...]
    opinions: tuple[Opinion, ...]


@dataclass(frozen=True)
class Matched:
    """Opinions that belong to leaks of this survey: reviewer → number → decision; ``left_out`` found no leak."""

    opinions: dict[str, dict[int, Decision]]
    left_out: int


def read_colleague(path: Path) -> Colleague:
    """Return what a survey folder holds of a second review; it is opened read-only. Any thread may do it.

    Raises:
        LeaklineError: what :meth:`SurveyFolder.open` says; OPINIONS_NONE.
    """
    with SurveyFolder.open(path, read_only=True) as folder:
        opinions = folder.opinions.opinions()
        if not opinions:
            raise LeaklineError(ErrorCode.OPINIONS_NONE, Place(path))
        run = folder.review.latest_run()
        candidates = folder.review.candidates(run) if run is not None else ()
        return Colleague(path, sums_of(folder), candidates, opinions)


def sums_of(folder: SurveyFolder) -> frozenset[str]:
    """Return the sums of the original files: what makes a survey this one."""
    return frozenset(file.sha256 for file in folder.files() if file.sha256)


def matched(colleague: Colleague, sums: frozenset[str], candidates: Iterable[Candidate]) -> Matched:
    """Return the opinions that belong to ``candidates``: of the same number, and where that leak is.

    Raises:
        LeaklineError: OPINIONS_OTHER_SURVEY, where no original file is the same or no leak is at its place.
    """
    mine = {candidate.label: candidate for candidate in candidates}
    theirs = {candidate.label: candidate for candidate in colleague.candidates}
    out: dict[str, dict[int, Decision]] = {}
    left_out = 0
    for opinion in colleague.opinions:
        number = opinion.number
        if number in mine and number in theirs and same_place(mine[number], theirs[number]):
            out.setdefault(opinion.reviewer, {})[number] = opinion.decision
        else:
            left_out += 1
    if not out or (sums and colleague.sums and not sums & colleague.sums):
        raise LeaklineError(ErrorCode.OPINIONS_OTHER_SURVEY, Place(colleague.path))
    return Matched(out, left_out)


def same_place(one: Candidate, other: Candidate) -> bool:
    """Tell whether two candidates' 95 % intervals meet; without places, whether they were heard at the same time."""
    if one.chainage_m == one.chainage_m and other.chainage_m == other.chainage_m:  # NaN is no place
        return one.chainage_low95_m <= other.chainage_high95_m and other.chainage_low95_m <= one.chainage_high95_m
    return abs(one.time_s - other.time_s) <= SAME_TIME_S
