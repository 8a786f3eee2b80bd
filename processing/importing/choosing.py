"""Which files of a device folder are the recording, and which reader reads the IMU log among them."""

from dataclasses import replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import delimited, frame_log, registry, ximu3_stream
from processing.importing.column_mapping import MappingStore
from processing.importing.options import ImportOptions
from processing.importing.raw import RawImu, ReadContext
from processing.importing.registry import Match
from processing.importing.sound_files import is_audio, natural_key
from processing.importing.survey_toml import read_survey_with_findings
from processing.importing.text_layout import find_layout
from processing.survey import Finding, Severity, Survey

SURVEY_FILE = "survey.toml"
MAX_FILES = 2000
MIN_LOG_COLUMNS = 6
MIN_LOG_ROWS = 40
_TEXT_SUFFIXES = frozenset({".csv", ".txt", ".log", ".tsv", ".dat", ".asc", ".tab", ".prn", ""})
_BINARY_SUFFIXES = frozenset({frame_log.SUFFIX, ximu3_stream.SUFFIX})
_OWN_FOLDERS = frozenset({"exports", "cache", "backups", "recordings"})


def read_survey(path: Path) -> Survey:
    """Return what survey.toml in the folder ``path`` (or beside the file ``path``) tells; the folder's name names it.

    Raises:
        LeaklineError: FILE_MISSING, and the errors of :func:`~processing.importing.survey_toml.read_survey_toml`.
    """
    return survey_of(path)[0]


def survey_of(path: Path) -> tuple[Survey, tuple[Finding, ...], Path | None]:
    """Return the survey, what was odd about its file, and that file; raises as :func:`read_survey`."""
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


def imu_of(path: Path, files: tuple[Path, ...], options: ImportOptions) -> tuple[Path | None, tuple[Finding, ...]]:
    """Return the IMU log of the recording at ``path``: the told one, ``path`` where it is a file, or the likeliest.

    The findings say where others may be it, too.
    """
    if options.imu_file is not None:
        return options.imu_file, ()
    if path.is_file() and path.name != SURVEY_FILE and not is_audio(path):
        return path, ()
    return choose_imu(folder_of(path), files)


def choose_imu(folder: Path, files: tuple[Path, ...]) -> tuple[Path | None, tuple[Finding, ...]]:
    """Return imu.csv, else the file that is most likely the IMU log, and a finding where others may be one too.

    Where no format fits, that is the largest wide table: reading it then asks for its columns.
    """
    by_contract = next((f for f in files if f.parent == folder and f.name.casefold() == "imu.csv"), None)
    if by_contract is not None:
        return by_contract, ()
    logs = [f for f in files if (is_text(f) or f.suffix.casefold() in _BINARY_SUFFIXES) and not is_audio(f)]
    ranked = [(matches[0].confidence, f) for f in logs if (matches := matches_of(f))]
    if not ranked:
        return _unknown_log(files), ()
    # parts of one recording are one log: its first
    ranked = [(confidence, f) for confidence, f in ranked if frame_log.first_of(f, logs) == f]
    # the surest; among equals the one nearest to the top, then the largest
    best = max(ranked, key=lambda r: (r[0], r[1].parent == folder, r[1].stat().st_size))
    others = [f.name for c, f in ranked if f != best[1] and c >= 0.5 * best[0]]
    if not others:
        return best[1], ()
    params: dict[str, str | float] = {"chosen": best[1].name, "others": ", ".join(others)[:300]}
    return best[1], (Finding("several_imu_logs", Severity.WARNING, params),)


def _unknown_log(files: tuple[Path, ...]) -> Path | None:
    """The largest table that is wide and long enough to be a log of a kind nobody knows: its columns must be asked."""
    tables = []
    for file in files:
        if not is_text(file) or is_audio(file):
            continue
        try:
            layout = registry.layout_of(file)
        except LeaklineError:
            continue
        if layout is not None and layout.width >= MIN_LOG_COLUMNS and len(layout.sample) >= MIN_LOG_ROWS:
            tables.append(file)
    return max(tables, key=lambda f: f.stat().st_size, default=None)


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
