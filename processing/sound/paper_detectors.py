"""Detectors after the methods that the papers name: a band chosen by kurtosis or by packets, and the whole spectrum.

P0 and P3 quote them (Ridao et al.: scales and their kurtosis graph, whose largest change points at the leak; FFT
spectra that are searched for what disturbs the usual flow) and use the envelope alone. Here each reads what the one
pass over the sound has measured, along the pipe where there is a path, and along the time where there is none: the
pass's bands, each alone and merged with its neighbours, stand for the scales of a filter bank.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage, signal

from processing.sound.apex import fit_apex
from processing.sound.background import bridged, lower_sigma, running_median
from processing.sound.band_choice import tree_of_bands
from processing.sound.cells import CELL_M, DB_PER_LN, band_log_power, excess_of, impulses
from processing.sound.kurtogram import kurtosis_of_levels
from processing.sound.matching import peaks_apart
from processing.sound.spots import UNCONVINCING, Listening, Spot
from processing.survey import BoolArray, FloatArray

_STEP_S = 0.5  # of a row where there is no path
_APART_M, _APART_S = 5.0, 8.0
_SMOOTH_M = 2.0  # what the envelope's four seconds are at half a metre a second
_LEAST_WIDTH, _MIN_SIGMA = 0.6, 0.06  # metres or seconds; of a smoothed log level
_WINDOWS_OVERLAP = 2
_KURTOSIS_SIGMAS = 1.0
_CELL_WINDOW_M = 2 * CELL_M
# fitted on 16 simulated mains (the usual ones, seeds 0 to 15) above a match of 2.5: offset, slope
_LOGISTIC = {"kurtosis_band": (5.6, 3.25), "wavelet_band": (5.8, 3.2), "spectrum": (4.5, 1.8)}


@dataclass(frozen=True)
class _Rows:
    """The sound along the way: ``excess`` (n, b) of log power over its background at ``place`` (n,), where ``heard``.

    ``values`` (n, b) independent values are behind each; ``removed`` (n, b) is the share that bumps made.
    """

    place: FloatArray
    excess: FloatArray
    heard: BoolArray
    values: FloatArray
    removed: npt.NDArray[np.float32]
    bands_hz: FloatArray
    step: float
    half: int  # rows of half a background window
    apart: float
    smooth: float


@dataclass(frozen=True)
class _Match:
    """How far each row (n,) stands out in sigmas, and in which bands (first, end) of the tree (n,) it does."""

    match: FloatArray
    node: npt.NDArray[np.int64]


def find_by_kurtosis_band(listening: Listening) -> list[Spot]:
    """Return the spots, best first: peaks of the envelope in the band of highest kurtosis of each stretch of pipe."""
    return _found("kurtosis_band", listening, _by_kurtosis, thirds=True)


def find_by_wavelet_band(listening: Listening) -> list[Spot]:
    """Return the spots, best first: where any band of the halving tree holds most energy over its background."""
    return _found("wavelet_band", listening, _by_energy, thirds=False)


def find_by_spectrum(listening: Listening) -> list[Spot]:
    """Return the spots, best first: where the spectrum as a whole stands over the background's."""
    return _found("spectrum", listening, _by_spectrum, thirds=False)


Matcher = Callable[[_Rows, list[FloatArray], tuple[tuple[int, int], ...]], _Match]


def _found(method: str, listening: Listening, matcher: Matcher, *, thirds: bool) -> list[Spot]:
    rows = _rows_of(listening)
    if rows is None or np.count_nonzero(rows.heard) < 8:
        return []
    nodes = tree_of_bands(rows.excess.shape[1], thirds=thirds)
    merged = [_merged(rows, node) for node in nodes]
    found = matcher(rows, merged, nodes)
    match = np.where(rows.heard & np.isfinite(found.match), found.match, -np.inf)
    probability = _confidence(method, match)
    settings = listening.settings
    apart = np.full(len(match), rows.apart)
    taken = peaks_apart(match, rows.place, apart, int(settings.max_candidates))
    return [
        _spot(method, int(row), rows, merged, nodes[found.node[row]], found, float(probability[row]), nodes)
        for row in taken
        if probability[row] >= settings.min_score
    ]


def _rows_of(listening: Listening) -> _Rows | None:
    table = listening.scan.bands_hz
    # what rumbles below the chosen band, bends and traffic, would decide every choice of a band
    used = np.flatnonzero(table[:-1, 1] > table[-1, 0])
    if not len(used):
        return None
    bands_hz = table[used]
    bandwidth = bands_hz[:, 1] - bands_hz[:, 0]
    cells, settings = listening.cells, listening.settings
    if cells is None:
        return _rows_in_time(listening, used)
    seconds = _CELL_WINDOW_M / np.maximum(cells.speed_mps, settings.min_speed_mps)
    return _Rows(
        place=cells.chainage_m,
        excess=excess_of(cells, settings.background_m, used.tolist()),
        heard=cells.heard,
        values=np.outer(seconds, bandwidth),
        removed=cells.removed_share[:, used],
        bands_hz=bands_hz,
        step=CELL_M,
        half=max(1, round(settings.background_m / CELL_M)),
        apart=_APART_M,
        smooth=_SMOOTH_M,
    )


def _rows_in_time(listening: Listening, used: npt.NDArray[np.int64]) -> _Rows | None:
    """Return rows of half a second, the background being that of the envelope finder where no path is known."""
    scan, frames, settings = listening.scan, listening.frames, listening.settings
    bands_hz = scan.bands_hz[used]
    size = max(1, round(_STEP_S / scan.frame_s))
    count = len(frames.time_s) // size
    if count < 2:
        return None
    row = np.minimum(np.arange(len(frames.time_s)) // size, count - 1)
    heard = np.bincount(row[frames.counts], minlength=count) > 0
    half = max(1, round(settings.envelope_background_s / (size * scan.frame_s)))
    excess, removed = np.zeros((count, len(bands_hz))), np.zeros((count, len(bands_hz)), np.float32)
    for band, measured in enumerate(used):
        logarithm = band_log_power(scan, int(measured))
        good = frames.counts & ~impulses(logarithm, frames.counts)
        power = np.exp(logarithm.astype(np.float64))
        number = np.bincount(row[good], minlength=count)
        kept = np.bincount(row[good], power[good], count)
        total = np.bincount(row[frames.counts], power[frames.counts], count)
        known = (number > 0) & (kept > 0)
        if not known.any():
            continue
        level = bridged(np.log(np.where(known, kept, 1.0) / np.maximum(number, 1)), known)
        excess[:, band] = np.where(heard, level - running_median(np.where(heard, level, np.nan), half), 0.0)
        removed[:, band] = np.where(total > 0, 1.0 - kept / np.where(total > 0, total, 1.0), 0.0)
    return _Rows(
        place=np.bincount(row, frames.time_s, count) / np.bincount(row, minlength=count),
        excess=np.where(np.isfinite(excess), excess, 0.0),
        heard=heard,
        values=np.full((count, len(bands_hz)), size * scan.frame_s) * (bands_hz[:, 1] - bands_hz[:, 0]),
        removed=removed,
        bands_hz=bands_hz,
        step=size * scan.frame_s,
        half=half,
        apart=_APART_S,
        smooth=settings.envelope_smooth_s,
    )


def _merged(rows: _Rows, node: tuple[int, int]) -> FloatArray:
    """Return the linear excess (n,) of the bands of a node together: each counts by its power over its background."""
    return np.asarray(np.exp(rows.excess[:, slice(*node)]).mean(axis=1), np.float64)


def _smoothed(rows: _Rows, power: FloatArray) -> FloatArray:
    """Return the logarithm (n,) of the envelope: the power convolved with a Hann window over what was heard."""
    size = max(1, round(rows.smooth / rows.step))
    kernel = np.hanning(size + 2)[1:-1]
    share = np.maximum(signal.oaconvolve(rows.heard.astype(np.float64), kernel, mode="same"), 1e-9)
    total = np.maximum(signal.oaconvolve(np.where(rows.heard, power, 0.0), kernel, mode="same"), 1e-12)
    return np.where(rows.heard, np.log(total / share), np.nan)


def _standing_out(rows: _Rows, power: FloatArray) -> FloatArray:
    """Return the smoothed log envelope over its median in its own sigmas (n,)."""
    height = _smoothed(rows, power)
    height = height - running_median(height, rows.half)
    return np.asarray(height / max(lower_sigma(height[rows.heard]), _MIN_SIGMA), np.float64)


def _by_kurtosis(rows: _Rows, merged: list[FloatArray], nodes: tuple[tuple[int, int], ...]) -> _Match:
    """In windows as long as the background's, each overlapping half, the band of the highest kurtosis is listened to.

    A narrow band's kurtosis is less sure: it must be higher by as much.
    """
    count = len(rows.place)
    power = np.where(rows.heard[:, None], np.column_stack(merged), np.nan)
    values = np.column_stack([rows.values[:, slice(*node)].sum(axis=1) for node in nodes])
    best, node = np.full(count, -np.inf), np.zeros(count, np.int64)
    kept: dict[int, FloatArray] = {}
    size = min(2 * rows.half, count)
    for start in range(0, count, max(1, size // _WINDOWS_OVERLAP)):
        window = slice(max(0, min(start, count - size)), min(start + size, count))
        heard = int(np.count_nonzero(rows.heard[window]))
        if heard < 8:
            continue
        kurtosis = kurtosis_of_levels(power[window], values[window])
        doubt = 2.0 * np.sqrt(2.0 / np.maximum(values[window].mean(axis=0), 1.0) / heard)
        chosen = int(np.argmax(kurtosis - _KURTOSIS_SIGMAS * doubt))
        if chosen not in kept:
            kept[chosen] = _standing_out(rows, merged[chosen])
        better = np.flatnonzero(kept[chosen][window] > best[window]) + window.start
        best[better], node[better] = kept[chosen][better], chosen
    return _Match(best, node)


def _by_energy(rows: _Rows, merged: list[FloatArray], nodes: tuple[tuple[int, int], ...]) -> _Match:
    """Each row takes the band of the tree whose energy stands furthest over its background."""
    del nodes
    best, node = np.full(len(rows.place), -np.inf), np.zeros(len(rows.place), np.int64)
    for number, power in enumerate(merged):
        match = _standing_out(rows, power)
        better = match > best
        best[better], node[better] = match[better], number
    return _Match(best, node)


def _by_spectrum(rows: _Rows, merged: list[FloatArray], nodes: tuple[tuple[int, int], ...]) -> _Match:
    """All bands' excess, each over its own sigma, is summed; the band is the one that holds most of the sum."""
    sigma = np.array([max(lower_sigma(column[rows.heard]), _MIN_SIGMA) for column in rows.excess.T])
    above = np.clip(rows.excess / sigma, 0.0, 8.0)  # no one band decides alone
    total = np.exp(above.mean(axis=1))
    match = _standing_out(rows, total)
    shares = np.column_stack([ndimage.uniform_filter1d(np.log(power), 5) for power in merged])
    widths = np.array([end - first for first, end in nodes])
    return _Match(match, np.asarray(np.argmax(shares * np.sqrt(widths), axis=1), np.int64))


def _spot(
    method: str,
    row: int,
    rows: _Rows,
    merged: list[FloatArray],
    node: tuple[int, int],
    found: _Match,
    probability: float,
    nodes: tuple[tuple[int, int], ...],
) -> Spot:
    power = merged[nodes.index(node)]
    width = max(_LEAST_WIDTH, rows.smooth / 4)
    apex = fit_apex(rows.place[rows.heard], power[rows.heard] - 1.0, float(rows.place[row]), width)
    near = (np.abs(rows.place - apex.chainage_m) <= max(apex.width_m, 2 * rows.step)) & rows.heard
    bands = slice(*node)
    removed = float(rows.removed[near, bands].mean()) if near.any() else 0.0
    return Spot(
        place=apex.chainage_m,
        sigma=apex.sigma_m,
        width=apex.width_m,
        score=probability if apex.is_convincing else UNCONVINCING * probability,
        level_db=float(np.log1p(apex.height) * DB_PER_LN),
        band_hz=(float(rows.bands_hz[node[0], 0]), float(rows.bands_hz[node[1] - 1, 1])),
        evidence={"method": method, "match": float(found.match[row]), "impulsive_share": removed},
    )


def _confidence(method: str, match: FloatArray) -> FloatArray:
    offset, slope = _LOGISTIC[method]
    return np.asarray(1.0 / (1.0 + np.exp(offset - slope * np.log(np.maximum(match, 1e-6)))), np.float64)
