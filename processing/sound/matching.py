"""Scores each metre of pipe by how much its sound looks like a passed leak and like nothing else.

Steps 6 to 10 of the detector measured in acoustics §5.1: shape filters in metres, whitening over the bands, a
dictionary of leak spectra, and the test that a candidate must survive: its best rival explanation is taken out first.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import signal

from processing.sound.background import robust_sigma
from processing.sound.cells import CELL_M
from processing.survey import BoolArray, FloatArray

WIDTHS_M = (0.8, 1.3, 2.2, 3.6, 6.0)
_REACH = 6.0  # the filter's half length in half-widths
_CENTRES_HZ = 420.0 * 2.0 ** (0.25 * np.arange(15))  # to 4.75 kHz
_SPREADS_OCTAVES = (0.35, 0.6, 1.0)
_LOW_HZ = 300.0  # bends, valves and traffic rumble below
_TRIM_SHARE = 0.07
_TRIM_PASSES = 3
_SHRINK = 0.5  # half-way to the diagonal: neither full whitening nor none does as well (acoustics §5.2)
_SHORT_RUN_M = 300.0
_STANDS_OUT = 5.0
_MIN_USUAL_SHARE = 0.4
_LOGISTIC = (8.99, 4.43)  # fitted on labelled synthetic runs (acoustics §5.1 step 10)


@dataclass(frozen=True)
class Matched:
    """The score S of each cell (n,), which width and spectrum gave it, and the best score of a low rumble."""

    score: FloatArray
    width_m: FloatArray
    spectrum: npt.NDArray[np.int64]  # column of ``spectra``
    rival: FloatArray
    spectra: FloatArray  # (b, k) the dictionary


def leak_spectra(bands_hz: FloatArray) -> FloatArray:
    """Return the dictionary (b, k): Gaussians over log frequency, each of unit length."""
    centre = np.log2(np.sqrt(bands_hz[:, 0] * bands_hz[:, 1]))
    columns = [
        np.exp(-0.5 * ((centre - np.log2(hz)) / spread) ** 2)
        for hz in _CENTRES_HZ
        if hz <= bands_hz[-1, 1]
        for spread in _SPREADS_OCTAVES
    ]
    return _unit(np.column_stack(columns or [np.ones(len(bands_hz))]))


def nuisance_spectra(bands_hz: FloatArray) -> FloatArray:
    """Return the rivals (b, m): rumbles that fall off above, humps at low frequency, and all bands up together."""
    hz = np.sqrt(bands_hz[:, 0] * bands_hz[:, 1])
    low = [1.0 / (1.0 + (hz / edge) ** 4) for edge in (120.0, 200.0, _LOW_HZ)]
    humps = [np.exp(-0.5 * (np.log2(hz / middle) / 0.5) ** 2) for middle in (110.0, 180.0, _LOW_HZ)]
    return _unit(np.column_stack([*low, *humps, np.ones(len(hz))]))


def matched(excess: FloatArray, bands_hz: FloatArray, heard: BoolArray) -> Matched:
    """Return the score of each cell from ``excess`` (n, b) over its bands (b, 2); −inf where not ``heard``.

    On a short run a strong leak is a good part of the statistics and would hide itself: there, what stands out at first
    is left out of the statistics of a second round. On a long run one round finds slightly more.
    """
    first = _matched(excess, bands_hz, heard, heard)
    usual = heard & ~_around(first)
    count = np.count_nonzero(heard)
    if count * CELL_M > _SHORT_RUN_M or np.count_nonzero(usual) < _MIN_USUAL_SHARE * count:
        return first
    return _matched(excess, bands_hz, heard, usual)


def _around(result: Matched) -> BoolArray:
    """Return the cells within two half-widths of a score that stands out."""
    near = np.zeros(len(result.score), np.bool_)
    for cell in np.flatnonzero(result.score >= _STANDS_OUT):
        reach = int(np.ceil(2 * result.width_m[cell] / CELL_M))
        near[max(0, cell - reach) : cell + reach + 1] = True
    return near


def _matched(excess: FloatArray, bands_hz: FloatArray, heard: BoolArray, usual: BoolArray) -> Matched:
    leaks, rivals = leak_spectra(bands_hz), nuisance_spectra(bands_hz)
    best = np.full(len(excess), -np.inf)
    width, spectrum = np.zeros(len(excess)), np.zeros(len(excess), np.int64)
    rival = np.full(len(excess), -np.inf)
    for width_m in WIDTHS_M:
        shaped = shape_filtered(excess, width_m)
        precision = np.asarray(np.linalg.inv(_shrunk_covariance(shaped[usual])), np.float64)
        score, which, low = _conditional_scores(shaped, precision, leaks, rivals, usual)
        better = score > best
        best[better], width[better], spectrum[better] = score[better], width_m, which[better]
        rival = np.maximum(rival, low)
    best[~heard] = -np.inf
    return Matched(best, width, spectrum, rival, leaks)


def shape_filtered(excess: FloatArray, width_m: float) -> FloatArray:
    """Return (n, b) the excess correlated with 1/(1+(d/w)²), zero mean, unit norm, over ±6 w."""
    half = min(int(np.ceil(_REACH * width_m / CELL_M)), max(1, (len(excess) - 1) // 2))
    shape = 1.0 / (1.0 + (np.arange(-half, half + 1) * CELL_M / width_m) ** 2)
    shape -= shape.mean()
    shape /= np.linalg.norm(shape)
    padded = np.pad(excess, ((half, half), (0, 0)), mode="reflect" if len(excess) > half else "edge")
    return np.asarray(signal.oaconvolve(padded, shape[:, None], mode="valid", axes=0), np.float64)


def confidence(score: FloatArray) -> FloatArray:
    """Return the probability (0..1) that a score is a leak's: half at 7.6."""
    offset, slope = _LOGISTIC
    safe = np.log(np.maximum(score, 1e-6))
    return np.asarray(1.0 / (1.0 + np.exp(offset - slope * safe)), np.float64)


def peaks_apart(score: FloatArray, chainage_m: FloatArray, apart_m: FloatArray, limit: int) -> npt.NDArray[np.int64]:
    """Return the cells of the highest scores, best first, each ``apart_m`` from any better one; at most ``limit``."""
    inner = np.concatenate([[-np.inf], score, [-np.inf]])
    is_peak = (score > 0) & (score >= inner[:-2]) & (score > inner[2:])
    order = np.flatnonzero(is_peak)
    order = order[np.argsort(-score[order], kind="stable")]
    taken: list[int] = []
    places = np.zeros(limit)
    reaches = np.zeros(limit)
    for cell in order:
        n = len(taken)
        if n == limit:
            break
        if np.all(np.abs(places[:n] - chainage_m[cell]) >= np.maximum(reaches[:n], apart_m[cell])):
            places[n], reaches[n] = chainage_m[cell], apart_m[cell]
            taken.append(int(cell))
    return np.array(taken, np.int64)


def _conditional_scores(
    shaped: FloatArray, precision: FloatArray, leaks: FloatArray, rivals: FloatArray, usual: BoolArray
) -> tuple[FloatArray, npt.NDArray[np.int64], FloatArray]:
    """Return the best leak score once each rival that is there is taken out, its spectrum, and the best rival score."""
    leak_score, leak_norm = _whitened(shaped, precision, leaks, usual)
    rival_score, rival_norm = _whitened(shaped, precision, rivals, usual)
    likeness = (leaks.T @ precision @ rivals) / leak_norm[:, None] / rival_norm[None, :]
    likeness = np.clip(likeness, -0.95, 0.95)
    lowest = leak_score.copy()
    for m in range(rivals.shape[1]):
        present = np.maximum(rival_score[:, m : m + 1], 0.0)
        rho = likeness[:, m]
        conditional = (leak_score - present * rho) / np.sqrt(1 - rho**2)
        np.minimum(lowest, np.where(present > 0, conditional, leak_score), out=lowest)
    which = np.argmax(lowest, axis=1)
    return lowest[np.arange(len(lowest)), which], which, rival_score[:, :-1].max(axis=1)


def _whitened(
    shaped: FloatArray, precision: FloatArray, spectra: FloatArray, usual: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return T = d'C⁻¹z / √(d'C⁻¹d) scaled by its own robust sigma, (n, k), and the norms (k,)."""
    weights = precision @ spectra
    norm = np.sqrt(np.einsum("bk,bk->k", spectra, weights))
    score = shaped @ (weights / norm)
    sigma = np.array([robust_sigma(column) for column in score[usual].T])
    return score / np.maximum(sigma, 1e-9), norm


def _shrunk_covariance(shaped: FloatArray) -> FloatArray:
    """Return the covariance (b, b) of the cells without their most unusual ones, half-way to its diagonal."""
    keep = np.ones(len(shaped), np.bool_)
    covariance = np.eye(shaped.shape[1])
    for _ in range(_TRIM_PASSES):
        raw = np.cov(shaped[keep].T) if np.count_nonzero(keep) > 1 else np.eye(shaped.shape[1])
        raw = np.atleast_2d(raw)
        covariance = (1 - _SHRINK) * raw + _SHRINK * np.diag(np.diag(raw))
        covariance[np.diag_indices_from(covariance)] += 1e-9 + 1e-6 * float(np.mean(np.diag(raw)))
        centred = shaped - np.median(shaped[keep], axis=0)
        distance = np.einsum("ib,bc,ic->i", centred, np.linalg.inv(covariance), centred, optimize=True)
        keep = distance <= np.quantile(distance, 1 - _TRIM_SHARE)
    return covariance


def _unit(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.linalg.norm(columns, axis=0), np.float64)
