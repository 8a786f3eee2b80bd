"""Sound of a rolling ball from closed forms: lines at known orders, noise that swells with the turn, bumps, a leak."""

from dataclasses import dataclass

import numpy as np
import soundfile

from processing.settings import DetectorSettings, SoundSettings
from processing.sound.cells import frames_of
from processing.sound.orders import Turning
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import ClockMap, ImuSamples, Track

RATE_HZ = 8000
TURNS_HZ = 1.4
RADIUS_M = 0.08
ORDERS = (3, 7, 12, 25, 40, 64, 90, 150, 220)


class Memory:
    """Reads samples of an array, as AudioReader does of a file."""

    def __init__(self, sound):
        self.sound = sound

    def read(self, start, count):
        return self.sound[start : start + count]


@dataclass(frozen=True)
class Roll:
    time_s: np.ndarray
    angle_rad: np.ndarray  # true

    def turning(self, scale=1.0):
        """Return what a gyro says whose scale is off."""
        knots = np.arange(0.0, self.time_s[-1] + 0.06, 0.02)
        return Turning(0.02, scale * np.interp(knots, self.time_s, self.angle_rad))

    def lines(self, rms, orders=ORDERS, seed=1):
        """Return tones of equal strength at these orders of the true angle."""
        phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(orders))
        tones = [np.cos(order * self.angle_rad + phase) for order, phase in zip(orders, phases, strict=True)]
        return (rms * np.sqrt(2) * np.sum(tones, axis=0)).astype(np.float32)

    def swelling(self, rms, depth=0.7, seed=2):
        """Return white noise whose power is 1 + depth·cos of the true angle."""
        noise = rms * np.random.default_rng(seed).standard_normal(len(self.time_s))
        return (noise * np.sqrt(1 + depth * np.cos(self.angle_rad))).astype(np.float32)


def roll(seconds=64.0, variation=0.15, seed=0):
    """Return a ball that turns at a speed that wanders."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(int(seconds * RATE_HZ)) / RATE_HZ
    knots = np.arange(0.0, seconds + 8.0, 4.0)
    rate = TURNS_HZ * (1 + variation * np.interp(time_s, knots, np.clip(rng.standard_normal(len(knots)), -2, 2)))
    return Roll(time_s, 2 * np.pi * np.cumsum(rate) / RATE_HZ)


def noise(count, rms, seed=5):
    return (rms * np.random.default_rng(seed).standard_normal(count)).astype(np.float32)


def over_between_db(sound, angle_rad, orders, turns=16):
    """Return by how many decibels the true orders stand over what lies between, by the FFT over even angles."""
    steps = 8192 * turns  # so finely that lines up to some hundred orders are read rightly between samples
    hits, beside = [], []
    for start in np.arange(angle_rad[0], angle_rad[-1] - 2 * np.pi * turns, 2 * np.pi * turns):
        even = np.interp(start + 2 * np.pi * turns * np.arange(steps) / steps, angle_rad, sound)
        power = np.square(np.abs(np.fft.rfft(even * np.hanning(steps))))
        bins = turns * np.array(orders)
        hits.append(power[bins])
        beside.append(np.concatenate([power[bins + turns // 2], power[bins + turns // 2 - 2]]))
    return 10 * np.log10(np.mean(hits) / np.mean(beside))


def level_db(sound):
    return 10 * np.log10(np.mean(np.square(sound, dtype=np.float64)))


@dataclass(frozen=True)
class Recorded:
    """All that learning needs."""

    audio: object
    imu: ImuSamples
    scan: object
    frames: object
    track: Track
    clock: ClockMap


def recorded(folder, run, sound, gyro_scale=1.0):
    """Write the sound and return it with what gyro and pass say of it."""
    folder.mkdir(parents=True, exist_ok=True)
    soundfile.write(folder / "sound.wav", sound, RATE_HZ, subtype="FLOAT")
    audio, _ = open_audio([folder / "sound.wav"])
    time_s = np.arange(0.0, run.time_s[-1], 0.01)
    angle = np.interp(time_s, run.time_s, run.angle_rad)
    rate = gyro_scale * np.gradient(angle, time_s)
    still = np.zeros_like(rate)
    acc = np.random.default_rng(3).normal((0.0, 0.0, 9.81), 0.05, (len(rate), 3))
    imu = ImuSamples(time_s, acc, np.column_stack([still, rate, still]), np.ones(len(rate), bool))
    scanned = scan(audio, SoundSettings(), out_dir=folder / "scan", threads=1)
    chainage = RADIUS_M * angle
    track = Track(
        time_s, chainage, np.column_stack([chainage, still, still]), still + 0.1, still + 0.1, still + 0.1,
        np.tile([1.0, 0, 0, 0], (len(still), 1)), RADIUS_M * rate / gyro_scale, "truth",
    )  # fmt: skip
    clock = ClockMap()
    return Recorded(audio, imu, scanned, frames_of(scanned, clock, track, (), DetectorSettings()), track, clock)
