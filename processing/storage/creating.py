"""Makes a new survey folder: built under a temporary name and renamed when complete, so it is there wholly or not."""

import os
import shutil
from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress, silent
from processing.storage import database as db_file
from processing.storage.documents import write_survey
from processing.storage.files import copy_hashed, reading, safe_name, sync_folder, writing
from processing.storage.journal import JOURNAL_NAME
from processing.storage.lock import acquire, is_abandoned
from processing.storage.plain import storable
from processing.survey import ImportedFile, Survey

SUFFIX = ".leakline"
DATABASE_NAME = "survey.db"
_PART = ".leakline-part"
_MARGIN = 8 << 20  # bytes: the database, the journal, the first cache entries
_AUDIO = frozenset({".wav", ".flac", ".w64", ".rf64", ".caf", ".ogg", ".oga", ".aif", ".aiff", ".au", ".mp3", ".raw"})


def folder_name(survey: Survey) -> str:
    """Return the name of the survey's folder: ``<Name>-<date>.leakline``."""
    date = safe_name(survey.info.date, "") if survey.info.date.strip() else ""
    return safe_name(survey.info.name) + (f"-{date}" if date else "") + SUFFIX


def create_folder(
    target_dir: Path,
    survey: Survey,
    files: Sequence[Path | ImportedFile],
    progress: Progress | None = None,
    operator: str = "",
) -> Path:
    """Copy ``files`` into a new survey folder under ``target_dir`` and return the folder; may run in any thread.

    A ``target_dir`` that ends in ``.leakline`` is itself the folder to make, whatever the survey's name is.
    Files keep their names, and their places relative to their common folder. The copy's SHA-256 is stored; an
    :class:`ImportedFile` must still have the one with which it was imported. A name that is taken gets ``-2``, ``-3``.
    When it fails or is cancelled nothing is left behind.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, DISC_FULL, CANNOT_WRITE.
        Cancelled: the operator stopped it.
    """
    progress = progress or silent()
    sources = [_Source(file) for file in files]
    needed = sum(source.size for source in sources)
    name = folder_name(survey)
    if target_dir.suffix == SUFFIX:
        target_dir, name = target_dir.parent, target_dir.name
    with writing(target_dir):
        target_dir.mkdir(parents=True, exist_ok=True)
        _sweep(target_dir)
        if shutil.disk_usage(target_dir).free < needed + _MARGIN:
            raise LeaklineError(ErrorCode.DISC_FULL, Place(target_dir))
        part = _new_folder(target_dir, name)
    try:
        lock = acquire(part)  # tells a later sweep whether the maker is still at work
        _fill(part, survey, sources, progress.part(0.0, 1.0, "copying_originals"), operator)
        lock.release()
        with writing(target_dir):
            return _put_in_place(part, target_dir, name)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise


class _Source:
    """A file to copy, with what import knew about it."""

    def __init__(self, file: Path | ImportedFile) -> None:
        self.path = file.path if isinstance(file, ImportedFile) else file
        self.role = file.role if isinstance(file, ImportedFile) else _role(file)
        self.sha256 = file.sha256 if isinstance(file, ImportedFile) else ""
        with reading(self.path):
            self.size = self.path.stat().st_size
        if not self.path.is_file():
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(self.path), reason="not a file")


def _role(path: Path) -> str:
    if path.suffix.lower() == ".toml":
        return "survey"
    if path.name == JOURNAL_NAME:
        return "journal"
    return "audio" if path.suffix.lower() in _AUDIO else "imu"


def _fill(part: Path, survey: Survey, sources: list[_Source], progress: Progress, operator: str) -> None:
    original = part / "recordings" / "1" / "original"
    with writing(part):
        for folder in (original, part / "cache", part / "exports", part / "backups"):
            folder.mkdir(parents=True)
    done, total = 0, max(sum(source.size for source in sources), 1)

    def told(count: int) -> None:
        nonlocal done
        done += count
        progress.update(done / total)

    rows = []
    for source, name in zip(sources, _names([source.path for source in sources]), strict=True):
        progress.update(done / total)
        size, sha256 = copy_hashed(source.path, original / name, told)
        if source.sha256 and source.sha256 != sha256:
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(source.path), reason="it has changed meanwhile")
        rows.append((name.as_posix(), source.role, size, sha256))
    db_file.create(part / DATABASE_NAME)
    opened = db_file.open_writable(part / DATABASE_NAME)
    try:
        with opened.transaction() as db:
            now = datetime.now(UTC).isoformat(timespec="milliseconds")
            db.execute("INSERT INTO recordings (id, created_utc) VALUES (1, ?)", (now,))
            sql = "INSERT INTO recording_files (recording_id, name, role, size, sha256) VALUES (1, ?, ?, ?, ?)"
            db.executemany(sql, rows)
        write_survey(opened, survey, operator)
    finally:
        opened.close()
    with writing(part):
        for folder in (original, *(f for f in original.rglob("*") if f.is_dir()), original.parent, part):
            sync_folder(folder)


def _names(paths: list[Path]) -> list[Path]:
    """Return each file's place relative to the folder they share; where none is shared, names made unique."""
    absolute = [path.absolute() for path in paths]
    if len({path.parent for path in absolute}) > 1:
        with suppress(ValueError):  # on Windows: on different drives
            common = os.path.commonpath([path.parent for path in absolute])
            if Path(common) != Path(common).parent:  # the root of a disc is no folder of a recording
                return [Path(*map(_storable_name, path.relative_to(common).parts)) for path in absolute]
    names: list[Path] = []
    for path in absolute:
        name, count = _storable_name(path.name), 1
        while name.casefold() in {taken.name.casefold() for taken in names}:
            count += 1
            name = f"{path.stem}-{count}{path.suffix}"
        names.append(Path(name))
    return names


def _storable_name(name: str) -> str:
    """Return ``name`` as it is, unless its bytes are no text: then without those."""
    return name if storable(name) == name else safe_name(name, "file")


def _new_folder(target_dir: Path, name: str) -> Path:
    stem = name.removesuffix(SUFFIX)
    for count in range(1, 1000):
        part = target_dir / f".{stem}-{os.getpid()}-{count}{_PART}"
        with suppress(FileExistsError):
            part.mkdir()
            return part
    raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(target_dir), reason=name)


def _put_in_place(part: Path, target_dir: Path, name: str) -> Path:
    stem = name.removesuffix(SUFFIX)
    for count in range(1, 10000):
        target = target_dir / (name if count == 1 else f"{stem}-{count}{SUFFIX}")
        if target.exists():
            continue
        try:
            part.rename(target)
        except OSError:
            if target.exists():  # another process was faster: take the next name
                continue
            raise
        sync_folder(target_dir)
        return target
    raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(target_dir), reason=name)


def _sweep(target_dir: Path) -> None:
    """Delete what a killed maker left: only unfinished folders of ours whose maker is dead."""
    for part in target_dir.glob(f".*{_PART}"):
        if part.is_dir() and is_abandoned(part):
            shutil.rmtree(part, ignore_errors=True)
