"""Envelopes of what the IMU says, for strips that scroll: lowest and highest of each channel in short bins of time."""

import numpy as np

from processing.live.picture import STRIP_CHANNELS, Float32Array, StripBins
from processing.live.rings import Ring
from processing.survey import FloatArray, ImuSamples

_BIN_S = 0.05
_SPAN_S = 60.0


class Strips:
    """Samples go in, envelopes of the last ``span_s`` come out; the cost does not grow with the run."""

    def __init__(self, *, bin_s: float = _BIN_S, span_s: float = _SPAN_S) -> None:
        """Begin empty."""
        self.bin_s = bin_s
        self.capacity = max(2, round(span_s / bin_s))
        width = (len(STRIP_CHANNELS),)
        self._low = Ring(self.capacity, width, np.float32, np.nan)
        self._high = Ring(self.capacity, width, np.float32, np.nan)

    def add(self, imu: ImuSamples) -> None:
        """Take rows (m,), later than all before; those that cannot be trusted leave nothing."""
        valid = np.asarray(imu.valid)
        if not np.any(valid):
            return
        values = _values(imu)
        place = np.floor(imu.time_s / self.bin_s).astype(np.int64)
        if not np.all(valid):
            values, place = values[valid], place[valid]
        place = np.maximum(place, max(self._low.stop - 1, 0))  # of a clock that went back a little: the present bin
        starts = np.flatnonzero(np.diff(place, prepend=place[0] - 1))
        low = np.minimum.reduceat(values, starts, axis=0)
        high = np.maximum.reduceat(values, starts, axis=0)
        for number, lowest, highest in zip(place[starts].tolist(), low, high, strict=True):
            self._put(number, lowest, highest)

    def bins(self, since: int = 0) -> StripBins:
        """Return the bins from number ``since`` on that are still here."""
        first, low = self._low.since(since)
        return StripBins(first, low, self._high.since(since)[1], self.bin_s, self.capacity)

    def _put(self, number: int, low: Float32Array, high: Float32Array) -> None:
        if number < self._low.stop:
            first, old = self._low.since(number)
            if first == number:  # fmin: what is not known yet gives way
                self._low.update(number, np.fmin(old[:1], low))
                self._high.update(number, np.fmax(self._high.since(number)[1][:1], high))
            return
        for ring, row in ((self._low, low), (self._high, high)):
            ring.skip_to(number)
            ring.append(row[None])


def _values(imu: ImuSamples) -> Float32Array:
    out = np.full((len(imu.time_s), len(STRIP_CHANNELS)), np.nan, np.float32)
    for first, vectors in ((0, imu.acc_s_mps2), (4, imu.gyr_s_radps)):
        out[:, first : first + 3] = vectors
        out[:, first + 3] = _norm(vectors)
    if imu.pressure_kpa is not None:
        out[:, 8] = imu.pressure_kpa
    return out


def _norm(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)), dtype=np.float64)
