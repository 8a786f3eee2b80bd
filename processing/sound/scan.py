"""One streamed pass over a recording builds everything that later steps and views need, in bounded memory.

The result lies in a folder of .npy files (no pickles) and is memory-mapped, so twelve hours cost no more RAM than one.
"""

import json
import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress, silent
from processing.settings import SoundSettings, digest
from processing.sound.analysis import FACTS, PART_COLUMNS, Analyser, Halves, ScanPart
from processing.sound.bands import Grid
from processing.sound.pcm import Samples
from processing.sound.rows import disc_errors, load_rows
from processing.sound.scan_files import ScanWriter, Shape, file_shapes
from processing.sound.soundness import CLIPPED, DROPOUT, FULL_SCALE, SILENT
from processing.sound.source import AudioReader
from processing.sound.tile_values import Bytes
from processing.sound.tiles import TilePyramid, WavePyramid, build_upper_levels, load_pyramids
from processing.survey import AudioSource, Channel, ClockMap, Finding, FloatArray, Severity, Stretch

VERSION = 3  # of what lies in the folder; part of its description, so that older folders are rebuilt
_INDEX = "scan.json"
_MAX_THREADS = 4
_JOIN_S = 1.0  # troubles closer than this are one stretch
_MIN_STRETCH_S = 0.5  # a shorter trouble is counted, not reported as a stretch
_DEAD_SHARE = 0.9
_OFFSET = 0.01  # of full scale: a steady voltage that costs range
_HUM_DB = 12.0  # above its surroundings, in half of all pieces
_REASONS = ((SILENT, "sound_silent"), (DROPOUT, "sound_dropout"), (CLIPPED, "sound_clipped"))
_SERIES = ("level_db", "crest_db", "state", "onset")

Grown = Callable[[Path, Grid, int], None]  # the folder, its grid, and how many picture columns can be read there


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
    *,
    resume: bool = False,
    grown: Grown | None = None,
) -> SoundScan:
    """Pass once over ``source`` and return what was measured; the files are left in ``out_dir``.

    Args:
        source: the recording.
        settings: the chosen band.
        progress: told about every twelve seconds of sound; may cancel.
        out_dir: where the files go; made when missing. Nothing in it counts until the pass is complete.
        threads: how many analyse at once; by default as many as there are processors, at most four.
        resume: go on where an earlier pass over the same sound into this folder stopped, with the same result to the
            bit, and leave what was done when this one stops. The folder must belong to this very sound.
        grown: called after each piece with the folder and the picture columns in it that can be read.

    Raises:
        LeaklineError: AUDIO_UNREADABLE, SETTING_INVALID, DISC_FULL, CANNOT_WRITE.
        Cancelled: the operator stopped it; without ``resume`` nothing is left.
    """
    if out_dir is None:
        raise ValueError("scan needs a folder for its result")
    progress = progress or silent()
    grid = Grid(source.sample_rate_hz, source.frames)
    analyser = Analyser(grid, settings)
    with disc_errors(out_dir):
        out_dir.mkdir(parents=True, exist_ok=True)
        (out_dir / _INDEX).unlink(missing_ok=True)
    made_of = digest(VERSION, grid.sample_rate_hz, grid.frames, source.channel, settings)
    writer = ScanWriter(out_dir, grid, len(analyser.bands_hz), made_of, resume=resume)
    try:
        with AudioReader(source) as reader:
            pieces = _pieces(reader, source.frames, analyser, writer.parts_done)
            for part, not_finite in _analysed(pieces, analyser, threads or min(os.cpu_count() or 1, _MAX_THREADS)):
                writer.add(part, not_finite)
                columns = min(writer.parts_done * PART_COLUMNS, grid.column_count)
                if grown is not None:
                    writer.flush()
                    grown(out_dir, grid, columns)
                progress.update(0.99 * columns / grid.column_count, "sound_scanning")
        writer.finish()
    finally:
        writer.end()
    build_upper_levels(out_dir, grid)
    findings = _findings(out_dir, grid, len(analyser.bands_hz))
    _write_index(out_dir, grid, analyser.bands_hz, findings)
    progress.update(1.0, "sound_scanning")
    return SoundScan.load(out_dir)


@dataclass(frozen=True)
class _Piece:
    samples: Samples  # (part + 2·context,)
    frames: int  # of the recording in the part
    not_finite: int


def _analysed(pieces: Iterator[_Piece], analyser: Analyser, threads: int) -> Iterator[tuple[ScanPart, int]]:
    """Yield the parts in order; a few are worked on at a time, so memory does not grow with the recording."""
    if threads == 1:
        for piece in pieces:
            yield analyser.analyse(piece.samples, piece.frames), piece.not_finite
        return
    with ThreadPoolExecutor(threads, "sound-scan") as pool:
        waiting: deque[tuple[Future[ScanPart], int]] = deque()
        try:
            for piece in pieces:
                waiting.append((pool.submit(analyser.analyse, piece.samples, piece.frames), piece.not_finite))
                if len(waiting) > threads:
                    yield waiting[0][0].result(), waiting[0][1]
                    waiting.popleft()
            while waiting:
                yield waiting[0][0].result(), waiting[0][1]
                waiting.popleft()
        finally:
            for job, _ in waiting:
                job.cancel()


def _pieces(reader: AudioReader, frames: int, analyser: Analyser, first: int) -> Iterator[_Piece]:
    """Yield the sound from the part ``first`` on, with context on either side; zeros beyond both ends.

    Each sample is read once, in order: many a compressed file can be read on but not sought in.
    """
    size, context = analyser.part, analyser.context
    start = first * size  # of the part; samples before start + context are in the tail
    tail = np.zeros(2 * context, np.float32)
    head_start = max(0, start - context)
    head = reader.read(min(head_start, frames), max(0, min(start + context, frames) - head_start))
    tail[context - (start - head_start) :][: len(head)] = head
    if first:
        reader.not_finite = 0  # those of the head were counted with the part before
    while start < frames:
        position = start + context
        fresh = reader.read(min(position, frames), max(0, min(size, frames - position)))
        piece = np.empty(size + 2 * context, np.float32)
        piece[: 2 * context] = tail
        piece[2 * context : 2 * context + len(fresh)] = fresh
        piece[2 * context + len(fresh) :] = 0
        tail = piece[size:].copy()
        yield _Piece(piece, min(size, frames - start), reader.not_finite)
        reader.not_finite = 0
        start += size


def _findings(folder: Path, grid: Grid, bands: int) -> tuple[Finding, ...]:
    shapes = file_shapes(folder, grid, bands)
    state, facts = load_rows(shapes["state"].path), np.asarray(load_rows(shapes["facts"].path), np.float64)
    fact = dict(zip((*FACTS, "not_finite"), facts.T, strict=True))
    found = [*_state_findings(np.asarray(state, np.uint8), grid, fact["clip_level"])]
    offset = float(fact["mean"].mean())
    if abs(offset) >= _OFFSET:
        found.append(Finding("audio_offset", Severity.INFO, {"share_pct": 100 * offset}))
    hum = {hz: float(np.median(fact[f"hum_{hz}_db"])) for hz in (50, 60)}
    loudest = max(hum, key=lambda hz: hum[hz])
    if hum[loudest] >= _HUM_DB:
        found.append(Finding("audio_hum", Severity.INFO, {"frequency_hz": loudest, "excess_db": hum[loudest]}))
    if not_finite := int(fact["not_finite"].sum()):
        found.append(Finding("audio_not_finite", Severity.REPAIRED, {"count": not_finite}))
    return tuple(found)


def _state_findings(state: Bytes, grid: Grid, clip_level: FloatArray) -> Iterator[Finding]:
    seconds = {bit: float(np.count_nonzero(state & bit) * grid.level_s) for bit, _ in _REASONS}
    share = {bit: float(np.count_nonzero(state & bit) / len(state)) for bit, _ in _REASONS}
    if max(share[SILENT], share[DROPOUT]) >= _DEAD_SHARE:
        yield Finding("audio_dead", Severity.WARNING, {"share_pct": 100 * max(share[SILENT], share[DROPOUT])})
    elif share[SILENT] > 0 or share[DROPOUT] > 0:
        lost_s = float(np.count_nonzero(state & (SILENT | DROPOUT)) * grid.level_s)
        yield Finding("audio_dropouts", Severity.MASKED, {"seconds": lost_s})
    if share[CLIPPED] > 0:
        params: dict[str, str | float] = {"seconds": seconds[CLIPPED], "share_pct": 100 * share[CLIPPED]}
        yield Finding("audio_clipped", Severity.MASKED, params)
        below = clip_level[clip_level < FULL_SCALE]  # nan where a piece was not clipped
        if len(below):
            yield Finding("audio_clipped_below", Severity.INFO, {"level_db": float(20 * np.log10(np.median(below)))})


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
    shapes = file_shapes(folder, grid, len(bands_hz))
    arrays = {name: _array(shapes[name].path, shapes[name]) for name in _SERIES}
    return SoundScan(folder=folder, grid=grid, bands_hz=bands_hz, tiles=tiles, wave=wave, findings=findings, **arrays)


def _array(path: Path, shape: Shape) -> npt.NDArray[Any]:
    array = load_rows(path)
    expected = (shape.rows,) if shape.columns is None else (shape.rows, shape.columns)
    if array.dtype != np.dtype(shape.dtype) or array.shape != expected:
        raise ValueError(f"{path.name} is not what it should be")
    return array
