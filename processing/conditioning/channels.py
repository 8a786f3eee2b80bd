"""The slow channels of a run, evenly sampled, for the filters: pressure, level of the sound, speed."""

from dataclasses import dataclass

import numpy as np

from processing.conditioning.channel import on_grid
from processing.conditioning.transients import KPA_PER_M, pressure_rows
from processing.sound.scan import SoundScan
from processing.survey import BoolArray, ClockMap, FloatArray, ImuSamples, Track

CHANNELS = ("pressure", "pressure_level", "level", "speed")
_RATE_HZ = 50.0  # means of this rate hold what a slow channel has to say, and still show how noisy it is


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

    The pressure is the mean of fiftieths of a second, ``pressure_level`` what it is without the path's height, the
    level (dBFS) that of the chosen band, the speed the track's.
    """
    if name in ("pressure", "pressure_level") and imu is not None:
        rows = pressure_rows(imu, _RATE_HZ)
        if rows is None or (name == "pressure_level" and track is None):
            return None
        time_s, values, known = rows.time_s, rows.values_kpa, rows.known
        if name == "pressure_level" and track is not None:
            values = values + KPA_PER_M * np.interp(
                time_s, track.time_s, track.position_w_m[:, 2] - track.position_w_m[0, 2]
            )
            known = known & (time_s >= track.time_s[0]) & (time_s <= track.time_s[-1])
        return _even(name, "kPa", time_s, values, known)
    if name == "level" and scan is not None:
        level = np.asarray(scan.level_db[:, -1], np.float64)
        return _even("level", "dB", clock.to_survey(scan.frame_times_s()), level, np.asarray(scan.state) == 0)
    if name == "speed" and track is not None:
        return _even("speed", "m/s", track.time_s, track.speed_mps, np.isfinite(track.speed_mps))
    return None


def _even(name: str, unit: str, time_s: FloatArray, values: FloatArray, valid: BoolArray) -> ChannelSeries | None:
    if np.count_nonzero(valid) < 2 or len(time_s) < 2:
        return None
    grid = on_grid(time_s, values, valid)
    places = time_s[0] + np.arange(len(grid.values)) / grid.sample_rate_hz
    return ChannelSeries(name, unit, np.asarray(places, np.float64), grid.values, grid.valid, grid.sample_rate_hz)
