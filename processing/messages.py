"""Sentences for codes, in English and Turkish: what the window, the command line and the report say to people.

The texts stand in ``resources/messages/<language>/*.toml``; each file holds tables (``errors``, ``findings``,
``reasons``, ``progress``, ``report`` …) of ``key = "sentence with {placeholders}"``, merged over the files.
Numbers are filled in by :meth:`str.format`, so a sentence chooses its own digits: ``{gap_s:.1f} s``. Turkish has a
decimal comma and writes the percent sign first; only the report keeps points, as it lists coordinates.
"""

import string
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from numbers import Real

from processing.errors import LeaklineError
from processing.survey import Finding

LANGUAGES = ("en", "tr")


class _TurkishFormatter(string.Formatter):
    def format_field(self, value: object, format_spec: str) -> str:
        out = str(super().format_field(value, format_spec))
        if not isinstance(value, Real):
            return out
        out = out.replace(".", ",")
        return f"%{out[:-1]}" if format_spec.endswith("%") else out


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
    formatter = _FORMATTERS["en" if table_name == "report" else language]
    return formatter.vformat(_tables(language)[table_name][key], (), params)


def finding_sentence(finding: Finding, language: str = "en") -> str:
    """Return what a finding says to the operator."""
    return text("findings", finding.code, language, **finding.params)


def error_sentence(error: LeaklineError, language: str = "en") -> str:
    """Return one line that names the file, the place in it and what to do."""
    sentence = text("errors", error.code.value, language, **error.params)
    if error.place is None:
        return sentence
    place = str(error.place.path)
    for key, value in (("line", error.place.line), ("column", error.place.column), ("byte", error.place.byte)):
        if value is not None:
            place += f", {text('places', key, language)} {value}"
    return f"{place}: {sentence}"
