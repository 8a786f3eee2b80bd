"""What the program remembers between starts: one small JSON file in the user's configuration folder.

It holds looks and habits only; nothing of a survey. A missing or damaged file means the defaults, never a failure.
"""

import dataclasses
import json
import logging
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import platformdirs

log = logging.getLogger(__name__)

MAX_RECENT = 40  # the start page searches among them


# what a value must be where not every text or number of its kind is one
ALLOWED: dict[str, Callable[[Any], bool]] = {
    "theme": ("light", "sun", "dark").__contains__,
    "language": ("", "en", "tr").__contains__,
    "report_language": ("", "en", "tr").__contains__,
    "units": ("metric", "us").__contains__,
    "places": ("chainage", "stationing").__contains__,
    "text_scale": lambda value: not isinstance(value, bool) and 100 <= value <= 200,
    "volume": lambda value: math.isfinite(value) and 0.0 <= value <= 1.0,
    "play_slow": (1, 2, 4).__contains__,
}


@dataclass
class Preferences:
    """The remembered values, with their defaults."""

    theme: str = "light"
    language: str = ""  # empty: the system's
    geometry: str = ""  # base64 of QWidget.saveGeometry
    splitters: dict[str, str] = field(default_factory=dict)  # name -> base64 of QSplitter.saveState
    recent: list[str] = field(default_factory=list)  # newest first
    volume: float = 0.8
    play_band: str = "whole"  # or leaks, candidate
    play_slow: int = 1  # times as long
    recent_crs: list[str] = field(default_factory=list)  # EPSG codes chosen for routes, newest first
    sound_view: dict[str, str] = field(default_factory=dict)  # scale, plane, colours and axis of the spectrogram
    correlator_folder: str = ""  # where recordings and sessions of the correlator were last
    recording: dict[str, str] = field(default_factory=dict)  # devices, names and folder of the recording page
    units: str = "metric"  # or us
    places: str = "chainage"  # or stationing
    text_scale: int = 100  # per cent, 100 to 200
    report_language: str = ""  # empty: the window's
    company: dict[str, str] = field(default_factory=dict)  # the report's template fields
    handover: dict[str, str] = field(default_factory=dict)  # which files, in which system, under which names
    reviewer: str = ""  # the second reviewer's name, as typed last
    layout: dict[str, str] = field(default_factory=dict)  # tabs, filters and modes of the review pages
    tour_seen: bool = False
    pinned: list[str] = field(default_factory=list)  # surveys kept on top of the start page, newest first
    operator: str = ""  # of new surveys, as typed in the settings


class PreferencesStore:
    """Reads the preferences once and writes them whole on each change."""

    def __init__(self, file: Path | None = None) -> None:
        self.file = file or config_folder() / "preferences.json"
        self.values = self._read()

    def change(self, **values: Any) -> None:  # noqa: ANN401  # any field of Preferences
        """Set some values and write the file; a disc that refuses costs the habit, not the work."""
        self.values = dataclasses.replace(self.values, **values)
        text = json.dumps(dataclasses.asdict(self.values), ensure_ascii=False, indent=1)
        try:
            self.file.parent.mkdir(parents=True, exist_ok=True)
            aside = self.file.with_suffix(".new")
            aside.write_text(text, encoding="utf-8")
            os.replace(aside, self.file)  # noqa: PTH105  # atomic on every platform
        except OSError as error:
            log.warning("preferences were not written: %s", error)

    def remember_recent(self, path: Path) -> None:
        """Put ``path`` on top of the recent surveys."""
        entry = str(path)
        self.change(recent=[entry, *(r for r in self.values.recent if r != entry)][:MAX_RECENT])

    def forget_recent(self, path: Path) -> None:
        """Take ``path`` off the recent surveys."""
        self.change(recent=[r for r in self.values.recent if r != str(path)])

    def _read(self) -> Preferences:
        try:
            found = json.loads(self.file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return Preferences()
        except (OSError, ValueError) as error:
            log.warning("preferences were not read: %s", error)
            return Preferences()
        defaults = Preferences()
        known = {f.name: getattr(defaults, f.name) for f in dataclasses.fields(Preferences)}
        if not isinstance(found, dict):
            return defaults
        kept = {k: v for k, v in found.items() if k in known and isinstance(v, type(known[k]))}
        kept = {k: v for k, v in kept.items() if k not in ALLOWED or ALLOWED[k](v)}
        for name in ("recent", "pinned", "recent_crs"):
            kept[name] = [text for text in kept.get(name, []) if text and _is_text(text)][:MAX_RECENT]
        for name in ("splitters", "sound_view", "recording", "company", "handover", "layout"):
            kept[name] = {k: v for k, v in kept.get(name, {}).items() if _is_text(v)}
        return Preferences(**kept)


def _is_text(value: object) -> bool:
    """Tell whether this is a text that may also name a file: the system's calls refuse a zero in one."""
    return isinstance(value, str) and "\0" not in value


def config_folder() -> Path:
    """Return the folder for preferences and column mappings."""
    return Path(platformdirs.user_config_dir("Leakline", appauthor=False))


def mappings_file() -> Path:
    """Return the file of remembered column mappings."""
    return config_folder() / "column-mappings.json"


def log_folder() -> Path:
    """Return the folder for the program's log."""
    return Path(platformdirs.user_log_dir("Leakline", appauthor=False))


def surveys_folder() -> Path:
    """Return where surveys go whose device folder cannot be written to."""
    return Path(platformdirs.user_documents_dir()) / "Leakline"
