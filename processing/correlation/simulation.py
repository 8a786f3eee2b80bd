"""Pairs of recordings of one leak with the truth: attenuation and dispersion of the pipe, noise, hum and echoes.

The pipe loses a constant part of the energy a period (loss factor η): amplitude ``exp(−πfηx/c)``, which a causal
medium cannot do without dispersion ``c(f) = c₀·(1 + (η/π)·ln(f/f₀))`` (Kolsky's model; Aki and Richards, Quantitative
Seismology, 5.5). The estimators know neither this law nor η.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import fft

from processing.survey import FloatArray


@dataclass(frozen=True)
class SimulatedPair:
    """What is simulated; speeds hold at ``reference_hz``; ``snr_db`` at each sensor, over 5 Hz .. ``noise_top_hz``.

    ``drift_ppm`` and ``offset_s`` are B's clock: it began ``offset_s`` after A and runs fast.
    """

    lengths_m: tuple[float, ...] = (100.0,)
    speeds_mps: tuple[float, ...] = (400.0,)
    leak_m: float = 30.0
    loss: float = 0.03
    reference_hz: float = 100.0
    source_hz: tuple[float, float] = (20.0, 600.0)
    snr_db: float = 0.0
    noise_top_hz: float = 1000.0
    duration_s: float = 60.0
    rate_hz: int = 4000
    hum_db: float | None = None  # a coherent 50 Hz comb over the signal
    other_m: float | None = None  # a second, intermittent source, such as a draw-off
    other_db: float = 0.0
    other_share: float = 0.3
    resonance: tuple[float, float] | None = None  # frequency and damping beside A
    polarity: int = 1
    offset_s: float = 0.0
    drift_ppm: float = 0.0
    seed: int = 0


def simulate(what: SimulatedPair) -> tuple[FloatArray, FloatArray]:
    """Return the sound at A and at B (n,), each about 0.1 strong; equal arguments give equal samples."""
    rng = np.random.default_rng(what.seed)
    count = fft.next_fast_len(int(what.duration_s * what.rate_hz), real=True)
    frequency = fft.rfftfreq(count, 1.0 / what.rate_hz)
    a, b = _heard(what, rng, frequency, count, what.leak_m)
    power = np.array([np.mean(a**2), np.mean(b**2)])
    if what.other_m is not None:
        on = _intermittent(rng, count, what.other_share)
        others = _heard(what, rng, frequency, count, what.other_m)
        for own, other in zip((a, b), others, strict=True):
            own += other * on * math.sqrt(np.mean(own**2) / np.mean(other**2)) * 10.0 ** (what.other_db / 20.0)
    if what.hum_db is not None:
        time_s = np.arange(count) / what.rate_hz
        hum = sum(np.sin(2.0 * math.pi * 50.0 * k * time_s + k) / k for k in range(1, 9))
        scale = 10.0 ** (what.hum_db / 20.0) / math.sqrt(np.mean(hum**2))
        a += hum * scale * math.sqrt(power[0])
        b += hum * scale * math.sqrt(power[1])
    for own, own_power in zip((a, b), power, strict=True):
        own += _noise(rng, frequency, count, what.noise_top_hz) * math.sqrt(own_power * 10.0 ** (-what.snr_db / 10.0))
        own += 1e-3 * math.sqrt(own_power) * rng.standard_normal(count)  # the recorder's own hiss, at all frequencies
    b *= what.polarity
    return _scaled(a, b, int(what.duration_s * what.rate_hz))


def _scaled(a: FloatArray, b: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    return tuple(0.1 * own[:count] / np.std(own[:count]) for own in (a, b))  # type: ignore[return-value]


def _heard(
    what: SimulatedPair, rng: np.random.Generator, frequency: FloatArray, count: int, from_a_m: float
) -> tuple[FloatArray, FloatArray]:
    """Return one source as it arrives at both sensors."""
    low, high = what.source_hz
    lines = rng.standard_normal(len(frequency)) + 1j * rng.standard_normal(len(frequency))
    shape = 1.0 / np.sqrt(np.maximum(frequency, low) / low)  # turbulence: 3 dB an octave down
    shape *= 1.0 / np.sqrt(1.0 + (frequency / high) ** 8) / np.sqrt(1.0 + (low / np.maximum(frequency, 0.1)) ** 8)
    lines *= shape
    to_a, to_b = _paths(what, from_a_m)
    at_a, at_b = lines * _path(what, frequency, to_a), lines * _path(what, frequency, to_b)
    if what.resonance is not None:
        ratio = frequency / what.resonance[0]
        at_a = at_a / (1.0 - ratio**2 + 2j * what.resonance[1] * ratio)
    if what.drift_ppm == 0.0:
        at_b = at_b * np.exp(2j * np.pi * frequency * what.offset_s)
        return fft.irfft(at_a, count), fft.irfft(at_b, count)
    # a drifting clock reads the sound at stretched moments
    fine = fft.irfft(np.concatenate([at_b, np.zeros(7 * (len(at_b) - 1))]), 8 * count) * 8
    moments = (np.arange(count) / (1.0 + 1e-6 * what.drift_ppm) + what.offset_s * what.rate_hz) * 8.0
    return fft.irfft(at_a, count), np.interp(moments % (8 * count), np.arange(8 * count), fine)


def _paths(what: SimulatedPair, from_a_m: float) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Return metres and speed of each stretch on the way to A and to B."""
    to_a, to_b, start_m = [], [], 0.0
    for length, speed in zip(what.lengths_m, what.speeds_mps, strict=True):
        inside = min(max(from_a_m - start_m, 0.0), length)
        to_a.append((inside, speed))
        to_b.append((length - inside, speed))
        start_m += length
    return to_a, to_b


def _path(what: SimulatedPair, frequency: FloatArray, stretches: Sequence[tuple[float, float]]) -> np.ndarray:
    ratio = np.maximum(frequency, 1.0) / what.reference_hz
    out = np.ones(len(frequency), np.complex128)
    for metres, speed in stretches:
        phase_speed = speed * (1.0 + what.loss / math.pi * np.log(ratio))
        out *= np.exp(-frequency * metres * (math.pi * what.loss / speed + 2j * math.pi / phase_speed))
    return out


def _noise(rng: np.random.Generator, frequency: FloatArray, count: int, top_hz: float) -> FloatArray:
    """Return noise of power one: half pink (flow, traffic), half white, between 5 Hz and the top."""
    lines = rng.standard_normal(len(frequency)) + 1j * rng.standard_normal(len(frequency))
    inside = (frequency >= 5.0) & (frequency <= top_hz)
    pink = np.where(inside, 1.0 / np.maximum(frequency, 5.0), 0.0)
    white = inside.astype(float)
    samples = fft.irfft(lines * np.sqrt(pink / pink.sum() + white / white.sum()), count)
    return np.asarray(samples / math.sqrt(np.mean(samples**2)))


def _intermittent(rng: np.random.Generator, count: int, share: float) -> FloatArray:
    """Return 1 in about ``share`` of the time, 0 else, in twelfths of the recording."""
    blocks = np.zeros(12)
    blocks[rng.permutation(12)[: max(1, round(12 * share))]] = 1.0
    steps = np.repeat(blocks, -(-count // 12))[:count]
    soft = max(1, count // 500)  # a switch that clicks would be a sound of its own
    return np.convolve(steps, np.hanning(soft + 2)[1:-1] / np.hanning(soft + 2).sum(), mode="same")


def write_wave(path: Path, samples: FloatArray, rate_hz: int) -> None:
    """Write one or more channels (n,) or (n, channels) as 16-bit WAV."""
    import soundfile

    soundfile.write(str(path), samples, rate_hz, subtype="PCM_16")
