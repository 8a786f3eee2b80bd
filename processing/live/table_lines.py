"""Reads lines of comma-separated numbers as they come: the columns of ``imu.csv`` (formats.md), live.

A header line with the contract's names may come first, in any order of columns, with others among them that are
ignored; it may come again, in another order too, when the device starts anew. ``counter``, one more a sample, is read
where a header names it. Where the header was missed, the columns are, by their number:

====== ==============================================================
 6     acc x y z, gyr x y z: no time
 7     time_s, acc x y z (m/s²), gyr x y z (rad/s)
 9     the same seven, pressure_kPa, temperature_C
10     the same seven, mag x y z (µT)
11     the same seven, quat w x y z
12     the same seven, mag, pressure, temperature
13     the same seven, quat, pressure, temperature
14     the same seven, mag, quat
16     the same seven, mag, quat, pressure, temperature
other  from 8 on: the same seven, and what follows is not read
====== ==============================================================

One more cell, last, that goes up by one from line to line is the counter; where a quaternion should stand and none is,
only the seven are read.

There is no checksum: what has another number of cells than the lines around it, or a cell that is no number, is
passed over. Three lines that agree are waited for before a stream without a header is believed.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from processing.importing.frames import Frames
from processing.importing.neutral import NAMES
from processing.importing.text_blocks import drop_absurd
from processing.live.decoded_rows import frames_of, usable_time
from processing.live.frame_rows import joined
from processing.live.text_lines import LineCutter
from processing.survey import FloatArray

_SLOTS: Mapping[str, int] = {name: slot for slot, name in enumerate((*NAMES, "counter"))}
_TIME, _COUNTER = 0, len(NAMES)
_ACC, _GYR, _MAG, _QUAT = slice(1, 4), slice(4, 7), slice(7, 10), slice(10, 14)
_PRESSURE, _TEMPERATURE = 14, 15
_SEVEN = (0, 1, 2, 3, 4, 5, 6)
_DEFAULTS: Mapping[int, tuple[int, ...]] = {
    6: (1, 2, 3, 4, 5, 6),
    9: (*_SEVEN, 14, 15),
    10: (*_SEVEN, 7, 8, 9),
    11: (*_SEVEN, 10, 11, 12, 13),
    12: (*_SEVEN, 7, 8, 9, 14, 15),
    13: (*_SEVEN, 10, 11, 12, 13, 14, 15),
    14: (*_SEVEN, 7, 8, 9, 10, 11, 12, 13),
    16: (*_SEVEN, 7, 8, 9, 10, 11, 12, 13, 14, 15),
}
_QUAT_LENGTH = 0.1  # how far from 1
_FEWEST_CELLS, _MOST_CELLS = 6, 64
_AGREEING = 3  # lines before a table without a header is believed
_OTHERS = 8  # lines in a row of another width before the old one is given up


@dataclass(frozen=True)
class Columns:
    """Which cell of a line holds what: ``cells[i]`` goes to slot ``slots[i]`` of the contract's order."""

    width: int
    cells: tuple[int, ...]
    slots: tuple[int, ...]

    @property
    def time_cell(self) -> int | None:
        """The cell with the device's time, None where there is none."""
        return self.cells[self.slots.index(_TIME)] if _TIME in self.slots else None


def default_columns(width: int) -> Columns | None:
    """Return what lines of ``width`` cells hold where no header was seen; None below six cells."""
    if not _FEWEST_CELLS <= width <= _MOST_CELLS:
        return None
    slots = _DEFAULTS.get(width, _SEVEN)
    return Columns(width, tuple(range(len(slots))), slots)


def columns_like(rows: FloatArray) -> Columns | None:
    """Return what lines hold of which (n, width) were seen, and no header; None where nothing says so.

    Device time must rise, a counter go up by one, and a quaternion have its length.
    """
    width = rows.shape[1]
    is_counted = _goes_up(rows[:, -1], by=1.0)
    if is_counted and width != len(_SEVEN):  # with seven cells, turning about z might count as well
        shorter = default_columns(width - 1)
        columns = shorter and Columns(width, (*shorter.cells, width - 1), (*shorter.slots, _COUNTER))
    else:
        columns = default_columns(width)
    if columns is None or (columns.time_cell is not None and not _goes_up(rows[:, columns.time_cell])):
        return None
    if _QUAT.start in columns.slots:
        first = columns.cells[columns.slots.index(_QUAT.start)]
        with np.errstate(over="ignore", invalid="ignore"):
            lengths = np.sqrt(np.sum(rows[:, first : first + 4] ** 2, axis=1))
        if not (np.abs(lengths - 1.0) < _QUAT_LENGTH).all():
            return Columns(width, _SEVEN, _SEVEN)
    return columns


def _goes_up(values: FloatArray, by: float | None = None) -> bool:
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(values)
    return bool((steps > 0.0).all() if by is None else (steps == by).all())


def header_columns(cells: list[bytes], *, is_torn: bool = False) -> Columns | None:
    """Return what a header line says; None where it is none, or does not name all six inertial columns.

    Of one that ``is_torn`` the first name may lack its beginning; it is taken for the only one that it can be.
    """
    if not _FEWEST_CELLS <= len(cells) <= _MOST_CELLS:
        return None
    found: dict[int, int] = {}
    names = [cell.removeprefix(b"\xef\xbb\xbf").strip(b' \t"').decode("ascii", "replace").casefold() for cell in cells]
    for number, name in enumerate(names):
        if name in _SLOTS:
            found.setdefault(_SLOTS[name], number)
    if is_torn and names[0] not in _SLOTS:
        endings = [slot for name, slot in _SLOTS.items() if slot not in found and name.endswith(names[0])]
        if len(endings) > 1:
            return None
        found |= dict.fromkeys(endings, 0)
    if not all(slot in found for slot in range(1, 7)):
        return None
    return Columns(len(cells), tuple(found.values()), tuple(found))


class TableLinesDecoder:
    """Finds rows in a stream of such lines, however it is cut."""

    name = "csv"

    def __init__(self) -> None:
        self._cutter = LineCutter()
        self._columns: Columns | None = None
        self._is_settled = False
        self._rows: list[list[float]] = []
        self._lengths: list[int] = []
        self._done: list[Frames] = []
        self._torn: tuple[list[float], int] | None = None  # the first line, if it may lack its beginning
        self._waiting: list[tuple[list[float], int]] = []
        self._others = 0
        self._count = 0
        self._garbage = 0
        self.bad_sums = 0

    @property
    def has_time(self) -> bool:
        """Whether the rows that came last hold the device's time."""
        return self._columns is not None and self._columns.time_cell is not None

    @property
    def has_counter(self) -> bool:
        """Whether the rows that came last hold the device's counter; else they are counted here."""
        return self._columns is not None and _COUNTER in self._columns.slots

    @property
    def garbage_bytes(self) -> int:
        """How many bytes were in no row and no header."""
        return self._garbage + self._cutter.garbage_bytes

    def feed(self, data: bytes) -> Frames:
        """Return the rows that are complete now."""
        lines = self._cutter.feed(data)
        is_torn = self._cutter.starts_torn
        for line in lines:
            cells = _cells(line)
            row = _numbers(cells) if self._is_settled and len(cells) == self._width and not is_torn else None
            if row is None:
                self._other_line(cells, len(line) + 1, is_torn=is_torn)
            else:
                self._rows.append(row)
                self._lengths.append(len(line) + 1)
                self._others = 0
            is_torn = False
        self._flush()
        done, self._done = self._done, []
        return joined(done)

    def restart(self) -> None:
        """Begin in the middle of a line again: the device was away. What its columns hold is remembered."""
        self._cutter.restart()
        self._unsettle()

    @property
    def _width(self) -> int:
        return self._columns.width if self._columns else 0

    def _unsettle(self) -> None:
        self._garbage += sum(length for _, length in self._waiting) + (self._torn[1] if self._torn else 0)
        self._waiting, self._torn, self._others, self._is_settled = [], None, 0, False

    def _other_line(self, cells: list[bytes], length: int, *, is_torn: bool) -> None:
        columns = header_columns(cells, is_torn=is_torn)
        if columns is not None:
            self._flush()
            self._unsettle()
            self._columns, self._is_settled = columns, True
            return
        row = _numbers(cells) if _FEWEST_CELLS <= len(cells) <= _MOST_CELLS else None
        if row is None:
            self._garbage += length
        elif is_torn:
            self._torn = (row, length)
        elif self._is_settled:
            self._garbage += length
            self._others += 1
            if self._others >= _OTHERS:
                self._flush()
                self._unsettle()
        else:
            self._wait(row, length)

    def _wait(self, row: list[float], length: int) -> None:
        """Gather lines until enough of them agree on what they are."""
        if self._waiting and len(self._waiting[0][0]) != len(row):
            self._unsettle()
        self._waiting.append((row, length))
        if len(self._waiting) < _AGREEING:
            return
        known = self._columns if self._width == len(row) else None
        columns = known or columns_like(np.array([r for r, _ in self._waiting]))
        if columns is None:
            self._garbage += self._waiting.pop(0)[1]
            return
        times = [r[columns.time_cell] for r, _ in self._waiting] if columns.time_cell is not None else []
        self._columns, self._is_settled = columns, True
        if self._torn is not None and self._fits(self._torn[0], times):
            self._waiting.insert(0, self._torn)
        elif self._torn is not None:
            self._garbage += self._torn[1]
        self._rows += [r for r, _ in self._waiting]
        self._lengths += [n for _, n in self._waiting]
        self._waiting, self._torn, self._others = [], None, 0

    def _fits(self, row: list[float], times: list[float]) -> bool:
        """Whether a line that may lack its beginning has the time that it must have: nothing was cut off then."""
        assert self._columns is not None
        if not times or len(row) != self._columns.width or self._columns.time_cell != 0:
            return False
        return 0.0 < times[0] - row[0] <= 2.0 * max(times[1] - times[0], times[2] - times[1])

    def _flush(self) -> None:
        """Make frames of the rows that were gathered under the columns of now."""
        if not self._rows:
            return
        assert self._columns is not None
        lengths = np.array(self._lengths)
        table = np.full((len(self._rows), _COUNTER + 1), np.nan)
        table[:, self._columns.slots] = np.array(self._rows)[:, self._columns.cells]
        self._rows, self._lengths = [], []
        drop_absurd(table[:, 1:_COUNTER])
        if not self.has_time:
            table[:, _TIME] = 0.0
        good = usable_time(table[:, _TIME]) & np.isfinite(table[:, 1:7]).any(axis=1)
        if not good.all():
            self._garbage += int(lengths[~good].sum())
            table = table[good]
        self._done.append(self._frames(table))

    def _frames(self, table: FloatArray) -> Frames:
        counter = self._count + np.arange(len(table))
        if self.has_counter:
            sent = table[:, _COUNTER]
            is_number = usable_time(sent)
            counter = np.where(is_number, sent, 0.0).astype(np.int64)
        self._count += len(table)
        return frames_of(
            table[:, _TIME],
            table[:, _ACC],
            table[:, _GYR],
            counter,
            mag_s_ut=table[:, _MAG],
            quat_ws=table[:, _QUAT],
            pressure_kpa=table[:, _PRESSURE],
            temperature_c=table[:, _TEMPERATURE],
        )


def _cells(line: bytes) -> list[bytes]:
    if b"," in line:
        return line.split(b",")
    return line.split(b";" if b";" in line else b"\t")


def _numbers(cells: list[bytes]) -> list[float] | None:
    """Return the cells as numbers, NaN for empty ones; None where one is no number."""
    try:
        return list(map(float, cells))
    except ValueError:
        pass
    try:
        return [float(cell) if cell.strip() else float("nan") for cell in cells]
    except ValueError:
        return None
