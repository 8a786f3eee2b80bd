"""Looks at a logo before it is taken, and keeps a copy beside the preferences: the original may be moved away."""

import shutil
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QImageReader

MOST_BYTES = 5_000_000
MOST_PIXELS = 6000  # a side
SHARP_PIXELS = 350  # 45 mm at 200 dots an inch
KINDS = {"png": ".png", "jpeg": ".jpg", "svg": ".svg"}


class LogoFault(StrEnum):
    """Why a picture is not taken, or is taken with a word."""

    NONE = "none"
    MISSING = "missing"
    NO_PICTURE = "no_picture"  # not PNG, JPEG or SVG
    TOO_LARGE = "too_large"
    COARSE = "coarse"  # taken, but it will look coarse in print


@dataclass(frozen=True)
class Logo:
    """What was found; ``size`` in pixels, of an SVG its own units."""

    fault: LogoFault
    kind: str = ""
    size: tuple[int, int] = (0, 0)

    @property
    def usable(self) -> bool:
        """Whether the report can carry it."""
        return self.fault in (LogoFault.NONE, LogoFault.COARSE)


def look_at(path: Path) -> Logo:
    """Return what a picture is, by its content; sizes are read before anything is decoded."""
    try:
        size_bytes = path.stat().st_size
    except OSError:
        return Logo(LogoFault.MISSING)
    if size_bytes > MOST_BYTES:
        return Logo(LogoFault.TOO_LARGE)
    reader = QImageReader(str(path))
    reader.setDecideFormatFromContent(True)
    kind, size = bytes(reader.format().data()).decode("ascii", "replace"), reader.size()
    kind = "jpeg" if kind == "jpg" else kind
    if kind not in KINDS or not size.isValid() or size.isEmpty():
        return Logo(LogoFault.NO_PICTURE)
    found = (size.width(), size.height())
    if kind != "svg" and max(found) > MOST_PIXELS:
        return Logo(LogoFault.TOO_LARGE, kind, found)
    reader.setScaledSize(size.scaled(QSize(64, 64), Qt.AspectRatioMode.KeepAspectRatio))
    if reader.read().isNull():
        return Logo(LogoFault.NO_PICTURE)
    coarse = kind != "svg" and size.width() < SHARP_PIXELS
    return Logo(LogoFault.COARSE if coarse else LogoFault.NONE, kind, found)


def keep(path: Path, folder: Path, kind: str) -> Path:
    """Copy a looked-at logo into ``folder`` and return the copy; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / f"company-logo{KINDS[kind]}"
    if path.resolve() != kept.resolve():
        shutil.copyfile(path, kept)
    return kept
