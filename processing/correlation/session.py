"""The correlator's own file ``*.leakcorr``: which recordings, which pipe, what was chosen, as JSON for people to read.

Keys (all but ``format``, ``version``, ``a`` and ``b`` may be left out):
    ``format`` "leakline-correlator", ``version`` 1
    ``a``, ``b``    ``{"files": ["a.wav"], "channel": 0}``; files as seen from the session's folder
    ``sync``        ``{"kind": "one_clock|typed|event|taps|unknown", "offset_s", "sigma_s", "drift_ppm",
                    "at_s"}``
    ``start_s``, ``end_s``   the stretch of A that is used; ``end_s`` null is to the end
    ``distance_m``  from sensor to sensor as measured, or null
    ``sections``    list of ``{"length_m", "material", "diameter_m", "wall_m", "speed_mps", "speed_sigma_mps",
                    "length_sigma_m"}``, numbers or null
    ``weighting``   "none|roth|scot|phat|maximum_likelihood"
    ``band_hz``     ``[low, high]`` or null for automatic; ``without_hum`` true or false
    ``dispersion``  ``{"slope", "sigma", "reference_hz"}``
    ``suppressed``  list of ``{"delay_s", "half_width_s", "name"}``
    ``divide_resonances`` true or false; ``note`` free text
The file comes from anywhere: sizes, types and ranges are checked, unknown keys are ignored, nothing is evaluated.
"""

import json
import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from processing.correlation.analysis import Choice
from processing.correlation.correlogram import Suppressed
from processing.correlation.phase_fit import DispersionChoice
from processing.correlation.pipe import MOST_SECTIONS, Pipe, PipeSection
from processing.correlation.recordings import MOST_DRIFT_PPM, Sync, SyncKind
from processing.correlation.weighting import Band, Weighting
from processing.errors import ErrorCode, LeaklineError, Place
from processing.reporting.files import whole_file

SUFFIX = ".leakcorr"
FORMAT, VERSION = "leakline-correlator", 1
MOST_BYTES = 1_000_000
_MOST_FILES, _MOST_SUPPRESSED, _MOST_TEXT = 64, 50, 4000


@dataclass(frozen=True)
class RecordingChoice:
    """Files that follow each other, and which of their channels."""

    paths: tuple[Path, ...]
    channel: int = 0


@dataclass(frozen=True)
class CorrelatorSession:
    """Everything that the page needs to come to the same result again."""

    a: RecordingChoice
    b: RecordingChoice
    sync: Sync = field(default_factory=Sync)
    start_s: float = 0.0
    end_s: float | None = None
    pipe: Pipe = field(default_factory=lambda: Pipe(()))
    choice: Choice = field(default_factory=Choice)
    note: str = ""


def write_session(path: Path, session: CorrelatorSession) -> None:
    """Write the file whole or not at all.

    Raises:
        LeaklineError: CANNOT_WRITE.
    """
    choice = session.choice
    data = {
        "format": FORMAT,
        "version": VERSION,
        "a": _recording_data(session.a, path.parent),
        "b": _recording_data(session.b, path.parent),
        "sync": asdict(session.sync),
        "start_s": session.start_s,
        "end_s": session.end_s,
        "distance_m": session.pipe.distance_m,
        "sections": [asdict(section) for section in session.pipe.sections],
        "weighting": choice.weighting.value,
        "band_hz": None if choice.band is None else [choice.band.low_hz, choice.band.high_hz],
        "without_hum": choice.band is None or choice.band.without_hum,
        "dispersion": asdict(choice.dispersion),
        "suppressed": [asdict(peak) for peak in choice.suppressed],
        "divide_resonances": choice.divide_resonances,
        "note": session.note,
    }
    try:
        with whole_file(path) as file:
            json.dump(data, file, ensure_ascii=False, indent=1)
    except OSError as error:
        raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=error.strerror or str(error)) from error


def _recording_data(recording: RecordingChoice, folder: Path) -> dict[str, Any]:
    return {"files": [_relative(file, folder) for file in recording.paths], "channel": recording.channel}


def _relative(file: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(file.absolute(), folder.absolute())).as_posix()
    except ValueError:  # another drive
        return str(file.absolute())


def read_session(path: Path) -> CorrelatorSession:
    """Return what a file says.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, CORRELATION_SESSION_DAMAGED with the key that is wrong,
            CORRELATION_SESSION_NEWER.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except FileNotFoundError as error:
        raise LeaklineError(ErrorCode.FILE_MISSING, Place(path)) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=reason) from error
    try:
        return _session(_Table(_parsed(raw), ""), path.parent)
    except _NewerError as error:
        raise LeaklineError(ErrorCode.CORRELATION_SESSION_NEWER, Place(path)) from error
    except _BadKeyError as error:
        raise LeaklineError(ErrorCode.CORRELATION_SESSION_DAMAGED, Place(path), entry=str(error)) from error
    except (ValueError, RecursionError) as error:  # no UTF-8, no JSON, or JSON nested without end
        raise LeaklineError(ErrorCode.CORRELATION_SESSION_DAMAGED, Place(path), entry="JSON") from error


def _parsed(raw: bytes) -> object:
    if len(raw) > MOST_BYTES:
        raise _BadKeyError("size")
    data: object = json.loads(raw.decode("utf-8"))
    return data


class _BadKeyError(Exception):
    """The text names the key."""


class _NewerError(Exception):
    pass


class _Table:
    """A JSON object whose values are taken out by kind; anything else names its key."""

    def __init__(self, data: object, name: str) -> None:
        if not isinstance(data, dict):
            raise _BadKeyError(name or "{}")
        self._data: Mapping[str, Any] = data
        self._name = name

    def _key(self, key: str) -> str:
        return f"{self._name}.{key}" if self._name else key

    def number(self, key: str, low: float, high: float, default: float | None = None) -> float:
        """Return a number within low..high."""
        value = self.optional_number(key, low, high)
        if value is None:
            if default is None:
                raise _BadKeyError(self._key(key))
            return default
        return value

    def optional_number(self, key: str, low: float, high: float) -> float | None:
        """Return a number within low..high, None where it is missing or null."""
        value = self._data.get(key)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _BadKeyError(self._key(key))
        number = float(value) if abs(value) < 1e300 else math.inf
        if not (math.isfinite(number) and low <= number <= high):
            raise _BadKeyError(self._key(key))
        return number

    def text(self, key: str, default: str = "") -> str:
        """Return a text of bounded length."""
        value = self._data.get(key, default)
        if not isinstance(value, str) or len(value) > _MOST_TEXT or "\0" in value:
            raise _BadKeyError(self._key(key))
        return value

    def truth(self, key: str, *, default: bool) -> bool:
        """Return true or false."""
        value = self._data.get(key, default)
        if not isinstance(value, bool):
            raise _BadKeyError(self._key(key))
        return value

    def items(self, key: str, most: int) -> list[object]:
        """Return a list of bounded length; empty where it is missing or null."""
        value = self._data.get(key)
        if value is None:
            return []
        if not isinstance(value, list) or len(value) > most:
            raise _BadKeyError(self._key(key))
        return value

    def table(self, key: str) -> "_Table":
        """Return an object; an empty one where it is missing."""
        return _Table(self._data.get(key, {}), self._key(key))

    def tables(self, key: str, most: int) -> "list[_Table]":
        """Return a list of objects."""
        return [_Table(item, f"{self._key(key)}[{n}]") for n, item in enumerate(self.items(key, most))]

    def one_of(self, key: str, default: str, allowed: set[str]) -> str:
        """Return one of some words."""
        value = self.text(key, default)
        if value not in allowed:
            raise _BadKeyError(self._key(key))
        return value


def _session(data: _Table, folder: Path) -> CorrelatorSession:
    data.one_of("format", "", {FORMAT})
    if data.number("version", 0, 1e9) > VERSION:
        raise _NewerError
    start_s = data.number("start_s", 0.0, 1e7, 0.0)
    end_s = data.optional_number("end_s", 0.0, 1e7)
    if end_s is not None and end_s <= start_s:
        raise _BadKeyError("end_s")
    sections = tuple(_section(row) for row in data.tables("sections", MOST_SECTIONS))
    return CorrelatorSession(
        a=_recording(data.table("a"), folder),
        b=_recording(data.table("b"), folder),
        sync=_sync(data.table("sync")),
        start_s=start_s,
        end_s=end_s,
        pipe=Pipe(sections, data.optional_number("distance_m", 0.01, 1e5)),
        choice=_choice(data),
        note=data.text("note"),
    )


def _recording(data: _Table, folder: Path) -> RecordingChoice:
    files = data.items("files", _MOST_FILES)
    if not all(isinstance(f, str) and 0 < len(f) <= _MOST_TEXT and "\0" not in f for f in files):
        raise _BadKeyError("files")
    return RecordingChoice(tuple(folder / str(f) for f in files), int(data.number("channel", 0, 63, 0)))


def _sync(data: _Table) -> Sync:
    return Sync(
        SyncKind(data.one_of("kind", SyncKind.UNKNOWN.value, {kind.value for kind in SyncKind})),
        data.number("offset_s", -1e7, 1e7, 0.0),
        data.number("sigma_s", 0.0, 1e4, 0.0),
        data.number("drift_ppm", -MOST_DRIFT_PPM, MOST_DRIFT_PPM, 0.0),
        data.number("at_s", -1e7, 1e7, 0.0),
    )


def _section(data: _Table) -> PipeSection:
    return PipeSection(
        length_m=data.number("length_m", 0.0, 1e5),
        material=data.text("material", "other"),
        diameter_m=data.optional_number("diameter_m", 1e-3, 10.0),
        wall_m=data.optional_number("wall_m", 1e-4, 1.0),
        speed_mps=data.optional_number("speed_mps", 1.0, 10_000.0),
        speed_sigma_mps=data.optional_number("speed_sigma_mps", 0.0, 10_000.0),
        length_sigma_m=data.number("length_sigma_m", 0.0, 1e4, 0.0),
    )


def _choice(data: _Table) -> Choice:
    edges = data.items("band_hz", 2)
    band = None
    if edges:
        pair = _Table({"low": edges[0], "high": edges[-1]}, "band_hz")
        low, high = pair.number("low", 0.1, 1e6), pair.number("high", 0.1, 1e6)
        if len(edges) != 2 or high <= low:
            raise _BadKeyError("band_hz")
        band = Band(low, high, data.truth("without_hum", default=True))
    bend = data.table("dispersion")
    suppressed = tuple(
        Suppressed(row.number("delay_s", -100.0, 100.0), row.number("half_width_s", 1e-6, 10.0), row.text("name"))
        for row in data.tables("suppressed", _MOST_SUPPRESSED)
    )
    kinds = {kind.value for kind in Weighting}
    return Choice(
        weighting=Weighting(data.one_of("weighting", Weighting.MAXIMUM_LIKELIHOOD.value, kinds)),
        band=band,
        dispersion=DispersionChoice(
            bend.number("slope", -0.5, 0.5, 0.0),
            bend.number("sigma", 0.0, 0.5, 0.03),
            bend.optional_number("reference_hz", 0.1, 1e6),
        ),
        suppressed=suppressed,
        divide_resonances=data.truth("divide_resonances", default=False),
    )
