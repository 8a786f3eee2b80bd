"""The whole job without a window: a folder in, the report's files out."""

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from pathlib import Path

from app.presets import effective_settings
from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.choosing import SURVEY_FILE, folder_of
from processing.importing.folder import ImportOptions, read_survey
from processing.importing.sound_files import pick_audio, raw_form_of
from processing.importing.survey_toml import apply_override
from processing.pipeline import process, read_recording
from processing.progress import Progress
from processing.reporting.exports import write_exports
from processing.reporting.options import HandoverOptions
from processing.results import Results
from processing.settings import Settings
from processing.storage.cache import Cache
from processing.storage.carrying import partners
from processing.storage.folder import SurveyFolder, is_survey_folder
from processing.storage.record import review_record
from processing.storage.review import ReviewStore
from processing.survey import Decision, Survey

_ABOUT_WHAT_WAS_TOLD = (
    ErrorCode.SETTING_INVALID,
    ErrorCode.CRS_UNKNOWN,
    ErrorCode.LAUNCH_INCOMPLETE,
    ErrorCode.LAUNCH_INVALID,
    ErrorCode.PATH_IMPOSSIBLE,
)


def process_folder(
    path: Path,
    out: Path,
    overrides: list[str],
    language: str,
    progress: Progress,
    handover: HandoverOptions | None = None,
) -> Results:
    """Process a device's folder, a single log, or a project, and write the files of the README into ``out``.

    ``overrides`` are ``table.key=value``. A project's verdicts go into the files; nothing in it is changed. With
    ``handover`` its files are written too; what was left out of them stands among the findings of the results.

    Raises:
        LeaklineError: what the user can mend, with its place.
    """
    if not path.exists():
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path))
    _check_writable(out)
    if is_survey_folder(path):
        return _process_project(path, out, overrides, language, progress, handover)
    survey, settings = _overridden(read_survey(path), Settings(), overrides)
    with _naming(path, overrides):
        return _process_recording(path, out, survey, settings, overrides, language, progress, handover)


def _process_recording(
    path: Path,
    out: Path,
    survey: Survey,
    settings: Settings,
    overrides: list[str],
    language: str,
    progress: Progress,
    handover: HandoverOptions | None,
) -> Results:
    options = _told_sound(path, survey, overrides)
    with tempfile.TemporaryDirectory(prefix="leakline-", ignore_cleanup_errors=True) as scratch:
        cache = Cache(Path(scratch))
        recording = read_recording(path, options, settings.importing, cache, progress.part(0.0, 0.3, "importing"))
        results = process(survey, recording, effective_settings(settings, survey), cache, progress.part(0.3, 0.9))
        language = _report_language(settings, language)
        written = write_exports(results, {}, out, progress.part(0.9, 1.0), language, handover=handover)
    return replace(results, findings=results.findings + written.findings)


def _process_project(
    path: Path,
    out: Path,
    overrides: list[str],
    language: str,
    progress: Progress,
    handover: HandoverOptions | None,
) -> Results:
    with SurveyFolder.open(path, read_only=True) as folder:
        survey, settings = _overridden(folder.read_survey(), folder.read_settings(), overrides)
        options = ImportOptions.from_json(folder.read_import_options(), folder.original_dir)
        files = folder.files()
        recording = read_recording(folder.original_dir, options, settings.importing, folder.cache(), progress, files)
        settings = effective_settings(settings, survey)
        results = process(survey, recording, settings, folder.cache(), progress.part(0.3, 0.9))
        results, decisions = reviewed(results, folder.review)
        language, record = _report_language(settings, language), review_record(folder, folder.review.latest_run())
        progress = progress.part(0.9, 1.0)
        written = write_exports(results, decisions, out, progress, language, record, handover=handover)
    return replace(results, findings=results.findings + written.findings)


def reviewed(results: Results, review: ReviewStore) -> tuple[Results, Mapping[int, Decision]]:
    """Return the results with the stored candidates, and the decisions on them; bare ones before a review.

    Where the results are of other settings than the review, decisions are carried over by place and time as a new run
    would; what was decided or marked and is not found again stays in the list, under a number of its own.
    """
    run = review.latest_run()
    if run is None:
        return results, {}
    stored, decisions = review.candidates(run), review.decisions(run)
    if run.settings_hash == results.run_hash:
        return replace(results, candidates=stored), decisions
    found = partners(stored, results.candidates)
    lost = [c for c in stored if c.id not in found and (c.id in decisions or c.id in review.manual_ids(run))]
    first = max((c.id for c in results.candidates), default=0) + 1
    found |= {candidate.id: number for number, candidate in enumerate(lost, first)}
    labels = {found[candidate.id]: candidate.label for candidate in stored if candidate.id in found}
    free = count(max((candidate.label for candidate in stored), default=0) + 1)
    fresh = tuple(replace(c, number=labels[c.id] if c.id in labels else next(free)) for c in results.candidates)
    kept = tuple(replace(candidate, id=found[candidate.id], number=candidate.label) for candidate in lost)
    carried = {found[number]: decision for number, decision in decisions.items() if number in found}
    return replace(results, candidates=fresh + kept), carried


def _report_language(settings: Settings, spoken: str) -> str:
    """Return the language of the report: that of the command line, unless only the settings name another one."""
    return settings.report.language if spoken == "en" else spoken


def _overridden(survey: Survey, settings: Settings, overrides: list[str]) -> tuple[Survey, Settings]:
    for words in overrides:
        survey, settings = apply_override(survey, settings, words)
    return survey, settings


def _told_sound(path: Path, survey: Survey, overrides: list[str]) -> ImportOptions:
    """Return import options with the sound that ``--set`` names: import itself knows only what survey.toml says."""
    told = {words.partition("=")[0].strip() for words in overrides}
    files = None
    if "audio.file" in told and survey.audio.file:
        files, _ = pick_audio(folder_of(path), (), survey.audio)
    form = raw_form_of(survey.audio) if any(name.startswith("audio.raw_") for name in told) else None
    return ImportOptions(audio_files=files, raw_form=form)


@contextmanager
def _naming(path: Path, overrides: list[str]) -> Iterator[None]:
    """Say of an error that names no file which one it is about: what was told, else the recording itself."""
    try:
        yield
    except LeaklineError as error:
        name = str(error.params.get("name", ""))
        if error.place is not None or any(words.partition("=")[0].strip() == name for words in overrides):
            raise
        told = folder_of(path) / SURVEY_FILE
        about_told = error.code in _ABOUT_WHAT_WAS_TOLD and told.is_file()
        raise LeaklineError(error.code, Place(told if about_told else path), **error.params) from error


def _check_writable(out: Path) -> None:
    """Learn that nothing can be written before an hour's work, not after it."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except OSError as error:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(out), reason=error.strerror or str(error)) from error
