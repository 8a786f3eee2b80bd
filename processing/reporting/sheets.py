"""The report's words and numbers, laid out for the page template: what ``resources/report/report.typ`` reads."""

from datetime import UTC, datetime
from importlib import metadata
from typing import Any

import numpy as np

from processing import messages
from processing.coordinates import is_local
from processing.live.check_sheet import CheckSheet
from processing.live.check_words import item_sentence, item_title, light_word
from processing.position.tie_checks import TieCheck
from processing.reporting.content import LeakRow, ReportContent, verdict_counts
from processing.reporting.figures import VERDICT_COLOURS
from processing.sound.size_words import size_name, size_sentence
from processing.survey import Motion, Verdict

SHEETS_AT_MOST = 40  # undecided places beyond it stand in the table's file only; decided ones always get a sheet


class Words:
    """The ``[report]`` table of one language."""

    def __init__(self, language: str) -> None:
        self.language = language

    def __call__(self, key: str, **params: object) -> str:
        """Return one phrase, filled in."""
        return messages.text("report", key, self.language, **params)


def page_data(content: ReportContent, language: str) -> dict[str, Any]:
    """Return all that the template shows, figures excepted."""
    words, results = Words(language), content.results
    info = results.survey.info
    sheets = rows_with_sheet(content)
    left_out = len(content.rows) - len(sheets) - sum(r.decision.verdict is Verdict.REJECTED for r in content.rows)
    return {
        "language": language,
        "words": dict(messages.table("report", language)),
        "title": info.name or words("title"),
        "author": info.operator,
        "banner": banner(content, words),
        "created": words(
            "created",
            version=metadata.version("leakline"),
            date=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
            run=results.run_hash[:12],
        ),
        "facts": cover_facts(content, words),
        "accuracy": accuracy(content, words),
        "ties": [tie_row(check, words) for check in results.tie_checks],
        "leaks": [table_row(row, content, words) for row in content.rows[: 4 * SHEETS_AT_MOST]],
        "more": words("more", count=left_out) if left_out > 0 else "",
        "sheets": [sheet(row, content, words) for row in sheets],
        "unassessed": [unassessed_row(part, words) for part in content.unassessed],
        "findings": [messages.finding_sentence(finding, language) for finding in results.findings],
        "checks": [check_table(check, words) for check in results.recording.sheets],
        "files": [[f"{file.path.name} ({file.size / 1e6:.1f} MB)", file.sha256] for file in results.recording.files],
    }


def check_table(check: CheckSheet, words: Words) -> dict[str, Any]:
    """Return a check's title and its rows: light as key and word, what was checked, what was found."""
    language = words.language
    rows = [
        {
            "light": item.light.value,
            "word": light_word(item.light, language),
            "title": item_title(item, language),
            "found": item_sentence(item, language),
        }
        for item in check.items
    ]
    title = words("check_end_title" if check.kind == "end" else "check_title")
    return {"title": title, "when": check.utc.replace("T", " ").removesuffix("+00:00"), "rows": rows}


def rows_with_sheet(content: ReportContent) -> list[LeakRow]:
    """Return the rows that get a page: all confirmed and unsure ones, then the likeliest undecided."""
    decided = [r for r in content.rows if r.decision.verdict in (Verdict.CONFIRMED, Verdict.UNSURE)]
    undecided = [r for r in content.rows if r.decision.verdict is Verdict.NONE]
    chosen = decided + undecided[: max(0, SHEETS_AT_MOST - len(decided))]
    return [row for row in content.rows if row in chosen]


def banner(content: ReportContent, words: Words) -> str:
    """Return the line that keeps a reader from digging too soon: simulated data, or undecided places."""
    parts = []
    if content.results.survey.info.simulated:
        parts.append(words("simulated"))
    if content.undecided:
        parts.append(words("draft", count=content.undecided))
    return " · ".join(parts)


def cover_facts(content: ReportContent, words: Words) -> list[list[str]]:
    """Return label and value pairs of the cover."""
    results, survey = content.results, content.results.survey
    track = results.track
    pipe = words(
        "pipe_value",
        material=survey.pipe.material or words("unknown"),
        diameter=metres(survey.pipe.diameter_m, words, 3),
        length=metres(survey.pipe.length_m, words),
    )
    device = {
        Motion.ROLLING: words("device_rolling", radius=metres(survey.device.radius_m, words, 4)),
        Motion.CARRIED: words("device_carried"),
        Motion.FOOT: words("device_foot"),
    }[survey.device.motion]
    walked = float(track.chainage_m[-1] - track.chainage_m[0]) if track is not None else None
    method = words(
        "method_value",
        orientation=results.attitude_method or words("unknown"),
        position=track.method if track is not None else words("unknown"),
        assessed=metres(walked, words),
    )
    unassessed = metres(content.unassessed_m, words)
    facts = [
        [words("operator"), survey.info.operator],
        [words("client"), survey.info.client],
        [words("date"), survey.info.date],
        [words("pipe"), pipe],
        [words("device"), device],
        [words("method"), method],
        [words("result"), words("result_value", **verdict_counts(content), unassessed=unassessed)],
    ]
    return [fact for fact in facts if fact[1]]


def metres(value: float | None, words: Words, digits: int = 1) -> str:
    """Return a length with its unit."""
    return words("unknown") if value is None else f"{value:.{digits}f} m"


def accuracy(content: ReportContent, words: Words) -> list[str]:
    """Return the accuracy statement, sentence by sentence, each with its basis."""
    results, track = content.results, content.results.track
    if track is None:
        return [words("accuracy_no_path")]
    half = 1.96 * track.sigma_along_m
    widest = int(np.argmax(half))
    params = {"widest": float(half[widest]), "at": float(track.chainage_m[widest])}
    at_leaks = [row.interval_m for row in content.rows if np.isfinite(row.interval_m)]
    sentences = [
        words("accuracy_interval", **params, least=min(at_leaks), most=max(at_leaks))
        if at_leaks
        else words("accuracy_interval_plain", **params)
    ]
    used = [tie for tie in results.survey.tie_points if tie.enabled]
    if used:
        sentences.append(words("accuracy_ties", count=len(used)))
        if "tie_left_out_max_m" in track.quality:
            rms, worst = track.quality["tie_residual_rms_m"], track.quality["tie_left_out_max_m"]
            sentences.append(words("accuracy_tie_check", rms=rms, worst=worst))
    if results.survey.pipe.length_m is not None:
        sentences.append(words("accuracy_length", length=results.survey.pipe.length_m))
    elif not used:
        sentences.append(words("accuracy_free"))
    if results.recording.audio is not None:
        clock = results.clock
        sentences.append(words(f"accuracy_clock_{clock.basis}", sigma_ms=1000 * clock.sigma_s, sigma_s=clock.sigma_s))
    if any(finding.code == "heading_unknown" for finding in results.findings):
        sentences.append(words("heading_unknown"))
    return sentences


def tie_row(check: TieCheck, words: Words) -> list[str]:
    """Return one line of the table of tie points: how far the path passes it, and how far it would, were it unknown."""
    signed = "+.2f" if check.kind == "chainage" else ".2f"
    return [
        check.name or words("tie_length"),
        words(f"tie_{check.kind}"),
        f"{check.time_s:.1f} s",
        f"{check.residual_m:{signed}} m",
        f"{check.left_out_m:{signed}} m ± {1.96 * check.left_out_sigma_m:.2f} m",
        words("tie_held_down") if check.held_down else words("tie_used"),
    ]


def table_row(row: LeakRow, content: ReportContent, words: Words) -> dict[str, str]:
    """Return one line of the leak table."""
    c = row.candidate
    return {
        "id": str(c.label),
        "status": status(row, words),
        "colour": VERDICT_COLOURS[row.decision.verdict],
        "class": class_and_size(row, words),
        "chainage": f"{c.chainage_m:.1f} ± {row.interval_m:.1f} m"
        if np.isfinite(c.chainage_m)
        else f"{c.time_s:.1f} s",
        "coordinates": "\n".join(coordinate_lines(row, content, words)[:1]),
        "score": words("percent", percent=100 * c.score) if np.isfinite(c.score) else words("marked_short"),
        "level": f"{c.level_db:+.1f} dB" if np.isfinite(c.level_db) else "",
    }


def class_and_size(row: LeakRow, words: Words) -> str:
    """Return ``leak`` or ``leak, small or medium``."""
    name = words(f"class_{row.leak_class.value}")
    size = size_name(row.size, words.language) if row.size is not None else ""
    return f"{name}, {size}" if size else name


def status(row: LeakRow, words: Words) -> str:
    """Return the verdict in words."""
    return words("verdict_unsure") if row.decision.verdict is Verdict.UNSURE else words(f"status_{row.status}")


def coordinate_lines(row: LeakRow, content: ReportContent, words: Words) -> list[str]:
    """Return the place in WGS 84, in the survey's CRS, and in local metres, as far as they are known."""
    if not np.all(np.isfinite(row.candidate.position_w_m)):
        return [words("unknown")]
    lines = []
    if row.latitude is not None and row.longitude is not None:
        lines.append(words("wgs84", latitude=row.latitude, longitude=row.longitude))
    if not is_local(content.frame.grid):
        east, north, up = content.grid_place(row.candidate.position_w_m)
        lines.append(words("grid", crs=content.frame.grid, east=east, north=north, up=up))
    east, north, up = row.candidate.position_w_m
    lines.append(words("local", east=east, north=north, up=up))
    return lines


def sheet(row: LeakRow, content: ReportContent, words: Words) -> dict[str, Any]:
    """Return one leak's page."""
    c = row.candidate
    heading = "leak_heading" if row.decision.verdict is Verdict.CONFIRMED else "place_heading"
    place = f"{c.time_s:.1f} s"
    if np.isfinite(c.chainage_m):
        place = words("chainage_value", chainage=c.chainage_m, low=c.chainage_low95_m, high=c.chainage_high95_m)

    def neighbour(entry: Any) -> str:  # noqa: ANN401  # Neighbour or None
        if entry is None:
            return words("no_neighbour")
        name = words("launch") if entry.name == "launch" else entry.name
        return words("neighbour", name=name, distance=entry.distance_m)

    low, high = c.band_hz
    scored, known_level = np.isfinite(c.score), np.isfinite(c.level_db)
    facts = [
        [words("coordinates"), "\n".join(coordinate_lines(row, content, words))],
        [words("before"), neighbour(row.before)],
        [words("after"), neighbour(row.after)],
        [words("col_class"), words(f"class_{row.leak_class.value}")],
        [words("col_level"), words("level_value", level=c.level_db, low=low, high=high) if known_level else ""],
        [words("size"), size_sentence(row.size, words.language) if row.size is not None else ""],
        [words("col_score"), words("probability_value", percent=100 * c.score) if scored else words("marked")],
        [words("note"), row.decision.note],
    ]
    return {
        "id": c.label,
        "heading": words(heading, id=c.label),
        "status": status(row, words),
        "colour": VERDICT_COLOURS[row.decision.verdict],
        "place": place,
        "facts": [fact for fact in facts if fact[1]],
    }


def unassessed_row(part: Any, words: Words) -> list[str]:  # noqa: ANN401  # UnassessedStretch
    """Return one line of the table of what was not assessed."""
    stretch = part.stretch
    where, length = words("unknown"), words("unknown")
    if part.start_m is not None and part.end_m is not None:
        where, length = f"{part.start_m:.1f} – {part.end_m:.1f} m", f"{part.end_m - part.start_m:.1f} m"
    reason = messages.text("reasons", stretch.reason, words.language)
    span = f"{stretch.start_s:.1f} – {stretch.end_s:.1f} s"
    return [where, length, span, words(f"channel_{stretch.channel.value}"), reason]
