"""Standstill detectors of a foot or a carried device, in one table: each gives a statistic, small at rest.

The threshold detectors of Skog et al. 2010 and Wahlström, Skog 2021: variance of the acceleration, its size, energy
of the angular rate, and SHOE, the likelihood ratio of both; the Butterworth measure of P3; and two networks, whose
statistic is the probability of motion. A fixed threshold is the known way to fail: what separates stance from swing
changes a thousandfold between strolling and running. So a threshold is laid, by default, between the levels that the
statistic itself reaches at the stances and swings around (:func:`adaptive_threshold`).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from processing.position.odometry import BLOCK_ROWS
from processing.position.zero_velocity_network import RATE_HZ, Float32Array, load_network, standing_probability
from processing.progress import Progress
from processing.settings import PositionSettings
from processing.survey import BoolArray, FloatArray

_ACC_NOISE_MPS2 = 0.00098  # the scale of SHOE as PyShoe has it for this sensor, so that thresholds can be compared
_GYR_NOISE_RADPS = np.radians(0.005)
_STRIDE_S = 1.3  # holds a stance and a swing of any gait
_STRIDES = 9
_LOW_PASS_HZ = 5.0

Statistic = Callable[[FloatArray, FloatArray, int, float], FloatArray]


@dataclass(frozen=True)
class Detector:
    """``statistic(acc, gyr, window, gravity)`` gives (n,) of (n, 3) each, in ``unit``; ``window_s`` long.

    ``fixed`` is the usual fixed threshold (of the networks 1 − 0.85, P4). The adaptive one is, in decades,
    ``base + low·L + high·H`` of the levels at stance ``L`` and swing ``H``, within ``least``..``most``; learned on the
    training sessions named in ``packaging/train_zero_velocity.py``. ``network`` is the name of a learned one, which
    brings its own. A shorter standstill than ``least_s`` is none.
    """

    unit: str
    fixed: float
    statistic: Statistic | None = None
    window_s: float = 0.025
    base: float = 0.0
    low: float = 0.5
    high: float = 0.5
    least: float = 0.0
    most: float = np.inf
    least_s: float = 0.0
    network: str = ""


@dataclass(frozen=True)
class Standing:
    """At each sample the ``statistic`` (n,), the ``threshold`` it is held against (n,), and ``still`` (n,)."""

    statistic: Float32Array
    threshold: Float32Array
    still: BoolArray


def acceleration_variance(acc: FloatArray, gyr: FloatArray, window: int, gravity: float) -> FloatArray:
    """Return ``(1/W) Σ ‖a − ā‖²`` (n,) in (m/s²)²: Skog et al. 2010, equation (13) without its noise."""
    del gyr, gravity
    return np.asarray(np.maximum(_mean(_square(acc), window) - _square(_mean(acc, window)), 0.0))


def acceleration_magnitude(acc: FloatArray, gyr: FloatArray, window: int, gravity: float) -> FloatArray:
    """Return ``(1/W) Σ (‖a‖ − g)²`` (n,) in (m/s²)²: Skog et al. 2010, equation (14) without its noise."""
    del gyr
    return _mean((np.sqrt(_square(acc)) - gravity) ** 2, window)


def rate_energy(acc: FloatArray, gyr: FloatArray, window: int, gravity: float) -> FloatArray:
    """Return ``(1/W) Σ ‖ω‖²`` (n,) in (rad/s)²: Skog et al. 2010, equation (15) without its noise."""
    del acc, gravity
    return _mean(_square(gyr), window)


def shoe(acc: FloatArray, gyr: FloatArray, window: int, gravity: float) -> FloatArray:
    """Return ``(1/W) Σ (‖a − g ā/‖ā‖‖²/σa² + ‖ω‖²/σω²)`` (n,), σa 0.00098 m/s², σω 0.005 °/s: Skog et al. 2010, (12).

    With the window's mean ā the sum of the first part is ``mean ‖a‖² − 2 g ‖ā‖ + g²``.
    """
    size = np.sqrt(_square(_mean(acc, window)))
    pushed = np.maximum(_mean(_square(acc), window) - 2.0 * gravity * size + gravity**2, 0.0)
    return np.asarray(pushed / _ACC_NOISE_MPS2**2 + _mean(_square(gyr), window) / _GYR_NOISE_RADPS**2)


def butterworth(acc: FloatArray, gyr: FloatArray, window: int, gravity: float) -> FloatArray:
    """Return P3's measure (n,) in m/s²: ``| |a| − g |`` smoothed by a Butterworth low pass (P3 section 5.3).

    ``window`` is one fifth of the low pass's period, 5 Hz for 40 ms.
    """
    del gyr
    from scipy.signal import butter, sosfiltfilt

    off = np.abs(np.sqrt(_square(acc)) - gravity)
    cut = 0.4 / max(window, 1)
    if cut >= 0.95 or len(off) < 12:
        return off
    return np.maximum(np.asarray(sosfiltfilt(butter(1, cut, output="sos"), off), dtype=np.float64), 0.0)


DETECTORS: dict[str, Detector] = {
    "variance": Detector("(m/s²)²", 0.02, acceleration_variance, 0.071, -0.389, 0.659, 0.286, 2e-3, 2.0),
    "magnitude": Detector("(m/s²)²", 0.1, acceleration_magnitude, 0.1, 0.736, 0.9, 0.1, 5e-3, 10.0),
    "rate_energy": Detector("(rad/s)²", 0.2, rate_energy, 0.093, -0.776, 0.175, 0.712, 1e-2, 3.0),
    "shoe": Detector("", 8.5e7, shoe, 0.083, 1.211, 0.224, 0.57, 3e6, 1e9),
    "butterworth": Detector("m/s²", 0.5, butterworth, 0.0206, 0.315, 0.504, 0.009, 0.05, 5.0),
    "lstm": Detector("", 0.15, network="lstm"),
    "tcn": Detector("", 0.15, network="tcn"),
}


def find_standing(
    name: str,
    time_s: FloatArray,
    blocks: Callable[[slice], tuple[FloatArray, FloatArray]],
    gravity_mps2: float,
    settings: PositionSettings,
    progress: Progress,
) -> Standing:
    """Return where detector ``name`` of :data:`DETECTORS` sees standstill, at ``time_s`` (n,).

    ``blocks(rows)`` gives specific force and rate (k, 3) of a slice of rows, so that no copy of a long run is needed.
    """
    detector = DETECTORS[name]
    rate_hz = 1.0 / float(np.median(np.diff(time_s)))
    if detector.network:
        load = load_network(detector.network)
        moving = np.empty(len(time_s), dtype=np.float32)
        for rows, wide in _overlapping(len(time_s), round(2.0 * rate_hz)):
            values = _at_200_hz(time_s[wide], *blocks(wide))
            standing = standing_probability(load, values.acc, values.gyr)
            back = np.interp(time_s[rows], values.time_s, standing)
            moving[rows] = 1.0 - back
            progress.update(rows.stop / len(time_s), "position_standstills")
        most = detector.fixed if settings.zero_velocity_threshold == "fixed" else 1.0 - load.threshold
        threshold = np.full(len(time_s), most, dtype=np.float32)
        return Standing(moving, threshold, moving < threshold)
    assert detector.statistic is not None
    window = max(round(detector.window_s * rate_hz), 2)
    out = np.empty(len(time_s), dtype=np.float32)
    for rows, wide in _overlapping(len(time_s), round(2.0 * rate_hz)):
        values_wide = detector.statistic(*blocks(wide), window, gravity_mps2)
        out[rows] = values_wide[rows.start - wide.start : rows.stop - wide.start]
        progress.update(rows.stop / len(time_s), "position_standstills")
    if settings.zero_velocity_threshold == "fixed":
        threshold = np.full(len(out), detector.fixed, dtype=np.float32)
    else:
        threshold = adaptive_threshold(out, rate_hz, detector)
    return Standing(out, threshold, out < threshold)


def adaptive_threshold(statistic: Float32Array, rate_hz: float, detector: Detector) -> Float32Array:
    """Return the threshold (n,) between the levels of stance and swing around each sample.

    A piece of 1.3 s holds at least one stance and one swing of a walk: its least and greatest value are their levels,
    medians over nine such pieces are what is usual there. Nothing is tuned to the run; a whole run of standing has a
    low "swing" and falls under ``detector.least``.
    """
    from scipy.ndimage import median_filter

    width = max(round(_STRIDE_S * rate_hz), 2)
    count = max(len(statistic) // width, 1)
    decades = np.log10(np.maximum(statistic, 1e-12))
    pieces = decades[: count * width].reshape(count, -1) if len(decades) >= width else decades[None, :]
    low = median_filter(np.min(pieces, axis=1), _STRIDES, mode="nearest")
    high = median_filter(np.max(pieces, axis=1), _STRIDES, mode="nearest")
    level = np.clip(
        detector.base + detector.low * low + detector.high * high,
        np.log10(max(detector.least, 1e-12)),
        np.log10(detector.most),
    )
    centre = (np.arange(count) + 0.5) * width
    return np.asarray(10.0 ** np.interp(np.arange(len(statistic)), centre, level), dtype=np.float32)


@dataclass(frozen=True)
class _Uniform:
    time_s: FloatArray
    acc: Float32Array
    gyr: Float32Array


def _at_200_hz(time_s: FloatArray, acc: FloatArray, gyr: FloatArray) -> _Uniform:
    """Both at 200 Hz: a quicker sensor is averaged first, a slower one drawn out."""
    rate_hz = 1.0 / float(np.median(np.diff(time_s)))
    grid = time_s[0] + np.arange(int((time_s[-1] - time_s[0]) * RATE_HZ) + 1) / RATE_HZ
    width = max(round(rate_hz / RATE_HZ), 1)

    def at_grid(values: FloatArray) -> Float32Array:
        smooth = _mean(values, width) if width > 1 else values
        return np.column_stack([np.interp(grid, time_s, c) for c in smooth.T]).astype(np.float32)

    return _Uniform(grid, at_grid(acc), at_grid(gyr))


def _overlapping(count: int, margin: int) -> Iterator[tuple[slice, slice]]:
    for start in range(0, count, BLOCK_ROWS):
        stop = min(start + BLOCK_ROWS, count)
        yield slice(start, stop), slice(max(start - margin, 0), min(stop + margin, count))


def _mean(values: FloatArray, window: int) -> FloatArray:
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(values, window, axis=0, mode="nearest"), dtype=np.float64)


def _square(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", vectors, vectors))
