"""Members of a zip file that a stranger packed: never written to disk, and measured before they are unpacked."""

import zipfile
import zlib
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.route_files.lines import MAX_BYTES, check_size, damaged

MAX_MEMBERS = 2_000
MAX_RATIO = 200  # text of coordinates packs some ten times; a bomb a thousand times


def members_of(path: Path) -> tuple[zipfile.ZipInfo, ...]:
    """Return what a zip file holds; raises LeaklineError as :func:`read_member`."""
    check_size(path)
    try:
        with zipfile.ZipFile(path) as archive:
            infos = archive.infolist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as fault:
        raise damaged(path, fault) from None
    if len(infos) > MAX_MEMBERS:
        raise damaged(path, f"zip: {len(infos)} files")
    return tuple(info for info in infos if not info.is_dir())


def read_member(path: Path, member: zipfile.ZipInfo, limit: int = MAX_BYTES) -> bytes:
    """Return a member, unpacked in memory.

    Raises:
        LeaklineError: FILE_TOO_LARGE for more than ``limit`` bytes, or where so little packs so much that it can only
            be a trap; ROUTE_DAMAGED for a broken or encrypted archive.
    """
    bomb = member.file_size > MAX_RATIO * max(member.compress_size, 1) + 1_000_000
    if member.file_size > limit or bomb:
        size, allowed = member.file_size / 1e6, limit / 1e6
        raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), size_mb=size, limit_mb=allowed)
    try:
        with zipfile.ZipFile(path) as archive, archive.open(member) as stream:
            data = stream.read(limit + 1)  # what the directory says of the size need not be true
    except (zipfile.BadZipFile, zlib.error, OSError, RuntimeError, EOFError, ValueError, NotImplementedError) as fault:
        raise damaged(path, fault) from None
    if len(data) > limit:
        raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), size_mb=len(data) / 1e6, limit_mb=limit / 1e6)
    return data
