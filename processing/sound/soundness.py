"""What tells that a recording is not what the microphone heard: clipping at any level, and hum of the mains."""

import numpy as np
import numpy.typing as npt

from processing.sound.pcm import Samples

SILENT, DROPOUT, CLIPPED = 1, 2, 4  # bits of a frame's state
FULL_SCALE = 0.999
_RUN = 3  # samples in a row that stand at the limit
_NEAR = 2e-4  # of the limit: what counts as standing at it; a converter's last digits are not quiet
_LEAST_LIMIT = 0.05  # full scale is 1; no amplifier cuts off lower, but a byte has only six steps below it
_LEAST_BLOCKS = 4  # that touch the limit
_LEAST_SAMPLES = 24
_PILED = 8.0  # times as many at the limit as just below it; a tone has 2.4, noise less than 1
_HUM_HZ = (50.0, 60.0)
_HARMONICS = 4
_ON_LINE = np.array([-1, 0, 1])  # a line may stand between two bins
_FAR_BINS = 5
_BESIDE = np.array([3, 4, _FAR_BINS])  # beyond the width of the window's main lobe


def clipped_at(samples: Samples, lowest: Samples, highest: Samples) -> tuple[npt.NDArray[np.bool_] | None, float]:
    """Return which samples stand at a limit of the recorder, and that limit; ``(None, nan)`` where there is none.

    A limit is full scale; or a lower level at which many samples stand and just below which there are few: an amplifier
    that runs out of range before its converter, or a gain that was taken back afterwards. Clipping that was filtered or
    compressed afterwards has no flat tops any more and is not found.

    Args:
        samples: (n,) the sound.
        lowest: (blocks,) lowest value of each of its equal blocks.
        highest: (blocks,) their highest values.
    """
    sides = ((samples, highest), (-samples, -lowest)) if _may_clip(-lowest) else ((samples, highest),)
    stands = np.zeros(len(samples), np.bool_)
    limits = []
    for side, tops in sides:
        if _may_clip(tops) and (limit := _limit(side, float(tops.max()))) is not None:
            stands |= side >= limit
            limits.append(float(tops.max()))
    if not limits:
        return None, float("nan")
    runs = stands[: 1 - _RUN].copy()
    for shift in range(1, _RUN):
        runs &= stands[shift : len(stands) + 1 - _RUN + shift]
    clipped = np.zeros(len(samples), np.bool_)
    for shift in range(_RUN):
        clipped[shift : shift + len(runs)] |= runs
    return clipped, min(limits)


def _may_clip(tops: Samples) -> bool:
    """Tell at little cost whether a closer look is worth while: several blocks reach the same height."""
    top = float(tops.max())
    if top >= FULL_SCALE:
        return True
    return top >= _LEAST_LIMIT and int(np.count_nonzero(tops >= top * (1 - _NEAR))) >= _LEAST_BLOCKS


def _limit(side: Samples, top: float) -> float | None:
    """Return from which value on samples stand at the limit, None where there is no limit."""
    if top >= FULL_SCALE:
        return FULL_SCALE
    limit = top * (1 - _NEAR)
    at_limit = int(np.count_nonzero(side >= limit))
    if at_limit < _LEAST_SAMPLES:
        return None
    below = side[(side < limit) & (side >= top * 0.5)]
    if not len(below):
        return limit
    # the next value that occurs, however coarse the steps are
    just_below = int(np.count_nonzero(below >= float(below.max()) - top * _NEAR))
    return limit if at_limit >= _PILED * just_below else None


def hum_excess_db(power: Samples, bin_hz: float) -> tuple[float, float]:
    """Return by how many dB the lines of 50 and of 60 Hz stand above what surrounds them: their second strongest one.

    One line may be anything; the mains, and pumps, bring several. ``power`` (bins,) is a mean over time; the bins must
    be narrower than some 5 Hz, so that a line is told from its surroundings.
    """
    level_db = 10 * np.log10(np.maximum(power.astype(np.float64), 1e-30))
    fifty, sixty = (_second_line(level_db, hz / bin_hz) for hz in _HUM_HZ)
    return fifty, sixty


def _second_line(level_db: npt.NDArray[np.float64], bins: float) -> float:
    at = np.rint(bins * np.arange(1, _HARMONICS + 1)).astype(np.intp)
    at = at[(at > _FAR_BINS) & (at < len(level_db) - _FAR_BINS)][:, None]
    if len(at) < 2:
        return 0.0
    line = level_db[at + _ON_LINE].max(axis=1)
    before, after = (np.sort(level_db[at + sign * _BESIDE], axis=1)[:, len(_BESIDE) // 2] for sign in (-1, 1))
    return float(np.sort(line - 0.5 * (before + after))[-2])
