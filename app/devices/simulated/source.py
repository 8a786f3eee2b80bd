"""What a simulated ball measures and hears: a scenario that is simulated now, or a recording on disc, in blocks."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.folder import ImportOptions, import_folder
from processing.importing.frames import Frames
from processing.progress import Progress
from processing.simulation.run import simulate
from processing.simulation.scenario import Scenario
from processing.simulation.scenarios import load_scenario
from processing.simulation.sound import SoundPlan, sound_blocks
from processing.sound.source import AudioReader
from processing.storage.folder import SurveyFolder, is_survey_folder
from processing.survey import AudioSource, FloatArray, ImuSamples

SoundArray = npt.NDArray[np.float32]  # (n, channels), full scale ±1


class Tape(Protocol):
    """The sound of a run from its beginning to its end."""

    rate_hz: int
    channels: int

    def read(self, count: int) -> SoundArray:
        """Return the next ``count`` frames, fewer at the end."""
        ...

    def rewind(self) -> None:
        """Begin anew."""
        ...

    def close(self) -> None:
        """Let files go."""
        ...


@dataclass(frozen=True)
class Ball:
    """A run to be sent; ``sound`` is None where there is none."""

    name: str
    imu: ImuSamples
    sound: Tape | None


@dataclass(frozen=True)
class Wanted:
    """How the ball shall be: None keeps what the source has. ``clock_ppm`` is the audio clock less the IMU's."""

    rate_hz: float | None = None
    audio_rate_hz: int | None = None
    channels: int = 1
    seed: int = 0
    clock_ppm: float = 0.0


def open_ball(source: str, wanted: Wanted, scratch: Path, progress: Progress) -> Ball:
    """Return the run of a scenario's name or file, of a device's folder or log, or of a survey folder.

    A scenario's sound begins with its first sample and has the clock that is wanted, so that sound and motion stay
    as far apart as the two streams' paces say. A recording is sent as it is. ``scratch`` is for long logs.

    Raises:
        LeaklineError: of the scenario or the import; NO_IMU where there is no motion; SETTING_INVALID for a sound
            rate that a recording does not have.
    """
    path = Path(source)
    if path.suffix.lower() in {".toml", ".json"} or not path.exists():
        return _simulated(load_scenario(source), wanted, progress)
    options = ImportOptions(scratch=scratch)
    recorded = import_folder(_original(path), options, progress=progress)
    if recorded.imu is None:
        raise LeaklineError(ErrorCode.NO_IMU, Place(path))
    imu = recorded.imu if wanted.rate_hz is None else _at_rate(recorded.imu, wanted.rate_hz)
    tape = None if recorded.audio is None else FileTape(recorded.audio)
    if tape is not None and wanted.audio_rate_hz not in {None, tape.rate_hz}:
        tape.close()
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, Place(path), name="--audio-rate", value=str(wanted.audio_rate_hz),
            allowed=str(tape.rate_hz),
        )  # fmt: skip
    return Ball(path.name, imu, tape)


def _original(path: Path) -> Path:
    if not is_survey_folder(path):
        return path
    with SurveyFolder.open(path, read_only=True) as folder:
        return folder.original_dir


def _simulated(scenario: Scenario, wanted: Wanted, progress: Progress) -> Ball:
    clock = replace(scenario.clock, start_s=0.0, drift_ppm=wanted.clock_ppm)
    scenario = replace(scenario, clock=clock)
    if wanted.rate_hz is not None:
        scenario = replace(scenario, imu=replace(scenario.imu, rate_hz=wanted.rate_hz))
    if wanted.audio_rate_hz is not None:
        scenario = replace(scenario, sound=replace(scenario.sound, rate_hz=wanted.audio_rate_hz))
    run = simulate(scenario, wanted.seed, progress)
    tape = None if run.sound is None else ScenarioTape(run.sound, wanted.channels)
    return Ball(scenario.name, run.imu, tape)


def _at_rate(imu: ImuSamples, rate_hz: float) -> ImuSamples:
    """Return a recording's samples at another rate, by straight lines between them."""
    time_s = np.arange(imu.time_s[0], imu.time_s[-1], 1.0 / rate_hz)

    def along(values: FloatArray | None) -> FloatArray | None:
        if values is None:
            return None
        columns = np.reshape(values, (len(values), -1)).T
        return np.reshape(np.column_stack([np.interp(time_s, imu.time_s, c) for c in columns]), (-1, *values.shape[1:]))

    acc, gyr = along(imu.acc_s_mps2), along(imu.gyr_s_radps)
    assert acc is not None
    assert gyr is not None
    quat = None if imu.quat_ws is None else imu.quat_ws[np.searchsorted(imu.time_s, time_s)]
    return ImuSamples(
        time_s, acc, gyr, np.ones(len(time_s), np.bool_), along(imu.mag_s_ut), quat, along(imu.pressure_kpa),
        along(imu.temperature_c),
    )  # fmt: skip


class RowReel:
    """Gives a run's samples in blocks as the device would: counted, with its time from 0 on; laps follow each other."""

    def __init__(self, imu: ImuSamples, *, loop: bool) -> None:
        self._imu, self._loop = imu, loop
        self._next, self._lap_s = 0, 0.0
        self._first_s = float(imu.time_s[0])
        self.lap_length_s = float(imu.time_s[-1]) - self._first_s + 1.0 / imu.sample_rate_hz

    def take(self, count: int) -> tuple[Frames, FloatArray]:
        """Return up to ``count`` samples and their times (s) since the first; none at the end."""
        imu = self._imu
        if self._next >= len(imu.time_s):
            if not self._loop:
                count = 0
            else:
                self._next, self._lap_s = 0, self._lap_s + self.lap_length_s
        rows = slice(self._next, min(self._next + count, len(imu.time_s)))
        run_s = np.asarray(imu.time_s[rows], np.float64) - self._first_s + self._lap_s
        self._next = rows.stop
        size = len(run_s)

        def channel(values: npt.NDArray[np.float64] | None, width: int) -> npt.NDArray[np.float32]:
            if values is None:
                return np.full((size, width) if width > 1 else (size,), np.nan, np.float32)
            return np.asarray(values[rows], np.float32)

        frames = Frames(
            counter=np.zeros(size, np.uint32),  # counted where faults are made
            time_us=np.round(run_s * 1e6).astype(np.uint64),
            acc_s_mps2=channel(imu.acc_s_mps2, 3),
            gyr_s_radps=channel(imu.gyr_s_radps, 3),
            mag_s_ut=channel(imu.mag_s_ut, 3),
            pressure_kpa=channel(imu.pressure_kpa, 1),
            temperature_c=channel(imu.temperature_c, 1),
            quat_ws=channel(imu.quat_ws, 4),
            host_s=np.full(size, np.nan),
        )
        return frames, run_s


class ScenarioTape:
    """A scenario's sound, made as it is needed, in 16 bits as the written one; further channels are turned over."""

    def __init__(self, plan: SoundPlan, channels: int = 1) -> None:
        self.rate_hz, self.channels = plan.rate_hz, channels
        self._plan = plan
        self._blocks: Iterator[npt.NDArray[np.float32]] = iter(())
        self._left = np.zeros(0, np.float32)
        self.rewind()

    def rewind(self) -> None:
        """Begin anew."""
        self._blocks, self._left = sound_blocks(self._plan), np.zeros(0, np.float32)

    def read(self, count: int) -> SoundArray:
        """Return the next frames, fewer at the end."""
        pieces, have = [self._left], len(self._left)
        while have < count and (block := next(self._blocks, None)) is not None:
            pieces.append(block)
            have += len(block)
        sound = np.concatenate(pieces) if len(pieces) > 1 else self._left
        self._left = sound[count:]
        mono = np.round(sound[:count] * 32767) / np.float32(32768)
        turned = [mono if channel % 2 == 0 else -mono for channel in range(self.channels)]
        return np.stack(turned, axis=1).astype(np.float32)

    def close(self) -> None:
        """Nothing is open."""


class FileTape:
    """A recording's sound, all channels of it."""

    def __init__(self, source: AudioSource) -> None:
        self.rate_hz, self.channels = round(source.sample_rate_hz), source.channels
        self._readers = [AudioReader(replace(source, channel=channel)) for channel in range(source.channels)]
        self._frames, self._at = source.frames, 0

    def rewind(self) -> None:
        """Begin anew."""
        self._at = 0

    def read(self, count: int) -> SoundArray:
        """Return the next frames, fewer at the end."""
        count = min(count, self._frames - self._at)
        sound = np.stack([reader.read(self._at, count) for reader in self._readers], axis=1)
        self._at += count
        return sound

    def close(self) -> None:
        """Close the files."""
        for reader in self._readers:
            reader.close()
