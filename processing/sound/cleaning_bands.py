"""Weighs the bands of the sound in time: the quiet part of each turn counts most, and bumps are ducked.

Frames of about 46 ms under a sine window, overlapped by half, lie on a fixed grid; gains come from the frame, the
seconds around it on that grid, and what was learnt from the whole run, so no sample depends on where reading began.
"""

from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft, ndimage

from processing.settings import CleaningSettings
from processing.sound.bands import Grid
from processing.sound.orders import Frames, padded
from processing.sound.pcm import Samples
from processing.survey import BoolArray, FloatArray

_CHUNK = 32  # frames that are made at once, some 0.75 s
_CONTEXT = 16  # frames on either side, for the running median of 0.7 s
_MEDIAN = 31
_KEPT_CHUNKS = 4
_EVEN_S = 15.0  # over which the gain's power is held at one: many turns
_USUAL_S, _NOW_S = 20.0, 2.0
_GAIN_RANGE = (-2.0, 2.0)  # nepers
_BELOW = 1.0  # nepers of power, 4 dB
_QUIET = 1e-14  # power of a bin in digital silence


@dataclass(frozen=True)
class PhaseGains:
    """Gain of each band over time, locked to the turning: natural logarithms (t, b), row ``t`` at (t + ½)·step_s."""

    step_s: float
    log_gain: npt.NDArray[np.float16]

    def at(self, audio_s: FloatArray) -> npt.NDArray[np.float32]:
        """Return the gains (m, b) at moments that rise."""
        place = np.clip(audio_s / self.step_s - 0.5, 0.0, len(self.log_gain) - 1.0)
        first = np.minimum(place.astype(np.intp), max(len(self.log_gain) - 2, 0))
        last = np.minimum(first + 1, len(self.log_gain) - 1)
        share = (place - first).astype(np.float32)[:, None]
        low, high = self.log_gain[first].astype(np.float32), self.log_gain[last].astype(np.float32)
        mixed: npt.NDArray[np.float32] = low + share * (high - low)
        return mixed


def phase_gain(
    modulation: npt.NDArray[np.float32],
    depth: float,
    step_s: float,
    share: npt.NDArray[np.float32] | float = 1.0,
) -> npt.NDArray[np.float16]:
    """Return the logarithm (t,) of the gain for noise that the turning lifts by ``modulation`` (t,), power.

    The gain is m^-depth, times what keeps a steady sound (a leak) at its power over many turns: with depth 1 its square
    weighs power by 1/m², the optimum of an energy detector (acoustics §5.1 step 4). Where rolling is only a ``share``
    of the power, the gain is drawn towards 1, as Wiener would: else a loud leak would be made to pulse.
    """
    log_gain = -depth * share * np.log(np.maximum(modulation, 1e-3))
    size = max(1, round(_EVEN_S / step_s))
    power = ndimage.uniform_filter1d(np.exp(2 * log_gain).astype(np.float64), size, mode="nearest")
    even: npt.NDArray[np.float16] = np.clip(log_gain - 0.5 * np.log(power), *_GAIN_RANGE).astype(np.float16)
    return even


def usual_share(log_power: npt.NDArray[np.float32], step_s: float) -> npt.NDArray[np.float32]:
    """Return which share (t,) of a band's power over two seconds its usual level in the minute around makes up."""
    block = max(1, round(_USUAL_S / step_s))
    count = max(1, len(log_power) // block)
    middles = (np.arange(count) + 0.5) * block
    medians = [float(np.median(log_power[i * block : (i + 1) * block])) for i in range(count)]
    usual = ndimage.median_filter(np.array(medians), 3, mode="nearest")
    present = np.log(ndimage.uniform_filter1d(np.exp(log_power.astype(np.float64)), max(1, round(_NOW_S / step_s))))
    over = present - np.interp(np.arange(len(log_power)), middles, usual)
    share: npt.NDArray[np.float32] = np.exp(-np.maximum(over, 0.0)).astype(np.float32)
    return share


class BandCleaner:
    """Reads through another reader and weighs its bands; bounded memory, random access."""

    def __init__(
        self,
        reader: Frames,
        grid: Grid,
        bands_hz: FloatArray,
        gains: PhaseGains | None,
        settings: CleaningSettings,
    ) -> None:
        self._reader, self._grid, self._gains, self._settings = reader, grid, gains, settings
        self._hop = grid.window // 2
        bins = np.arange(grid.window // 2 + 1, dtype=np.float64) * grid.bin_hz
        middles = np.log(np.sqrt(bands_hz[:, 0] * bands_hz[:, 1]))
        place = np.interp(np.log(np.maximum(bins, 1.0)), middles, np.arange(len(middles)))
        self._band = np.minimum(place.astype(np.intp), max(len(middles) - 2, 0))
        self._next = np.minimum(self._band + 1, len(middles) - 1)
        self._share = (place - self._band).astype(np.float32)
        edges = np.clip(np.rint(bands_hz / grid.bin_hz).astype(np.intp), 0, len(bins) - 1)
        self._marks = np.column_stack([edges[:, 0], np.maximum(edges[:, 1], edges[:, 0] + 1)]).ravel()
        width = np.maximum(edges[:, 1] - edges[:, 0], 1)
        self._least_sigma = 1.2 / np.sqrt(width)  # of the logarithm of a sum of so many exponential variates
        self._high_pass = _high_pass(bins, settings.high_pass_hz)
        self._window = np.sin(np.pi * (np.arange(grid.window) + 0.5) / grid.window).astype(np.float32)
        self._chunks: OrderedDict[int, Samples] = OrderedDict()

    def read(self, start: int, count: int) -> Samples:
        """Return up to ``count`` samples from frame ``start`` on."""
        end = min(start + count, self._grid.frames)
        out = np.empty(max(0, end - start), np.float32)
        size, at = _CHUNK * self._hop, start
        while at < end:
            number = at // size
            last = min((number + 1) * size, end)
            out[at - start : last - start] = self._chunk(number)[at - number * size : last - number * size]
            at = last
        return out

    def ducked(self, number: int) -> BoolArray:
        """Return which frames (_CHUNK + 1,) of a chunk hold a bump in any band; see :attr:`chunk_s`."""
        _, _, bumps = self._measured(number)
        ducked: BoolArray = np.any(bumps < 0, axis=1, keepdims=False)
        return ducked

    @property
    def chunk_s(self) -> float:
        """Seconds in a chunk; its frames lie chunk_s / 32 apart, the first at its beginning."""
        return _CHUNK * self._hop / self._grid.sample_rate_hz

    def _chunk(self, number: int) -> Samples:
        kept = self._chunks.get(number)
        if kept is None:
            spectra, steady, bumps = self._measured(number)
            log_gain = steady + bumps
            lower, upper = log_gain[:, self._band], log_gain[:, self._next]
            gain = np.exp(lower + self._share * (upper - lower)) * self._high_pass
            frames = fft.irfft(spectra * gain, self._grid.window, axis=1).astype(np.float32, copy=False)
            frames *= self._window
            kept = (frames[:-1, self._hop :] + frames[1:, : self._hop]).ravel()
            self._chunks[number] = kept
            while len(self._chunks) > _KEPT_CHUNKS:
                self._chunks.popitem(last=False)
        return kept

    def _measured(
        self, number: int
    ) -> tuple[npt.NDArray[np.complex64], npt.NDArray[np.float32], npt.NDArray[np.float32]]:
        """Return spectra (n, bins) of a chunk's frames, the turning's gain (n, bands) and that of bumps (n, bands)."""
        hop, window = self._hop, self._grid.window
        first = number * _CHUNK - _CONTEXT
        count = _CHUNK + 1 + 2 * _CONTEXT
        sound = padded(self._reader, (first - 1) * hop, (first + count) * hop, self._grid.frames)
        view = np.lib.stride_tricks.sliding_window_view(sound, window)[::hop]
        spectra = fft.rfft(view * self._window, axis=1)
        power = np.square(spectra.real) + np.square(spectra.imag)
        level: npt.NDArray[np.float32] = np.log(
            np.add.reduceat(power, self._marks, axis=1)[:, ::2] + np.float32(_QUIET)
        )
        middles_s = (first + np.arange(count, dtype=np.float64)) * (hop / self._grid.sample_rate_hz)
        steady = np.zeros_like(level) if self._gains is None else self._gains.at(middles_s)
        depth = self._settings.rolling_depth
        swell = -steady / depth if depth > 0 else np.zeros_like(level)  # ln m, but for a constant
        bumps = self._bumps(level - swell)
        own = slice(_CONTEXT, _CONTEXT + _CHUNK + 1)
        return spectra[own], steady[own], bumps[own]

    def _bumps(self, level: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Return the logarithm of the gain (n, bands) that brings a bump somewhat below the median around it.

        Below, because a crack is shorter than a frame: with the power of quiet frames it would still be heard.
        """
        over = level - ndimage.median_filter(level, (_MEDIAN, 1), mode="nearest")
        sigma = np.maximum(1.4826 * np.median(np.abs(over), axis=0), self._least_sigma)
        struck = over > self._settings.impulse_sigmas * sigma
        struck = ndimage.binary_dilation(struck, np.ones((3, 1), np.bool_))
        ducked: npt.NDArray[np.float32] = np.where(struck, -0.5 * np.maximum(over + _BELOW, 0), 0).astype(np.float32)
        return ducked


def _high_pass(bins_hz: FloatArray, corner_hz: float) -> npt.NDArray[np.float32]:
    """Return the gain (bins,) of a zero-phase Butterworth high-pass of fourth order; ones where ``corner_hz`` is 0."""
    if corner_hz <= 0:
        return np.ones(len(bins_hz), np.float32)
    ratio = (bins_hz / corner_hz) ** 4
    gain: npt.NDArray[np.float32] = (ratio / (1 + ratio)).astype(np.float32)
    return gain
