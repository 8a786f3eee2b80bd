"""Band levels of synthetic drifts with known leaks, after acoustics §5.2, made without any sound file."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from processing.settings import SoundSettings
from processing.sound.bands import Grid, band_table, is_low
from processing.sound.scan import SoundScan
from processing.survey import ClockMap, Track

RATE = 44100


@dataclass(frozen=True)
class Leak:
    place_m: float
    width_m: float = 1.5
    snr_db: float = 10.0
    centre_hz: float = 1300.0
    octaves: float = 1.8


@dataclass(frozen=True)
class Run:
    scan: SoundScan
    track: Track
    clock: ClockMap
    time_s: np.ndarray
    chainage_m: np.ndarray
    speed_mps: np.ndarray


def slow(rng, count, tau):
    """Return unit noise that varies over ``tau`` samples."""
    knots = rng.standard_normal(int(count / tau) + 4)
    values = np.interp(np.arange(count) / tau, np.arange(len(knots)), knots)
    return values / values.std()


def drift(leaks=(), seed=0, seconds=400.0, speed=0.6, stops=(), rolling_db=3.0, bumps=True, extra=None, sigma_m=0.1):
    """Return a run at about ``speed``; ``extra(run_time_s, chainage_m, band_hz)`` adds power relative to the flow."""
    rng = np.random.default_rng(seed)
    grid = Grid(RATE, int(seconds * RATE))
    bands = band_table(RATE, SoundSettings())
    hz, width, low = np.sqrt(bands[:, 0] * bands[:, 1]), bands[:, 1] - bands[:, 0], is_low(bands)
    count, step = grid.level_count, grid.level_s
    time = (np.arange(count) + 0.5) * step
    velocity = np.clip(speed * (1 + 0.15 * slow(rng, count, 40 / step)), 0.2, 1.2)
    for begin, length in stops:
        velocity[(time > begin) & (time < begin + length)] = 0.0
    place = np.cumsum(velocity) * step
    flow = width / hz
    power = flow * (10 ** (0.15 * slow(rng, count, 60 / step)))[:, None]
    turn = place / 0.08
    modulation = np.clip(1 + 0.6 * np.cos(turn) + 0.25 * np.cos(2 * turn), 0.05, None) * (velocity / speed) ** 3
    audible = (hz > 250) & (hz < 2500)
    power += (
        10 ** (rolling_db / 10) * flow * audible * (modulation * 10 ** (0.2 * slow(rng, count, 60 / step)))[:, None]
    )
    usual = np.median(power[velocity > 0.1], axis=0)
    for leak in leaks:
        spectrum = np.exp(-0.5 * (np.log2(hz / leak.centre_hz) / (leak.octaves / 2.355)) ** 2) * width
        inside = np.abs(np.log2(hz[:-1] / leak.centre_hz)) < leak.octaves / 2
        spectrum *= 10 ** (leak.snr_db / 10) * usual[:-1][inside].sum() / spectrum[:-1][inside].sum()
        chosen = (hz[:-1] > bands[-1, 0]) & (hz[:-1] < bands[-1, 1])
        spectrum[-1] = spectrum[:-1][chosen].sum()
        power += spectrum / (1 + ((place - leak.place_m) / leak.width_m) ** 2)[:, None]
    if extra is not None:
        power += flow * extra(time, place, hz)
    if bumps:
        for at in np.arange(2.0, place[-1], 5.3):
            row = int(np.searchsorted(place, at))
            power[row : row + 2] += 30 * flow * rng.uniform(0.2, 1.0)
    freedom = np.maximum(np.where(low, width * 0.13, width * step), 1.0)
    power *= rng.gamma(freedom, 1, power.shape) / freedom
    level = (10 * np.log10(power) - 60).astype(np.float16)
    zeros = np.zeros(count, np.uint8)
    scan = SoundScan(
        Path(), grid, bands, level, np.zeros_like(level), zeros, zeros, tiles=None, wave=None, findings=()
    )  # fmt: skip
    track_time = np.arange(0, seconds, 0.05)
    chainage = np.interp(track_time, time, place)
    flat = np.zeros(len(track_time))
    track = Track(
        track_time, chainage, np.column_stack([chainage, flat, flat]), flat + sigma_m, flat + sigma_m, flat + sigma_m,
        np.tile([1.0, 0, 0, 0], (len(flat), 1)), np.interp(track_time, time, velocity), "truth",
    )  # fmt: skip
    return Run(scan, track, ClockMap(), time, place, velocity)
