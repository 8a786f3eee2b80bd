"""The report's tables in words: leaks, tie points, what was not assessed, and the checks before the launch."""

from functools import lru_cache
from typing import Any

import numpy as np

from processing import messages
from processing.coordinates import LocalFrame
from processing.live.check_sheet import CheckSheet
from processing.live.check_words import item_sentence, item_title, light_word
from processing.position.distance import NORMAL_95
from processing.position.tie_checks import TieCheck
from processing.reporting.content import LeakRow, ReportContent, UnassessedStretch
from processing.reporting.handover.system import TargetSystem, target_system
from processing.reporting.marks import VERDICT_COLOURS
from processing.reporting.options import HandoverOptions
from processing.reporting.references import is_heading_known
from processing.reporting.words import Words
from processing.sound.size_words import size_name
from processing.survey import Verdict

UNASSESSED_AT_MOST = 60  # rows; of more, the longest are told one by one and the rest as a sum


def tie_row(check: TieCheck, words: Words) -> list[str]:
    """Return one line of the table of tie points: how far the path passes it, and how far it would, were it unknown."""
    q = words.quantities

    def off(metres: float) -> str:
        shown = metres * q.length_factor
        text = words.signed(shown, 2) if check.kind == "chainage" else words.number(shown, 2)
        return f"{text} {q.length_unit}"

    return [
        words.name(check.name, 60) or words("tie_length"),
        words(f"tie_{check.kind}"),
        words.seconds(check.time_s),
        off(check.residual_m),
        f"{off(check.left_out_m)} {words.plus_minus(NORMAL_95 * check.left_out_sigma_m, 2)}",
        words("tie_held_down") if check.held_down else words("tie_used"),
    ]


def table_row(row: LeakRow, content: ReportContent, words: Words) -> dict[str, str]:
    """Return one line of the leak table."""
    c = row.candidate
    placed = np.isfinite(c.chainage_m)
    return {
        "id": str(c.label),
        "status": status(row, words),
        "verdict": row.decision.verdict.value,
        "colour": VERDICT_COLOURS[row.decision.verdict],
        "class": class_and_size(row, words),
        "chainage": f"{words.place(c.chainage_m)} {words.plus_minus(row.interval_m)}"
        if placed
        else words.seconds(c.time_s),
        "coordinates": "\n".join(coordinate_lines(row, content, words)[:1]),
        "score": words.share(c.score) if np.isfinite(c.score) else words("marked_short"),
        "level": f"{words.signed(c.level_db, 1)} dB" if np.isfinite(c.level_db) else "",
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
    """Return the place in WGS 84, in the chosen coordinate system, and from the launch, as far as they are known.

    Degrees and grid coordinates have a point in every language: they are typed into phones and maps.
    """
    if not np.all(np.isfinite(row.candidate.position_w_m)):
        return [words("unknown")]
    if not is_heading_known(content.results):
        return [words("no_direction")]
    q, lines = words.quantities, []
    if row.latitude is not None and row.longitude is not None:
        lines.append(words("wgs84", latitude=f"{row.latitude:.6f}", longitude=f"{row.longitude:.6f}"))
    system = chosen_system(content.frame, content.options.crs)
    if not system.is_local and not system.is_degrees:
        x, y, _ = system.coordinates(np.array([row.candidate.position_w_m]))[0]
        if np.isfinite([x, y]).all():  # far outside of its area a system has no coordinates
            unit = "US ft" if system.unit == "ftus" else system.unit
            lines.append(words("grid", crs=system.crs, east=f"{x:.2f}", north=f"{y:.2f}", unit=unit))
    east, north, _ = (value * q.length_factor for value in row.candidate.position_w_m)
    lines.append(words("local", east=words.signed(east, 1), north=words.signed(north, 1), unit=q.length_unit))
    return lines


@lru_cache(maxsize=4)
def chosen_system(frame: LocalFrame, crs: str) -> TargetSystem:
    """Return the system that coordinates are told in; found once, as all leaks are told in the same."""
    return target_system(frame, HandoverOptions(crs=crs))


def unassessed_rows(content: ReportContent, words: Words) -> list[list[str]]:
    """Return the table of what was not assessed, in the order of the pipe; of very many only the longest."""

    def extent(part: UnassessedStretch) -> float:
        return part.stretch.end_s - part.stretch.start_s

    longest = sorted(content.unassessed, key=extent, reverse=True)[:UNASSESSED_AT_MOST]
    chosen = {id(part) for part in longest}
    in_order = sorted(content.unassessed, key=lambda part: part.stretch.start_s)
    return [unassessed_row(part, words) for part in in_order if id(part) in chosen]


def unassessed_rest(content: ReportContent, words: Words) -> str:
    """Return how many stretches the table leaves out; empty where it has them all."""
    count = len(content.unassessed) - UNASSESSED_AT_MOST
    return words("unassessed_more", count=count) if count > 0 else ""


def unassessed_row(part: UnassessedStretch, words: Words) -> list[str]:
    """Return one line: where, how long, when, what, why, and what to do about it."""
    stretch = part.stretch
    where, length = words("unknown"), words("unknown")
    if part.start_m is not None and part.end_m is not None:
        where, length = words.span(part.start_m, part.end_m), words.length(part.end_m - part.start_m)
    span = f"{words.number(stretch.start_s, 1)} – {words.seconds(stretch.end_s)}"
    reason = messages.text("reasons", stretch.reason, words.language)
    todo = f"todo_{stretch.reason}"
    advice = words(todo) if todo in words else words(f"todo_{stretch.channel.value}")
    return [where, length, span, words(f"channel_{stretch.channel.value}"), reason, advice]


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
