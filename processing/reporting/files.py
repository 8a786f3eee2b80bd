"""Writing a file so that it is either whole or not there: aside first, then in place."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO


@contextmanager
def whole_file(path: Path) -> Iterator[TextIO]:
    """Open ``path`` for UTF-8 text with ``\\n`` line ends; it appears there only when all of it is on disk.

    Undecodable bytes of an old file name become ``\\udcff``, as JSON writes them too. Two jobs that write the same
    file do not meet: each has its own file aside, and the last one stays.
    """
    aside = aside_of(path)
    try:
        with aside.open("w", encoding="utf-8", errors="backslashreplace", newline="\n") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def aside_of(path: Path) -> Path:
    """Return where a file is written before it takes its place."""
    return path.with_name(f".{path.name[:200]}.{os.getpid()}-{threading.get_ident()}.part")


@contextmanager
def whole_path(path: Path) -> Iterator[Path]:
    """Yield where a library may write a file by its name; it appears at ``path`` only when all of it is on disk."""
    aside = aside_of(path)
    aside.unlink(missing_ok=True)
    try:
        yield aside
        with aside.open("rb+") as file:
            os.fsync(file.fileno())
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)
