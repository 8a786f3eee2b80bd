"""One streamed pass over a recording builds everything that later steps and views need, in bounded memory.

The result lies in a folder of .npy files (no pickles) and is memory-mapped, so twelve hours cost no more RAM than one.
"""

import json
import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress, silent
from processing.settings import SoundSettings
from processing.sound.analysis import CLIPPED, DROPOUT, SILENT, Analyser, Bytes, Halves, ScanPart
from processing.sound.bands import Grid
from processing.sound.pcm import Samples
from processing.sound.rows import RowFile, disc_errors, load_rows
from processing.sound.source import AudioReader
from processing.sound.tiles import (
    TilePyramid,
    WavePyramid,
    build_upper_levels,
    load_pyramids,
    tile_path,
    wave_block_count,
    wave_path,
)
from processing.survey import AudioSource, Channel, ClockMap, Finding, FloatArray, Severity, Stretch

VERSION = 1  # of what lies in the folder; part of its description, so that older folders are rebuilt
_INDEX = "scan.json"
_COLUMNS_PER_JOB = 32  # about 6 s: large enough for threads, small enough for memory and for a quick stop
_MAX_THREADS = 4
_JOIN_S = 1.0  # troubles closer than this are one stretch
_MIN_STRETCH_S = 0.5  # a shorter trouble is counted, not reported as a stretch
_DEAD_SHARE = 0.9
_REASONS = ((SILENT, "sound_silent"), (DROPOUT, "sound_dropout"), (CLIPPED, "sound_clipped"))


@dataclass(frozen=True)
class SoundScan:
    """What one pass measured, memory-mapped; all times are on the audio clock, levels in dBFS.

    Row ``t`` of the level series covers ``t·frame_s`` to ``(t + 1)·frame_s``. The last band is the chosen one.
    ``crest_db`` tells how far the mean stands above the median: over the frame's windows in bands above 1 kHz
    (impulses), over the band's bins below (tones). ``state`` holds the bits SILENT, DROPOUT and CLIPPED.
    """

    folder: Path
    grid: Grid
    bands_hz: FloatArray  # (b + 1, 2)
    level_db: Halves  # (t, b + 1)
    crest_db: Halves  # (t, b + 1)
    state: Bytes  # (t,)
    onset: Bytes  # (k,) high-passed energy in steps of 0.5 dB above −130 dBFS, for the clock
    tiles: TilePyramid
    wave: WavePyramid
    findings: tuple[Finding, ...]

    @property
    def frame_s(self) -> float:
        """Seconds in a level frame."""
        return self.grid.level_s

    @property
    def duration_s(self) -> float:
        """Length of the recording on the audio clock."""
        return self.grid.frames / self.grid.sample_rate_hz

    @property
    def onset_step_s(self) -> float:
        """Seconds a step of the onset series."""
        return self.grid.onset_step / self.grid.sample_rate_hz

    def frame_times_s(self) -> FloatArray:
        """Return the middle (t,) of each level frame on the audio clock."""
        return (np.arange(len(self.state), dtype=np.float64) + 0.5) * self.frame_s

    def stretches(self, clock: ClockMap) -> tuple[Stretch, ...]:
        """Return where the sound cannot be assessed, in survey time: silent, dropped out or clipped."""
        found: list[Stretch] = []
        for bit, reason in _REASONS:
            for start, end in self._spans(bit):
                times = clock.to_survey(np.array([start, end]))
                found.append(Stretch(float(times[0]), float(times[1]), Channel.SOUND, reason))
        return tuple(sorted(found, key=lambda s: (s.start_s, s.reason)))

    def _spans(self, bit: int) -> list[tuple[float, float]]:
        bad = np.flatnonzero(np.asarray(self.state) & bit)
        if not len(bad):
            return []
        join = max(1, round(_JOIN_S / self.frame_s))
        groups = np.split(bad, np.flatnonzero(np.diff(bad) > join) + 1)
        spans = ((int(g[0]) * self.frame_s, (int(g[-1]) + 1) * self.frame_s, len(g) * self.frame_s) for g in groups)
        # frames scattered over a long while are not one bad stretch: they are masked one by one
        return [(a, b) for a, b, held in spans if b - a >= _MIN_STRETCH_S and held >= 0.3 * (b - a)]

    @classmethod
    def load(cls, folder: Path) -> "SoundScan":
        """Return the scan in ``folder``.

        Raises:
            LeaklineError: FILE_UNREADABLE where it is missing, incomplete, damaged or of another version: scan again.
        """
        try:
            return _loaded(folder)
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(folder), reason=f"no usable scan: {error}") from error


def scan(
    source: AudioSource,
    settings: SoundSettings,
    progress: Progress | None = None,
    out_dir: Path | None = None,
    threads: int | None = None,
) -> SoundScan:
    """Pass once over ``source`` and return what was measured; the files are left in ``out_dir``.

    Args:
        source: the recording.
        settings: the chosen band.
        progress: told about every six seconds of sound; may cancel.
        out_dir: where the files go; made when missing. Nothing in it counts until the pass is complete.
        threads: how many analyse at once; by default as many as there are processors, at most four.

    Raises:
        LeaklineError: AUDIO_UNREADABLE, SETTING_INVALID, DISC_FULL, CANNOT_WRITE.
        Cancelled: the operator stopped it; no file is left half-written.
    """
    if out_dir is None:
        raise ValueError("scan needs a folder for its result")
    progress = progress or silent()
    grid = Grid(source.sample_rate_hz, source.frames)
    analyser = Analyser(grid, settings)
    with disc_errors(out_dir):
        out_dir.mkdir(parents=True, exist_ok=True)
        (out_dir / _INDEX).unlink(missing_ok=True)
    writer = _ScanWriter(out_dir, grid, len(analyser.bands_hz))
    try:
        with AudioReader(source) as reader:
            columns_done = 0
            for part in _analysed(reader, source.frames, analyser, threads or min(os.cpu_count() or 1, _MAX_THREADS)):
                writer.add(part)
                columns_done += len(part.tile_max)
                progress.update(0.97 * min(1.0, columns_done / grid.column_count), "sound_scanning")
            not_finite = reader.not_finite
        state = writer.finish()
    finally:
        writer.discard()
    build_upper_levels(out_dir, grid)
    progress.update(0.99, "sound_scanning")
    findings = _findings(state, grid, not_finite)
    _write_index(out_dir, grid, analyser.bands_hz, findings)
    progress.update(1.0, "sound_scanning")
    return SoundScan.load(out_dir)


def _analysed(reader: AudioReader, frames: int, analyser: Analyser, threads: int) -> Iterator[ScanPart]:
    """Yield the parts in order; a few are worked on at a time, so memory does not grow with the recording."""
    jobs = _pieces(reader, frames, analyser)
    if threads == 1:
        for samples in jobs:
            yield analyser.analyse(samples, _COLUMNS_PER_JOB)
        return
    with ThreadPoolExecutor(threads, "sound-scan") as pool:
        waiting: deque[Future[ScanPart]] = deque()
        try:
            for samples in jobs:
                waiting.append(pool.submit(analyser.analyse, samples, _COLUMNS_PER_JOB))
                if len(waiting) > threads:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for job in waiting:
                job.cancel()


def _pieces(reader: AudioReader, frames: int, analyser: Analyser) -> Iterator[Samples]:
    """Yield the sound in jobs with context on either side; before the start and after the end there are zeros."""
    size, context = _COLUMNS_PER_JOB * analyser.grid.column, analyser.context
    tail = np.zeros(2 * context, np.float32)
    position = 0  # of the next sample to read; the tail ends here
    head = reader.read(0, min(context, frames))
    tail[context : context + len(head)] = head
    position = context
    while position - context < frames:
        fresh = reader.read(min(position, frames), max(0, min(size, frames - position)))
        piece = np.zeros(size + 2 * context, np.float32)
        piece[: 2 * context] = tail
        piece[2 * context : 2 * context + len(fresh)] = fresh
        yield piece
        tail = piece[size:].copy()
        position += size


class _ScanWriter:
    """The files that grow during the pass."""

    def __init__(self, folder: Path, grid: Grid, bands: int) -> None:
        self._files: dict[str, RowFile] = {}
        self._state: list[Bytes] = []
        self._levels = grid.level_count
        steps = grid.level_count * grid.level // grid.onset_step
        shapes: tuple[tuple[str, Path, Any, int, int | None], ...] = (
            ("level_db", folder / "level_db.npy", np.float16, grid.level_count, bands),
            ("crest_db", folder / "crest_db.npy", np.float16, grid.level_count, bands),
            ("state", folder / "state.npy", np.uint8, grid.level_count, None),
            ("onset", folder / "onset.npy", np.uint8, steps, None),
            ("wave", wave_path(folder, 0), np.float16, wave_block_count(grid), 3),
            ("tile_max", tile_path(folder, "max", 0), np.uint8, grid.column_count, grid.picture_bins),
            ("tile_mean", tile_path(folder, "mean", 0), np.uint8, grid.column_count, grid.picture_bins),
        )
        try:
            for name, path, dtype, rows, columns in shapes:
                self._files[name] = RowFile(path, dtype, rows, columns)
        except LeaklineError:
            self.discard()
            raise

    def add(self, part: ScanPart) -> None:
        """Append one part."""
        for name, file in self._files.items():
            file.add(getattr(part, name))
        self._state.append(part.state)

    def finish(self) -> Bytes:
        """Take all files into place and return the states of all level frames."""
        for file in self._files.values():
            file.finish()
        return np.concatenate(self._state)[: self._levels]

    def discard(self) -> None:
        """Remove what is not complete."""
        for file in self._files.values():
            file.discard()


def _findings(state: Bytes, grid: Grid, not_finite: int) -> tuple[Finding, ...]:
    found: list[Finding] = []
    seconds = {bit: float(np.count_nonzero(state & bit) * grid.level_s) for bit, _ in _REASONS}
    share = {bit: float(np.count_nonzero(state & bit) / len(state)) for bit, _ in _REASONS}
    if max(share[SILENT], share[DROPOUT]) >= _DEAD_SHARE:
        found.append(Finding("audio_dead", Severity.WARNING, {"share_pct": 100 * max(share[SILENT], share[DROPOUT])}))
    elif share[SILENT] > 0 or share[DROPOUT] > 0:
        lost_s = float(np.count_nonzero(state & (SILENT | DROPOUT)) * grid.level_s)
        found.append(Finding("audio_dropouts", Severity.MASKED, {"seconds": lost_s}))
    if share[CLIPPED] > 0:
        params = {"seconds": seconds[CLIPPED], "share_pct": 100 * share[CLIPPED]}
        found.append(Finding("audio_clipped", Severity.MASKED, params))
    if not_finite:
        found.append(Finding("audio_not_finite", Severity.REPAIRED, {"count": not_finite}))
    return tuple(found)


def _write_index(folder: Path, grid: Grid, bands_hz: FloatArray, findings: tuple[Finding, ...]) -> None:
    """Write what makes the folder a scan, last of all."""
    content = {
        "version": VERSION,
        "sample_rate_hz": grid.sample_rate_hz,
        "frames": grid.frames,
        "bands_hz": bands_hz.tolist(),
        "findings": [{"code": f.code, "severity": f.severity.value, "params": dict(f.params)} for f in findings],
    }
    part = folder / f"{_INDEX}.part"
    with disc_errors(folder):
        part.write_text(json.dumps(content, indent=1), encoding="utf-8")
        part.replace(folder / _INDEX)


def _loaded(folder: Path) -> SoundScan:
    content = json.loads((folder / _INDEX).read_text(encoding="utf-8"))
    if content["version"] != VERSION:
        raise ValueError(f"version {content['version']}")
    grid = Grid(float(content["sample_rate_hz"]), int(content["frames"]))
    bands_hz = np.asarray(content["bands_hz"], np.float64)
    tiles, wave = load_pyramids(folder, grid)
    findings = tuple(Finding(f["code"], Severity(f["severity"]), f["params"]) for f in content["findings"])
    levels = (grid.level_count, len(bands_hz))
    return SoundScan(
        folder=folder,
        grid=grid,
        bands_hz=bands_hz,
        level_db=_array(folder / "level_db.npy", np.float16, levels),
        crest_db=_array(folder / "crest_db.npy", np.float16, levels),
        state=_array(folder / "state.npy", np.uint8, levels[:1]),
        onset=_array(folder / "onset.npy", np.uint8, (grid.level_count * grid.level // grid.onset_step,)),
        tiles=tiles,
        wave=wave,
        findings=findings,
    )


def _array(path: Path, dtype: npt.DTypeLike, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    array = load_rows(path)
    if array.dtype != np.dtype(dtype) or array.shape != shape:
        raise ValueError(f"{path.name} is not what it should be")
    return array
