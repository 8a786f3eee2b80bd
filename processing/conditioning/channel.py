"""What goes into a channel filter and what comes out: evenly sampled readings, some not to be trusted, without NaN."""

from dataclasses import dataclass, field

import numpy as np

from processing.errors import ErrorCode, LeaklineError
from processing.survey import BoolArray, FloatArray, Params


@dataclass(frozen=True)
class Conditioned:
    """A filtered channel: ``values`` (n,), all finite, and its 1 sigma (n,) under the random-walk model.

    ``probabilities`` (n, models) only where a bank of models was weighed; ``figures`` say what was estimated or chosen.
    """

    values: FloatArray
    sigma: FloatArray | None
    probabilities: np.ndarray[tuple[int, int], np.dtype[np.float32]] | None = None
    figures: Params = field(default_factory=dict)


@dataclass(frozen=True)
class Readings:
    """Readings (n,), finite: 0 where ``valid`` is False; ``first`` is the first valid row."""

    values: FloatArray
    valid: BoolArray
    sample_rate_hz: float

    @property
    def first(self) -> int:
        """The first row that can be trusted."""
        return int(np.argmax(self.valid))

    @property
    def complete(self) -> bool:
        """Whether every row can be trusted."""
        return bool(self.valid.all())


def readings(values: FloatArray, sample_rate_hz: float, valid: BoolArray | None = None) -> Readings:
    """Return ``values`` (n,) as a filter wants them; what is not finite is not valid, whatever the mask says.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES where fewer than two rows are valid.
    """
    given = np.asarray(values, dtype=np.float64)
    trusted = np.isfinite(given) if valid is None else np.isfinite(given) & valid
    count = int(np.count_nonzero(trusted))
    if count < 2:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=count, needed=2)
    return Readings(np.where(trusted, given, 0.0), np.ascontiguousarray(trusted), sample_rate_hz)


def on_grid(time_s: FloatArray, values: FloatArray, valid: BoolArray, max_rows: int = 40_000_000) -> Readings:
    """Return rows with gaps in time as evenly sampled readings at the median rate, invalid where there is no row.

    ``time_s`` (n,) strictly increasing. Each row goes to the nearest moment of the grid that begins at ``time_s[0]``;
    of two at one moment the later stays.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES; FILE_TOO_LARGE where the grid would have more than ``max_rows`` rows.
    """
    if len(time_s) < 2:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=len(time_s), needed=2)
    period_s = float(np.median(np.diff(time_s)))
    rows = (time_s[-1] - time_s[0]) / period_s + 1.0
    if rows > max_rows:
        raise LeaklineError(ErrorCode.FILE_TOO_LARGE, size_mb=rows * 8e-6, limit_mb=max_rows * 8e-6)
    place = np.rint((time_s - time_s[0]) / period_s).astype(np.int64)
    grid, trusted = np.zeros(int(place[-1]) + 1), np.zeros(int(place[-1]) + 1, dtype=np.bool_)
    use = valid & np.isfinite(values)
    grid[place[use]] = values[use]
    trusted[place[use]] = True
    return readings(grid, 1.0 / period_s, trusted)
