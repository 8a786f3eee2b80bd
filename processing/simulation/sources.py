"""The sources of stationary-looking noise in a run, each a spectrum with a power that changes along time and place.

Levels: flow and rolling noise are given in dB of full scale at nominal speed; every other source by its
signal-to-noise ratio in its own band above those two, so that a scenario reads as a detector's tables do (in-band SNR
at closest approach).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from processing.simulation import spectra
from processing.simulation.route import SmoothRoute
from processing.simulation.scenario import Local, Scenario, Sound, Timed
from processing.simulation.wander import gauss_markov
from processing.survey import FloatArray, LeakClass


@dataclass(frozen=True)
class Heard:
    """The going at m moments, for the powers of all sources: survey time, chainage, speed, rolled angle."""

    time_s: FloatArray
    chainage_m: FloatArray
    speed_mps: FloatArray
    rotation_rad: FloatArray


Power = Callable[[Heard], FloatArray]


@dataclass(frozen=True)
class Source:
    """``power(heard)`` (m,) times ``shape`` (bins,) is the power per bin; ``name`` is for people and tests."""

    name: str
    shape: FloatArray
    power: Power


def sources_of(
    scenario: Scenario,
    route: SmoothRoute,
    span_s: tuple[float, float],
    frequency_hz: FloatArray,
    rng: np.random.Generator,
) -> tuple[Source, ...]:
    """Return every noise source of the scenario with its spectrum at ``frequency_hz`` (bins,)."""
    sound, speed = scenario.sound, scenario.drive.speed_mps
    flow, rolling = _flow(sound, speed, span_s, frequency_hz, rng), _rolling(scenario, span_s, frequency_hz, rng)
    still = [Source("hiss", spectra.white(frequency_hz), _steady(sound.hiss_dbfs))]
    background = _power(sound.flow_dbfs) * flow.shape + _power(sound.rolling_dbfs) * rolling.shape
    placed = [_local(x, background, frequency_hz, rng) for x in (*sound.local, *_bends(sound, route))]
    timed = [_timed(x, background, frequency_hz) for x in sound.timed]
    return (flow, rolling, *still, *placed, *timed)


def background_shape(scenario: Scenario, frequency_hz: FloatArray) -> FloatArray:
    """Return power per bin of flow and rolling noise at nominal speed, without drift: what SNRs refer to."""
    sound = scenario.sound
    rolling = _rolling_shape(frequency_hz) * _power(sound.rolling_dbfs)
    return _power(sound.flow_dbfs) * spectra.pink(frequency_hz) + rolling


def peak_power(source: Local | Timed, background: FloatArray, frequency_hz: FloatArray) -> float:
    """Return the power (of full scale) that stands ``snr_db`` above ``background`` within the source's own band."""
    shape = spectra.bell(frequency_hz, source.centre_hz, source.octaves)
    inside = spectra.in_band(frequency_hz, source.centre_hz, source.octaves)
    return float((background @ inside) / (shape @ inside) * _power(source.snr_db))


def _power(level_db: float) -> float:
    return float(10 ** (level_db / 10))


def _steady(level_dbfs: float) -> Power:
    return lambda heard: np.full(len(heard.time_s), _power(level_dbfs))


def _flow(
    sound: Sound, speed: float, span_s: tuple[float, float], frequency_hz: FloatArray, rng: np.random.Generator
) -> Source:
    drift = gauss_markov(span_s, sound.flow_drift_db, 60.0, rng)
    level = _power(sound.flow_dbfs)

    def power(heard: Heard) -> FloatArray:
        rush = 0.3 + 0.7 * (heard.speed_mps / speed) ** 2  # at a stop the water still passes
        return np.asarray(level * rush * 10 ** (drift(heard.time_s) / 10))

    return Source("flow", spectra.pink(frequency_hz), power)


def _rolling_shape(frequency_hz: FloatArray) -> FloatArray:
    return spectra.band(frequency_hz, 250.0, 2500.0)


def _rolling(
    scenario: Scenario, span_s: tuple[float, float], frequency_hz: FloatArray, rng: np.random.Generator
) -> Source:
    sound, speed = scenario.sound, scenario.drive.speed_mps
    drift = gauss_markov(span_s, sound.rolling_drift_db, 60.0, rng)
    level = _power(sound.rolling_dbfs)
    once, twice = sound.rolling_modulation
    phases = rng.uniform(0, 2 * np.pi, 2)

    def power(heard: Heard) -> FloatArray:
        phi = heard.rotation_rad
        swell = 1 + once * np.cos(phi + phases[0]) + twice * np.cos(2 * phi + phases[1])
        loud = level * (heard.speed_mps / speed) ** 3 * 10 ** (drift(heard.time_s) / 10)
        return np.asarray(loud * np.maximum(swell, 0.02))

    return Source("rolling", _rolling_shape(frequency_hz), power)


def _local(local: Local, background: FloatArray, frequency_hz: FloatArray, rng: np.random.Generator) -> Source:
    peak = peak_power(local, background, frequency_hz)
    phase, flutter_seed = float(rng.uniform(0, 2 * np.pi)), int(rng.integers(2**31))

    def power(heard: Heard) -> FloatArray:
        away = (heard.chainage_m - local.chainage_m) / local.half_width_m
        loud = peak / (1 + away**2) * (1 + local.turning * np.cos(heard.rotation_rad + phase))
        return np.asarray(loud * _gurgle(heard.time_s, local.flutter, flutter_seed))

    return Source(local.name or str(local.kind), spectra.bell(frequency_hz, local.centre_hz, local.octaves), power)


def _gurgle(time_s: FloatArray, flutter: float, seed: int) -> FloatArray:
    """Return a bubbling gain of mean about 1, the same at the same time however the run is cut into blocks."""
    if flutter == 0.0:
        return np.ones(len(time_s))
    rng = np.random.default_rng(seed)
    rates, phases = rng.uniform(2.0, 9.0, 6), rng.uniform(0, 2 * np.pi, 6)
    wave = np.sum(np.sin(2 * np.pi * rates * time_s[:, None] + phases), axis=1) / np.sqrt(3)
    return np.asarray(np.exp(flutter * wave - 0.5 * flutter**2))


def _timed(timed: Timed, background: FloatArray, frequency_hz: FloatArray) -> Source:
    peak = peak_power(timed, background, frequency_hz)
    sigma = timed.duration_s / 2.355

    def power(heard: Heard) -> FloatArray:
        return np.asarray(peak * np.exp(-0.5 * ((heard.time_s - timed.time_s) / sigma) ** 2))

    return Source(timed.name or str(timed.kind), spectra.bell(frequency_hz, timed.centre_hz, timed.octaves), power)


def _bends(sound: Sound, route: SmoothRoute) -> list[Local]:
    """A rumble at each bend of 10° and more, unless the scenario has silent ones."""
    if not sound.bends_rumble:
        return []
    return [
        Local(LeakClass.BEND, chainage, 1.0, 150.0, 1.6, sound.bend_snr_db, f"bend {i + 1}")
        for i, (chainage, angle) in enumerate(route.bends_m)
        if angle > np.radians(10)
    ]
