"""From a device folder (or a single file) to a :class:`~processing.survey.Recording`."""

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import delimited, registry
from processing.importing.column_mapping import ColumnMapping, MappingStore
from processing.importing.doctor import Examined, examine
from processing.importing.raw import RawImu, ReadContext
from processing.importing.registry import Match
from processing.importing.sound_files import compare_lengths, is_audio, natural_key, pick_audio, raw_form_of
from processing.importing.survey_toml import read_survey_with_findings
from processing.importing.text_layout import find_layout
from processing.progress import Progress, silent
from processing.settings import ImportSettings
from processing.sound.pcm import RawForm
from processing.sound.source import open_audio
from processing.survey import (
    AudioSource,
    Finding,
    ImportedFile,
    Recording,
    Severity,
    Survey,
)

SURVEY_FILE = "survey.toml"
MAX_FILES = 2000
_TEXT_SUFFIXES = frozenset({".csv", ".txt", ".log", ".tsv", ".dat", ".asc", ".tab", ".prn", ""})
_OWN_FOLDERS = frozenset({"exports", "cache", "backups", "recordings"})


@dataclass(frozen=True)
class ImportOptions:
    """What the operator chose in the import page; all None is: find out.

    ``format`` is a name of :data:`processing.importing.registry.FORMATS`; ``mapping`` wins over it. ``mapping_store``
    is the file of remembered mappings. ``scratch`` is where arrays of long logs live; None is the temporary folder.
    """

    imu_file: Path | None = None
    format: str | None = None
    mapping: ColumnMapping | None = None
    sample_rate_hz: float | None = None
    audio_files: tuple[Path, ...] | None = None
    raw_form: RawForm | None = None
    mapping_store: Path | None = None
    scratch: Path | None = None


def read_survey(path: Path) -> Survey:
    """Return what survey.toml in the folder ``path`` (or beside the file ``path``) tells; the folder's name names it.

    Raises:
        LeaklineError: FILE_MISSING, and the errors of :func:`~processing.importing.survey_toml.read_survey_toml`.
    """
    return _survey_of(path)[0]


def _survey_of(path: Path) -> tuple[Survey, tuple[Finding, ...], Path | None]:
    folder = folder_of(path)
    survey, file = Survey(), None
    findings: tuple[Finding, ...] = ()
    if (folder / SURVEY_FILE).is_file():
        file = folder / SURVEY_FILE
        survey, findings = read_survey_with_findings(file)
    if not survey.info.name:
        name = folder.resolve().name if path.is_dir() or path.name == SURVEY_FILE else path.stem
        survey = replace(survey, info=replace(survey.info, name=name))
    return survey, findings, file


def folder_of(path: Path) -> Path:
    """Return the folder of a recording; raises FILE_MISSING."""
    if not path.exists():
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path))
    return path if path.is_dir() else path.parent


def files_of(path: Path) -> tuple[Path, ...]:
    """Return the files that may belong to the recording at ``path``: its folder and the folders in it, sorted.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE.
    """
    if path.is_file() and path.name not in ("imu.csv", SURVEY_FILE):
        return (path,)
    folder = folder_of(path)
    found: list[Path] = []
    try:
        for entry in sorted(folder.iterdir(), key=natural_key):
            if entry.name.startswith("."):
                continue
            if entry.is_file():
                found.append(entry)
            elif entry.is_dir() and entry.name not in _OWN_FOLDERS:
                inner = (f for f in entry.iterdir() if f.is_file() and not f.name.startswith("."))
                found += sorted(inner, key=natural_key)[: MAX_FILES // 10]
            if len(found) >= MAX_FILES:
                break
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(folder), reason=fault.strerror or str(fault)) from None
    return tuple(found)


def is_text(path: Path) -> bool:
    """True for a file whose name allows that it is a sensor log in text."""
    return path.suffix.casefold() in _TEXT_SUFFIXES


def matches_of(path: Path) -> tuple[Match, ...]:
    """Return the formats of a file, none where it cannot be read: another file may be the log."""
    try:
        return registry.sniff(path)
    except LeaklineError:
        return ()


def choose_imu(folder: Path, files: tuple[Path, ...]) -> tuple[Path | None, tuple[Finding, ...]]:
    """Return the file that is most likely the IMU log, and a finding where others may be one too."""
    ranked = []
    for file in files:
        if not is_text(file) or is_audio(file):
            continue
        matches = matches_of(file)
        if file.parent == folder and file.name.casefold() == "imu.csv":
            ranked.append((2.0, file))
        elif matches:
            ranked.append((matches[0].confidence, file))
    if not ranked:
        return None, ()
    # the surest; among equals the one nearest to the top, then the largest
    best = max(ranked, key=lambda r: (r[0], r[1].parent == folder, r[1].stat().st_size))
    others = [f.name for c, f in ranked if f != best[1] and c >= 0.5 * min(best[0], 1.0)]
    if not others:
        return best[1], ()
    params: dict[str, str | float] = {"chosen": best[1].name, "others": ", ".join(others)[:300]}
    return best[1], (Finding("several_imu_logs", Severity.WARNING, params),)


def read_imu(path: Path, options: ImportOptions, context: ReadContext) -> RawImu:
    """Return the raw rows of an IMU log: by the told mapping or format, a remembered mapping, or the likeliest format.

    Raises:
        LeaklineError: FORMAT_UNKNOWN, and the errors of the reader.
    """
    if options.mapping is not None:
        return delimited.read_delimited(path, options.mapping, context)
    if options.format is not None:
        return registry.format_named(options.format).read(path, context)
    matches = registry.sniff(path)
    if options.mapping_store is not None and (not matches or matches[0].confidence < 0.9):
        layout = registry.layout_of(path)
        known = MappingStore(options.mapping_store).recall(layout) if layout is not None else None
        if known is not None:
            return delimited.read_delimited(path, known, context, layout)
    if not matches:
        find_layout(path)  # raises the better message where there is no table at all
        raise LeaklineError(ErrorCode.FORMAT_UNKNOWN, Place(path))
    return matches[0].format.read(path, context)


def import_folder(
    path: Path,
    options: ImportOptions | None = None,
    settings: ImportSettings | None = None,
    progress: Progress | None = None,
) -> Recording:
    """Return all that the recording at ``path`` (a folder, or one file) holds, and what is wrong with it.

    Raises:
        LeaklineError: NOT_A_SURVEY where there is neither IMU log nor sound; a code and a place for what the operator
            has to mend. Cancelled passes through.
    """
    options, settings = options or ImportOptions(), settings or ImportSettings()
    progress = progress or silent()
    progress.update(0.0, "import_looking")
    survey, survey_findings, survey_file = _survey_of(path)
    folder, files = folder_of(path), files_of(path)
    findings = list(survey_findings)
    imu_file = options.imu_file
    if imu_file is None:
        imu_file, more = choose_imu(folder, files)
        findings += more
    sounds, more = (options.audio_files, ()) if options.audio_files else pick_audio(folder, files, survey.audio)
    findings += more
    if imu_file is None and not sounds:
        raise LeaklineError(ErrorCode.NOT_A_SURVEY, Place(path))
    audio, more = _open_sound(sounds, options, survey)
    findings += more
    examined, used = None, []
    if imu_file is None:
        findings.append(Finding("imu_missing", Severity.WARNING))
    else:
        context = ReadContext(options.scratch, None, options.sample_rate_hz, progress.part(0.02, 0.5))
        raw = read_imu(imu_file, options, context)
        used = [imu_file, *raw.files]
        examined = examine(raw, settings, imu_file, progress.part(0.5, 0.75))
        findings += examined.findings
    if examined is not None and audio is not None:
        findings += compare_lengths(examined.imu, audio, settings)
    roles = [*((f, "imu") for f in used), *((f, "audio") for f in sounds if audio is not None)]
    roles += [(survey_file, "survey")] if survey_file is not None else []
    imported = _hashed(roles, progress.part(0.75, 1.0))
    return _recording(examined, audio, findings, imported)


def _recording(
    examined: Examined | None, audio: AudioSource | None, findings: list[Finding], files: tuple[ImportedFile, ...]
) -> Recording:
    if examined is None:
        return Recording(None, audio, tuple(findings), (), files)
    return Recording(examined.imu, audio, tuple(findings), examined.not_assessed, files)


def _open_sound(
    sounds: tuple[Path, ...], options: ImportOptions, survey: Survey
) -> tuple[AudioSource | None, tuple[Finding, ...]]:
    """Sound that was found, not named, may be broken without stopping the path; what was named must be there."""
    if not sounds:
        return None, (Finding("sound_missing", Severity.WARNING),)
    form = options.raw_form or raw_form_of(survey.audio)
    try:
        return open_audio(sounds, form, survey.audio.channel)
    except LeaklineError as error:
        if options.audio_files or survey.audio.file or error.code is ErrorCode.AUDIO_NEEDS_FORM:
            raise
        name = error.place.path.name if error.place is not None else sounds[0].name
        return None, (Finding("sound_unusable", Severity.WARNING, {"file": name}),)


def _hashed(files: list[tuple[Path, str]], progress: Progress) -> tuple[ImportedFile, ...]:
    total = max(sum(f.stat().st_size for f, _ in files), 1)
    done = 0
    out = []
    for file, role in files:
        digest = hashlib.sha256()
        size = 0
        try:
            with file.open("rb") as stream:
                while block := stream.read(4 << 20):
                    digest.update(block)
                    size += len(block)
                    progress.update((done + size) / total, "import_hashing")
        except OSError as fault:
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(file), reason=fault.strerror or str(fault)) from None
        done += size
        out.append(ImportedFile(file, role, size, digest.hexdigest()))
    return tuple(out)
