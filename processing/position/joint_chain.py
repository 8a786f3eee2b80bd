"""Finds a regular spacing among blows along a way: the longest believable chain of joints, with some missed or extra.

Every blow is a joint or a stray. A chain of joints pays for each link by how much better a spacing of m pipes explains
its gap than a stray of the same density would: the log-likelihood ratio of a Poisson crowd of strays. The best chain
over all spacings is found by dynamic programming over the blows (Smith & Waterman 1981, local alignment: a chain may
begin and end anywhere), and its score has a threshold that random blows do not reach in 999 of 1000 runs.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray

LEAST_SCORE = 18.0  # nats; of 690 runs of random, clustered or spaced-out blows none reached 15
LEAST_JOINTS = 8
_PIPES_PER_LINK = 4
_LOOK_BACK = 14  # blows
_DETECTED = 0.85
_SHORTEST_M, _LONGEST_M = 2.0, 20.0
_GRID_STEP = 0.008
_LINK_SIGMA_M = 0.12
_LINK_SIGMA_SHARE = 0.03  # of the spacing: slip, cut pipes
_SIGMA_FLOOR_M = 0.02


@dataclass(frozen=True)
class Chain:
    """Joints at rows (n,) of the blows, ``pipes`` (n − 1,) between each and the next, and what they have in common.

    ``spacing_m`` is by odometer; ``sigma_m`` is the scatter of one pipe about it, without the part that neighbours
    share (the odometer's slow slip); ``score`` in nats.
    """

    rows: npt.NDArray[np.intp]
    pipes: npt.NDArray[np.intp]
    spacing_m: float
    sigma_m: float
    score: float


def find_chain(place_m: FloatArray, around_m: tuple[float, float] = (_SHORTEST_M, _LONGEST_M)) -> Chain | None:
    """Return the chain of joints among blows at odometer readings ``place_m`` (n,), ascending; None if chance would do.

    The spacing is looked for in ``around_m``.
    """
    if len(place_m) < LEAST_JOINTS or place_m[-1] <= place_m[0]:
        return None
    count = max(int(np.ceil(np.log(around_m[1] / around_m[0]) / _GRID_STEP)), 1)
    spacing = around_m[0] * np.exp(_GRID_STEP * np.arange(count + 1))
    sigma = np.hypot(_LINK_SIGMA_M, _LINK_SIGMA_SHARE * spacing)
    rough = _best(place_m, spacing, sigma)
    if rough.score < LEAST_SCORE or len(rough.rows) < LEAST_JOINTS:
        return None
    scatter = _scatter(place_m, rough)
    fine = rough.spacing_m * (1.0 + np.linspace(-0.01, 0.01, 11))
    fitted = np.full(len(fine), float(np.clip(scatter, _SIGMA_FLOOR_M, float(sigma.max()))))
    chain = _best(place_m, fine, fitted)
    if len(chain.rows) < LEAST_JOINTS:
        return None
    return Chain(chain.rows, chain.pipes, chain.spacing_m, _own_sigma(place_m, chain), rough.score)


def _best(place_m: FloatArray, spacing: FloatArray, sigma: FloatArray) -> Chain:
    """The best chain over the spacings (p,), each with the scatter of one link (p,)."""
    density = (len(place_m) - 1) / float(place_m[-1] - place_m[0])
    pipes = np.arange(1, _PIPES_PER_LINK + 1)
    price = np.log(_DETECTED) + (pipes - 1) * np.log(1.0 - _DETECTED) - np.log(density)
    wide = sigma * np.sqrt(pipes)[:, None]  # (m, p)
    price = price[:, None] - np.log(wide * np.sqrt(2.0 * np.pi))
    score = np.zeros((len(place_m), len(spacing)))
    before = np.full(score.shape, -1, dtype=np.int32)
    many = np.zeros(score.shape, dtype=np.int8)
    for row in range(1, len(place_m)):
        first = max(row - _LOOK_BACK, 0)
        gap = place_m[row] - place_m[first:row]
        link = price - 0.5 * ((gap[:, None, None] - pipes[:, None] * spacing) / wide) ** 2  # (j, m, p)
        which = link.argmax(axis=1)
        total = score[first:row] + np.take_along_axis(link, which[:, None, :], axis=1)[:, 0]
        best = total.argmax(axis=0)
        value = np.take_along_axis(total, best[None], axis=0)[0]
        linked = value > 0.0
        score[row] = np.where(linked, value, 0.0)
        before[row] = np.where(linked, best + first, -1)
        many[row] = np.take_along_axis(which, best[None], axis=0)[0] + 1
    end, column = np.unravel_index(int(score.argmax()), score.shape)
    return _traced(place_m, before[:, column], many[:, column], int(end), float(score[end, column]))


def _traced(
    place_m: FloatArray, before: npt.NDArray[np.int32], many: npt.NDArray[np.int8], end: int, score: float
) -> Chain:
    rows, pipes = [end], []
    while before[rows[-1]] >= 0:
        pipes.append(int(many[rows[-1]]))
        rows.append(int(before[rows[-1]]))
    chain = np.array(rows[::-1], dtype=np.intp)
    links = np.array(pipes[::-1], dtype=np.intp)
    spacing = float((place_m[chain[-1]] - place_m[chain[0]]) / max(int(links.sum()), 1))
    return Chain(chain, links, spacing, 0.0, score)


def _left(place_m: FloatArray, chain: Chain) -> FloatArray:
    """What each link is longer than its pipes, per √pipe; gentle changes of the odometer's scale are not taken off."""
    return np.asarray((np.diff(place_m[chain.rows]) - chain.pipes * chain.spacing_m) / np.sqrt(chain.pipes))


def _scatter(place_m: FloatArray, chain: Chain) -> float:
    left = _left(place_m, chain)
    return float(1.4826 * np.median(np.abs(left - np.median(left))))


def _own_sigma(place_m: FloatArray, chain: Chain) -> float:
    """Scatter of a pipe's own length: pipes do not know their neighbours, so what neighbours share is the slip's.

    Robust against a few links that are none: residuals are clipped at three scatters.
    """
    left = _left(place_m, chain)
    limit = 3.0 * max(_scatter(place_m, chain), _SIGMA_FLOOR_M)
    left = np.clip(left - left.mean(), -limit, limit)
    whole = float(np.mean(left**2))
    shared = float(np.mean(left[1:] * left[:-1]))
    return float(np.sqrt(max(whole - max(shared, 0.0), 0.3 * whole, _SIGMA_FLOOR_M**2)))
