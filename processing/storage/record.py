"""All that people added to a run, gathered from an open survey folder for the report and the hand-over."""

from collections.abc import Sequence

from processing.review_facts import DigHistory, DigResult, LoggedDecision, Opinion, ReviewRecord
from processing.storage.digs import DigEntry
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, Run


def review_record(folder: SurveyFolder, run: Run | None, history: DigHistory | None = None) -> ReviewRecord:
    """Return the log up to ``run`` (None: all of it), photos, digs and opinions; ``history`` is the computer's own.

    All is told by the leaks' numbers. What was decided on leaks of later runs is left out; photos, digs and opinions
    belong to a place, whichever run found it, and come as they are now.

    Raises:
        LeaklineError: SURVEY_DAMAGED.
    """
    photos = folder.photos.photos()
    said = [*decided(folder, run), *second_opinions(folder.opinions.log()), *dug(folder.digs.log())]
    return ReviewRecord(
        log=tuple(sorted(said, key=lambda entry: entry.at_utc)),
        photos=tuple((photo, str(folder.photos.path(photo))) for photo in photos),
        digs=folder.digs.results(),
        opinions=folder.opinions.opinions(),
        history=history,
    )


def decided(folder: SurveyFolder, run: Run | None) -> list[LoggedDecision]:
    """Return who decided what when, oldest first, up to a run."""
    known = folder.review.known_as()
    entries = []
    for entry in folder.review.decision_log():
        run_id, number = known[entry.candidate_id]
        if run is None or run_id <= run.id:
            told = LoggedDecision(entry.at_utc, entry.operator, entry.reason.value, number, entry.before, entry.after)
            entries.append(told)
    return entries


def second_opinions(said: Sequence[Opinion]) -> list[LoggedDecision]:
    """Return second opinions as lines of the log, each with what the same reviewer had said before."""
    before: dict[tuple[int, str], Decision] = {}
    entries = []
    for opinion in said:
        key = opinion.number, opinion.reviewer
        earlier = before.get(key, Decision())
        entries.append(
            LoggedDecision(opinion.at_utc, opinion.reviewer, "opinion", opinion.number, earlier, opinion.decision)
        )
        before[key] = opinion.decision
    return entries


def dug(entries: Sequence[DigEntry]) -> list[LoggedDecision]:
    """Return dig results as lines of the log: what was found and how far off stands where a decision has its note."""
    before: dict[int, Decision] = {}
    lines = []
    for entry in entries:
        after = Decision(note=dig_note(entry.result))
        earlier = before.get(entry.number, Decision())
        lines.append(LoggedDecision(entry.at_utc, entry.operator, "dig", entry.number, earlier, after))
        before[entry.number] = after
    return lines


def dig_note(result: DigResult | None) -> str:
    """Return a dig in a word and a figure, as files have it: ``leak +0.40 m``; empty where it was taken back."""
    if result is None:
        return ""
    off = f" {result.off_along_m:+.2f} m" if result.off_along_m is not None else ""
    return f"{result.finding.value}{off}"
