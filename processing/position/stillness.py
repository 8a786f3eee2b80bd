"""When a carried device stands still: the Butterworth measure of P3 and P0, and the energy of the angular rate.

P3, section 5.3: |a| is high-pass filtered, made absolute, low-pass filtered, and compared with a threshold. The high
pass only takes off the resting level, so here that level is found directly (the quietest seconds of the run), which
holds for any sample rate and any share of walking; a device that turns does not rest, whatever its |a| says.

|a| hardly feels a gentle horizontal push (1 m/s² changes it by 0.05), so where an attitude is at hand its linear
acceleration has a word too. Travel at constant speed feels like rest to all of them: :func:`really_resting` tells.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.settings import PositionSettings
from processing.survey import BoolArray, FloatArray

_LOW_PASS_HZ = 5.0
_ENERGY_S = 0.1
_LEAST_PUSH_MPS2 = 0.15
_LOUDEST_MPS2 = 1.0
_LONGEST_TRAVEL = 200  # quiet spans in one go, between bends or bumps
_LOST_SHARE = 0.3
_FASTEST_MPS = 2.0
_STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Stillness:
    """``still`` (n,) at each sample, and the resting size of the specific force, which is gravity on this sensor."""

    still: BoolArray
    gravity_mps2: float


@dataclass(frozen=True)
class Felt:
    """The world acceleration less gravity (n,): ``push_mps2`` its size, ``change_mps2`` how much it changes within a
    moment, which no tilt error disturbs.
    """

    push_mps2: FloatArray
    change_mps2: FloatArray


def find_stillness(
    time_s: FloatArray,
    acc_mps2: FloatArray,
    gyr_radps: FloatArray,
    settings: PositionSettings,
    felt: Felt | None = None,
) -> Stillness:
    """Return where a device with |a| ``acc_mps2`` (n,) and |ω| ``gyr_radps`` (n,) at ``time_s`` (n,) stands still.

    A carried device starts and stops gently: what it ``felt`` sharpens the search, and a margin is taken off each end.

    Source: P3 section 5.3 and P0 section 3 (Butterworth), Skog et al. 2010 (angular-rate energy).
    """
    rate_hz = 1.0 / float(np.median(np.diff(time_s)))
    gravity = resting_level(acc_mps2, gyr_radps, rate_hz)
    quiet = _low_passed(np.abs(acc_mps2 - gravity), rate_hz) < settings.still_acc_mps2
    quiet &= _smooth(gyr_radps**2, _ENERGY_S * rate_hz) < np.radians(settings.still_gyr_dps) ** 2
    if felt is not None:
        # tremor is a change that never ends, and a tilt error a push: each standstill's own sets the floor
        change = _low_passed(np.minimum(felt.change_mps2, _LOUDEST_MPS2), rate_hz)
        floor = float(np.median(np.take(_windowed(change, rate_hz), _quietest(acc_mps2, gyr_radps, rate_hz), axis=0)))
        quiet &= change < np.clip(3.0 * floor, settings.still_change_mps2, settings.still_acc_mps2)
        push = _low_passed(np.minimum(felt.push_mps2, _LOUDEST_MPS2), rate_hz)
        floor = float(np.median(push[quiet])) if np.any(quiet) else 0.0
        quiet &= push < np.clip(3.0 * floor, _LEAST_PUSH_MPS2, settings.still_acc_mps2)
    # a gap in the samples says nothing about rest
    step = np.diff(time_s)
    gap = np.flatnonzero(step > 0.25)
    quiet[gap] = False
    quiet[gap + 1] = False
    margin_s = settings.still_margin_s if felt is not None else 0.0
    return Stillness(_only_long(time_s, quiet, settings.still_min_s, margin_s), gravity)


def resting_level(acc_mps2: FloatArray, gyr_radps: FloatArray, rate_hz: float) -> float:
    """Return |a| at rest: its median over the quietest quarter seconds, or standard gravity where that is not sane."""
    if len(acc_mps2) < 2 * _window_rows(rate_hz):
        return _STANDARD_GRAVITY
    quietest = _quietest(acc_mps2, gyr_radps, rate_hz)
    level = float(np.median(np.mean(_windowed(acc_mps2, rate_hz)[quietest], axis=1)))
    return level if 9.0 < level < 10.6 else _STANDARD_GRAVITY


def _quietest(acc_mps2: FloatArray, gyr_radps: FloatArray, rate_hz: float) -> npt.NDArray[np.intp]:
    """The quietest fiftieth of all windows."""
    acc, gyr = _windowed(acc_mps2, rate_hz), _windowed(gyr_radps, rate_hz)
    # a metre lever turns 1 rad/s into 1 m/s²: one common scale for both kinds of unrest
    unrest = np.std(acc, axis=1) + np.sqrt(np.mean(gyr**2, axis=1))
    return np.argsort(unrest, kind="stable")[: max(len(unrest) // 50, 2)]


def _windowed(values: FloatArray, rate_hz: float) -> FloatArray:
    """Values (n,) as windows of a quarter second (k, w); a rest at the end is left out."""
    width = min(_window_rows(rate_hz), len(values))
    count = len(values) // width
    return values[: count * width].reshape(count, width)


def _window_rows(rate_hz: float) -> int:
    return max(round(0.25 * rate_hz), 1)


def really_resting(duration_s: FloatArray, first_mps: FloatArray, last_mps: FloatArray) -> BoolArray:
    """Return which of k quiet spans are standstills (k,), and not travel at constant speed, which feels the same.

    ``first_mps`` and ``last_mps`` (k, 3) are the integrated velocities at the ends of each span, ``duration_s``
    (k − 1,) the times between the spans. A velocity gained since a standstill that drift cannot explain (0.05 m/s, and
    a tilt of 0.2° for the time between) is travel if a later span shows it lost again; else it was a knock or a bad
    tilt, and the device rested.
    """
    resting = np.ones(len(first_mps), dtype=np.bool_)
    drift = 0.05 + 0.035 * duration_s
    k = 1
    while k < len(first_mps):
        back = k
        if np.linalg.norm(first_mps[k] - last_mps[k - 1]) > drift[k - 1]:
            back = _velocity_lost_again(drift, first_mps, last_mps, k)
            resting[k:back] = False
        k = back + 1
    return resting


def _velocity_lost_again(drift_mps: FloatArray, first_mps: FloatArray, last_mps: FloatArray, k: int) -> int:
    """The span at which the velocity gained before span ``k`` is gone; ``k`` itself where that never happens.

    The loss must be as plain as the gain was: more than drift, and most of the speed.
    """
    velocity = first_mps[k] - last_mps[k - 1]
    for later in range(k + 1, min(len(first_mps), k + _LONGEST_TRAVEL)):
        speed = float(np.linalg.norm(velocity))
        change = first_mps[later] - last_mps[later - 1]  # within a quiet span it keeps its velocity
        velocity = velocity + change
        left = float(np.linalg.norm(velocity))
        plain = float(np.linalg.norm(change)) > drift_mps[later - 1]
        if plain and left <= _LOST_SHARE * speed + min(drift_mps[later - 1], _LOST_SHARE * speed):
            return later
        if left > 3.0 * _FASTEST_MPS:
            break
    return k


def spans_of(mask: BoolArray) -> npt.NDArray[np.intp]:
    """Return the runs of True as rows ``(first, last)`` (k, 2), both included."""
    edges = np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8))
    return np.column_stack([np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1])


def _low_passed(values: FloatArray, rate_hz: float) -> FloatArray:
    from scipy.signal import butter, sosfiltfilt

    cut = _LOW_PASS_HZ / (0.5 * rate_hz)
    if cut >= 0.95 or len(values) < 12:  # too slow a sensor to smooth
        return values
    return np.asarray(sosfiltfilt(butter(1, cut, output="sos"), values), dtype=np.float64)


def _smooth(values: FloatArray, width: float) -> FloatArray:
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(values, max(round(width), 1), mode="nearest"), dtype=np.float64)


def _only_long(time_s: FloatArray, quiet: BoolArray, least_s: float, margin_s: float) -> BoolArray:
    """Drop the edges of each quiet span, then the spans that are too short; the run's own ends have no edge."""
    still = np.zeros_like(quiet)
    for first, last in spans_of(quiet):
        start = time_s[first] + (margin_s if first > 0 else 0.0)
        end = time_s[last] - (margin_s if last < len(time_s) - 1 else 0.0)
        if end - start >= least_s:
            still[slice(*np.searchsorted(time_s, [start, end], side="left"))] = True
            still[min(int(np.searchsorted(time_s, end)), len(time_s) - 1)] = True
    return still
