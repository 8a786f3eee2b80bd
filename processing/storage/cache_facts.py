"""Saves any dataclass of facts, arrays and all, into a cache entry and loads it again, arrays memory-mapped.

Arrays go into ``.npy`` files of their own (never pickled), the rest into ``facts.json``.
"""

import json
import tokenize
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np

from processing.storage.plain import from_plain, to_plain

T = TypeVar("T")
Array = np.ndarray[Any, Any]
_FACTS = "facts.json"
_INDEX = "arrays.json"
# what numpy raises, beside ValueError, about a header that is no header
_HEADER_ERRORS = (tokenize.TokenError, SyntaxError, TypeError, OverflowError, LookupError, RecursionError, EOFError)


def save_arrays(folder: Path, arrays: Mapping[str, Array]) -> None:
    """Write named arrays into ``folder``."""
    names = {name: f"array{i}.npy" for i, name in enumerate(arrays)}
    for name, array in arrays.items():
        with (folder / names[name]).open("wb") as file:
            # through write(), as numpy's own way to a file loses the reason when the disc is full
            np.lib.format.write_array(_Writer(file), np.asarray(array), allow_pickle=False)
    (folder / _INDEX).write_text(json.dumps(names), encoding="utf-8")


def load_arrays(folder: Path, *, mmap: bool = True) -> dict[str, Array]:
    """Return the arrays that :func:`save_arrays` wrote, read-only and memory-mapped unless ``mmap`` is False.

    Raises ValueError or OSError where a file is not what its header says.
    """
    names = json.loads((folder / _INDEX).read_text(encoding="utf-8"))
    arrays: dict[str, Array] = {}
    for name, file in names.items():
        if Path(file).name != file:
            raise ValueError(f"{file!r} is no file name")
        arrays[name] = _load(folder / file, mmap=mmap)
    return arrays


def _load(path: Path, *, mmap: bool) -> Array:
    try:
        return _mapped(path, mmap=mmap)
    except _HEADER_ERRORS as error:
        raise ValueError(f"{path.name}: {error}") from error


def _mapped(path: Path, *, mmap: bool) -> Array:
    # mapping checks the shape that the header tells against the file's size: a spoilt one allocates nothing
    if path.stat().st_size == _header_size(path):
        empty: Array = np.load(path, allow_pickle=False)  # nothing cannot be mapped
        return empty
    mapped: Array = np.lib.format.open_memmap(path, mode="r")
    return mapped if mmap else np.array(mapped)


def _header_size(path: Path) -> int:
    with path.open("rb") as file:
        if np.lib.format.read_magic(file) == (1, 0):
            np.lib.format.read_array_header_1_0(file)
        else:
            np.lib.format.read_array_header_2_0(file)
        return file.tell()


class _Writer:
    """A file that numpy does not know to be one."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    def write(self, data: bytes) -> int:
        return self._file.write(data)


def save_facts(folder: Path, facts: object) -> None:
    """Write a dataclass (or a tuple of them), arrays at any depth included."""
    arrays: dict[str, Array] = {}
    plain = to_plain(facts, arrays)
    save_arrays(folder, arrays)
    (folder / _FACTS).write_text(json.dumps(plain, ensure_ascii=False), encoding="utf-8")


def load_facts(folder: Path, kind: type[T], *, mmap: bool = True) -> T:
    """Return what :func:`save_facts` wrote; raises ValueError or OSError where it does not fit ``kind``."""
    plain = json.loads((folder / _FACTS).read_text(encoding="utf-8"))
    return from_plain(kind, plain, load_arrays(folder, mmap=mmap))


def loader(kind: type[T]) -> Callable[[Path], T]:
    """Return :func:`load_facts` for ``kind``, as :func:`processing.storage.cache.cached` wants it."""
    return lambda folder: load_facts(folder, kind)
