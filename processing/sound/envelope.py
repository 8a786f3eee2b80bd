"""The papers' leak finder: the sound's envelope in a chosen band, smoothed by convolution; its peaks are the leaks.

P0 and P3 (A. E. Akkaya, M. F. Talu 2017; A. E. Akkaya 2017) take the highest peaks; ``envelope_order`` = ``plain`` does
the same. By default peaks are measured against the local background, which finds half as many leaks again at the same
rate of false ones (acoustics §5.2 a').
"""

import numpy as np
import numpy.typing as npt
from scipy import ndimage, signal

from processing.settings import DetectorSettings
from processing.sound.apex import fit_apex
from processing.sound.background import bridged, lower_sigma, running_median
from processing.sound.cells import DB_PER_LN, Cells, Frames, band_log_power, excess_of, impulses
from processing.sound.matching import peaks_apart
from processing.sound.spots import UNCONVINCING, Listening, Spot
from processing.survey import BoolArray, FloatArray

_APART_M, _APART_S = 5.0, 8.0
_MIN_SHARE = 0.15  # of a smoothing window must have been heard
_COARSE_S = 0.5
_MIN_SIGMA = 0.12  # of the log envelope: no real pipe is steadier than half a decibel
_LOGISTIC = (9.4, 5.5)  # fitted on 16 synthetic drifts as in acoustics §5.2, half of them with another leak shape


def find_by_envelope(listening: Listening) -> list[Spot]:
    """Return the spots, best first, placed in metres where a path is known, else in seconds."""
    scan, frames, cells, settings = listening.scan, listening.frames, listening.cells, listening.settings
    logarithm = band_log_power(scan, -1)
    good = frames.counts & ~impulses(logarithm, frames.counts)
    if not good.any():
        return []
    power = np.exp(logarithm.astype(np.float64))
    smooth = _smoothed(power, good, max(1, round(settings.envelope_smooth_s / scan.frame_s)))
    background = _background(smooth, frames, cells, settings, scan.frame_s)
    is_plain = settings.envelope_order == "plain"
    height = np.log(smooth) - (np.nanmedian(np.log(smooth)) if is_plain else background)
    match = height / max(lower_sigma(height[frames.counts]), _MIN_SIGMA)
    match[~np.isfinite(match) | ~frames.counts] = -np.inf
    place = frames.time_s if cells is None else frames.chainage_m
    apart = np.full(len(match), _APART_S if cells is None else _APART_M)
    probability = _confidence(match)
    taken = peaks_apart(match, np.where(np.isfinite(place), place, 0.0), apart, int(settings.max_candidates))
    taken = taken[probability[taken] >= settings.min_score]
    excess = np.where(good, power / np.exp(background) - 1.0, np.nan)
    spots = []
    for frame in taken:
        speed = float(frames.speed_mps[frame]) if cells is not None else 1.0
        # half the smoothing window at the speed of passing: the fit finds the true width
        width = max(0.5, settings.envelope_smooth_s * speed / 4)
        apex = fit_apex(place[good], excess[good], float(place[frame]), width)
        near = (np.abs(place - apex.chainage_m) <= max(apex.width_m, 0.5)) & frames.counts
        removed = 1.0 - float(power[near & good].sum() / power[near].sum()) if near.any() else 0.0
        evidence: dict[str, str | float] = {
            "method": "envelope",
            "match": float(match[frame]),
            "impulsive_share": removed,
        }
        band = (float(scan.bands_hz[-1, 0]), float(scan.bands_hz[-1, 1]))
        level = float(np.log1p(apex.height) * DB_PER_LN)
        score = float(probability[frame]) * (1.0 if apex.is_convincing else UNCONVINCING)
        spots.append(Spot(apex.chainage_m, apex.sigma_m, apex.width_m, score, level, band, evidence))
    return spots


def _smoothed(power: FloatArray, good: BoolArray, window: int) -> FloatArray:
    """Return the convolution of ``power`` with a Hann window over the good frames; NaN where few of them are."""
    kernel = np.hanning(2 * (window // 2) + 3)[1:-1]
    kernel /= kernel.sum()
    share = np.maximum(signal.oaconvolve(good.astype(np.float64), kernel, mode="same"), 0.0)
    total = np.maximum(signal.oaconvolve(np.where(good, power, 0.0), kernel, mode="same"), 0.0)
    known = (share >= _MIN_SHARE) & (total > 0)
    return np.where(known, total / np.where(known, share, 1.0), np.nan)


def _background(
    smooth: FloatArray, frames: Frames, cells: Cells | None, settings: DetectorSettings, frame_s: float
) -> FloatArray:
    """Return the log background (t,) of each frame: the running median in metres with what follows the speed.

    Without a path it is the running median in seconds.
    """
    if cells is not None:
        level = cells.log_power[:, -1] - excess_of(cells, settings.background_m, [-1])[:, 0]
        known = np.isfinite(level)
        return np.asarray(np.interp(frames.chainage_m, cells.chainage_m[known], level[known]), np.float64)
    step = max(1, round(_COARSE_S / frame_s))
    logarithm = np.log(bridged(smooth, np.isfinite(smooth)))
    coarse = ndimage.uniform_filter1d(logarithm, step)[step // 2 :: step]
    half = max(1, round(settings.envelope_background_s / (step * frame_s)))
    places = step // 2 + step * np.arange(len(coarse))
    return np.asarray(np.interp(np.arange(len(smooth)), places, running_median(coarse, half)), np.float64)


def _confidence(match: FloatArray) -> npt.NDArray[np.float64]:
    offset, slope = _LOGISTIC
    return np.asarray(1.0 / (1.0 + np.exp(offset - slope * np.log(np.maximum(match, 1e-6)))), np.float64)
