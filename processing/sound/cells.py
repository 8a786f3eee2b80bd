"""Brings band levels from seconds to metres: cells of a quarter metre along the pipe, bumps taken out first.

Steps 3, 4 and 5 of the detector measured in acoustics §5.1.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from processing.settings import DetectorSettings
from processing.sound.background import bridged, robust_sigma, running_median
from processing.sound.rolling_noise import RollingNoise
from processing.sound.scan import SoundScan
from processing.survey import BoolArray, Channel, ClockMap, FloatArray, Stretch, Track

CELL_M = 0.25
_GATE_FRAMES = 11  # 0.7 s
_GATE_SIGMAS = 3.5
_BRIDGE_CELLS = 4  # a metre without sound is bridged, more is not assessed
DB_PER_LN = 10 / float(np.log(10))


@dataclass(frozen=True)
class Frames:
    """Level frames on the path, and which of them count: heard, on the path, and moving."""

    time_s: FloatArray  # (t,) survey time
    chainage_m: FloatArray  # (t,)
    speed_mps: FloatArray  # (t,)
    counts: BoolArray  # (t,)


@dataclass(frozen=True)
class Cells:
    """The pipe in cells of CELL_M; ``log_power`` is the natural logarithm of band power, NaN where not ``heard``."""

    chainage_m: FloatArray  # (n,) middles
    time_s: FloatArray  # (n,)
    speed_mps: FloatArray  # (n,)
    heard: BoolArray  # (n,)
    log_power: FloatArray  # (n, b + 1), the last band is the chosen one
    removed_share: npt.NDArray[np.float32]  # (n, b + 1) of the energy that the impulse gate took out
    frames: FloatArray  # (n,) how many level frames a cell was heard in


def frames_of(
    scan: SoundScan, clock: ClockMap, track: Track | None, masked: Sequence[Stretch], settings: DetectorSettings
) -> Frames:
    """Return the level frames in survey time, with chainage and speed NaN where there is no track."""
    time_s = clock.to_survey(scan.frame_times_s())
    counts = np.asarray(scan.state) == 0
    for stretch in masked:
        if stretch.channel is Channel.SOUND:
            counts &= (time_s < stretch.start_s) | (time_s > stretch.end_s)
    if track is None:
        nowhere = np.full(len(time_s), np.nan)
        return Frames(time_s, nowhere, nowhere, counts)
    chainage = np.asarray(np.interp(time_s, track.time_s, track.chainage_m), np.float64)
    speed = np.asarray(np.interp(time_s, track.time_s, np.abs(track.speed_mps)), np.float64)
    counts &= (time_s >= track.time_s[0]) & (time_s <= track.time_s[-1]) & (speed >= settings.min_speed_mps)
    return Frames(time_s, chainage, speed, counts)


def impulses(log_power: npt.NDArray[np.float32], counts: BoolArray) -> BoolArray:
    """Return which frames (t,) stand out of the 0.7 s around them in this band, with their neighbours.

    A bump lasts a frame or two; a leak rises and falls over seconds and passes.
    """
    rest = log_power - ndimage.median_filter(log_power, _GATE_FRAMES, mode="nearest")
    sigma = robust_sigma(rest[counts].astype(np.float64))
    if sigma == 0.0:
        return np.zeros(len(rest), np.bool_)
    gated: BoolArray = ndimage.binary_dilation(rest > _GATE_SIGMAS * sigma)
    return gated


def band_log_power(scan: SoundScan, band: int) -> npt.NDArray[np.float32]:
    """Return the natural logarithm of a band's power, one value a frame."""
    logarithm: npt.NDArray[np.float32] = np.asarray(scan.level_db[:, band], np.float32) * np.float32(1 / DB_PER_LN)
    return logarithm


def cells_of(scan: SoundScan, frames: Frames, rolling: RollingNoise | None = None) -> Cells | None:
    """Return the sound along the pipe; None where no frame counts.

    A cell holds the mean power of the frames within half a metre, weighted to its middle: one turn of a usual ball, so
    that most of the rotation's modulation averages out. Where the ``rolling`` noise m of each frame is known, frames
    weigh 1/m², the best an energy detector can do in noise of that power, and the sum is held against what noise
    alone gives, Σ m/m²: else the level would jump wherever the modulation, or what is known of it, changes.
    """
    keep = frames.counts
    if np.count_nonzero(keep) < 2:
        return None
    first = np.floor(frames.chainage_m[keep].min() / CELL_M)
    cell = (np.floor(frames.chainage_m / CELL_M) - first).astype(np.int64)
    count = int(cell[keep].max()) + 1
    bands = scan.level_db.shape[1]
    log_power = np.empty((count, bands))
    removed = np.empty((count, bands), np.float32)
    heard = _bridgeable(np.bincount(cell[keep], minlength=count) > 0)
    for band in range(bands):
        logarithm = band_log_power(scan, band)
        power = np.exp(logarithm)
        lift = rolling.modulation(logarithm, keep) if rolling is not None else np.ones(len(power), np.float32)
        good = keep & ~impulses(logarithm - np.log(lift), keep)
        lifted = lift.astype(np.float64)
        weight = 1.0 / np.square(lifted)
        total = _spread(np.bincount(cell[keep], (weight * power)[keep], count).astype(np.float64))
        kept = _spread(np.bincount(cell[good], (weight * power)[good], count).astype(np.float64))
        number = _spread(np.bincount(cell[good], (weight * lifted)[good], count).astype(np.float64))
        known = (number > 0) & (kept > 0)
        if not known.any():
            log_power[:, band], removed[:, band] = np.nan, 0.0
            continue
        values = np.full(count, np.nan)
        values[known] = np.log(kept[known] / number[known])
        log_power[:, band] = np.where(heard, bridged(values, known), np.nan)
        removed[:, band] = np.where(total > 0, 1 - kept / np.where(total > 0, total, 1.0), 0.0)
    return Cells(
        chainage_m=(first + np.arange(count) + 0.5) * CELL_M,
        time_s=_cell_mean(cell[keep], frames.time_s[keep], count),
        speed_mps=_cell_mean(cell[keep], frames.speed_mps[keep], count),
        heard=heard,
        log_power=log_power,
        removed_share=removed,
        frames=_spread(np.bincount(cell[keep], minlength=count).astype(np.float64)),
    )


def excess_of(cells: Cells, background_m: float, bands: Sequence[int] | None = None) -> FloatArray:
    """Return (n, bands) how far each band's log power stands above its background, 0 where not heard.

    The background is the running median in metres; what follows the speed is taken out, then the median once more.
    """
    half = max(1, round(background_m / CELL_M))
    log_speed = np.log(np.maximum(cells.speed_mps, 0.01))
    log_speed = log_speed - running_median(log_speed, half)
    chosen = cells.log_power if bands is None else cells.log_power[:, list(bands)]
    excess = np.empty_like(chosen)
    for column, level in enumerate(chosen.T):
        above = level - running_median(level, half)
        above = above - robust_slope(log_speed, above) * log_speed
        excess[:, column] = above - running_median(above, half)
    return np.where(np.isfinite(excess), excess, 0.0)


def robust_slope(x: FloatArray, y: FloatArray) -> float:
    """Return the slope of ``y`` on ``x`` through the origin, outliers pulled in to two sigma; 0 where ``x`` stands."""
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if len(x) < 8 or float(np.std(x)) < 0.02:
        return 0.0
    slope = 0.0
    for _ in range(4):
        rest = y - slope * x
        limit = 2 * robust_sigma(rest)
        slope += float(x @ np.clip(rest, -limit, limit) / (x @ x))
    return slope


def _spread(sums: FloatArray) -> FloatArray:
    """Return the sums of half-metre windows from the sums of quarter-metre cells."""
    out = sums.copy()
    out[1:] += 0.5 * sums[:-1]
    out[:-1] += 0.5 * sums[1:]
    return out


def _bridgeable(known: BoolArray) -> BoolArray:
    """Return ``known`` with short holes between known cells closed."""
    closed: BoolArray = ndimage.binary_closing(
        np.pad(known, _BRIDGE_CELLS), np.ones(_BRIDGE_CELLS + 1, np.bool_), origin=0
    )[_BRIDGE_CELLS:-_BRIDGE_CELLS]
    return closed | known


def _cell_mean(cell: npt.NDArray[np.int64], values: FloatArray, count: int) -> FloatArray:
    number = np.bincount(cell, minlength=count)
    mean = np.bincount(cell, values, count) / np.maximum(number, 1)
    return bridged(mean, number > 0)
