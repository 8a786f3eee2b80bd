"""Wavelet packets of a stretch of sound: in which band it stands out of its background by energy, kurtosis or order.

The packets are those of I. Daubechies' orthogonal filters, periodic in blocks, so that energy is kept to the last
digit and no band counts another's. The filters are computed (I. Daubechies, Ten Lectures on Wavelets, 1992, §6.1) and
the bank is a few lines: a library for it would be one more to ship.
"""

from dataclasses import dataclass
from functools import cache
from math import comb

import numpy as np
import numpy.typing as npt

from processing.sound.band_choice import BandChoice, best_of
from processing.survey import FloatArray

CRITERIA = ("energy", "kurtosis", "entropy")
_BLOCK = 1 << 18
_FEWEST = 64  # coefficients of a node
_SIGMAS = 4.0
_FLOOR_DB = 0.3  # no background is steadier
# of e = χ² with one degree of freedom: E[e ln e], and the standard deviation of e ln e − (1 + E[e ln e])·e
_NOISE_ENTROPY, _NOISE_ENTROPY_SIGMA = 0.7296, 0.897


@dataclass(frozen=True)
class Packets:
    """The nodes of all levels, rows (n,), ascending in frequency within a level.

    ``power`` is mean square (full scale 1), ``kurtosis`` the excess over a normal distribution's, ``entropy`` Shannon's
    of the coefficients' energies over their number's (1: spread evenly over the time, 0: all at one moment).
    """

    bands_hz: FloatArray  # (n, 2)
    level: npt.NDArray[np.int64]
    power: FloatArray
    kurtosis: FloatArray
    entropy: FloatArray
    count: npt.NDArray[np.int64]  # coefficients behind each row


@cache
def daubechies(moments: int) -> tuple[float, ...]:
    """Return the 2·``moments`` taps of the orthogonal low-pass with that many vanishing moments, least delay.

    The half-band polynomial ``Σ C(N − 1 + k, k) yᵏ`` is factored and its roots within the unit circle are taken.

    Raises:
        ValueError: not 1 to 12; beyond, rounding spoils the roots.
    """
    if not 1 <= moments <= 12:
        raise ValueError("1 to 12 vanishing moments")
    y = np.roots([comb(moments - 1 + k, k) for k in range(moments - 1, -1, -1)]).astype(np.complex128)
    middle = 1.0 - 2.0 * y
    inside = middle - np.sqrt(middle * middle - 1.0)
    inside = np.where(np.abs(inside) < 1.0, inside, 1.0 / inside)
    taps = np.real(np.poly(np.concatenate([-np.ones(moments), inside])))
    return tuple(float(tap) for tap in taps * np.sqrt(2.0) / taps.sum())


def split(nodes: FloatArray, low_pass: FloatArray) -> FloatArray:
    """Return the nodes (2k, m/2) of the next level from ``nodes`` (k, m), m even, both in order of frequency."""
    taps = len(low_pass)
    high_pass = low_pass[::-1] * (-1.0) ** np.arange(taps)
    wrapped = np.pad(nodes, ((0, 0), (0, taps)), mode="wrap")
    half = nodes.shape[1] // 2
    out = np.zeros((2 * len(nodes), half))
    low, high = out[0::2], out[1::2]
    for k in range(taps):
        part = wrapped[:, k : k + 2 * half : 2]
        low += low_pass[k] * part
        high += high_pass[k] * part
    # a high-passed node lies mirrored in frequency: there the halves change places
    out[2::4], out[3::4] = out[3::4].copy(), out[2::4].copy()
    return out


def wavelet_packets(
    samples: npt.NDArray[np.floating], sample_rate_hz: float, levels: int = 6, moments: int = 8
) -> Packets:
    """Return power, kurtosis and entropy of every node down to ``levels`` halvings of ``samples`` (n,).

    Raises:
        ValueError: fewer samples than 64 coefficients in the deepest nodes.
    """
    step = 1 << levels
    whole = len(samples) // step * step
    if whole < _FEWEST * step:
        raise ValueError("too short for so many levels")
    data = np.asarray(samples[:whole], np.float64)
    # the mean belongs to the lowest node alone, but would be the whole of its power
    data = data - data.mean()
    low_pass = np.array(daubechies(moments))
    sums = [np.zeros((3, 1 << level)) for level in range(1, levels + 1)]
    scale = float(np.mean(np.square(data))) or 1.0
    starts = list(range(0, whole, _BLOCK))
    if len(starts) > 1 and whole - starts[-1] < _FEWEST * step:
        starts.pop()  # a short rest is taken along with the block before it
    for start, end in zip(starts, [*starts[1:], whole], strict=True):
        nodes = data[None, start:end]
        for total in sums:
            nodes = split(nodes, low_pass)
            energy = np.square(nodes) / scale
            total[0] += energy.sum(axis=1)
            total[1] += np.square(energy).sum(axis=1)
            total[2] += (energy * np.log(np.maximum(energy, 1e-300))).sum(axis=1)
    rows = [_figures(total, whole >> (k + 1), scale) for k, total in enumerate(sums)]
    half_hz = 0.5 * sample_rate_hz
    edges = [half_hz / (1 << level) * np.arange((1 << level) + 1) for level in range(1, levels + 1)]
    sizes = [1 << level for level in range(1, levels + 1)]
    return Packets(
        bands_hz=np.vstack([np.column_stack([e[:-1], e[1:]]) for e in edges]),
        level=np.repeat(np.arange(1, levels + 1), sizes),
        power=np.concatenate([row[0] for row in rows]),
        kurtosis=np.concatenate([row[1] for row in rows]),
        entropy=np.concatenate([row[2] for row in rows]),
        count=np.repeat([whole >> level for level in range(1, levels + 1)], sizes),
    )


def packet_band(stretch: Packets, background: Packets, criterion: str = "energy") -> BandChoice | None:
    """Return the node in which ``stretch`` stands out most of ``background``; None where none does by four sigma.

    By ``energy`` that is where a detector of energy would be surest: the rise over the background times the root of
    the background's equivalent bandwidth; ``excess`` is in dB. By ``kurtosis`` it is the highest rise of the kurtosis,
    by ``entropy`` the deepest fall of the entropy: both find what comes in bursts, and nothing in a steady hiss.

    Raises:
        ValueError: another criterion, or packets of other bands.
    """
    if criterion not in CRITERIA:
        raise ValueError(f"criterion is none of {CRITERIA}")
    if stretch.bands_hz.shape != background.bands_hz.shape or not np.allclose(stretch.bands_hz, background.bands_hz):
        raise ValueError("the packets are of other bands")
    both = 1.0 / stretch.count + 1.0 / background.count
    if criterion == "kurtosis":
        return best_of(stretch.bands_hz, stretch.kurtosis - background.kurtosis, np.sqrt(24.0 * both), _SIGMAS)
    if criterion == "entropy":
        sigma = _NOISE_ENTROPY_SIGMA * np.sqrt(both) / np.log(stretch.count)
        return best_of(stretch.bands_hz, _disorder(background) - _disorder(stretch), sigma, _SIGMAS)
    ratio = np.divide(stretch.power, background.power, out=np.ones(len(stretch.power)), where=background.power > 0)
    excess_db = 10.0 * np.log10(np.maximum(ratio, 1e-30))
    sigma_db = np.hypot(10.0 / np.log(10.0) * np.sqrt(2.0 * both), _FLOOR_DB)
    surely = (ratio - 1.0) * np.sqrt(_equivalent_width_hz(background))
    sure = np.where(excess_db > _SIGMAS * sigma_db, surely, -np.inf)
    best = int(np.argmax(sure))
    if not np.isfinite(sure[best]):
        return None
    low, high = stretch.bands_hz[best]
    return BandChoice((float(low), float(high)), float(excess_db[best]), float(sigma_db[best]))


def _equivalent_width_hz(packets: Packets) -> FloatArray:
    """Return the bandwidth (n,) of white noise whose power would be as well known as each node's: ``(Σp)²/Σp²``.

    Of a wide node over a steep spectrum the lowest part alone makes the power, and the width is that part's.
    """
    deepest = packets.level == packets.level.max()
    power, edges = packets.power[deepest], packets.bands_hz[deepest]
    first = np.searchsorted(edges[:, 0], packets.bands_hz[:, 0] + 1e-6, side="right") - 1
    end = np.searchsorted(edges[:, 1], packets.bands_hz[:, 1] - 1e-6, side="left") + 1
    total, square = (np.concatenate([[0.0], np.cumsum(terms)]) for terms in (power, np.square(power)))
    spread = np.maximum(square[end] - square[first], 1e-300)
    return np.asarray((edges[0, 1] - edges[0, 0]) * np.square(total[end] - total[first]) / spread, np.float64)


def _disorder(packets: Packets) -> FloatArray:
    """Return the entropy less that of steady noise, which depends a little on how many coefficients there are."""
    return np.asarray(packets.entropy + _NOISE_ENTROPY / np.log(packets.count), np.float64)


def _figures(total: FloatArray, count: int, scale: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    mean, square = total[0] / count, total[1] / count
    known = total[0] > 0
    kurtosis = np.divide(square, np.square(mean), out=np.full(len(mean), 3.0), where=known) - 3.0
    shannon = np.log(np.where(known, total[0], 1.0)) - np.divide(
        total[2], total[0], out=np.zeros(len(mean)), where=known
    )
    return mean * scale, kurtosis, np.where(known, shannon / np.log(count), 1.0)
