"""Extended and unscented filters for a channel that also swings: a level, and an oscillation of unknown speed on it.

A ball's turning swings its sound level and speed, a closed valve the pressure, a belt P2's scale. Linear filters can
only smooth that over; knowing that it swings takes it out. The speed makes the model nonlinear: state ``(m, a, b, ω)``,
``m`` a random walk, ``(a, b)`` turned by ``ω·T`` a row, reading ``m + a`` (B. La Scala, R. Bitmead 1996).
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy import ndimage, signal

from processing.conditioning.channel import Conditioned, Readings, readings
from processing.conditioning.fir import bridged
from processing.conditioning.kalman import noise_figures
from processing.conditioning.noise import Noise, channel_noise
from processing.conditioning.settings import ConditioningSettings
from processing.conditioning.state_space import Model, StateEstimates, ekf, smoothed, ukf
from processing.errors import ErrorCode, LeaklineError
from processing.survey import BoolArray, FloatArray

MAX_ROWS = 60_000  # some ten seconds of work: the model is Python
_FEWEST_PERIODS = 8.0
_STANDS_OUT = 30.0  # times the median around it: of noise one bin in a thousand million does
_NEIGHBOURS = 31
_SPEED_DRIFT = 0.02  # of the oscillation's speed, over the periods that it keeps it

Filter = Callable[[Model, FloatArray, FloatArray, FloatArray, BoolArray], StateEstimates]


def by_ekf(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) by linearising (P2, eq. 3.10–3.18), smoothed backwards where ``phase`` is zero.

    ``figures`` tell the oscillation's ``swing_hz`` and ``swing_size``, 0 where none stands out.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES; FILE_TOO_LARGE beyond 60 000 rows.
    """
    return _filtered(ekf, values, sample_rate_hz, settings, valid)


def by_ukf(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) by the unscented transform (P2, eq. 3.19–3.27); else as :func:`by_ekf`.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES; FILE_TOO_LARGE beyond 60 000 rows.
    """
    return _filtered(ukf, values, sample_rate_hz, settings, valid)


def swing_of(data: Readings, noise: Noise) -> tuple[float, float, FloatArray]:
    """Return the frequency (Hz) and size of the oscillation that stands out most, and the readings without it (n,).

    Frequency and size are 0 where none stands out of the periodogram of the differences by far.
    """
    filled, _ = bridged(data, noise)
    rows = len(filled)
    frequency = np.fft.rfftfreq(rows, 1.0 / data.sample_rate_hz)
    taper = signal.windows.hann(rows, sym=False)
    # differences whiten a wander: else its slow end would hide every swing
    power = np.square(np.abs(np.fft.rfft(np.diff(filled, prepend=filled[0]) * taper)))
    size = min(_NEIGHBOURS, len(power) // 2 * 2 - 1)
    if size < 3:
        return 0.0, 0.0, filled
    over = power / np.maximum(ndimage.median_filter(power, size, mode="nearest"), 1e-300)
    over[frequency < _FEWEST_PERIODS * data.sample_rate_hz / rows] = 0.0
    over[frequency > 0.45 * data.sample_rate_hz] = 0.0
    best = int(np.argmax(over))
    if over[best] < _STANDS_OUT:
        return 0.0, 0.0, filled
    span = slice(max(best - 1, 0), best + 2)
    swing_hz = float(np.average(frequency[span], weights=power[span]))
    carrier = np.exp(-2j * np.pi * swing_hz * np.arange(rows) / data.sample_rate_hz)
    window = signal.windows.hann(2 * max(2, round(3.0 * data.sample_rate_hz / swing_hz)) + 1)
    window /= window.sum()
    half = len(window) // 2
    # eight periods fit in, and half a window is three: there is always enough to mirror
    level = signal.oaconvolve(np.pad(filled, half, mode="reflect"), window, mode="valid")
    slow = signal.oaconvolve((filled - level) * carrier, window, mode="same")
    swinging = 2.0 * np.real(slow * np.conj(carrier))
    return swing_hz, float(np.sqrt(2.0 * np.mean(np.square(swinging)))), filled - swinging


def _filtered(
    run: Filter, values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None
) -> Conditioned:
    data = readings(values, sample_rate_hz, valid)
    if len(data.values) > MAX_ROWS:
        raise LeaklineError(ErrorCode.FILE_TOO_LARGE, size_mb=len(data.values) * 8e-6, limit_mb=MAX_ROWS * 8e-6)
    swing_hz, size, rest = swing_of(data, channel_noise(data, settings))
    noise = channel_noise(replace(data, values=np.where(data.valid, rest, 0.0)), settings)
    model = _model(noise, swing_hz, size, settings, sample_rate_hz)
    first = data.first
    start = np.array([data.values[first], 0.0, 0.0, 2.0 * np.pi * swing_hz / sample_rate_hz])
    # of the level nothing is known before the first reading, which must not count twice
    doubt = np.diag(
        [1e6 * (noise.r + size**2), size**2 + 1e-12 * noise.r, size**2 + 1e-12 * noise.r, model.Q[3, 3] * 100.0]
    )
    found = run(model, data.values[first:], start, doubt, data.valid[first:])
    mean, covariance = smoothed(found) if settings.phase == "zero" else (found.mean, found.covariance)
    level, sigma = np.empty(len(data.values)), np.empty(len(data.values))
    level[first:], sigma[first:] = mean[:, 0], np.sqrt(np.maximum(covariance[:, 0, 0], 0.0))
    level[:first] = level[first]
    sigma[:first] = np.sqrt(sigma[first] ** 2 + noise.q * np.arange(first, 0, -1))
    figures = noise_figures(noise, sample_rate_hz) | {"swing_hz": swing_hz, "swing_size": size}
    return Conditioned(level, sigma, figures=figures)


def _model(noise: Noise, swing_hz: float, size: float, settings: ConditioningSettings, sample_rate_hz: float) -> Model:
    turn = 2.0 * np.pi * swing_hz / sample_rate_hz
    share = swing_hz / sample_rate_hz / settings.swing_periods  # of the time that the oscillation keeps its size
    tiny = 1e-12 * noise.r  # a covariance must stay positive where nothing swings
    Q = np.diag([noise.q, size**2 * share + tiny, size**2 * share + tiny, (_SPEED_DRIFT * turn) ** 2 * share + 1e-16])

    def f(x: FloatArray) -> FloatArray:
        m, a, b, turned = x.T
        cos, sin = np.cos(turned), np.sin(turned)
        return np.array([m, cos * a - sin * b, sin * a + cos * b, turned]).T

    def f_jacobian(x: FloatArray) -> FloatArray:
        cos, sin = np.cos(x[3]), np.sin(x[3])
        return np.array(
            [
                [1.0, 0.0, 0.0, 0.0],
                [0.0, cos, -sin, -sin * x[1] - cos * x[2]],
                [0.0, sin, cos, cos * x[1] - sin * x[2]],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )

    seen = np.array([[1.0, 1.0, 0.0, 0.0]])
    return Model(
        f, lambda x: x[..., :1] + x[..., 1:2], Q, np.array([[noise.r]]), f_jacobian, lambda _: seen, takes_rows=True
    )
