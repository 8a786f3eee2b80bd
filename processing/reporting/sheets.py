"""All that the page template shows, figures excepted: what ``resources/report/report.typ`` reads as data.json."""

from datetime import UTC, datetime
from importlib import metadata
from typing import Any

from processing.reporting.appendix import appendix
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.cover import (
    accuracy,
    banner,
    company_lines,
    cover_facts,
    glance_tiles,
    result_sentence,
    watermark,
)
from processing.reporting.dig_sheet import sheet
from processing.reporting.listing import check_table, table_row, tie_row, unassessed_rest, unassessed_rows
from processing.reporting.references import references
from processing.reporting.words import Words
from processing.survey import Verdict

SHEETS_AT_MOST = 40  # undecided places beyond it stand in the table's file only; decided ones always get a sheet
TABLE_AT_MOST = 4 * SHEETS_AT_MOST
_TITLE_CHARACTERS = 140


def page_data(content: ReportContent) -> dict[str, Any]:
    """Return all words and numbers of the report, in the language and the units of ``content.options``."""
    words, results = Words(content.options), content.results
    info = results.survey.info
    sheets = rows_with_sheet(content)
    known = references(results)
    company = content.options.company
    now = datetime.now(UTC)
    title = words.shortened(info.name, _TITLE_CHARACTERS) or words("title")
    return {
        "language": words.language,
        "words": dict(words.table),
        "title": title,
        "short_title": words.name(title, 64),
        "author": words.shortened(info.operator, 80),
        "banner": banner(content, words),
        "watermark": watermark(content, words),
        "now": [now.year, now.month, now.day, now.hour, now.minute, now.second],
        "created": words(
            "created",
            version=metadata.version("leakline"),
            date=words.moment(now.isoformat()) + " UTC",
            run=results.run_hash[:12],
        ),
        "company": {
            "name": words.shortened(company.name, 90),
            "lines": company_lines(content, words),
            "footer": words.shortened(company.footer, 110),
        },
        "facts": cover_facts(content, words),
        "tiles": glance_tiles(content, words),
        "result": result_sentence(content, words),
        "accuracy": accuracy(content, words),
        "ties": [tie_row(check, words) for check in results.tie_checks],
        "changes": changes(content, words),
        "leaks": [table_row(row, content, words) for row in sorted(content.rows, key=crews_order)[:TABLE_AT_MOST]],
        "more": left_out(content, words),
        "sheets": [sheet(row, content, words, known) for row in sheets],
        "unassessed": unassessed_rows(content, words),
        "unassessed_more": unassessed_rest(content, words),
        "checks": [check_table(check, words) for check in results.recording.sheets],
        "appendix": appendix(content, words),
    }


def changes(content: ReportContent, words: Words) -> list[str]:
    """Return what has changed since the run that the operator put beside this one; nothing where there is none."""
    told = content.record.changes
    return [] if told is None else list(told(words.quantities)[:TABLE_AT_MOST])


def rows_with_sheet(content: ReportContent) -> list[LeakRow]:
    """Return the rows that get a page, in the crew's order: all confirmed and unsure, and the likeliest undecided."""
    decided = sum(r.decision.verdict in (Verdict.CONFIRMED, Verdict.UNSURE) for r in content.rows)
    room = max(0, SHEETS_AT_MOST - decided)
    chosen = []
    for row in content.rows:
        if row.decision.verdict in (Verdict.CONFIRMED, Verdict.UNSURE):
            chosen.append(row)
        elif row.decision.verdict is Verdict.NONE and room > 0:
            room -= 1
            chosen.append(row)
    return sorted(chosen, key=crews_order)


def crews_order(row: LeakRow) -> tuple[int, float]:
    """Return what sorts for a crew that goes along the pipe: confirmed first, then what is open, rejected last."""
    order = (Verdict.CONFIRMED, Verdict.UNSURE, Verdict.NONE, Verdict.REJECTED)
    return order.index(row.decision.verdict), row.candidate.time_s


def left_out(content: ReportContent, words: Words) -> str:
    """Return how many undecided places have no sheet; empty where all have one."""
    undecided = sum(row.decision.verdict is Verdict.NONE for row in content.rows)
    with_sheet = sum(row.decision.verdict is Verdict.NONE for row in rows_with_sheet(content))
    return words("more", count=undecided - with_sheet) if undecided > with_sheet else ""
