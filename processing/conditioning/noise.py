"""The random-walk model of a channel: its variances q and r, its steady state, and the error of any linear filter."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter

from processing.conditioning import kernels_conditioning as kernels
from processing.conditioning.channel import Readings
from processing.conditioning.settings import ConditioningSettings
from processing.survey import FloatArray

_PIECES, _PIECE_ROWS = 8, 8192  # the noise of hours is learnt from a minute's worth of CPU nobody waits for


@dataclass(frozen=True)
class Noise:
    """Variances a sample: ``q`` of the true value's step, ``r`` of a reading; unit²."""

    q: float
    r: float

    @property
    def predicted(self) -> float:
        """Steady-state variance before a reading: ``P² − qP − qr = 0``, the scalar Riccati equation."""
        return 0.5 * self.q + float(np.sqrt(0.25 * self.q * self.q + self.q * self.r))

    @property
    def gain(self) -> float:
        """Steady-state Kalman gain."""
        return self.predicted / (self.predicted + self.r)

    @property
    def filtered(self) -> float:
        """Steady-state variance after a reading."""
        return self.gain * self.r

    @property
    def smoothed(self) -> float:
        """Steady-state variance of the smoother."""
        return self.filtered / (2.0 - self.gain)


def channel_noise(data: Readings, settings: ConditioningSettings) -> Noise:
    """Return the variances that ``settings`` give, the likeliest for the data where they give none.

    Maximum likelihood by the innovations of the Kalman filter; a scale that is not given is profiled out
    (A. C. Harvey, Forecasting, Structural Time Series Models and the Kalman Filter, 1989, §4.2).
    """
    scale = float(np.abs(data.values).max()) or 1.0
    floor = (1e-9 * scale) ** 2  # a channel that never changes has no noise to divide by
    r = max(settings.noise_sigma**2, floor) if settings.noise_sigma else None
    q = settings.wander_sigma**2 / data.sample_rate_hz if settings.wander_sigma else None
    if r is not None and q is not None:
        return Noise(q, r)
    pieces = _pieces(data)

    def fitted(log_ratio: float) -> tuple[float, Noise]:
        sums, ratio = np.zeros(3), float(np.exp(log_ratio))
        for values, valid in pieces:
            kernels.likelihood(values, valid, ratio, sums)
        each = sums[1] / max(sums[2], 1.0)
        unit = max(each if r is None and q is None else r if r is not None else (q or 0.0) / ratio, floor)
        return sums[2] * float(np.log(unit)) + sums[0] + sums[1] / unit, Noise(ratio * unit, unit)

    best = minimize_scalar(lambda x: fitted(x)[0], bounds=(-30.0, 15.0), method="bounded", options={"xatol": 0.01})
    return fitted(float(best.x))[1]


def _pieces(data: Readings) -> list[tuple[FloatArray, np.ndarray[tuple[int], np.dtype[np.uint8]]]]:
    """Even pieces of a long channel, the whole of a short one; each begins with a valid row."""
    rows = len(data.values)
    starts = [0] if rows <= _PIECES * _PIECE_ROWS else list(np.linspace(0, rows - _PIECE_ROWS, _PIECES, dtype=int))
    length = rows if len(starts) == 1 else _PIECE_ROWS
    found = []
    for start in starts:
        valid = data.valid[start : start + length]
        if np.count_nonzero(valid) > 1:
            first = start + int(np.argmax(valid))
            found.append((data.values[first : start + length], data.valid[first : start + length].view(np.uint8)))
    if not found:  # every piece fell into a hole of a channel that has few readings: take what there is
        found.append((data.values[data.valid], np.ones(np.count_nonzero(data.valid), dtype=np.uint8)))
    return found


@dataclass(frozen=True)
class Weights:
    """What a linear filter weighs the readings around row ``now`` with, oldest first.

    Beyond the first and the last they go on geometrically, by ``decay_old`` and ``decay_new`` a row; all sum to 1.
    """

    near: FloatArray
    now: int
    decay_old: float = 0.0
    decay_new: float = 0.0


def steady_weights(noise: Noise, taps: FloatArray, *, zero_phase: bool) -> Weights:
    """Return the weights of the steady Kalman filter, or smoother, in a row with symmetric ``taps`` (2m + 1,).

    The smoother is the filter run forwards, then backwards: ``K/(1 − a z⁻¹) · K/(1 − a z)`` with a = 1 − K.
    """
    gain = max(noise.gain, 1e-9)  # of a value that does not wander at all every reading counts alike, for ever
    keep = 1.0 - gain
    # newest reading first: the recursion runs into the past
    weights = np.asarray(lfilter([gain], [1.0, -keep], taps), dtype=np.float64)
    if not zero_phase:
        return Weights(weights[::-1], len(taps) - 1 - len(taps) // 2, decay_old=keep)
    oldest = weights[-1] / (1.0 - keep * keep)  # what the geometric rest adds, going back to now
    back, _ = lfilter([gain], [1.0, -keep], weights[-2::-1], zi=np.array([keep * gain * oldest]))
    weights = np.concatenate([[gain * oldest], back])
    return Weights(weights, len(taps) // 2, keep, keep)


def model_variance(weights: Weights, noise: Noise) -> float:
    """Return the error variance of ``Σ weights_j z_j`` as an estimate of ``x_now``.

    Readings' noise counts ``r Σ g²``; a step w between row j − 1 and j is missed by all weights on its far side:
    ``q Σ (Σ_far g)²``. For the Kalman weights this is the Riccati solution.
    """
    near, rows = weights.near, len(weights.near)
    squares, missed = float(near @ near), 0.0
    for side, steps, decay in (
        (near, weights.now, weights.decay_old),
        (near[::-1], rows - 1 - weights.now, weights.decay_new),
    ):
        beyond = float(side[0]) * decay / (1.0 - decay)
        rest = 1.0 / (1.0 - decay * decay)
        far = beyond + np.cumsum(side)[:steps]
        squares += (float(side[0]) * decay) ** 2 * rest
        missed += float(far @ far) + beyond * beyond * rest
    return noise.r * squares + noise.q * missed
