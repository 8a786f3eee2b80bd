"""The photos of a survey under names that say which leak they show."""

import shutil
from collections.abc import Iterable
from pathlib import Path

from processing.review_facts import Photo

FOLDER = "photos"
KEPT_SUFFIXES = {".jpg", ".jpeg", ".png", ".webp", ".heic", ".gif", ".bmp", ".tif", ".tiff"}


def photo_names(photos: Iterable[tuple[Photo, str]]) -> dict[int, tuple[str, ...]]:
    """Return the relative paths of each leak's photos, as they are handed over."""
    named: dict[int, tuple[str, ...]] = {}
    for photo, _ in photos:
        before = named.get(photo.number, ())
        named[photo.number] = (*before, _name(photo, len(before) + 1))
    return named


def copy_photos(photos: tuple[tuple[Photo, str], ...], out_dir: Path) -> tuple[Path, ...]:
    """Copy the photos below ``out_dir``; return their new paths. One that is gone from the disc raises OSError."""
    if not photos:
        return ()
    (out_dir / FOLDER).mkdir(exist_ok=True)
    copied, seen = [], dict.fromkeys((photo.number for photo, _ in photos), 0)
    for photo, source in photos:
        seen[photo.number] += 1
        target = out_dir / _name(photo, seen[photo.number])
        shutil.copyfile(source, target)
        copied.append(target)
    return tuple(copied)


def _name(photo: Photo, nth: int) -> str:
    suffix = Path(photo.file).suffix.lower()
    return f"{FOLDER}/leak-{photo.number}-{nth}{suffix if suffix in KEPT_SUFFIXES else '.jpg'}"
