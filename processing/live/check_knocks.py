"""Hears and feels the knocks on the ball while they are made, and pairs them by the host's clock."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.live.stream import MotionBlock, SoundBlock
from processing.sound.onsets import first_quarter, imu_events, rises
from processing.survey import FloatArray, ImuSamples

STEP_S = 0.001
_MIN_RISE_DB = 12.0  # a knock on the shell is far louder than what else happens on a bench
_FLOOR_DB = -150.0
_MIN_FORCE_MPS2 = 4.0
_APART_S = 0.1
_SEARCH_S = 0.4  # the latencies of sound card and link differ by less
_FEWEST_ROWS = 16


@dataclass(frozen=True)
class Knocks:
    """Knocks on the host's clock: heard (n,), felt (m,), and the pairs (k,) of both with how far they lie apart."""

    heard_s: FloatArray
    felt_s: FloatArray
    paired_s: FloatArray
    apart_s: FloatArray  # heard − felt

    @property
    def jitter_s(self) -> float:
        """The rms scatter of the pairs' distance about its median."""
        if not len(self.apart_s):
            return float("nan")
        return float(np.sqrt(np.mean((self.apart_s - np.median(self.apart_s)) ** 2)))

    @property
    def irregularity(self) -> float:
        """By how much the intervals differ, as a share of their mean; 0 for a metronome."""
        steps = np.diff(self.paired_s)
        return float(np.ptp(steps) / np.mean(steps)) if len(steps) > 1 else 0.0


class KnockEar:
    """Turns sound blocks into the level of their high-passed energy, one value a millisecond, and finds the blows."""

    def __init__(self, rate_hz: float) -> None:
        self._step = max(1, round(rate_hz * STEP_S))
        self._rate_hz = rate_hz
        self._left = np.zeros(0)
        self._levels: list[npt.NDArray[np.float32]] = []
        self._first_frame: int | None = None
        self._offsets_s: list[float] = []
        self._last = 0.0

    def add(self, block: SoundBlock) -> None:
        """Take the next block; of several channels the first counts."""
        wave = block.frames[:, 0] / 2.0**31
        if self._first_frame is None:
            self._first_frame, self._last = block.first_frame, float(wave[0]) if len(wave) else 0.0
        self._offsets_s.append(block.adc_host_s - block.first_frame / self._rate_hz)
        if block.lost_before:
            wave = np.concatenate([np.zeros(min(block.lost_before, int(60 * self._rate_hz))), wave])
        high = np.concatenate([self._left, np.diff(wave, prepend=self._last)])
        self._last = float(wave[-1]) if len(wave) else self._last
        whole = len(high) // self._step * self._step
        power = (high[:whole].reshape(-1, self._step) ** 2).mean(axis=1)
        self._levels.append(np.asarray(10 * np.log10(power + 10 ** (_FLOOR_DB / 10)), np.float32))
        self._left = high[whole:]

    def knocks_s(self) -> FloatArray:
        """Return the moments (n,) of the blows so far, host time."""
        if self._first_frame is None or not self._levels:
            return np.zeros(0)
        level = np.concatenate(self._levels)
        step_s = self._step / self._rate_hz
        peaks, strength = rises(level, step_s)
        loud = level[np.minimum(peaks + 4, len(level) - 1)] > np.median(level) + _MIN_RISE_DB
        peaks = peaks[(strength >= _MIN_RISE_DB) & loud]
        start_s = float(np.median(self._offsets_s)) + self._first_frame / self._rate_hz
        moments = np.array([first_quarter(level, int(peak), step_s) * step_s for peak in peaks]) + start_s
        return _apart(moments)


class KnockFeel:
    """Gathers IMU blocks and finds the blows in them."""

    def __init__(self) -> None:
        self._blocks: list[ImuSamples] = []
        self._offsets_s: list[float] = []

    def add(self, block: MotionBlock) -> None:
        """Take the next block."""
        if len(block.imu.time_s):
            self._blocks.append(block.imu)
            self._offsets_s.append(block.arrived_host_s - float(block.imu.time_s[-1]))

    def knocks_s(self) -> FloatArray:
        """Return the moments (n,) of the blows so far, host time; the quickest arrivals tell the offset."""
        if sum(len(imu.time_s) for imu in self._blocks) < _FEWEST_ROWS:
            return np.zeros(0)
        joined = ImuSamples(
            np.concatenate([imu.time_s for imu in self._blocks]),
            np.concatenate([imu.acc_s_mps2 for imu in self._blocks]),
            np.concatenate([imu.gyr_s_radps for imu in self._blocks]),
            np.concatenate([imu.valid for imu in self._blocks]),
        )
        events = imu_events(joined)
        size = np.linalg.norm(joined.acc_s_mps2, axis=1)
        away = np.abs(size - np.median(size))
        rows = np.searchsorted(joined.time_s, events.time_s)
        around = np.clip(rows[:, None] + np.arange(-2, 3), 0, len(away) - 1)
        strong = away[around].max(axis=1) >= _MIN_FORCE_MPS2 if len(rows) else np.zeros(0, np.bool_)
        return _apart(events.time_s[strong] + min(self._offsets_s))


def _apart(moments_s: FloatArray) -> FloatArray:
    """Drop what follows another within a tenth of a second: a blow that bounced."""
    keep = np.diff(moments_s, prepend=-np.inf) > _APART_S
    return moments_s[keep]


def pair_knocks(heard_s: FloatArray, felt_s: FloatArray, tolerance_s: float) -> Knocks:
    """Pair what was heard with what was felt at the one distance (within ±0.4 s) that fits most of them best."""
    best: tuple[int, float, FloatArray, FloatArray] = (0, np.inf, np.zeros(0), np.zeros(0))
    for shift in (heard_s[:, None] - felt_s[None, :]).ravel():
        if abs(shift) > _SEARCH_S:
            continue
        near = np.abs(heard_s[:, None] - felt_s[None, :] - shift)
        partner = np.argmin(near, axis=0) if len(heard_s) else np.zeros(0, int)
        fits = near[partner, np.arange(len(felt_s))] <= tolerance_s
        apart = (heard_s[partner] - felt_s)[fits]
        scatter = float(np.ptp(apart)) if len(apart) else np.inf
        if (-len(apart), scatter) < (-best[0], best[1]):
            best = (len(apart), scatter, felt_s[fits], apart)
    return Knocks(heard_s, felt_s, best[2], best[3])
