"""A quick look at a device folder before it is imported: reads heads and tails only, so a gigabyte costs no more."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import registry
from processing.importing.choosing import (
    SURVEY_FILE,
    files_of,
    folder_of,
    imu_of,
    is_text,
    read_imu,
    read_survey,
)
from processing.importing.column_mapping import ColumnMapping, MappingStore
from processing.importing.doctor import examine
from processing.importing.guess import guess_mapping
from processing.importing.options import ImportOptions
from processing.importing.raw import ReadContext
from processing.importing.registry import Match
from processing.importing.sound_files import is_audio, pick_audio, raw_form_of
from processing.importing.text_layout import TextLayout
from processing.settings import ImportSettings
from processing.sound.source import open_audio
from processing.storage.journal import JOURNAL_NAME
from processing.survey import AudioSource, Finding, Survey

HEAD_BYTES = 1_000_000
SHOWN_ROWS = 20


@dataclass(frozen=True)
class FilePreview:
    """What one file seems to be: ``role`` is that of an imported file, ``other`` (not needed) or ``ignored``.

    ``mapping`` says what each column is taken for; ``rows`` are the first ones as written. ``row_count`` and
    ``duration_s`` are estimates from the head and the size of the file.
    """

    path: Path
    role: str
    size: int
    matches: tuple[Match, ...] = ()
    layout: TextLayout | None = None
    mapping: ColumnMapping | None = None
    row_count: float | None = None
    sample_rate_hz: float | None = None
    duration_s: float | None = None
    findings: tuple[Finding, ...] = ()
    audio: AudioSource | None = None
    error: LeaklineError | None = None
    beside: tuple[Path, ...] = ()  # other files whose columns are merged into this one

    @property
    def rows(self) -> tuple[tuple[str, ...], ...]:
        """The first rows as they are written."""
        return self.layout.sample[:SHOWN_ROWS] if self.layout is not None else ()


@dataclass(frozen=True)
class FolderPreview:
    """What a folder (or a file) would be imported as, under ``options``; ``error`` is what stops it."""

    path: Path
    survey: Survey
    files: tuple[FilePreview, ...]
    imu: Path | None
    audio: tuple[Path, ...]
    findings: tuple[Finding, ...] = ()  # of the folder, and of each file that would be used
    error: LeaklineError | None = None
    options: ImportOptions = field(default_factory=ImportOptions)

    @property
    def ready(self) -> bool:
        """True where nothing has to be asked or mended before the import."""
        return self.error is None

    @property
    def has_survey_file(self) -> bool:
        """True where a survey.toml is among the files."""
        return any(f.role == "survey" for f in self.files)

    @property
    def paths(self) -> tuple[Path, ...]:
        """The files that the import would use: all of the recording, nothing else."""
        used = [f.path for f in self.files if f.role in ("survey", "imu", "audio", "journal")]
        used += [p for f in self.files if f.role == "imu" for p in f.beside]
        return tuple(dict.fromkeys(used))

    @property
    def end_s(self) -> float:
        """About how long the recording lasts, in seconds; 0 where unknown."""
        return max((f.duration_s or 0.0 for f in self.files), default=0.0)

    def of(self, path: Path) -> FilePreview | None:
        """Return the preview of one file."""
        return next((f for f in self.files if f.path == path), None)


def preview_folder(path: Path, options: ImportOptions | None = None) -> FolderPreview:
    """Return what each file at ``path`` seems to be, without reading more than heads.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE for the folder itself; what is wrong with a file is in its preview.
    """
    options = options or ImportOptions()
    folder, files = folder_of(path), files_of(path)
    findings: list[Finding] = []
    survey, error = Survey(), None
    try:
        survey = read_survey(path)
    except LeaklineError as fault:
        error = fault
    imu, more = imu_of(path, files, options)
    findings += more
    sounds: tuple[Path, ...] = options.audio_files or ()
    if not sounds:
        try:
            sounds, more = pick_audio(folder, files, survey.audio)
            findings += more
        except LeaklineError as fault:
            error = error or fault
    previews = [_preview(file, imu, sounds, survey, options) for file in files]
    if imu is None and not sounds and error is None:
        error = LeaklineError(ErrorCode.NOT_A_SURVEY, Place(path))
    for preview in previews:
        if preview.role in ("imu", "audio"):
            findings += preview.findings
            error = error or preview.error
    return FolderPreview(path, survey, tuple(previews), imu, sounds, tuple(findings), error, options)


def _preview(
    file: Path, imu: Path | None, sounds: tuple[Path, ...], survey: Survey, options: ImportOptions
) -> FilePreview:
    size = file.stat().st_size
    if file.name == SURVEY_FILE:
        return FilePreview(file, "survey", size)
    if file.name == JOURNAL_NAME and (imu is not None or sounds):
        return FilePreview(file, "journal", size)
    if file in sounds:
        return _preview_sound(file, size, survey, options)
    if file == imu:
        return _preview_imu(file, size, options)
    if is_audio(file) or not is_text(file):
        return FilePreview(file, "ignored", size)
    try:
        return FilePreview(file, "other", size, registry.sniff(file), registry.layout_of(file))
    except LeaklineError as fault:
        return FilePreview(file, "ignored", size, error=fault)


def _preview_sound(file: Path, size: int, survey: Survey, options: ImportOptions) -> FilePreview:
    try:
        form = options.raw_form or raw_form_of(survey.audio)
        audio, findings = open_audio([file], form, survey.audio.channel)
    except LeaklineError as fault:
        return FilePreview(file, "audio", size, error=fault)
    return FilePreview(
        file,
        "audio",
        size,
        row_count=float(audio.frames),
        sample_rate_hz=audio.sample_rate_hz,
        duration_s=audio.duration_s,
        findings=findings,
        audio=audio,
    )


def _preview_imu(file: Path, size: int, options: ImportOptions) -> FilePreview:
    matches: tuple[Match, ...] = ()
    layout: TextLayout | None = None
    mapping: ColumnMapping | None = None
    try:
        matches, layout = registry.sniff(file), registry.layout_of(file)
        mapping = _mapping_of(matches, layout, options)
        context = ReadContext(options.scratch, HEAD_BYTES, options.sample_rate_hz)
        raw = read_imu(file, options, context)
        read, beside = len(raw), tuple(raw.files)
        examined = examine(raw, ImportSettings(), file)
    except LeaklineError as fault:
        return FilePreview(file, "imu", size, matches, layout, mapping, error=fault)
    share = min(HEAD_BYTES, size) / max(size, 1)
    time = examined.imu.time_s
    rate = 1.0 / float(np.median(np.diff(time)))
    return FilePreview(
        file,
        "imu",
        size,
        matches,
        layout,
        mapping,
        row_count=read / share,
        sample_rate_hz=rate,
        duration_s=examined.imu.duration_s / share,
        findings=examined.findings,
        beside=beside,
    )


def _mapping_of(matches: tuple[Match, ...], layout: TextLayout | None, options: ImportOptions) -> ColumnMapping | None:
    """What the columns are taken for: told, remembered, or what the chosen format says."""
    if options.mapping is not None or layout is None:
        return options.mapping
    if options.format is None and options.mapping_store is not None:
        known = MappingStore(options.mapping_store).recall(layout)
        if known is not None:
            return known
    chosen = next((m.format for m in matches if options.format in (None, m.format.name)), None)
    if chosen is not None and chosen.mapping_of is not None:
        return chosen.mapping_of(layout)
    return guess_mapping(layout)
