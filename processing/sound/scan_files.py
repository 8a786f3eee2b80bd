"""The files of a pass while they grow: complete, thrown away, or left so that a later pass goes on where it stopped.

A note beside them tells how many rows of each can be relied on, with checksums; it is written after the rows are on the
disc. What a crash left beyond it is cut off, and where anything does not agree the pass begins anew.
"""

import json
import logging
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from processing.errors import LeaklineError
from processing.sound.analysis import FACTS, PART_COLUMNS, ScanPart
from processing.sound.bands import Grid
from processing.sound.rows import Kept, RowFile, disc_errors
from processing.sound.tiles import PLANES, streamed_levels, tile_path, wave_block_count, wave_path

log = logging.getLogger(__name__)

_NOTE = "unfinished.json"
_NOTE_EVERY_S = 5.0  # of work that a power cut may cost


@dataclass(frozen=True)
class Shape:
    """A file of the pass: what its rows are."""

    path: Path
    dtype: npt.DTypeLike
    rows: int
    columns: int | None

    def open(self, kept: Kept | None) -> RowFile:
        """Begin the file, or go on with it."""
        return RowFile(self.path, self.dtype, self.rows, self.columns, kept)


def part_count(grid: Grid) -> int:
    """Return into how many pieces a pass divides the recording."""
    return -(-grid.column_count // PART_COLUMNS)


def file_shapes(folder: Path, grid: Grid, bands: int) -> dict[str, Shape]:
    """Return the files that a pass streams, by name; those of the picture carry plane and level."""
    steps = grid.level_count * grid.level // grid.onset_step
    parts = part_count(grid)
    shapes = {
        "level_db": Shape(folder / "level_db.npy", np.float16, grid.level_count, bands),
        "crest_db": Shape(folder / "crest_db.npy", np.float16, grid.level_count, bands),
        "state": Shape(folder / "state.npy", np.uint8, grid.level_count, None),
        "onset": Shape(folder / "onset.npy", np.uint8, steps, None),
        "wave": Shape(wave_path(folder, 0), np.float16, wave_block_count(grid), 3),
        "facts": Shape(folder / "facts.npy", np.float32, parts, len(FACTS) + 1),
    }
    for plane in PLANES:
        for level, rows in enumerate(streamed_levels(grid)):
            shapes[f"tile_{plane}_{level}"] = Shape(tile_path(folder, plane, level), np.uint8, rows, grid.picture_bins)
    return shapes


class ScanWriter:
    """Appends pieces to the files of a pass.

    Args:
        folder: where they lie.
        grid: how the recording is divided.
        bands: how many bands are measured.
        made_of: names all that the pass depends on; what was left by another one is not gone on with.
        resume: go on with what lies there, and leave there what was done when it ends early.
    """

    def __init__(self, folder: Path, grid: Grid, bands: int, made_of: str, *, resume: bool) -> None:
        self._folder, self._made_of, self._resume = folder, made_of, resume
        self._shapes = file_shapes(folder, grid, bands)
        self._files: dict[str, RowFile] = {}
        self.parts_done = 0
        self._finished = False
        self._noted_s = time.monotonic()
        try:
            if not (resume and self._go_on()):
                self._begin()
        except LeaklineError:
            self.end()
            raise

    def add(self, part: ScanPart, not_finite: int) -> None:
        """Append one piece."""
        for name in ("level_db", "crest_db", "state", "onset", "wave"):
            self._files[name].add(getattr(part, name))
        self._files["facts"].add(np.column_stack([part.facts, [[np.float32(not_finite)]]]))
        for plane, levels in (("max", part.tile_max), ("mean", part.tile_mean)):
            for level, rows in enumerate(levels):
                if (file := self._files.get(f"tile_{plane}_{level}")) is not None:
                    file.add(rows)
        self.parts_done += 1
        if self._resume and time.monotonic() - self._noted_s >= _NOTE_EVERY_S:
            self._note()

    def flush(self) -> None:
        """Let readers of the growing files see what was added."""
        for file in self._files.values():
            file.flush()

    def finish(self) -> None:
        """Take all files into place."""
        for file in self._files.values():
            file.finish()
        self._finished = True
        (self._folder / _NOTE).unlink(missing_ok=True)

    def end(self) -> None:
        """Leave what is not complete for a later pass, or nothing; harmless after :meth:`finish`."""
        try:
            if self._resume and len(self._files) == len(self._shapes) and not self._finished:
                self._note()
        except LeaklineError as error:  # a full disc: the note before still holds
            log.debug("no note of the unfinished pass: %s", error)
        for file in self._files.values():
            if self._resume:
                file.leave()
            else:
                file.discard()

    def _begin(self) -> None:
        (self._folder / _NOTE).unlink(missing_ok=True)
        self.parts_done = 0
        for name, shape in self._shapes.items():
            self._files[name] = shape.open(None)

    def _go_on(self) -> bool:
        note = self._folder / _NOTE
        try:
            told = json.loads(note.read_text(encoding="utf-8"))
            if told["made_of"] != self._made_of:  # of another band or another version
                return self._nothing_left()
            kept = {name: Kept(int(k["rows"]), int(k["crc32"])) for name, k in told["files"].items()}
            for name, shape in self._shapes.items():
                self._files[name] = shape.open(kept[name])
        except FileNotFoundError:
            return self._nothing_left()
        except (OSError, ValueError, KeyError, TypeError, AttributeError, LeaklineError) as error:
            log.warning("the pass begins anew, what is left of the one before is not sound: %s", error)
            return self._nothing_left()
        self.parts_done = self._files["facts"].rows_added
        return True

    def _nothing_left(self) -> bool:
        for file in self._files.values():
            file.leave()
        self._files.clear()
        return False

    def _note(self) -> None:
        kept = {name: asdict(file.flush(to_disc=True)) for name, file in self._files.items()}
        content: dict[str, Any] = {"made_of": self._made_of, "files": kept}
        aside = self._folder / f"{_NOTE}.part"
        with disc_errors(self._folder):
            aside.write_text(json.dumps(content), encoding="utf-8")
            aside.replace(self._folder / _NOTE)
        self._noted_s = time.monotonic()
