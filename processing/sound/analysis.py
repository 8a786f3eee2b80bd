"""Turns a piece of sound into levels, picture columns, waveform envelope and onsets: the work of one pass, in blocks.

Numbers are chosen by measurement (acoustics §3): float32 FFTs in blocks that fit the processor's cache, one walk over
each block's memory, logarithms only after pooling, and nothing per window in Python.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import fft

from processing.settings import SoundSettings
from processing.sound import kernels_pass, plain_pass
from processing.sound.bands import (
    HANN_ENBW,
    LEVELS_PER_COLUMN,
    Grid,
    Spectrum,
    band_edges,
    band_table,
    decibels,
    is_low,
    low_band_bins,
)
from processing.sound.pcm import Samples
from processing.sound.soundness import CLIPPED, DROPOUT, SILENT, clipped_at, hum_excess_db
from processing.sound.tile_values import Bytes, max_of_rows, mean_of_rows, pooled, to_tile
from processing.survey import FloatArray

Halves = npt.NDArray[np.float16]

PART_COLUMNS = 64  # picture columns of one piece, about 12 s: whole rows of three upper levels of the picture
PART_LEVELS = 3
TILE_FACTOR = 4
_COLUMNS_PER_BLOCK = 2
_CLIPPED_SHARE = 0.005  # of a frame: a single clipped knock does not spoil 64 ms
_DROPOUT_SHARE = 0.15  # of a frame: 10 ms without any change of the signal
_ONSET_LAG_HZ = 6000.0
FACTS = ("mean", "clip_level", "hum_50_db", "hum_60_db")


@dataclass(frozen=True)
class ScanPart:
    """What one piece of sound gives; rows follow the grid of :class:`processing.sound.bands.Grid`."""

    level_db: Halves  # (levels, bands)
    crest_db: Halves  # (levels, bands)
    state: Bytes  # (levels,)
    onset: Bytes  # (steps,)
    wave: Halves  # (blocks, 3) lowest, highest, rms
    tile_max: tuple[Bytes, ...]  # finest level first, each (columns, bins)
    tile_mean: tuple[Bytes, ...]
    facts: Samples  # (1, len(FACTS))


class Analyser:
    """Holds the constants of a pass; :meth:`analyse` is a pure function and may run in several threads."""

    def __init__(self, grid: Grid, settings: SoundSettings, *, compiled: bool = kernels_pass.COMPILED) -> None:
        self.grid = grid
        self.bands_hz: FloatArray = band_table(grid.sample_rate_hz, settings)
        self.part = PART_COLUMNS * grid.column  # samples in a piece
        self.context = grid.level + 4 * grid.decimation + 2 * self._onset_lag
        self._loops: Any = kernels_pass if compiled else plain_pass
        self._window = scaled_hann(grid.window)
        self._low_window = scaled_hann(grid.low_window)
        self._low = is_low(self.bands_hz)
        self._edges, self._shares = band_edges(self.bands_hz[~self._low], grid.bin_hz, grid.window // 2 + 1)
        low = low_band_bins(self.bands_hz[self._low], self._low_bin_hz)
        self._low_bins = np.array([row[:2] for row in low], np.intp).reshape(-1, 2)
        self._low_factors = np.array([row[2] for row in low], np.float32)
        self._low_gain = self._thinning_gain()
        self._silence = 10 ** (settings.silence_db / 10) / 2  # power of a sine of that level

    @property
    def _onset_lag(self) -> int:
        return max(1, round(self.grid.sample_rate_hz / _ONSET_LAG_HZ))

    @property
    def _low_bin_hz(self) -> float:
        return self.grid.sample_rate_hz / self.grid.decimation / self.grid.low_window

    def analyse(self, samples: Samples, frames: int) -> ScanPart:
        """Return everything about a piece of sound.

        Args:
            samples: (part + 2·context,) contiguous, of which ``context`` on either side belong to the neighbours.
            frames: how many samples of the piece lie within the recording; the others are 0.
        """
        if samples.shape != (self.part + 2 * self.context,) or not samples.flags.c_contiguous:
            raise ValueError(f"a piece of {samples.shape} samples")  # the kernels do not look
        grid, loops = self.grid, self._loops
        levels = PART_COLUMNS * LEVELS_PER_COLUMN
        power = np.empty((levels, len(self.bands_hz)), np.float32)
        crest = np.empty_like(power)
        tile_max, tile_mean = self._spectra(samples, power, crest)
        low_total = self._low_spectra(samples, power, crest)
        onset = np.empty(self.part // grid.onset_step, np.float32)
        loops.onset_energy(samples, self.context, self._onset_lag, onset, grid.onset_step)
        wave = np.empty((self.part // grid.wave_block, 4), np.float32)
        loops.envelope(samples, self.context, grid.wave_block, wave)
        body = samples[self.context : self.context + self.part]
        state, clip_level = self._state(body, wave, onset, levels)
        mean = float(wave[:, 2].sum(dtype=np.float64)) * grid.wave_block / max(frames, 1)
        hum = hum_excess_db(low_total, self._low_bin_hz)
        columns = -(-frames // grid.column)
        return ScanPart(
            level_db=decibels(power).astype(np.float16),
            crest_db=decibels(crest).astype(np.float16),
            state=state,
            onset=to_tile(onset),
            wave=_envelope_halves(wave),
            tile_max=_levels(tile_max, columns, "max"),
            tile_mean=_levels(tile_mean, columns, "mean"),
            facts=np.array([[mean, clip_level, *hum]], np.float32),
        )

    def _spectra(self, samples: Samples, power: Spectrum, crest: Spectrum) -> tuple[Spectrum, Spectrum]:
        """Fill the bands above 1 kHz; return both planes of the picture."""
        grid, loops = self.grid, self._loops
        hops = LEVELS_PER_COLUMN * grid.hops_per_level
        bins = grid.window // 2 + 1
        highest = np.empty((PART_COLUMNS, grid.picture_bins), np.float32)
        mean = np.empty_like(highest)
        bands = np.empty((PART_COLUMNS * hops, len(self._edges)), np.float32)
        scratch = np.empty((3, bins), np.float32)
        windows = np.empty((_COLUMNS_PER_BLOCK * hops, grid.window), np.float32)
        first_window = self.context + grid.hop // 2 - grid.window // 2
        for first in range(0, PART_COLUMNS, _COLUMNS_PER_BLOCK):
            rows = slice(first, first + _COLUMNS_PER_BLOCK)
            loops.cut_windows(samples, first_window + first * grid.column, grid.hop, self._window, windows)
            parts = fft.rfft(windows, axis=1).view(np.float32)
            loops.pool_spectra(
                parts,
                grid.bins_pooled,
                highest[rows],
                mean[rows],
                self._edges,
                self._shares,
                1 / HANN_ENBW,
                bands[first * hops : (first + _COLUMNS_PER_BLOCK) * hops],
                scratch,
            )
        high = np.flatnonzero(~self._low)
        in_frames, ratio = np.empty((2, len(power), len(high)), np.float32)
        loops.frame_bands(bands, in_frames, ratio, np.empty(grid.hops_per_level, np.float32))
        power[:, high], crest[:, high] = in_frames, ratio
        return highest, mean

    def _low_spectra(self, samples: Samples, power: Spectrum, crest: Spectrum) -> Spectrum:
        """Fill the low bands; return the summed power (bins,) of their fine bins.

        A window of four level frames serves the two in its middle, so windows overlap by half.
        """
        grid, loops = self.grid, self._loops
        count = len(power) // 2
        thin = grid.level // grid.decimation
        thinned = self._thinned(samples, (2 * count + 2) * thin)
        windows = np.empty((count, grid.low_window), np.float32)
        loops.cut_windows(thinned, 0, 2 * thin, self._low_window, windows)
        parts = fft.rfft(windows, axis=1).view(np.float32)
        total = np.zeros(len(self._low_gain), np.float32)
        low, ratio = np.empty((2, count, len(self._low_bins)), np.float32)
        scratch = np.empty((2, len(self._low_gain)), np.float32)
        loops.low_bands(parts, self._low_gain, self._low_bins, self._low_factors, low, ratio, total, scratch)
        where = np.flatnonzero(self._low)
        power[:, where], crest[:, where] = np.repeat(low, 2, axis=0), np.repeat(ratio, 2, axis=0)
        return total

    def _thinned(self, samples: Samples, count: int) -> Samples:
        """Return ``count`` samples at the low rate from one level frame before the body on, halved again and again."""
        step = self.grid.decimation
        start = self.context - self.grid.level - (step - 1)  # each halving looks one of its samples ahead
        thinned = samples[start : start + count * step + 2 * (step - 1)]
        while step > 1:
            out = np.empty(len(thinned) // 2 - 1, np.float32)
            self._loops.halve(thinned, out)
            thinned = out
            step //= 2
        return thinned

    def _thinning_gain(self) -> Spectrum:
        """Return what undoes the droop of the halvings, per bin of the low spectra."""
        grid = self.grid
        cycles = np.arange(grid.low_window // 2 + 1) / grid.low_window / grid.decimation
        gain = np.ones(len(cycles))
        step = 1
        while step < grid.decimation:
            gain *= np.cos(np.pi * cycles * step) ** 6
            step *= 2
        undone: Spectrum = (1.0 / np.maximum(gain, 1e-3)).astype(np.float32)
        return undone

    def _state(self, body: Samples, wave: Samples, onset: Samples, levels: int) -> tuple[Bytes, float]:
        """Return the bits of each frame and the level at which the sound is cut off, nan where it is not."""
        by_frame = wave.reshape(levels, -1, 4)
        power = by_frame[:, :, 3].mean(axis=1) + by_frame[:, :, 2].var(axis=1)
        state = np.where(power < self._silence, SILENT, 0).astype(np.uint8)
        unchanged = (onset == 0).reshape(levels, -1).mean(axis=1)
        state[unchanged >= _DROPOUT_SHARE] |= DROPOUT
        clipped, level = clipped_at(body, wave[:, 0], wave[:, 1])
        if clipped is None:
            return state, float("nan")
        bad = clipped.reshape(levels, -1).mean(axis=1) >= _CLIPPED_SHARE
        state[bad] |= CLIPPED
        return state, level if bad.any() else float("nan")


def scaled_hann(length: int) -> Samples:
    """Return a periodic Hann window, scaled so that a full-scale sine's bin has power 1."""
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    scaled: Samples = (window * 2 / window.sum()).astype(np.float32)
    return scaled


def power_of(windows: Samples) -> Spectrum:
    """Return |rfft|² of each row, float32."""
    parts = fft.rfft(windows, axis=1).view(np.float32)
    parts *= parts
    power: Spectrum = parts[:, ::2] + parts[:, 1::2]
    return power


def _levels(finest: Spectrum, columns: int, plane: str) -> tuple[Bytes, ...]:
    """Return the rows of the finest level and of those above it, of the first ``columns`` columns."""
    pool = max_of_rows if plane == "max" else mean_of_rows
    levels = [to_tile(finest[:columns])]
    for _ in range(PART_LEVELS):
        levels.append(pooled(levels[-1], TILE_FACTOR, pool))
    return tuple(levels)


def _envelope_halves(wave: Samples) -> Halves:
    """Return lowest, highest and rms of lowest, highest, mean and variance."""
    rms = np.sqrt(np.square(wave[:, 2]) + wave[:, 3])
    return np.column_stack([wave[:, 0], wave[:, 1], rms]).astype(np.float16)
