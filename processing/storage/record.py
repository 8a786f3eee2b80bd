"""All that people added to a run, gathered from an open survey folder for the report and the hand-over."""

from processing.review_facts import DigHistory, LoggedDecision, ReviewRecord
from processing.storage.folder import SurveyFolder
from processing.survey import Run


def review_record(folder: SurveyFolder, run: Run | None, history: DigHistory | None = None) -> ReviewRecord:
    """Return the log up to ``run`` (None: all of it), photos, digs and opinions; ``history`` is the computer's own.

    Entries are told by the leaks' numbers, oldest first. What was said of leaks in later runs is left out: a report of
    a run is the same whenever it is made of the same decisions.

    Raises:
        LeaklineError: SURVEY_DAMAGED.
    """
    return ReviewRecord(log=decision_log(folder, run), history=history)


def decision_log(folder: SurveyFolder, run: Run | None) -> tuple[LoggedDecision, ...]:
    """Return who decided what when, oldest first, up to a run."""
    known = folder.review.known_as()
    entries = []
    for entry in folder.review.decision_log():
        run_id, number = known[entry.candidate_id]
        if run is None or run_id <= run.id:
            told = LoggedDecision(entry.at_utc, entry.operator, entry.reason.value, number, entry.before, entry.after)
            entries.append(told)
    return tuple(entries)
