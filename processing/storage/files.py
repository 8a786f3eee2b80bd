"""Files that are on the disc when a function returns: safe names, durable writes, copies with their SHA-256."""

import contextlib
import errno
import hashlib
import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from processing.errors import ErrorCode, LeaklineError, Place

CHUNK = 1 << 20  # bytes; large enough for a stick, small enough that cancel answers at once
_LONGEST_NAME = 80  # characters; four bytes each at worst, file systems allow 255 bytes, and dates are added
_FULL = (errno.ENOSPC, errno.EDQUOT)
_FORBIDDEN = frozenset('<>:"/\\|?*')
_DEVICES = frozenset({"CON", "PRN", "AUX", "NUL"} | {f"{port}{n}" for port in ("COM", "LPT") for n in range(10)})


def safe_name(text: str, default: str = "Survey") -> str:
    """Return ``text`` as a file name that Windows, Linux and macOS accept; letters of any language stay.

    Never empty, never a path: separators, control characters and leading or trailing dots are gone.
    """
    kept = "".join("-" if c in _FORBIDDEN or c.isspace() or not c.isprintable() else c for c in text)
    # a lone surrogate (an undecodable byte of some old file name) has no UTF-8 form
    kept = kept.encode("utf-8", "ignore").decode("utf-8")
    while "--" in kept:
        kept = kept.replace("--", "-")
    kept = kept[:_LONGEST_NAME].strip("-. ")
    if kept.split(".")[0].upper() in _DEVICES:
        kept = f"_{kept}"
    return kept or default


@contextmanager
def disc_full_told(path: Path) -> Iterator[None]:
    """Turn the OSError of a full disc into DISC_FULL; others, such as those of reading, pass."""
    try:
        yield
    except OSError as error:
        if error.errno in _FULL:
            raise LeaklineError(ErrorCode.DISC_FULL, Place(path)) from error
        raise


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn any OSError met while writing at ``path`` into DISC_FULL or CANNOT_WRITE."""
    try:
        with disc_full_told(path):
            yield
    except OSError as error:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=error.strerror or str(error)) from error


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn an OSError met while reading ``path`` into FILE_MISSING or FILE_UNREADABLE."""
    try:
        yield
    except FileNotFoundError as error:
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path)) from error
    except OSError as error:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=error.strerror or str(error)) from error


def sync_folder(folder: Path) -> None:
    """Make the names in ``folder`` durable; Windows has no such call and needs none."""
    if os.name == "nt":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        # some network file systems refuse to sync a directory; then the file's own sync has to do
        with contextlib.suppress(OSError):
            os.fsync(handle)
    finally:
        os.close(handle)


def write_json(path: Path, value: Any) -> None:  # noqa: ANN401
    """Write ``value`` as JSON aside, sync it and put it in place: readers see the old file or the new one."""
    aside = path.with_name(f".{path.name}.{os.getpid()}.new")
    with writing(path):
        try:
            with aside.open("w", encoding="utf-8") as file:
                json.dump(value, file, ensure_ascii=False, indent=1)
                file.flush()
                os.fsync(file.fileno())
            aside.replace(path)
        except BaseException:
            aside.unlink(missing_ok=True)
            raise
        sync_folder(path.parent)


def copy_hashed(source: Path, target: Path, told: Callable[[int], None]) -> tuple[int, str]:
    """Copy ``source`` to the new file ``target``, synced; return its bytes and SHA-256.

    ``told`` is called with the bytes of each chunk and may raise to stop.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, DISC_FULL, CANNOT_WRITE.
    """
    digest, size = hashlib.sha256(), 0
    with reading(source):
        reader = source.open("rb")
    with reader:
        with writing(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            writer = target.open("xb")
        with _closing(writer, target):
            while chunk := _read(reader, source):
                digest.update(chunk)
                size += len(chunk)
                with writing(target):
                    writer.write(chunk)
                told(len(chunk))
            with writing(target):
                writer.flush()
                os.fsync(writer.fileno())
    # the date of a logger's file tells when the run was; a file system that cannot keep it is no reason to fail
    with contextlib.suppress(OSError):
        shutil.copystat(source, target)
    return size, digest.hexdigest()


@contextmanager
def _closing(writer: Any, target: Path) -> Iterator[None]:  # noqa: ANN401  # a binary file object
    try:
        yield
    except BaseException:
        # closing flushes again and fails again on a full disc; the first error is the one to tell
        with contextlib.suppress(OSError):
            writer.close()
        raise
    with writing(target):
        writer.close()


def _read(reader: Any, source: Path) -> bytes:  # noqa: ANN401
    with reading(source):
        chunk: bytes = reader.read(CHUNK)
    return chunk


def hash_file(path: Path, told: Callable[[int], None]) -> tuple[int, str]:
    """Return the bytes and the SHA-256 of ``path``, telling each chunk's bytes."""
    digest, size = hashlib.sha256(), 0
    with reading(path):
        reader = path.open("rb")
    with reader:
        while chunk := _read(reader, path):
            digest.update(chunk)
            size += len(chunk)
            told(len(chunk))
    return size, digest.hexdigest()
