"""What lies on the disc of a recording that is running or was never ended: its files are there, their sums are not."""

from collections.abc import Callable, Sequence
from pathlib import Path

from processing.errors import LeaklineError
from processing.storage.files import hash_file, reading
from processing.storage.journal import JOURNAL_NAME, is_ended
from processing.storage.lock import LOCK_NAME, is_abandoned
from processing.survey import Finding, ImportedFile, Severity

RESERVE_NAME = "room.reserve"  # in the recording's folder while it runs: see disc_space.Aside
_KINDS = (("audio-*.wav", "audio"), ("imu-*.lkf", "imu"), (JOURNAL_NAME, "journal"))


def files_without_sum(original: Path, known: Sequence[ImportedFile]) -> tuple[ImportedFile, ...]:
    """Return the files of a live recording that are not among the ``known`` ones, their sum being empty.

    Nothing is added to folders of other kinds: there the known ones are all that was imported. Raises FILE_UNREADABLE.
    """
    if not (original / JOURNAL_NAME).is_file():
        return ()
    names = {file.path.name for file in known}
    with reading(original):
        found = [(path, role) for pattern, role in _KINDS for path in original.glob(pattern) if path.name not in names]
        return tuple(ImportedFile(path, role, path.stat().st_size, "") for path, role in found if path.is_file())


def with_sums(
    files: Sequence[ImportedFile], hashed: Sequence[ImportedFile] = (), told: Callable[[int], None] | None = None
) -> tuple[ImportedFile, ...]:
    """Return ``files`` with all their sums: their own, those of ``hashed`` for the same path and size, or counted now.

    ``told`` hears the bytes that are read. Raises FILE_MISSING, FILE_UNREADABLE.
    """
    known = {(file.path.absolute(), file.size): file.sha256 for file in hashed if file.sha256}
    done = []
    for file in files:
        sha256, size = file.sha256 or known.get((file.path.absolute(), file.size), ""), file.size
        if not sha256:
            size, sha256 = hash_file(file.path, told or (lambda _: None))
        done.append(ImportedFile(file.path, file.role, size, sha256))
    return tuple(done)


def recording_findings(folder: Path, *, is_ours: bool) -> tuple[Finding, ...]:
    """Tell of a recording that is running, or was never stopped; ``is_ours``: we hold the folder's lock."""
    findings = []
    for journal in sorted(folder.glob(f"recordings/*/original/{JOURNAL_NAME}")):
        try:
            if is_ended(journal):
                continue
        except LeaklineError:  # gone meanwhile, or unreadable: the import tells it with its place
            continue
        is_running = not is_ours and (folder / LOCK_NAME).exists() and not is_abandoned(folder)
        code, severity = (
            ("recording_running", Severity.INFO) if is_running else ("recording_unfinished", Severity.WARNING)
        )
        findings.append(Finding(code, severity))
    return tuple(findings)
