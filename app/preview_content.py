"""Turns what the import found into what the preview shows; plain functions."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication

from processing.survey import ImportedFile
from widgets.import_preview import PreviewedFile

if TYPE_CHECKING:
    from processing.importing.folder import FolderPreview

_ROLES = {
    "imu": str(QT_TRANSLATE_NOOP("Preview", "motion")),
    "audio": str(QT_TRANSLATE_NOOP("Preview", "sound")),
    "survey": str(QT_TRANSLATE_NOOP("Preview", "form")),
}
_NOT_USED = str(QT_TRANSLATE_NOOP("Preview", "not used"))


def role_text(role: str) -> str:
    """Return what a file is used for, in the window's language."""
    return QCoreApplication.translate("Preview", _ROLES.get(role, _NOT_USED))


def imported_files(files: Sequence[ImportedFile]) -> tuple[PreviewedFile, ...]:
    """Return the originals of an open survey."""
    return tuple(PreviewedFile(file.path.name, role_text(file.role), file.size) for file in files)


def previewed_files(preview: "FolderPreview") -> tuple[PreviewedFile, ...]:
    """Return the files of a device's folder."""
    raise NotImplementedError
