"""The band in which a stretch of sound stands out, whatever figure told it."""

from dataclasses import dataclass

import numpy as np

from processing.survey import FloatArray


@dataclass(frozen=True)
class BandChoice:
    """``band_hz`` stands out by ``excess`` (in the figure's own unit), ± ``sigma`` (1 sigma)."""

    band_hz: tuple[float, float]
    excess: float
    sigma: float


def best_of(bands_hz: FloatArray, excess: FloatArray, sigma: FloatArray, sigmas: float) -> BandChoice | None:
    """Return the band of the highest ``excess`` (n,) less ``sigmas`` times its own ``sigma`` (n,).

    So a narrow band, whose figure is less sure, must stand out by more. None where none is above 0.
    """
    sure = np.where(np.isfinite(excess), excess - sigmas * sigma, -np.inf)
    best = int(np.argmax(sure))
    if not sure[best] > 0.0:
        return None
    return BandChoice((float(bands_hz[best, 0]), float(bands_hz[best, 1])), float(excess[best]), float(sigma[best]))


def tree_of_bands(count: int, *, thirds: bool) -> tuple[tuple[int, int], ...]:
    """Return the nodes (first, end) of a tree over ``count`` bands that stand side by side.

    Widths 1, 2, 4 …, and with ``thirds`` 3, 6, 12 … too; at each width the nodes stand side by side from the first
    band on, those that would reach beyond the last left out; the whole is always there.
    """
    widths = {1 << k for k in range(count.bit_length())}
    if thirds:
        widths |= {3 << k for k in range(count.bit_length())}
    widths = {width for width in widths if width <= count}
    nodes = {(first, first + width) for width in widths for first in range(0, count - width + 1, width)}
    return tuple(sorted(nodes | {(0, count)}, key=lambda node: (node[1] - node[0], node[0])))
