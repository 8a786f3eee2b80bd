#!/usr/bin/env python3
"""Keeps the window's Turkish in step with its English: collects the texts of ``app`` and ``widgets``, and compiles.

    python packaging/translate.py         collect into resources/translations/leakline_tr.ts, compile leakline_tr.qm
    python packaging/translate.py check   change nothing; say what is missing, exit status 1 if anything is

Run it with the Python of ``.venv`` after any change of a text, then write the Turkish of what it names into the .ts
file (by hand or with pyside6-linguist) and run it again. Qt's own lupdate is not used: it overlooks texts inside
f-strings and those of the table in ``app/actions.py``.
"""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET  # it reads only our own file
from collections.abc import Iterator
from pathlib import Path
from xml.sax.saxutils import escape

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ("app", "widgets")
TS = ROOT / "resources" / "translations" / "leakline_tr.ts"
QM = TS.with_suffix(".qm")
FIELD = re.compile(r"\{[^{}]*\}|%(?:L?[1-9](?!\d)|n\b)")

Key = tuple[str, str]  # context, English text

# Qt's own Turkish calls these keys Kontrol, Üst Karakter, Dönüş, Baş; keyboards sold in Turkey bear other names.
# None may be called as Qt calls another one in English: a text such as "Enter" is read as a key in either language
QT_TEXTS = {("QShortcut", key) for key in ("Ctrl", "Shift", "Return", "Enter", "PgUp", "PgDown", "Home")}


class NotTranslatableError(Exception):
    """A text that no translation can reach; the message names file and line."""


def main(arguments: list[str]) -> int:
    """Collect and compile, or only check; returns the exit status."""
    if arguments not in ([], ["check"]):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        wanted = collect(ROOT)
    except NotTranslatableError as error:
        print(error, file=sys.stderr)
        return 1
    old = read_ts(TS)
    if arguments:
        gone = sorted(set(old) - wanted)
        for context, text in gone:
            print(f"no longer used: {context}: {text!r}")
        return 1 if report({key: old.get(key, "") for key in wanted}) or gone else 0
    new = {key: old.get(key, "") for key in wanted}
    write_ts(TS, new)
    compile_ts(TS, QM)
    for context, text in sorted(set(old) - wanted):
        print(f"removed: {context}: {text!r} was {old[context, text]!r}")
    return 1 if report(new) else 0


def report(messages: dict[Key, str]) -> bool:
    """Print what is untranslated or has lost a placeholder; tell whether there was anything."""
    bad = [key for key in sorted(messages) if faults(key[1], messages[key])]
    for context, text in bad:
        print(f"{faults(text, messages[context, text])}: {context}: {text!r}")
    print(f"{len(messages)} texts, {len(bad)} to mend")
    return bool(bad)


def faults(text: str, turkish: str) -> str:
    """Return what is wrong with a translation, empty if nothing."""
    if not turkish.strip():
        return "not translated"
    if sorted(FIELD.findall(text)) != sorted(FIELD.findall(turkish)):
        return "placeholders differ"
    return ""


# --- collecting ---------------------------------------------------------------------------------------------------


def collect(root: Path) -> set[Key]:
    """Return every text of the sources below ``root``; raises NotTranslatableError for one that cannot be reached."""
    found = set(QT_TEXTS)
    for package in SOURCES:
        for path in sorted((root / package).rglob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            found.update(texts(tree, path.relative_to(root).as_posix()))
    return found


def texts(tree: ast.AST, place: str, owner: str = "") -> Iterator[Key]:
    """Yield context and text of each call of tr, translate and QT_TRANSLATE_NOOP below ``tree``."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Call):
            key = text_of(node, f"{place}:{node.lineno}", owner)
            if key is not None:
                yield key
        yield from texts(node, place, node.name if isinstance(node, ast.ClassDef) else owner)


def text_of(call: ast.Call, place: str, owner: str) -> Key | None:
    """Return context and text of a call, None if it is about something else."""
    called = ast.unparse(call.func)
    literals = [a.value if isinstance(a, ast.Constant) and isinstance(a.value, str) else None for a in call.args]
    if called == "tr" or called.endswith(".tr"):
        if called != "self.tr" or not owner or len(literals) != 1 or literals[0] is None:
            raise NotTranslatableError(f"{place}: only self.tr with one plain text can be translated")
        return owner, literals[0]
    if called in ("QT_TRANSLATE_NOOP", "N") or called.endswith("QCoreApplication.translate"):
        if len(literals) != 2 or literals[0] is None:
            raise NotTranslatableError(f"{place}: a context and one text are wanted, both plain")
        if literals[1] is not None:
            return literals[0], literals[1]
        if called.endswith("translate") and not isinstance(call.args[1], ast.JoinedStr):
            return None  # looks up a text that stands in a table, where QT_TRANSLATE_NOOP names it
        raise NotTranslatableError(f"{place}: this text is put together; only a plain one can be translated")
    return None


# --- the two files ------------------------------------------------------------------------------------------------


def read_ts(path: Path) -> dict[Key, str]:
    """Return the translations of a .ts file; unfinished ones are empty, a missing file holds none."""
    if not path.exists():
        return {}
    found: dict[Key, str] = {}
    for context in ET.parse(path).getroot().iter("context"):  # noqa: S314  # our own file
        for message in context.iter("message"):
            turkish = message.find("translation")
            done = turkish is not None and turkish.get("type") is None
            key = context.findtext("name", ""), message.findtext("source", "")
            found[key] = (turkish.text or "") if done and turkish is not None else ""
    return found


def write_ts(path: Path, messages: dict[Key, str]) -> None:
    """Write translations sorted by context and text, without lines of source files, so that changes stay readable."""
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        "<!DOCTYPE TS>",
        '<TS version="2.1" language="tr_TR" sourcelanguage="en">',
    ]
    context = None
    for key in sorted(messages):
        if key[0] != context:
            lines += ["</context>"] if context is not None else []
            context = key[0]
            lines += ["<context>", f"    <name>{escape(context)}</name>"]
        turkish = messages[key]
        state = "" if turkish else ' type="unfinished"'
        lines += [
            "    <message>",
            f"        <source>{escape(key[1])}</source>",
            f"        <translation{state}>{escape(turkish)}</translation>",
            "    </message>",
        ]
    lines += ["</context>"] if context is not None else []
    lines.append("</TS>")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def compile_ts(source: Path, target: Path) -> None:
    """Write the .qm that the program loads; raises RuntimeError with lrelease's words if it fails."""
    program = shutil.which("pyside6-lrelease", path=str(Path(sys.executable).parent))
    if program is None:
        raise RuntimeError("pyside6-lrelease is not beside this Python: use the one of .venv")
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / target.name
        done = subprocess.run(
            [program, "-silent", str(source), "-qm", str(made)], capture_output=True, text=True, check=False
        )
        if done.returncode != 0 or not made.exists():
            raise RuntimeError(f"lrelease: {done.stdout}{done.stderr}")
        shutil.copyfile(made, target)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
