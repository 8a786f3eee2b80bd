"""Reads the printed lines of the recorder of P0 and P3 as they come, with or without a time before the values.

``Accelerometer(xyz)=…, Gyroscope(xyz)=…, Magnetometer(xyz)=…---`` in g, °/s and µT (methods.md §5), other prints
among them. There is no checksum: a line that has not the form of those around it is passed over.
"""

import re
from typing import NamedTuple

import numpy as np

from processing.importing.frames import Frames
from processing.importing.printed_log import LINE
from processing.importing.text_blocks import drop_absurd
from processing.importing.units import factor
from processing.live.decoded_rows import frames_of, usable_time
from processing.live.frame_rows import joined, no_frames
from processing.live.printed_stamps import StampForm, form_of, may_hold_time, without_midnights
from processing.live.text_lines import LineCutter

_BEGINNING = re.compile(rb"acc(?:elerometer)?[ \t]*\(", re.IGNORECASE)
_PRINTABLE = bytes(range(0x20, 0x7F)) + b"\t"
_AGREEING = 3  # lines before a stream is believed
_STAMPED = 12  # lines before it is decided what a number before the values is
_OTHERS = 8  # lines in a row of another form before the old one is given up


class _Row(NamedTuple):  # not a dataclass: a thousand a second are made
    before: bytes
    values: list[float]  # 9, those of the field NaN where there is none
    form: tuple[bool, bytes]  # whether there is a field, and what ends the line
    length: int


class PrintedLinesDecoder:
    """Finds rows in a stream of such lines, however it is cut."""

    name = "printed"
    has_counter = False

    def __init__(self) -> None:
        self._cutter = LineCutter()
        self._stamps: StampForm | None = None
        self._last_s: float | None = None
        self._form: tuple[bool, bytes] | None = None
        self._is_settled = False
        self._torn: _Row | None = None
        self._waiting: list[_Row] = []
        self._others = 0
        self._count = 0
        self._garbage = 0
        self.bad_sums = 0

    @property
    def has_time(self) -> bool:
        """Whether the rows that came last hold the device's time."""
        return self._stamps is not None and self._stamps.has_time

    @property
    def garbage_bytes(self) -> int:
        """How many bytes were in no row and no other print."""
        return self._garbage + self._cutter.garbage_bytes

    def feed(self, data: bytes) -> Frames:
        """Return the rows that are complete now."""
        lines = self._cutter.feed(data)
        is_torn = self._cutter.starts_torn
        done: list[Frames] = []
        rows: list[_Row] = []
        for line in lines:
            row = _row_of(line)
            if row is None:
                is_print = not line.translate(None, _PRINTABLE) and not _BEGINNING.search(line)
                self._garbage += 0 if is_print or is_torn else len(line) + 1
            elif is_torn:
                self._torn = row
            elif self._is_settled and row.form == self._form:
                rows.append(row)
                self._others = 0
            elif self._is_settled:
                self._garbage += row.length
                self._others += 1
                if self._others >= _OTHERS:
                    done.append(self._frames(rows))
                    rows = []
                    self._unsettle()
                    self._stamps = None
            else:
                self._waiting.append(row)
                rows += self._settle()
            is_torn = False
        done.append(self._frames(rows))
        return joined(done)

    def restart(self) -> None:
        """Begin in the middle of a line again: the device was away. What its lines look like is remembered."""
        self._cutter.restart()
        self._unsettle()

    def _unsettle(self) -> None:
        self._garbage += sum(row.length for row in self._waiting) + (self._torn.length if self._torn else 0)
        self._waiting, self._torn, self._others, self._is_settled = [], None, 0, False

    def _settle(self) -> list[_Row]:
        """Return the lines that were waiting, once enough of them agree on what they are."""
        last = self._waiting[-1]
        if self._waiting[0].form != last.form:
            self._garbage += sum(row.length for row in self._waiting[:-1])
            self._waiting = [last]
        is_stamped = self._stamps is None and may_hold_time(last.before)
        if len(self._waiting) < (_STAMPED if is_stamped else _AGREEING):
            return []
        if self._stamps is None:
            self._stamps = form_of([row.before for row in self._waiting])
        rows, self._waiting, self._others = self._waiting, [], 0
        self._form, self._is_settled = last.form, True
        torn, self._torn = self._torn, None
        if torn is not None and torn.form == self._form and self._fits(torn, rows):
            return [torn, *rows]
        self._garbage += torn.length if torn else 0
        return rows

    def _fits(self, torn: _Row, rows: list[_Row]) -> bool:
        """Whether a line that may lack its beginning has the time that it must have: nothing was cut off then."""
        assert self._stamps is not None
        if not self._stamps.has_time:
            return True
        before, *times = self._stamps.seconds([row.before for row in [torn, *rows]]).tolist()
        return bool(0.0 < times[0] - before <= 2.0 * max(times[1] - times[0], times[2] - times[1]))

    def _frames(self, rows: list[_Row]) -> Frames:
        if not rows:
            return no_frames()
        stamps = self._stamps or StampForm()
        time_s = stamps.seconds([row.before for row in rows])
        if stamps.is_clock:
            time_s = without_midnights(time_s, self._last_s)
        good = usable_time(time_s)
        if not good.all():
            self._garbage += sum(row.length for row, is_good in zip(rows, good, strict=True) if not is_good)
        values = np.array([row.values for row in rows], dtype=np.float64).reshape(-1, 9)[good]
        drop_absurd(values)
        time_s = time_s[good]
        if len(time_s):
            self._last_s = float(time_s[-1])
        counter = self._count + np.arange(len(values))
        self._count += len(values)
        return frames_of(
            time_s,
            values[:, 0:3] * factor("acc", "g"),
            values[:, 3:6] * factor("gyr", "dps"),
            counter,
            mag_s_ut=values[:, 6:9],
        )


def _row_of(line: bytes) -> _Row | None:
    """Return what a line holds; None where it is none, was broken off, or is two that ran into one another."""
    match = LINE.match(line)
    if match is None or (line.lower().count(b"acc") > 1 and len(_BEGINNING.findall(line)) > 1):
        return None
    has_field = match[8] is not None
    numbers = match.groups()[1 : 10 if has_field else 7]
    try:
        values = [float(number) for number in numbers]
    except ValueError:
        return None
    end = line[match.end() :].strip()
    return _Row(match[1], values if has_field else values + [float("nan")] * 3, (has_field, end), len(line) + 1)
