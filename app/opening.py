"""The long steps behind opening and processing, as plain functions for a job's thread; they know no window."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from processing.errors import LeaklineError
from processing.importing.folder import ImportOptions
from processing.progress import Progress
from processing.storage.creating import SUFFIX, create_folder, folder_name
from processing.storage.folder import SurveyFolder

if TYPE_CHECKING:
    from processing.importing.folder import FolderPreview
    from processing.results import Results
    from processing.settings import Settings
    from processing.storage.cache import Cache
    from processing.survey import ImportedFile, Survey

TRIED_NAMES = 20


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
    stored: dict[str, Any] | None = folder.read_import_options()
    options = ImportOptions() if stored is None else ImportOptions.from_json(stored)
    return Source(
        folder.original_dir, folder.files(), options, folder.read_survey(), folder.read_settings(), folder.cache()
    )


def results_of(source: Source, progress: Progress) -> "Results":
    """Import and process; what the cache holds is not computed again.

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
    return process(source.survey, recording, source.settings, source.cache, progress.part(0.3, 1.0))


def preview_of(path: Path, options: ImportOptions, progress: Progress) -> "FolderPreview":
    """Look at a device's folder."""
    from processing.importing.folder import preview_folder

    progress.update(0.0, "importing")
    return preview_folder(path, options)


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


def make_project(target: Path, survey: "Survey", files: "tuple[Path, ...]", operator: str, progress: Progress) -> Path:
    """Copy the device's files into a new survey folder and return it."""
    return create_folder(target, survey, files, progress, operator)
