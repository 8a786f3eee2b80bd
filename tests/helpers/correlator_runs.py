"""Simulated pairs on disk for the tests of the correlator."""

from dataclasses import replace

from processing.correlation.pipe import Pipe, PipeSection
from processing.correlation.recordings import Pair, Sync
from processing.correlation.simulation import SimulatedPair, simulate, write_wave
from processing.sound.source import open_audio


def source_of(path, samples, rate_hz):
    write_wave(path, samples, rate_hz)
    return open_audio([path])[0]


def pair_on_disk(folder, what: SimulatedPair, sync: Sync | None = None) -> Pair:
    a, b = simulate(what)
    return Pair(
        source_of(folder / "a.wav", a, what.rate_hz), source_of(folder / "b.wav", b, what.rate_hz), sync or Sync()
    )


def pipe_of(what: SimulatedPair, sigma: float = 0.0) -> Pipe:
    return Pipe(
        tuple(
            PipeSection(length, speed_mps=speed, speed_sigma_mps=sigma * speed)
            for length, speed in zip(what.lengths_m, what.speeds_mps, strict=True)
        )
    )


def shorter(what: SimulatedPair, **changes) -> SimulatedPair:
    return replace(what, **changes)
