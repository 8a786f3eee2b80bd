"""Another survey as it lies in its cache, opened read-only for a comparison; nothing is computed or changed there."""

from dataclasses import replace
from pathlib import Path

from app.opening import results_of, source_of
from processing.errors import ErrorCode, LeaklineError
from processing.progress import Progress
from processing.repeat_runs import ComparedRun
from processing.storage.cache_known import KnownCache
from processing.storage.folder import SurveyFolder


def other_run(path: Path, identity: str, progress: Progress) -> ComparedRun:
    """Return the latest run of the survey at ``path`` with its decisions; ``identity`` is that of the open one.

    Raises:
        LeaklineError: REPEAT_SAME_SURVEY, REPEAT_NOT_PROCESSED, and whatever opening finds.
    """
    with SurveyFolder.open(path, read_only=True) as folder:
        if folder.identity == identity:
            raise LeaklineError(ErrorCode.REPEAT_SAME_SURVEY)
        run = folder.review.latest_run()
        if run is None:
            raise LeaklineError(ErrorCode.REPEAT_NOT_PROCESSED)
        source = replace(source_of(folder), cache=KnownCache(folder.path / "cache"))
        results = results_of(source, progress)
        if results.run_hash != run.settings_hash:
            raise LeaklineError(ErrorCode.REPEAT_NOT_PROCESSED)
        # with the numbers and marks by which people know them
        results = replace(results, candidates=folder.review.candidates(run))
        info = results.survey.info
        name = info.name or folder.path.stem
        return ComparedRun(name, info.date, results, folder.review.decisions(run), folder.imported_utc)
