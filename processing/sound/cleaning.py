"""The sound as one wants to hear it: without the noise of the ball's own rolling, the leak left as it is.

Three steps, each measured by tests/benchmarks/bench_cleaning.py: tones locked to the turning are taken out, noise that
swells with the turning is weighed towards the quiet part of each turn, bumps are ducked in the bands they are in. The
search for leaks does not use it: it does the same to levels, where nothing has to be made audible.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt

from processing.progress import Progress, silent
from processing.results import Results
from processing.settings import CleaningSettings
from processing.sound.bands import Grid
from processing.sound.cells import Frames as LevelFrames
from processing.sound.cells import band_log_power, frames_of
from processing.sound.cleanable import NotCleaned, why_not_cleaned
from processing.sound.cleaning_bands import BandCleaner, PhaseGains, phase_gain, usual_share
from processing.sound.loudness import usual_power
from processing.sound.onsets import imu_events
from processing.sound.orders import Frames, OrderWindows, Turning, turning_of
from processing.sound.orders_lines import NO_LINES, LineRemover, RollingLines, learn_lines
from processing.sound.pcm import Samples
from processing.sound.rolling_noise import listened_bands, rolling_noise, turned_angle
from processing.sound.scan import SoundScan
from processing.sound.source import AudioReader
from processing.survey import AudioSource, ClockMap, FloatArray, ImuSamples

__all__ = [
    "CleanReader",
    "CleaningContext",
    "CleaningFigures",
    "NotCleaned",
    "figures",
    "learn_cleaning",
    "prepare_cleaning",
    "why_not_cleaned",
]

_LEAST_HEARD = 0.05  # share of the run in which the swelling must be heard to count
_APART_S = 0.2
_FELT_S = 0.08  # a bump is felt within so much of being heard
_SAMPLES, _SAMPLE_S = 8, 0.4  # of the sound, for a figure over a span


@dataclass(frozen=True)
class CleaningContext:
    """What was learnt from the whole run; shared by all readers, never changed."""

    grid: Grid
    turning: Turning
    lines: RollingLines
    gains: PhaseGains | None
    bands_hz: FloatArray  # (b, 2) of the gains
    felt_s: FloatArray  # audio seconds of what the accelerometer felt
    settings: CleaningSettings
    usual_power: FloatArray | None = None  # of the cleaned sound, see :mod:`processing.sound.loudness`


@dataclass(frozen=True)
class CleaningFigures:
    """What cleaning does over a span."""

    removed_db: float  # by how much the band that leaks are looked for in is quieter
    turns_hz: float
    bumps: int  # ducked, in the parts looked at
    felt: int  # of them, by the accelerometer too


def prepare_cleaning(results: Results, progress: Progress | None = None) -> CleaningContext | NotCleaned:
    """Return what the cleaner needs, learnt from a processed run; or why no rolling can be taken out.

    Raises:
        LeaklineError: AUDIO_UNREADABLE.
        Cancelled: the operator stopped it.
    """
    reason = why_not_cleaned(results)
    if reason is not None:
        return reason
    audio, imu, scan = results.recording.audio, results.recording.imu, results.scan
    assert audio is not None
    assert imu is not None
    assert scan is not None
    frames = frames_of(scan, results.clock, results.track, results.not_assessed, results.settings.detector)
    return learn_cleaning(audio, imu, scan, frames, results.clock, results.settings.cleaning, progress)


def learn_cleaning(
    audio: AudioSource,
    imu: ImuSamples,
    scan: SoundScan,
    frames: LevelFrames,
    clock: ClockMap,
    settings: CleaningSettings,
    progress: Progress | None = None,
) -> CleaningContext | NotCleaned:
    """Return the context from the parts of a run (see :func:`prepare_cleaning`).

    Args:
        audio: the recording.
        imu: with the gyro's turn rate, right to a few per cent.
        scan: what the pass over ``audio`` measured.
        frames: its level frames in survey time, and which of them are heard and moving.
        clock: audio to survey time.
        settings: what to take out.
        progress: told a few times a second.
    """
    progress = progress or silent()
    progress.update(0.0, "cleaning_listening")
    turning = turning_of(imu, clock, audio.duration_s)
    lines = NO_LINES
    if settings.lines == "on" and turning.usual_hz > 0:
        with AudioReader(audio) as reader:
            windows = OrderWindows(reader, audio.frames, audio.sample_rate_hz, turning, settings.lines_to_hz)
            lines = learn_lines(windows, progress.part(0.0, 0.4))
    gains = _phase_gains(imu, scan, frames, settings, progress.part(0.4, 0.9))
    if gains is None and not len(lines.orders):
        return NotCleaned.NOT_HEARD
    felt_s = clock.to_audio(imu_events(imu).time_s)
    context = CleaningContext(scan.grid, turning, lines, gains, scan.bands_hz[:-1], felt_s, settings)
    progress.update(0.9)
    with CleanReader(audio, context) as clean:
        context = replace(context, usual_power=usual_power(clean, audio.frames))
    progress.update(1.0)
    return context


def _phase_gains(
    imu: ImuSamples, scan: SoundScan, frames: LevelFrames, settings: CleaningSettings, progress: Progress
) -> PhaseGains | None:
    """Return the gain of each band over the level frames; None where no turning is heard in them."""
    listened = listened_bands(scan.bands_hz[:-1])
    if settings.rolling_depth <= 0 or not len(listened) or not frames.counts.any():
        return None
    level = np.zeros(len(frames.time_s), np.float32)
    for band in listened:
        level += band_log_power(scan, int(band)) / np.float32(len(listened))
    rolling = rolling_noise(level, turned_angle(imu, frames.time_s), frames.counts, scan.frame_s)
    if rolling is None or rolling.heard_share < _LEAST_HEARD:
        return None
    bands = len(scan.bands_hz) - 1
    table: npt.NDArray[np.float16] = np.zeros((len(level), bands), np.float16)
    for band in range(bands):
        progress.update(band / bands)
        log_power = band_log_power(scan, band)
        lift = rolling.modulation(log_power, frames.counts)
        share = usual_share(log_power, scan.frame_s)
        table[:, band] = phase_gain(lift, settings.rolling_depth, scan.frame_s, share)
    return PhaseGains(scan.frame_s, table)


class _WithoutLines:
    """The sound less its rolling lines."""

    def __init__(self, reader: Frames, remover: LineRemover) -> None:
        self._reader, self._remover = reader, remover

    def read(self, start: int, count: int) -> Samples:
        """Return up to ``count`` samples from frame ``start`` on."""
        sound = self._reader.read(start, count)
        less: Samples = sound - self._remover.read(start, len(sound))
        return less


class CleanReader:
    """Reads cleaned samples of one channel from anywhere in a source; one reader a thread, as AudioReader.

    A sample depends on the recording alone, not on where reading began or how it is cut.
    """

    def __init__(self, source: AudioSource, context: CleaningContext) -> None:
        self._source, self._context = source, context
        self._audio = AudioReader(source)
        rate, settings = source.sample_rate_hz, context.settings
        windows = OrderWindows(self._audio, source.frames, rate, context.turning, settings.lines_to_hz)
        sound = _WithoutLines(self._audio, LineRemover(windows, context.lines))
        self._bands = BandCleaner(sound, context.grid, context.bands_hz, context.gains, settings)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the files; reading again opens them again."""
        self._audio.close()

    def read(self, start: int, count: int) -> Samples:
        """Return up to ``count`` samples from frame ``start`` (>= 0) on, float32.

        Raises:
            LeaklineError: AUDIO_UNREADABLE where a file gives less than it held when it was opened.
        """
        if start < 0:
            raise ValueError("start lies before the recording")
        return self._bands.read(start, count)

    def bumps(self, start: int, count: int) -> tuple[int, int]:
        """Return how many bumps begin in a span of frames, and how many of them the accelerometer felt as well."""
        rate, chunk_s = self._source.sample_rate_hz, self._bands.chunk_s
        step_s = chunk_s / 32
        heard: list[float] = []
        for number in range(int(start / rate / chunk_s), int((start + count) / rate / chunk_s) + 1):
            ducked = self._bands.ducked(number)[:-1]
            begins = np.flatnonzero(ducked & ~np.concatenate([[False], ducked[:-1]]))
            heard += [number * chunk_s + step_s * float(i) for i in begins]
        at = np.array([t for t in heard if start <= t * rate < start + count])
        at = at[np.diff(at, prepend=-np.inf) > _APART_S]  # one that rings on is one
        felt = self._context.felt_s
        if not len(at) or not len(felt):
            return len(at), 0
        near = np.clip(np.searchsorted(felt, at), 1, max(len(felt) - 1, 1))
        away = np.minimum(np.abs(felt[np.minimum(near, len(felt) - 1)] - at), np.abs(felt[near - 1] - at))
        return len(at), int(np.count_nonzero(away < _FELT_S))


def figures(
    source: AudioSource, context: CleaningContext, start_s: float, end_s: float, band_hz: Sequence[float]
) -> CleaningFigures:
    """Return what cleaning does between two moments of the audio clock, from eight short looks at most.

    Raises:
        LeaklineError: AUDIO_UNREADABLE.
    """
    rate = source.sample_rate_hz
    first, last = max(0, int(start_s * rate)), min(source.frames, int(end_s * rate))
    size = max(1, min(int(_SAMPLE_S * rate), last - first))
    starts = np.unique(np.linspace(first, max(first, last - size), _SAMPLES).astype(int))
    before = after = 0.0
    bumps = felt = 0
    with AudioReader(source) as raw, CleanReader(source, context) as clean:
        for start in starts:
            before += _band_power(raw.read(int(start), size), rate, band_hz)
            after += _band_power(clean.read(int(start), size), rate, band_hz)
            number, shared = clean.bumps(int(start), size)
            bumps, felt = bumps + number, felt + shared
    removed = 10 * float(np.log10(before / after)) if before > 0 and after > 0 else 0.0
    turns = context.turning.between(max(start_s, 0.0), end_s) / max(end_s - max(start_s, 0.0), 1e-6)
    return CleaningFigures(removed, turns, bumps, felt)


def _band_power(sound: Samples, rate_hz: float, band_hz: Sequence[float]) -> float:
    if not len(sound):
        return 0.0
    power = np.square(np.abs(np.fft.rfft(sound * np.hanning(len(sound)))))
    hz = np.fft.rfftfreq(len(sound), 1 / rate_hz)
    return float(power[(hz >= band_hz[0]) & (hz <= band_hz[1])].sum())
