"""The computer's memory of digs over all surveys: one append-only file of JSON lines, synced, that survives damage.

Each line is what one revision of a survey's dig log said of one leak; the highest revision of a survey's number counts,
so that a correction replaces, and what was taken back disappears, whatever the clocks of the computers said. Lines that
cannot be read are skipped and counted. Nothing personal is in it beyond the survey's name. Files of several computers
are put together by :meth:`HistoryFile.take_in`. Simulated surveys are left out: nobody digs there.
"""

import errno
import os
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.review_facts import DigResult
from processing.sound.presets import AUTO, chosen, shipped
from processing.storage.digs import DigEntry
from processing.storage.files import reading, sync_folder, writing
from processing.storage.plain import from_json, to_json
from processing.survey import ProcessingChoice, Survey

FILE_NAME = "dig-history.jsonl"
MAX_BYTES = 32_000_000  # a hundred thousand digs
_LONGEST_LINE = 20_000
_LARGEST = 1e6  # metres or litres: no dig has more
_DIAMETERS_MM = (110, 300, 600)
ANY = "*"
OTHER = "other"


@dataclass(frozen=True)
class DigKind:
    """What kind of pipe and run a dig belongs to: errors are compared within a kind only.

    ``material`` is a row of the table of pipes, ``other`` or empty where not told; ``diameter_mm`` the upper end of its
    class (0: not told, 9999: the largest); ``tied`` says that enabled tie points held the path.
    """

    motion: str
    material: str = ""
    diameter_mm: int = 0
    tied: bool = False

    def pools(self) -> tuple[str, ...]:
        """Return the names of the pools that a dig of this kind belongs to, the narrowest first."""
        material, diameter, tied = self.material or "?", str(self.diameter_mm or "?"), "tied" if self.tied else "free"
        return (
            f"{self.motion}/{material}/{diameter}/{tied}",
            f"{self.motion}/{material}/{ANY}/{tied}",
            f"{self.motion}/{ANY}/{ANY}/{tied}",
            f"{self.motion}/{ANY}/{ANY}/{ANY}",
        )


@dataclass(frozen=True)
class HistoryEntry:
    """One line: what revision ``revision`` of a survey's log said of leak ``number``; ``dig`` None: taken back."""

    survey: str  # SurveyFolder.identity
    name: str
    number: int
    revision: int
    kind: DigKind
    dig: DigResult | None

    @property
    def key(self) -> tuple[str, int]:
        """What is corrected by a later line with the same."""
        return self.survey, self.number


@dataclass(frozen=True)
class HistoryRead:
    """What counts, and how many lines could not be read."""

    digs: tuple[HistoryEntry, ...]  # the newest of each leak that was not taken back
    damaged: int = 0


def kind_of(survey: Survey) -> DigKind:
    """Return the kind of a survey's pipe and run, as its form has it."""
    pipe = replace(survey.pipe, diameter_m=None)
    row = chosen(shipped(), replace(survey, pipe=pipe, processing=ProcessingChoice(preset=AUTO)))
    material = row.key if row is not None else OTHER if survey.pipe.material.strip() else ""
    diameter = 0
    if survey.pipe.diameter_m is not None:
        diameter = next((mm for mm in _DIAMETERS_MM if 1000 * survey.pipe.diameter_m <= mm + 0.5), 9999)
    return DigKind(survey.device.motion.value, material, diameter, any(t.enabled for t in survey.tie_points))


class HistoryFile:
    """The history in one file, which need not be there yet. Every write is on disc before the call returns."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> HistoryRead:
        """Return the digs that count.

        Raises:
            LeaklineError: FILE_UNREADABLE, FILE_TOO_LARGE.
        """
        entries, damaged = _lines(self.path) if self.path.exists() else ((), 0)
        newest = _newest(entries)
        return HistoryRead(tuple(entry for entry in newest.values() if entry.dig is not None), damaged)

    def take(self, identity: str, survey: Survey, log: Sequence[DigEntry], entered: Collection[int] = ()) -> int:
        """Take a survey's log of digs; return how many lines that added: none for what is known already.

        An older copy of a survey changes nothing, as its log is shorter. What was ``entered`` just now, by number,
        counts over all that is known, however short the log: the survey may have come back from a backup. Raises as
        :meth:`read`, and DISC_FULL, CANNOT_WRITE.
        """
        if survey.info.simulated or not log:
            return 0
        known = _newest(_lines(self.path)[0]) if self.path.exists() else {}
        kind, found = kind_of(survey), []
        for number in sorted({entry.number for entry in log}):
            rows = [entry for entry in log if entry.number == number]
            entry = HistoryEntry(identity, survey.info.name, number, len(rows), kind, _impersonal(rows[-1].result))
            before = known.get(entry.key)
            if before is not None and number in entered and entry.dig != before.dig:
                entry = replace(entry, revision=max(entry.revision, before.revision + 1))
            if before is None or entry.revision > before.revision:
                found.append(entry)
            elif entry.revision == before.revision:
                # whether tie points held the path stays as it was when the dig was entered
                described = replace(before, name=entry.name, kind=replace(kind, tied=before.kind.tied))
                found += [described] if described != before else []
        self._append(found)
        return len(found)

    def write_out(self, path: Path) -> int:
        """Write what is known to another file, for another computer; return how many digs that are.

        What was taken back goes along, so that it disappears there too. Raises as :meth:`take`.
        """
        entries = tuple(_newest(_lines(self.path)[0]).values()) if self.path.exists() else ()
        with writing(path), path.open("wb") as file:
            file.write("".join(f"{to_json(entry)}\n" for entry in entries).encode())
            file.flush()
            os.fsync(file.fileno())
        return sum(entry.dig is not None for entry in entries)

    def take_in(self, path: Path) -> HistoryRead:
        """Take what another computer wrote out; return the digs that were new or newer here, and damaged lines.

        Raises as :meth:`take`, and FILE_MISSING; a file without one readable line is FILE_UNREADABLE.
        """
        entries, damaged = _lines(path)
        if damaged and not entries:
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason="no line of it is a dig")
        known = _newest(_lines(self.path)[0]) if self.path.exists() else {}
        found = [
            entry
            for entry in _newest(entries).values()
            if entry.key not in known or entry.revision > known[entry.key].revision
        ]
        self._append(found)
        return HistoryRead(tuple(found), damaged)

    def _append(self, entries: Sequence[HistoryEntry]) -> None:
        if not entries:
            return
        text = "".join(f"{to_json(entry)}\n" for entry in entries).encode()
        with writing(self.path):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab", buffering=0) as file:  # one write: two windows do not mix their lines
                line = b"\n" + text if _ends_torn(self.path) else text
                if file.write(line) != len(line):  # a raw file tells of a full disc by writing less
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
                os.fsync(file.fileno())
            sync_folder(self.path.parent)


def _impersonal(result: DigResult | None) -> DigResult | None:
    """Return the figures of a dig without its people, notes and moments."""
    if result is None:
        return None
    return replace(result, note="", operator="", dug_by="", at_utc="", cause="")


def _newest(entries: Iterable[HistoryEntry]) -> dict[tuple[str, int], HistoryEntry]:
    newest: dict[tuple[str, int], HistoryEntry] = {}
    for entry in entries:
        if entry.key not in newest or entry.revision >= newest[entry.key].revision:
            newest[entry.key] = entry
    return newest


def _lines(path: Path) -> tuple[tuple[HistoryEntry, ...], int]:
    with reading(path):
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), size_mb=size / 1e6, limit_mb=MAX_BYTES / 1e6)
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    entries, damaged = [], 0
    for line in text.split("\n"):
        if not line.strip():
            continue
        entry = _entry(line)
        if entry is None:
            damaged += 1
        else:
            entries.append(entry)
    return tuple(entries), damaged


def _entry(line: str) -> HistoryEntry | None:
    """Return what a line says, None where it is damaged."""
    if len(line) > _LONGEST_LINE:
        return None
    try:
        entry = from_json(HistoryEntry, line)
    except ValueError:  # what another writer, or half a write, left: told by the count
        return None
    values = () if entry.dig is None else vars(entry.dig).values()
    sound = all(abs(value) <= _LARGEST for value in values if isinstance(value, float))  # NaN is not either
    return entry if sound else None


def _ends_torn(path: Path) -> bool:
    """Tell whether the last line has no end: a write that was cut short."""
    with path.open("rb") as file:
        if file.seek(0, os.SEEK_END) == 0:
            return False
        file.seek(-1, os.SEEK_END)
        return file.read(1) != b"\n"
