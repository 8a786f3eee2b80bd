"""Sound as it comes, turned into columns of the very picture that the review shows, and into levels of a few bands.

Windows, their places, frequency rows and decibels are those of :class:`processing.sound.bands.Grid`; a column here is
as many windows as fill about 50 ms, where the stored picture has 190 ms. A column is known 16 ms after its end.
"""

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from processing.live.picture import SpectrumColumns
from processing.live.rings import Ring
from processing.live.stream import SoundBlock
from processing.settings import SoundSettings
from processing.sound.analysis import power_of, scaled_hann
from processing.sound.bands import HANN_ENBW, Grid, band_edges, decibels
from processing.sound.tile_values import to_tile
from processing.survey import BoolArray, FloatArray

_COLUMN_S = 0.05
_SPAN_S = 90.0
_USABLE = 0.95  # of the Nyquist frequency
_EDGES_HZ = (90.0, 300.0, 1000.0, 3000.0, 8000.0, 20_000.0, 90_000.0)
_MOST_WINDOWS = 64  # in one go: a late block of a second must not need a gigabyte
_FULL_SCALE = np.float32(2.0**-31)
_NO_LEVEL_DB = -200.0


class SpectrumStream:
    """Blocks of sound go in, columns come out; one channel is looked at."""

    def __init__(
        self,
        sample_rate_hz: float,
        settings: SoundSettings | None = None,
        *,
        channel: int = 0,
        column_s: float = _COLUMN_S,
        span_s: float = _SPAN_S,
    ) -> None:
        """Begin with the stream's rate; the last ``span_s`` are kept, in columns of about ``column_s``."""
        grid = Grid(sample_rate_hz, 1)
        self.sample_rate_hz = sample_rate_hz
        self.frequency_hz = grid.picture_hz()
        self.bands_hz = _bands(sample_rate_hz, settings or SoundSettings())
        self._grid, self._channel = grid, channel
        self._windows = max(1, round(column_s * sample_rate_hz / grid.hop))
        self._column = self._windows * grid.hop  # samples
        self.column_s = self._column / sample_rate_hz
        self._before = grid.window // 2 - grid.hop // 2  # samples that a column's first window reaches back
        self._hann = scaled_hann(grid.window)
        self._shares = _band_shares(self.bands_hz, grid)
        capacity = max(2, round(span_s / self.column_s))
        self.capacity = capacity
        self._tiles = Ring(capacity, (grid.picture_bins,), np.uint8)
        self._levels = Ring(capacity, (len(self.bands_hz),), np.float32, _NO_LEVEL_DB)
        self._gap = Ring(capacity, (), np.bool_, 1.0)
        self._host = Ring(capacity, (), np.float64, np.nan)
        self._samples: npt.NDArray[np.float32] | None = None  # not yet all used, from frame _start on
        self._start = 0
        self._lost: list[tuple[int, int]] = []  # frames that are missing, of columns to come
        self.newest_host_s: float | None = None  # when the newest sample was digitised

    def add(self, block: SoundBlock) -> None:
        """Take a block (n, channels); what was lost before it becomes a gap."""
        frames = block.frames[:, min(self._channel, block.frames.shape[1] - 1)]
        samples = frames.astype(np.float32) * _FULL_SCALE
        end = block.first_frame + len(samples)
        self.newest_host_s = block.adc_host_s + len(samples) / self.sample_rate_hz
        if self._samples is None or block.first_frame < self._start:
            self._begin(block.first_frame)
        assert self._samples is not None
        missing = block.first_frame - (self._start + len(self._samples))
        if missing > self.capacity * self._column:
            self._skip_to(block.first_frame)
            missing = 0
        if missing > 0:
            self._lost.append((block.first_frame - missing, block.first_frame))
            self._samples = np.concatenate([self._samples, np.zeros(missing, np.float32)])
        elif missing < 0:  # told twice: the new one holds
            self._samples = self._samples[:missing]
        self._samples = np.concatenate([self._samples, samples])
        self._work(end)

    def columns(self, since: int = 0) -> SpectrumColumns:
        """Return the columns from number ``since`` on that are known and still here."""
        first, tiles = self._tiles.since(since)
        return SpectrumColumns(
            first,
            tiles,
            self._levels.since(since)[1],
            self._gap.since(since)[1],
            self._host.since(since)[1],
            self.column_s,
            self.capacity,
            self.frequency_hz,
            self.bands_hz,
        )

    def _begin(self, frame: int) -> None:
        """Start at ``frame`` of the audio clock, with silence before it."""
        column = -(-frame // self._column) if self._samples is None else self._tiles.stop
        self._start = column * self._column - self._before
        lead = max(frame - self._start, 0)
        self._samples, self._lost = np.zeros(lead, np.float32), []
        for ring in (self._tiles, self._levels, self._gap, self._host):
            ring.skip_to(column)

    def _skip_to(self, frame: int) -> None:
        """Leave out a gap that is longer than the picture."""
        for ring in (self._tiles, self._levels, self._gap, self._host):
            ring.skip_to(frame // self._column)
        self._start = self._tiles.stop * self._column - self._before
        self._samples = np.zeros(max(frame - self._start, 0), np.float32)
        self._lost = [(self._start, frame)]

    def _work(self, end: int) -> None:
        assert self._samples is not None
        reach = self._column + self._grid.window - self._grid.hop  # samples that a column needs
        most = max(1, _MOST_WINDOWS // self._windows)
        used = 0
        while (ready := (len(self._samples) - used - reach) // self._column + 1) > 0:
            count = min(ready, most)
            self._make(self._samples[used : used + (count - 1) * self._column + reach], count, end)
            used += count * self._column
        if used:
            self._samples = self._samples[used:].copy()
            self._start += used

    def _make(self, samples: npt.NDArray[np.float32], count: int, end: int) -> None:
        grid, rows = self._grid, self._grid.picture_bins * self._grid.bins_pooled
        view = np.lib.stride_tricks.sliding_window_view(samples, grid.window)[:: grid.hop]
        power = power_of(view * self._hann).reshape(count, self._windows, -1)
        highest = power.max(axis=1)[:, :rows].reshape(count, grid.picture_bins, grid.bins_pooled)
        first = self._tiles.stop
        ends = (np.arange(first, first + count) + 1) * self._column
        assert self.newest_host_s is not None
        self._tiles.append(to_tile(highest.max(axis=2)))
        self._levels.append(decibels(power.mean(axis=1) @ self._shares))
        self._host.append(self.newest_host_s - (end - ends) / self.sample_rate_hz)
        self._gap.append(self._gaps(ends))

    def _gaps(self, ends: FloatArray | npt.NDArray[np.int64]) -> BoolArray:
        out = np.zeros(len(ends), np.bool_)
        for start, stop in self._lost:
            out |= (ends > start) & (ends - self._column < stop)
        self._lost = [span for span in self._lost if span[1] > ends[-1]]
        return out


def _bands(sample_rate_hz: float, settings: SoundSettings) -> FloatArray:
    """Return the bands (b, 2) in Hz as far as the rate allows, the chosen one last."""
    top = _USABLE * sample_rate_hz / 2
    edges = [e for e in _EDGES_HZ if e < top]
    edges.append(top)
    high = min(settings.band_high_hz, top)
    chosen = (min(settings.band_low_hz, 0.5 * high), high)
    return np.array([*pairwise(edges), chosen], dtype=np.float64)


def _band_shares(bands_hz: FloatArray, grid: Grid) -> npt.NDArray[np.float32]:
    """Return what each bin's power counts in each band (bins, b): power of a band = power spectrum @ shares."""
    bins = grid.window // 2 + 1
    first, shares = band_edges(bands_hz, grid.bin_hz, bins)
    out = np.zeros((bins, len(bands_hz)), np.float32)
    for band, ((low, high), (low_share, high_share)) in enumerate(zip(first, shares, strict=True)):
        out[low:high, band] = 1.0 / HANN_ENBW
        out[low, band] -= low_share
        out[high, band] += high_share
    return out
