"""Sentences for codes, in English and Turkish: what the window, the command line and the report say to people.

The texts stand in ``resources/messages/<language>/*.toml``; each file holds tables (``errors``, ``findings``,
``reasons``, ``progress``, ``report`` …) of ``key = "sentence with {placeholders}"``, merged over the files.
Numbers are filled in by :meth:`str.format`, so a sentence chooses its own digits: ``{gap_s:.1f} s``. Turkish has a
decimal comma and writes the percent sign first; only the report keeps points, as it lists coordinates. The texts are
metric; a number that one of the units of :data:`_IN_US` follows is told in US units where these are asked for.

Every error and every finding says what is the matter, then :data:`THEN`, then what to do, be it that nothing is to be
done; for the short ``reasons`` that stands in the table ``reasons_do``. A test holds all texts to it.
"""

import re
import string
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from numbers import Real

from processing.errors import LeaklineError
from processing.quantities import GALLONS_PER_LITRE, METRES_PER_US_FOOT, PSI_PER_BAR, Units
from processing.survey import Finding

LANGUAGES = ("en", "tr")
THEN = " → "  # between what is the matter and what to do


class _TurkishFormatter(string.Formatter):
    def format_field(self, value: object, format_spec: str) -> str:
        out = str(super().format_field(value, format_spec))
        if not isinstance(value, Real):
            return out
        out = out.replace(".", ",")
        return f"%{out[:-1]}" if format_spec.endswith("%") else out


# the unit that stands behind a placeholder, the one in its stead, and how many of those one is
_IN_US: Mapping[str, tuple[str, float]] = {
    "m": ("ft", 1.0 / METRES_PER_US_FOOT),
    "mm": ("in", 1.0 / 25.4),
    "m/s": ("ft/s", 1.0 / METRES_PER_US_FOOT),
    "bar": ("psi", PSI_PER_BAR),
    "L/min": ("gal/min", GALLONS_PER_LITRE),
    "L/dak": ("gal/dak", GALLONS_PER_LITRE),
}
_WITH_UNIT = re.compile(
    r"\{(\w+)(:[^{}]*)?\}( ?(?:–|…|-|to|and|ile|ve) ?\{(\w+)(?::[^{}]*)?\})? (m/s|mm|m|bar|L/min|L/dak)(?![\w²³/])"
)


def _told_in_us(template: str, params: Mapping[str, object]) -> tuple[str, dict[str, object]]:
    """Return the sentence with US units in the place of metric ones, and the numbers that belong to it."""
    changed = dict(params)

    def swap(found: re.Match[str]) -> str:
        sign, factor = _IN_US[found.group(5)]
        for name in (found.group(1), found.group(4)):
            value = params.get(name or "")
            if isinstance(value, Real):
                changed[name] = float(value) * factor
        return f"{found.group(0)[: -len(found.group(5))]}{sign}"

    return _WITH_UNIT.sub(swap, template), changed


_FORMATTERS: Mapping[str, string.Formatter] = {"en": string.Formatter(), "tr": _TurkishFormatter()}


@cache
def _tables(language: str) -> Mapping[str, Mapping[str, str]]:
    merged: dict[str, dict[str, str]] = {}
    folder = resources.files("resources") / "messages" / language
    for file in sorted((f for f in folder.iterdir() if f.name.endswith(".toml")), key=lambda f: f.name):
        for table, texts in tomllib.loads(file.read_text(encoding="utf-8")).items():
            merged.setdefault(table, {}).update(texts)
    return merged


def table(name: str, language: str = "en") -> Mapping[str, str]:
    """Return all texts of one table."""
    return _tables(language).get(name, {})


def text(table_name: str, key: str, language: str = "en", **params: object) -> str:
    """Return one sentence, filled in; raises KeyError for an unknown key (that is our bug: a test lists them all)."""
    return text_in(Units.METRIC, table_name, key, language, **params)


def text_in(units: Units, table_name: str, key: str, language: str, **params: object) -> str:
    """Return one sentence as :func:`text` does, its lengths, speeds and pressures in these units."""
    formatter = _FORMATTERS["en" if table_name == "report" else language]
    template, told = _tables(language)[table_name][key], dict(params)
    if units is Units.US:
        template, told = _told_in_us(template, params)
    return formatter.vformat(template, (), told)


def finding_sentence(finding: Finding, language: str = "en", units: Units = Units.METRIC) -> str:
    """Return what a finding says to the operator."""
    return text_in(units, "findings", finding.code, language, **finding.params)


def what_and_do(sentence: str) -> tuple[str, str]:
    """Part the sentence of an error or a finding in what is the matter and what to do (empty where it has none)."""
    what, _, do = sentence.partition(THEN)
    return what, do


def reason_sentence(reason: str, language: str = "en") -> str:
    """Return a reason with what to do about it; a reason that no table knows as it is."""
    known, do = table("reasons", language), table("reasons_do", language)
    return f"{known[reason].rstrip('.')}{THEN}{do[reason]}" if reason in known and reason in do else reason


def error_sentence(error: LeaklineError, language: str = "en", units: Units = Units.METRIC) -> str:
    """Return one line that names the file, the place in it and what to do."""
    sentence = text_in(units, "errors", error.code.value, language, **error.params)
    if error.place is None:
        return sentence
    place = str(error.place.path)
    for key, value in (("line", error.place.line), ("column", error.place.column), ("byte", error.place.byte)):
        if value is not None:
            place += f", {text('places', key, language)} {value}"
    return f"{place}: {sentence}"
