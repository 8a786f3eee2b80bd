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


def running_findings(folder: Path) -> tuple[Finding, ...]:
    """Tell of a recording in the survey ``folder`` that somebody is writing at this moment."""
    if not (folder / LOCK_NAME).exists() or is_abandoned(folder):
        return ()
    originals = (journal.parent for journal in folder.glob(f"recordings/*/original/{JOURNAL_NAME}"))
    return (Finding("recording_running", Severity.INFO),) if any(map(ending_findings, originals)) else ()


def ending_findings(original: Path) -> tuple[Finding, ...]:
    """Tell of a live recording, whose files are in ``original``, that has no end: it runs, or was killed."""
    journal = original / JOURNAL_NAME
    try:
        if not journal.is_file() or is_ended(journal):
            return ()
    except LeaklineError:  # not to be read: nothing can be said of its end
        return ()
    return (Finding("recording_unfinished", Severity.WARNING),)
