"""Facts as plain JSON and back: frozen dataclasses, tuples, enums and numbers, checked against their type hints.

Text from a file is never trusted: :func:`from_plain` builds only the declared types and raises ValueError otherwise.
Keys that the dataclass does not know (a newer minor version wrote them) are ignored, missing ones take the default.
Arrays are set aside by the caller's ``arrays`` mapping, as they do not belong into JSON.
"""

import dataclasses
import json
import types
import typing
from collections.abc import Mapping, MutableMapping
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")
Arrays = Mapping[str, np.ndarray[Any, Any]]

_ARRAY = "__array__"
_NO_ARRAYS: Arrays = types.MappingProxyType({})


def to_plain(thing: object, arrays: MutableMapping[str, np.ndarray[Any, Any]] | None = None, name: str = "a") -> Any:  # noqa: ANN401
    """Return ``thing`` as JSON values; numpy arrays in it are put into ``arrays`` under their dotted place.

    Raises TypeError for anything that cannot be read back (our bug, not the user's).
    """
    if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        pairs = ((f.name, getattr(thing, f.name)) for f in dataclasses.fields(thing))
        return {key: to_plain(value, arrays, f"{name}.{key}") for key, value in pairs}
    if isinstance(thing, np.ndarray):
        if arrays is None:
            raise TypeError(f"{name}: an array needs a file of its own")
        arrays[name] = thing
        return {_ARRAY: name}
    if isinstance(thing, Mapping):
        return {str(key): to_plain(value, arrays, f"{name}.{key}") for key, value in thing.items()}
    if isinstance(thing, tuple | list):
        return [to_plain(value, arrays, f"{name}.{i}") for i, value in enumerate(thing)]
    return _plain_scalar(thing, name)


def _plain_scalar(thing: object, name: str) -> str | float | bool | None:
    if isinstance(thing, Enum):
        return str(thing.value)
    if isinstance(thing, np.generic):
        thing = thing.item()
    if thing is None or isinstance(thing, str | bool | int | float):
        return thing
    if isinstance(thing, Path):
        return str(thing)
    raise TypeError(f"{name}: a {type(thing).__name__} cannot be stored")


def from_plain(kind: type[T], value: object, arrays: Arrays = _NO_ARRAYS) -> T:
    """Return ``value`` (from JSON) as a ``kind``; raises ValueError if it does not fit the type hints."""
    return typing.cast("T", _build(kind, value, arrays))


def to_json(thing: object) -> str:
    """Return ``thing`` as one line of JSON, keys in their order."""
    plain = to_plain(thing)
    text = json.dumps(plain, ensure_ascii=False, separators=(",", ":"))
    # the rest of an undecodable file name has no UTF-8 form; escaped it survives
    return text if storable(text) == text else json.dumps(plain, separators=(",", ":"))


def storable(text: str) -> str:
    """Return ``text`` with a question mark for what has no UTF-8 form."""
    return text.encode("utf-8", "replace").decode("utf-8")


def from_json(kind: type[T], text: str) -> T:
    """Return a ``kind`` from JSON; raises ValueError if the text is no JSON or does not fit."""
    try:
        return from_plain(kind, json.loads(text))
    except RecursionError:
        raise ValueError("nested too deeply") from None


@cache
def _hints(kind: type) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _build(hint: Any, value: object, arrays: Arrays) -> object:  # noqa: ANN401  # a type hint has no type
    if hint is type(value) and hint in (float, str):  # the most frequent by far
        return value
    origin = typing.get_origin(hint)
    if origin in (typing.Union, types.UnionType):
        return _build_union(typing.get_args(hint), value, arrays)
    if origin is not None:
        return _build_generic(hint, origin, value, arrays)
    if dataclasses.is_dataclass(hint):
        return _build_dataclass(typing.cast("type", hint), value, arrays)
    return _build_scalar(hint, value)


def _build_union(options: tuple[Any, ...], value: object, arrays: Arrays) -> object:
    if value is None and type(None) in options:
        return None
    # an int in a "str | float" stays an int: the sentence it fills may count with it
    if isinstance(value, int) and not isinstance(value, bool) and float in options:
        return value
    for option in options:
        if option is not type(None):
            try:
                return _build(option, value, arrays)
            except ValueError:
                continue
    raise ValueError(f"{_short(value)} fits none of {options}")


def _build_generic(hint: Any, origin: Any, value: object, arrays: Arrays) -> object:  # noqa: ANN401
    if origin is np.ndarray:
        return _build_array(hint, value, arrays)
    if origin is tuple and isinstance(value, list):
        kinds = typing.get_args(hint)
        if len(kinds) == 2 and kinds[1] is Ellipsis:
            return tuple(_build(kinds[0], item, arrays) for item in value)
        if len(kinds) != len(value):
            raise ValueError(f"{len(kinds)} values expected, not {len(value)}")
        return tuple(_build(kind, item, arrays) for kind, item in zip(kinds, value, strict=True))
    if isinstance(value, dict) and isinstance(origin, type) and issubclass(origin, Mapping):
        of_value = typing.get_args(hint)[1]
        return {str(key): _build(of_value, item, arrays) for key, item in value.items()}
    raise ValueError(f"{_short(value)} is not a {hint}")


def _build_array(hint: Any, value: object, arrays: Arrays) -> object:  # noqa: ANN401
    name = value.get(_ARRAY) if isinstance(value, dict) else None
    if not isinstance(name, str) or name not in arrays:
        raise ValueError("an array is missing")
    wanted = typing.get_args(typing.get_args(hint)[1])
    if wanted and wanted[0] is not Any and arrays[name].dtype != np.dtype(wanted[0]):
        raise ValueError(f"{name} holds {arrays[name].dtype}")
    return arrays[name]


def _build_dataclass(kind: type, value: object, arrays: Arrays) -> object:
    if not isinstance(value, dict):
        raise ValueError(f"{_short(value)} is not a {kind.__name__}")  # noqa: TRY004  # bad data, not a bad call
    hints = _hints(kind)
    known = {f.name for f in dataclasses.fields(kind) if f.init}
    given = {name: _build(hints[name], item, arrays) for name, item in value.items() if name in known}
    try:
        return kind(**given)
    except TypeError as error:
        raise ValueError(str(error)) from None


def _build_scalar(hint: Any, value: object) -> object:  # noqa: ANN401
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if hint is int and isinstance(value, int) and not isinstance(value, bool):
        return value
    if hint in (str, bool, type(None)) and type(value) is hint:
        return value
    if hint in (object, Any):
        return value
    if isinstance(value, str) and isinstance(hint, type) and issubclass(hint, Enum | Path):
        return hint(value)
    raise ValueError(f"{_short(value)} is not a {getattr(hint, '__name__', hint)}")


def _short(value: object) -> str:
    return repr(value)[:60]
