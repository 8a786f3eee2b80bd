"""Which decibels the colours of a picture of sound span: a fixed range, the same everywhere, until one asks otherwise.

A range that followed each view would make the same leak look loud here and weak there, and a single knock would hide
what is weak beside it. So it is fixed; :meth:`Contrast.fitted` takes it once from what is visible, and says so.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from widgets.colour_bar import LEAST_RANGE_DB, ColourBar
from widgets.plot_scale import Scale

USUAL_DB = (-95.0, -35.0)  # of full scale, a bin: what an ordinary hydrophone hears in a pipe lies within
SHARES = (0.05, 0.998)  # acoustics §4.3: never by extremes, which one click would set
MOST_HIDDEN = 0.5  # of what is visible: more than that below the colours, and weak sounds may be among it
Counts = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Contrast:
    """A colour bar with the range to go back to; ``auto`` while it was taken from what was visible."""

    bar: ColourBar
    fixed_db: tuple[float, float]
    auto: bool = False

    def with_fixed(self, low_db: float, high_db: float) -> "Contrast":
        """Return this with another fixed range, in use at once."""
        fixed = (low_db, max(high_db, low_db + LEAST_RANGE_DB))
        return Contrast(replace(self.bar, low_db=fixed[0], high_db=fixed[1]), fixed)

    def back(self) -> "Contrast":
        """Return this with the fixed range in use."""
        return self.with_fixed(*self.fixed_db)

    def fitted(self, counts: Counts, levels_db: tuple[float, float]) -> "Contrast | None":
        """Return this with the range of what is visible: how often each number from 0 to 255 occurs, of which the
        first and last stand for ``levels_db``; None where nothing is visible.
        """
        counts, scale = np.where(np.arange(256) == 0, 0, counts), self.bar.scale  # 0 is "nothing there"
        if not counts.any():
            return None
        share = np.cumsum(counts) / counts.sum()
        first, last = levels_db
        lowest, highest = (first + (last - first) / 255.0 * int(np.searchsorted(share, part)) for part in SHARES)
        if self.bar.symmetric:
            half = min(max(math.ceil(max(highest, -lowest)), 6.0), scale.high)
            low, high = -half, half
        else:
            low, high = lowest - 3.0, max(highest, lowest + 27.0)
            low, high = round(max(low, scale.low)), round(min(max(high, low + LEAST_RANGE_DB), scale.high))
        return replace(self, bar=replace(self.bar, low_db=low, high_db=high), auto=True)

    def over(self, scale: Scale) -> "Contrast":
        """Return this for a sound whose levels span ``scale``; the range stays."""
        wide = Scale(min(scale.low, self.bar.low_db), max(scale.high, self.bar.high_db))
        return replace(self, bar=replace(self.bar, scale=wide))

    def hidden_share(self, counts: Counts, levels_db: tuple[float, float]) -> float:
        """Return which part of what is visible lies below the colours, 0 to 1; 0 for colours on both sides of 0 dB."""
        counts = np.where(np.arange(256) == 0, 0, counts)
        if self.bar.symmetric or not counts.any():
            return 0.0
        levels = np.linspace(*levels_db, 256)
        return float(counts[levels <= self.bar.low_db].sum() / counts.sum())
