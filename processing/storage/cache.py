"""Derived results on disc, keyed by what made them; complete or absent, deletable at any time, never trusted blindly.

An entry is a folder ``<step>/<key>/`` with a manifest of its files' sizes (and checksums of the small ones). It is
built aside and renamed, so that a crash leaves no half of one. What does not look right is thrown away and made anew.
A step that can go on where it stopped finds in its folder what an earlier one left; whether to believe it is its own
affair. Unfinished folders lie in ``.unfinished/`` under their step and key and are the first to go.
"""

import json
import logging
import os
import re
import secrets
import shutil
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from processing.errors import LeaklineError
from processing.storage.files import disc_full_told, writing
from processing.storage.processes import process_start

T = TypeVar("T")
log = logging.getLogger(__name__)

CAP_BYTES = 16 << 30  # a 12 h survey needs some 2 GB: several settings side by side fit
_MANIFEST = "entry.json"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]{0,99}")
_CHECKED_BYTES = 4 << 20  # a larger file's checksum would cost more than it is worth at every opening
_BUILDING = ".building-"
_UNFINISHED = ".unfinished"


class Cache:
    """The cache in ``root``; ``also`` is a second place that is only read (of a survey on a read-only medium).

    At most ``cap_bytes`` are kept, the entries used longest ago go first; those used through this object stay.
    """

    def __init__(self, root: Path, cap_bytes: int = CAP_BYTES, also: Path | None = None) -> None:
        self.root = root
        self.cap_bytes = cap_bytes
        self._also = also
        self._used: set[Path] = set()

    def get(self, step: str, key: str) -> Path | None:
        """Return the folder of a sound entry, None if there is none; a spoilt one is discarded."""
        for place in (self.root, self._also):
            if place is None:
                continue
            entry = place / _safe(step) / _safe(key)
            if not entry.is_dir():
                continue
            if _is_sound(entry):
                self._touch(entry)
                return entry
            if place == self.root:
                self.discard(step, key)
        return None

    def put(self, step: str, key: str, build: Callable[[Path], None], *, resumable: bool = False) -> Path:
        """Make an entry: ``build`` writes files into a folder and closes them; return the entry's folder.

        The folder is empty; with ``resumable`` it may hold what a ``build`` of this entry left that did not end well,
        and is kept for the next one if this one does not.

        Raises:
            LeaklineError: DISC_FULL, CANNOT_WRITE; and whatever ``build`` raises. No entry is left half-made.
        """
        entry = self.root / _safe(step) / _safe(key)
        self._sweep()
        building = self.root / f"{_BUILDING}{os.getpid()}-{secrets.token_hex(4)}"
        if resumable:
            building = building.with_name(f"{building.name}-{_left_name(step, key)}")
        try:
            with writing(entry):
                self.root.mkdir(parents=True, exist_ok=True)
                if not (resumable and self._take_up(step, key, building)):
                    building.mkdir()
            with disc_full_told(entry):
                build(building)
            with writing(entry):
                _write_manifest(building)
                entry.parent.mkdir(exist_ok=True)
                self._put_in_place(building, entry)
        except BaseException:
            if resumable:
                self._lay_aside(building)
            else:
                shutil.rmtree(building, ignore_errors=True)
            raise
        self._used.add(entry)
        self._evict()
        return entry

    def entry(self, step: str, key: str, build: Callable[[Path], None], *, resumable: bool = False) -> Path:
        """Return the entry's folder, made by ``build`` if it is not there."""
        return self.get(step, key) or self.put(step, key, build, resumable=resumable)

    def discard(self, step: str, key: str) -> None:
        """Throw one entry away."""
        entry = self.root / _safe(step) / _safe(key)
        self._used.discard(entry)
        _remove(entry)

    def clear(self) -> None:
        """Throw everything away."""
        self._used.clear()
        shutil.rmtree(self.root, ignore_errors=True)

    def size_bytes(self) -> int:
        """Return the bytes of all entries."""
        return sum(_size(entry) for entry in self._entries())

    def _put_in_place(self, building: Path, entry: Path) -> None:
        try:
            building.rename(entry)
        except OSError:
            if not entry.is_dir():
                raise
            # somebody else made the same entry meanwhile, or a spoilt one could not be removed
            if _is_sound(entry):
                shutil.rmtree(building, ignore_errors=True)
            else:
                _remove(entry)
                building.rename(entry)

    def _take_up(self, step: str, key: str, building: Path) -> bool:
        """Make what was left of an entry the folder in which it is built; False where nothing was left.

        Renaming is the claim: of two processes only one gets it.
        """
        try:
            (self.root / _UNFINISHED / _left_name(step, key)).rename(building)
        except OSError:
            return False
        return True

    def _lay_aside(self, building: Path) -> None:
        """Keep a folder whose build did not end, unless another process kept one meanwhile, or it is empty."""
        _, _, name = building.name.removeprefix(_BUILDING).split("-", 2)
        left = self.root / _UNFINISHED / name
        try:
            building.rmdir()
        except OSError:  # it is not empty, as it should be
            try:
                left.parent.mkdir(exist_ok=True)
                building.rename(left)
            except OSError as error:
                log.debug("cannot keep %s: %s", building, error)
                shutil.rmtree(building, ignore_errors=True)

    def _touch(self, entry: Path) -> None:
        self._used.add(entry)
        try:
            os.utime(entry / _MANIFEST)
        except OSError as error:  # read-only: then nothing is evicted either
            log.debug("cannot touch %s: %s", entry, error)

    def _entries(self) -> list[Path]:
        if not self.root.is_dir():
            return []
        steps = [step for step in self.root.iterdir() if step.is_dir() and not step.name.startswith(_BUILDING)]
        return [entry for step in steps for entry in step.iterdir() if entry.is_dir()]

    def _evict(self) -> None:
        sizes = {entry: _size(entry) for entry in self._entries()}
        total = sum(sizes.values())
        for entry in sorted(sizes, key=_last_used):
            if total <= self.cap_bytes:
                return
            if entry not in self._used and _remove(entry):
                total -= sizes[entry]

    def _sweep(self) -> None:
        """Remove what a killed process left half-built, or keep it where it can be gone on with."""
        if not self.root.is_dir():
            return
        for left in self.root.glob(f"{_BUILDING}*"):
            pid = left.name.removeprefix(_BUILDING).partition("-")[0]
            if pid.isdecimal() and int(pid) != os.getpid() and process_start(int(pid)) is None:
                if left.name.removeprefix(_BUILDING).count("-") >= 2:
                    self._lay_aside(left)
                else:
                    shutil.rmtree(left, ignore_errors=True)


def cached(
    cache: Cache | None,
    step: str,
    key: str,
    compute: Callable[[], T],
    save: Callable[[Path, T], None],
    load: Callable[[Path], T],
) -> T:
    """Return the result of ``compute``, from the cache where it is there and can be read.

    A cache that cannot be written costs time later, never the result: it is logged and the result returned.
    """
    if cache is None:
        return compute()
    entry = cache.get(step, key)
    if entry is not None:
        try:
            return load(entry)
        except (OSError, ValueError, KeyError, TypeError, EOFError) as error:
            log.warning("cache entry %s/%s cannot be read and is made anew: %s", step, key, error)
            cache.discard(step, key)
    result = compute()
    try:
        cache.put(step, key, lambda folder: save(folder, result))
    except (LeaklineError, OSError) as error:
        log.warning("the result of %s is not cached: %s", step, error)
    return result


def _safe(name: str) -> str:
    if not _NAME.fullmatch(name):
        raise ValueError(f"{name!r} is no name for a cache entry")
    return name


def _left_name(step: str, key: str) -> str:
    return f"{step}@{key}"  # a name that no step can have


def _write_manifest(folder: Path) -> None:
    files: dict[str, dict[str, Any]] = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        files[path.relative_to(folder).as_posix()] = {"size": path.stat().st_size, "crc32": _checksum(path)}
    (folder / _MANIFEST).write_text(json.dumps({"files": files}), encoding="utf-8")


def _is_sound(entry: Path) -> bool:
    try:
        files = json.loads((entry / _MANIFEST).read_text(encoding="utf-8"))["files"]
        for name, told in files.items():
            path = entry / name
            if path.stat().st_size != told["size"] or _checksum(path) != told["crc32"]:
                return False
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False
    return True


def _checksum(path: Path) -> int | None:
    return zlib.crc32(path.read_bytes()) if path.stat().st_size <= _CHECKED_BYTES else None


def _size(entry: Path) -> int:
    return sum(path.stat().st_size for path in entry.rglob("*") if path.is_file())


def _last_used(entry: Path) -> float:
    manifest = entry / _MANIFEST
    return manifest.stat().st_mtime if manifest.exists() else 0.0  # an unfinished one is the first to go


def _remove(entry: Path) -> bool:
    """Delete an entry at once for all readers; False where Windows holds a mapped file in it."""
    if not entry.exists():
        return True
    aside = entry.parent.parent / f"{_BUILDING}{os.getpid()}-{secrets.token_hex(4)}"
    try:
        entry.rename(aside)
    except OSError as error:
        log.debug("cannot remove %s now: %s", entry, error)
        return False
    shutil.rmtree(aside, ignore_errors=True)
    return True
