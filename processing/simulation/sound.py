"""The sound of a run, made in blocks of bounded size: coloured noise of all sources, pump tones, and blows.

All noise is Gaussian and independent, so that its sum is made at once: frames of white noise in the frequency domain
are shaped by the root of the summed power spectrum at the moment and overlapped under a sine window, whose squares sum
to one. Each source's power is thus exactly its own, and the cost does not grow with their number.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from processing.simulation.events import Blow
from processing.simulation.lines import LinesPlan, line_sound
from processing.simulation.motion import TrueMotion
from processing.simulation.scenario import Pump, Scenario
from processing.simulation.sources import Heard, Source
from processing.survey import ClockMap

Samples = npt.NDArray[np.float32]

_FRAMES_A_BLOCK = 32
_RING_S = 0.12  # after which a blow has died away


@dataclass(frozen=True)
class SoundPlan:
    """Everything needed to make the sound; ``frames`` is its length in samples."""

    rate_hz: int
    frames: int
    clock: ClockMap
    motion: TrueMotion
    sources: tuple[Source, ...]
    blows: tuple[Blow, ...]
    pumps: tuple[Pump, ...]
    seed: int
    lines: LinesPlan = field(default_factory=LinesPlan)

    def heard_at(self, audio_s: npt.NDArray[np.float64]) -> Heard:
        """Return the going at moments of the audio clock."""
        t = self.clock.to_survey(audio_s)
        m = self.motion
        return Heard(
            t,
            np.interp(t, m.time_s, m.chainage_m),
            np.interp(t, m.time_s, m.speed_mps),
            np.interp(t, m.time_s, m.rotation_rad),
        )


def frame_length(rate_hz: int) -> int:
    """Return the frame length in samples: a power of two of 60 to 120 ms, short beside a turn of the ball."""
    return int(2 ** np.floor(np.log2(rate_hz * 0.12)))


def frequencies(rate_hz: int) -> npt.NDArray[np.float64]:
    """Return the FFT bins (Hz) on which sources give their spectra."""
    return np.asarray(np.fft.rfftfreq(frame_length(rate_hz), 1 / rate_hz))


def sound_blocks(plan: SoundPlan) -> Iterator[Samples]:
    """Yield consecutive blocks of float32 samples, full scale ±1, ``plan.frames`` in all."""
    length = frame_length(plan.rate_hz)
    hop = length // 2
    rng = np.random.default_rng([plan.seed, 1])
    shapes = np.stack([s.shape for s in plan.sources]).astype(np.float32)
    window = np.sin(np.pi * (np.arange(length) + 0.5) / length).astype(np.float32)
    tail = np.zeros(hop, dtype=np.float32)
    ringing = _Ringing(plan)
    combs = [_comb(p, plan.rate_hz, np.random.default_rng([plan.seed, 2, i])) for i, p in enumerate(plan.pumps)]
    done = -hop  # the first half frame only fills the overlap
    while done < plan.frames:
        noise = _noise_frames(plan, shapes, rng, done, hop, window)
        block = np.empty(_FRAMES_A_BLOCK * hop, dtype=np.float32)
        halves = noise.reshape(_FRAMES_A_BLOCK, 2, hop)
        block[:hop] = tail + halves[0, 0]
        block[hop:] = (halves[:-1, 1] + halves[1:, 0]).ravel()
        tail = halves[-1, 1]
        first = max(done, 0)
        block = block[first - done : plan.frames - done]
        _add_pumps(block, plan, combs, first)
        if plan.lines.lines:
            audio_s = (first + np.arange(len(block))) / plan.rate_hz
            block += line_sound(plan.lines, plan.heard_at(audio_s), plan.rate_hz)
        ringing.add_to(block, first)
        done += _FRAMES_A_BLOCK * hop
        yield np.clip(block, -1.0, 1.0, out=block)


def _noise_frames(
    plan: SoundPlan, shapes: Samples, rng: np.random.Generator, first: int, hop: int, window: Samples
) -> Samples:
    from scipy.fft import irfft

    length = 2 * hop
    bins = shapes.shape[1]
    middles = (first + hop * (np.arange(_FRAMES_A_BLOCK) + 1.0)) / plan.rate_hz
    heard = plan.heard_at(middles)
    powers = np.stack([s.power(heard) for s in plan.sources], axis=1).astype(np.float32)
    # a bin of unit complex noise c gives samples of variance 2|c|²/length², hence the factor
    size = np.sqrt(powers @ shapes) * np.float32(length / 2)
    white = rng.standard_normal((_FRAMES_A_BLOCK, bins, 2), dtype=np.float32)
    spectrum = white.view(np.complex64)[..., 0] * size
    spectrum[:, 0] = 0.0
    spectrum[:, -1] = 0.0
    return np.asarray(irfft(spectrum, n=length, axis=1).astype(np.float32, copy=False) * window)


def _add_pumps(block: Samples, plan: SoundPlan, combs: list[Samples], first: int) -> None:
    """Add each pump from its comb, a table of one period; it fades in and out over two seconds and swells slowly."""
    audio_s = (first + np.arange(len(block))) / plan.rate_hz
    for pump, table in zip(plan.pumps, combs):
        t = plan.clock.to_survey(audio_s[:: max(len(block) // 64, 1)])
        on = np.clip((t - pump.start_s) / 2, 0, 1) * np.clip((pump.end_s - t) / 2, 0, 1)
        if not np.any(on):
            continue
        gain = np.interp(np.arange(len(block)), np.linspace(0, len(block), len(t)), on * (1 + 0.3 * np.sin(t / 7)))
        at = (audio_s * pump.frequency_hz % 1.0) * len(table)
        block += (gain * table[at.astype(np.int64)]).astype(np.float32)


def _comb(pump: Pump, rate_hz: int, rng: np.random.Generator) -> Samples:
    turn = np.arange(8192) / 8192
    table = np.zeros(8192)
    for k in range(1, pump.harmonics + 1):
        if k * pump.frequency_hz < 0.45 * rate_hz:
            table += np.cos(2 * np.pi * (k * turn + rng.uniform())) / k**0.7
    return np.asarray(table / np.sqrt(np.mean(table**2)) * 10 ** (pump.level_dbfs / 20), dtype=np.float32)


class _Ringing:
    """Adds blows to blocks: a sharp onset, noise and two tones dying away, the same however the blocks are cut."""

    def __init__(self, plan: SoundPlan) -> None:
        self._plan = plan
        onsets = plan.clock.to_audio(np.array([b.time_s for b in plan.blows])) * plan.rate_hz
        self._first = np.round(onsets).astype(np.int64)
        self._length = int(_RING_S * plan.rate_hz)

    def add_to(self, block: Samples, first: int) -> None:
        last = first + len(block)
        for i in range(*np.searchsorted(self._first, [first - self._length, last])):
            start = int(self._first[i])
            wave = self._wave(i)
            a, b = max(start, first), min(start + self._length, last)
            if a < b:
                block[a - first : b - first] += wave[a - start : b - start]

    def _wave(self, index: int) -> Samples:
        blow, rate = self._plan.blows[index], self._plan.rate_hz
        rng = np.random.default_rng([self._plan.seed, 3, index])
        t = np.arange(self._length) / rate
        crack = rng.normal(size=self._length) * np.exp(-t / 0.006)
        for tone in rng.uniform(350.0, 0.2 * rate, 2):
            crack += (
                1.2 * np.sin(2 * np.pi * tone * t + rng.uniform(0, 2 * np.pi)) * np.exp(-t / rng.uniform(0.01, 0.03))
            )
        return np.asarray(crack / np.max(np.abs(crack)) * 10 ** (blow.level_dbfs / 20), dtype=np.float32)


def sound_length(scenario: Scenario, end_s: float) -> tuple[int, ClockMap]:
    """Return the number of samples and the clock of a recorder that runs 1.5 s beyond the IMU log."""
    clock = ClockMap(scenario.clock.start_s, scenario.clock.drift_ppm, 0.0, "given")
    seconds = float(clock.to_audio(end_s + 1.5))
    return max(int(seconds * scenario.sound.rate_hz), 1), clock
