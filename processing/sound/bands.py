"""The frequency bands and the time grid on which one pass over the sound measures everything.

Decibels are dBFS throughout: 0 dB is the power of a full-scale sine (AES17), in spectra and in bands alike.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError
from processing.settings import SoundSettings
from processing.survey import FloatArray

Spectrum = npt.NDArray[np.float32]

LOWEST_HZ, HIGHEST_HZ, BAND_COUNT = 90.0, 7200.0, 28  # acoustics §5.1
SPLIT_HZ = 1000.0  # below it, bands are the median of fine bins, which a comb of pump tones does not move
FLOOR_DB = -200.0
_WINDOW_S = 0.0464  # 2048 samples at 44.1 kHz
_LEVEL_S = 0.064
_DECIMATED_HZ = 10_000.0
_USABLE = 0.95  # of the Nyquist frequency; above it the recorder's own filter shapes the sound
_MIN_LOW_BINS = 3
HANN_ENBW = 1.5  # equivalent noise bandwidth of the Hann window, in bins
LEVELS_PER_COLUMN = 3


@dataclass(frozen=True)
class Grid:
    """How samples fall into windows, level frames and picture columns; all sizes in samples.

    Window ``i`` is centred on ``(i + ½)·hop``; level frame ``t`` covers ``t·level`` to ``(t + 1)·level``.
    """

    sample_rate_hz: float
    frames: int

    @cached_property
    def hop(self) -> int:
        """From window to window: a quarter of a window."""
        return max(64, 1 << round(math.log2(_WINDOW_S * self.sample_rate_hz))) // 4

    @property
    def window(self) -> int:
        """Samples in a window, a power of two near 46 ms."""
        return 4 * self.hop

    @cached_property
    def hops_per_level(self) -> int:
        """Windows whose mean makes one level frame of about 64 ms."""
        return max(1, round(_LEVEL_S * self.sample_rate_hz / self.hop))

    @property
    def level(self) -> int:
        """Samples in a level frame."""
        return self.hops_per_level * self.hop

    @property
    def column(self) -> int:
        """Samples in a picture column of about 190 ms."""
        return LEVELS_PER_COLUMN * self.level

    @property
    def level_s(self) -> float:
        """Seconds in a level frame."""
        return self.level / self.sample_rate_hz

    @property
    def column_s(self) -> float:
        """Seconds in a picture column."""
        return self.column / self.sample_rate_hz

    @property
    def level_count(self) -> int:
        """Whole level frames in the recording, at least one."""
        return max(1, self.frames // self.level)

    @property
    def column_count(self) -> int:
        """Picture columns that cover the recording."""
        return max(1, -(-self.frames // self.column))

    @property
    def onset_step(self) -> int:
        """Samples a step of the onset series, 0.6 to 1.1 ms."""
        return self.hop // 16

    @property
    def wave_block(self) -> int:
        """Samples a block of the waveform envelope."""
        return self.hop // 2

    @cached_property
    def decimation(self) -> int:
        """By how much the low bands' sound is thinned out, a power of two."""
        return 1 << max(0, int(math.log2(self.sample_rate_hz / _DECIMATED_HZ)))

    @property
    def low_window(self) -> int:
        """Thinned samples in a window for the low bands: four level frames, about 256 ms."""
        return 4 * self.level // self.decimation

    @cached_property
    def bins_pooled(self) -> int:
        """Spectral bins that share a row of the picture."""
        return max(1, self.window // 2 // 512)

    @property
    def picture_bins(self) -> int:
        """Rows of the picture."""
        return self.window // 2 // self.bins_pooled

    @property
    def bin_hz(self) -> float:
        """Width of one spectral bin."""
        return self.sample_rate_hz / self.window

    def picture_hz(self) -> FloatArray:
        """Return the centre frequencies (picture_bins,) of the picture's rows."""
        rows = np.arange(self.picture_bins, dtype=np.float64)
        return (self.bins_pooled * (rows + 0.5) - 0.5) * self.bin_hz


def band_table(sample_rate_hz: float, settings: SoundSettings) -> FloatArray:
    """Return the bands (b + 1, 2) in Hz, ascending, as far as the sample rate allows; the last row is the chosen band.

    Raises:
        LeaklineError: SETTING_INVALID where the chosen band is empty or lies above what the recording holds.
    """
    top = _USABLE * sample_rate_hz / 2
    edges = np.geomspace(LOWEST_HZ, HIGHEST_HZ, BAND_COUNT + 1)
    edges = edges[edges <= top]
    low, high = settings.band_low_hz, min(settings.band_high_hz, top)
    if low >= high:
        allowed = f"< {high:.0f} Hz"
        raise LeaklineError(ErrorCode.SETTING_INVALID, name="sound.band_low_hz", value=f"{low:.0f}", allowed=allowed)
    table: FloatArray = np.vstack([np.column_stack([edges[:-1], edges[1:]]), [low, high]]).astype(np.float64)
    return table


def is_low(bands_hz: FloatArray) -> npt.NDArray[np.bool_]:
    """Return which bands (b + 1,) are measured as a median of fine bins; never the chosen one."""
    low: npt.NDArray[np.bool_] = bands_hz[:, 1] <= SPLIT_HZ
    low[-1] = False
    return low


def band_edges(bands_hz: FloatArray, bin_hz: float, bins: int) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.float32]]:
    """Return how bins sum to band power: first bin and end (b, 2), and what share of the bins there (b, 2) belongs out.

    A bin on an edge counts by the share of its width that lies inside. The shares hold the window's noise bandwidth.
    """
    edges = np.clip(bands_hz / bin_hz + 0.5, 0, bins - 1)  # bin k reaches from k to k + 1 here
    whole = np.floor(edges).astype(np.intp)
    return whole, ((edges - whole) / HANN_ENBW).astype(np.float32)


def low_band_bins(bands_hz: FloatArray, bin_hz: float) -> list[tuple[int, int, float]]:
    """Return ``(first bin, end bin, factor)`` of each low band: band power = factor · median of its bins' power."""
    rows = []
    for low, high in bands_hz:
        first = int(np.ceil(low / bin_hz))
        end = max(int(np.ceil(high / bin_hz)), first + _MIN_LOW_BINS)
        rows.append((first, end, (high - low) / bin_hz / HANN_ENBW / _median_of_exponentials(end - first)))
    return rows


def _median_of_exponentials(count: int) -> float:
    """Return the expected median of ``count`` exponential variates of mean 1: ln 2 for many, more for few."""
    orders = ((count + 1) // 2, count // 2 + 1)
    return float(np.mean([sum(1.0 / k for k in range(count - r + 1, count + 1)) for r in orders]))


def decibels(power: npt.NDArray[np.floating]) -> Spectrum:
    """Return 10·log10 of ``power``, not below FLOOR_DB."""
    level: Spectrum = (10.0 * np.log10(np.maximum(power, np.float32(10 ** (FLOOR_DB / 10))))).astype(np.float32)
    return level
