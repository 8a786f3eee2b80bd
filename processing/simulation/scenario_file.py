"""Scenarios from and to TOML or JSON: keys are the fields of :mod:`.scenario`, absent ones keep their defaults."""

import dataclasses
import json
import math
import tomllib
import types
import typing
from enum import StrEnum
from pathlib import Path
from typing import Any

from processing.errors import ErrorCode, LeaklineError, Place
from processing.simulation.scenario import Scenario
from processing.simulation.scenario_check import check

_LARGEST_BYTES = 2_000_000


def read_scenario(path: Path) -> Scenario:
    """Return the scenario in a ``.toml`` or ``.json`` file; without a ``name`` the file's name is its name.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, FILE_TOO_LARGE, TOML_INVALID (which says what and where).
    """
    place = Place(path)
    try:
        if path.exists() and not path.is_file():  # a device or a pipe would be read for ever
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, place, reason="not a file")
        size = path.stat().st_size
        if size > _LARGEST_BYTES:
            raise LeaklineError(ErrorCode.FILE_TOO_LARGE, place, size_mb=size / 1e6, limit_mb=_LARGEST_BYTES / 1e6)
        text = path.read_text(encoding="utf-8-sig")
        data = json.loads(text) if path.suffix.lower() == ".json" else tomllib.loads(text)
        return from_mapping({"name": path.stem, **data} if isinstance(data, dict) else data)
    except FileNotFoundError:
        raise LeaklineError(ErrorCode.FILE_MISSING, place) from None
    except OSError as error:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, place, reason=error.strerror or str(error)) from error
    except (ValueError, TypeError, RecursionError) as error:  # decoding, syntax and our own checks
        raise LeaklineError(ErrorCode.TOML_INVALID, place, reason=str(error)) from error


def from_mapping(data: object) -> Scenario:
    """Return the scenario of nested plain values; raises TypeError or ValueError that names the key."""
    scenario = _built(Scenario, data, "")
    assert isinstance(scenario, Scenario)
    check(scenario)
    return scenario


def to_mapping(scenario: Scenario) -> dict[str, Any]:
    """Return nested plain values with everything that differs from the defaults: ready for TOML."""
    return _plain(scenario)


def _plain(thing: Any) -> dict[str, Any]:  # noqa: ANN401  # any of the scenario's dataclasses
    out: dict[str, Any] = {}
    for f in dataclasses.fields(thing):
        value = getattr(thing, f.name)
        default = f.default_factory() if f.default_factory is not dataclasses.MISSING else f.default
        if value is None or value == default:
            continue
        out[f.name] = _plain_value(value)
    return out


def _plain_value(value: Any) -> Any:  # noqa: ANN401
    if dataclasses.is_dataclass(value):
        return _plain(value)
    if isinstance(value, tuple):
        return [_plain_value(v) for v in value]
    return str(value) if isinstance(value, StrEnum) else value


def _built(kind: type, data: object, where: str) -> object:
    if not isinstance(data, dict):
        raise TypeError(f"[{where}] must be a table" if where else "a table of keys is expected")
    hints = typing.get_type_hints(kind)
    unknown = sorted(set(data) - set(hints))
    if unknown:
        raise ValueError(f"unknown key '{_join(where, unknown[0])}'")
    needed = [f.name for f in dataclasses.fields(kind) if _required(f) and f.name not in data]
    if needed:
        raise ValueError(f"key '{_join(where, needed[0])}' is missing")
    return kind(**{key: _value(hints[key], value, _join(where, key)) for key, value in data.items()})


def _required(f: "dataclasses.Field[Any]") -> bool:
    return f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING


def _join(where: str, key: str) -> str:
    return f"{where}.{key}" if where else key


def _value(hint: Any, value: object, where: str) -> object:  # noqa: ANN401  # a typing construct
    if isinstance(hint, types.UnionType):  # X | None
        (hint,) = (h for h in typing.get_args(hint) if h is not type(None))
    if dataclasses.is_dataclass(hint):
        return _built(typing.cast("type", hint), value, where)
    if typing.get_origin(hint) is tuple:
        return _tuple(typing.get_args(hint), value, where)
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        if value not in {str(v) for v in hint}:
            raise ValueError(f"'{where}' must be one of {', '.join(hint)}")
        return hint(str(value))
    return _scalar(hint, value, where)


def _tuple(kinds: tuple[Any, ...], value: object, where: str) -> tuple[object, ...]:
    if not isinstance(value, list):
        raise TypeError(f"'{where}' must be a list")
    if kinds[-1] is not Ellipsis and len(kinds) != len(value):
        raise ValueError(f"'{where}' must hold {len(kinds)} values")
    each = [kinds[0]] * len(value) if kinds[-1] is Ellipsis else kinds
    return tuple(_value(kind, v, f"{where}[{i}]") for i, (kind, v) in enumerate(zip(each, value)))


def _scalar(hint: type, value: object, where: str) -> object:
    if hint is float and isinstance(value, (int, float)) and not isinstance(value, bool):
        if not math.isfinite(value) or abs(value) > 1e12:
            raise ValueError(f"'{where}' is not a usable number")
        return float(value) + 0.0  # no negative zero: a spread may not be one
    if type(value) is not hint:
        raise TypeError(f"'{where}' must be a {'number' if hint is float else hint.__name__}")
    return value
