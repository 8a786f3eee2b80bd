"""survey.toml to :class:`~processing.survey.Survey` and back, and the ``table.key=value`` of the command line."""

import dataclasses
import datetime as dt
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import survey_keys as keys
from processing.settings import Settings, with_value
from processing.survey import (
    AudioInfo,
    CalibrationLeak,
    DeviceInfo,
    Finding,
    Launch,
    Motion,
    PipeInfo,
    ProcessingChoice,
    Route,
    Severity,
    Survey,
    SurveyInfo,
    TiePoint,
)

MAX_BYTES = 16_000_000
_PARTS: dict[str, tuple[str, type]] = {
    "survey": ("info", SurveyInfo),
    "pipe": ("pipe", PipeInfo),
    "device": ("device", DeviceInfo),
    "audio": ("audio", AudioInfo),
    "launch": ("launch", Launch),
    "processing": ("processing", ProcessingChoice),
}


def read_survey_toml(path: Path) -> Survey:
    """Return what the operator told in the survey.toml at ``path``.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, FILE_TOO_LARGE; TOML_INVALID with the line where the text is no
            TOML; SETTING_INVALID and KEY_MISSING with the line of a value that cannot be.
    """
    return read_survey_with_findings(path)[0]


def read_survey_with_findings(path: Path) -> tuple[Survey, tuple[Finding, ...]]:
    """Return the survey and a finding that lists the keys nobody knows; raises as :func:`read_survey_toml`."""
    text = _text(path)
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as fault:
        at = re.search(r"\(at line (\d+), column (\d+)\)", str(fault))
        place = Place(path, line=int(at[1]), column=int(at[2])) if at else Place(path)
        reason = re.sub(r"\s*\(at .*\)$", "", str(fault))[:200]
        raise LeaklineError(ErrorCode.TOML_INVALID, place, reason=reason) from None
    unknown = [
        name for name in document if name not in _PARTS and name not in ("tie_points", "route", "calibration_leak")
    ]
    parts: dict[str, Any] = {}
    for table, (attribute, kind) in _PARTS.items():
        parts[attribute] = kind(**_values(path, text, table, document.get(table, {}), keys.TABLES[table], unknown))
    parts["device"] = replace(parts["device"], motion=Motion(parts["device"].motion))
    survey = Survey(
        **parts,
        tie_points=_tie_points(path, text, document.get("tie_points", []), unknown),
    )
    if "route" in document:
        survey = replace(survey, route=_route(path, text, document["route"], unknown, survey))
    if "calibration_leak" in document:
        survey = replace(survey, calibration_leak=_known_leak(path, text, document["calibration_leak"], unknown))
    _check_pair(path, text, "launch", 0, survey.launch)
    if not unknown:
        return survey, ()
    return survey, (Finding("survey_keys_unknown", Severity.INFO, {"names": ", ".join(unknown)[:500]}),)


def _text(path: Path) -> str:
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), size_mb=size / 1e6, limit_mb=MAX_BYTES / 1e6)
        data = path.read_bytes()
    except FileNotFoundError:
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path)) from None
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        # what Notepad writes on a Turkish Windows; TOML wants UTF-8, the technician wants his name read
        return data.decode("cp1254", errors="replace")


def _values(
    path: Path, text: str, table: str, given: object, known: Mapping[str, keys.Kind], unknown: list[str], nth: int = 0
) -> dict[str, keys.Value]:
    if not isinstance(given, dict):
        allowed = f"[{table}]"
        place = keys.place_of(path, text, "", table)
        raise LeaklineError(ErrorCode.SETTING_INVALID, place, name=table, value=str(given)[:80], allowed=allowed)
    values: dict[str, keys.Value] = {}
    for key, raw in given.items():
        if key not in known:
            unknown.append(f"{table}.{key}")
            continue
        try:
            values[key] = keys.checked(known[key], f"{table}.{key}", raw)
        except LeaklineError as fault:  # only now: looking for the line of each of a thousand tie points takes a minute
            raise LeaklineError(fault.code, keys.place_of(path, text, table, key, nth), **fault.params) from None
    return values


def _tie_points(path: Path, text: str, given: object, unknown: list[str]) -> tuple[TiePoint, ...]:
    if not isinstance(given, list):
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, Place(path), name="tie_points", value=str(given)[:80], allowed="[[tie_points]]"
        )
    points = []
    for nth, raw in enumerate(given):
        values: dict[str, Any] = _values(path, text, "tie_points", raw, keys.TIE_POINT, unknown, nth)
        if "time_s" not in values:
            here = keys.place_of(path, text, "tie_points", "", nth)
            raise LeaklineError(ErrorCode.KEY_MISSING, here, name="tie_points.time_s")
        values.setdefault("name", f"{nth + 1}")
        point = TiePoint(**values)
        _check_pair(path, text, "tie_points", nth, point)
        if point.chainage_m is None and point.latitude is None and point.east_m is None:
            here = keys.place_of(path, text, "tie_points", "", nth)
            raise LeaklineError(ErrorCode.KEY_MISSING, here, name="tie_points.chainage_m")
        points.append(point)
    return tuple(points)


def _check_pair(path: Path, text: str, table: str, nth: int, place: TiePoint | Launch) -> None:
    """A latitude without its longitude, or an east without its north, is no place."""
    for one, other in (("latitude", "longitude"), ("east_m", "north_m")):
        if (getattr(place, one) is None) != (getattr(place, other) is None):
            missing = other if getattr(place, other) is None else one
            here = keys.place_of(path, text, table, "", nth)
            raise LeaklineError(ErrorCode.KEY_MISSING, here, name=f"{table}.{missing}")


def _known_leak(path: Path, text: str, given: object, unknown: list[str]) -> CalibrationLeak:
    table = "calibration_leak"
    values: dict[str, Any] = _values(path, text, table, given, keys.CALIBRATION_LEAK, unknown)
    for key in ("chainage_m", "flow_lpm"):
        if key not in values:
            raise LeaklineError(ErrorCode.KEY_MISSING, keys.place_of(path, text, table), name=f"{table}.{key}")
    return CalibrationLeak(**values)


def _route(path: Path, text: str, given: object, unknown: list[str], survey: Survey) -> Route:
    plain = {k: v for k, v in given.items() if k != "points"} if isinstance(given, dict) else given
    values: dict[str, Any] = _values(path, text, "route", plain, keys.ROUTE, unknown)
    points = given.get("points") if isinstance(given, dict) else None
    file = values.pop("file", None)
    if file and points is None:
        from processing.importing.route_files.told import told_route

        return told_route(path, keys.place_of(path, text, "route", "file"), file, values, survey)
    here = keys.place_of(path, text, "route", "points")
    if points is None:
        raise LeaklineError(ErrorCode.KEY_MISSING, keys.place_of(path, text, "route"), name="route.points")
    rows = points if isinstance(points, list) else []
    if len(rows) < 2 or not all(isinstance(p, list) and len(p) in (2, 3) for p in rows):
        allowed = "[[x, y, z], [x, y, z], …]"
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, here, name="route.points", value=str(points)[:80], allowed=allowed
        )
    numbers: list[Any] = [[keys.checked(keys.COORDINATE, "route.points", c, here) for c in p] for p in rows]
    return Route(points=tuple((p[0], p[1], p[2] if len(p) == 3 else 0.0) for p in numbers), **values)


def survey_as_tables(survey: Survey) -> dict[str, Any]:
    """Return the document of survey.toml: only what differs from the defaults, and nothing that is unknown."""
    document: dict[str, Any] = {}
    for table, (attribute, _) in _PARTS.items():
        values = _told(getattr(survey, attribute))
        if table == "survey" and values.get("date"):
            values["date"] = dt.date.fromisoformat(values["date"])
        if values:
            document[table] = values
    if survey.tie_points:
        document["tie_points"] = [_told(p) | {"time_s": p.time_s, "name": p.name} for p in survey.tie_points]
    if survey.calibration_leak is not None:
        document["calibration_leak"] = _told(survey.calibration_leak)
    if survey.route is not None:
        document["route"] = _told(survey.route) | {"points": [list(p) for p in survey.route.points]}
    return document


def _told(part: Any) -> dict[str, Any]:  # noqa: ANN401  # any of the survey's dataclasses
    values: dict[str, Any] = {}
    for spec in fields(part):
        value = getattr(part, spec.name)
        if value is None or value == spec.default:
            continue
        values[spec.name] = str(value) if isinstance(value, Motion) else value
    return values


def write_survey_toml(path: Path, survey: Survey) -> None:
    """Write ``survey`` so that :func:`read_survey_toml` gives it back, aside first, then in place of the old file.

    Raises:
        LeaklineError: CANNOT_WRITE.
    """
    import tomli_w

    aside = path.with_name(path.name + ".new")
    try:
        with aside.open("wb") as file:
            tomli_w.dump(survey_as_tables(survey), file)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
    except OSError as fault:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=fault.strerror or str(fault)) from None


def apply_override(survey: Survey, settings: Settings, override: str) -> tuple[Survey, Settings]:
    """Return both with ``table.key=value`` applied; a key of survey.toml wins over a setting of the same name.

    An empty value takes an optional key of survey.toml back to *unknown*.

    Raises:
        LeaklineError: SETTING_UNKNOWN for a name that does not exist, SETTING_INVALID for a value that cannot be.
    """
    name, equals, value = override.partition("=")
    table, dot, key = name.strip().partition(".")
    if not (equals and dot):
        raise LeaklineError(ErrorCode.SETTING_UNKNOWN, name=override[:80])
    value = value.strip()
    if key not in keys.TABLES.get(table, {}):
        return survey, with_value(settings, table, key, value)
    attribute, kind = _PARTS[table]
    default = next(f.default for f in fields(kind) if f.name == key)
    new: Any = default if value == "" else keys.checked(keys.TABLES[table][key], name.strip(), value)
    if key == "motion":
        new = Motion(new)
    part: Any = dataclasses.replace(getattr(survey, attribute), **{key: new})
    if table == "audio" and key in ("start_time_s", "drift_ppm"):  # the operator's word is no measurement
        part = dataclasses.replace(part, start_sigma_s=None, drift_sigma_ppm=None)
    changes: dict[str, Any] = {attribute: part}
    return replace(survey, **changes), settings
