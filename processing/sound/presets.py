"""Presets by the pipe's material and diameter: an editable table, each value with its unit, range, basis and source.

A preset fills in settings that nobody changed by hand; what was set by hand stays. Which one is taken says
``survey.processing.preset``: ``auto`` (by material and diameter), ``none``, or a key of the table. Values that no step
uses (attenuation, modulus, widths, joints) are told beside them, for the operator's eye and for the correlator.
"""

import math
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from processing.errors import ErrorCode, LeaklineError, Place
from processing.settings import Settings
from processing.survey import Survey

AUTO, NONE = "auto", "none"
BASES = ("measured", "theory", "convention", "own")
_BULK_GPA, _DENSITY, _RESTRAINT = 2.2, 1000.0, 0.91
_MAX_BYTES = 1_000_000
_MOST_ROWS = 500


@dataclass(frozen=True)
class ValueKind:
    """What a value of the table may be; ``setting`` is the ``table.key`` that it fills in, empty for none."""

    unit: str
    low: float
    high: float
    setting: str = ""


KINDS: Mapping[str, ValueKind] = {
    "band_low_hz": ValueKind("Hz", 10.0, 90000.0, "sound.band_low_hz"),
    "band_high_hz": ValueKind("Hz", 20.0, 96000.0, "sound.band_high_hz"),
    "background_m": ValueKind("m", 3.0, 200.0, "detector.background_m"),
    "half_width_low_m": ValueKind("m", 0.05, 50.0),
    "half_width_high_m": ValueKind("m", 0.05, 50.0),
    "attenuation_low_db_per_m": ValueKind("dB/m", 0.0, 50.0),
    "attenuation_high_db_per_m": ValueKind("dB/m", 0.0, 50.0),
    "modulus_gpa": ValueKind("GPa", 0.01, 500.0),
    "diameter_per_wall": ValueKind("1", 3.0, 500.0),
    "size_low_hz": ValueKind("Hz", 20.0, 40000.0, "detector.size_low_hz"),
    "size_high_hz": ValueKind("Hz", 50.0, 90000.0, "detector.size_high_hz"),
    "small_below_db": ValueKind("dB", -30.0, 60.0, "size.small_below_db"),
    "large_above_db": ValueKind("dB", -30.0, 80.0, "size.large_above_db"),
    "joint_spacing_m": ValueKind("m", 0.5, 100.0),
}


@dataclass(frozen=True)
class PresetValue:
    """A value with its basis (one of :data:`BASES`) and where it is from."""

    value: float
    basis: str = "own"
    source: str = ""


@dataclass(frozen=True)
class Preset:
    """One row: for pipes whose material is one of ``materials`` and whose inner diameter lies in ``diameter_mm``."""

    key: str
    name: str
    name_tr: str = ""
    materials: tuple[str, ...] = ()
    diameter_mm: tuple[float, float] = (0.0, 20000.0)
    values: Mapping[str, PresetValue] | None = None
    own: bool = False  # added or changed by the user

    @property
    def told(self) -> Mapping[str, PresetValue]:
        """The values; none where the row has none."""
        return self.values or {}

    @property
    def sound_speed_mps(self) -> float | None:
        """The speed of sound in the water of the pipe, None where modulus or wall are not told."""
        modulus, wall = self.told.get("modulus_gpa"), self.told.get("diameter_per_wall")
        return sound_speed_mps(modulus.value, wall.value) if modulus is not None and wall is not None else None

    def title(self, language: str) -> str:
        """Return the name in the language."""
        return self.name_tr if language == "tr" and self.name_tr else self.name


def sound_speed_mps(modulus_gpa: float, diameter_per_wall: float) -> float:
    """Return the speed of sound in water in a pipe: √(K/ρ) / √(1 + c·(K/E)·(D/e)), K = 2.2 GPa, c = 0.91.

    Theory (D. J. Korteweg 1878; findings §6): makers' tables disagree; measure it at the pipe where it matters.
    """
    free = math.sqrt(_BULK_GPA * 1e9 / _DENSITY)
    return free / math.sqrt(1.0 + _RESTRAINT * _BULK_GPA / modulus_gpa * diameter_per_wall)


@cache  # it is asked for at each change of a survey, and never changes itself
def shipped() -> tuple[Preset, ...]:
    """Return the table that comes with the program."""
    text = (files("resources") / "presets" / "pipes.toml").read_text(encoding="utf-8")
    return _rows(tomllib.loads(text), Place(Path("pipes.toml")), own=False)


def table(user_file: Path | None = None) -> tuple[Preset, ...]:
    """Return the shipped table with the user's rows in the place of those of the same key, new ones after them.

    Raises:
        LeaklineError: FILE_UNREADABLE, FILE_TOO_LARGE, TOML_INVALID, KEY_MISSING, SETTING_INVALID: what is wrong with
            the user's file, and where.
    """
    rows = {row.key: row for row in shipped()}
    if user_file is not None and user_file.is_file():
        rows |= {row.key: row for row in _user_rows(user_file)}
    return tuple(rows.values())


def save_user_rows(user_file: Path, rows: Sequence[Preset]) -> None:
    """Write the rows that are the user's own, aside first, then in place of the old file; none removes it.

    Raises:
        LeaklineError: CANNOT_WRITE; SETTING_INVALID for a row that could not be read again.
    """
    import tomli_w

    own = [row for row in rows if row.own]
    document = {"preset": [_plain(row) for row in own]}
    _rows(document, Place(user_file), own=True)
    try:
        if not own:
            user_file.unlink(missing_ok=True)
            return
        user_file.parent.mkdir(parents=True, exist_ok=True)
        aside = user_file.with_name(user_file.name + ".new")
        with aside.open("wb") as file:
            tomli_w.dump(document, file)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(user_file)
    except OSError as fault:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(user_file), reason=fault.strerror or str(fault)) from None


def chosen(rows: Sequence[Preset], survey: Survey) -> Preset | None:
    """Return the preset of a survey: the one it names, or by material and diameter; None for none.

    Where the material is not known, or no row has it, ``auto`` takes none.

    Raises:
        LeaklineError: SETTING_INVALID for a key that the table does not have.
    """
    wanted = survey.processing.preset
    if wanted == NONE:
        return None
    if wanted != AUTO:
        found = next((row for row in rows if row.key == wanted), None)
        if found is None:
            allowed = ", ".join((AUTO, NONE, *(row.key for row in rows)))
            raise LeaklineError(ErrorCode.SETTING_INVALID, name="processing.preset", value=wanted, allowed=allowed)
        return found
    material = _bare(survey.pipe.material)
    if not material:
        return None
    diameter = survey.pipe.diameter_m
    fitting = [row for row in rows if _names(row, material)]
    if diameter is not None:
        fitting = [row for row in fitting if row.diameter_mm[0] <= 1000 * diameter <= row.diameter_mm[1]]

    def rank(row: Preset) -> tuple[bool, float]:
        """The user's own rows first; then what is meant for few diameters, or where none is told, for many."""
        breadth = row.diameter_mm[1] - row.diameter_mm[0]
        return not row.own, breadth if diameter is not None else -breadth

    return min(fitting, key=rank, default=None)


def filled_in(settings: Settings, preset: Preset | None) -> Settings:
    """Return ``settings`` with the preset's values wherever a setting still has its default."""
    if preset is None:
        return settings
    defaults = Settings()
    for name, told in preset.told.items():
        kind = KINDS[name]
        if not kind.setting:
            continue
        step_name, key = kind.setting.split(".")
        step: Any = getattr(settings, step_name)
        if getattr(step, key) == getattr(getattr(defaults, step_name), key):
            changes: dict[str, Any] = {step_name: replace(step, **{key: told.value})}
            settings = replace(settings, **changes)
    return settings


def effective(settings: Settings, survey: Survey, rows: Sequence[Preset]) -> Settings:
    """Return the settings that a survey is processed with; raises as :func:`chosen`."""
    return filled_in(settings, chosen(rows, survey))


def _names(row: Preset, material: str) -> bool:
    words = material.replace("-", " ").split()
    return any(_bare(name) == material or _bare(name) in words for name in row.materials)


def _bare(text: str) -> str:
    """Return a material's name as it is compared: small letters, dotted and dotless i alike."""
    return " ".join(text.replace("İ", "i").replace("I", "i").lower().replace("ı", "i").replace("\u0307", "").split())


def _user_rows(path: Path) -> tuple[Preset, ...]:
    try:
        size = path.stat().st_size
        if size > _MAX_BYTES:
            raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), size_mb=size / 1e6, limit_mb=_MAX_BYTES / 1e6)
        document = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None
    except (ValueError, RecursionError) as fault:
        raise LeaklineError(ErrorCode.TOML_INVALID, Place(path), reason=str(fault)[:200]) from None
    return _rows(document, Place(path), own=True)


def _rows(document: Mapping[str, Any], place: Place, *, own: bool) -> tuple[Preset, ...]:
    given = document.get("preset", [])
    if not isinstance(given, list) or len(given) > _MOST_ROWS:
        raise _invalid(place, "preset", given, "[[preset]]")
    return tuple(_row(raw, place, own=own) for raw in given)


def _row(raw: object, place: Place, *, own: bool) -> Preset:
    if not isinstance(raw, dict):
        raise _invalid(place, "preset", raw, "[[preset]]")
    key, name = raw.get("key"), raw.get("name")
    for field_name, text in (("key", key), ("name", name)):
        if text is None:
            raise LeaklineError(ErrorCode.KEY_MISSING, place, name=f"preset.{field_name}")
        if not isinstance(text, str) or not 0 < len(text.strip()) <= 100:
            raise _invalid(place, f"preset.{field_name}", text, "1 … 100 characters")
    if key in (AUTO, NONE):
        raise _invalid(place, "preset.key", key, f"not {AUTO}, {NONE}")
    materials = raw.get("materials", [])
    if not isinstance(materials, list) or not all(isinstance(m, str) and len(m) <= 100 for m in materials):
        raise _invalid(place, f"{key}.materials", materials, '["…", …]')
    span = raw.get("diameter_mm", [0.0, 20000.0])
    if not isinstance(span, list) or len(span) != 2 or not all(_is_number(x) for x in span) or span[0] > span[1]:
        raise _invalid(place, f"{key}.diameter_mm", span, "[from, to]")
    given = raw.get("values", {})
    if not isinstance(given, dict):
        raise _invalid(place, f"{key}.values", given, "values.… = { value = …, basis = …, source = … }")
    values = {n: _value(f"{key}.{n}", n, entry, place) for n, entry in given.items()}
    for low, high in (("band_low_hz", "band_high_hz"), ("size_low_hz", "size_high_hz"),
                      ("small_below_db", "large_above_db")):  # fmt: skip
        if low in values and high in values and values[low].value >= values[high].value:
            raise _invalid(place, f"{key}.{low}", values[low].value, f"< {values[high].value:g}")
    text_tr = raw.get("name_tr", "")
    return Preset(
        str(key), str(name), text_tr if isinstance(text_tr, str) else "", tuple(materials),
        (float(span[0]), float(span[1])), values, own,
    )  # fmt: skip


def _value(full_name: str, name: str, entry: object, place: Place) -> PresetValue:
    kind = KINDS.get(name)
    if kind is None:
        raise LeaklineError(ErrorCode.SETTING_UNKNOWN, place, name=full_name)
    raw: Mapping[str, Any] = entry if isinstance(entry, dict) else {"value": entry}
    value: Any = raw.get("value")
    basis, source = raw.get("basis", "own"), raw.get("source", "")
    if not _is_number(value) or not kind.low <= float(value) <= kind.high:
        raise _invalid(place, full_name, value, f"{kind.low:g} … {kind.high:g} {kind.unit}")
    if basis not in BASES:
        raise _invalid(place, f"{full_name}.basis", basis, ", ".join(BASES))
    return PresetValue(float(value), str(basis), str(source)[:1000])


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _invalid(place: Place, name: str, value: object, allowed: str) -> LeaklineError:
    return LeaklineError(ErrorCode.SETTING_INVALID, place, name=name, value=str(value)[:80], allowed=allowed)


def _plain(row: Preset) -> dict[str, Any]:
    values = {name: {f.name: getattr(told, f.name) for f in fields(told)} for name, told in row.told.items()}
    return {
        "key": row.key,
        "name": row.name,
        "name_tr": row.name_tr,
        "materials": list(row.materials),
        "diameter_mm": list(row.diameter_mm),
        "values": values,
    }
