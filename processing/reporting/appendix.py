"""The report's appendix: what it takes to make the run again and to see who said what: settings, files, log, photos."""

import dataclasses
import json
from typing import Any

from processing import messages
from processing.dig_statistics import errors_of
from processing.reporting.content import ReportContent
from processing.reporting.dig_sheet import NOTE_CHARACTERS, dug_lines, verdict_word
from processing.reporting.summary import LIBRARIES, version
from processing.reporting.words import Words
from processing.review_facts import DigResult, LoggedDecision
from processing.settings import Settings
from processing.survey import Decision

LOG_AT_MOST, PHOTOS_AT_MOST, FILES_AT_MOST = 300, 200, 200
_NOTE_AT_MOST = 6000  # characters of one whole note


def appendix(content: ReportContent, words: Words) -> dict[str, Any]:
    """Return all tables of the appendix."""
    results = content.results
    log, units = content.record.log, words.quantities.units
    return {
        "findings": [messages.finding_sentence(finding, words.language, units) for finding in results.findings],
        "notes": long_notes(content, words),
        "settings": [[name, shown(value), shown(default)] for name, value, default in changed(results.settings)],
        "versions": " · ".join(f"{name} {version(name)}" for name in LIBRARIES if version(name)),
        "run": results.run_hash,
        "recipe": recipe(content),
        "files": [
            [f"{file.path.name} ({words.number(file.size / 1e6, 1)} MB)", file.sha256]
            for file in results.recording.files[:FILES_AT_MOST]
        ],
        "log": [log_row(entry, words) for entry in log[-LOG_AT_MOST:]],
        "log_more": words("log_more", count=len(log) - LOG_AT_MOST) if len(log) > LOG_AT_MOST else "",
        "digs": [dig_row(content.record.digs[number], words) for number in sorted(content.record.digs)],
        "photos": photo_rows(content, words),
    }


def changed(settings: Settings) -> list[tuple[str, object, object]]:
    """Return name, value and default of each setting that differs, as ``--set`` has it: ``table.key``."""
    out: list[tuple[str, object, object]] = []
    plain = Settings()
    for table in dataclasses.fields(settings):
        own, default = getattr(settings, table.name), getattr(plain, table.name)
        out += [
            (f"{table.name}.{key.name}", getattr(own, key.name), getattr(default, key.name))
            for key in dataclasses.fields(own)
            if getattr(own, key.name) != getattr(default, key.name)
        ]
    return out


def shown(value: object) -> str:
    """Return a setting's value as ``--set`` reads it: with a point."""
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def recipe(content: ReportContent) -> str:
    """Return one line of JSON that names the run and all it takes to make it again from the files listed."""
    results = content.results
    told = {
        "leakline": version("leakline"),
        "run": results.run_hash,
        "settings": {name: shown(value) for name, value, _ in changed(results.settings)},
        "sha256": [file.sha256 for file in results.recording.files[:FILES_AT_MOST]],
    }
    return json.dumps(told, ensure_ascii=False)  # with its spaces: lines break there


def long_notes(content: ReportContent, words: Words) -> list[list[str]]:
    """Return the notes that had no room on their sheets, whole, with their lines."""
    notes = []
    for row in content.rows:
        note = row.decision.note
        if len(" ".join(note.split())) > NOTE_CHARACTERS:
            cut = note if len(note) <= _NOTE_AT_MOST else f"{note[:_NOTE_AT_MOST]} …"
            notes.append([words("place_heading", id=row.candidate.label), cut])
    return notes


def log_row(entry: LoggedDecision, words: Words) -> list[str]:
    """Return who said what of which leak when."""
    key = f"reason_{entry.reason}"
    reason = words(key) if key in words else entry.reason
    return [
        words.moment(entry.at_utc),
        words.shortened(entry.operator, 40) or words("unknown"),
        str(entry.number),
        reason,
        change(entry.before, entry.after, words),
    ]


def change(before: Decision, after: Decision, words: Words) -> str:
    """Return what a decision changed: verdict, class, note."""
    parts = []
    if before.verdict is not after.verdict:
        parts.append(f"{verdict_word(before.verdict, words)} → {verdict_word(after.verdict, words)}")
    if before.leak_class is not after.leak_class:
        parts.append(words(f"class_{after.leak_class.value}") if after.leak_class is not None else words("class_auto"))
    if before.note != after.note:
        parts.append(words("note_is", note=words.shortened(after.note, 60)) if after.note else words("note_removed"))
    return "; ".join(parts) or verdict_word(after.verdict, words)


def dig_row(dug: DigResult, words: Words) -> list[str]:
    """Return one dig: leak, day, what was found, how far off, whether the window that was stated then held it.

    As the window and the history judge it: the tape's own error considered.
    """
    low, high = dug.stated_low95_m, dug.stated_high95_m
    judged = errors_of([dug]).held
    held = words("not_known")
    if len(judged):
        held = words("dig_inside" if judged[0] else "dig_outside")
    window = words.span(low, high) if low is not None and high is not None else words("not_known")
    told = dug_lines(dug, words)
    found = words("dig_missed") if dug.missed else told["finding"]
    note = " · ".join(part for part in (told["cause"], words.shortened(dug.note, 80)) if part)
    return [str(dug.number), told["date"], found, told["off"] or "–", window, held, note]


def photo_rows(content: ReportContent, words: Words) -> list[list[str]]:
    """Return the list of photos: leak, file, caption, when and by whom, and the sum that proves the file."""
    rows = []
    for photo, _ in content.record.photos[:PHOTOS_AT_MOST]:
        told = " · ".join(part for part in (words.moment(photo.at_utc), words.shortened(photo.operator, 40)) if part)
        rows.append(
            [
                str(photo.number),
                words.shortened(photo.file, 60),
                words.shortened(photo.caption, 120),
                told,
                photo.sha256,
            ]
        )
    return rows
