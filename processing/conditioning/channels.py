"""The slow channels of a run, evenly sampled, for the filters: pressure, level of the sound, speed."""

from dataclasses import dataclass

import numpy as np

from processing.conditioning.channel import on_grid
from processing.orientation.binning import BinSums
from processing.sound.scan import SoundScan
from processing.survey import BoolArray, ClockMap, FloatArray, ImuSamples, Track

CHANNELS = ("pressure", "level", "speed")
_RATE_HZ = 10.0  # means of this rate hold what a slow channel has to say
_BLOCK = 500_000
_MOST_EMPTY_S = 3600.0  # a longer hole in a log is cut short: nothing filters over it


@dataclass(frozen=True)
class ChannelSeries:
    """Readings ``values`` (n,) at ``time_s`` (n,), survey time, even but for holes, where ``valid`` is False."""

    name: str
    unit: str
    time_s: FloatArray
    values: FloatArray
    valid: BoolArray
    sample_rate_hz: float

    def coarser(self, most_rows: int) -> "ChannelSeries":
        """Return means over as many rows as bring the channel down to ``most_rows``; itself where it is shorter."""
        factor = -(-len(self.values) // most_rows)
        if factor <= 1:
            return self
        rows = len(self.values) // factor
        shape, part = (rows, factor), slice(0, rows * factor)
        count = self.valid[part].reshape(shape).sum(axis=1)
        total = np.where(self.valid[part], self.values[part], 0.0).reshape(shape).sum(axis=1)
        valid = 2 * count >= factor
        values = np.where(valid, total / np.maximum(count, 1), 0.0)
        time_s = self.time_s[part].reshape(shape).mean(axis=1)
        return ChannelSeries(self.name, self.unit, time_s, values, valid, self.sample_rate_hz / factor)


def channel_series(
    name: str, imu: ImuSamples | None, track: Track | None, scan: SoundScan | None, clock: ClockMap
) -> ChannelSeries | None:
    """Return one of ``CHANNELS``; None where the run has none of it, or fewer than two readings.

    The pressure is the mean of tenths of a second, the level (dBFS) that of the chosen band, the speed the track's.
    """
    if name == "pressure" and imu is not None and imu.pressure_kpa is not None:
        time_s, values = _pressure(imu, imu.pressure_kpa)
        return _even("pressure", "kPa", time_s, values, np.ones(len(time_s), np.bool_))
    if name == "level" and scan is not None:
        level = np.asarray(scan.level_db[:, -1], np.float64)
        return _even("level", "dB", clock.to_survey(scan.frame_times_s()), level, np.asarray(scan.state) == 0)
    if name == "speed" and track is not None:
        return _even("speed", "m/s", track.time_s, track.speed_mps, np.isfinite(track.speed_mps))
    return None


def _pressure(imu: ImuSamples, pressure_kpa: FloatArray) -> tuple[FloatArray, FloatArray]:
    width = 1.0 / min(_RATE_HZ, imu.sample_rate_hz)
    sums = BinSums(float(imu.time_s[0]), width, 2, most_empty=round(_MOST_EMPTY_S / width))
    for start in range(0, len(imu.time_s), _BLOCK):
        rows = slice(start, start + _BLOCK)
        good = imu.valid[rows] & np.isfinite(pressure_kpa[rows])
        kept = pressure_kpa[rows][good]
        sums.add(imu.time_s[rows][good], np.column_stack([np.ones(len(kept)), kept]))
    found = sums.result()
    some = found.sums[:, 0] > 0
    return found.start_of[some] + 0.5 * width, found.sums[some, 1] / found.sums[some, 0]


def _even(name: str, unit: str, time_s: FloatArray, values: FloatArray, valid: BoolArray) -> ChannelSeries | None:
    if np.count_nonzero(valid) < 2 or len(time_s) < 2:
        return None
    grid = on_grid(time_s, values, valid)
    places = time_s[0] + np.arange(len(grid.values)) / grid.sample_rate_hz
    return ChannelSeries(name, unit, np.asarray(places, np.float64), grid.values, grid.valid, grid.sample_rate_hz)
