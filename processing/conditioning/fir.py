"""A low-pass FIR by frequency sampling: linear phase, its delay taken off, so that a filtered peak stays in place."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import oaconvolve

from processing.conditioning.channel import Conditioned, Readings, readings
from processing.conditioning.kalman import noise_figures, run
from processing.conditioning.noise import Noise, Weights, channel_noise, model_variance
from processing.conditioning.settings import ConditioningSettings
from processing.errors import ErrorCode, LeaklineError
from processing.survey import BoolArray, FloatArray

_TRANSITION_BINS = 4.0  # sampled frequencies in the transition: stop band at least 45 dB down, ripple below 0.5 %
_MAX_TAPS = 200_001


def taps_from_samples(amplitudes: FloatArray) -> FloatArray:
    """Return the 2m − 1 taps whose response is ``amplitudes`` (m,) at ``k·rate/(2m − 1)``, k = 0 … m − 1.

    Symmetric, hence of exactly linear phase (P2 §3.4.1, method 2; L. R. Rabiner, B. Gold, C. A. McGonegal 1970).
    """
    taps = np.fft.irfft(np.asarray(amplitudes, dtype=np.complex128), n=2 * len(amplitudes) - 1)
    return np.asarray(np.fft.fftshift(taps), dtype=np.float64)


def low_pass_taps(sample_rate_hz: float, settings: ConditioningSettings) -> FloatArray:
    """Return the taps of the low-pass: 1 up to ``cutoff_hz``, 0 beyond ``transition_hz`` more.

    Between them the integral of a Hann window: the smoother the transition, the lower the ripple between the samples.

    Raises:
        LeaklineError: SETTING_INVALID where the stop band would begin above half the sample rate, or the filter would
            be longer than 200 001 taps.
    """
    stop_hz = settings.cutoff_hz + settings.transition_hz
    if stop_hz >= 0.5 * sample_rate_hz:
        allowed = f"cutoff_hz + transition_hz < {0.5 * sample_rate_hz:g} Hz"
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, name="conditioning.cutoff_hz", value=f"{stop_hz:g}", allowed=allowed
        )
    half = int(np.ceil(0.5 * _TRANSITION_BINS * sample_rate_hz / settings.transition_hz))
    if 2 * half + 1 > _MAX_TAPS:
        allowed = f"≥ {_TRANSITION_BINS * sample_rate_hz / _MAX_TAPS:.3g} Hz"
        name, value = "conditioning.transition_hz", f"{settings.transition_hz:g}"
        raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=value, allowed=allowed)
    frequency_hz = np.arange(half + 1) * sample_rate_hz / (2 * half + 1)
    into = np.clip((frequency_hz - settings.cutoff_hz) / settings.transition_hz, 0.0, 1.0)
    return taps_from_samples(1.0 - into + np.sin(2.0 * np.pi * into) / (2.0 * np.pi))


@dataclass(frozen=True)
class Ends:
    """The record's last rows: beyond them the signal goes on point-mirrored about a line's end.

    Mirrored about the last reading, the filter would return that reading with all its noise; about the end of a line
    through the last half-length it stays exact on ramps, and the noise is averaged.
    """

    line: FloatArray  # weights on the last rows (oldest first) that give the line's value at the last row

    @classmethod
    def of(cls, half: int) -> "Ends":
        """Return the ends of a filter of ``2·half + 1`` taps."""
        back = np.arange(-half, 1, dtype=np.float64)
        centred = back - back.mean()
        spread = float(centred @ centred)
        slope = -back.mean() * centred / spread if spread else np.zeros_like(back)
        return cls(1.0 / len(back) + slope)

    def continued(self, values: FloatArray) -> FloatArray:
        """Return ``values`` with half a length added on either side."""
        half = len(self.line) - 1
        if not half:
            return values
        last = float(self.line @ values[-half - 1 :])
        first = float(self.line @ values[half::-1])
        return np.concatenate([2.0 * first - values[half:0:-1], values, 2.0 * last - values[-2 : -half - 2 : -1]])

    def weights(self, taps: FloatArray, rows_to_end: int) -> FloatArray:
        """Return what the output ``rows_to_end`` before the last row weighs the last 2·half + 1 readings with."""
        half = len(self.line) - 1
        now = 2 * half - rows_to_end
        placed = np.zeros(3 * half + 1)
        placed[now - half : now + half + 1] = taps
        beyond = placed[2 * half + 1 :]
        inside = placed[: 2 * half + 1].copy()
        inside[half : 2 * half] -= beyond[::-1]
        inside[half:] += 2.0 * beyond.sum() * self.line
        return inside


def convolve(values: FloatArray, taps: FloatArray) -> FloatArray:
    """Return ``values`` (n,) filtered by symmetric ``taps`` without delay.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES where the record is shorter than half the filter.
    """
    half = len(taps) // 2
    if len(values) < half + 1:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=len(values), needed=half + 1)
    level = float(values.mean())  # an offset of 1e5 would cost the transform five digits
    filtered = oaconvolve(Ends.of(half).continued(values - level), taps, mode="valid")
    return np.asarray(filtered + level, dtype=np.float64)


def end_inflation(taps: FloatArray, noise: Noise, rows: int) -> FloatArray:
    """Return the error variance (rows,) over that in the middle: 1 there, another towards the ends."""
    half = len(taps) // 2
    if not half:
        return np.ones(rows)
    ends, middle = Ends.of(half), model_variance(Weights(taps, half), noise)
    places = np.unique(np.linspace(0, half, 17).astype(int))
    found = [_end_variance(ends, taps, int(d), noise) / middle for d in places]
    row = np.arange(rows)
    return np.asarray(np.interp(np.minimum(row, row[::-1]), places, found), dtype=np.float64)


def _end_variance(ends: Ends, taps: FloatArray, rows_to_end: int, noise: Noise) -> float:
    return model_variance(Weights(ends.weights(taps, rows_to_end), len(taps) - 1 - rows_to_end), noise)


def bridged(data: Readings, noise: Noise) -> tuple[FloatArray, FloatArray]:
    """Return the readings with holes filled by the smoother's prediction, and the sigma (n,) of the fill, else 0."""
    if data.complete:
        return data.values, np.zeros(len(data.values))
    mean, variance = run(data, noise, zero_phase=True)
    return np.where(data.valid, data.values, mean), np.where(data.valid, 0.0, np.sqrt(variance))


def spread(sigma: FloatArray, taps: FloatArray) -> FloatArray:
    """Return the sigma (n,) that errors of ``sigma``, taken as of one piece, leave after the filter."""
    if not sigma.any():
        return np.zeros(len(sigma))
    half = len(taps) // 2
    return np.maximum(oaconvolve(np.pad(sigma, half, mode="edge"), np.abs(taps), mode="valid"), 0.0)


def fir(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) by the low-pass of :func:`low_pass_taps`; holes are bridged by the smoother first.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES, SETTING_INVALID.
    """
    data = readings(values, sample_rate_hz, valid)
    noise, taps = channel_noise(data, settings), low_pass_taps(sample_rate_hz, settings)
    filled, fill_sigma = bridged(data, noise)
    variance = model_variance(Weights(taps, len(taps) // 2), noise) * end_inflation(taps, noise, len(filled))
    sigma = np.sqrt(variance + spread(fill_sigma, taps) ** 2)
    return Conditioned(
        convolve(filled, taps), sigma, figures=noise_figures(noise, sample_rate_hz) | {"taps": len(taps)}
    )
