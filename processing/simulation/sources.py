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
    return (flow, rolling, *still, *placed, *timed, *_scraping(scenario, span_s, frequency_hz, rng))


def background_shape(scenario: Scenario, frequency_hz: FloatArray) -> FloatArray:
    """Return power per bin of flow and rolling noise at nominal speed, without drift: what SNRs refer to."""
    sound = scenario.sound
    rolling = _rolling_shape(sound, frequency_hz) * _power(sound.rolling_dbfs)
    return _power(sound.flow_dbfs) * _flow_shape(sound, frequency_hz) + rolling


def peak_power(source: Local | Timed, background: FloatArray, frequency_hz: FloatArray) -> float:
    """Return the power (of full scale) that stands ``snr_db`` above ``background`` within the source's own band."""
    shape = shape_of(source, frequency_hz)
    inside = spectra.in_band(frequency_hz, source.centre_hz, source.octaves)
    return float((background @ inside) / (shape @ inside) * _power(source.snr_db))


def shape_of(source: Local | Timed, frequency_hz: FloatArray) -> FloatArray:
    """Return the share of its power that each bin holds."""
    if isinstance(source, Local) and source.spectrum:
        return spectra.through(frequency_hz, source.spectrum)
    return spectra.bell(frequency_hz, source.centre_hz, source.octaves)


def passing(local: Local, chainage_m: FloatArray) -> FloatArray:
    """Return the share of its power that is heard at each chainage, 1 at closest approach."""
    beyond = chainage_m - local.chainage_m
    stretch = np.where(beyond > 0, np.sqrt(local.skew), 1 / np.sqrt(local.skew))
    away = np.abs(beyond) / (local.half_width_m * stretch)
    return np.asarray(2.0**-away if local.shape == "exponential" else 1 / (1 + away**2))


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

    return Source("flow", _flow_shape(sound, frequency_hz), power)


def _flow_shape(sound: Sound, frequency_hz: FloatArray) -> FloatArray:
    return spectra.coloured(frequency_hz, sound.flow_slope, sound.flow_corner_hz)


def _rolling_shape(sound: Sound, frequency_hz: FloatArray) -> FloatArray:
    return spectra.band(frequency_hz, *sound.rolling_band_hz)


def _rolling(
    scenario: Scenario, span_s: tuple[float, float], frequency_hz: FloatArray, rng: np.random.Generator
) -> Source:
    sound, speed = scenario.sound, scenario.drive.speed_mps
    drift = gauss_markov(span_s, sound.rolling_drift_db, 60.0, rng)
    level = _power(sound.rolling_dbfs)
    once, twice = sound.rolling_modulation
    thrice = sound.rolling_third
    phases = rng.uniform(0, 2 * np.pi, 3 if thrice else 2)

    def power(heard: Heard) -> FloatArray:
        phi = heard.rotation_rad
        swell = 1 + once * np.cos(phi + phases[0]) + twice * np.cos(2 * phi + phases[1])
        if thrice:
            swell = swell + thrice * np.cos(3 * phi + phases[2])
        loud = level * (heard.speed_mps / speed) ** 3 * 10 ** (drift(heard.time_s) / 10)
        return np.asarray(loud * np.maximum(swell, 0.02))

    return Source("rolling", _rolling_shape(sound, frequency_hz), power)


def _local(local: Local, background: FloatArray, frequency_hz: FloatArray, rng: np.random.Generator) -> Source:
    peak = peak_power(local, background, frequency_hz)
    phase, flutter_seed = float(rng.uniform(0, 2 * np.pi)), int(rng.integers(2**31))

    def power(heard: Heard) -> FloatArray:
        facing = 1 + local.turning * np.cos(heard.rotation_rad + phase)
        loud = peak * passing(local, heard.chainage_m) * facing
        return np.asarray(loud * _gurgle(heard.time_s, local.flutter, flutter_seed))

    return Source(local.name or str(local.kind), shape_of(local, frequency_hz), power)


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

    return Source(timed.name or str(timed.kind), shape_of(timed, frequency_hz), power)


def _scraping(
    scenario: Scenario, span_s: tuple[float, float], frequency_hz: FloatArray, rng: np.random.Generator
) -> list[Source]:
    """Bursts at random times, each as long as a draw from an exponential law, silent while the device stands."""
    scraping, nominal = scenario.sound.scraping, scenario.drive.speed_mps
    if scraping.per_minute <= 0.0:
        return []
    count = rng.poisson(scraping.per_minute * (span_s[1] - span_s[0]) / 60)
    starts = np.sort(rng.uniform(*span_s, count))
    ends = starts + rng.exponential(scraping.duration_s, count)
    level = _power(scraping.level_dbfs)

    def power(heard: Heard) -> FloatArray:
        begun = np.searchsorted(starts, heard.time_s, side="right")
        latest = np.concatenate([[-np.inf], np.maximum.accumulate(ends)])  # bursts may overlap
        return np.asarray(level * (heard.time_s < latest[begun]) * np.minimum(heard.speed_mps / nominal, 1.0) ** 2)

    return [Source("scraping", spectra.band(frequency_hz, *scraping.band_hz), power)]


def _bends(sound: Sound, route: SmoothRoute) -> list[Local]:
    """A rumble at each bend of 10° and more, unless the scenario has silent ones."""
    if not sound.bends_rumble:
        return []
    return [
        Local(LeakClass.BEND, chainage, 1.0, 150.0, 1.6, sound.bend_snr_db, f"bend {i + 1}")
        for i, (chainage, angle) in enumerate(route.bends_m)
        if angle > np.radians(10)
    ]
