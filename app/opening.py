"""The long steps behind opening and processing, as plain functions for a job's thread; they know no window."""

import logging
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from app.presets import effective_settings
from processing.errors import LeaklineError
from processing.importing.column_mapping import MappingStore
from processing.importing.folder import ImportOptions
from processing.progress import Progress
from processing.sound.pcm import RawForm
from processing.storage.creating import SUFFIX, create_folder, folder_name
from processing.storage.folder import SurveyFolder
from widgets.raw_form import RawAnswer

if TYPE_CHECKING:
    from processing.importing.preview import FilePreview, FolderPreview
    from processing.results import Results
    from processing.settings import Settings
    from processing.sound.coarse import CoarseTiles, GrowingPass
    from processing.storage.cache import Cache
    from processing.survey import ImportedFile, Survey

log = logging.getLogger(__name__)

TRIED_NAMES = 20
SEVERAL_FILES = frozenset({"xio", "phone"})  # loggers that write one file a sensor
SURE = 0.9  # a format that is surer than this need not be confirmed column by column


@dataclass(frozen=True)
class Source:
    """What a processing run needs of an open survey folder, read on the GUI thread that owns its database."""

    original_dir: Path
    files: "tuple[ImportedFile, ...]"
    options: ImportOptions
    survey: "Survey"
    settings: "Settings"
    cache: "Cache"


def source_of(folder: SurveyFolder) -> Source:
    """Gather it."""
    options = ImportOptions.from_json(folder.read_import_options(), folder.original_dir)
    return Source(
        folder.original_dir, folder.files(), options, folder.read_survey(), folder.read_settings(), folder.cache()
    )


def results_of(source: Source, progress: Progress, growing: "GrowingPass | None" = None) -> "Results":
    """Import and process; what the cache holds is not computed again. ``growing`` hears how far the sound is.

    Raises:
        LeaklineError: what the user can mend.
        Cancelled: by the operator; what was finished stays in the cache.
    """
    from processing.pipeline import process, read_recording

    recording = read_recording(
        source.original_dir,
        source.options,
        source.settings.importing,
        source.cache,
        progress.part(0.0, 0.3, "importing"),
        source.files,
    )
    settings = effective_settings(source.settings, source.survey)
    return process(source.survey, recording, settings, source.cache, progress.part(0.3, 1.0), growing)


def complete(folder: SurveyFolder | None, results: "Results") -> None:
    """Store the sums of a live recording that was not ended properly, now that its files have been read."""
    if folder is None or folder.read_only:
        return
    try:
        folder.complete_recording(results.recording.files)
    except LeaklineError as error:  # the results count all the same; the next opening tries it again
        log.warning("the sums were not stored: %s", error)


@dataclass(frozen=True)
class FirstLook:
    """What a look at the sound needs before anything is processed; ``growing`` hears how far the processing is."""

    path: Path
    options: ImportOptions
    survey: "Survey"
    growing: "GrowingPass"


def first_look(path: Path, options: ImportOptions, survey: "Survey") -> FirstLook:
    """Prepare a look at the sound of a recording."""
    from processing.sound.coarse import GrowingPass

    return FirstLook(path, options, survey, GrowingPass())


def coarse_sound(look: FirstLook) -> "CoarseTiles | None":
    """Open the sound and look at it here and there; None where there is none.

    Raises:
        LeaklineError: what the import will tell, too.
    """
    from processing.importing.folder import sound_of
    from processing.sound.coarse import open_coarse

    sound = sound_of(look.path, look.options, look.survey)
    return None if sound is None else open_coarse(sound, look.growing)


def preview_of(path: Path, options: ImportOptions, progress: Progress) -> "FolderPreview":
    """Look at a device's folder."""
    from processing.importing.preview import preview_folder

    progress.update(0.0, "importing")
    return preview_folder(path, options)


def is_ready(preview: "FolderPreview") -> bool:
    """Tell whether everything that was found can be read: at least the motion or the sound, and nothing is amiss."""
    chosen = [file for file in preview.files if file.role in ("imu", "audio")]
    return bool(chosen) and preview.error is None and all(file.error is None for file in chosen)


def told_everything(preview: "FolderPreview") -> bool:
    """Tell whether the folder needs no questions: it has a valid survey.toml, and its formats are known for sure."""
    has_form = any(file.role == "survey" for file in preview.files)
    return has_form and is_ready(preview) and not any(asks_for_columns(file) for file in preview.files)


def asks_for_columns(file: "FilePreview") -> bool:
    """Tell whether the operator should look at what the columns of a file are taken for."""
    sure = bool(file.matches) and file.matches[0].confidence >= SURE and file.matches[0].format.name != "table"
    return file.role == "imu" and file.mapping is not None and not sure


def used_files(preview: "FolderPreview") -> tuple[Path, ...]:
    """Return the files that belong to the recording: log, sound, form, and the log's siblings of the same format."""
    log = next((file for file in preview.files if file.role == "imu"), None)
    kind = log.matches[0].format.name if log is not None and log.matches else None

    def is_sibling(file: "FilePreview") -> bool:
        same = bool(file.matches) and file.matches[0].format.name == kind and kind in SEVERAL_FILES
        return file.role == "other" and log is not None and same and file.path.parent == log.path.parent

    return tuple(f.path for f in preview.files if f.role in ("imu", "audio", "survey") or is_sibling(f))


def settled(preview: "FolderPreview", options: ImportOptions) -> ImportOptions:
    """Return the options with what the preview took for granted: a guessed or remembered mapping is now a told one."""
    for file in preview.files:
        if asks_for_columns(file) and options.mapping is None:
            return replace(options, imu_file=file.path, mapping=file.mapping)
    return options


def remember(preview: "FolderPreview", options: ImportOptions) -> None:
    """Keep a told mapping for the next file of its kind; a disc that refuses costs some clicks, not the survey."""
    file = None if options.imu_file is None else preview.of(options.imu_file)
    if file is None or file.layout is None or options.mapping is None or options.mapping_store is None:
        return
    try:
        MappingStore(options.mapping_store).remember(file.layout, options.mapping)
    except LeaklineError as error:
        log.warning("the mapping was not remembered: %s", error)


def with_raw_form(options: ImportOptions, answer: RawAnswer) -> ImportOptions:
    """Return the options with the form of headerless sound."""
    form = RawForm(answer.sample_rate_hz, answer.bits, answer.channels, answer.encoding, answer.endian)
    return replace(options, raw_form=form)


def end_of(preview: "FolderPreview") -> float | None:
    """Return about when the log ends, seconds; None where that is not known before the import."""
    log = next((file for file in preview.files if file.role == "imu"), None)
    return None if log is None else log.duration_s


def target_folder(source: Path, fallback: Path) -> Path:
    """Return where the survey folder goes: beside the device's folder, else (a read-only stick) the fallback."""
    beside = source.parent
    if os.access(beside, os.W_OK):
        return beside
    fallback.mkdir(parents=True, exist_ok=True)
    return fallback


def earlier_project(source: Path, files: "tuple[Path, ...]", survey: "Survey", places: tuple[Path, ...]) -> Path | None:
    """Return the survey folder that was made of these very files before, None if there is none.

    Files are compared by name and size; their content was hashed when they were copied.
    """
    wanted = sorted((file.name, file.stat().st_size) for file in files)
    stem = folder_name(survey).removesuffix(SUFFIX)
    for place in places:
        for count in range(1, TRIED_NAMES):
            path = place / f"{stem}{'' if count == 1 else f'-{count}'}{SUFFIX}"
            if not path.is_dir():
                break
            if path != source and _holds(path, wanted):
                return path
    return None


def _holds(path: Path, wanted: list[tuple[str, int]]) -> bool:
    try:
        with SurveyFolder.open(path, read_only=True) as folder:
            return sorted((file.path.name, file.size) for file in folder.files()) == wanted
    except LeaklineError:
        return False


def with_operator(survey: "Survey", operator: str) -> "Survey":
    """Return the survey with this operator, where it names none."""
    return replace(survey, info=replace(survey.info, operator=survey.info.operator or operator))


def make_project(target: Path, survey: "Survey", files: "tuple[Path, ...]", operator: str, progress: Progress) -> Path:
    """Copy the device's files into a new survey folder and return it."""
    return create_folder(target, survey, files, progress, operator)
