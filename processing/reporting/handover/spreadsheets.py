"""Tables for people: CSV as Excel opens it by a double click, and who decided what when.

Turkish Excel splits at semicolons and reads decimal commas, English Excel the other way: a file in the other's form
lands in one column, or with its numbers as dates.
"""

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from processing.quantities import MINUS
from processing.reporting.content import ReportContent
from processing.reporting.files import whole_path
from processing.reporting.handover.columns import Column, ColumnKind
from processing.reporting.handover.layers import Cell, Feature, Layer, Layers
from processing.reporting.handover.words import HandoverWords

LEAKS_NAME, STRETCHES_NAME, DECISIONS_NAME = "leaks-excel.csv", "stretches-excel.csv", "decisions.csv"
DECISION_COLUMNS = (
    "at_utc,operator,reason,leak,verdict_before,class_before,note_before,verdict_after,class_after,note_after"
)
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def write_excel(folder: Path, layers: Layers, words: HandoverWords) -> tuple[Path, ...]:
    """Write the leaks and the stretches with headings in words; return their paths. Raises OSError."""
    paths = folder / LEAKS_NAME, folder / STRETCHES_NAME
    for path, layer in zip(paths, (layers.all_leaks, layers.stretches), strict=True):
        headings = [words.heading(column) for column in layer.columns]
        _write(path, [headings, *_rows(layer, words)], words.language)
    return paths


def write_decisions(path: Path, content: ReportContent) -> None:
    """Write the log of decisions, oldest first, in the form of the contract's tables. Raises OSError."""
    text = io.StringIO()
    text.write(DECISION_COLUMNS + "\n")
    table = csv.writer(text, lineterminator="\n")
    for entry in content.record.log:
        told: list[str] = [entry.at_utc, entry.operator, entry.reason, str(entry.number)]
        for decision in (entry.before, entry.after):
            leak_class = decision.leak_class.value if decision.leak_class is not None else ""
            told += [decision.verdict.value, leak_class, decision.note]
        table.writerow(told)
    with whole_path(path) as aside:
        aside.write_bytes(text.getvalue().encode("utf-8", "backslashreplace"))


def _rows(layer: Layer, words: HandoverWords) -> Iterable[list[str]]:
    return ([_told(c, v, words) for c, v in _cells(layer, feature)] for feature in layer.features)


def _cells(layer: Layer, feature: Feature) -> Iterable[tuple[Column, Cell]]:
    return zip(layer.columns, feature.cells, strict=True)


def _told(column: Column, value: Cell, words: HandoverWords) -> str:
    """A number by the language without separators of thousands, which Excel would read as text; no text a formula."""
    if value is None:
        return ""
    if column.kind is ColumnKind.REAL:
        text = f"{value:.{column.digits}f}"
        return text.replace(".", ",") if words.language == "tr" else text
    if column.kind is ColumnKind.INTEGER and column.key not in ("used", "simulated"):
        return str(value)
    text = words.value(column, value)
    return f"'{text}" if text.startswith((*_FORMULA, MINUS)) else text


def _write(path: Path, rows: Sequence[Sequence[str]], language: str) -> None:
    text = io.StringIO()
    csv.writer(text, delimiter=";" if language == "tr" else ",", lineterminator="\r\n").writerows(rows)
    with whole_path(path) as aside:
        aside.write_bytes(text.getvalue().encode("utf-8-sig", "backslashreplace"))
