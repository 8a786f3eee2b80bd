"""Finds the tones that are locked to the turning of the ball, and takes them out of the sound without taking the leak.

A line is a peak that stays at one order while the speed varies. The orders are those of the gyro's own angle, so a
constant error of its scale moves them and does no harm; what the scale changes along the way is tracked in each
window from the lines themselves. In each window a line's bins are weighed as Wiener would (1 − noise / power, the noise
from the bins on both sides), so that where there is no line, nothing is taken.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.progress import Progress, silent
from processing.sound.orders import OrderParts, OrderSpectrum, OrderWindows
from processing.sound.pcm import Samples
from processing.survey import FloatArray

_LISTENED = 48  # windows over the whole run from which the lines are learnt
_FEWEST = 4
_REACH = 2  # bins on either side of a line's nearest boundary: the Hann window's main lobe
_SIDE = np.array([-9, -8, -7, -6, -5, -4, 4, 5, 6, 7, 8, 9])  # where the noise beside a line is measured
_SIDE_BIAS = 0.72  # median of twelve exponential variates of mean 1
_FLOOR_BINS = 48
_MOST = 30.0  # one window's peak counts at most so many times the noise
_SIGMAS = 6.0
_MARGIN = 0.35  # of the noise: what its estimate may be off
_SPREAD = 0.0075  # the scale is looked for so far around 1 in each window
_SEARCHED_LINES = 40
_HEARD = 2.0  # power over noise from which a window's line is taken out
_SCALES = 1.0 + 0.0005 * np.arange(-120, 121)
_NEAR_WHOLE = 0.04
_MOST_LINES = 400


@dataclass(frozen=True)
class RollingLines:
    """The orders (k,) of the gyro's angle at which the rolling sounds, rising, with their power over the noise."""

    orders: FloatArray
    over_noise: FloatArray
    scale: float | None = None  # true turns a turn of the gyro, where most orders are near whole multiples of it


NO_LINES = RollingLines(np.zeros(0), np.zeros(0))


def learn_lines(windows: OrderWindows, progress: Progress | None = None) -> RollingLines:
    """Return the lines that stand out in windows spread over the recording, in the mean over those in which it turns.

    Raises:
        LeaklineError: AUDIO_UNREADABLE.
        Cancelled: the operator stopped it.
    """
    progress = progress or silent()
    enough = 0.5 * windows.turning.usual_hz * 2 * windows.hop / windows.sample_rate_hz
    able = [j for j in range(windows.count) if windows.turns(j) >= max(enough, 1.0)]
    chosen = [able[i] for i in np.unique(np.linspace(0, len(able) - 1, _LISTENED).astype(int))] if able else []
    peaks: list[tuple[float, npt.NDArray[np.float32]]] = []
    for number, window in enumerate(chosen):
        progress.update(number / len(chosen), "cleaning_listening")
        spectrum = windows.spectrum(window)
        if spectrum is not None:
            peaks.append((spectrum.turns, over_noise(spectrum)))
    if len(peaks) < _FEWEST:
        return NO_LINES
    scales = np.ones(len(peaks))
    lines = _standing_out(peaks, scales)
    for _ in range(2):  # with the scales aligned, higher orders come out
        if not len(lines.orders):
            return NO_LINES
        scales = np.array([_scale_of(lines, turns, over) for turns, over in peaks])
        lines = _standing_out(peaks, scales)
    progress.update(1.0)
    return RollingLines(lines.orders, lines.over_noise, _whole_scale(lines))


def over_noise(spectrum: OrderSpectrum) -> npt.NDArray[np.float32]:
    """Return the power over the noise floor (top,), summed over three bins of the Hann window's main lobe."""
    power = spectrum.power
    blocks = max(1, len(power) // _FLOOR_BINS)
    whole = power[: blocks * _FLOOR_BINS].reshape(blocks, -1)
    floor = np.median(whole, axis=1) / np.float32(np.log(2))
    middles = (np.arange(blocks) + 0.5) * whole.shape[1]
    smooth = np.exp(np.interp(np.arange(len(power)), middles, np.log(np.maximum(floor, 1e-30))))
    wide = power.copy()
    wide[1:] += power[:-1]
    wide[:-1] += power[1:]
    ratio: npt.NDArray[np.float32] = (wide / (3 * smooth)).astype(np.float32)
    return ratio


def _standing_out(peaks: list[tuple[float, npt.NDArray[np.float32]]], scales: FloatArray) -> RollingLines:
    """Return the orders at which the mean over the windows is more than chance makes it."""
    step = 0.5 / float(np.median([turns for turns, _ in peaks]))
    highest = max(len(over) / turns for turns, over in peaks)
    order = step * np.arange(1, int(highest / step), dtype=np.float64)
    total, number, sharp = np.zeros(len(order)), np.zeros(len(order)), np.zeros(len(order))
    for (turns, over), scale in zip(peaks, scales, strict=True):
        bins = np.rint(order * (scale * turns)).astype(np.intp)
        inside = bins < len(over)
        heights = over[bins[inside]]
        total[inside] += np.minimum(heights, _MOST)
        sharp[inside] += np.log(np.maximum(heights, 0.1))
        number[inside] += 1
    mean = total / np.maximum(number, 1)
    rank = sharp / np.maximum(number, 1)  # the mean is flat on top of a strong line, this is not
    # three bins under a Hann window are worth two independent ones
    needed = 1.0 + _MARGIN + _SIGMAS * np.sqrt(0.5 / np.maximum(number, 1))
    around = np.lib.stride_tricks.sliding_window_view(np.pad(rank, 4), 9).max(axis=1)
    found = np.flatnonzero((mean > needed) & (rank >= around) & (number >= _FEWEST))
    found = np.sort(found[np.argsort(-mean[found], kind="stable")][:_MOST_LINES])
    return RollingLines(order[found], mean[found])


def _scale_of(lines: RollingLines, turns: float, over: npt.NDArray[np.float32]) -> float:
    """Return by what the lines' orders must be multiplied in this window."""
    strongest = np.argsort(-lines.over_noise, kind="stable")[:_SEARCHED_LINES]
    orders = lines.orders[strongest]
    step = 0.25 / (turns * float(orders.max()))
    count = int(min(_SPREAD / step, 400))
    scales = 1.0 + step * np.arange(-count, count + 1)
    bins = np.rint(np.outer(scales, orders) * turns).astype(np.intp)
    heights = np.where(bins < len(over), over[np.minimum(bins, len(over) - 1)], 1.0)
    score = np.log(np.maximum(heights, 0.5)).sum(axis=1)
    # chance makes a maximum among many: what is not clearly better than no change is no change
    best = int(np.argmax(score))
    return float(scales[best]) if score[best] > score[count] + 3.0 else 1.0


def _whole_scale(lines: RollingLines) -> float | None:
    """Return the scale that makes the orders whole numbers; None where no scale does so better than chance."""
    low = lines.orders * _NEAR_WHOLE < 0.5 / 0.06  # higher ones are near some whole number at any scale
    orders, weight = lines.orders[low], np.log(lines.over_noise[low])
    if len(orders) < 3:
        return None
    turned = np.outer(_SCALES, orders)
    off = np.abs(turned - np.rint(turned))
    score = ((off < _NEAR_WHOLE) * weight).sum(axis=1) / weight.sum()
    best = score >= score.max() - 1e-9
    return float(np.median(_SCALES[best])) if score.max() > 0.7 else None


class LineRemover:
    """Gives the sum of the rolling lines; bounded memory, random access, the same samples however it is cut."""

    def __init__(self, windows: OrderWindows, lines: RollingLines) -> None:
        self._lines = lines
        self._parts = OrderParts(windows, self.chosen)

    def read(self, start: int, count: int) -> Samples:
        """Return the lines' sound (count,) from frame ``start`` on."""
        if not len(self._lines.orders):
            return np.zeros(count, np.float32)
        return self._parts.read(start, count)

    def chosen(self, spectrum: OrderSpectrum) -> npt.NDArray[np.complex64]:
        """Return the spectrum of the lines alone: each bin times the largest gain of the lines that reach it."""
        gains = self.gains(spectrum)
        out: npt.NDArray[np.complex64] = np.zeros_like(spectrum.bins)
        out[: len(gains)] = spectrum.bins[: len(gains)] * gains
        return out

    def gains(self, spectrum: OrderSpectrum) -> npt.NDArray[np.float32]:
        """Return the weight (top,) with which each bin belongs to a line, 0 … 1."""
        power = spectrum.power
        gains = np.zeros(len(power), np.float32)
        if not len(self._lines.orders):
            return gains
        scale = _scale_of(self._lines, spectrum.turns, over_noise(spectrum))
        places = self._lines.orders * (scale * spectrum.turns)
        places = places[(places > -_SIDE[0]) & (places < len(power) - _SIDE[-1] - 1)]
        if not len(places):
            return gains
        near = np.floor(places).astype(np.intp)[:, None] + np.arange(1 - _REACH, 1 + _REACH)
        beside = np.rint(places).astype(np.intp)[:, None] + _SIDE
        noise = np.median(power[beside], axis=1) / _SIDE_BIAS
        ratio = power[near].mean(axis=1) / np.maximum(noise, 1e-30)
        gain = np.where(ratio > _HEARD, 1.0 - 1.0 / np.maximum(ratio, 1.0), 0.0).astype(np.float32)
        np.maximum.at(gains, near.ravel(), np.repeat(gain, near.shape[1]))
        return gains
