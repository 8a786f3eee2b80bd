"""Turns what the import found into what the preview shows; plain functions."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

from app.opening import asks_for_columns
from processing.errors import ErrorCode, LeaklineError
from processing.importing.guess import guess_mapping
from processing.survey import ImportedFile
from widgets.import_preview import PreviewedFile
from widgets.vocabulary import clock_text, frequency_text

if TYPE_CHECKING:
    from processing.importing.preview import FilePreview, FolderPreview

_ROLES = {
    "imu": str(QT_TRANSLATE_NOOP("Preview", "motion")),
    "audio": str(QT_TRANSLATE_NOOP("Preview", "sound")),
    "survey": str(QT_TRANSLATE_NOOP("Preview", "form")),
    "journal": str(QT_TRANSLATE_NOOP("Preview", "journal")),
}
_NOT_USED = str(QT_TRANSLATE_NOOP("Preview", "not used"))


def role_text(role: str) -> str:
    """Return what a file is used for, in the window's language."""
    return QCoreApplication.translate("Preview", _ROLES.get(role, _NOT_USED))


def imported_files(files: Sequence[ImportedFile]) -> tuple[PreviewedFile, ...]:
    """Return the originals of an open survey."""
    return tuple(PreviewedFile(file.path.name, role_text(file.role), file.size) for file in files)


def previewed_files(preview: "FolderPreview") -> tuple[PreviewedFile, ...]:
    """Return the files of a device's folder; columns are asked for where no format is sure."""
    return tuple(_previewed(file, preview) for file in preview.files)


def errors_of(preview: "FolderPreview") -> tuple[LeaklineError, ...]:
    """Return what stops the folder or one of its chosen files."""
    found = [preview.error, *(file.error for file in preview.files if file.role in ("imu", "audio"))]
    unique = {str(error): error for error in found if error is not None}  # a log's error may be the folder's too
    return tuple(unique.values())


def _previewed(file: "FilePreview", preview: "FolderPreview") -> PreviewedFile:
    mapping = file.mapping if asks_for_columns(file) else None
    if file.role == "other" and preview.imu is None and file.layout is not None:
        mapping = guess_mapping(file.layout)  # perhaps this is the log: the operator may say so
    needs_form = file.error is not None and file.error.code is ErrorCode.AUDIO_NEEDS_FORM
    layout = file.layout
    return PreviewedFile(
        name=file.path.name,
        taken_for=_taken_for(file),
        size=file.size,
        columns=layout.columns if layout is not None else (),
        rows=file.rows,
        mapping=mapping,
        needs_raw_form=needs_form,
    )


def _taken_for(file: "FilePreview") -> str:
    parts = [role_text(file.role)]
    if file.role == "imu" and file.matches:
        parts.append(file.matches[0].format.title)
    if file.sample_rate_hz is not None:
        parts.append(frequency_text(file.sample_rate_hz))
    if file.duration_s is not None:
        parts.append(clock_text(file.duration_s))
    return ", ".join(parts)
