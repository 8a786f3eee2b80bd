"""From a device folder (or a single file) to a :class:`~processing.survey.Recording`: the door of this package."""

import hashlib
from dataclasses import replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.check_sheets import check_sheets
from processing.importing.choosing import files_of, folder_of, imu_of, read_imu, read_survey, survey_of
from processing.importing.doctor import Examined, examine
from processing.importing.live_journal import Journal, journal_in, with_gaps, with_restarts
from processing.importing.options import ImportOptions
from processing.importing.preview import FilePreview, FolderPreview, preview_folder
from processing.importing.raw import ReadContext
from processing.importing.sound_files import compare_lengths, pick_audio, raw_form_of
from processing.progress import Progress, silent
from processing.settings import ImportSettings
from processing.sound.source import open_audio
from processing.storage.unfinished import ending_findings
from processing.survey import AudioSource, Finding, ImportedFile, Recording, Severity, Survey

__all__ = [
    "FilePreview",
    "FolderPreview",
    "ImportOptions",
    "import_folder",
    "preview_folder",
    "read_survey",
    "sound_of",
]


def import_folder(
    path: Path,
    options: ImportOptions | None = None,
    settings: ImportSettings | None = None,
    progress: Progress | None = None,
    known: tuple[ImportedFile, ...] = (),
) -> Recording:
    """Return all that the recording at ``path`` (a folder, or one file) holds, and what is wrong with it.

    Files in ``known`` that still have their size are not read once more for their hash: they had it when they were
    copied, and a night of sound takes its time.

    Raises:
        LeaklineError: NOT_A_SURVEY where there is neither IMU log nor sound; a code and a place for what the operator
            has to mend. Cancelled passes through.
    """
    options, settings = options or ImportOptions(), settings or ImportSettings()
    progress = progress or silent()
    progress.update(0.0, "import_looking")
    survey, survey_findings, survey_file = survey_of(path)
    folder, files = folder_of(path), files_of(path)
    findings = [*survey_findings, *ending_findings(folder)]
    imu_file, more = imu_of(path, files, options)
    findings += more
    sounds, more = (options.audio_files, ()) if options.audio_files else pick_audio(folder, files, survey.audio)
    findings += more
    if imu_file is None and not sounds:
        raise LeaklineError(ErrorCode.NOT_A_SURVEY, Place(path))
    audio, more = _open_sound(sounds, options, survey)
    findings += more
    journal, more = journal_in(folder)
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
    if examined is not None and audio is not None and journal is None:  # a live recording's are of one run
        findings += compare_lengths(examined.imu, audio, settings)
    if journal is not None:
        findings += journal.findings(audio.sample_rate_hz if audio is not None else None)
        examined, audio = _with_journal(examined, audio, journal)
    roles = [*((f, "imu") for f in used), *((f, "audio") for f in sounds if audio is not None)]
    roles += [(survey_file, "survey")] if survey_file is not None else []
    roles += [(journal.path, "journal")] if journal is not None else []
    imported = _hashed(roles, progress.part(0.75, 1.0), known)
    return replace(_recording(examined, audio, findings, imported), sheets=check_sheets(folder))


def _with_journal(
    examined: Examined | None, audio: AudioSource | None, journal: Journal
) -> tuple[Examined | None, AudioSource | None]:
    """Return both with what the journal of a live recording knows of their gaps."""
    if examined is not None:
        spans = with_restarts(examined.not_assessed, journal, float(examined.imu.time_s[-1]))
        examined = replace(examined, not_assessed=spans)
    return examined, with_gaps(audio, journal) if audio is not None else None


def _recording(
    examined: Examined | None, audio: AudioSource | None, findings: list[Finding], files: tuple[ImportedFile, ...]
) -> Recording:
    if examined is None:
        return Recording(None, audio, tuple(findings), (), files)
    return Recording(examined.imu, audio, tuple(findings), examined.not_assessed, files)


def sound_of(path: Path, options: ImportOptions, survey: Survey) -> AudioSource | None:
    """Return the sound of the recording at ``path`` alone, as the import will open it; None where there is none.

    Raises:
        LeaklineError: as :func:`import_folder`.
    """
    sounds = options.audio_files or pick_audio(folder_of(path), files_of(path), survey.audio)[0]
    return _open_sound(sounds, options, survey)[0]


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


def _hashed(
    files: list[tuple[Path, str]], progress: Progress, known: tuple[ImportedFile, ...]
) -> tuple[ImportedFile, ...]:
    hashes = {(file.path.absolute(), file.size): file.sha256 for file in known if file.sha256}
    total = max(sum(f.stat().st_size for f, _ in files), 1)
    done = 0
    out = []
    for file, role in files:
        size = file.stat().st_size
        if (told := hashes.get((file.absolute(), size))) is not None:
            done += size
            out.append(ImportedFile(file, role, size, told))
            progress.update(done / total, "import_hashing")
            continue
        digest, size = hashlib.sha256(), 0
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
