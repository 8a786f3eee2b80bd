"""Turns sound into a spectrum of orders, cycles per turn of the ball, window by window, and back.

Computed order tracking (Fyfe & Munck, MSSP 11 (1997) 187): the sound of a window is read at even steps of the angle
that the gyro measured instead of even steps of time, so that a tone locked to the rolling falls on one line of the
spectrum although the speed varies. The windows lie on a fixed grid of the recording's frames and overlap by half under
a Hann window, whose halves sum to one: whatever is taken out of their spectra joins without a seam, and no sample
depends on where reading began.
"""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy import fft, signal

from processing.sound.pcm import Samples
from processing.sound.rolling_noise import turned_angle
from processing.survey import ClockMap, FloatArray, ImuSamples

TURNS = 16.0  # in a window: longer parts line and noise better, shorter follows a line that wanders
_MIN_TURNS = 5.0  # fewer cannot be told from noise: the ball stands or creeps
_WINDOW_S = (3.0, 20.0)
_KNOT_S = 0.02
_THIN = 5.0  # thinned samples a period of the highest line: cubic interpolation is good to −35 dB there
_FINE = 1.5  # angle steps a thinned sample: speed may fall to two thirds of its mean before noise folds
_CLIP = 5.0  # sigmas: a bump is not to raise the noise of a whole window
_KEPT_WINDOWS = 4
_KEPT_BLOCKS = 3


class Frames(Protocol):
    """Reads samples of one channel from anywhere, as AudioReader does."""

    def read(self, start: int, count: int) -> Samples:
        """Return up to ``count`` samples from frame ``start`` on."""


@dataclass(frozen=True)
class Turning:
    """The angle that the ball has turned through, at even steps of the audio clock from its zero on."""

    step_s: float
    angle_rad: FloatArray  # (n,) never falls

    def knots(self, first_s: float, last_s: float) -> tuple[FloatArray, FloatArray]:
        """Return times and angles of the knots that enclose a span of the audio clock."""
        first = min(max(int(first_s / self.step_s) - 1, 0), len(self.angle_rad) - 2)
        end = min(max(int(last_s / self.step_s) + 3, first + 2), len(self.angle_rad))
        knots = np.arange(first, end, dtype=np.float64)
        # standing still must not stop the clock: times are read off the angle as well
        return knots * self.step_s, self.angle_rad[first:end] + 1e-9 * knots

    def between(self, first_s: float, last_s: float) -> float:
        """Return the turns between two moments of the audio clock."""
        times, angles = self.knots(first_s, last_s)
        at = np.interp([first_s, last_s], times, angles)
        return float(at[1] - at[0]) / (2 * np.pi)

    @property
    def usual_hz(self) -> float:
        """Median turns a second while the ball turns at all; 0 where it never does."""
        rate = np.diff(self.angle_rad[:: max(1, round(0.5 / self.step_s))]) / (2 * np.pi * 0.5)
        moving = rate[rate > 0.05]
        return float(np.median(moving)) if len(moving) else 0.0


def turning_of(imu: ImuSamples, clock: ClockMap, duration_s: float) -> Turning:
    """Return how the ball turns over the length of a recording, as the gyro says."""
    audio_s = np.arange(int(duration_s / _KNOT_S) + 3, dtype=np.float64) * _KNOT_S
    return Turning(_KNOT_S, turned_angle(imu, clock.to_survey(audio_s)))


@dataclass(frozen=True)
class OrderSpectrum:
    """The spectrum of one window: bin ``b`` is the order ``b / turns`` of the gyro's angle."""

    turns: float
    start_rad: float
    step_rad: float
    size: int  # angle steps in the window
    bins: npt.NDArray[np.complex64]  # (size // 2 + 1,)
    top: int  # bins that lie below the highest frequency of interest

    @property
    def power(self) -> npt.NDArray[np.float32]:
        """|bin|² (top,)."""
        kept = self.bins[: self.top]
        power: npt.NDArray[np.float32] = np.square(kept.real) + np.square(kept.imag)
        return power


@dataclass(frozen=True)
class _Around:
    """What was taken out of a window, along the angle."""

    start_rad: float
    step_rad: float
    sound: Samples


class OrderWindows:
    """Order spectra of a recording on a fixed grid of windows; bounded memory, any window at any time.

    Window ``j`` is centred on frame ``j · hop`` and reaches one hop to either side.
    """

    def __init__(
        self, reader: Frames, frames: int, sample_rate_hz: float, turning: Turning, highest_hz: float = 2500.0
    ) -> None:
        self._reader, self.frames, self.sample_rate_hz, self.turning = reader, frames, sample_rate_hz, turning
        self._thinning = max(1, int(sample_rate_hz / (_THIN * highest_hz)))
        self._highest_hz = min(highest_hz, 0.45 * sample_rate_hz)
        usual_hz = turning.usual_hz
        window_s = float(np.clip(TURNS / max(usual_hz, 1e-6), *_WINDOW_S))
        self.hop = max(1, round(0.5 * window_s * sample_rate_hz / self._thinning)) * self._thinning
        self._taps = _low_pass(self._thinning)
        self._blocks: OrderedDict[int, Samples] = OrderedDict()

    @property
    def count(self) -> int:
        """Windows that reach into the recording are 0 … count − 1."""
        return -(-self.frames // self.hop) + 1

    def turns(self, window: int) -> float:
        """Return how often the ball turns within a window."""
        hop_s = self.hop / self.sample_rate_hz
        return self.turning.between((window - 1) * hop_s, (window + 1) * hop_s)

    def spectrum(self, window: int) -> OrderSpectrum | None:
        """Return the spectrum of a window; None where the ball does not turn enough."""
        turns = self.turns(window)
        if turns < _MIN_TURNS:
            return None
        first = (window - 1) * self.hop
        thin = np.concatenate([self._block(window - 1), self._block(window)])
        limit = np.float32(_CLIP * 1.4826) * np.median(np.abs(thin[::5]))
        weight = np.square(np.sin(np.pi * np.arange(len(thin)) / len(thin))).astype(np.float32)
        thin = np.clip(thin, -limit, limit) * weight
        size = int(fft.next_fast_len(int(_FINE * len(thin)), real=True))
        step = 2 * np.pi * turns / size
        begin_s, end_s = first / self.sample_rate_hz, (first + 2 * self.hop) / self.sample_rate_hz
        times, angles = self.turning.knots(begin_s, end_s)
        start_rad = float(np.interp(begin_s, times, angles))
        at_s = np.interp(start_rad + step * np.arange(size), angles, times)
        bins = fft.rfft(cubic(thin, (at_s * self.sample_rate_hz - first) / self._thinning))
        top = min(len(bins), int(self._highest_hz * (end_s - begin_s)))
        return OrderSpectrum(turns, start_rad, step, size, bins, top)

    def _block(self, number: int) -> Samples:
        """Return the thinned sound of ``hop`` frames, zeros where there is no recording."""
        kept = self._blocks.get(number)
        if kept is None:
            margin = len(self._taps) // 2
            sound = padded(self._reader, number * self.hop - margin, (number + 1) * self.hop + margin, self.frames)
            filtered = signal.upfirdn(self._taps, sound, 1, self._thinning)
            skip = 2 * margin // self._thinning
            kept = filtered[skip : skip + self.hop // self._thinning].astype(np.float32, copy=False)
            self._blocks[number] = kept
            while len(self._blocks) > _KEPT_BLOCKS:
                self._blocks.popitem(last=False)
        return kept


class OrderParts:
    """The sum of what ``choose`` keeps of each window's spectrum, as sound of the recording's own rate."""

    def __init__(self, windows: OrderWindows, choose: Callable[[OrderSpectrum], npt.NDArray[np.complex64]]) -> None:
        self._windows, self._choose = windows, choose
        self._kept: OrderedDict[int, _Around | None] = OrderedDict()

    def read(self, start: int, count: int) -> Samples:
        """Return the chosen part (count,) from frame ``start`` on; the same samples however the reading is cut."""
        out = np.zeros(count, np.float32)
        hop = self._windows.hop
        at = start
        while at < start + count:
            block = at // hop
            end = min((block + 1) * hop, start + count)
            piece = out[at - start : end - start]
            for window in (block, block + 1):
                around = self._around(window)
                if around is not None:
                    piece += self._along(around, at, end)
            at = end
        return out

    def _along(self, around: _Around, first: int, end: int) -> Samples:
        rate = self._windows.sample_rate_hz
        times, angles = self._windows.turning.knots(first / rate, end / rate)
        angle = np.interp(np.arange(first, end) / rate, times, angles)
        return cubic(around.sound, (angle - around.start_rad) / around.step_rad)

    def _around(self, window: int) -> _Around | None:
        if window in self._kept:
            return self._kept[window]
        spectrum = self._windows.spectrum(window)
        around = None
        if spectrum is not None:
            sound = fft.irfft(self._choose(spectrum), spectrum.size).astype(np.float32, copy=False)
            around = _Around(spectrum.start_rad, spectrum.step_rad, sound)
        self._kept[window] = around
        while len(self._kept) > _KEPT_WINDOWS:
            self._kept.popitem(last=False)
        return around


def cubic(values: Samples, at: FloatArray) -> Samples:
    """Return ``values`` (n,) between its samples at the indices ``at`` (m,), by Catmull-Rom cubics; 0 far outside."""
    base = np.floor(at)
    t = (at - base).astype(np.float32)
    row = np.clip(base, -2, len(values)).astype(np.intp) + 2  # of the sample before, in the lengthened row
    long = np.pad(values, (3, 4))
    before, here, after, beyond = long[row], long[row + 1], long[row + 2], long[row + 3]
    half = np.float32(0.5)
    out: Samples = here + half * t * (
        (after - before) + t * (2 * before - 5 * here + 4 * after - beyond + t * (3 * (here - after) + beyond - before))
    )
    return out


def padded(reader: Frames, first: int, end: int, frames: int) -> Samples:
    """Return frames ``first`` to ``end``, zeros where there is no recording."""
    out = np.zeros(end - first, np.float32)
    inside, outside = max(first, 0), min(end, frames)
    if outside > inside:
        sound = reader.read(inside, outside - inside)
        out[inside - first : inside - first + len(sound)] = sound
    return out


def _low_pass(thinning: int) -> npt.NDArray[np.float32]:
    """Return taps that keep the lowest fifth of the thinned rate and stop what would fold onto it."""
    if thinning == 1:
        return np.ones(1, np.float32)
    half = 4 * thinning  # a whole number of thinned samples, so that the delay is one
    taps: npt.NDArray[np.float32] = signal.firwin(2 * half + 1, 1.0 / thinning, window=("kaiser", 5.0)).astype(
        np.float32
    )
    return taps
