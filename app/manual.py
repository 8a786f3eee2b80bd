"""The manual: Markdown pages in ``resources/manual/<language>``, with keys and names filled in from the action table.

Within a page ``{key:confirm}`` stands for the keys of the action ``confirm``, ``{action:confirm}`` for its name in the
menus, ``{keys:review}`` alone on a line for the table of all keys of that menu, and ``{gestures:all}`` for what mouse
and fingers do: what those tables say is never written down a second time.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from app import actions, gestures
from app.actions import ACTIONS, PAGE_TITLES, Page
from app.gestures import GESTURES

# the order of the contents; each is a file in each language
PAGES = (
    "quick-start",
    "before-the-launch",
    "recording",
    "importing",
    "lights",
    "tie-points",
    "path",
    "listening",
    "review",
    "gallery",
    "measuring",
    "report",
    "hand-over",
    "digs",
    "repeat-runs",
    "correlator",
    "settings",
    "troubleshooting",
    "keys",
    "glossary",
)

# which page answers for what is in front
CONTEXT = {
    "start": "quick-start",
    "data": "importing",
    "path": "path",
    "sound": "listening",
    "leaks": "review",
    "report": "report",
    "gallery": "gallery",
    "correlator": "correlator",
    "recording": "recording",
    "settings": "settings",
    "digs": "digs",
    "repeat": "repeat-runs",
}

PLACEHOLDER = re.compile(r"\{(key|action|keys|gestures):([a-z0-9_]+)\}")
LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)]+)\)")
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")


@dataclass(frozen=True)
class ManualPage:
    """One page: ``markdown`` is ready to show, ``text`` is what a search looks through."""

    name: str
    title: str
    markdown: str

    @property
    def text(self) -> str:
        """The words of the page without Markdown's signs."""
        plain = PICTURE.sub(" ", self.markdown)
        plain = re.sub(r"\[([^\]]*)\]\([^)]+\)", r"\1", plain)
        return re.sub(r"[#*|`>]|^-+$", " ", plain, flags=re.MULTILINE)


def folder(language: str) -> Path:
    """Return where the pages and pictures of a language lie."""
    return Path(str(resources.files("resources") / "manual" / language))


def raw(name: str, language: str) -> str:
    """Return a page as it is written."""
    return (folder(language) / f"{name}.md").read_text(encoding="utf-8")


def pages(language: str) -> tuple[ManualPage, ...]:
    """Return all pages in their order; the program must speak this language, for the names of actions."""
    return tuple(page(name, language) for name in PAGES)


def page(name: str, language: str) -> ManualPage:
    """Return one page; raises KeyError where it names an action that does not exist."""
    text = filled(raw(name, language))
    title = text.splitlines()[0].lstrip("# ").strip()
    return ManualPage(name, title, text)


def filled(text: str) -> str:
    """Return a page with keys and names of actions in the place of what stands for them."""
    return PLACEHOLDER.sub(lambda found: _of_kind(found.group(1), found.group(2)), text)


def context(window_page: str) -> str:
    """Return the page of the manual for a page of the window."""
    return CONTEXT.get(window_page, PAGES[0])


def _of_kind(kind: str, name: str) -> str:
    if kind == "keys":
        return "\n".join(_table(Page(name)))
    if kind == "gestures":
        return "\n".join(_gestures())
    row = _rows()[name]
    if kind == "action":
        return f"*{actions.translated(row.text).rstrip('…')}*"
    return " / ".join(f"**{key}**" for key in actions.shown_keys(row).split(" / ")) if row.keys else "–"


@cache
def _rows() -> dict[str, actions.ActionRow]:
    return {row.id: row for row in ACTIONS}


def _gestures() -> Iterator[str]:
    yield f"| {gestures.translated(gestures.TITLE)} | |"
    yield "|---|---|"
    for gesture in GESTURES:
        yield f"| **{gestures.translated(gesture.how)}** | {gestures.translated(gesture.what)} |"


def _table(group: Page) -> Iterator[str]:
    yield f"| {actions.translated(PAGE_TITLES[group]).replace('&', '')} | | |"
    yield "|---|---|---|"
    for row in ACTIONS:
        if row.page is group and row.keys:
            yield f"| **{actions.shown_keys(row)}** | {actions.translated(row.text)} | {actions.translated(row.tip)} |"
