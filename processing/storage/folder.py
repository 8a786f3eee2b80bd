"""A survey on disc: one class owns all paths of a project folder, its database, its lock and its backups.

An open folder belongs to the thread that opened it. Long work in another thread gets paths and plain facts, or makes
a folder with :func:`processing.storage.creating.create_folder` and leaves the opening to its caller.
"""

import hashlib
import sqlite3
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Self

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress, silent
from processing.settings import Settings
from processing.storage import backup, documents, migration, schema
from processing.storage.cache import Cache
from processing.storage.creating import DATABASE_NAME, SUFFIX, create_folder
from processing.storage.database import Database, check_header, open_read_only, open_writable
from processing.storage.digs import DigStore
from processing.storage.files import hash_file, safe_name, writing
from processing.storage.lock import Lock, acquire
from processing.storage.opinions import OpinionStore
from processing.storage.photos import PhotoStore
from processing.storage.review import ReviewStore
from processing.storage.unfinished import RESERVE_NAME, files_without_sum, running_findings, with_sums
from processing.survey import Finding, ImportedFile, Params, Run, Severity, Survey


def is_survey_folder(path: Path) -> bool:
    """Return whether ``path`` looks like a survey folder, even one whose database is damaged or lost."""
    if not path.is_dir():
        return False
    return (path / DATABASE_NAME).is_file() or (path.suffix == SUFFIX and bool(backup.backups(path / "backups")))


class SurveyFolder:
    """An open survey folder; :meth:`open` or :meth:`create` make one, ``with`` or :meth:`close` end it.

    ``review`` holds runs, candidates and decisions, ``digs`` what digs showed, ``photos`` the pictures of the leaks,
    ``opinions`` what second reviewers say. ``findings`` say what opening noticed.
    """

    def __init__(self, path: Path, database: Database, lock: Lock | None, findings: tuple[Finding, ...]) -> None:
        self.path = path
        self.findings = findings
        self.review = ReviewStore(database)
        self.photos = PhotoStore(database, path)
        self.opinions = OpinionStore(database)
        self.digs = DigStore(database)
        self._db = database
        self._lock = lock
        self._own_cache: TemporaryDirectory[str] | None = None

    @classmethod
    def create(
        cls,
        target_dir: Path,
        survey: Survey,
        files: Sequence[Path | ImportedFile],
        progress: Progress | None = None,
        operator: str = "",
    ) -> Self:
        """Make a new folder under ``target_dir`` and open it; see :func:`create_folder` for what it raises."""
        return cls.open(create_folder(target_dir, survey, files, progress, operator))

    @classmethod
    def open(cls, path: Path, *, read_only: bool = False, take_over: bool = False) -> Self:
        """Open a folder, for writing unless ``read_only``, the medium, or a newer version forbid it (told in findings).

        ``take_over`` takes the lock from a holder on another computer, on the operator's word that it is not in use.

        Raises:
            LeaklineError: FILE_MISSING, NOT_A_SURVEY, SURVEY_LOCKED, SURVEY_NEWER (not even readable), SURVEY_DAMAGED.
        """
        if not path.exists():
            raise LeaklineError(ErrorCode.FILE_MISSING, Place(path))
        file = path / DATABASE_NAME
        if not file.exists() and is_survey_folder(path):
            raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(file), reason="survey.db is missing")
        check_header(file)
        findings: list[Finding] = []
        lock = None if read_only else _lock(path, findings, take_over=take_over)
        try:
            database = _open_database(file, lock, findings)
        except BaseException:
            if lock is not None:
                lock.release()
            raise
        if lock is not None and database.read_only:
            lock.release()
            lock = None
        findings += running_findings(path) if lock is None else ()
        return cls(path, database, lock, tuple(findings))

    @classmethod
    def restore(cls, path: Path, backup_file: Path | None = None, *, take_over: bool = False) -> Self:
        """Put a backup (the newest sound one by default) in the place of a damaged database, and open the folder.

        The damaged file is kept in ``backups/``. Raises SURVEY_LOCKED, SURVEY_DAMAGED (no sound backup), DISC_FULL.
        """
        lock = acquire(path, take_over=take_over)
        try:
            used = backup.restore(path / DATABASE_NAME, path / "backups", backup_file)
        finally:
            lock.release()
        opened = cls.open(path, take_over=take_over)
        told = Finding("survey_restored", Severity.REPAIRED, {"backup": used.name})
        opened.findings = (told, *opened.findings)
        return opened

    def close(self) -> None:
        """Close the database and give the lock back; calling it twice does no harm."""
        self._db.close()
        if self._own_cache is not None:
            self._own_cache.cleanup()
            self._own_cache = None
        if self._lock is not None:
            self._lock.release()
            self._lock = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # --- places

    @property
    def read_only(self) -> bool:
        """Whether nothing can be changed; every write then raises SURVEY_READ_ONLY."""
        return self._db.read_only

    @property
    def version(self) -> str:
        """The version of the database's form, such as ``1.0``."""
        return schema.version_text(self._db.version)

    @property
    def original_dir(self) -> Path:
        """The folder with the imported files, untouched: what :mod:`processing.importing` reads."""
        return self.recording_dir(1) / "original"

    @property
    def identity(self) -> str:
        """What tells this survey from all others, the same in all copies of its folder."""
        made = self._db.one("SELECT created_utc FROM recordings ORDER BY id LIMIT 1")
        told = self._db.one("SELECT at_utc, part, after FROM survey_log ORDER BY id LIMIT 1")
        return hashlib.sha256(repr((made, told)).encode()).hexdigest()[:24]

    @property
    def imported_utc(self) -> str:
        """When the first recording was imported, ISO 8601; empty without one."""
        made = self._db.one("SELECT created_utc FROM recordings ORDER BY id LIMIT 1")
        return str(made[0]) if made is not None else ""

    def recording_dir(self, recording: int) -> Path:
        """Return the folder of one recording."""
        return self.path / "recordings" / str(recording)

    @property
    def exports_dir(self) -> Path:
        """The folder for reports and exports."""
        return self.path / "exports"

    @property
    def backups_dir(self) -> Path:
        """The folder of the database's backups."""
        return self.path / "backups"

    def backups(self) -> tuple[Path, ...]:
        """Return the backups, newest first."""
        return backup.backups(self.backups_dir)

    def new_export(self, stem: str, suffix: str, run: Run) -> Path:
        """Return a free path in ``exports/`` with the run and its date in the name, the folder being there."""
        self.exports_dir.mkdir(exist_ok=True)
        name = f"{safe_name(stem)}-run{run.id}-{safe_name(run.created_utc[:10], 'undated')}"
        path, count = self.exports_dir / f"{name}{suffix}", 1
        while path.exists():
            count += 1
            path = self.exports_dir / f"{name}-{count}{suffix}"
        return path

    def cache(self) -> Cache:
        """Return the cache; of a read-only survey what is missing goes to a temporary folder, gone at closing."""
        if not self.read_only:
            return Cache(self.path / "cache")
        if self._own_cache is None:
            self._own_cache = TemporaryDirectory(prefix="leakline-cache-", ignore_cleanup_errors=True)
        return Cache(Path(self._own_cache.name), also=self.path / "cache")

    # --- what the operator told

    def read_survey(self) -> Survey:
        """Return the survey with its tie points."""
        return documents.read_survey(self._db)

    def write_survey(self, survey: Survey, operator: str = "") -> None:
        """Store the survey with its tie points; what changed is logged."""
        documents.write_survey(self._db, survey, operator)

    def set_patience(self, seconds: float) -> None:
        """Wait so long for another process that has the database open before SURVEY_LOCKED is raised."""
        self._db.set_patience(seconds)

    def read_settings(self) -> Settings:
        """Return the settings; stored ones that this version does not know are told in ``findings``."""
        settings, told = documents.read_settings(self._db)
        self.findings += tuple(finding for finding in told if finding not in self.findings)
        return settings

    def write_settings(self, settings: Settings) -> None:
        """Store what differs from the defaults."""
        documents.write_settings(self._db, settings)

    def read_import_options(self, recording: int = 1) -> dict[str, Any] | None:
        """Return the options of import as plain JSON values, None if none were stored."""
        return documents.read_import_options(self._db, recording)

    def write_import_options(self, options: Mapping[str, Any] | None, recording: int = 1) -> None:
        """Store the options of import, plain JSON values."""
        documents.write_import_options(self._db, recording, options)

    def read_state(self) -> dict[str, Any]:
        """Return what the window remembered: plain JSON values."""
        return documents.read_state(self._db)

    def write_state(self, state: Mapping[str, Any]) -> None:
        """Replace what the window remembers; raises SURVEY_READ_ONLY like every write."""
        documents.write_state(self._db, state)

    # --- originals

    def files(self, recording: int = 1) -> tuple[ImportedFile, ...]:
        """Return the original files of a recording with size and SHA-256 as they were when copied.

        Parts of a live recording that is running, or was killed, have an empty sum until :meth:`complete_recording`.
        """
        sql = "SELECT name, role, size, sha256 FROM recording_files WHERE recording_id = ? ORDER BY name"
        original = (self.recording_dir(recording) / "original").absolute()
        found = []
        for name, role, size, sha256 in self._db.rows(sql, (recording,)):
            path = Path(name)
            if path.is_absolute() or path.drive or ".." in path.parts:
                raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(self._db.path), reason=name)
            found.append(ImportedFile(original / path, role, size, sha256))
        found += files_without_sum(original, found)
        return tuple(sorted(found, key=lambda file: file.path.name))

    def complete_recording(self, hashed: Sequence[ImportedFile] = (), recording: int = 1) -> None:
        """Store the sums of a live recording's files that have none yet; those in ``hashed`` are not read for it.

        What is stored stays: calling it again, or for a recording that was imported, does nothing.

        Raises:
            LeaklineError: SURVEY_READ_ONLY, DISC_FULL, CANNOT_WRITE; FILE_UNREADABLE.
        """
        missing = [file for file in self.files(recording) if not file.sha256]
        if missing:
            self.add_files(with_sums(missing, hashed), recording)
            with writing(self.path):
                (self.recording_dir(recording) / RESERVE_NAME).unlink(missing_ok=True)

    def add_files(self, files: Sequence[ImportedFile], recording: int = 1) -> None:
        """Store finished files of a live recording, which lie in ``original``, with their sums.

        Raises:
            LeaklineError: SURVEY_READ_ONLY, DISC_FULL, CANNOT_WRITE.
        """
        original = self.recording_dir(recording).absolute() / "original"
        rows = [
            (recording, file.path.absolute().relative_to(original).as_posix(), file.role, file.size, file.sha256)
            for file in files
        ]
        with self._db.transaction() as db:
            sql = "INSERT INTO recording_files (recording_id, name, role, size, sha256) VALUES (?, ?, ?, ?, ?)"
            db.executemany(sql, rows)

    def verify_originals(self, progress: Progress | None = None, recording: int = 1) -> tuple[Finding, ...]:
        """Read all originals again and tell which are missing or no longer what they were."""
        progress = progress or silent()
        findings: list[Finding] = []
        files = self.files(recording)
        findings += [
            Finding("original_without_sum", Severity.INFO, {"file": file.path.name})
            for file in files
            if not file.sha256
        ]
        files = tuple(file for file in files if file.sha256)
        done, total = 0, max(sum(file.size for file in files), 1)

        def told(count: int) -> None:
            nonlocal done
            done += count
            progress.update(done / total, "checking_originals")

        for file in files:
            if not file.path.is_file():
                findings.append(Finding("original_missing", Severity.WARNING, {"file": file.path.name}))
            elif (now := hash_file(file.path, told)) != (file.size, file.sha256):
                params: Params = {"file": file.path.name, "size_before": file.size, "size_now": now[0]}
                findings.append(Finding("original_changed", Severity.WARNING, params))
        return tuple(findings)


def _lock(path: Path, findings: list[Finding], *, take_over: bool) -> Lock | None:
    """Return the lock; None, with a finding, where the medium lets nobody write."""
    try:
        lock = acquire(path, take_over=take_over)
    except LeaklineError as error:
        if error.code is ErrorCode.SURVEY_LOCKED:
            raise
        code = "survey_disc_full" if error.code is ErrorCode.DISC_FULL else "survey_medium_read_only"
        findings.append(Finding(code, Severity.WARNING))
        return None
    if lock.taken_from is not None:
        findings.append(Finding("survey_lock_taken_over", Severity.INFO, {"owner": lock.taken_from}))
    return lock


def _open_database(file: Path, lock: Lock | None, findings: list[Finding]) -> Database:
    database = open_read_only(file) if lock is None else open_writable(file)
    try:
        version = database.version
        if schema.major(version) > schema.major(schema.VERSION):
            return _open_newer(file, database, findings)
        if version < schema.VERSION:
            if database.read_only:
                return migration.migrated_copy(database)
            migration.migrate(database, file.parent / "backups")
            params = {"before": schema.version_text(version), "after": schema.version_text(schema.VERSION)}
            findings.append(Finding("survey_migrated", Severity.INFO, params))
        if not database.read_only:
            _back_up(database, file.parent / "backups", findings)
    except BaseException:
        database.close()
        raise
    return database


def _open_newer(file: Path, database: Database, findings: list[Finding]) -> Database:
    """Return the newer database opened read-only, if what it holds can be read at all."""
    version = schema.version_text(database.version)
    database.close()
    newer = open_read_only(file)
    try:
        documents.read_survey(newer)
        ReviewStore(newer).latest_run()
    except (LeaklineError, sqlite3.Error) as error:
        newer.close()
        raise LeaklineError(ErrorCode.SURVEY_NEWER, Place(file), version=version) from error
    findings.append(Finding("survey_newer", Severity.WARNING, {"version": version}))
    return newer


def _back_up(database: Database, folder: Path, findings: list[Finding]) -> None:
    try:
        backup.make_backup(database, folder)
    except LeaklineError:
        # the survey itself is sound: to refuse it for want of a copy would be worse than to say so
        findings.append(Finding("survey_backup_failed", Severity.WARNING))
