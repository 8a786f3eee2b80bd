"""What the operator told, as stored: the survey (each change logged), settings, import options, window state."""

import json
from collections.abc import Mapping
from dataclasses import fields
from datetime import UTC, datetime
from sqlite3 import Connection
from typing import Any

from processing.errors import ErrorCode, LeaklineError, Place
from processing.settings import Settings, with_value
from processing.storage.database import Database
from processing.storage.plain import from_json, from_plain, storable, to_json, to_plain
from processing.survey import Finding, Severity, Survey, TiePoint

_TIE_POINTS = "tie_points"
Json = dict[str, Any]


def read_survey(database: Database) -> Survey:
    """Return the stored survey; parts that are missing have their defaults."""
    try:
        parts = {part: json.loads(value) for part, value in database.rows("SELECT part, value FROM survey")}
        rows = database.rows("SELECT value FROM tie_points ORDER BY position")
        parts[_TIE_POINTS] = [json.loads(row[0]) for row in rows]
        return from_plain(Survey, parts)
    except ValueError as error:
        raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(database.path), reason=str(error)) from error


def write_survey(database: Database, survey: Survey, operator: str) -> None:
    """Store the survey in one transaction; each part that changed leaves its before and after in ``survey_log``."""
    with database.transaction() as db:
        stored = dict(db.execute("SELECT part, value FROM survey"))
        for field in fields(survey):
            part = getattr(survey, field.name)
            if field.name == _TIE_POINTS:
                _write_tie_points(db, survey.tie_points, operator)
            elif stored.get(field.name) != (text := to_json(part)):
                db.execute("INSERT OR REPLACE INTO survey (part, value) VALUES (?, ?)", (field.name, text))
                _log(db, operator, field.name, stored.get(field.name), text)


def _write_tie_points(db: Connection, points: tuple[TiePoint, ...], operator: str) -> None:
    before = [row[0] for row in db.execute("SELECT value FROM tie_points ORDER BY position")]
    after = [to_json(point) for point in points]
    if before == after:
        return
    db.execute("DELETE FROM tie_points")
    rows = [
        (i, storable(point.name), point.time_s, text) for i, (point, text) in enumerate(zip(points, after, strict=True))
    ]
    db.executemany("INSERT INTO tie_points (position, name, time_s, value) VALUES (?, ?, ?, ?)", rows)
    _log(db, operator, _TIE_POINTS, f"[{','.join(before)}]", f"[{','.join(after)}]")


def _log(db: Connection, operator: str, part: str, before: str | None, after: str) -> None:
    now = datetime.now(UTC).isoformat(timespec="milliseconds")
    sql = "INSERT INTO survey_log (at_utc, operator, part, before, after) VALUES (?, ?, ?, ?, ?)"
    db.execute(sql, (now, storable(operator), part, before, after))


def read_settings(database: Database) -> tuple[Settings, tuple[Finding, ...]]:
    """Return the defaults with the stored changes; a change that this version does not know or allow is told."""
    settings, findings = Settings(), []
    for name, text in database.rows("SELECT name, value FROM settings ORDER BY name"):
        table, _, key = name.partition(".")
        try:
            settings = with_value(settings, table, key, text)
        except LeaklineError:
            findings.append(Finding("stored_setting_ignored", Severity.WARNING, {"name": name, "value": text}))
    return settings, tuple(findings)


def write_settings(database: Database, settings: Settings) -> None:
    """Store what differs from the defaults; names of other versions stay untouched."""
    with database.transaction() as db:
        for table in fields(settings):
            step, plain = getattr(settings, table.name), getattr(Settings(), table.name)
            for field in fields(step):
                name, value = f"{table.name}.{field.name}", getattr(step, field.name)
                if value == getattr(plain, field.name):
                    db.execute("DELETE FROM settings WHERE name = ?", (name,))
                else:
                    db.execute("INSERT OR REPLACE INTO settings (name, value) VALUES (?, ?)", (name, str(value)))


def read_import_options(database: Database, recording: int) -> Json | None:
    """Return the options with which the recording was imported, None if none were stored."""
    row = database.one("SELECT import_options FROM recordings WHERE id = ?", (recording,))
    return None if row is None or row[0] is None else _object(database, row[0])


def write_import_options(database: Database, recording: int, options: Mapping[str, Any] | None) -> None:
    """Store the options with which the recording is to be imported."""
    text = None if options is None else to_json(options)
    with database.transaction() as db:
        db.execute("UPDATE recordings SET import_options = ? WHERE id = ?", (text, recording))


def read_state(database: Database) -> Json:
    """Return what the window remembered; values that cannot be understood are left out, they are mere comfort."""
    state: Json = {}
    for key, text in database.rows("SELECT key, value FROM state"):
        try:
            state[key] = json.loads(text)
        except (ValueError, RecursionError):
            continue
    return state


def write_state(database: Database, state: Mapping[str, Any]) -> None:
    """Replace what the window remembers."""
    rows = [(key, json.dumps(to_plain(value))) for key, value in state.items()]
    with database.transaction() as db:
        db.execute("DELETE FROM state")
        db.executemany("INSERT INTO state (key, value) VALUES (?, ?)", rows)


def _object(database: Database, text: str) -> Json:
    try:
        return from_json(Json, text)
    except ValueError as error:
        raise LeaklineError(ErrorCode.SURVEY_DAMAGED, Place(database.path), reason=str(error)) from error
