"""Turns a piece of sound into levels, picture columns, waveform envelope and onsets: the work of one pass, in blocks.

Numbers are chosen by measurement (acoustics §3): float32 FFTs in blocks that fit the cache, logarithms only after
pooling, and nothing per window in Python.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft

from processing.settings import SoundSettings
from processing.sound.bands import (
    LEVELS_PER_COLUMN,
    BandSums,
    Grid,
    Spectrum,
    band_table,
    decibels,
    is_low,
    low_band_bins,
)
from processing.sound.pcm import Samples
from processing.survey import FloatArray

Bytes = npt.NDArray[np.uint8]
Halves = npt.NDArray[np.float16]

SILENT, DROPOUT, CLIPPED = 1, 2, 4  # bits of a frame's state
TILE_FLOOR_DB, TILE_STEP_DB = -130.0, 0.5
_COLUMNS_PER_BLOCK = 4
_FULL_SCALE = 0.999
_CLIPPED_SHARE = 0.005  # of a frame: a single clipped knock does not spoil 64 ms
_DROPOUT_SHARE = 0.15  # of a frame: 10 ms without any change of the signal
_ONSET_LAG_HZ = 6000.0


@dataclass(frozen=True)
class ScanPart:
    """What one piece of sound gives; rows follow the grid of :class:`processing.sound.bands.Grid`."""

    level_db: Halves  # (levels, bands)
    crest_db: Halves  # (levels, bands)
    state: Bytes  # (levels,)
    onset: Bytes  # (steps,)
    wave: Halves  # (blocks, 3) lowest, highest, rms
    tile_max: Bytes  # (columns, bins)
    tile_mean: Bytes  # (columns, bins)


class Analyser:
    """Holds the constants of a pass; :meth:`analyse` is a pure function and may run in several threads."""

    def __init__(self, grid: Grid, settings: SoundSettings) -> None:
        self.grid = grid
        self.bands_hz: FloatArray = band_table(grid.sample_rate_hz, settings)
        self.context = grid.level + 4 * grid.decimation + 2 * self._onset_lag
        self._window = scaled_hann(grid.window)
        self._low_window = scaled_hann(grid.low_window)
        self._low = is_low(self.bands_hz)
        self._high_sums = BandSums(self.bands_hz[~self._low], grid.bin_hz, grid.window // 2 + 1)
        low_bin_hz = grid.sample_rate_hz / grid.decimation / grid.low_window
        self._low_bins = low_band_bins(self.bands_hz[self._low], low_bin_hz)
        self._low_gain = self._thinning_gain()
        self._silence = 10 ** (settings.silence_db / 10) / 2  # power of a sine of that level

    @property
    def _onset_lag(self) -> int:
        return max(1, round(self.grid.sample_rate_hz / _ONSET_LAG_HZ))

    def analyse(self, samples: Samples, columns: int) -> ScanPart:
        """Return everything about ``columns`` (an even number of) picture columns.

        ``samples`` holds ``columns · grid.column`` samples with ``context`` more on either side.
        """
        grid = self.grid
        body = samples[self.context : self.context + columns * grid.column]
        levels = columns * LEVELS_PER_COLUMN
        power = np.empty((levels, len(self.bands_hz)), np.float32)
        crest = np.empty_like(power)
        tile_max = np.empty((columns, grid.picture_bins), np.float32)
        tile_mean = np.empty_like(tile_max)
        for first in range(0, columns, _COLUMNS_PER_BLOCK):
            rows = slice(first, min(first + _COLUMNS_PER_BLOCK, columns))
            spectra = self._spectra(samples, first, rows.stop - first)
            _pool_tiles(spectra, grid, tile_max[rows], tile_mean[rows])
            level_rows = slice(first * LEVELS_PER_COLUMN, rows.stop * LEVELS_PER_COLUMN)
            power[level_rows, ~self._low], crest[level_rows, ~self._low] = self._high_bands(spectra)
        if self._low.any():
            power[:, self._low], crest[:, self._low] = self._low_bands(samples, levels)
        onset_energy = self._onset_energy(samples, len(body))
        return ScanPart(
            level_db=decibels(power).astype(np.float16),
            crest_db=decibels(crest).astype(np.float16),
            state=self._state(body, onset_energy, levels),
            onset=to_tile(onset_energy),
            wave=_wave_envelope(body.reshape(-1, grid.wave_block)),
            tile_max=to_tile(tile_max),
            tile_mean=to_tile(tile_mean),
        )

    def _spectra(self, samples: Samples, first_column: int, columns: int) -> Spectrum:
        """Return the power (windows, bins) of the windows in these columns; 1 is a full-scale sine."""
        grid = self.grid
        count = columns * LEVELS_PER_COLUMN * grid.hops_per_level
        start = self.context + first_column * grid.column + grid.hop // 2 - grid.window // 2
        piece = samples[start : start + (count - 1) * grid.hop + grid.window]
        windows = np.lib.stride_tricks.sliding_window_view(piece, grid.window)[:: grid.hop]
        return power_of(windows * self._window)

    def _high_bands(self, spectra: Spectrum) -> tuple[Spectrum, Spectrum]:
        """Return mean power and mean over lower median of the windows in each level frame, (levels, high bands)."""
        per_window = self._high_sums(spectra).reshape(
            len(spectra) // self.grid.hops_per_level, self.grid.hops_per_level, -1
        )
        mean = per_window.mean(axis=1)
        per_window.sort(axis=1)
        lower_median = per_window[:, (self.grid.hops_per_level - 1) // 2]
        return mean, _ratio(mean, lower_median)

    def _low_bands(self, samples: Samples, levels: int) -> tuple[Spectrum, Spectrum]:
        """Return median-of-bins power and mean over median of the bins, (levels, low bands).

        A window of four level frames serves the two in its middle, so windows overlap by half.
        """
        grid = self.grid
        windows = levels // 2
        thin = grid.level // grid.decimation
        thinned = self._thinned(samples, (2 * windows + 2) * thin)
        view = np.lib.stride_tricks.sliding_window_view(thinned, grid.low_window)[:: 2 * thin]
        spectra = power_of(view * self._low_window) * self._low_gain
        power = np.empty((windows, len(self._low_bins)), np.float32)
        crest = np.empty_like(power)
        for k, (first, end, factor) in enumerate(self._low_bins):
            bins = spectra[:, first:end]
            median = np.median(bins, axis=1)
            power[:, k] = factor * median
            crest[:, k] = _ratio(bins.mean(axis=1), median)
        return np.repeat(power, 2, axis=0), np.repeat(crest, 2, axis=0)

    def _thinned(self, samples: Samples, count: int) -> Samples:
        """Return ``count`` samples at the low rate from one level frame before the body on.

        Halved again and again with the weights 1 3 3 1, whose triple zero lies where aliases of 0 Hz would come from:
        what folds onto the bands below 1 kHz is damped by 50 dB and more.
        """
        step = self.grid.decimation
        start = self.context - self.grid.level - (step - 1)  # each halving looks one of its samples ahead
        thinned = samples[start : start + count * step + 2 * (step - 1)]
        while step > 1:
            pairs = len(thinned) // 2 - 1
            outer = thinned[0 : 2 * pairs : 2] + thinned[3 : 3 + 2 * pairs : 2]
            inner = thinned[1 : 1 + 2 * pairs : 2] + thinned[2 : 2 + 2 * pairs : 2]
            thinned = np.float32(0.125) * outer + np.float32(0.375) * inner
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

    def _onset_energy(self, samples: Samples, count: int) -> Samples:
        """Return the mean square (steps,) of the second difference over about 0.17 ms: a high-pass near 1 kHz."""
        lag, start = self._onset_lag, self.context
        late, middle, early = (samples[start - k * lag : start - k * lag + count] for k in (0, 1, 2))
        sharp = (late - middle) - (middle - early)
        rows = sharp.reshape(-1, self.grid.onset_step)
        energy: Samples = np.einsum("ij,ij->i", rows, rows) / np.float32(self.grid.onset_step)
        return energy

    def _state(self, body: Samples, onset_energy: Samples, levels: int) -> Bytes:
        frames = body.reshape(levels, self.grid.level)
        mean = frames.mean(axis=1)
        power = np.einsum("ij,ij->i", frames, frames) / np.float32(self.grid.level) - mean * mean
        state = np.where(power < self._silence, SILENT, 0).astype(np.uint8)
        unchanged = (onset_energy == 0).reshape(levels, -1).mean(axis=1)
        state[unchanged >= _DROPOUT_SHARE] |= DROPOUT
        if max(float(body.max()), -float(body.min())) >= _FULL_SCALE:
            full = np.abs(body) >= _FULL_SCALE
            runs = full[:-2] & full[1:-1] & full[2:]
            clipped = np.zeros(len(body), np.bool_)
            for shift in range(3):
                clipped[shift : shift + len(runs)] |= runs
            state[clipped.reshape(levels, -1).mean(axis=1) >= _CLIPPED_SHARE] |= CLIPPED
        return state


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


def _pool_tiles(spectra: Spectrum, grid: Grid, out_max: Spectrum, out_mean: Spectrum) -> None:
    """Pool windows to columns and bins to rows; the Nyquist bin is left out."""
    bins = grid.picture_bins
    by_column = spectra[:, : bins * grid.bins_pooled].reshape(len(out_max), -1, bins * grid.bins_pooled)
    shape = (len(out_max), bins, grid.bins_pooled)
    out_max[:] = by_column.max(axis=1).reshape(shape).max(axis=2)
    out_mean[:] = by_column.mean(axis=1).reshape(shape).mean(axis=2)


def to_tile(power: Spectrum) -> Bytes:
    """Return power as steps of 0.5 dB above −130 dBFS, 0 to 255."""
    steps = (decibels(power) - np.float32(TILE_FLOOR_DB)) * np.float32(1 / TILE_STEP_DB) + np.float32(0.5)
    tile: Bytes = np.clip(steps, 0, 255).astype(np.uint8)
    return tile


def _wave_envelope(blocks: Samples) -> Halves:
    out = np.empty((len(blocks), 3), np.float16)
    out[:, 0], out[:, 1] = blocks.min(axis=1), blocks.max(axis=1)
    out[:, 2] = np.sqrt(np.einsum("ij,ij->i", blocks, blocks) / np.float32(blocks.shape[1]))
    return out


def _ratio(high: Spectrum, low: Spectrum) -> Spectrum:
    """Return high/low, 1 where there is nothing."""
    ratio: Spectrum = np.where(low > 0, high / np.maximum(low, np.float32(1e-30)), np.float32(1))
    return ratio
