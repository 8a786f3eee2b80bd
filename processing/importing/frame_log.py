"""A file of Leakline's binary frames (``.lkf``), or several that continue each other: see :mod:`.frames`.

A recording of hours is in parts ``imu-001.lkf``, ``imu-002.lkf`` …: each goes on where the one before ended.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.frames import FrameDecoder, Frames
from processing.importing.raw import GrowingArray, RawImu, ReadContext
from processing.importing.sound_files import parts_from
from processing.importing.streams import decoded
from processing.importing.text_layout import TextLayout
from processing.survey import Finding, FloatArray, Severity

SUFFIX = ".lkf"
_HEAD_BYTES = 1 << 16
_FEWEST = 3
_COUNTER_SPAN = 1 << 32
_LONGEST_PAUSE_S = 86_400.0  # between parts of one recording
_FASTEST_HZ = 2000.0
_COLUMNS = (
    ("acc_s_mps2", 3),
    ("gyr_s_radps", 3),
    ("mag_s_ut", 3),
    ("quat_ws", 4),
    ("pressure_kpa", 0),
    ("temperature_c", 0),
)


def sniff(path: Path, _layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that the file holds such frames."""
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    return 1.0 if len(FrameDecoder().feed(head)) >= _FEWEST else 0.0


def parts_of(first: Path) -> tuple[Path, ...]:
    """Return ``first`` and the files beside it that continue it by their names: the last number goes up by one."""
    try:
        beside = [f for f in first.parent.iterdir() if f.suffix.casefold() == SUFFIX]
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(first), reason=fault.strerror or str(fault)) from None
    return parts_from(first, [f for f in beside if f.is_file()])


def first_of(path: Path, files: Sequence[Path]) -> Path:
    """Return the first part of the series that a file belongs to."""
    for file in files:
        if file.suffix.casefold() == SUFFIX and file.parent == path.parent and path in parts_from(file, files):
            return file
    return path


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the rows of the file and of the parts that continue it; their times are the device's, from the first on.

    A part whose times do not go on is not of this recording: it is left, with a finding. A preview reads the first.

    Raises:
        LeaklineError: FILE_UNREADABLE, and where no frame is in it.
    """
    decoder = FrameDecoder()
    stores = {name: GrowingArray(width, context.scratch) for name, width in _COLUMNS}
    times, counters = GrowingArray(0, context.scratch), GrowingArray(0, context.scratch)
    is_known = dict.fromkeys(stores, False)
    first_us, rows = None, 0
    series = _Series(path, context)
    for frames in series.frames(decoder):
        if first_us is None and len(frames):
            first_us = int(frames.time_us[0])
        for name, store in stores.items():
            values = getattr(frames, name)
            is_known[name] |= bool(np.isfinite(values).any())
            store.append(values.astype(np.float64))
        times.append(np.asarray(1e-6 * (frames.time_us - np.uint64(first_us or 0)).astype(np.int64), np.float64))
        counters.append(frames.counter.astype(np.float64))
        rows += len(frames)
    if not rows:
        raise LeaklineError(
            ErrorCode.FILE_UNREADABLE, Place(path), reason="no frame of Leakline's binary form is in it"
        )
    columns: dict[str, FloatArray] = {name: store.finish() for name, store in stores.items()}
    optional = {name: columns[name] if is_known[name] else None for name in is_known}
    raw = RawImu(
        times.finish(),
        columns["acc_s_mps2"],
        columns["gyr_s_radps"],
        mag=optional["mag_s_ut"],
        quat=optional["quat_ws"],
        pressure=optional["pressure_kpa"],
        temperature=optional["temperature_c"],
        counter=_unwrapped(counters.finish()),
        time_unit="s",
        acc_unit="mps2",
        gyr_unit="radps",
        mag_unit="ut",
    )
    if decoder.garbage_bytes:
        params = {"bytes": decoder.garbage_bytes, "bad_sums": decoder.bad_sums}
        raw.findings.append(Finding("frames_garbage", Severity.MASKED, params))
    raw.files += series.used[1:]
    if series.left:
        names = {"chosen": path.name, "others": ", ".join(file.name for file in series.left)[:300]}
        raw.findings.append(Finding("several_imu_logs", Severity.WARNING, names))
    return raw


class _Series:
    """The parts of one recording, in order: ``used`` are those that were read, ``left`` those that do not go on."""

    def __init__(self, first: Path, context: ReadContext) -> None:
        self.used: list[Path] = list(parts_of(first))
        self.left: list[Path] = []
        self._context = context
        self._last: tuple[int, int] | None = None  # time, counter

    def frames(self, decoder: FrameDecoder) -> Iterator[Frames]:
        """Yield the frames of all parts; a preview's are those of the first."""
        total = len(self.used)
        for nth, part in enumerate(list(self.used) if self._context.max_bytes is None else self.used[:1]):
            progress = self._context.progress.part(nth / total, (nth + 1) / total)
            is_first_block = True
            for frames in decoded(part, decoder, replace(self._context, progress=progress)):
                if not len(frames):
                    continue
                if is_first_block and not self._goes_on(frames):
                    self.used, self.left = self.used[:nth], self.used[nth:]
                    return
                is_first_block = False
                self._last = int(frames.time_us[-1]), int(frames.counter[-1])
                yield frames

    def _goes_on(self, frames: Frames) -> bool:
        """Whether a part begins where the one before ended, by its time and its counter."""
        if self._last is None:
            return True
        pause_s = 1e-6 * (int(frames.time_us[0]) - self._last[0])
        counted = (int(frames.counter[0]) - self._last[1]) % _COUNTER_SPAN
        return 0.0 < pause_s <= _LONGEST_PAUSE_S and 1 <= counted <= _FASTEST_HZ * pause_s + _FEWEST


def _unwrapped(counter: FloatArray) -> FloatArray:
    """Return the counter without its jumps from 4294967295 to 0."""
    if len(counter) < 2:
        return counter
    turns = np.cumsum(np.diff(counter, prepend=counter[0]) < -0.5 * _COUNTER_SPAN)
    counter += _COUNTER_SPAN * turns
    return counter
